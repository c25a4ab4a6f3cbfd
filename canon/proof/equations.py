"""Two systems of equations: have they the same solutions at generic points?"""

from __future__ import annotations

import random
import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import acb, acb_mat
from sympy.core.function import AppliedUndef

from canon.proof.anatomy import anatomy
from canon.proof.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain import EVERYWHERE, Domain
from canon.proof.examples import with_example_functions
from canon.proof.vanish import vanishes
from canon.proof.verdict import Evidence, Status, Verdict

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol

__all__ = ["equivalent_equations"]

WORKING_BITS = 256
POINTS = 12


@dataclass(frozen=True)
class _System:
    """An affine system as the rows of its augmented matrix (coefficients of the unknowns, then the rest)."""

    rows: tuple[tuple[Expr, ...], ...]


@dataclass(frozen=True)
class _Pivots:
    """Rows and columns of a minor that is certainly nonzero, as large as was found."""

    rows: tuple[int, ...]
    columns: tuple[int, ...]


def equivalent_equations(
    system_a: Sequence[Expr],
    system_b: Sequence[Expr],
    unknowns: Sequence[Symbol],
    domain: Domain = EVERYWHERE,
    budget: float = 10.0,
) -> Verdict:
    """Decide whether two systems, each expression meaning ``expr = 0``, have the same solutions.

    Both must be affine in ``unknowns``; the remaining symbols are coefficients. The systems are
    equivalent at generic points exactly when their augmented matrices span one row space over the
    functions of those symbols: every row of either then has vanishing determinants when it borders a
    largest nonvanishing minor of the other.

    Parameters
    ----------
    system_a, system_b
        Expressions; the numbers of equations may differ.
    unknowns
        What is solved for, such as accelerations.
    domain, budget
        As for :func:`canon.proof.vanishes`.

    Returns
    -------
    Verdict
        FAILS names the equation of one system that does not follow from the other.

    Raises
    ------
    ValueError
        If an equation is not affine in the unknowns.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y, u, v = symbols("x y u v")
    >>> equivalent_equations([u + v - x, u - v], [2*u - x, u*y - v*y], [u, v]).status
    <Status.HOLDS: 'holds'>
    >>> print(equivalent_equations([u - x, v], [u - x], [u, v]).feedback)
    equation 2 of the first system does not follow from the second: v = 0
    """
    start = time.monotonic()
    deadline = start + budget
    a = _augmented(system_a, unknowns, domain, "first")
    b = _augmented(system_b, unknowns, domain, "second")
    extra = _rows_follow(b, a, system_b, ("second", "first"), domain, deadline)
    if extra.fails:
        return replace(extra, seconds=time.monotonic() - start)
    missing = _rows_follow(a, b, system_a, ("first", "second"), domain, deadline)
    worst = missing if missing.fails or extra.holds else extra
    return replace(worst, seconds=time.monotonic() - start)


def _augmented(system: Sequence[Expr], unknowns: Sequence[Symbol], domain: Domain, which: str) -> _System:
    at_rest = dict.fromkeys(unknowns, sp.Integer(0))
    rows: list[tuple[Expr, ...]] = []
    for number, equation in enumerate(system, start=1):
        expr = equation + sp.Integer(0)
        row: list[Expr] = []
        for u in unknowns:
            slope = cast("Expr", expr.diff(u))
            if slope.free_symbols & set(unknowns):
                if not all(vanishes(slope.diff(w), domain, 2.0).holds for w in unknowns):
                    raise ValueError(
                        f"equation {number} of the {which} system is not affine in {u}: {expr} = 0; "
                        "solve it for the unknowns or name others"
                    )
                slope = cast("Expr", slope.xreplace(at_rest))
            row.append(slope)
        row.append(cast("Expr", expr.xreplace(at_rest)))
        rows.append(tuple(row))
    return _System(tuple(rows))


