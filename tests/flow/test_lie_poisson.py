"""Lie–Poisson splittings: order, reversal, Poisson maps, Casimirs to rounding, closed forms of bodies and tops."""

import functools
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import example, given, settings
from hypothesis import strategies as st

from canon import (
    Hamiltonian,
    Study,
    VectorField,
    choose,
    coordinates,
    drift,
    drift_study,
    load_motion,
    parameters,
    propagate,
    results_of,
    run_study,
)
from canon.expression.symbols.symbol import time
from canon.flow import LiePoissonSplitting, reversal_error
from canon.flow.fixed_step.compiled_loop import steps_between
from canon.flow.fixed_step.partial_step import LoopState
from canon.flow.method.method import RK4
from canon.flow.request import Request
from canon.flow.run.sampling_plan import fixed_plan
from canon.flow.system_request import any_task
from canon.kernel.loops.lie_poisson import lie_poisson_loop, palindrome
from canon.mechanics import (
    ANGULAR_MOMENTUM,
    EULER_PARAMETERS,
    VERTICAL,
    PoissonSystem,
    attitude_matrix,
    free_body,
    heavy_top,
    rotating_body,
)
from canon.scene import find
from canon.study.energy_drift.drift import Growth
from canon.study.method_choice.candidate import candidate_methods
from canon.study.method_choice.choice_question import Question

U = 2.0**-53
R = attitude_matrix()
M, e, Gamma = ANGULAR_MOMENTUM, EULER_PARAMETERS, VERTICAL
FREE = free_body([1, 2, 3])
TOP = heavy_top([1, sp.Rational(3, 2), 2], Gamma[2] + 3 * Gamma[0] / 10)
BODY = rotating_body([1, sp.Rational(3, 2), 2], R[2, 2] + 3 * R[2, 0] / 10)
SYMMETRIC = rotating_body([1, 1, 2], R[2, 2] ** 2 + R[2, 0])
START = [0.3, 0.5, 1.2]
TOP_START = [*START, 0.6, 0.0, 0.8]
BODY_START = [*START, 0.8, 0.0, 0.6, 0.0]
CASES = {
    "free": (FREE, START),
    "top": (TOP, TOP_START),
    "body": (BODY, BODY_START),
    "symmetric": (SYMMETRIC, BODY_START),
}
cases = pytest.mark.parametrize(("system", "start"), CASES.values(), ids=CASES)


def quick(chosen):
    """The cases of which one is run always, the others with the slow ones."""
    marks = {name: () if name == chosen else pytest.mark.slow for name in CASES}
    some = [pytest.param(*case, id=name, marks=marks[name]) for name, case in CASES.items()]
    return pytest.mark.parametrize(("system", "start"), some)


def end_error(system, start, method, steps, true):
    return abs(propagate(system, (0, 5), start, method=method, step=5 / steps, samples=1).final - true).max()


@pytest.mark.parametrize("order", [4, *(pytest.param(n, marks=pytest.mark.slow) for n in (2, 6))])
def test_halving_the_step_divides_the_error_by_two_to_the_order(order):
    with mpmath.workdps(30):
        errors = [float(free_body_error(order, step, "compensated", [10])) for step in (0.25, 0.125)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.05 * order)


@pytest.mark.slow
@cases
@pytest.mark.parametrize("order", [2, 4, 6, 8])
def test_fitted_order(system, start, order):
    true = propagate(system, (0, 5), start, samples=1).final
    steps = {2: 100, 4: 60, 6: 36, 8: 16}[order]
    if system is FREE:
        steps //= 2
    errors = [end_error(system, start, LiePoissonSplitting(order), n, true) for n in (steps, 2 * steps)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.06 * order)


@quick("free")
def test_time_reversal(system, start):
    assert abs(reversal_error(system, (0, 20), start, method=LiePoissonSplitting(4), step=0.1)).max() < 4e-15


