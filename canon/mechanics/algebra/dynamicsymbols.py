"""SymPy's dynamicsymbols converted: theta(t), its derivatives and t become canon's symbols."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Derivative, Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.expression.symbols.repeated_sum import written_out
from canon.expression.symbols.symbol import Coordinate, acceleration, time, velocity, without_dynamicsymbols
from canon.expression.symbols.symbols_and_functions import symbols_and_functions
from canon.expression.symbols.user_input import given_expression, given_kind
from canon.mechanics.algebra.substitution import exchanged, refuse_unordered

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

__all__ = [
    "check_no_namesake",
    "check_none_is_the_time",
    "check_none_reads_as_the_time",
    "coordinate",
    "coordinate_symbols",
    "in_own_symbols",
    "in_own_time",
    "needs_plain",
    "plain",
    "plain_all",
    "plain_places",
]


def coordinate(x: Any) -> Symbol:
    """Return the symbol of a coordinate given as a symbol, a function of time, or the derivative of one.

    Raises
    ------
    TypeError
        Where it is neither.

    Examples
    --------
    >>> from sympy.physics.mechanics import dynamicsymbols
    >>> coordinate(dynamicsymbols("theta")), coordinate(dynamicsymbols("theta", 1))
    (theta, theta_dot)
    """
    if isinstance(x, Symbol):
        return x
    if isinstance(x, AppliedUndef) and len(x.args) == 1:
        return Coordinate(x.func.__name__, real=True)
    if isinstance(x, Derivative) and isinstance(x.expr, AppliedUndef) and x.derivative_count == 1:
        return velocity(coordinate(x.expr))
    raise TypeError(
        f"{x!r} is no coordinate; use coordinates('theta'), a SymPy symbol, or one of SymPy's dynamicsymbols"
    )


def coordinate_symbols(q: Any) -> tuple[Symbol, ...]:
    """Return the symbols of one coordinate or of several.

    Raises
    ------
    TypeError
        Where they are in a dictionary or a set, or something else is among them.

    Examples
    --------
    >>> from sympy.physics.mechanics import dynamicsymbols
    >>> coordinate_symbols(dynamicsymbols("x y"))
    (x, y)
    """
    refuse_unordered(q)
    several = (q,) if isinstance(q, sp.Basic) or not hasattr(q, "__iter__") else q
    return tuple(coordinate(x) for x in several)


def plain_all(functions: Sequence[Any], q: Sequence[Symbol], t: Symbol = time) -> tuple[Expr, ...]:
    """Return :func:`plain` of each; TypeError where they are in a dictionary or a set, which has no order."""
    refuse_unordered(functions)
    return tuple(plain(f, q, t) for f in functions)


def plain_places(
    places: Mapping[Any, Any], old: Sequence[Symbol], new: Sequence[Symbol], t: Symbol = time
) -> dict[Symbol, Expr]:
    """Return what each old coordinate is in terms of new ones, all in canon's symbols.

    Examples
    --------
    >>> from canon import coordinates
    >>> from sympy.physics.mechanics import dynamicsymbols
    >>> x, s = coordinates("x"), coordinates("s")
    >>> plain_places({dynamicsymbols("x"): 2*dynamicsymbols("s")}, [x], [s])
    {x: 2*s}
    """
    named = {s.name: s for s in (*old, *new)}
    found = {coordinate(s): plain(place, (*old, *new), t) for s, place in places.items()}
    for s in found:
        check_no_namesake(s, (s,), named, (*old, *new), t)
    return found


def needs_plain(symbols: Collection[Any], named: Mapping[str, Symbol]) -> bool:
    """Tell whether a symbol has the name of a variable or of the time, and is another one.

    SymPy's own time, ``dynamicsymbols._t``, is such a one. ``named`` has the symbols that are meant by their names.
    """
    return any(
        s not in (named.get(s.name, s),) for s in symbols
    )  # asks for identity first: most are the same object


def check_no_namesake(
    f: Expr, symbols: Iterable[Symbol], named: Mapping[str, Symbol], variables: Sequence[Symbol], t: Symbol
) -> None:
    """Refuse a function that holds another symbol of a variable's name: it would read as the variable and be constant.

    Parameters
    ----------
    symbols
        Those of the function, and others that do not stand free in it, as may be.
    named
        The variables by name, so that thousands of functions of thousands of variables need one such mapping.
    t
        The time, which may have the name of a variable.

    Examples
    --------
    >>> x, other = sp.symbols("x", real=True), sp.symbols("x")
    >>> check_no_namesake(x + other, [x, other], {"x": x}, [x], time)
    Traceback (most recent call last):
        ...
    ValueError: x is another symbol than the variable x, for SymPy tells symbols apart by their assumptions and cla...
    """
    for s in symbols:
        own = named.get(s.name)
        if own is None or s in (own, t) or isinstance(s, sp.Dummy):
            continue
        if s not in variables and s in f.free_symbols:
            raise ValueError(
                f"{s} is another symbol than the variable {own}, for SymPy tells symbols apart by their assumptions "
                "and classes: write the variable itself, or give the other one another name"
            )


def _check_no_other_time(f: Expr, symbols: Iterable[Symbol], named: Mapping[str, Symbol], t: Symbol) -> None:
    """Refuse another symbol of the time's name, which has assumptions and so is not known to be meant as the time."""
    for s in symbols:
        if s.name != t.name or s.name in named or s in (t, Symbol(t.name)) or isinstance(s, sp.Dummy):
            continue
        if s in f.free_symbols:
            raise ValueError(
                f"{s} is another symbol than the time {t}, for SymPy tells symbols apart by their assumptions: write "
                f"canon.time, or Symbol({t.name!r}), or give yours as the time, t={s}; a parameter needs another name"
            )


