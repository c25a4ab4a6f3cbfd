"""RATTLE: constraints to rounding, order, reversal, symplecticity on the constraints, energy in long runs, trouble."""

import functools

import mpmath
import numpy as np
import pytest
import sympy as sp

from canon import (
    ConstrainedLagrangian,
    Hamiltonian,
    Lagrangian,
    coordinates,
    flow_jacobian,
    load_motion,
    parameters,
    propagate,
)
from canon.expression.symbols.symbol import time, time_derivative
from canon.flow import reversal_error
from canon.flow.method.constrained_method import Rattle
from canon.flow.method.method import RK4
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.study.method_choice.candidate import candidate_methods
from canon.study.method_choice.choice_question import Question

U = 2.0**-53
x, y, u, w, r, theta, alpha = coordinates("x y u w r theta alpha")


def masses_on_rods():
    """The double pendulum in Cartesian coordinates, unit masses and rods."""
    L = Lagrangian(sum(s.dot**2 for s in (x, y, u, w)) / 2 - y - w, [x, y, u, w])
    return ConstrainedLagrangian(L, holonomic=[x**2 + y**2 - 1, (u - x) ** 2 + (w - y) ** 2 - 1])


def in_polar_coordinates():
    """The same with masses that depend on the place: the first mass at (r, θ) with r = 1, the second at an angle α."""
    first = (r * sp.sin(theta), -r * sp.cos(theta))
    second = (first[0] + sp.sin(alpha), first[1] - sp.cos(alpha))
    moving = [time_derivative(z, [r, theta, alpha]) for z in (*first, *second)]
    L = Lagrangian(sum(v**2 for v in moving) / 2 - first[1] - second[1], [r, theta, alpha])
    return ConstrainedLagrangian(L, holonomic=[r - 1])


def on_rods(angles):
    """Cartesian places and velocities of angles and their rates, in mpmath's numbers."""
    a, b, da, db = angles
    sin, cos = mpmath.sin, mpmath.cos
    q = [sin(a), -cos(a), sin(a) + sin(b), -cos(a) - cos(b)]
    v = [cos(a) * da, sin(a) * da, cos(a) * da + cos(b) * db, sin(a) * da + sin(b) * db]
    return [*q, *v]


CARTESIAN, POLAR = masses_on_rods(), in_polar_coordinates()
START, POLAR_START = [1, 0, 1, 1, 0, 0, 0, 0], [1, 1.5, 0.3, 0, 0, 0]


def sizes(motion, system, numbers=()):
    """Σ |G q| and the largest Σ |G v| along a motion, by constraint: what residuals are measured in."""
    q, values = system.lagrangian.q, motion.y[: len(system.lagrangian.q)]
    found = []
    for f in system.holonomic:
        G = [sp.lambdify(q, f.subs(dict(numbers)).diff(s))(*values) * np.ones(values.shape[1]) for s in q]
        found.append(sum(abs(a * b) for a, b in zip(G, values, strict=True)))
    for f in system.holonomic:
        G = [sp.lambdify(q, f.subs(dict(numbers)).diff(s))(*values) * np.ones(values.shape[1]) for s in q]
        found.append(sum(abs(a * b) for a, b in zip(G, motion.v, strict=True)).max())
    return found


def worst_residual(motion, system):
    return max(
        float((abs(row) / size).max())
        for row, size in zip(motion.residuals, sizes(motion, system), strict=True)
    )


@pytest.mark.parametrize("order", [2, 4])
def test_the_pendulum_is_that_of_one_angle(order):
    swinging = Hamiltonian(theta.momentum**2 / 2 - sp.cos(theta), [theta], [theta.momentum])
    angle = propagate(swinging, (0, 5), [sp.pi / 2, 0], samples=1).q[0, -1]
    pendulum = ConstrainedLagrangian(Lagrangian((x.dot**2 + y.dot**2) / 2 - y, [x, y]), [x**2 + y**2 - 1])
    errors = [
        np.hypot(found["x"][-1] - np.sin(angle), found["y"][-1] + np.cos(angle))
        for found in (
            propagate(pendulum, (0, 5), [1, 0, 0, 0], method=Rattle(order), step=5 / n, samples=1)
            for n in (200, 400)
        )
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.05 * order)