def stepper(system, start, stages=None):
    """One compiled step as a map of states, in the order of the variables."""
    method = LiePoissonSplitting(2)
    task, _ = any_task(Request(system, (0, 1), start, method=method, step=1.0))
    loop = lie_poisson_loop(task.system, task.system.lie_poisson, 1, compensated=False, stages=stages)
    dimension = len(task.system.q) * 2

    def moved(y, direction=1):
        full = np.zeros((dimension, 1))
        full[task.system.rows, 0] = y
        steps = steps_between(loop, method, fixed_plan(0, Fraction(direction, 8), (0, 1)))
        return steps.whole(LoopState(full, np.zeros((dimension, 1)), np.zeros((1, 0))), 0, 1).high[
            task.system.rows, 0
        ]

    return moved, task.system.lie_poisson


@pytest.mark.parametrize("case", ["free", pytest.param("body", marks=pytest.mark.slow)])
def test_parts_in_another_order_do_not_come_back(case):
    _, parts = stepper(*CASES[case])
    wrong = sorted({part: 1 for part, _ in palindrome(parts)}.items())
    defects = []
    for stages in (None, wrong):
        step, _ = stepper(*CASES[case], stages)
        y = np.array(CASES[case][1])
        defects.append(abs(step(step(y), -1) - y).max())
    assert defects[0] < 4e-16
    assert defects[1] > 1e-4


def brackets_at(system, y):
    return np.array(sp.lambdify(system.x, system.structure, "mpmath")(*y).tolist())


def poisson_defect(system, start, method, precision, delta, span=0.5):
    """The largest entry of J Π(y) Jᵀ − Π(y′) of some steps y → y′, J by differences of tenth order."""
    n, weights = len(start), {1: sp.Rational(5, 6), 2: sp.Rational(-5, 21), 3: sp.Rational(5, 84)}
    weights |= {4: sp.Rational(-5, 504), 5: sp.Rational(1, 1260)}
    weights = {k: mpmath.mpf(w.p) / w.q for k, w in weights.items()}
    places = [(0, 0), *((i, sign * k) for i in range(n) for k in weights for sign in (1, -1))]
    y = [mpmath.mpf(x) for x in start]
    states = [[x + k * delta * (i == j) for j, x in enumerate(y)] for i, k in places]
    found = propagate(
        system,
        (0, span),
        np.array(states, dtype=object).T,
        method=method,
        step=0.25,
        samples=1,
        precision=precision,
    )
    ends = {
        place: [mpmath.mpf(a) + mpmath.mpf(b) for a, b in zip(high, low, strict=True)]
        for place, high, low in zip(places, found.y[:, -1].T, found.carried[:, -1].T, strict=True)
    }
    J = np.array(
        [
            [
                sum(w * (ends[i, k][row] - ends[i, -k][row]) for k, w in weights.items()) / delta
                for i in range(n)
            ]
            for row in range(n)
        ]
    )
    return abs(J @ brackets_at(system, y) @ J.T - brackets_at(system, ends[0, 0])).max()


@pytest.mark.parametrize("case", ["top", pytest.param("symmetric", marks=pytest.mark.slow)])
def test_steps_are_poisson_maps(case):
    with mpmath.workdps(20):
        method, delta = LiePoissonSplitting(2), mpmath.mpf(2) ** -6
        assert poisson_defect(*CASES[case], method, "double", delta) < 2e-13


@pytest.mark.slow
@cases
@pytest.mark.parametrize("order", [2, 4])
def test_steps_are_poisson_maps_to_twenty_digits(system, start, order):
    with mpmath.workdps(40):
        delta = mpmath.mpf(2) ** -9
        assert poisson_defect(system, start, LiePoissonSplitting(order), "double-double", delta) < 1e-21
        assert poisson_defect(system, start, RK4(), "double-double", delta) > 1e-8


