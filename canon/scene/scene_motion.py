"""Motion of a scene by heyoka's Taylor method to round-off: sampled, or up to an event."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import LONGDOUBLE
from canon.flow.geometry.vector_field_motion import at_first_zero, sampled
from canon.mechanics.at_scale.constrained import constrained, constrained_motion
from canon.mechanics.at_scale.second_order import derivation_of_lagrangian
from canon.scene.equations_of_motion import SceneEquations, scene_equations
from canon.scene.parts import SceneError, Start

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from sympy import Expr

    from canon.array import Array
    from canon.scene.scene import Scene

__all__ = ["SceneMotion", "first_zero", "run", "start_state"]


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
    SceneError
        There is no such start, or no such number of periods or samples.

    Examples
    --------
    >>> from canon.scene import find
    >>> motion = run(find("simple-pendulum"), "small", periods=1, samples=4)
    >>> motion.q.round(3) + 0.0
    array([[ 0.1,  0. , -0.1,  0. ,  0.1]])
    """
    if not 0.0 < periods < np.inf:
        raise SceneError(f"periods={periods}: give a positive, finite number")
    if samples < 1:
        raise SceneError(f"samples={samples}: keep one state after the first at least")
    chosen = start if isinstance(start, Start) else scene.start(start)
    equation = scene_equations(scene)
    times = np.linspace(0.0, periods * scene.period, samples + 1)
    y0 = start_state(scene, chosen, equation)
    angles = [i for i, s in enumerate(scene.q) if s.name in scene.angles.split()]
    found = sampled(equation.field, equation.field.heyoka_pairs(), times, y0, angles=angles)
    return SceneMotion(scene, chosen, equation, times, found.rows.T, found.turns.T, found.steps)


def first_zero(scene: Scene, start: str | None, f: Expr, periods: float) -> SceneMotion:
    """Return the motion up to the first instant at which f(q, q̇, p, t) vanishes: its start and that instant.

    Raises
    ------
    NonFiniteStateError
        f does not vanish within these periods, or the motion ends before.
    SceneError
        There is no such start, or no such number of periods.

    Examples
    --------
    A pendulum let go at 0.1 rad is at its lowest after a quarter of its period, T = 2π √(l/g) (1 + θ₀²/16 + …):

    >>> from canon.scene import find
    >>> scene = find("simple-pendulum")
    >>> quarter = first_zero(scene, "small", scene.q[0], periods=1).t[-1]
    >>> float((4 * quarter / scene.period - 1).round(6))
    0.000625
    """
    if not 0.0 < periods < np.inf:
        raise SceneError(f"periods={periods}: give a positive, finite number")
    chosen, equation = scene.start(start), scene_equations(scene)
    y0 = start_state(scene, chosen, equation)
    node, until = equation.node(f, "the event"), periods * scene.period
    end, state, steps = at_first_zero(equation.field, node, y0, until)
    x = np.array([y0, state]).T
    return SceneMotion(scene, chosen, equation, np.array([0.0, end]), x, np.zeros_like(x), steps)


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