@pytest.mark.slow
@pytest.mark.parametrize("order", [2, 4, 6, 8])
def test_order_by_halving_the_step_against_the_motion_in_angles(order):
    with mpmath.workdps(30):
        start = [str(z) for z in on_rods(map(mpmath.mpf, (1.0, 0.3, 0.2, -0.4)))]
    true = propagate(CARTESIAN, (0, 3), start, samples=1).final
    steps = {2: 200, 4: 100, 6: 60, 8: 40}[order]
    errors = [
        abs(
            propagate(CARTESIAN, (0, 3), start, method=Rattle(order), step=3 / n, samples=1).final - true
        ).max()
        for n in (steps, 2 * steps)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.07 * order)


@pytest.mark.slow
@pytest.mark.parametrize("order", [2, 4, 6])
def test_order_where_masses_depend_on_the_place(order):
    true = propagate(POLAR, (0, 3), POLAR_START, samples=1).final
    steps = {2: 200, 4: 100, 6: 60}[order]
    errors = [
        abs(
            propagate(POLAR, (0, 3), POLAR_START, method=Rattle(order), step=3 / n, samples=1).final - true
        ).max()
        for n in (steps, 2 * steps)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.07 * order)


@pytest.mark.slow
def test_the_two_descriptions_are_one_motion():
    with mpmath.workdps(30):
        start = [str(z) for z in on_rods(map(mpmath.mpf, (1.5, 0.3, 0.0, 0.0)))]
    one = propagate(CARTESIAN, (0, 3), start, method=Rattle(4), step=0.01, samples=30)
    other = propagate(POLAR, (0, 3), POLAR_START, method=Rattle(4), step=0.01, samples=30)
    assert abs(one["x"] - np.sin(other["theta"])).max() < 1e-7
    assert abs(one["w"] + np.cos(other["theta"]) + np.cos(other["alpha"])).max() < 1e-7


@pytest.mark.parametrize(
    ("system", "start", "bound"),
    [(CARTESIAN, START, 2e-15), (POLAR, POLAR_START, 1e-13)],
    ids=["rods", "polar"],
)
def test_time_reversal(system, start, bound):
    assert abs(reversal_error(system, (0, 3), start, method=Rattle(4), step=0.02)).max() < bound


@functools.cache
def momentum_functions(system):
    L = system.lagrangian
    return [sp.lambdify([*L.q, *L.velocities], L.L.diff(v), "mpmath") for v in L.velocities]


def momenta(system, state):
    """p = ∂L/∂q̇ at a state of mpmath's numbers."""
    return [p(*state) for p in momentum_functions(system)]


def symplectic_defect(system, chart, at, method, precision, delta, step=0.25, span=0.25):
    """The largest ω(Mu, Mv) − ω(u, v) of some steps over tangent vectors u, v, by differences in a chart."""
    n, weights = len(system.lagrangian.q), {1: 45, 2: -9, 3: 1}
    places = [(i, sign * k) for i in range(len(at)) for k in weights for sign in (1, -1)]
    states = [chart([mpmath.mpf(a) + k * delta * (i == j) for j, a in enumerate(at)]) for i, k in places]
    found = propagate(
        system,
        (0, span),
        np.array(states, dtype=object).T,
        method=method,
        step=step,
        samples=1,
        precision=precision,
    )
    ends = [
        [mpmath.mpf(a) + mpmath.mpf(b) for a, b in zip(high, low, strict=True)]
        for high, low in zip(found.y[:, -1].T, found.carried[:, -1].T, strict=True)
    ]

    def tangents(reached):
        canonical = {place: [*z[:n], *momenta(system, z)] for place, z in zip(places, reached, strict=True)}
        return [
            [
                sum(c * (canonical[i, k][row] - canonical[i, -k][row]) for k, c in weights.items())
                / (60 * delta)
                for row in range(2 * n)
            ]
            for i in range(len(at))
        ]

    def forms(vectors):
        return [
            sum(a[i] * b[n + i] - a[n + i] * b[i] for i in range(n))
            for k, a in enumerate(vectors)
            for b in vectors[:k]
        ]

    before, after = forms(tangents(states)), forms(tangents(ends))
    assert max(map(abs, before)) > 0.1
    return max(abs(a - b) for a, b in zip(after, before, strict=True))