def casimirs(system, motion):
    """Values of the Casimir functions along a motion, in long doubles."""
    y = motion.y.astype(np.longdouble) + motion.carried
    if len(y) == 3:
        return [(y**2).sum(axis=0)]
    square = (y[3:] ** 2).sum(axis=0)
    return [square, (y[:3] * y[3:]).sum(axis=0)] if len(y) == 6 else [square]


def worst_change(system, motion):
    return max(float(abs(value - value[0]).max()) for value in casimirs(system, motion))


@quick("top")
def test_casimirs_are_kept_to_round_off_over_a_hundred_thousand_steps(system, start):
    motion = propagate(system, (0, 10_000), start, method=LiePoissonSplitting(2), step=0.1, samples=1000)
    assert motion.steps == 100_000
    assert worst_change(system, motion) < 100 * U
    error = abs(motion.energy_error)
    assert error.max() < 1e-2
    assert error[-100:].max() < 3 * error[1:101].max()


@pytest.mark.slow
@cases
def test_casimirs_wander_less_than_the_root_of_the_steps(system, start):
    motion = propagate(system, (0, 10**6), start, method=LiePoissonSplitting(2), step=0.1, samples=1000)
    assert worst_change(system, motion) < U * np.sqrt(motion.steps)
    in_doubles = propagate(
        system, (0, 10**5), start, method=LiePoissonSplitting(2), step=0.1, samples=1000, precision="double"
    )
    assert worst_change(system, in_doubles) < 20 * U * np.sqrt(in_doubles.steps)


@pytest.mark.slow
def test_a_turn_by_the_same_angle_again_and_again_does_not_drift():
    """What rounding does to a sine and a cosine would add up: angles of symmetric bodies are the same in each step."""
    for inertia in ([1, 1, 1], [1, 1, 2], [2, 1, 1]):
        for step in (0.1, 0.37, 1.0, 4.0):
            motion = propagate(
                rotating_body(inertia),
                (0, step * 10**6),
                BODY_START,
                method=LiePoissonSplitting(2),
                step=step,
            )
            assert worst_change(BODY, motion) < 6 * U * 1000


@pytest.mark.slow
def test_the_energy_of_runge_and_kutta_drifts_where_that_of_the_splitting_is_bounded():
    setting = {"step": 0.25, "samples": 400}
    kept = abs(propagate(TOP, (0, 2000), TOP_START, method=LiePoissonSplitting(4), **setting).energy_error)
    lost = abs(propagate(TOP, (0, 2000), TOP_START, method=RK4(), **setting).energy_error)
    assert kept[-40:].max() < 2 * kept[1:41].max()
    assert lost[-40:].min() > 5 * lost[1:41].max()


# closed forms ----------------------------------------------------------------------------------------


def jacobis_motion(inertia, energy, square, t):
    """M of a free body at times in mpmath's numbers (Landau & Lifshitz, Mechanics, § 37), M² > 2 E I₂, from M₂ = 0."""
    A, B, C = map(mpmath.mpf, inertia)
    first = mpmath.sqrt(A * (2 * energy * C - square) / (C - A))
    second = mpmath.sqrt(B * (2 * energy * C - square) / (C - B))
    third = mpmath.sqrt(C * (square - 2 * energy * A) / (C - A))
    rate = mpmath.sqrt((C - B) * (square - 2 * energy * A) / (A * B * C))
    m = (B - A) * (2 * energy * C - square) / ((C - B) * (square - 2 * energy * A))
    sn, cn, dn = (mpmath.ellipfun(name, rate * t, m=m) for name in ("sn", "cn", "dn"))
    return [first * cn, second * sn, third * dn]


