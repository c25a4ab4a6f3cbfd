"""Largest minor of a matrix that balls certify as nonzero, and determinants of expressions."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import sympy as sp
from flint import acb, acb_mat
from sympy import Expr
from sympy.core.function import AppliedUndef

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.refute.sample_functions import with_example_functions
from canon.proof.trees.anatomy import anatomy

if TYPE_CHECKING:
    from sympy import Symbol

    from canon.proof.domain.domain import Domain

__all__ = ["Pivots", "Rows", "determinant", "largest_minor"]

Rows: TypeAlias = tuple[tuple[Expr, ...], ...]
"""The rows of a matrix."""

WORKING_BITS = 256
POINTS = 12


@dataclass(frozen=True)
class Pivots:
    """Rows and columns of a minor that is certainly nonzero, as large as was found; the rest's comes last."""

    rows: tuple[int, ...]
    columns: tuple[int, ...]

    def left_of(self, column: int) -> Pivots:
        """Return the pivots without that of a last column."""
        kept = len(self.columns) - (column in self.columns)
        return Pivots(self.rows[:kept], self.columns[:kept])


def largest_minor(system: Rows, domain: Domain) -> Pivots:
    """Find the largest minor of slopes and rest that balls certify as nonzero at some point of the domain.

    The rest, the last column, is taken last: x u = 1 has no solution where x = 0, and one everywhere else.
    """
    best = Pivots((), ())
    if not system:
        return best
    symbols = anatomy([entry for row in system for entry in row]).symbols
    system = _with_examples(system)
    rest = len(system[0]) - 1
    most = (min(len(system), rest), min(len(system), rest + 1))
    for point in domain.points(symbols, POINTS, seed=3, but_functions=True):
        found = _pivots_at(system, point)
        best = max(best, found, key=lambda pivots: _ranks(pivots, rest))
        if _ranks(best, rest) == most:
            break
    return best


def _ranks(pivots: Pivots, rest: int) -> tuple[int, int]:
    return len(pivots.left_of(rest).rows), len(pivots.rows)


def _with_examples(system: Rows) -> Rows:
    """Put examples for the arbitrary functions: a minor that is nonzero for one choice is not zero."""
    entries = [entry for row in system for entry in row]
    if any(entry.has(AppliedUndef) for entry in entries):
        entries, _ = with_example_functions(entries, random.Random(3))
    width = len(system[0])
    return tuple(tuple(entries[i : i + width]) for i in range(0, len(entries), width))


def _pivots_at(system: Rows, point: dict[Symbol, sp.Rational]) -> Pivots:
    with precision(WORKING_BITS):
        memo: dict[sp.Basic, acb] = {}
        try:
            matrix = [[value(entry, point, memo) for entry in row] for row in system]
        except (Undefined, NotDecided, Unmodelled):
            return Pivots((), ())
        return _certified(matrix)


def _certified(matrix: list[list[acb]]) -> Pivots:
    """Take column by column the first row that keeps the minor of balls away from zero."""
    rows: list[int] = []
    columns: list[int] = []
    for column in range(len(matrix[0])):
        for i in (i for i in range(len(matrix)) if i not in rows):
            minor = acb_mat([[matrix[r][c] for c in (*columns, column)] for r in (*rows, i)])
            if not minor.det().contains(0):
                rows.append(i)
                columns.append(column)
                break
    return Pivots(tuple(rows), tuple(columns))


def determinant(matrix: list[list[Expr]]) -> Expr:
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