AT = ("1.0", "0.3", "0.7", "-0.4")


def test_a_step_is_symplectic_on_the_constraints():
    with mpmath.workdps(20):
        defect = symplectic_defect(CARTESIAN, on_rods, AT, Rattle(2), "double", mpmath.mpf(2) ** -7)
        assert defect < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "chart"),
    [
        (CARTESIAN, on_rods),
        (POLAR, lambda a: [mpmath.mpf(1), a[0], a[1], mpmath.mpf(0), a[2], a[3]]),
    ],
    ids=["rods", "polar"],
)
@pytest.mark.parametrize("order", [2, 4])
def test_a_step_is_symplectic_to_twenty_digits(system, chart, order):
    with mpmath.workdps(40):
        delta = mpmath.mpf(2) ** -14
        arguments = {"precision": "double-double", "delta": delta, "step": 0.0625, "span": 1.0}
        assert symplectic_defect(system, chart, AT, Rattle(order), **arguments) < 1e-20
        assert symplectic_defect(system, chart, AT, RK4(), **arguments) > 1e-12


def test_constraints_hold_to_rounding_and_energy_stays_bounded_over_a_hundred_thousand_steps():
    motion = propagate(CARTESIAN, (0, 2000), START, method=Rattle(4), step=0.02, samples=2000)
    assert motion.steps == 100_000
    assert worst_residual(motion, CARTESIAN) < 4 * U
    error = abs(motion.energy_error)
    assert error.max() < 2e-5
    assert error[-200:].max() < 5 * error[1:201].max()


@pytest.mark.slow
def test_constraints_hold_to_rounding_and_energy_stays_bounded_over_a_hundred_million_steps():
    motion = propagate(CARTESIAN, (0, 10**6), START, method=Rattle(2), step=0.01, samples=10_000)
    assert motion.steps == 10**8
    assert worst_residual(motion, CARTESIAN) < 4 * U
    error = abs(motion.energy_error)
    assert error.max() < 1e-2
    assert error[-1000:].max() < 3 * error[1:1001].max()


def test_multipliers_are_the_tensions():
    L = Lagrangian((x.dot**2 + y.dot**2) / 2 - y, [x, y])
    motion = propagate(
        ConstrainedLagrangian(L, [x**2 + y**2 - 1]), (0, 10), [1, 0, 0, 0], method=Rattle(4), step=0.01
    )
    speed = motion["x_dot"] ** 2 + motion["y_dot"] ** 2
    assert abs(motion.multipliers[0] - (motion["y"] - speed) / 2).max() < 1e-13


def chain(links, ends, extra=()):
    """Unit masses joined by unit rods, hung between two points or from one."""
    q = coordinates(" ".join(f"x{i} y{i}" for i in range(1, links)))
    places = [ends[0], *zip(q[::2], q[1::2], strict=True), *ends[1:]]
    pairs = zip(places[1:], places, strict=False)
    rods = [(a - c) ** 2 + (b - d) ** 2 - 1 for (a, b), (c, d) in pairs]
    L = Lagrangian(sum(s.dot**2 for s in q) / 2 - sum(q[1::2]), list(q))
    return ConstrainedLagrangian(L, holonomic=[*rods, *(f(q) for f in extra)])


