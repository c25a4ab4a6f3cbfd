"""Symbols of mechanics: coordinates, velocities, momenta and parameters as SymPy symbols.

A coordinate is an ordinary SymPy symbol that knows the names of its rates and of its momentum, so
``m*theta.dot**2/2`` is an ordinary SymPy expression. Velocities are independent symbols, as in
∂L/∂q̇; :func:`time_derivative` is the d/dt that knows how they hang together.
"""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.facts import InconsistentAssumptions
from sympy.printing.pretty.pretty_symbology import pretty_symbol, pretty_use_unicode
from sympy.printing.pretty.stringpict import prettyForm

from canon.expression.symbols.user_input import given_expression, given_symbols

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = [
    "Coordinate",
    "Momentum",
    "Rate",
    "acceleration",
    "coordinates",
    "momentum",
    "parameters",
    "time",
    "time_derivative",
    "velocity",
    "without_dynamicsymbols",
]

time = Symbol("t", real=True)
"""The time of every system that does not name its own."""


class Moving(Symbol):
    """What moves: a symbol that SymPy writes after constants, as in ``l**2*m*theta_ddot``.

    SymPy's printers choose a rule by the name of the class: one called Variable would be taken for that of its syntax
    trees for code, and ``lambdify`` would fail.
    """

    __slots__ = ()

    @classmethod
    def class_key(cls) -> Any:
        """Return SymPy's sorting key of the class, the next after that of ``Symbol``."""
        *kind, name = Symbol.class_key()
        return (*kind, f"{name}, variable")


class Coordinate(Moving):
    """A generalized coordinate: a real symbol with ``.dot``, ``.ddot`` and ``.momentum``."""

    __slots__ = ()

    @property
    def dot(self) -> Rate:
        """The generalized velocity, a symbol of its own."""
        return velocity(self)

    @property
    def ddot(self) -> Rate:
        """The generalized acceleration, a symbol of its own."""
        return acceleration(self)

    @property
    def momentum(self) -> Momentum:
        """The canonical momentum conjugate to this coordinate, named ``p_<name>``."""
        return momentum(self)


class Rate(Moving):
    """A first or second rate of a coordinate; prints as q̇ or q̈."""

    __slots__ = ()

    def _latex(self, _printer: Any) -> str:
        base, dots = self._parts()
        written = sp.latex(Symbol(base))
        return rf"\{'d' * dots}ot{{{written}}}" if dots else written

    def _pretty(self, _printer: Any) -> Any:
        base, dots = self._parts()
        if not (pretty_use_unicode() and dots):
            return prettyForm(pretty_symbol(self.name), binding=prettyForm.ATOM)
        letter, *rest = pretty_symbol(base) or base
        return prettyForm("".join((letter, _DOTS[dots], *rest)), binding=prettyForm.ATOM)

    def _parts(self) -> tuple[str, int]:
        """Return the name of what changes, and the number of dots above it."""
        for ending, dots in (("_ddot", 2), ("_dot", 1)):
            if self.name.endswith(ending):
                return self.name.removesuffix(ending), dots
        return self.name, 0


_DOTS = ("", "\u0307", "\u0308")
"""What Unicode puts above the letter before."""


class Momentum(Moving):
    """A canonical momentum."""

    __slots__ = ()


def coordinates(names: str, **assumptions: bool) -> Any:
    """Make generalized coordinates from their names.

    Parameters
    ----------
    names
        Names separated by spaces or commas, or ranges ``"q:8"``, ``"q1:9"``, as :func:`sympy.symbols` takes them.
    **assumptions
        SymPy assumptions such as ``positive=True``; real unless said otherwise.

    Returns
    -------
    Coordinate or tuple of Coordinate
        One coordinate of one name, a tuple of several; of ``"x,"`` and of a range always a tuple.

    Examples
    --------
    >>> from canon import coordinates
    >>> theta, phi = coordinates("theta phi")
    >>> theta.dot, theta.ddot, theta.momentum
    (theta_dot, theta_ddot, p_theta)
    >>> coordinates("q1:4")
    (q1, q2, q3)
    """
    assumed = _assumed(names, assumptions)
    return _one_or_all(names, [Coordinate(name, **assumed) for name in _split(names)])


def parameters(names: str, **assumptions: bool) -> Any:
    """Make parameters (masses, lengths, constants) from their names.

    Parameters
    ----------
    names
        Names separated by spaces or commas, or ranges ``"q:8"``, ``"q1:9"``, as :func:`sympy.symbols` takes them.
    **assumptions
        SymPy assumptions such as ``positive=True``; real unless said otherwise.

    Returns
    -------
    sympy.Symbol or tuple of sympy.Symbol
        One parameter of one name, a tuple of several; of ``"m,"`` and of a range always a tuple.

    Examples
    --------
    >>> from canon import parameters
    >>> m, l, g = parameters("m l g", positive=True)
    >>> m.is_positive
    True
    """
    assumed = _assumed(names, assumptions)
    return _one_or_all(names, [Symbol(name, **assumed) for name in _split(names)])


