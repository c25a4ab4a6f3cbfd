r"""LaTeX names: how ``\dot\theta_1``, ``mgl`` or ``p_{\varphi}`` become declared names.

Only declared names are ever read. A run of letters is the name it spells as a whole; otherwise it is a
product of declared names (``mgl`` is m g l), and a run that splits in two ways is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice, product
from typing import TYPE_CHECKING, NoReturn, TypeAlias

from canon.cached_property import cached_property
from canon.expression.text.syntax import LanguageError, Name, Number

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = [
    "FUNCTIONS", "UPRIGHT", "Applied", "Function", "Item", "Mark", "Names", "Pieces", "spellings", "stems",
]  # fmt: skip

FUNCTIONS = {
    **{name: name for name in ("sin", "cos", "tan", "cot", "sec", "csc", "sinh", "cosh", "tanh", "exp")},
    **{name: name for name in ("sech", "csch", "coth")}, "sen": "sin",
    "ln": "log", "log": "log", "max": "Max", "min": "Min",
    "arcsin": "asin", "arccos": "acos", "arctan": "atan", "arccot": "acot",
    "arsinh": "asinh", "arcosh": "acosh", "artanh": "atanh",
    "arcsinh": "asinh", "arccosh": "acosh", "arctanh": "atanh", "sgn": "sign", "abs": "Abs", "Abs": "Abs",
    "atan2": "atan2", "arctan2": "atan2", "tg": "tan", "ctg": "cot", "arctg": "atan", "cosec": "csc",
    **{name: name for name in ("asin", "acos", "atan", "acot", "asinh", "acosh", "atanh", "sign", "LambertW")},
}  # fmt: skip
r"""What ``\sin``, ``\operatorname{arsinh}``, … are called in the plain language."""
UPRIGHT = {name: f"jacobi_{name}" for name in ("am", "sn", "cn", "dn")}
r"""Functions whose letters are taken for factors unless they stand upright, ``\operatorname{sn}``."""

_GREEK = ("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu",
          "xi", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta",
          "Lambda", "Xi", "Pi", "Sigma", "Upsilon", "Phi", "Psi", "Omega", "hbar", "ell")  # fmt: skip
_VARIANTS = {f"var{name}": name for name in ("epsilon", "theta", "kappa", "pi", "rho", "sigma", "phi")}
_SHORT = {"lambda": ("lamda", "lam", "lmbda", "lambd"), "theta": ("th",), "epsilon": ("eps",), "varepsilon": ("eps",),
          "ell": ("l",)}  # fmt: skip
"""Other names that people declare for a letter; Python keeps ``lambda`` for itself."""
_RATES = ("", "_dot", "_ddot")
_MAX_RUN = 100
"""Most letters in a row; more are no product anyone wrote, and splitting them would cost their square."""


_MOST_CHOICES = 64
"""Most spellings of a subscript that are looked up."""


@dataclass(frozen=True, slots=True)
class Function:
    r"""The name of a built-in function, ``\sin``, before its argument is known."""

    name: str
    column: int


@dataclass(frozen=True, slots=True)
class Applied:
    """The name of a declared function; ``order`` counts its primes or dots."""

    name: str
    order: int
    dotted: bool
    column: int


@dataclass(frozen=True, slots=True)
class Mark:
    """A letter that means nothing alone: the d, partial or delta of a differential, Euler's e."""

    text: str
    column: int


Item: TypeAlias = Name | Number | Function | Applied | Mark
Pieces: TypeAlias = tuple[tuple[str, ...], ...]
"""A subscript piece by piece, each with its possible spellings."""


def stems(command: str) -> tuple[str, ...]:
    r"""Return how a letter's command may be declared, best first; empty for any other command.

    Examples
    --------
    >>> stems("varphi"), stems("theta"), stems("frac")
    (('varphi', 'phi'), ('theta', 'vartheta', 'th'), ())
    """
    if command in _VARIANTS:
        return (command, _VARIANTS[command], *_SHORT.get(command, ()))
    if command not in _GREEK:
        return ()
    variant = (f"var{command}",) if f"var{command}" in _VARIANTS and command != "pi" else ()
    return (command, *variant, *_SHORT.get(command, ()))


