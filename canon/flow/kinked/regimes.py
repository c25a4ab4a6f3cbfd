"""Regimes of equations with kinks: the smooth equations between the zeros of what stands under sign and Abs.

Moduli, maxima, steps and dry friction are smooth but for the zeros of their switching functions g, which are the
arguments of ``sign`` and ``Abs`` on the graph. A regime says of which sign each of them is; with these signs put in,
the equations are smooth, and so is their continuation a little beyond the zeros. A switching function may hold others:
|(|x| − 1)| has those of x and, in each regime of x, of x − 1 or −x − 1.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING

from canon.cached_property import cached_property
from canon.expression.graph.algebra import factored
from canon.flow.kinked.equivalent_control import shares_that_hold
from canon.flow.kinked.regime_signs import HELD, held_in, put

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.expression.graph.graph import Graph, Node
    from canon.flow.kinked.regime_signs import Signs
    from canon.flow.run.event import PreparedEvent
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["Kinks", "Regime", "kinks_of"]

_KEPT = 256

_DERIVATIVES = 6
"""So many time derivatives are looked through for the first that differs on two sides."""


@dataclass(frozen=True, eq=False)
class Regime:
    """Smooth equations, and the switching functions that end them.

    Parameters
    ----------
    signs
        The signs of all switching functions.
    system
        The equations with these signs.
    functions
        The nodes of the switching functions in this regime, by their number: of those that matter in it.
    """

    signs: Signs
    system: HamiltonEquations
    functions: Mapping[int, int]

    @functools.lru_cache(maxsize=_KEPT)  # noqa: B019 - regimes live as long as their run
    def rate(self, node: int) -> int:
        """Return dg/dt of a node along the motion in this regime."""
        graph, system = self.system.graph, self.system
        slopes = graph.gradient(node, system.inputs)
        rates = (*system.velocity, *system.force, graph.one)
        return graph.add([graph.mul(pair) for pair in zip(slopes, rates, strict=True)])

    @cached_property
    def weak(self) -> frozenset[int]:
        """The switching functions at whose zeros the rates have no Taylor series, as g^(3/2) of Hertz's contact."""
        graph = self.system.graph
        roots = {
            _direction(graph, node.operands[0])
            for node in map(graph.nodes.__getitem__, graph.reachable(self.system.rates))
            if node.kind == "pow" and not _is_whole(graph.nodes[node.operands[1]])
        }
        return frozenset(k for k, g in self.functions.items() if _direction(graph, g) in roots)


def _is_whole(node: Node) -> bool:
    return node.kind == "number" and node.value.denominator == 1


def _direction(graph: Graph, node: int) -> frozenset[tuple[int, Fraction]]:
    """Return what a function and its multiples have in common, sums within sums being added up."""
    terms: dict[int, Fraction] = {}

    def add(part: int, times: Fraction) -> None:
        factor, rest = factored(graph, part)
        if rest is None:
            terms[graph.one] = terms.get(graph.one, Fraction(0)) + times * factor
        elif graph.nodes[rest].kind == "add":
            for operand in graph.nodes[rest].operands:
                add(operand, times * factor)
        else:
            terms[rest] = terms.get(rest, Fraction(0)) + times * factor

    add(node, Fraction(1))
    left = {part: times for part, times in terms.items() if times}
    unit = left[min(left)] if left else Fraction(1)
    return frozenset((part, times / unit) for part, times in left.items())


