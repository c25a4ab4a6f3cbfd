"""Left sides: what stands before ``=`` in an answer, held against what is asked.

``H = …`` where H is asked is a name and passed over, ``L = T - V = …`` a definition from a book, and told; ``K = …``
where H is asked contradicts the question.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from canon.expression.parse import parse_expression
from canon.expression.text.declared_names import key_of
from canon.expression.text.tokens import LanguageError, Token, tokens

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.expression.text.scope import Scope

__all__ = [
    "OTHER_SPELLINGS",
    "Label",
    "Quantity",
    "components_asked",
    "entry_asked",
    "has_primes",
    "is_action",
    "is_asked",
    "is_definition",
    "is_of_another",
    "label_of",
]

OTHER_SPELLINGS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "F": ("f", "S", "W", "G", "Lambda", "chi", "Phi"),
        "L1": ("L_1",),
        "L2": ("L_2", "L", "L'"),
        "I": ("I", "C"),
        "H": ("H_total", "H_tot", "H_system", "H_sys", "H_ges"),
        "L": ("L_total", "L_tot", "L_system", "L_sys", "L_ges"),
        "W": ("W_1", "chi"),
        "T": ("K", "E_kin", "T_kin", "E_k", "T_total", "T_tot"),
        "dof": ("f", "n", "N", "s", "DOF"),
        "K": ("K_1", "H", "H'", "H_av", "H_new"),
        "energy_rate": (),
        "rhs": (),
        "lhs": (),
    }
)
"""Other names that people give to what a key holds."""
_COMPONENTS: Mapping[str, tuple[str, int]] = {
    "q_dot": ("q", 1), "p_dot": ("p", 1), "X": ("x", 1), "map.Q": ("new_q", 0), "map.P": ("new_p", 0),
    "inverse_map.q": ("q", 0), "inverse_map.p": ("p", 0), "Q": ("q", 0), "P": ("p", 0), "force": ("q", 0),
    "Qnc": ("q", 0), "J": ("q", 0), "omega": ("q", 0), "gradient": ("p", 0),
}  # fmt: skip
"""The key that names the components of a list, and the dots on these names."""
_LETTERS = {
    "Q": ("Q",), "P": ("P",), "force": ("Q",), "Qnc": ("Q",), "J": ("J", "I"), "omega": ("omega", "Omega"),
}  # fmt: skip
"""Letters that components are called by."""
_DECORATION = re.compile("[\u0302-\u0304]|\\^?\\*$")
"""What tells a new quantity from an old one: ``H̄``, ``H̃``, ``H*``."""
_OF_POISSON = re.compile(r"(?<=[}\]])_\{?P\.?B\.?\}?$")
"""What says that a bracket is Poisson's."""
_IN_PROGRAMS = re.compile(r"d(?P<of>[A-Za-z]\w*)_dt")
"""A rate as programs call it."""
_PAIRS = {"{": "}", "[": "]", "(": ")", "<": ">"}
_DEFINITIONS: Mapping[str, str] = {
    "L": r"[TK]-[VU]",
    "H": r"[TK]\+[VU]|[VU]\+[TK]|(?:[Σ∑]|sum)?_?i?\(?[^=]*\)?-L|T_2-T_0\+V",
    "K": r"H\+(?:∂F|dF|∂S|F)[_1-4]*(?:/∂t|/dt|_t)?(?:\([^=]*\))?|H'",
    "R": r"L-[^=]*|[^=]*-L",
    "claim": r"d/dt\(?∂L/∂[^=+-]*-\(?∂L/∂[^=+-]*|\(?d/dt\)?\(?∂L/∂[^=+-]*|∂L/∂[^=+-]*|Q_?[A-Za-z0-9]*",
    "energy_rate": r"d\(?[TKE]\+[VU]\)?/dt|-2F|-2\*F",
    "S": r"[^=]*[Σ∑][^=]*",
    "I": r"[TK]\+[VU]|[VU]\+[TK]",
}
_ACTION = re.compile(
    r"(?:(?P<share>\\[dt]?frac\s?\{?1\}?\s?\{\s?2\s?\\pi\s?\}|\(?1/\(?2\s?\*?\s?(?:π|pi|\\pi)\)?\)?)"
    r"(?:\s|\\[,;: ]|\*){0,9})?(?:\\o?int|[∫∮])\s{0,9}p(?:_\\?\w{1,9}|_\{\\?\w{1,9}\})?(?:\s|\\[,;: ]){0,9}"
    r"(?:\\mathrm\s?\{d\}|\\dd|d)\s{0,9}\\?\w{1,9}(?P<less>\s{0,9}[-−]\s{0,9}\w{1,9}(?:\s|\*){0,9}t)?"
)
"""``∫ p dq``, for S less ``E t``, and the share of it that an action is.

Repeats are bounded, or blanks are tried in too many ways.
"""
_FREQUENCY = re.compile(r"[∂d][EH]/[∂d](?P<action>[JI])")
"""A frequency by its definition."""
_SEPARATED = {
    "S": re.compile(r"W(?:\([^()=]{1,40}\))?-\w{1,9}\*?t"),
    "W": re.compile(r"W_\{?\w{1,9}\}?(?:\([^()=]{1,40}\))?(?:\+W_\{?\w{1,9}\}?(?:\([^()=]{1,40}\))?){1,9}"),
}
"""Complete integrals by their parts, ``W - E t`` and ``W_r(r) + W_φ(φ)``."""
_SUBSCRIPTS = str.maketrans("₁₂₃₄", "1234")
_OF_ONE_ACTION = 2
"""Names that depend on others, the energy and one action; of several actions ∂E/∂J would have to say which."""
_OF_ANY = r"[-−+]?∂[HLFKSRVUW][_0-9]{0,3}/∂[^-−+=∂*/(){}\[\]]{1,20}|\{[^={}]{1,20},H\}"
"""Derivatives of functions that are not given, and the bracket with H."""


