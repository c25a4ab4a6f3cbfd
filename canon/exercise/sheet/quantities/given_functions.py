r"""Sides of chains that are made of functions the claim gives: ``-∂H/∂x``, ``d/dt(∂L/∂θ̇) - ∂L/∂θ``, ``{x, H}``.

People write where a formula comes from. What is made of H, L, V … of the same claim is worked out and compared with its
neighbours in the chain, so that a wrong sign in it is seen; what is made of functions that nobody gave can't be.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

import sympy as sp

from canon.exercise.sheet.left_sides import is_definition
from canon.exercise.sheet.quantities.known_vectors import (
    with_angular_momenta,
    with_place_of_body,
    with_speeds,
    without_cross_products,
)
from canon.expression.parse import LanguageError, parse_expression
from canon.expression.symbols.symbol import time_derivative, velocity
from canon.expression.text.declared_names import key_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.expression.text.scope import Scope
    from canon.expression.text.statement import Side, Statement

__all__ = ["GivenFunctions", "key_at", "with_partial_signs"]

_LONGEST = 200
"""Characters of a side that is looked at."""
_BY_LETTER = ("L", "H", "V", "L1", "L2")
"""Functions of a claim that people put into formulas by their letters; F is too often a force."""
_FORCES = ("F", "Qnc", "constraints", "multipliers", "force", "contact")
"""Keys of what stands in Lagrange's equations beside L."""
_TERM = re.compile(
    r"(?P<sign>[-+]?)(?:"
    r"(?P<rate>\(?d/dt\)?)?(?P<open>\(?)∂(?P<of>[A-Z])/∂(?P<by>[^-+=∂(){}\[\]/*]{1,20})(?P<close>\)?)"
    r"|\{(?P<first>[^{},=]{1,20}),(?P<second>[A-Z])\})"
)

_SLOPE = re.compile(r"∂\s?(?P<of>[A-Z][12]?)\s?/\s?∂(?P<by>[^-−+=∂*/(){}\[\]\s]{1,20})")


_SCRIPT = re.compile(
    r"\\(?:mathcal|mathscr)(?:\s+(?P<a>[FHLV])(?![A-Za-z_])|\s?\{\s?(?P<b>[FHLV])\s?\}(?!_))"
)
"""Letters of functions in script, which in a formula of these are the functions."""
_INTEGRAL = re.compile(r"∫|∮|\\o?int(?![a-z])|\bIntegral\b|\bintegrate\b")
"""Signs of integrals: a letter that is put in for a function would be constant under them."""


def key_at(place: str) -> str:
    """Return the key of a place in a claim.

    Examples
    --------
    >>> key_at("p_dot[0]"), key_at("map.Q[1]")
    ('p_dot', 'map')
    """
    return re.split(r"[.\[]", place)[0]


_D = r"(?:d|\\(?:mathrm|text)\s?\{\s?d\s?\}|\\rm\s?d)"
_STRAIGHT = re.compile(
    rf"(?<![\w∂]){_D}\s?(?P<of>[HWS]|\\mathcal\s?\{{\s?[HWS]\s?\}})(?P<over>\s?/\s?|\s?\}}\s?\{{\s?){_D}\s?"
    r"(?P<by>\\?[^\W\d_]\w{0,15}(?:_\{\w{1,5}\})?)"
)
_OF_KEYS = {"q_dot": "H", "p_dot": "H", "gradient": "WS"}
"""Functions whose derivatives by a variable are partial ones under some keys, however they are written."""


def with_partial_signs(key: str, text: str, keys: Mapping[str, Any]) -> str:
    """Return a text with ``∂H/∂p`` for ``dH/dp``, which in Hamilton's equations is nothing else.

    Examples
    --------
    >>> with_partial_signs("p_dot", "-dH/dx = -k x", {"q": ["x"]}), with_partial_signs("p_dot", "dH/dt", {"q": ["x"]})
    ('-∂H/∂x = -k x', 'dH/dt')
    """
    listed = [keys.get(name, []) for name in ("q", "p")]
    names = {key_of(name) for each in listed for name in (each if isinstance(each, list) else [each])}

    def partial(found: re.Match[str]) -> str:
        by = found["by"].lstrip("\\").replace("{", "").replace("}", "")
        if key_of(by) not in names or not set(found["of"]) & set(_OF_KEYS.get(key, "")):
            return found.group()
        by = found["by"] if found["over"].strip() == "/" else f" {found['by']}"
        return f"∂{found['of']}{found['over']}∂{by.strip()}".rjust(len(found.group()))

    return _STRAIGHT.sub(partial, text)