@dataclass(frozen=True, eq=False)
class Kinks:
    """The switching functions of equations with kinks.

    Parameters
    ----------
    system
        The equations, with ``sign`` and ``Abs``.
    kinks
        The nodes of ``sign`` and ``Abs``, those inside others first: which switching function each has, and whether
        with the same sign or the other.
    functions
        The nodes of the switching functions, which may hold others.
    """

    system: HamiltonEquations
    kinks: Mapping[int, tuple[int, int]]
    functions: tuple[int, ...]

    @cached_property
    def _kept(self) -> dict[Signs, Regime]:
        return {}

    @cached_property
    def _shares(self) -> dict[Signs, Mapping[int, int] | None]:
        return {}

    @cached_property
    def _mattering(self) -> dict[Signs, tuple[int, ...]]:
        return {}

    @cached_property
    def nested(self) -> frozenset[int]:
        """The switching functions that hold others."""
        graph = self.system.graph
        return frozenset(
            k
            for k, g in enumerate(self.functions)
            if any(node in self.kinks for node in graph.reachable([g]))
        )

    def regime(self, signs: Signs) -> Regime:
        """Return the equations of a regime, made once."""
        if signs not in self._kept:
            self._kept[signs] = self._held(signs) if HELD in signs else self._made(signs)
        return self._kept[signs]

    def _made(self, signs: Signs) -> Regime:
        mattering = self.mattering(signs)
        folded = self.folded(signs, [self.functions[k] for k in mattering])
        return Regime(signs, self._system(signs), dict(zip(mattering, folded, strict=True)))

    def mattering(self, signs: Signs) -> tuple[int, ...]:
        """Return the switching functions that the equations depend on in a regime, in rising order.

        Where a product vanishes one of its vanishing factors matters: when that changes, the others are looked at.
        """
        if signs not in self._mattering:
            self._mattering[signs] = self._found(signs)
        return self._mattering[signs]

    def _found(self, signs: Signs) -> tuple[int, ...]:
        graph = self.system.graph
        roots = [*self._rates(self.system), self.system.hamiltonian]
        image, found, seen, waiting = self._images(signs, roots), set[int](), set[int](), list(roots)
        while waiting:
            each = waiting.pop()
            if each in seen:
                continue
            seen.add(each)
            if each in self.kinks:
                found.add(self.kinks[each][0])
            kind, operands, _ = graph.nodes[each]
            if kind == "mul" and image[each] == graph.zero:
                nothing = [o for o in operands if image[o] == graph.zero]
                waiting += [] if seen & {*nothing} else nothing[:1]
            else:
                waiting += operands
        return tuple(sorted(found))

    def _images(self, signs: Signs, roots: Sequence[int]) -> dict[int, int]:
        """Return every node that some are computed from, as it is in a regime."""
        nodes = self.system.graph.reachable(roots)
        return dict(zip(nodes, self.folded(signs, nodes), strict=True))

    def _held(self, signs: Signs) -> Regime:
        """Return the motion on a zero that both sides lead to: the mean of their rates that stays on it.

        A. F. Filippov, Differential Equations with Discontinuous Righthand Sides, Kluwer 1988, § 4. It ends where one
        side does not lead there any more.
        """
        if len(held_in(signs)) > 1:
            return self._held_together(signs)
        k, graph = signs.index(HELD), self.system.graph
        if self.rate_at_rest(signs, k) is not None:
            return self._resting(signs, k)
        above, below = self._sides(signs, k)
        zero = self.folded(above.signs, [self.functions[k]])[0]
        down, up = self._ways_apart(above, below, zero)
        share = graph.power(graph.add((up, graph.negative(down))), -1)

        def mean(a: int, b: int) -> int:
            if a == b:
                return a
            both = graph.add((graph.mul((up, a)), graph.negative(graph.mul((down, b)))))
            return graph.mul((both, share))

        pairs = zip(self._rates(above.system), self._rates(below.system), strict=True)
        own = graph.symbols(zero)
        alone = len(own) == 1 and graph.nodes[zero].kind == "symbol"
        rates = [
            graph.zero if alone and symbol in own else mean(a, b)
            for symbol, (a, b) in zip(self.system.inputs[:-1], pairs, strict=True)
        ]
        half = len(self.system.velocity)
        system = replace(above.system, written=above.system.moving_by(rates[:half], rates[half:]))
        others = {j: node for j, node in above.functions.items() if j != k}
        return Regime(signs, system, others)

    def _held_together(self, signs: Signs) -> Regime:
        """Return the motion on the zeros of several functions at once.

        Raises
        ------
        ValueError
            It is not determined.
        """
        graph, shares, beside = (
            self.system.graph,
            self.shares(signs),
            self.regime(_on_their_positive_side(signs)),
        )
        if shares is None:
            zeros = ", ".join(f"{graph.to_sympy(self.functions[k])} = 0" for k in held_in(signs))
            raise ValueError(
                f"several kinks hold the motion at once, {zeros}, and nothing tells by which forces"
            )
        rates = self.folded(signs, self._rates(self.system), shares)
        for k in shares:
            if graph.nodes[self.functions[k]].kind == "symbol":
                rates[self.row(k)] = graph.zero
        half = len(self.system.velocity)
        system = replace(beside.system, written=beside.system.moving_by(rates[:half], rates[half:]))
        return Regime(signs, system, {j: node for j, node in beside.functions.items() if j not in shares})

    def shares(self, signs: Signs) -> Mapping[int, int] | None:
        """Return what stands in place of the signs of several functions that are held; None where nothing tells."""
        if signs not in self._shares:
            self._shares[signs] = self._shares_found(signs)
        return self._shares[signs]

    def _shares_found(self, signs: Signs) -> Mapping[int, int] | None:
        held, beside = held_in(signs), self.regime(_on_their_positive_side(signs))
        if any(k in beside.weak for k in held):
            return None
        found = self.folded(beside.signs, [self.functions[k] for k in held])
        return shares_that_hold(
            self.system.graph,
            self.system.inputs,
            dict(zip(held, found, strict=True)),
            lambda shares: self.folded(signs, self._rates(self.system), shares),
        )

    def rate_at_rest(self, signs: Signs, k: int) -> int | None:
        """Return the rate of a variable where it is 0, of one whose rate has a root there and does not jump.

        So is the speed of a body under a drag √|v|. None of other switching functions.
        """
        graph, g = self.system.graph, self.functions[k]
        above, below = self._sides(signs, k)
        if graph.nodes[g].kind != "symbol" or k not in above.weak | below.weak:
            return None
        try:
            down, up = (graph.substitute([side.rate(g)], {g: graph.zero})[0] for side in (above, below))
        except ZeroDivisionError:  # a force that is infinite at rest
            return None
        return down if down == up else None

    def _resting(self, signs: Signs, k: int) -> Regime:
        """Return the motion of the other variables while one stays 0."""
        graph, g = self.system.graph, self.functions[k]
        above, _ = self._sides(signs, k)
        rates = graph.substitute(self._rates(above.system), {g: graph.zero})
        rates[self.row(k)] = graph.zero
        half = len(self.system.velocity)
        system = replace(above.system, written=above.system.moving_by(rates[:half], rates[half:]))
        return Regime(signs, system, {j: node for j, node in above.functions.items() if j != k})

    def row(self, k: int) -> int:
        """Return which component of the state a switching function is that is a variable."""
        (symbol,) = self.system.graph.symbols(self.functions[k])
        return self.system.inputs.index(symbol)

    def _sides(self, signs: Signs, k: int) -> tuple[Regime, Regime]:
        above, below = (self.regime(put(signs, k, side)) for side in (1, -1))
        return above, below

    def ways_out(self, signs: Signs) -> list[tuple[int, int]]:
        """Return which function leaves its zero where one of these functions vanishes that end a motion on zeros.

        Each is positive while its side leads to the zero. Nothing ends the rest of what nothing moves.
        """
        graph = self.system.graph
        if len(held_in(signs)) > 1:
            shares = self.shares(signs) or {}
            ends = [(k, side) for k, share in shares.items() for side in (share, graph.negative(share))]
            return [(k, graph.add((graph.one, side))) for k, side in ends]
        k = signs.index(HELD)
        if self.rate_at_rest(signs, k) is not None:
            return []
        above, below = self._sides(signs, k)
        zero = self.folded(above.signs, [self.functions[k]])[0]
        down, up = self._ways_apart(above, below, zero)
        return [(k, graph.negative(down)), (k, up)]

    def _ways_apart(self, above: Regime, below: Regime, zero: int) -> tuple[int, int]:
        """Return the first time derivatives of a switching function that differ on its two sides."""
        down = up = zero
        for _ in range(_DERIVATIVES):
            down, up = above.rate(down), below.rate(up)
            if down != up:
                return down, up
        raise ValueError(
            f"the motion stays on {self.system.graph.to_sympy(zero)} = 0, and {_DERIVATIVES} derivatives do not tell "
            "to which side it leaves; stop it there with an Event(…, action='stop')"
        )

    def folded(
        self, signs: Signs, nodes: Sequence[int], shares: Mapping[int, int] = MappingProxyType({})
    ) -> list[int]:
        """Return nodes with the signs of a regime put in, and shares in place of those of functions that are held."""
        graph, known = self.system.graph, dict[int, int]()
        for kink, (k, same) in self.kinks.items():
            node, sign = graph.nodes[kink], signs[k] * same
            if node.kind == "Abs":
                known[kink] = graph.scaled(sign, graph.substitute(node.operands, known)[0])
            elif k in shares:
                known[kink] = graph.scaled(same, shares[k])
            else:
                known[kink] = graph.number(sign)
        return graph.substitute(nodes, known)

    def events(self, signs: Signs, events: Sequence[PreparedEvent]) -> tuple[PreparedEvent, ...]:
        """Return events with their functions as they are in a regime."""
        made: list[PreparedEvent] = []
        for event in events:
            value, rate, *jump = self.folded(signs, [event.value, event.rate, *(event.jump or ())])
            made.append(replace(event, value=value, rate=rate, jump=tuple(jump) if event.jump else None))
        return tuple(made)

    def _nodes(self, signs: Signs) -> list[int]:
        return self.folded(signs, [*self._rates(self.system), self.system.hamiltonian])

    def _system(self, signs: Signs) -> HamiltonEquations:
        n, own = len(self.system.velocity), self.system
        named = self.folded(signs, list(own.named.values()))
        *rates, energy = self._nodes(signs)
        return replace(
            own,
            written=own.moving_by(rates[:n], rates[n:], energy),
            named=dict(zip(own.named, named, strict=True)),
        )

    @staticmethod
    def _rates(system: HamiltonEquations) -> list[int]:
        return [*system.velocity, *system.force]


