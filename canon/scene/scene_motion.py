"""Motion of a scene by heyoka's Taylor method to round-off: sampled, or up to an event."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import LONGDOUBLE
from canon.flow.geometry.vector_field_motion import COMPACT_FROM
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.kernel.heyoka_bridge import heyoka_expressions
from canon.mechanics.at_scale.constrained import constrained, constrained_motion
from canon.mechanics.at_scale.second_order import derivation_of_lagrangian
from canon.scene.equations_of_motion import SceneEquations, scene_equations
from canon.scene.parts import SceneError, Start

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from sympy import Expr

    from canon.array import Array
    from canon.flow.geometry.vector_field_motion import VectorFieldSystem
    from canon.scene.scene import Scene

__all__ = ["SceneMotion", "first_zero", "run", "start_state"]

_MET = -1
"""heyoka's outcome where the first of its terminal events stopped the motion."""

_TURN_HIGH, _TURN_LOW = 6.28125, 1.9353071795864769e-03
"""2π in two parts, the first with so few digits that a multiple of it is exact."""


@dataclass(frozen=True, eq=False)
class SceneMotion:
    """A sampled motion of a scene.

    Parameters
    ----------
    scene, start
        What moved, and from where.
    equation
        Its equations.
    t
        Sample times, shape (times,).
    x
        States (q, p), with W last where the energy is not conserved; shape (variables, times). Angles are within
        half a turn of 0.
    turns
        How many whole turns the variables have made besides, shape (variables, times).
    steps
        Steps of the integrator.
    """

    scene: Scene
    start: Start
    equation: SceneEquations
    t: Array
    x: Array
    turns: Array
    steps: int

    @property
    def q(self) -> Array:
        """Coordinates, shape (n, times), angles with all their turns."""
        n = len(self.scene.q)
        return self.x[:n] + 2.0 * np.pi * self.turns[:n]

    def values(self, nodes: Sequence[int]) -> NDArray[Any]:
        """Return the values of nodes along the motion, evaluated in long double, shape (nodes, times)."""
        field = self.equation.field
        turn = 2 * LONGDOUBLE.named("pi")
        wide = (*(self.x.astype(np.longdouble) + turn * self.turns), self.t.astype(np.longdouble))
        found = field.graph.evaluate(nodes, dict(zip((*field.x, field.t), wide, strict=True)), LONGDOUBLE)
        return np.array([np.broadcast_to(np.asarray(f, np.longdouble), self.t.shape) for f in found])

    def observed(self, f: Expr) -> Array:
        """Return a function of q, q̇, p and t along the motion, shape (times,)."""
        return self.values([self.equation.node(f, str(f))])[0].astype(np.float64)


def run(
    scene: Scene, start: str | Start | None = None, periods: float = 100.0, samples: int = 1009
) -> SceneMotion:
    """Return the motion of a scene over some periods, by heyoka's Taylor method to round-off.

    Parameters
    ----------
    scene
        The scene, with the values of its parameters.
    start
        One of its starts, by name, or another; its first one unless given.
    periods
        Duration in the scene's periods.
    samples
        How many evenly spaced states to keep after the first; a prime meets other phases in each period.

    Raises
    ------
    NonFiniteStateError
        The motion can't be continued over the whole span.

    Examples
    --------
    >>> from canon.scene import find
    >>> motion = run(find("simple-pendulum"), "small", periods=1, samples=4)
    >>> motion.q.round(3) + 0.0
    array([[ 0.1,  0. , -0.1,  0. ,  0.1]])
    """
    if not periods > 0.0:
        raise SceneError(f"periods={periods}: give a positive, finite number")
    chosen = start if isinstance(start, Start) else scene.start(start)
    equation = scene_equations(scene)
    times = np.linspace(0.0, periods * scene.period, samples + 1)
    y0 = start_state(scene, chosen, equation)
    angles = [s.name in scene.angles.split() for s in scene.q]
    x, turns, steps = _carried(equation.field, y0, times, np.flatnonzero(angles))
    return SceneMotion(scene, chosen, equation, times, x, turns, steps)