def test_closed_loops_and_redundant_constraints():
    """Three masses between (0, 0) and (2, 0) on four rods; a fifth constraint follows from the third and fourth."""
    follows = lambda q: 2 * ((q[4] - q[2]) ** 2 + (q[5] - q[3]) ** 2) + 3 * ((2 - q[4]) ** 2 + q[5] ** 2) - 5  # noqa: E731
    loop = chain(4, [(0, 0), (2, 0)], [follows])
    start = [0, 1, 1, 1, 2, 1, *[0] * 6]
    motion = propagate(loop, (0, 50), start, method=Rattle(4), step=0.01, samples=200)
    assert motion.multipliers.shape[0] == 5
    assert abs(motion.residuals).max() < 1e-14
    assert worst_residual(motion, chain(4, [(0, 0), (2, 0)], [follows])) < 8 * U
    assert abs(motion.energy_error).max() < 1e-3


@pytest.mark.slow
def test_a_closed_loop_moves_as_by_taylors_method():
    loop, start = chain(4, [(0, 0), (2, 0)]), [0, 1, 1, 1, 2, 1, *[0] * 6]
    true = propagate(loop, (0, 2), start, samples=1).final
    found = propagate(loop, (0, 2), start, method=Rattle(4), step=0.005, samples=1).final
    assert abs(found - true).max() < 1e-8


@pytest.mark.slow
def test_a_long_chain():
    """More constraints than are eliminated in registers."""
    links = 9
    hung = chain(links + 1, [(0, 0)])
    start = [z for i in range(1, links + 1) for z in (i, 0)] + [0] * (2 * links)
    motion = propagate(hung, (0, 5), start, method=Rattle(4), step=0.005, samples=100)
    assert worst_residual(motion, hung) < 4 * U
    true = propagate(hung, (0, 1), start, samples=1).final
    assert (
        abs(propagate(hung, (0, 1), start, method=Rattle(4), step=0.0025, samples=1).final - true).max()
        < 1e-7
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "start"), [(CARTESIAN, START), (POLAR, POLAR_START)], ids=["rods", "polar"]
)
def test_precisions_differ_by_their_rounding(system, start):
    ends = {
        precision: propagate(
            system, (0, 1), start, method=Rattle(2), step=0.125, samples=1, precision=precision
        )
        for precision in ("single", "double", "compensated", "extended", "double-double")
    }
    true = ends["double-double"]
    assert abs(true.residuals).max() < 1e-30
    for precision, unit in (("single", 3e-6), ("double", 5e-15), ("compensated", 2e-15), ("extended", 3e-18)):
        found = ends[precision]
        assert abs((found.y - true.y) + (found.carried - true.carried)).max() < unit


def test_same_bits_among_others_resumed_and_kept(tmp_path):
    arguments = {"method": Rattle(4), "step": 0.02}
    one = propagate(CARTESIAN, (0, 2), START, samples=7, **arguments)
    many = propagate(CARTESIAN, (0, 2), np.array(START)[:, None] * [1.0, 1.0], samples=7, **arguments)
    np.testing.assert_array_equal(many.y[:, :, 1], one.y)
    half = propagate(CARTESIAN, (0, 1), START, samples=3, **arguments)
    np.testing.assert_array_equal(half.resume(2).final, one.final)
    half.save(tmp_path / "half.npz")
    np.testing.assert_array_equal(load_motion(tmp_path / "half.npz").resume(2).final, one.final)