def _on_their_positive_side(signs: Signs) -> Signs:
    return tuple(sign or 1 for sign in signs)


@functools.lru_cache(maxsize=_KEPT)
def kinks_of(system: HamiltonEquations) -> Kinks | None:
    """Return the kinks of equations, or None where they are smooth.

    Examples
    --------
    >>> from canon.kernel.program.hamilton_equations import equations
    >>> from sympy import Abs, symbols
    >>> q, p, t = symbols("q p t", real=True)
    >>> found = kinks_of(equations(p**2 / 2 + Abs(q), (q,), (p,), t, {}))
    >>> [found.system.graph.to_sympy(g) for g in found.functions]
    [q]
    >>> [found.system.graph.to_sympy(rate) for rate in found.regime((-1,)).system.rates]
    [p, 1]
    """
    graph = system.graph
    found = [
        node
        for node in sorted(graph.reachable((*system.velocity, *system.force, system.hamiltonian)))
        if graph.nodes[node].kind in ("sign", "Abs") and graph.symbols(node)
    ]
    if not found:
        return None
    functions, kinks = list[int](), dict[int, tuple[int, int]]()
    for node in found:
        g = graph.nodes[node].operands[0]
        opposite = graph.negative(g)
        if g not in functions and opposite not in functions:
            functions.append(g)
        same = g in functions
        kinks[node] = (functions.index(g if same else opposite), 1 if same else -1)
    assert all(a < b for a, b in pairwise(kinks))
    return Kinks(system, kinks, tuple(functions))
