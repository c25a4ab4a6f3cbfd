"""SymPy's KanesMethod with constraints: starts that violate them are refused, and all their parameters are known."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from sympy import symbols
from sympy.physics.mechanics import KanesMethod, Particle, Point, ReferenceFrame, dynamicsymbols

from canon import propagate
from canon.mechanics.lagrange.sympy_bridge import from_sympy_mechanics
from canon.study.motion.system_text import system_in, system_text

m, g, l = symbols("m g l", positive=True)
COS, SIN = np.cos(0.6), np.sin(0.6)


def pendulum_in_the_plane(length):
    """q1 points down; the string keeps q1² + q2² = l², its rate q1 u1 + q2 u2 = 0."""
    q1, q2, u1, u2 = dynamicsymbols("q1 q2 u1 u2")
    frame, pivot = ReferenceFrame("N"), Point("O")
    pivot.set_vel(frame, 0)
    bob = pivot.locatenew("P", q1 * frame.x + q2 * frame.y)
    bob.set_vel(frame, u1 * frame.x + u2 * frame.y)
    kane = KanesMethod(
        frame,
        q_ind=[q2],
        q_dependent=[q1],
        u_ind=[u2],
        u_dependent=[u1],
        configuration_constraints=[q1**2 + q2**2 - length**2],
        velocity_constraints=[q1 * u1 + q2 * u2],
        kd_eqs=[q1.diff() - u1, q2.diff() - u2],
    )
    kane.kanes_equations([Particle("P", bob, m)], [(bob, m * g * frame.x)])
    return kane


def started(q1, q2, u1, u2):
    return {"q1": q1, "q2": q2, "u1": u1, "u2": u2}


def test_a_start_on_the_constraints_moves_as_the_pendulum_does():
    kane, numbers = pendulum_in_the_plane(l), {m: 1, g: 9.81, l: 2}
    motion = propagate(kane, (0, 3), started(2 * COS, 2 * SIN, 0, 0), parameters=numbers)
    angle = solve_ivp(
        lambda t, s: [s[1], -9.81 / 2 * np.sin(s[0])], (0, 3), [0.6, 0], "DOP853", rtol=1e-12, atol=1e-13
    ).y[0, -1]
    assert motion["q2"][-1] == pytest.approx(2 * np.sin(angle), abs=1e-9)
    assert abs(motion.residuals).max() < 1e-12


@pytest.mark.parametrize(
    ("start", "words"),
    [
        (
            started(1.2 * COS, 1.2 * SIN, 0, 0),
            "the start is not on the constraints: holonomic constraint 1 is 0.44",
        ),
        (started(COS, SIN, 1, 0), "the start is not on the constraints: the rate of constraint"),
        (started(COS, SIN, -SIN, 1.01 * COS), "the start is not on the constraints: the rate of constraint"),
    ],
)
def test_a_start_off_the_constraints_is_refused(start, words):
    with pytest.raises(ValueError, match=words):
        propagate(pendulum_in_the_plane(1), (0, 3), start, parameters={m: 1, g: 9.81})


def test_a_parameter_of_the_configuration_alone_is_needed():
    start = started(COS, SIN, 0, 0)
    with pytest.raises(KeyError, match="l"):
        propagate(pendulum_in_the_plane(l), (0, 3), start, parameters={m: 1, g: 9.81})
    with pytest.raises(ValueError, match="not on the constraints"):
        propagate(pendulum_in_the_plane(l), (0, 3), start, parameters={m: 1, g: 9.81, l: 1.1})


def test_the_constraints_are_written_with_the_system():
    taken = from_sympy_mechanics(pendulum_in_the_plane(l))
    assert [str(f) for f in (*taken.holonomic, *taken.nonholonomic)] == [
        "-l**2 + q1**2 + q2**2",
        "q1*u1 + q2*u2",
    ]
    assert system_in(system_text(taken)) == taken