def _plain_letter(found: re.Match[str]) -> str:
    """Return a letter without its script, at its column and apart from a word before it."""
    return f" {found['a'] or found['b']}".rjust(len(found.group()))


@dataclass(frozen=True)
class GivenFunctions:
    """The functions that a claim gives.

    Parameters
    ----------
    keys
        The claim.
    asked
        The key that a side stands under: what is asked gives nothing.
    scope
        The declared names.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression import Scope
    >>> x = coordinates("x")
    >>> given = GivenFunctions({"H": "p**2/2 + x**3"}, "p_dot", Scope({"x": x, "p": x.momentum}))
    >>> given.worked_out("-∂H/∂x"), given.worked_out("∂F/∂x")
    (-3*x**2, None)
    """

    keys: Mapping[str, Any]
    asked: str
    scope: Scope

    def equations(self, side: Side, near: Side) -> list[str] | None:
        """Return the equation of a side with another one, none where it is an identity; None where it is not given."""
        made = self.worked_out(side.said)
        if made is None:
            made = self.put_in(side.text)
        if made is None:
            return None
        try:
            right = parse_expression(near.text, self.scope)
        except LanguageError:
            return []  # it is told where the side itself is read
        return [] if sp.expand(made - right) == 0 else [f"{made} = {right}"]

    def worked_out(self, said: str) -> Expr | None:
        """Return a side, in plain spelling without blanks, in the declared names; None where it is made of others."""
        said, total, place = said.replace("−", "-"), sp.S.Zero, 0
        if not said or len(said) > _LONGEST:
            return None
        while place < len(said):
            term = _TERM.match(said, place)
            if (
                term is None
                or (place and not term["sign"])
                or (term["of"] and bool(term["open"]) != bool(term["close"]))
            ):
                return None
            try:
                value = self._value(term)
            except LanguageError:
                return None
            if value is None:
                return None
            total += -value if term["sign"] == "-" else value
            place = term.end()
        return total

    def put_in(self, text: str) -> Expr | None:
        """Return a side in which functions stand by their letters, ``p θ̇ - L``; None where none that is given does.

        Examples
        --------
        >>> from canon.expression import Scope, parse_expression
        >>> GivenFunctions({"L": "v**2/2"}, "R", Scope({"v": sp.Symbol("v")})).put_in("-L")
        -v**2/2
        """
        if len(text.strip()) > _LONGEST or _INTEGRAL.search(text):
            return None
        try:
            letters = self._letters()
            known = with_place_of_body(self.keys, self.scope)
            known = with_angular_momenta(self.keys, known) if self.asked == "pairs" else known
            plain, slopes = self._without_slopes(_SCRIPT.sub(_plain_letter, text), letters)
            plain = plain if known is self.scope else with_speeds(plain)
            plain, crosses = without_cross_products(plain, self.keys, self.scope)
            put = {
                name: (sp.Dummy(name, real=True), f) for name, f in {**letters, **slopes, **crosses}.items()
            }
            if not put and known is self.scope:
                return None
            names = {**known.names, **{name: symbol for name, (symbol, _) in put.items()}}
            said = parse_expression(plain, replace(known, names=names))
        except LanguageError:
            return None
        found = said.xreplace(dict(put.values()))
        made = found != said or not self._can_read(text)
        return found if made and isinstance(found, sp.Expr) else None

    def _letters(self) -> dict[str, Expr]:
        """Return the functions that the claim gives, by their letters; F is Rayleigh's function beside dE/dt."""
        given = [name for name in _BY_LETTER if self._gives(name)]
        given += ["F"] if self.asked == "energy_rate" and self._gives("F") else []
        letters = {name: parse_expression(self.keys[name], self.scope) for name in given}
        if "H" in letters and not self.scope.declares("E") and "E" not in self.keys:
            letters["E"] = letters["H"]
        return letters

    def _can_read(self, text: str) -> bool:
        try:
            parse_expression(text, self.scope)
        except LanguageError:
            return False
        return True

    def restates(self, statement: Statement) -> bool:
        """Tell whether a statement says again what the claim gives, ``L = T - V = …`` before an equation of motion."""
        first, *others = statement.sides
        if not others or not self._gives(first.said):
            return False
        between = [side for side in others[:-1] if not is_definition(side.said, first.said, self.scope)]
        try:
            given = parse_expression(self.keys[first.said], self.scope)
            said = [parse_expression(side.text, self.scope) for side in (*between, others[-1])]
        except LanguageError:
            return False
        return all(sp.expand(given - each) == 0 for each in said)

    def is_lagranges_equation(self, sides: Sequence[Side]) -> bool:
        """Tell whether two sides are Lagrange's equation of a given L and no other forces, ``d/dt(∂L/∂x') = ∂L/∂x``."""
        if len(sides) != 2 or not self._gives("L") or any(key in self.keys for key in _FORCES):
            return False
        left, right = (sp.S.Zero if side.said == "0" else self.worked_out(side.said) for side in sides)
        q = self._symbols("q")
        if left is None or right is None or not q:
            return False
        L, said = parse_expression(self.keys["L"], self.scope), sp.expand(left - right)
        for x in q:
            own = sp.expand(time_derivative(L.diff(velocity(x)), q, self.scope.time) - L.diff(x))
            if own != 0 and (said == own or said == -own):
                return True
        return False

    def says_a_momentum(self, statement: Statement) -> bool:
        """Tell whether a statement is true of a momentum, ``p = m x'`` beside a Hamiltonian that is asked for."""
        q, p = self._symbols("q"), self._symbols("p")
        if len(statement.sides) != 2 or not self._gives("L") or not q or not p or len(q) != len(p):
            return False
        try:
            L = parse_expression(self.keys["L"], self.scope)
            left, right = (parse_expression(side.text, self.scope) for side in statement.sides)
        except LanguageError:
            return False
        momenta = {p_i: L.diff(velocity(q_i)) for p_i, q_i in zip(p, q, strict=True)}
        return left in momenta and sp.expand(momenta[cast("Symbol", left)] - right) == 0

    def _without_slopes(self, text: str, letters: Mapping[str, Expr]) -> tuple[str, dict[str, Expr]]:
        """Return a text with names in place of derivatives ``∂L/∂x'`` of the given functions, and what these are."""
        slopes: dict[str, Expr] = {}

        def named(found: re.Match[str]) -> str:
            by = parse_expression(found["by"], self.scope)
            of = letters.get(found["of"])
            if of is None or not isinstance(by, sp.Symbol) or self._hides(of, by):
                return found.group()
            slopes[f"Slope_{len(slopes)}"] = of.diff(by)
            return f" Slope_{len(slopes) - 1} "

        return _SLOPE.sub(named, text), slopes

    def _gives(self, letter: str) -> bool:
        """Whether a letter stands for a function that the claim gives."""
        undeclared = not self.scope.declares(letter) and letter not in self.scope.functions
        return letter != self.asked and isinstance(self.keys.get(letter), str) and undeclared

    def _value(self, term: re.Match[str]) -> Expr | None:
        letter = term["of"] or term["second"]
        if not self._gives(letter):
            return None
        function = parse_expression(self.keys[letter], self.scope)
        if term["second"]:
            return self._bracket(parse_expression(term["first"], self.scope), function)
        symbol = parse_expression(term["by"], self.scope)
        if not isinstance(symbol, sp.Symbol):
            return None
        if self._hides(function, symbol):
            return None
        slope = function.diff(symbol)
        return time_derivative(slope, self._symbols("q") or [], self.scope.time) if term["rate"] else slope

    def _hides(self, function: Expr, symbol: Symbol) -> bool:
        """Whether it is not written how a function depends on a symbol: ∂H/∂J is a frequency, with no J in H."""
        return symbol.name in self.scope.dependent and not function.has(symbol)

    def _bracket(self, f: Expr, g: Expr) -> Expr | None:
        """Return Poisson's bracket in the claim's coordinates and momenta."""
        from canon.mechanics.hamilton.bracket import (
            poisson_bracket,  # most sheets need no mechanics to be read
        )

        q, p = self._symbols("q"), self._symbols("p")
        return None if q is None or p is None or len(q) != len(p) else poisson_bracket(f, g, q, p)

    def _symbols(self, key: str) -> list[Symbol] | None:
        """Return the symbols that a key lists; None where it lists none, as for coordinates in terms of others."""
        names = self.keys.get(key)
        if not isinstance(names, list):
            return None
        try:
            found = [parse_expression(name, self.scope) for name in names]
        except LanguageError:  # it is told where the names are read
            return None
        symbols = [s for s in found if isinstance(s, sp.Symbol)]
        return symbols if len(symbols) == len(found) else None