def in_own_symbols(
    functions: Iterable[Expr], variables: Sequence[Symbol], t: Symbol = time
) -> tuple[Expr, ...]:
    """Return functions with the time in place of a symbol without assumptions of its name, which is no variable.

    Raises
    ------
    ValueError
        Where another symbol has the name of a variable or of the time.

    Examples
    --------
    >>> bare, x = Symbol("t"), Symbol("x", real=True)
    >>> in_own_symbols([2 * bare * x], [x]) == (2 * time * x,)
    True
    """
    named = {s.name: s for s in variables}
    return tuple(_in_own_symbols(f, named, variables, t) for f in functions)


def _in_own_symbols(f: Expr, named: Mapping[str, Symbol], variables: Sequence[Symbol], t: Symbol) -> Expr:
    symbols: list[Symbol] = [s for s in f.free_symbols if isinstance(s, Symbol)]
    check_no_namesake(f, symbols, named, variables, t)
    _check_no_other_time(f, symbols, named, t)
    return in_own_time(f, variables, t)


def in_own_time(f: Expr, variables: Collection[Symbol], t: Symbol = time) -> Expr:
    """Return a function with the time in place of a symbol without assumptions of its name, which is no variable.

    Examples
    --------
    >>> bare = Symbol("t")
    >>> in_own_time(2 * bare, []) == 2 * time, in_own_time(2 * bare, [bare]) == 2 * bare
    (True, True)
    """
    bare = Symbol(t.name)
    if bare not in f.free_symbols or bare in variables:  # in this order: there may be thousands of variables
        return f
    return exchanged(f, {bare: t})


def check_none_is_the_time(variables: Sequence[Symbol], call: str, t: Symbol) -> None:
    """Refuse a variable whose symbol is that of the time: nothing could tell which of them is meant.

    Parameters
    ----------
    call
        How the system is written, such as ``"Hamiltonian(H, q, p"``, to show where another time is given.

    Examples
    --------
    >>> check_none_is_the_time([time], "PoissonSystem(H, x, structure", time)
    Traceback (most recent call last):
        ...
    ValueError: the variable t is the symbol of the time too: give it another name, or the time another symbol, Pois...
    """
    if not any(x.name == t.name and x == t for x in variables):  # names first: there may be thousands
        return
    taken = {x.name for x in variables}
    other = next((name for name in ("s", "tau", "sigma") if name not in taken), "another name")
    raise ValueError(
        f"the variable {t} is the symbol of the time too: give it another name, or the time another symbol, "
        f"{call}, t=Symbol({other!r}, real=True))"
    )


def check_none_reads_as_the_time(variables: Sequence[Symbol], call: str, t: Any) -> None:
    """Refuse the same, and a symbol without assumptions that :func:`plain` takes for the time by its name."""
    for clock in (t, Symbol(t.name)) if isinstance(t, Symbol) else ():  # what else it is is told of elsewhere
        check_none_is_the_time(variables, call, clock)


