"""Equations that make no motion, and what is asked along them: refusals say what was wrong and what to give."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.interpolate import CubicSpline, PPoly

from canon import (
    ConstrainedLagrangian,
    Event,
    Hamiltonian,
    Lagrangian,
    VectorField,
    coordinates,
    parameters,
    propagate,
    time,
)
from canon.flow import HamiltonianMap, LiePoissonSplitting, Rattle, sampled_function
from canon.flow.run.event import prepared_events
from canon.mechanics import GibbsAppell, NewtonEuler, PoissonSystem
from canon.mechanics.lagrange.body import Particle
from canon.mechanics.lagrange.newton_euler import Load, weights

x, y, theta = coordinates("x y theta")
g, k, nu = parameters("g k nu", positive=True)
FALL = Hamiltonian(y.momentum**2 / 2 + y, [y], [y.momentum])
FALLING = Lagrangian(y.dot**2 / 2 - y, [y])
ORBITS = np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]])


def mirror(K: Any) -> PoissonSystem:
    return PoissonSystem(K, [x, y], [[0, 1], [-1, 0]])


@pytest.mark.parametrize(
    ("system", "how", "said"),
    [
        (
            FALLING,
            {"events": [Event(y.dot, 0, "bounce")]},
            r"no wall g\(q, t\) = 0 .* its action as \{v: …\}",
        ),
        (
            FALLING,
            {"y0": {"y": [1, 2], "y_dot": [0, 0, 0]}},
            "y0 has values for 2 and 3 orbits: give one number",
        ),
        (
            Lagrangian(y.dot**2 / 2 - g * y, [y]),
            {"y0": ORBITS, "parameters": {g: np.array([1.0, 2.0])}},
            r"g of shape \(2,\) for y0 of shape \(2, 3\): parameters by orbit have shape \(orbits,\)",
        ),
        (FALL, {"t_span": (0, 1, 2)}, r"t_span = \(0, 1, 2\): give the first and the last time, \(t0, t1\)"),
        (
            ConstrainedLagrangian(FALLING, []),
            {"method": Rattle(), "step": 0.1},
            r"there are none: hamiltonian\(L\) takes Splitting and Gauss",
        ),
        (
            mirror(sp.exp(x * y)),
            {"y0": [1.0, 0.0], "method": LiePoissonSplitting(2), "step": 0.1},
            "has no flow that is known: LiePoissonSplitting takes",
        ),
    ],
)
def test_requests_that_make_no_sense_are_refused(system: Any, how: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        propagate(system, **{"t_span": (0, 1), "y0": [1.0, 0.0], **how})


@pytest.mark.parametrize(
    ("system", "how", "said"),
    [
        (
            FALL,
            {"parameters": {nu: np.ones(3)}, "observables": {"height": nu * y}},
            "an array is given for nu, which H does not hold",
        ),
        (FALLING, {"events": [Event(y - nu, 0, "bounce")]}, "holds nu: give .* a number"),
    ],
)
def test_parameters_without_a_place_or_a_number_are_named(
    system: Any, how: dict[str, Any], said: str
) -> None:
    with pytest.raises(KeyError, match=said):
        propagate(system, (0, 1), [1.0, 0.0], **how)


def test_what_is_noted_beside_a_bounce_leaves_it_as_it_is() -> None:
    """y = 1 − t²/2 meets the ground at √2, and is up again at 2√2; the height 1/2 is passed at 1 and at 2√2 − 1."""
    ground, half = Event(y, -1, "bounce"), Event(y - sp.Rational(1, 2))
    motion = propagate(FALLING, (0, 2 * np.sqrt(2)), [1.0, 0.0], events=[half, ground])
    root = np.sqrt(2)
    assert [met.t for met in motion.events] == pytest.approx([1, root, 2 * root - 1], abs=1e-13)
    assert motion.final == pytest.approx([1.0, 0.0], abs=1e-13)


def test_a_new_state_may_hold_a_parameter() -> None:
    """Each impact leaves the part k of the speed: after the first at √2 the ball flies for 2 √2 k."""
    p = y.momentum
    impact = Event(y, -1, {p: -k * p})
    motion = propagate(FALL, (0, 3), [1.0, 0.0], events=[impact], parameters={k: 0.5})
    assert [met.t for met in motion.events] == pytest.approx(np.sqrt(2) * np.array([1, 2]), abs=1e-12)


def test_events_may_be_written_with_functions_of_time() -> None:
    Y = sp.Function("y")(time)
    motion = propagate(
        FALLING, (0, 2), [1.0, 0.0], events=[Event(Y - sp.Rational(1, 2)), Event(Y.diff(time) + 1)]
    )
    assert [met.t for met in motion.events] == pytest.approx([1, 1], abs=1e-13)


def test_maps_take_as_many_momenta_as_coordinates() -> None:
    with pytest.raises(ValueError, match="2 q and 1 p: give as many of each"):
        HamiltonianMap(x.momentum**2 / 2, sp.cos(x), [x, y], [x.momentum])


def test_splines_of_several_values_or_without_numbers_are_refused() -> None:
    places = np.linspace(0, 3, 7)
    with pytest.raises(ValueError, match="several values at a place: give one of them at a time"):
        sampled_function(x, CubicSpline(places, np.stack([places, places**2], axis=1)))
    lost = PPoly(np.array([[1.0, np.nan], [0.0, 1.0]]), [0.0, 1.0, 2.0])
    with pytest.raises(ValueError, match="the spline has coefficients that are not finite"):
        sampled_function(x, lost)


def test_particles_without_reactions_move_by_newton_alone() -> None:
    ball = Particle(2, (x, y))
    motion = propagate(
        NewtonEuler([ball], [x, y], weights([ball], (0, -g))), (0, 2), [0, 1, 1, 2], parameters={g: 3}
    )
    assert motion.final == pytest.approx([2, 1 + 4 - 6, 1, 2 - 6], abs=1e-13)


def lead(force: Any, *reactions: Any) -> NewtonEuler:
    """A particle on the line that a force of reactions acts on, beside its weight across."""
    ball = Particle(1, (x, sp.S.Zero))
    return NewtonEuler([ball], [x], [*weights([ball], (0, -1)), Load(0, force)], list(reactions))


def test_reactions_that_balances_do_not_determine_are_refused() -> None:
    R, S = sp.symbols("R S", real=True)
    held = propagate(lead((0, R), R), (0, 1), [0.0, 1.0])
    assert held["R"] == pytest.approx(np.ones(len(held.t)), abs=1e-14)
    with pytest.raises(
        ValueError, match="2 independent balances at the start for x_ddot, R, S: too many reactions"
    ):
        propagate(lead((0, R + S), R, S), (0, 1), [0.0, 1.0])
    with pytest.raises(ValueError, match="the equations are not linear in x_ddot, R"):
        propagate(lead((0, R + R**2), R), (0, 1), [0.0, 1.0])


def test_a_variable_of_heyoka_with_the_name_of_the_time_is_refused() -> None:
    hy: Any = pytest.importorskip("heyoka")
    clock, place = hy.make_vars("t", "place")
    moved = propagate([(place, 2 * hy.time)], (0, 3), [1.0])
    assert moved.final == pytest.approx([10.0], abs=1e-13)
    with pytest.raises(
        ValueError, match="heyoka's variable t has the name of the time here: call it something else"
    ):
        propagate([(clock, hy.expression(1.0))], (0, 3), [1.0])


def test_forces_with_squares_of_accelerations_are_refused() -> None:
    ball = Particle(1, (x, sp.S.Zero))
    lighter = GibbsAppell([ball], [x], forces=[1 + x.ddot / 2])
    assert propagate(lighter, (0, 2), [0.0, 1.0]).final == pytest.approx([6.0, 5.0], abs=1e-13)
    with pytest.raises(ValueError, match="the equations are not linear in x_ddot"):
        propagate(GibbsAppell([ball], [x], forces=[1 + x.ddot**2]), (0, 2), [0.0, 1.0])


def test_only_hamiltonians_reflect_momenta() -> None:
    field = propagate(VectorField([y, -x], [x, y]), (0, 1), [1.0, 0.0], samples=1).record.task.system
    with pytest.raises(
        ValueError, match="bounces, which Hamiltonians do: give the new velocities as its action"
    ):
        prepared_events(field, [Event(x, 0, "bounce")])