def free_body_error(order, step, precision, times=(2.5, 5.0, 10.0)):
    start = [mpmath.mpf("0.4"), mpmath.mpf(0), mpmath.mpf(1)]
    energy, square = start[0] ** 2 / 2 + start[2] ** 2 / 6, start[0] ** 2 + start[2] ** 2
    motion = propagate(
        FREE, (0, 10), [str(x) for x in start], method=LiePoissonSplitting(order), step=step, times=times,
        precision=precision,
    )  # fmt: skip
    errors = []
    for k, t in enumerate(motion.t):
        true = jacobis_motion((1, 2, 3), energy, square, mpmath.mpf(float(t)))
        found = [
            mpmath.mpf(a) + mpmath.mpf(b) for a, b in zip(motion.y[:, k], motion.carried[:, k], strict=True)
        ]
        errors.append(max(abs(a - b) for a, b in zip(found, true, strict=True)))
    return max(errors)


def test_the_free_body_moves_by_jacobis_functions():
    with mpmath.workdps(30):
        assert free_body_error(8, 0.125, "compensated") < 4e-15


@pytest.mark.slow
def test_the_free_body_moves_by_jacobis_functions_to_many_digits():
    with mpmath.workdps(40):
        assert free_body_error(8, 2.0**-8, "double-double") < 1e-27


@pytest.mark.slow
def test_a_symmetric_free_body_moves_exactly_whatever_the_step():
    body, method = rotating_body([2, 2, 1]), LiePoissonSplitting(2)
    true = propagate(body, (0, 21), BODY_START, samples=1).final
    assert (
        abs(propagate(body, (0, 21), BODY_START, method=method, step=7, samples=1).final - true).max() < 1e-14
    )


@pytest.mark.slow
def test_lagranges_top_nutates_as_its_scene_does():
    scene = find("lagrange-top")
    value = {name: sp.Float(x, 17) for name, x in scene.values.items()}
    A, C, weight = value["A"], value["C"], value["m"] * value["g"] * value["l"]
    top, spin = heavy_top([A, A, C], weight * Gamma[2]), 150.0
    start = [0.0, 0.0, float(C) * spin, 0.0, float(np.sin(0.5)), float(np.cos(0.5))]
    motion = propagate(top, (0, 1), start, method=LiePoissonSplitting(6), step=1e-3, samples=50)
    (solution, *_) = scene.solutions
    assert solution.start == "cusps"
    true = solution.value(scene.values, motion.t)
    assert abs(motion["Gamma_3"] - true).max() < 1e-11
    fallen = heavy_top([A, A, C], -weight * Gamma[2])
    wrong = propagate(fallen, (0, 1), start, method=LiePoissonSplitting(6), step=1e-3, samples=50)
    assert abs(wrong["Gamma_3"] - true).max() > 1e-3


@pytest.mark.slow
def test_vertical_and_attitude_move_alike():
    top = propagate(
        TOP, (0, 5), [*START, "0.96", 0, "-0.28"], method=LiePoissonSplitting(4), step=0.05, samples=10
    )
    body = propagate(
        BODY, (0, 5), [*START, "0.6", 0, "-0.8", 0], method=LiePoissonSplitting(4), step=0.05, samples=10
    )
    row = np.array([sp.lambdify(e, R[2, i])(*body.y[3:]) for i in range(3)])
    np.testing.assert_allclose(row, top.y[3:], atol=2e-15)


# brackets ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("system", [FREE, TOP, BODY])
def test_brackets_obey_jacobis_identity_and_with_a_wrong_sign_they_do_not(system):
    assert system.is_poisson()
    assert system.is_constant_of_motion(system.H)
    if system is FREE:
        return
    wrong = system.structure.as_mutable()
    wrong[:3, 3:], wrong[3:, :3] = -wrong[:3, 3:], -wrong[3:, :3]
    assert PoissonSystem(system.H, system.x, wrong).is_poisson().fails