@dataclass(frozen=True)
class Label:
    """A left side that is a name: ``p_r'``, ``H(q, p)``, ``{L_z, x}``.

    Parameters
    ----------
    name
        The name; empty for a bracket.
    rates
        Primes or dots on it, and one more for ``dp/dt``.
    arguments
        What stands in the brackets after it, or in the bracket itself.
    """

    name: str
    rates: int = 0
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True)
class Quantity:
    """What is asked under a key, by the names that people write before ``=``.

    Parameters
    ----------
    shown
        What it is called in a message.
    names
        Its names, each with the number of dots it has.
    bracket
        The two entries of a bracket, as the claim writes them.
    """

    shown: str
    names: tuple[tuple[str, int], ...] = ()
    bracket: tuple[str, str] | None = None

    def named_by(self, label: Label) -> bool:
        """Tell whether a label is one of its names.

        Examples
        --------
        >>> Quantity("H", (("H", 0),)).named_by(label_of("H(q,p)")), Quantity("H", (("H", 0),)).named_by(label_of("K"))
        (True, False)
        """
        return any(key_of(name) == key_of(label.name) and rates == label.rates for name, rates in self.names)


def entry_asked(key: str, name: str) -> Quantity:
    """Return what an entry of a table is called, under ``rates`` the velocity of its coordinate.

    Examples
    --------
    >>> entry_asked("rates", "x").named_by(label_of("dx/dt")), entry_asked("solution", "x").named_by(label_of("x(t)"))
    (True, True)
    """
    if key == "rates":
        return Quantity(f"{name}'", ((name, 1), (f"{name}_dot", 0)))
    return Quantity(name, ((name, 0),))


def components_asked(place: str, keys: Mapping[str, Any], scope: Scope) -> tuple[Quantity, ...]:
    """Return what each component of a list is called.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> first, second = components_asked("p_dot", {"q": ["x", "y"], "p": ["p_x", "p_y"]}, Scope())
    >>> second.named_by(label_of("p_y'")), second.named_by(label_of("F_y")), second.named_by(label_of("F_x"))
    (True, True, False)
    """
    of, _ = _COMPONENTS.get(place, ("", 0))
    listed: Any = keys.get(of, [])
    names = listed if isinstance(listed, list) else [listed]
    if place in _LETTERS:
        return tuple(_by_letters(place, i, name, len(names) == 1, scope) for i, name in enumerate(names, 1))
    return tuple(_by_name(place, i, name, keys, scope) for i, name in enumerate(names, 1))