@dataclass(frozen=True)
class Names:
    """Looks spelled names up in a scope.

    Parameters
    ----------
    text
        The whole LaTeX text, for errors.
    scope
        The declared names.
    """

    text: str
    scope: Scope

    @cached_property
    def longest(self) -> int:
        """Length of the longest declared name."""
        return max(map(len, self.scope.spelled))

    def declares(self, name: str) -> bool:
        """Whether a name is declared, as a symbol or a function."""
        return name in self.scope.functions or self.scope.symbol(name) is not None

    def is_length(self, stem: str) -> bool:
        """Whether a vector's letter can only stand for its length: none of its components is declared."""
        return stem not in ("x", "y", "z", "q") and not any(
            name.startswith(f"{stem}_") for name in self.scope.names
        )

    def spelled(
        self, stems: tuple[str, ...], pieces: Pieces, order: int, column: int, *, dotted: bool = False
    ) -> Name | Applied | None:
        """Return the one declared name that stem, subscript and rate can mean, None if there is none.

        Raises
        ------
        LanguageError
            Where two declared names, such as ``theta1`` and ``theta_1``, would be written alike.
        """
        others: dict[str, None] = {}
        for stem in stems:
            for choice in islice(product(*pieces), _MOST_CHOICES):
                found = [name for name in _joined(stem, choice) if self._has_rate(name, order)]
                if len(found) > 1:
                    self._both(found, column)
                if found and stem == stems[0] and all(map(_is_first, choice, pieces)):
                    return self._named(found[0], order, column, dotted=dotted)
                others |= dict.fromkeys(found)
        if len(others) > 1:
            self._both([*others], column)
        return self._named(next(iter(others)), order, column, dotted=dotted) if others else None

    def _named(self, name: str, order: int, column: int, *, dotted: bool) -> Name | Applied:
        if name in self.scope.functions:
            return Applied(name, order, dotted, column)
        return Name(name + _RATES[order], 0, column)

    def _both(self, names: list[str], column: int) -> NoReturn:
        self._refuse(
            column, f"this could be {' or '.join(names[:3])}; both are declared", "rename one of them"
        )

    def _has_rate(self, name: str, order: int) -> bool:
        if name in self.scope.functions:
            return True
        return order < len(_RATES) and self.scope.symbol(name + _RATES[order]) is not None

    def run(self, letters: str, column: int, pieces: Pieces, order: int, *, powered: bool) -> list[Item]:
        """Return the declared names of a run of letters; subscript and rate belong to the last of them.

        Parameters
        ----------
        letters
            Letters and digits as they stand, beginning with a letter.
        column
            Where they begin.
        pieces, order
            Subscript and rate of the last name.
        powered
            Whether ``^`` follows, which makes an undeclared last ``e`` Euler's number.

        Raises
        ------
        LanguageError
            Where no split into declared names exists, or more than one.
        """
        if len(letters) > _MAX_RUN:
            self._refuse(column, f"more than {_MAX_RUN} letters in a row", "put spaces between the names")
        whole = self.spelled((letters,), pieces, order, column) or self._mark(letters, 0, column)
        if whole is not None:
            return [whole]
        if (letters in FUNCTIONS or letters in ("pi", "i", "I")) and not pieces and not order:
            return [self._spelled_out(letters, column)]
        splits = self._splits(letters, column)
        ends = self._ends(letters, column, pieces, order, splits, powered=powered)
        if (
            not ends
            and not pieces
            and not order
            and (named := self._before_function(letters, column, splits))
        ):
            return named
        if not ends:
            self._unknown(letters, column, max(i for i, s in enumerate(splits) if s), pieces, order)
        ways = [[*split, end] for start, end in ends for split in splits[start]]
        if len(ways) > 1:
            shown = " and as ".join(" ".join(_shown(item) for item in way) for way in ways[:2])
            self._refuse(column, f"{letters} can be read as {shown}", "put spaces between the names")
        return ways[0]

    def _spelled_out(self, letters: str, column: int) -> Item:
        """Return the function, π or imaginary unit that letters without a backslash name, if they mean nothing else."""
        splits = self._splits(letters, column)
        endings = ((start, letters[start:]) for start in range(1, len(letters)) if splits[start])
        if any(
            ending in FUNCTIONS or self.spelled((ending,), (), 0, column + start) for start, ending in endings
        ):
            factors = " ".join(letters)
            self._refuse(
                column,
                f"{letters} can be read as \\{letters} and as {factors}",
                f"write \\{letters}, or the factors with spaces",
            )
        if letters == "i" and self.declares("I"):
            remedy = "write I for the symbol; the imaginary unit needs a sheet without I"
            self._refuse(column, "i is not declared, and I is", remedy)
        if letters in ("i", "I"):
            return Name("I", 0, column)
        return Name("pi", 0, column) if letters == "pi" else Function(FUNCTIONS[letters], column)

    def _before_function(self, letters: str, column: int, splits: list[list[list[Item]]]) -> list[Item]:
        """Return the names before a function without a backslash, ``mglcos``; nothing if no such thing stands here."""
        ends = [name for name in FUNCTIONS if letters.endswith(name) and splits[len(letters) - len(name)]]
        if not ends:
            return []
        name = max(ends, key=len)
        before = splits[len(letters) - len(name)]
        if len(before) > 1 or len(ends) > 1:
            self._refuse(
                column,
                f"{letters} can be read in several ways",
                f"put spaces between the names, and write \\{name}",
            )
        return [*before[0], Function(FUNCTIONS[name], column + len(letters) - len(name))]

    def _splits(self, letters: str, column: int) -> list[list[list[Item]]]:
        """Return for each beginning of the run at most two ways to split it into declared names."""
        splits: list[list[list[Item]]] = [[[]]]
        for end in range(1, len(letters)):
            ways: list[list[Item]] = []
            for start in range(max(0, end - self.longest), end):
                if not splits[start] or len(ways) > 1:
                    continue
                part = letters[start:end]
                item = self.spelled((part,), (), 0, column + start)
                item = item or (self._mark(part, start, column) if part == "d" else None)
                if item is None and start == 0 and part == "i" and not self.declares("I"):
                    item = Name("I", 0, column)
                if item is not None:
                    ways += [[*way, item] for way in splits[start]]
            splits.append(ways[:2])
        return splits

    def _ends(
        self,
        letters: str,
        column: int,
        pieces: Pieces,
        order: int,
        splits: list[list[list[Item]]],
        *,
        powered: bool,
    ) -> list[tuple[int, Item]]:
        """Return the names that can end the run, each with where it starts."""
        found: list[tuple[int, Item]] = []
        for start in range(max(1, len(letters) - self.longest), len(letters)):
            if not splits[start]:
                continue
            item: Item | None = self.spelled((letters[start:],), pieces, order, column + start)
            if item is None and letters[start:] == "e" and powered and not pieces and not order:
                item = Mark("e", column + start)
            if item is not None:
                found.append((start, item))
        return found

    def _mark(self, part: str, start: int, column: int) -> Mark | None:
        """Return the d of a differential, which begins a run, or a lone e, where they are not declared."""
        if start == 0 and part in ("d", "e") and not self.declares(part):
            return Mark(part, column)
        return None

    def _unknown(self, letters: str, column: int, start: int, pieces: Pieces, order: int) -> NoReturn:
        rest = letters[start:]
        if rest[0].isdigit():
            self._refuse(column + start, "a number after a name", "write x_2, x^2 or 2x, whichever is meant")
        name = spellings(rest, pieces)[0]
        if self.spelled((rest,), pieces, 0, column + start) and order:
            self.no_rate(name, column + start)
        function = next((f for f in sorted(FUNCTIONS, key=len, reverse=True) if rest.startswith(f)), None)
        if function:
            remedy = f"write \\{function} for the function"
        elif rest in ("i", "j", "I"):
            remedy = r"write \mathrm{i} for the imaginary unit"
        elif rest == "pi":
            remedy = r"write \pi"
        else:
            remedy = self.scope.near(name, self.text[column - 1 + start + len(rest) :])
        self._refuse(column + start, f"{name} is not declared", remedy)

    def no_rate(self, name: str, column: int) -> NoReturn:
        """Refuse the dot or prime of what is not a coordinate."""
        self._refuse(
            column,
            f"{name} has no such rate here",
            "one or two dots or primes belong to a coordinate, or to a declared function",
        )

    def _refuse(self, column: int, reason: str, remedy: str) -> NoReturn:
        raise LanguageError(self.text, column, reason, remedy)


def spellings(stem: str, pieces: Pieces) -> tuple[str, ...]:
    """Return ``theta_1`` and ``theta1``, and for a subscript of several pieces ``q_1_2`` too."""
    if not pieces:
        return (stem,)
    return tuple(
        dict.fromkeys(
            name for choice in islice(product(*pieces), _MOST_CHOICES) for name in _joined(stem, choice)
        )
    )


def _joined(stem: str, choice: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names that stem and subscript can be declared as, ``q_1_2``, ``q_12``, ``q12`` and ``q1_2``."""
    if not choice:
        return (stem,)
    return tuple(
        dict.fromkeys(f"{stem}{gap}{joint.join(choice)}" for gap in ("_", "") for joint in ("", "_"))
    )


def _is_first(spelling: str, among: tuple[str, ...]) -> bool:
    return spelling == among[0]


def _shown(item: Item) -> str:
    return item.text if isinstance(item, Name | Mark) else getattr(item, "name", "")