def test_casimirs_and_their_wrong_twins():
    assert TOP.is_casimir(sum(g**2 for g in Gamma))
    assert TOP.is_casimir(sum(a * b for a, b in zip(M, Gamma, strict=True)))
    assert TOP.is_casimir(sum(m**2 for m in M)).fails
    assert BODY.is_casimir(sum(x**2 for x in e))
    assert BODY.is_casimir(e[0] ** 2 + e[1] ** 2 - e[2] ** 2).fails
    vertical = sum(M[i] * R[2, i] for i in range(3))
    assert BODY.is_constant_of_motion(vertical)
    assert BODY.is_constant_of_motion(sum(M[i] * R[1, i] for i in range(3))).fails
    kovalevskaya = heavy_top([2, 2, 1], Gamma[0])
    w1, w2 = M[0] / 2, M[1] / 2
    integral = (w1**2 - w2**2 - Gamma[0]) ** 2 + (2 * w1 * w2 - Gamma[1]) ** 2
    assert kovalevskaya.is_constant_of_motion(integral)
    assert kovalevskaya.is_constant_of_motion(
        (w1**2 - w2**2 + Gamma[0]) ** 2 + (2 * w1 * w2 - Gamma[1]) ** 2
    ).fails


# many orbits, and going on ------------------------------------------------------------------------------


def test_same_bits_among_others_resumed_and_kept(tmp_path):
    arguments = {"method": LiePoissonSplitting(4), "step": 0.125}
    one = propagate(FREE, (0, 4), START, samples=8, **arguments)
    many = propagate(FREE, (0, 4), np.array(START)[:, None] * np.ones(9), samples=8, **arguments)
    np.testing.assert_array_equal(many.y[:, :, 4], one.y)
    half = propagate(FREE, (0, 2), START, samples=4, **arguments)
    np.testing.assert_array_equal(half.resume(4).final, one.final)
    half.save(tmp_path / "half.npz")
    np.testing.assert_array_equal(load_motion(tmp_path / "half.npz").resume(4).final, one.final)


@pytest.mark.slow
def test_parameters_by_orbit():
    A, w = parameters("A w", positive=True)
    top, weights = rotating_body([A, 1, 2], w * R[2, 2]), np.array([1.0, 2.0, 3.0])
    setting = {"method": LiePoissonSplitting(4), "step": 0.125, "samples": 1}
    both = propagate(top, (0, 4), BODY_START, parameters={A: [1.5, 1.5, 1.25], w: weights}, **setting)
    one = propagate(
        top, (0, 4), BODY_START, parameters={A: 1.25, w: 3}, method=LiePoissonSplitting(8), step=0.03125
    )
    assert abs(both.final[:, 2] - one.final).max() < 1e-4
    assert abs(both.energy_error).max() < 1e-4


@pytest.mark.slow
@cases
def test_precisions_differ_by_their_rounding(system, start):
    ends = {
        precision: propagate(
            system, (0, 2), start, method=LiePoissonSplitting(4), step=0.125, samples=1, precision=precision
        )
        for precision in ("single", "double", "compensated", "extended", "double-double")
    }
    true = ends["double-double"]
    for precision, unit in (("single", 5e-6), ("double", 1e-14), ("compensated", 2e-15), ("extended", 5e-18)):
        found = ends[precision]
        assert abs((found.y - true.y) + (found.carried - true.carried)).max() < unit


# parts, and trouble -------------------------------------------------------------------------------------


@functools.cache
def parts_of(system):
    return stepper(system, START + ([1] + [0] * (len(system.x) - 4) if len(system.x) > 3 else []))[1]


@pytest.mark.slow
def test_the_middle_moment_of_inertia_leaves_two_turns_and_a_symmetric_body_one():
    found = [
        [len(p.turns), len(p.commons), *map(len, p.kicks)]
        for p in map(parts_of, (FREE, TOP, BODY, SYMMETRIC))
    ]
    assert found == [[2, 0], [2, 1, 3], [2, 1, 3], [1, 1, 3]]
    spherical = rotating_body([2, 2, 2])
    assert [len(parts_of(spherical).turns), len(parts_of(spherical).commons)] == [0, 1]