def _by_letters(place: str, number: int, name: str, alone: bool, scope: Scope) -> Quantity:
    """Return a component that is called by a letter; a declared name is what was declared."""
    spelled = [s for letter in _LETTERS[place] for s in _numbered(letter, number, name, alone)]
    free = place in ("J", "omega")
    return Quantity(spelled[0], tuple((s, 0) for s in spelled if not (free and scope.declares(s))))


def _by_name(place: str, number: int, name: str, keys: Mapping[str, Any], scope: Scope) -> Quantity:
    """Return a component that is called as its variable, with the dots of a rate or by the letter of one."""
    _, rates = _COMPONENTS[place]
    letters = _by_letter(place, number, name, keys.get("q", []))
    also = [(s, 0) for s in letters if s in scope.other_names or not scope.declares(s)]
    if (
        place == "p_dot"
        and ("p" in scope.other_names or not scope.declares("p"))
        and len(_listed(keys.get("p"))) == 1
    ):
        also.append(("p", 1))  # the only momentum
    return Quantity(f"{name}{chr(39) * rates}", ((name, rates), (f"{name}{'_dot' * rates}", 0), *also))


def _listed(names: Any) -> list[Any]:
    return names if isinstance(names, list) else [names]


def _numbered(letter: str, number: int, name: str, alone: bool) -> list[str]:
    """Return how a component is called: ``Q`` where there is one, ``Q_1`` or ``Q_x``."""
    return [letter] * alone + [f"{letter}_{number}", f"{letter}_{name}"]


def _by_letter(place: str, number: int, name: str, q: list[str]) -> list[str]:
    """Return the names of a rate by its letter: the force ``F_x`` for p_x', the velocity ``v_x`` for x'."""
    letter = {"q_dot": "v", "p_dot": "F", "X": "X"}.get(place)
    index = name if place != "p_dot" else q[number - 1] if number <= len(q) else number
    return [f"{letter}_{index}", f"{letter}_{number}"] if letter else []


def label_of(said: str) -> Label | None:
    """Return the name that a left side is, None where it is none.

    Examples
    --------
    >>> label_of("ṗ_r"), label_of("dp/dt"), label_of("F₂(q, P)"), label_of("{L_z, x}").arguments
    (Label(name='p_r', rates=1, arguments=()), Label(name='p', rates=1, arguments=()),
     Label(name='F_2', rates=0, arguments=('q', 'P')), ('L_z', 'x'))
    """
    said = _OF_POISSON.sub("", said)
    try:
        found = tokens(_DECORATION.sub("", said))[:-1]
    except LanguageError:
        return None
    if not found or len(found) > 40:
        return None
    first, *rest = found
    if first.text in _PAIRS and found[-1].text == _PAIRS[first.text]:
        entries = _entries(said, found[1:-1])
        return Label("", 0, entries) if len(entries) == 2 else None
    if not first.atoms:
        return None
    if not rest and (rate := _IN_PROGRAMS.fullmatch(first.text)):
        return Label(rate["of"], first.primes + 1)
    if not rest:
        return Label(first.text, first.primes)
    if first.text.startswith("d") and [t.text for t in rest] == ["/", "dt"] and len(first.text) > 1:
        return Label(first.text[1:], first.primes + 1)
    arguments = _arguments(rest)
    return None if arguments is None else Label(first.text, first.primes, arguments)


def is_asked(label: Label | None, asked: Quantity, scope: Scope) -> bool:
    """Tell whether a left side is a name of what is asked, its arguments being declared."""
    if label is None:
        return False
    if not label.name:
        return asked.bracket is not None and _same_bracket(label, asked.bracket, scope)
    known = {key_of(name) for name in scope.spelled}
    known |= {"q", "p"} if asked.shown == "H" else set()  # H(q, p), whatever they are called here
    return all(key_of(argument) in known for argument in label.arguments) and asked.named_by(label)


