"""Lattice spanned by the arguments of sines and cosines, and a basis of it."""

from __future__ import annotations

from math import lcm
from typing import TYPE_CHECKING

from flint import fmpq, fmpq_mat, fmpz_mat

if TYPE_CHECKING:
    from collections.abc import Hashable

    from sympy import Expr

__all__ = ["Angle", "Lattice"]

Angle = frozenset[tuple["Hashable", int, int]]
"""An argument: the key of each atom with numerator and denominator of its rational coefficient."""


class Lattice:
    """All whole combinations of the arguments that were added.

    The basis is the arguments themselves while they are independent: then cos A, cos B need no expansion
    in what A and B consist of. Dependent ones are replaced by a reduced basis (LLL), so that sin 2x,
    sin(x/3) and sin(x + y) are all written in few sines and cosines.

    Examples
    --------
    >>> lattice = Lattice()
    >>> x, third = frozenset({("x", 1, 1)}), frozenset({("x", 1, 3)})
    >>> lattice.add(x)
    True
    >>> lattice.coordinates(third) is None
    True
    >>> lattice.add(third)
    False
    >>> [times for _, times in lattice.coordinates(x)]
    [3]
    """

    def __init__(self) -> None:
        self.meaning: dict[Hashable, Expr] = {}
        self._atoms: dict[Hashable, int] = {}
        self._rows: list[Angle] = []
        self._basis: list[Angle] = []
        self._known: dict[Angle, list[tuple[Angle, int]]] = {}

    def number(self, key: Hashable) -> int:
        """Return the place of an atom, in the order in which they are first met."""
        return self._atoms.setdefault(key, len(self._atoms))

    def add(self, angle: Angle) -> bool:
        """Widen the lattice by one argument; tell whether the basis before is still part of the basis."""
        for key, _, _ in angle:
            self.number(key)
        self._rows.append(angle)
        common = lcm(*(q for row in self._rows for _, _, q in row))
        matrix = fmpz_mat([[int(c * common) for c in self._vector(row)] for row in self._rows])
        if matrix.rank() == len(self._rows):
            kept = self._basis == self._rows[:-1]
            self._basis = list(self._rows)
            self._known = self._known if kept else {}
            return kept
        reduced = matrix.hnf()
        rank = reduced.rank()
        short = fmpz_mat([[reduced[i, j] for j in range(reduced.ncols())] for i in range(rank)]).lll()
        rows = [[int(short[i, j]) for j in range(short.ncols())] for i in range(rank)]
        self._basis = [self._angle(row, common) for row in rows]
        self._rows = list(self._basis)
        self._known = {}
        return False

    def coordinates(self, angle: Angle) -> list[tuple[Angle, int]] | None:
        """Return base angles and whole multiples that add up to an argument, if it lies in the lattice."""
        found = self._known.get(angle) or self._solved(angle)
        if found is not None:
            self._known[angle] = found
        return found

    def _solved(self, angle: Angle) -> list[tuple[Angle, int]] | None:
        if angle in self._basis:
            return [(angle, 1)]
        if not self._basis or any(key not in self._atoms for key, _, _ in angle):
            return None
        columns = [self._vector(row) for row in (*self._basis, angle)]
        size = len(self._basis)
        rows = fmpq_mat([[column[k] for column in columns] for k in range(len(self._atoms))])
        solved, rank = rows.rref()
        if rank > size:
            return None
        found = [solved[k, size] for k in range(size)]
        if any(c.q != 1 for c in found):
            return None
        return [(base, int(c.p)) for base, c in zip(self._basis, found, strict=True) if c != 0]

    def _vector(self, angle: Angle) -> list[fmpq]:
        entries = [fmpq(0)] * len(self._atoms)
        for key, p, q in angle:
            entries[self._atoms[key]] = fmpq(p, q)
        return entries

    def _angle(self, row: list[int], common: int) -> Angle:
        keys = list(self._atoms)
        entries = [(key, fmpq(c, common)) for key, c in zip(keys, row, strict=True) if c]
        sign = 1 if entries[0][1] > 0 else -1
        return frozenset((key, sign * int(c.p), int(c.q)) for key, c in entries)