def test_h_may_be_written_as_a_product():
    product = PoissonSystem(
        (M[0] ** 2 + M[1] ** 2) * (1 + 1) / 3 + (M[0] + M[2]) ** 2 - 2 * M[0] * M[2], M, FREE.structure
    )
    assert len(parts_of(product).turns) > 0


x = coordinates("x")


@pytest.mark.parametrize(
    ("system", "start", "message"),
    [
        (PoissonSystem(M[0] * M[1], M, FREE.structure), START, r"H couples M_1 with M_2: .* inertia is diagonal"),
        (PoissonSystem(M[0] * Gamma[0], TOP.x, TOP.structure), TOP_START, r"H couples M_1 with Gamma_1"),
        (PoissonSystem(M[0] ** 2 * time, M, FREE.structure), START, "H that does not hold the time"),
        (PoissonSystem(M[0], [x, M[0], M[1]], [[0, x, 0], [-x, 0, 0], [0, 0, 0]]), START, "depends on M_1 has no flow"),
        (PoissonSystem(M[0] * 0, M, FREE.structure), START, "every motion rests"),
    ],
)  # fmt: skip
def test_what_has_no_parts_is_refused(system, start, message):
    with pytest.raises(ValueError, match=message):
        propagate(system, (0, 1), start, method=LiePoissonSplitting(), step=0.1)


def test_other_systems_and_orders_are_refused():
    oscillator = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])
    with pytest.raises(
        ValueError, match=r"LiePoissonSplitting moves a PoissonSystem, .* Splitting, Gauss and Taylor"
    ):
        propagate(oscillator, (0, 1), [1, 0], method="lie-poisson-4", step=0.1)
    with pytest.raises(TypeError, match="LiePoissonSplitting is for a PoissonSystem"):
        propagate(VectorField([-x], [x]), (0, 1), [1], method=LiePoissonSplitting(), step=0.1)
    with pytest.raises(ValueError, match=r"LiePoissonSplitting\(3\): the order is one of 2, 4, 6, 8"):
        LiePoissonSplitting(3)
    with pytest.raises(ValueError, match="made for a Hamiltonian"):
        propagate(FREE, (0, 1), START, method="verlet", step=0.1)
    with pytest.raises(ValueError, match="inertia has 2 entries for 3 principal axes"):
        free_body([1, 2])
    with pytest.raises(
        ValueError, match=r"inertia = \['1', '1', '0'\]: principal moments of inertia are positive"
    ):
        heavy_top([1, 1, 0], Gamma[2])
    C = parameters("C")
    with pytest.raises(ZeroDivisionError, match="the expression divides by zero"):
        propagate(free_body([1, 2, C]), (0, 1), START, method="lie-poisson", step=0.1, parameters={C: 0})
    with pytest.raises(ValueError, match=r"a matrix of 2 × 2 brackets for 3 variables"):
        PoissonSystem(M[0], M, sp.eye(2))


@pytest.mark.slow
def test_a_choice_considers_it_where_it_applies():
    methods = candidate_methods(Question(TOP, np.array(TOP_START), {}, 10.0))
    assert LiePoissonSplitting(4) in methods
    coupled = PoissonSystem(M[0] * M[1], M, FREE.structure)
    others = candidate_methods(Question(coupled, np.array(START), {}, 10.0))
    assert not any(isinstance(m, LiePoissonSplitting) for m in others)
    found = choose(TOP, 1000.0, TOP_START, accuracy=1e-6, methods=[LiePoissonSplitting(4)])
    assert abs(found.run().energy_error).max() < 1e-6