def test_parameters_by_orbit():
    length, g = parameters("l g", positive=True)
    L = Lagrangian((x.dot**2 + y.dot**2) / 2 - g * y, [x, y])
    pendulum = ConstrainedLagrangian(L, [x**2 + y**2 - length**2])
    start = np.array([[1.0, 2.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    setting = {"method": Rattle(2), "step": 0.02, "samples": 1}
    both = propagate(pendulum, (0, 2), start, parameters={length: np.array([1.0, 2.0]), g: 3}, **setting)
    one = propagate(pendulum, (0, 2), start[:, 1], parameters={length: 2, g: 3}, **setting)
    assert abs(both.final[:, 1] - one.final).max() < 1e-14


# trouble ---------------------------------------------------------------------------------------------


def test_constraints_that_become_dependent_on_the_way_are_told_with_the_state_before():
    crossing = ConstrainedLagrangian(Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y]), holonomic=[x * y])
    with pytest.raises(
        NonFiniteStateError, match=r"the constraints become dependent in the step after t = 0\.875"
    ) as caught:
        propagate(crossing, (0, 3), [1, 0, -1, 0], method=Rattle(2), step=0.125)
    np.testing.assert_array_equal(caught.value.state, [0.125, 0, -1, 0])


def test_a_step_that_is_too_large_is_told_with_the_state_before():
    pendulum = ConstrainedLagrangian(
        Lagrangian((x.dot**2 + y.dot**2) / 2 - y, [x, y]), holonomic=[x**2 + y**2 - 1]
    )
    with pytest.raises(
        NonFiniteStateError, match=r"the multipliers of step 1 do not converge .*smaller step"
    ) as caught:
        propagate(pendulum, (0, 30), [1, 0, 0, 3], method=Rattle(2), step=2)
    np.testing.assert_array_equal(caught.value.state, [1, 0, 0, 3])


FREE = Lagrangian((x.dot**2 + y.dot**2) / 2 - y, [x, y])


@pytest.mark.parametrize(
    ("system", "start", "message"),
    [
        (CARTESIAN, [1, 0.01, 1, 1, 0, 0, 0, 0], "the start is not on the constraints"),
        (CARTESIAN, [1, 0, 1, 1, 1, 0, 0, 0], "the rate of constraint 1 is 2 there"),
        (
            ConstrainedLagrangian(FREE, [], [x * y.dot]),
            [1, 0, 1, 0],
            "holonomic constraints, not 1 constraint on vel",
        ),
        (ConstrainedLagrangian(FREE, [x - time**2]), [0, 0, 0, 0], "do not hold the time"),
        (
            ConstrainedLagrangian(Lagrangian(FREE.L, [x, y], forces=[-x.dot, 0]), [x]),
            [0, 0, 0, 0],
            "forces that L holds",
        ),
        (
            ConstrainedLagrangian(Lagrangian(x.dot**2 / 2 + x * y, [x, y]), [y - x**2]),
            [1, 1, 0, 0],
            "the mass matrix is singular along y",
        ),
        (
            ConstrainedLagrangian(Lagrangian(x.dot**4 / 4 + y.dot**2, [x, y]), [y - x]),
            [1, 1, 1, 1],
            "masses that do not",
        ),
    ],
)
def test_what_rattle_is_not_for_is_refused(system, start, message):
    with pytest.raises(ValueError, match=message):
        propagate(system, (0, 1), start, method=Rattle(), step=0.1)


def test_without_constraints_other_methods_are_named():
    with pytest.raises(TypeError, match="Rattle is for a ConstrainedLagrangian"):
        propagate(FREE, (0, 1), [0, 0, 0, 0], method="rattle-4", step=0.1)
    with pytest.raises(ValueError, match="this is none; Splitting"):
        propagate("kepler", (0, 1), method=Rattle(), step=0.1)
    with pytest.raises(ValueError, match=r"Rattle\(3\): the order is one of 2, 4, 6, 8"):
        Rattle(3)
    with pytest.raises(ValueError, match="derivative of steps that keep constraints"):
        flow_jacobian(CARTESIAN, (0, 1), START, method=Rattle(), step=0.1)


def test_a_choice_considers_it_where_it_applies():
    rubbing = ConstrainedLagrangian(Lagrangian(FREE.L, [x, y], forces=[-x.dot, 0]), [x**2 + y**2 - 1])
    pendulum, start = ConstrainedLagrangian(FREE, [x**2 + y**2 - 1]), np.array([1.0, 0.0, 0.0, 0.0])
    assert Rattle(4) in candidate_methods(Question(pendulum, start, {}, 10.0))
    assert not any(isinstance(m, Rattle) for m in candidate_methods(Question(rubbing, start, {}, 10.0)))
