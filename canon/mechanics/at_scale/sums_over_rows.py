"""Sums over chains, pairs and lattices, kept as one term: Hamiltonians of thousands of bodies in a line of code.

They are SymPy expressions and can be added, differentiated and put into a :class:`~canon.Hamiltonian`. Splittings step
them without writing them out; everything else sees them written out (:func:`written_out`).
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from sympy import Dummy

from canon.expression.symbols.input_in_words import described
from canon.expression.symbols.repeated_sum import RepeatedSum, sums_within, written_out
from canon.expression.symbols.user_input import given_expression

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from sympy import Expr

__all__ = ["chain_sum", "lattice_sum", "pair_sum", "row_sum", "written_out"]

_FIRST = 10**9
"""Numbers of the symbols that stand for arguments; the same sum is the same expression each time it is written."""


def row_sum(term: Callable[..., Any], *columns: Iterable[Any]) -> Expr:
    """Return Σ f(x_i, y_i, …) over rows, as ``map`` takes them.

    Parameters
    ----------
    term
        f, a function of as many expressions as there are columns.
    columns
        Symbols, numbers or expressions, as many in each.

    Raises
    ------
    ValueError
        The columns are empty or differ in length.

    Examples
    --------
    >>> from sympy import symbols
    >>> p, m = symbols("p0:3"), (1, 2, 3)
    >>> written_out(row_sum(lambda p, m: p**2/(2*m), p, m))
    p0**2/2 + p1**2/4 + p2**2/6
    """
    given = [tuple(column) for column in columns]
    lengths = {len(column) for column in given}
    if len(lengths) != 1 or lengths == {0}:
        counts = ", ".join(str(len(column)) for column in given) or "no columns"
        raise ValueError(f"columns of {counts} entries: give each as many, at least one")
    arguments = _arguments(len(given))
    return _summed(_term(term, arguments), arguments, [_entries(column) for column in given])


def chain_sum(term: Callable[[Any, Any], Any], sites: Sequence[Any]) -> Expr:
    """Return Σ f(x_i, x_{i+1}) over neighbours in a chain.

    Parameters
    ----------
    term
        f, a function of a site and the next one.
    sites
        Symbols and numbers in order: ``[0, *q, 0]`` is a chain between walls, ``[*q, q[0]]`` a ring.

    Raises
    ------
    ValueError
        There are fewer than two sites.

    Examples
    --------
    The Fermi–Pasta–Ulam–Tsingou chain of 1,000 sites between walls, and its first step:

    >>> from canon import Hamiltonian, Splitting, coordinates, propagate
    >>> q = coordinates("q1:1001")
    >>> p = [each.momentum for each in q]
    >>> V = chain_sum(lambda a, b: (b - a)**2/2 + (b - a)**4/40, [0, *q, 0])
    >>> H = Hamiltonian(row_sum(lambda p: p**2/2, p) + V, q, p)
    >>> y0 = [1.0] + [0.0]*1999
    >>> motion = propagate(H, (0, 0.1), y0, method=Splitting("verlet"), step=0.1, samples=1)
    >>> print(f"{motion.energies.values[0]:.3f} {motion.energy_change[-1]:.0e}")
    1.050 3e-04
    """
    entries = tuple(sites)
    if len(entries) < 2:
        raise ValueError(f"a chain of {len(entries)} sites has no neighbours; give two or more")
    return row_sum(term, entries[:-1], entries[1:])


def pair_sum(term: Callable[..., Any], bodies: Iterable[Any]) -> Expr:
    """Return Σ f(a, b) over the pairs of bodies, each pair once.

    Parameters
    ----------
    term
        f, a function of two bodies, each a tuple of what is given of it; or the symbol, where that alone is given.
    bodies
        What stands for each body: its coordinates, and numbers that differ from body to body such as its mass.

    Raises
    ------
    ValueError
        There are fewer than two bodies, or of some more is given than of others.

    Examples
    --------
    >>> from sympy import sqrt, symbols
    >>> bodies = list(zip(symbols("x0:3"), symbols("y0:3"), (5, 3, 2)))
    >>> def attraction(a, b):
    ...     (x, y, m), (X, Y, M) = a, b
    ...     return -m*M/sqrt((x - X)**2 + (y - Y)**2)
    >>> len(written_out(pair_sum(attraction, bodies)).args)
    3
    """
    given = list(bodies)
    alone = not any(_is_listed(body) for body in given)
    rows = [tuple(body) if _is_listed(body) else (body,) for body in given]
    if len(rows) < 2:
        raise ValueError(f"{len(rows)} bodies make no pair; give two or more")
    widths = {len(row) for row in rows}
    if len(widths) != 1:
        counts = ", ".join(map(str, sorted(widths)))
        raise ValueError(f"of some bodies more is given than of others ({counts} entries): give each as much")
    (width,) = widths
    arguments = _arguments(2 * width)
    value = _term(term, arguments if alone else [arguments[:width], arguments[width:]])
    return _summed(value, arguments, [_entries(column) for column in zip(*rows, strict=True)], pairs=True)


def lattice_sum(term: Callable[[Any, Any], Any], sites: Any, *, periodic: bool = False) -> Expr:
    """Return Σ f(x, x′) over nearest neighbours in a lattice, each bond once.

    Parameters
    ----------
    term
        f, a function of a site and its neighbour at the next place along an axis.
    sites
        Symbols as a list of rows, of lists of rows, …, or an array of objects, of any number of axes.
    periodic
        Whether the last site along an axis is a neighbour of the first.

    Raises
    ------
    ValueError
        The rows differ in length, or no two sites are neighbours.

    Examples
    --------
    >>> from sympy import symbols
    >>> x = symbols("x0:4")
    >>> written_out(lattice_sum(lambda a, b: a*b, [x[:2], x[2:]]))
    x0*x1 + x0*x2 + x1*x3 + x2*x3
    """
    rows = (
        sites if isinstance(sites, np.ndarray) else [list(row) if _is_listed(row) else row for row in sites]
    )
    array = np.array(rows, dtype=object)
    if any(_is_listed(each) for each in array.flat):
        raise ValueError("the rows of the lattice differ in length")
    first: list[Any] = []
    second: list[Any] = []
    for axis, length in enumerate(array.shape):
        if periodic and length > 2:
            first += list(array.flat)
            second += list(np.roll(array, -1, axis).flat)
        else:
            first += list(array.take(range(length - 1), axis).flat)
            second += list(array.take(range(1, length), axis).flat)
    if not first:
        raise ValueError(f"a lattice of shape {array.shape} has no neighbours")
    return row_sum(term, first, second)


def _arguments(count: int) -> list[Dummy]:
    """Return new symbols for so many arguments: no sum that stands in the term has them."""
    return [Dummy(f"x{k}", real=True) for k in range(count)]


def _summed(
    term: Expr, arguments: Sequence[Dummy], columns: Sequence[Sequence[Expr]], *, pairs: bool = False
) -> Expr:
    """Return the sum of a term, without the columns that it does not hold, in the symbols that it has every time."""
    width, held = len(columns), term.free_symbols
    used = [k for k in range(width) if held.intersection(arguments[k::width])]
    rows = len(columns[0])
    if not used:
        return term * (rows * (rows - 1) // 2 if pairs else rows)
    depth = 1 + max((each.depth for each in sums_within(term)), default=0)
    kept = [arguments[shift + k] for shift in range(0, len(arguments), width) for k in used]
    slots = _slots(len(kept), depth)
    renamed: Any = term.xreplace(dict(zip(kept, slots, strict=True)))
    return RepeatedSum(renamed, slots, [columns[k] for k in used], pairs)


@functools.cache
def _slots(count: int, depth: int) -> tuple[Dummy, ...]:
    """Return the symbols that stand for so many arguments, others the more sums stand in each other."""
    return tuple(Dummy(f"x{k}", dummy_index=_FIRST * depth + k, real=True) for k in range(count))


def _term(term: Callable[..., Any], arguments: Sequence[Any]) -> Expr:
    if not callable(term):
        raise TypeError(
            f"what is summed should be a function, such as lambda a, b: (b - a)**2/2, not {described(term)}"
        )
    return given_expression(term(*arguments), "the term of the sum")


def _is_listed(x: Any) -> bool:
    return hasattr(x, "__iter__") and not isinstance(x, sp.Basic)


def _entries(column: Iterable[Any]) -> list[Expr]:
    return [given_expression(each, "an argument of the sum") for each in column]