@pytest.mark.slow
def test_its_drift_is_judged():
    motion = propagate(TOP, (0, 20_000), TOP_START, method=LiePoissonSplitting(4), step=0.2)
    assert drift(motion).verdict is Growth.BOUNDED
    casimir = {"M Γ": sum(a * b for a, b in zip(M, Gamma, strict=True))}
    methods = [LiePoissonSplitting(4), RK4()]
    kept, lost = drift_study(TOP, TOP_START, methods=methods, span=20_000, step=0.2, observables=casimir).rows
    assert abs(kept.error).max() < 1e-13
    assert abs(lost.error).max() > 1e-3


@pytest.mark.slow
def test_studies_take_rotating_bodies(tmp_path):
    study = Study.of(
        system=BODY, start=[BODY_START], method="lie-poisson-4", step=[0.2, 0.1], span=200.0, samples=500
    )
    assert run_study(study, tmp_path / "bodies.sqlite").failed == 0
    coarse, fine = (result.numbers["bound"] for result in results_of(tmp_path / "bodies.sqlite"))
    assert 2.0**3 < coarse / fine < 2.0**5


numbers = st.floats(-2, 2).map(lambda z: round(z, 3))


@pytest.mark.filterwarnings("ignore::canon.AccuracyWarning")
@settings(max_examples=50, deadline=None)
@given(
    inertia=st.lists(st.floats(0.2, 5).map(lambda z: round(z, 2)), min_size=3, max_size=3),
    weights=st.lists(numbers, min_size=3, max_size=3),
    momentum=st.lists(numbers, min_size=3, max_size=3),
    axis=st.tuples(numbers, numbers, numbers),
    step=st.floats(0.01, 2),
)
@example(inertia=[0.25, 2.0, 1.0], weights=[1, 0, 0], momentum=[0, 0, 1], axis=(0, 1, 0), step=2.0)
def test_laws_of_any_top(inertia, weights, momentum, axis, step):
    """Casimirs to round-off after a hundred steps, however large, and the way back to the start after five."""
    V = sum(w * g for w, g in zip(weights, Gamma, strict=True)) + weights[0] * Gamma[1] ** 2
    size = np.linalg.norm([*axis, 1e-3])
    vertical = [float(x) for x in (*axis[:2], axis[2] + 1e-3) / size]
    start, method = [*momentum, *vertical], LiePoissonSplitting(2)
    top = heavy_top(inertia, V)
    motion = propagate(top, (0, 100 * step), start, method=method, step=step * (1 + 1e-12), samples=10)
    largest = abs(motion.y[:3]).max() + 1
    assert worst_change(top, motion) < 100 * U * largest
    how = {"method": method, "step": step * (1 + 1e-12)}
    there = propagate(top, (0, 5 * step), start, samples=5, **how)
    error, bound = (
        abs(reversal_error(top, (0, 5 * step), start, **how)).max(),
        100 * U * (1 + abs(there.y).max()),
    )
    if error >= bound:  # what the way back enlarges is asked for where it matters only
        bound *= max(
            growth_to_the_start(top, t, y, how) for t, y in zip(there.t[1:], there.y[:, 1:].T, strict=True)
        )
    assert error < bound


def growth_to_the_start(top, t, y, how):
    """Return by how much the way back to the start enlarges a small error of the state at a time."""
    small = 1e-6
    states = y[:, np.newaxis] + small * np.hstack([np.zeros((6, 1)), np.eye(6)])
    back = propagate(top, (float(t), 0.0), states, samples=1, **how).y[:, -1]
    return np.linalg.norm((back[:, 1:] - back[:, :1]) / small, 2)


@pytest.mark.parametrize("structure", [[[0, 1], [1, 0]], [[1, 0], [0, 0]], [[0, 1], [-2, 0]]])
def test_a_bracket_is_antisymmetric(structure):
    x, y = sp.symbols("x y", real=True)
    assert PoissonSystem(x**2 + y**2, [x, y], [[0, x], [-x, 0]]).is_poisson()
    assert PoissonSystem(x**2 + y**2, [x, y], structure).is_poisson().fails