def _rows_follow(
    rows: _System,
    basis: _System,
    equations: Sequence[Expr],
    names: tuple[str, str],
    domain: Domain,
    deadline: float,
) -> Verdict:
    """Decide whether every row of one system lies in the row space of the other."""
    pivots = _largest_minor(basis, domain)
    assumed = ("generic point: the coefficients' largest minor is not zero",)
    undecided: Verdict | None = None
    for number, row in enumerate(rows.rows):
        for bordered in _borders(row, basis, pivots):
            verdict = vanishes(_determinant(bordered), domain, max(0.1, deadline - time.monotonic()))
            if verdict.fails and not _minor_is_largest(basis, pivots, domain, deadline):
                verdict = Verdict(
                    Status.UNDECIDED,
                    evidence=(Evidence("rank", f"the rank of the {names[1]} system is not known"),),
                )
            if verdict.fails:
                equation = equations[number]
                return replace(
                    verdict,
                    residual=equation,
                    feedback=f"equation {number + 1} of the {names[0]} system does not follow from the "
                    f"{names[1]}: {equation} = 0",
                )
            if verdict.undecided:
                undecided = (
                    undecided
                    if undecided is not None
                    else replace(
                        verdict,
                        evidence=(
                            *verdict.evidence,
                            Evidence(
                                "equation", f"whether equation {number + 1} of the {names[0]} system follows"
                            ),
                        ),
                    )
                )
    return undecided if undecided is not None else Verdict(Status.HOLDS, certificate="exact", assumed=assumed)


def _borders(row: tuple[Expr, ...], basis: _System, pivots: _Pivots) -> Iterator[list[list[Expr]]]:
    """Border the pivots' minor with a row and, in turn, each column outside it."""
    for column in range(len(row)):
        if column not in pivots.columns:
            columns = (*pivots.columns, column)
            yield [*([basis.rows[i][c] for c in columns] for i in pivots.rows), [row[c] for c in columns]]


def _minor_is_largest(basis: _System, pivots: _Pivots, domain: Domain, deadline: float) -> bool:
    """Tell whether every row of the basis is proved to depend on the pivots' rows.

    Without that a row outside the pivots' span may still follow from the basis.
    """
    return all(
        vanishes(_determinant(bordered), domain, max(0.1, deadline - time.monotonic())).holds
        for number, row in enumerate(basis.rows)
        if number not in pivots.rows
        for bordered in _borders(row, basis, pivots)
    )


def _largest_minor(system: _System, domain: Domain) -> _Pivots:
    """Find the largest minor that balls certify as nonzero at some point of the domain."""
    best = _Pivots((), ())
    if not system.rows:
        return best
    symbols = anatomy([entry for row in system.rows for entry in row]).symbols
    system = _with_examples(system)
    full = min(len(system.rows), len(system.rows[0]))
    for point in domain.points(symbols, POINTS, seed=3):
        found = _pivots_at(system, point)
        if len(found.rows) > len(best.rows):
            best = found
        if len(best.rows) == full:
            break
    return best


def _with_examples(system: _System) -> _System:
    """Put examples for the arbitrary functions: a minor that is nonzero for one choice is not zero."""
    entries = [entry for row in system.rows for entry in row]
    if any(entry.has(AppliedUndef) for entry in entries):
        entries, _ = with_example_functions(entries, random.Random(3))
    width = len(system.rows[0])
    return _System(tuple(tuple(entries[i : i + width]) for i in range(0, len(entries), width)))


def _pivots_at(system: _System, point: dict[Symbol, sp.Rational]) -> _Pivots:
    with precision(WORKING_BITS):
        memo: dict[sp.Basic, acb] = {}
        try:
            matrix = [[value(entry, point, memo) for entry in row] for row in system.rows]
        except (Undefined, NotDecided, Unmodelled):
            return _Pivots((), ())
        rows: list[int] = []
        columns: list[int] = []
        for column in range(len(matrix[0])):
            for i in range(len(matrix)):
                if i in rows:
                    continue
                minor = acb_mat([[matrix[r][c] for c in (*columns, column)] for r in (*rows, i)])
                if not minor.det().contains(0):
                    rows.append(i)
                    columns.append(column)
                    break
        return _Pivots(tuple(rows), tuple(columns))


def _determinant(matrix: list[list[Expr]]) -> Expr:
    """Return the determinant by Laplace's expansion along the rows, minors shared."""
    size = len(matrix)
    minors: dict[tuple[int, ...], Expr] = {(): sp.Integer(1)}
    for depth in range(size):
        row = matrix[size - 1 - depth]
        larger: dict[tuple[int, ...], Expr] = {}
        for columns, minor in minors.items():
            for c in range(size):
                if c not in columns and row[c] != 0 and minor != 0:
                    chosen = tuple(sorted((*columns, c)))
                    sign = (-1) ** chosen.index(c)
                    larger[chosen] = larger.get(chosen, sp.Integer(0)) + sign * row[c] * minor
        minors = larger
    return minors.get(tuple(range(size)), sp.Integer(0))