def _carried(
    field: VectorFieldSystem, y0: Array, times: Array, angles: NDArray[np.intp]
) -> tuple[Array, Array, int]:
    """Return states and turns at the times, and the steps taken; angles are turned back as they grow.

    An angle that went on growing would be rounded to ever fewer digits, and heyoka's steps with it, as their error is
    relative to the largest variable.
    """
    import heyoka as hy

    large = len(field.graph.reachable(field.rates)) > COMPACT_FROM
    integrator = hy.taylor_adaptive(field.heyoka_pairs(), y0, compact_mode=large)
    turns = np.zeros(len(field.x))
    rows, whole, steps = [y0], [turns.copy()], 0
    slices = len(times) - 1 if angles.size else 1
    for part in np.array_split(np.arange(1, len(times)), slices):
        outcome, _, _, taken, _, found = integrator.propagate_grid(times[part[0] - 1 : part[-1] + 1])
        if outcome != hy.taylor_outcome.time_limit or not np.isfinite(found).all():
            raise NonFiniteStateError(
                f"the motion can't be continued after t = {integrator.time:.9g} ({outcome}): a collision or the edge "
                "of the equations' domain; take fewer periods",
                float(integrator.time),
                np.array(integrator.state),
            )
        steps += int(taken)
        state = integrator.state
        back = np.round(state[angles] / (2.0 * np.pi))
        state[angles] = (state[angles] - back * _TURN_HIGH) - back * _TURN_LOW
        rows += [*found[1:-1], state.copy()]
        whole += [turns.copy()] * (len(part) - 1)
        turns[angles] += back
        whole.append(turns.copy())
    return np.array(rows).T, np.array(whole).T, steps


def first_zero(scene: Scene, start: str | None, f: Expr, periods: float) -> SceneMotion:
    """Return the motion up to the first instant at which f(q, q̇, p, t) vanishes: its start and that instant.

    Raises
    ------
    NonFiniteStateError
        f does not vanish within these periods, or the motion ends before.

    Examples
    --------
    A pendulum let go at 0.1 rad is at its lowest after a quarter of its period, T = 2π √(l/g) (1 + θ₀²/16 + …):

    >>> from canon.scene import find
    >>> scene = find("simple-pendulum")
    >>> quarter = first_zero(scene, "small", scene.q[0], periods=1).t[-1]
    >>> float((4 * quarter / scene.period - 1).round(6))
    0.000625
    """
    import heyoka as hy

    chosen, equation = scene.start(start), scene_equations(scene)
    field = equation.field
    pairs = field.heyoka_pairs()
    variables = {s: pair[0] for s, pair in zip(field.x, pairs, strict=True)} | {field.t: hy.time}
    crossing = heyoka_expressions(field.graph, [equation.node(f, "the event")], variables)[0]
    y0 = start_state(scene, chosen, equation)
    integrator = hy.taylor_adaptive(pairs, y0, t_events=[hy.t_event(crossing)], compact_mode=True)
    outcome, _, _, steps, _, _ = integrator.propagate_until(periods * scene.period)
    if int(outcome) != _MET or not np.isfinite(integrator.state).all():
        raise NonFiniteStateError(
            f"{f} does not vanish before t = {integrator.time:.9g} ({outcome}); follow the motion longer",
            float(integrator.time),
            np.array(integrator.state),
        )
    t = np.array([0.0, float(integrator.time)])
    x = np.array([y0, integrator.state]).T
    return SceneMotion(scene, chosen, equation, t, x, np.zeros_like(x), int(steps))


def start_state(scene: Scene, start: Start, equation: SceneEquations) -> Array:
    """Return the state to start from: (q, p), put onto the constraints, and W = 0 where work is done."""
    state, n = scene.state(start), len(scene.q)
    if equation.residuals:
        if start.v is None:
            raise SceneError(f"the start {start.name!r} of {scene.name} has constraints: give it velocities")
        bound = scene.constrained
        equations = constrained(
            derivation_of_lagrangian(scene.lagrangian), bound.holonomic, bound.nonholonomic
        )
        motion = constrained_motion(equations, scene.values_by_symbol())
        place, speed = (x.tolist() for x in motion.projected(start.q, start.v, 0.0))
        state = scene.state(Start(start.name, start.about, tuple(place), v=tuple(speed)))
    return np.append(state, 0.0) if len(equation.field.x) > 2 * n else state
