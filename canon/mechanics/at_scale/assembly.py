"""Assembly of the equations of motion: mass matrix, projected forces, slopes of the kinetic energy as sums of terms."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

import sympy as sp

from canon.expression.graph.pythagoras import without_squares
from canon.expression.graph.sums import SharedSums, signed_product
from canon.expression.symbols.symbol import velocity

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from sympy import Expr

    from canon.mechanics.at_scale.kinetic_terms import Channel, Reader
    from canon.mechanics.lagrange.body import Body

__all__ = ["Assembly"]

_Slope = tuple[int, int, int]
"""A coordinate's number, the node of the slope, and how often it occurred in the channel before."""


class Assembly:
    """The nodes that equations of motion are assembled from.

    Parameters
    ----------
    reader
        The graph with coordinates and time.
    channels
        What the kinetic energy consists of.
    """

    def __init__(self, reader: Reader, channels: Sequence[Channel]) -> None:
        self.reader, self.graph, self.channels = reader, reader.graph, channels
        self.q, self.v = reader.q, [reader.graph.symbol(velocity(s)) for s in reader.q]
        self.sums = SharedSums(reader.graph)
        self._rates: dict[tuple[int, int], list[int]] = {}
        self._products: dict[tuple[int, int], int] = {}
        self._slopes: dict[tuple[int, int], list[tuple[int, int]]] = {}
        self._places = reader.graph.mask(reader.q)
        self._moving = tuple(zip(self.q, self.v, strict=True))

    def heights(self, bodies: Sequence[Body], field: Sequence[Expr]) -> list[int]:
        """Return the energy −m g·r of each body in a uniform field."""
        graph, reader = self.graph, self.reader
        energies: list[int] = []
        for body in bodies:
            for g, place in zip(field, body.r, strict=False):
                if g != 0:
                    terms = tuple(sorted(reader.node(term) for term in sp.Add.make_args(place)))
                    factors = (
                        reader.node(body.m),
                        reader.node(sp.sympify(g, strict=True)),
                        self.sums.of(terms),
                    )
                    energies.append(graph.negative(graph.plain_mul(factors)))
        return energies

    def rate(self, node: int, factor: int) -> list[int]:
        """Return the terms of the rate of a function of q and t times a factor, products of velocities shared."""
        graph = self.graph
        found = self._rates.get((node, factor))
        if found is None:
            symbols = graph.symbols(node)
            found = self._rates[node, factor] = [
                signed_product(graph, (self.reader.derivative(node, s), graph.plain_mul((v, factor))))
                for s, v in self._moving
                if s in symbols
            ]
            if self.reader.t in symbols:
                found.append(graph.plain_mul((self.reader.derivative(node, self.reader.t), factor)))
        return found

    def speed(self, c: Channel) -> int:
        """Return u = Σ a q̇ + a₀."""
        terms = [self._product(a, i) for i, a in c.slopes]
        return self.sums.of(tuple(terms) if c.rest is None else (*terms, c.rest))

    def _product(self, a: int, i: int) -> int:
        found = self._products.get((a, i))
        if found is None:
            found = self._products[a, i] = self.graph.plain_mul((a, self.v[i]))
        return found

    def excess(self, c: Channel) -> int:
        """Return u̇ without accelerations, less what the field gives: Σ Dₜa q̇ + Dₜa₀ − load.

        The field stands first, so that bodies of a chain add it once.
        """
        terms = [] if c.load is None else [self.graph.negative(c.load)]
        terms += [term for i, a in c.slopes for term in self.rate(a, self.v[i])]
        if c.rest is not None:
            terms += self.rate(c.rest, self.graph.one)
        return self.sums.of(tuple(term for term in terms if term != self.graph.zero))

    def projected(self, along: Sequence[int]) -> list[int]:
        """Return Σ a F for each coordinate, terms with the same a put together first."""
        zero = self.graph.zero
        grouped: list[dict[int, list[int]]] = [defaultdict(list) for _ in self.q]
        for c, F in zip(self.channels, along, strict=True):
            if zero != F:
                for i, a in c.slopes:
                    grouped[i][a].append(F)
        return [self._collected(group) for group in grouped]

    def _collected(self, group: dict[int, list[int]]) -> int:
        return self.graph.plain_add(
            [signed_product(self.graph, (a, self.sums.of(tuple(terms)))) for a, terms in group.items()]
        )

    def slopes_of_T(self, momentum: Sequence[int]) -> list[int]:
        """Return ∂T/∂q = Σ w u ∂u/∂q at fixed velocities."""
        zero = self.graph.zero
        grouped: list[dict[int, list[int]]] = [defaultdict(list) for _ in self.q]
        for c, w in zip(self.channels, momentum, strict=True):
            for i, slope in self._slopes_of_speed(c):
                if slope != zero:
                    grouped[i][slope].append(w)
        return [self._collected(group) for group in grouped]

    def _slopes_of_speed(self, c: Channel) -> Iterable[tuple[int, int]]:
        """Yield pairs (i, ∂u/∂qᵢ), one a term."""
        for j, a in c.slopes:
            yield from self._slopes_of(a, self.v[j])
        if c.rest is not None:
            yield from self._slopes_of(c.rest, self.graph.one)

    def _slopes_of(self, a: int, factor: int) -> list[tuple[int, int]]:
        """Return pairs (i, ∂a/∂qᵢ · factor)."""
        found = self._slopes.get((a, factor))
        if found is None:
            graph, symbols = self.graph, self.graph.symbols(a)
            found = self._slopes[a, factor] = [
                (i, graph.plain_mul((self.reader.derivative(a, s), factor)))
                for i, s in enumerate(self.q)
                if s in symbols
            ]
        return found

    def not_a_rate(self, c: Channel) -> Iterable[tuple[int, int]]:
        """Yield pairs (i, −w u (Dₜaᵢ − ∂u/∂qᵢ)), which vanish where u is a rate."""
        if c.is_rate:
            return
        terms: dict[int, list[int]] = defaultdict(list)
        for i, a in c.slopes:
            terms[i].extend(map(self.graph.negative, self.rate(a, self.graph.one)))
        for i, slope in self._slopes_of_speed(c):
            terms[i].append(slope)
        for i, parts in terms.items():
            total = self.graph.add(parts)
            if total != self.graph.zero:
                momentum = self.graph.plain_mul((c.weight, self.speed(c)))
                yield i, self.graph.plain_mul((momentum, total))

    def mass_matrix(self) -> tuple[tuple[int, ...], ...]:
        """Return Σ w aᵢ aⱼ, i ≥ j: the weights that a pair of slopes shares are added and put to aᵢ first.

        In a chain the weights beyond link i depend on i alone, so w aᵢ serves the whole row.
        """
        channels_of, slopes_in = self._occurrences()
        weights: dict[int, int] = {}
        entries: list[list[list[tuple[int, int, int]]]] = [
            [[] for _ in range(i + 1)] for i in range(len(self.q))
        ]
        for k, slopes in enumerate(slopes_in):
            earlier = (1 << k) - 1
            for x, slope in enumerate(slopes):
                i, a, _ = slope
                own = channels_of[slope]
                for other in slopes[: x + 1]:
                    common = own & channels_of[other]
                    if common & earlier:
                        continue  # the pair was met before, and its weights were added then
                    j, b, _ = other
                    weight = weights.get(common)
                    if weight is None:
                        weight = weights[common] = self._weight(common)
                    entries[i][j] += [(weight, a, b)] * (2 if i == j and slope != other else 1)
        return tuple(tuple(map(self._entry, row)) for row in entries)

    def _entry(self, products: list[tuple[int, int, int]]) -> int:
        """Return Σ w a b, cos² + sin² = 1 used where a and b depend on the same coordinates."""
        masks, mul = self.graph.masks, self.graph.plain_mul
        if any(masks[a] & masks[b] & self._places for _, a, b in products):
            united = without_squares(self.graph, products)
            if united is not None:
                return united
        return self.graph.plain_add([mul((mul((w, a)), b)) for w, a, b in products])

    def _occurrences(self) -> tuple[dict[_Slope, int], list[list[_Slope]]]:
        """Return the channels of each slope as bits, and the slopes of each channel by rising i.

        A slope that occurs twice in a channel counts as two.
        """
        channels_of: dict[_Slope, int] = {}
        slopes_in: list[list[_Slope]] = []
        for k, c in enumerate(self.channels):
            slopes: list[_Slope] = []
            for i, a in sorted(c.slopes):
                again = slopes[-1][2] + 1 if slopes and slopes[-1][:2] == (i, a) else 0
                slopes.append((i, a, again))
                channels_of[i, a, again] = channels_of.get((i, a, again), 0) | 1 << k
            slopes_in.append(slopes)
        return channels_of, slopes_in

    def _weight(self, channels: int) -> int:
        """Return the sum of the weights of channels given as bits."""
        return self.sums.of(tuple([c.weight for k, c in enumerate(self.channels) if channels >> k & 1]))
