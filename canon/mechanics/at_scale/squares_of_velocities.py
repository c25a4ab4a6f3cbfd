"""Lagrangians read as weighted squares of velocities: L = Σ ½ w u² + rest, u affine in q̇, w constant."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import sympy as sp

from canon.expression.symbols.symbol import velocity
from canon.mechanics.algebra.substitution import symbols_within
from canon.mechanics.at_scale.kinetic_terms import Channel

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from canon.mechanics.at_scale.kinetic_terms import Reader

__all__ = ["Squares", "squares_of_velocities"]


class Squares(NamedTuple):
    """The kinetic energy as channels, and what else the Lagrangian is."""

    channels: tuple[Channel, ...]
    rest: Expr


def squares_of_velocities(reader: Reader, L: Expr) -> Squares:
    """Return the terms of a Lagrangian that are weighted squares of velocities, and the sum of the others.

    Nothing is expanded but a factor in front of a sum of squares.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression.graph.graph import Graph
    >>> from canon.expression.symbols.symbol import time
    >>> from canon.mechanics.at_scale.kinetic_terms import Reader
    >>> from sympy import sin
    >>> x, phi = coordinates("x phi")
    >>> m = parameters("m", positive=True)
    >>> T = m * (x.dot**2 + (x.dot + sin(phi) * phi.dot)**2) / 2 + x**3 * phi.dot**2
    >>> found = squares_of_velocities(Reader(Graph(), (x, phi), time), T)
    >>> sorted(len(c.slopes) for c in found.channels), found.rest
    ([1, 2], phi_dot**2*x**3)
    """
    search = _Search(reader)
    channels: list[Channel] = []
    rest: list[Expr] = []
    for term in sp.Add.make_args(L):
        found = search.channels(term, sp.S.One)
        if found is None:
            rest.append(term)
        else:
            channels += found
    return Squares(tuple(channels), sp.Add(*rest))


class _Affine(NamedTuple):
    """Pairs (i, aᵢ) and terms of a₀ of a velocity."""

    slopes: list[tuple[int, int]]
    rest: list[int]


class _Search:
    """What a reader has read already."""

    def __init__(self, reader: Reader) -> None:
        self.reader, self.graph = reader, reader.graph
        self.number: dict[Expr, int] = {velocity(s): i for i, s in enumerate(reader.q)}
        self.varying = {*reader.q, *self.number, reader.t}
        self._known: dict[tuple[Expr, Expr], _Affine | None] = {}
        self._seen: dict[sp.Basic, frozenset[Symbol]] = {}

    def channels(self, term: Expr, weight: Expr, speed: Expr = sp.S.One) -> list[Channel] | None:
        """Return the channels of weight · speed² times a term of L; None where it is no sum of squares."""
        factors, moving = self._parted(term)
        taken = self._weighed(factors, weight, speed)
        if taken is None or len(moving) != 1:
            return None
        if isinstance(moving[0], sp.Add):
            found = [self.channels(each, *taken) for each in moving[0].args]
            return None if None in found else [c for each in found for c in each or ()]
        if not isinstance(moving[0], sp.Pow) or moving[0].exp != 2:
            return None
        u = self._affine(moving[0].base, taken[1])
        return None if u is None else [self._channel(self.reader.node(2 * taken[0]), u)]

    def _weighed(self, factors: list[Expr], weight: Expr, speed: Expr) -> tuple[Expr, Expr] | None:
        """Return weight and speed with constant factors, and roots of squares, taken in; None where others are left."""
        for factor in factors:
            if self.varying.isdisjoint(self._symbols(factor)):
                weight = weight * factor
            elif isinstance(factor, sp.Pow) and factor.exp.is_Integer and factor.exp.is_even:
                speed = speed * factor.base ** (factor.exp / 2)
            else:
                return None
        return weight, speed

    def _symbols(self, f: Expr) -> frozenset[Symbol]:
        return symbols_within(f, self._seen)

    def _parted(self, term: Expr) -> tuple[list[Expr], list[Expr]]:
        """Return the factors without and with velocities."""
        parts: tuple[list[Expr], list[Expr]] = ([], [])
        for factor in sp.Mul.make_args(term):
            parts[not self.number.keys().isdisjoint(self._symbols(factor))].append(factor)
        return parts

    def _channel(self, weight: int, u: _Affine) -> Channel:
        rest = self.graph.plain_add(u.rest) if u.rest else None
        return Channel(
            weight, tuple(sorted(u.slopes)), rest, is_rate=rest is None and self._is_rate(u.slopes)
        )

    def _is_rate(self, slopes: list[tuple[int, int]]) -> bool:
        """Tell whether each slope depends on its own coordinate alone; others may be rates too."""
        graph, q = self.graph, self.reader.q
        places = graph.mask((*q, self.reader.t))
        return all(not graph.masks[a] & places & ~graph.mask((q[i],)) for i, a in slopes)

    def _affine(self, u: Expr, factor: Expr) -> _Affine | None:
        """Return the slopes of a sum times a factor, None where it is not affine in the velocities."""
        found = _Affine([], [])
        for term in sp.Add.make_args(u):
            part = self._term(term, factor)
            if part is None:
                return None
            found.slopes.extend(part.slopes)
            found.rest.extend(part.rest)
        return found

    def _term(self, term: Expr, factor: Expr) -> _Affine | None:
        key = (term, factor)
        if key not in self._known:
            self._known[key] = self._read(term, factor)
        return self._known[key]

    def _read(self, term: Expr, factor: Expr) -> _Affine | None:
        others, moving = self._parted(term)
        coefficient = sp.Mul(factor, *others)
        if not moving:
            return _Affine([], [self.reader.node(coefficient)])
        if len(moving) > 1:
            return None
        if moving[0] in self.number:
            return _Affine([(self.number[moving[0]], self.graph.apart(self.reader.node(coefficient)))], [])
        return self._affine(moving[0], coefficient) if isinstance(moving[0], sp.Add) else None