def _one_or_all(names: str, made: list[Any]) -> Any:
    return made[0] if len(made) == 1 and not {",", ":"} & {*names} else tuple(made)


def velocity(q: Symbol) -> Rate:
    """Return the symbol for q̇."""
    return Rate(f"{q.name}_dot", real=True)


def acceleration(q: Symbol) -> Rate:
    """Return the symbol for q̈."""
    return Rate(f"{q.name}_ddot", real=True)


def momentum(q: Symbol) -> Momentum:
    """Return the symbol for the momentum conjugate to q, named ``p_<name>``."""
    return Momentum(f"p_{q.name}", real=True)


def time_derivative(f: Expr, q: Sequence[Symbol], t: Symbol = time) -> Expr:
    """Return df/dt of f(q, q̇, t) along any motion, with q̈ where f holds q̇.

    The chain rule  df/dt = Σ (∂f/∂q q̇ + ∂f/∂q̇ q̈) + ∂f/∂t.

    Examples
    --------
    >>> from canon import coordinates
    >>> x = coordinates("x")
    >>> time_derivative(x * x.dot, [x])
    x*x_ddot + x_dot**2
    """
    f = given_expression(f, "f")
    terms: list[Expr] = [f.diff(t)]
    for s in given_symbols(q, "q"):
        terms.append(f.diff(s) * velocity(s))
        terms.append(f.diff(velocity(s)) * acceleration(s))
    return sp.Add(*terms)


def without_dynamicsymbols(f: Expr, functions: Mapping[Expr, Symbol], t: Symbol = time) -> Expr:
    """Rewrite q(t), dq/dt and d²q/dt² (SymPy's dynamicsymbols) as symbols.

    Parameters
    ----------
    f
        Expression in applied functions of ``t`` and their derivatives.
    functions
        The symbol that stands for each applied function.
    t
        The time symbol the functions were made with.
    """
    replaced: Expr = f
    for applied, symbol in functions.items():
        replaced = replaced.xreplace(
            {applied.diff(t, 2): acceleration(symbol), applied.diff(t): velocity(symbol)}
        ).xreplace({applied: symbol})
    return replaced


_ASSUMPTIONS = (
    "positive", "negative", "nonzero", "real", "integer", "nonnegative", "nonpositive", "complex", "imaginary",
    "rational", "irrational", "algebraic", "transcendental", "even", "odd", "prime", "composite", "zero", "noninteger",
    "finite", "infinite", "commutative", "hermitian", "antihermitian", "polar", "extended_real", "extended_positive",
    "extended_negative", "extended_nonzero", "extended_nonnegative", "extended_nonpositive",
)  # fmt: skip
"""What SymPy takes as an assumption."""


def _assumed(names: Any, assumptions: Mapping[str, Any]) -> dict[str, bool]:
    """Return SymPy's assumptions, real unless said otherwise; a misspelt one is no assumption and says so."""
    for word, value in assumptions.items():
        if word not in _ASSUMPTIONS:
            close = get_close_matches(word, _ASSUMPTIONS, n=1)
            remedy = f"is {close[0]} meant?" if close else "such as positive, real, integer"
            raise ValueError(f"SymPy has no assumption {word!r}; {remedy}")
        if not isinstance(value, bool):
            raise TypeError(f"{word} should be True or False, not {value!r}")
    said = {**assumptions} or {"real": True}
    try:
        Symbol("_", **said)
    except InconsistentAssumptions:
        together = ", ".join(f"{word}={value}" for word, value in said.items())
        raise ValueError(f"{names}: nothing is {together} at once") from None
    return said


def _in_ranges(names: Sequence[str]) -> list[str]:
    """Return names with each range in it written out."""
    found: list[str] = []
    for name in names:
        try:
            made = [symbol.name for symbol in sp.symbols(name, seq=True)]
        except ValueError as unknown:
            raise ValueError(f"{name} is no range of names ({unknown}): write q:3 or q1:4") from unknown
        if not made:
            raise ValueError(
                f"{name} is a range without names: write q:3 for q0, q1, q2, or q1:4 for q1, q2, q3"
            )
        found += made
    return found


def _split(names: Any) -> list[str]:
    if not isinstance(names, str):
        raise TypeError(f"the names should be one text, as in coordinates('theta phi'), not {names!r}")
    found = names.replace(",", " ").split()
    if ":" in names:
        found = _in_ranges(found)
    if not found:
        raise ValueError("no names given: write them separated by spaces, as in coordinates('theta phi')")
    repeated = sorted({name for name in found if found.count(name) > 1})
    if repeated:
        raise ValueError(f"{', '.join(repeated)} named twice; every name stands for one quantity")
    return found