def _same_bracket(label: Label, asked: tuple[str, str], scope: Scope) -> bool:
    """Tell whether a bracket is the one that is asked: what can be read of it agrees, and one entry can be.

    ``{f, g}`` is that of the functions under these keys.
    """
    if label.arguments == ("f", "g") and not (scope.declares("f") or scope.declares("g")):
        return True
    agree = [_same_entry(entry, wanted, scope) for entry, wanted in zip(label.arguments, asked, strict=True)]
    return False not in agree and True in agree


def _same_entry(entry: str, wanted: str, scope: Scope) -> bool | None:
    """Tell whether an entry is what is wanted; None where it is a name of the reader's own."""
    if entry.replace(" ", "") == wanted.replace(" ", ""):
        return True
    try:
        right = parse_expression(wanted, scope)
    except LanguageError:
        return None
    try:
        said = parse_expression(entry, scope)
    except LanguageError:
        return None if label_of(entry) is not None and not right.is_Symbol else False
    return bool(said == right)


def _arguments(bracket: Sequence[Token]) -> tuple[str, ...] | None:
    """Return the names between brackets after a name; None where something else is there."""
    if bracket[0].text not in ("(", "[") or bracket[-1].text != _PAIRS[bracket[0].text]:
        return None
    inside = bracket[1:-1]
    if not all(t.atoms or t.text in (",", "0", ";") for t in inside):
        return None
    return tuple(t.text for t in inside if t.atoms)


def _entries(said: str, inside: list[Token]) -> tuple[str, ...]:
    """Return the two entries of a bracket as they were written."""
    depth, commas = 0, list[Token]()
    for token in inside:
        depth += (token.text in _PAIRS) - (token.text in _PAIRS.values())
        if token.text == "," and depth == 0:
            commas.append(token)
    if len(commas) != 1 or not inside:
        return ()
    start, middle = inside[0].column - 1, commas[0].column
    end = len(said.rstrip()) - 1
    return said[start : middle - 1].strip(), said[middle:end].strip()


def has_primes(text: str) -> bool:
    """Tell whether a name has primes, which may tell it from another; a dot or d/dt says that it is a rate.

    Examples
    --------
    >>> has_primes("H' = 1"), has_primes("dH/dt = 1")
    (True, False)
    """
    return re.search("['′″]", text) is not None


def is_definition(said: str, key: str, scope: Scope) -> bool:
    """Tell whether a side is a definition of what is asked in terms of quantities that the claim does not declare.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> is_definition("T-V", "L", Scope()), is_definition("T+V", "L", Scope())
    (True, False)
    """
    said = said.replace("−", "-").translate(_SUBSCRIPTS)
    if key == "omega" and (rate := _FREQUENCY.fullmatch(said)) is not None:
        action = rate["action"]
        return not scope.declares(action) or (
            action in scope.dependent and len(scope.dependent) <= _OF_ONE_ACTION
        )
    if key in _SEPARATED and not scope.declares("W") and _SEPARATED[key].fullmatch(said):
        return True
    names = set(re.findall(r"[A-Z]", said))
    if not names or any(scope.declares(name) for name in names):
        return False
    if re.fullmatch(_OF_ANY, said):
        return not any(name in scope.functions for name in names)
    return re.fullmatch(_DEFINITIONS.get(key, "(?!)"), said) is not None


def is_action(text: str, key: str) -> bool:
    r"""Tell whether a side is ``∫ p dq`` where W or S is asked, or ``(1/2π) ∮ p dq`` where an action is.

    Examples
    --------
    >>> is_action(r"$\int p_x\,\mathrm{d}x$", "W"), is_action("∫ x dx", "W"), is_action("(1/2π)∮ p dq", "J")
    (True, False, True)
    """
    if key not in ("W", "S") and key.rstrip("0123456789_") != "J":
        return False
    found = _ACTION.fullmatch(text.strip(" $"))
    if found is None or (found["less"] is not None and key != "S"):
        return False
    return (found["share"] is None) == (key in ("W", "S"))


def is_of_another(said: str) -> bool:
    """Tell whether a side is a derivative or bracket of some function, which names no answer by itself.

    Examples
    --------
    >>> is_of_another("∂F/∂q"), is_of_another("{L,H}"), is_of_another("T-V")
    (True, True, False)
    """
    return re.fullmatch(_OF_ANY, said.replace("−", "-")) is not None