def _rate_named(name: str, coordinates: Mapping[str, Symbol]) -> Symbol | None:
    """Return the rate of a coordinate that has this name; of thousands of coordinates few are asked for."""
    of, _, what = name.rpartition("_")
    if what not in ("dot", "ddot") or of not in coordinates:
        return None
    return (velocity if what == "dot" else acceleration)(coordinates[of])


def _check_no_rate_of_symbols(f: Expr, named: Mapping[str, Symbol], t: Symbol) -> None:
    """Refuse a derivative by the time of an expression in coordinates: symbols are constant in it, rates are meant."""
    for d in f.atoms(Derivative) if t.name not in named else ():
        by_time = any(isinstance(v, Symbol) and v.name == t.name for v in d.variables)
        moving = sorted(s.name for s in d.expr.free_symbols if isinstance(s, Symbol) and s.name in named)
        if by_time and moving and not isinstance(d.expr, AppliedUndef):
            raise ValueError(
                f"{d} takes the symbol {moving[0]} for a constant: write its rate as {moving[0]}.dot, or give "
                f"functions of {t} instead, as SymPy's dynamicsymbols are"
            )


def _with_derivatives_taken(f: Expr) -> Expr:
    """Return f with the derivatives taken that SymPy leaves as they are written, but for those of plain functions.

    With symbols in place of functions of the time they would be derivatives of constants.
    """
    written = {
        d: d.doit(integrals=False)
        for d in f.atoms(Derivative)
        if not (
            isinstance(d.expr, AppliedUndef) and all(isinstance(argument, Symbol) for argument in d.expr.args)
        )
    }
    return exchanged(f, written) if written else f


def plain(f: Any, q: Sequence[Symbol], t: Symbol = time, *, keep_sums: bool = False) -> Expr:
    """Return an expression with canon's symbols for dynamicsymbols of these coordinates, their rates and the time.

    A function of one symbol whose name is that of a coordinate is that coordinate. Symbols named as rates
    (``theta_dot``) become the rates, and a symbol without assumptions named as the time, which ``dynamicsymbols._t``
    is, becomes the time. Sums over rows are written out where they are not to be kept, and derivatives such as
    ``Derivative(theta**2, t)`` are taken before theta is a symbol.

    Raises
    ------
    ValueError
        Where another symbol has the name of a coordinate or of the time, or a derivative by the time that SymPy left
        as it was written holds coordinates as symbols.

    Examples
    --------
    >>> from canon import coordinates
    >>> from sympy.physics.mechanics import dynamicsymbols
    >>> theta = coordinates("theta")
    >>> plain(dynamicsymbols("theta", 1) ** 2 + dynamicsymbols("theta"), [theta]) == theta.dot**2 + theta
    True
    """
    expression = given_expression(f)
    if not keep_sums:
        expression = written_out(expression)
    given_kind(t, Symbol, "the time", "give a domain and the like by their names")
    named = {s.name: s for s in q}
    symbols, functions = symbols_and_functions(expression)
    if t in symbols or Symbol(t.name) in symbols:
        _check_no_rate_of_symbols(expression, named, t)
    if functions:
        expression = _with_derivatives_taken(expression)
        symbols, functions = symbols_and_functions(expression)
    applied = {
        g: named[g.func.__name__]
        for g in functions
        if g.func.__name__ in named and len(g.args) == 1 and isinstance(g.args[0], Symbol)
    }
    clocks: dict[Symbol, Symbol] = {}
    for g, s in applied.items():
        clock: Any = g.args[0]
        clocks[clock] = t
        expression = without_dynamicsymbols(expression, {g: s}, clock)
    if applied:
        symbols, _ = symbols_and_functions(expression)
    others = {
        s for s in symbols if named.get(s.name) is not s
    }  # of a hundred thousand variables nothing is asked
    check_no_namesake(expression, others, named, q, t)
    _check_no_other_time(expression, others.difference(clocks), named, t)
    rates = (s for s in symbols if s.name.endswith("dot"))
    exact = {s: rate for s in rates if (rate := _rate_named(s.name, named)) is not None}
    meant = {Symbol(t.name): t, **clocks, **exact}
    return expression if symbols.isdisjoint(meant) else exchanged(expression, meant)
