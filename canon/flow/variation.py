"""Equations of motion, and of variations of it, carried along a trajectory by heyoka."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon.expression.graph import Graph
from canon.expression.symbol import time
from canon.flow.pointwise import definite_node
from canon.flow.stepping import NonFiniteStateError
from canon.kernel.structure import exact
from canon.kernel.taylor import heyoka_expressions
from canon.mechanics.vector_field import VectorField

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from sympy import Expr, Symbol

    from canon.flow.propagate import HamiltonianSystem
    from canon.flow.trajectory import Array

__all__ = ["Field", "carried", "exact_numbers", "field_of", "step_error"]

_COMPACT_FROM = 60
"""Equations with more operations are compiled in heyoka's compact mode."""


@dataclass(frozen=True, eq=False)
class Field:
    """Equations of motion ẋ = X(x, t) on a graph, with numbers for their parameters."""

    graph: Graph
    x: tuple[Symbol, ...]
    t: Symbol
    numbers: Mapping[str, Fraction]
    rates: tuple[int, ...]

    def node(self, f: Expr, what: str) -> int:
        """Return the node of a function of x, t and the parameters."""
        general = definite_node(self.graph, f, what)
        others = self.graph.symbols(general) - {*self.x, self.t}
        unknown = sorted(s.name for s in others if s.name not in self.numbers)
        if unknown:
            raise KeyError(
                f"{what} holds {', '.join(unknown)}: give each a number, parameters={{symbol: value}}"
            )
        known = {self.graph.symbol(s): self.graph.number(self.numbers[s.name]) for s in others}
        return self.graph.substitute([general], known)[0]

    def half(self) -> int:
        """Return n of the 2n variables (q, p)."""
        if len(self.x) % 2:
            raise ValueError(
                f"the field has {len(self.x)} variables, which can't be coordinates and momenta (q, p)"
            )
        return len(self.x) // 2

    def state(self, y: Sequence[Any]) -> Array:
        """Return a state as doubles."""
        given = np.array([float(exact(value, "a component of the state")) for value in y])
        if given.shape != (len(self.x),):
            raise ValueError(
                f"{given.size} numbers given for the state ({', '.join(map(str, self.x))}): give one each"
            )
        return given

    def heyoka_pairs(self, variations: int = 0) -> list[tuple[Any, Any]]:
        """Return heyoka's equations of x and, after them, of so many variations δx."""
        import heyoka as hy

        graph, dummies = self.graph, [sp.Dummy(s.name) for _ in range(variations) for s in self.x]
        rates = list(self.rates)
        for k in range(variations):
            d = [graph.symbol(s) for s in dummies[k * len(self.x) : (k + 1) * len(self.x)]]
            for rate in self.rates:
                slopes = graph.gradient(rate, self.x)
                rates.append(graph.add([graph.mul([a, b]) for a, b in zip(slopes, d, strict=True)]))
        symbols = (*self.x, *dummies)
        variables = {s: hy.expression(f"x{i}") for i, s in enumerate(symbols)}
        made = heyoka_expressions(graph, rates, {**variables, self.t: hy.time})
        return list(zip(variables.values(), made, strict=True))


def field_of(motion: HamiltonianSystem | VectorField, parameters: Mapping[Symbol | str, Any]) -> Field:
    """Return Hamilton's equations, or those of a vector field, with numbers for the parameters."""
    graph, numbers = Graph(), exact_numbers(parameters)
    if isinstance(motion, VectorField):
        empty = Field(graph, motion.x, time, numbers, ())
        rates = tuple(empty.node(f, "the vector field") for f in motion.components)
        return Field(graph, motion.x, time, numbers, rates)
    x, n = (*motion.q, *motion.p), len(motion.q)
    empty = Field(graph, x, motion.t, numbers, ())
    slopes = graph.gradient(empty.node(motion.H, "the Hamiltonian"), x)
    rates = (*slopes[n:], *(graph.negative(slope) for slope in slopes[:n]))
    return Field(graph, x, motion.t, numbers, rates)


def carried(
    field: Field, equations: Any, y0: Array, t_span: tuple[float, float], samples: int, variations: int = 0
) -> tuple[Array, int]:
    """Return the states at evenly spaced times, shape (samples + 1, …), and the steps taken.

    ``equations`` are heyoka's, of the field's variables and of so many ``variations`` of them.

    Raises
    ------
    NonFiniteStateError
        The motion can't be continued over the whole span.
    """
    import heyoka as hy

    start, end = (float(exact(t, "t_span")) for t in t_span)
    if start == end or samples < 1:
        raise ValueError(f"t_span = {t_span} with samples={samples}: there is no motion to look at")
    large = len(field.graph.reachable(field.rates)) * (1 + variations) > _COMPACT_FROM
    integrator = hy.taylor_adaptive(equations, y0, time=start, compact_mode=large)
    outcome, _, _, steps, _, rows = integrator.propagate_grid(np.linspace(start, end, samples + 1))
    if outcome != hy.taylor_outcome.time_limit or not np.isfinite(rows).all():
        state = np.array(integrator.state[: len(field.x)])
        raise NonFiniteStateError(
            f"the motion can't be continued after t = {integrator.time:.9g} ({outcome}): a collision or the "
            "edge of the equations' domain; stop earlier",
            float(integrator.time),
            state,
        )
    return rows, int(steps)


def step_error(states: Array, steps: int) -> Array:
    """Return the error of a state after so many steps that are each right to a rounding, in every instant.

    heyoka's tolerance is relative to the largest component, and absolute where that is below 1.
    """
    largest = np.maximum.accumulate(np.abs(states).max(axis=1))
    return np.finfo(float).eps * math.sqrt(steps + 1) * np.maximum(1.0, largest)


def exact_numbers(parameters: Mapping[Symbol | str, Any]) -> dict[str, Fraction]:
    """Return the parameters' exact numbers by name."""
    return {str(name): exact(value, str(name)) for name, value in parameters.items()}
