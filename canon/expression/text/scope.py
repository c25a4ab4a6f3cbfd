"""Scope: the names that an expression may use, and what each of them means."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from sympy import Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import Coordinate, Momentum, Rate, acceleration, time, velocity
from canon.expression.text.vocabulary import CONSTANTS, FUNCTIONS, LEGENDRES, OTHER_NAMES, WRITTEN_OUT

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Expr

__all__ = ["Scope", "split"]

_MAX_TOLD = 20
"""Names that are told where one is not known."""
_MAX_RUN = 40
"""Letters of a name that is still taken apart."""


@dataclass(frozen=True)
class Scope:
    """The names an expression may use.

    A declared name overrides any built-in meaning. Each :class:`Coordinate` brings its rates along:
    ``theta_dot`` and ``theta_ddot``, or ``theta'`` and ``theta''``.

    Parameters
    ----------
    names
        Symbol of each declared name.
    functions
        Arbitrary smooth functions: the names of the arguments each was declared with.
    time
        The symbol of the time.
    signs
        SymPy assumptions on the values of declared functions, where they are more than real.
    implicit
        Whether letters after a number are always factors, ``2 m``, never a unit.
    moving
        Names of what changes in time, besides coordinates and momenta.
    other_names
        What declared symbols are called besides; none of these names is declared.
    values
        What names and rates abbreviate, as they are written here: every operation acts on the value, ``∂V/∂x`` too.
        None where a name has none.
    quadratures
        Whether an integral over a coordinate may have no limits, as in W = ∫ √(2m(E − V)) dx.
    independent
        Whether a derivative of one symbol by another is plainly 0, as in brackets; elsewhere it is asked about.
    dependent
        Names of what depends on other names in a way that is not written, as the energy on q and p and an action on it.
    timed
        Names without rates that may have the time behind them all the same: multipliers, ``λ[t]``.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression import parse_expression
    >>> theta = coordinates("theta")
    >>> parse_expression("theta'' + 0.5*sin(theta)", Scope({"theta": theta}))
    theta_ddot + sin(theta)/2
    """

    names: Mapping[str, Symbol] = field(default_factory=lambda: MappingProxyType({}))
    functions: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))
    time: Symbol = time
    signs: Mapping[str, Mapping[str, bool]] = field(default_factory=lambda: MappingProxyType({}))
    implicit: bool = False
    moving: frozenset[str] = frozenset()
    other_names: Mapping[str, Symbol] = field(default_factory=lambda: MappingProxyType({}))
    values: Mapping[str, Expr | None] = field(default_factory=lambda: MappingProxyType({}))
    quadratures: bool = False
    independent: bool = True
    dependent: frozenset[str] = frozenset()
    timed: frozenset[str] = frozenset()

    def __hash__(self) -> int:
        return hash(
            (
                frozenset(self.names.items()),
                frozenset(self.functions.items()),
                self.time,
                self.implicit,
                self.moving,
                frozenset(self.other_names.items()),
                self.quadratures,
                self.independent,
                self.dependent,
                self.timed,
            )
        )

    @cached_property
    def spelled(self) -> tuple[str, ...]:
        """All names that may be typed: declared ones, functions, and rates as ``theta_dot_1`` or ``theta_1_dot``."""
        found = [*self.names, *self.functions, self.time.name, *self.other_names]
        for name, symbol in (*self.names.items(), *self.other_names.items()):
            if isinstance(symbol, Coordinate):
                found += [f"{name}_dot", f"{name}_ddot"]
        return tuple(dict.fromkeys(found))

    def moves(self, name: str) -> bool:
        """Tell whether a name stands for what changes in time, or for the time."""
        moving = isinstance(self.symbol(name), Coordinate | Momentum | Rate)
        return moving or name in self.moving or name == self.time.name

    def takes_time(self, name: str) -> bool:
        """Tell whether the time may stand behind a name, ``x(t)``, as its argument."""
        return name in self.timed or (self.moves(name) and name != self.time.name)

    def symbol(self, name: str) -> Symbol | None:
        """Return the symbol of a declared name or of a coordinate's rate, None for any other name."""
        if name in self.names:
            return self.names[name]
        if name == self.time.name:
            return self.time
        for ending, rate in (("_ddot", acceleration), ("_dot", velocity)):
            stem = name.removesuffix(ending)
            base = self.names.get(stem, self.other_names.get(stem))
            if name.endswith(ending) and isinstance(base, Coordinate):
                return rate(base)
        return self.other_names.get(name)

    def declares(self, name: str) -> bool:
        """Tell whether a name stands for a declared symbol or a rate."""
        return name not in self.functions and self.symbol(name) is not None

    def with_variable(self, name: str, *, positive: bool | None = None) -> Scope:
        """Return a scope in which a name is the variable of an integral: any real number, whatever it is outside."""
        if not name or name in self.functions:
            return self
        outside = self.symbol(name)
        values = {
            each: None if value is not None and value.has(outside) else value
            for each, value in self.values.items()
            if each != name
        }
        variable = Symbol(name, real=True, positive=positive)
        return replace(self, names={**self.names, name: variable}, values=values)

    def near(self, name: str, behind: str = "") -> str:
        """Return a remedy for an unknown name, before what stands behind it."""
        called = behind.lstrip().startswith(("(", "[", r"\left"))
        if name in LEGENDRES and called and (name not in ("F", "Pi") or "," in behind.partition(")")[0]):
            return f"if Legendre's integral is meant, write {LEGENDRES[name]} of the parameter m = k²"
        if name == "E":
            return "if an energy is meant, write what it is equal to; Euler's number is exp(1)"
        if name in OTHER_NAMES:
            return f"write {OTHER_NAMES[name]}"
        if name in WRITTEN_OUT:
            return WRITTEN_OUT[name]
        moving = [q for q, symbol in self.names.items() if isinstance(symbol, Coordinate)]
        if name in ("v", "a") and len(moving) == 1:
            return f"if a rate is meant, write {moving[0]}' or {moving[0]}''"
        if factors := split(name, self):
            return f"write {factors}"
        known = [*self.names, self.time.name, *self.functions, *FUNCTIONS, *CONSTANTS]
        known += [f"{n}_dot" for n, s in self.names.items() if isinstance(s, Coordinate)]
        close = difflib.get_close_matches(name[:60], known, n=1, cutoff=0.75)
        if close:
            return f"is {close[0]} meant?"
        named = [*self.names, *self.functions]
        more = f" and {len(named) - _MAX_TOLD} more" if len(named) > _MAX_TOLD else ""
        return (
            f"the names here are {', '.join(named[:_MAX_TOLD])}{more}"
            if named
            else "no names are declared here"
        )


def split(name: str, scope: Scope) -> str:
    """Return the declared names that a run of letters is made of, one space between them; nothing if in no one way.

    Examples
    --------
    >>> from canon import parameters
    >>> from canon.expression.text.scope import Scope
    >>> split("mgl", Scope({s.name: s for s in parameters("m g l")}))
    'm g l'
    """
    if len(name) > _MAX_RUN:
        return ""
    ways: list[list[str]] = [[""]]
    for end in range(1, len(name) + 1):
        parts = ((ways[start], name[start:end]) for start in range(end))
        found = [f"{way} {part}" for before, part in parts if scope.declares(part) for way in before]
        ways.append(found[:2])
    return ways[-1][0].strip() if len(ways[-1]) == 1 else ""
