"""Boris's push and magnetic splittings: order, reversal, volume and symplecticity, closed forms, mirror, trouble."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import Hamiltonian, choose, coordinates, flow_jacobian, load_motion, parameters, propagate
from canon.expression.symbols.symbol import time
from canon.flow import Boris, MagneticSplitting, lyapunov_spectrum, reversal_error
from canon.flow.method.method import RK4
from canon.scene import find
from canon.study.method_choice.candidate import candidate_methods
from canon.study.method_choice.choice_question import Question

x, y, z = Q = coordinates("x y z")
P = [s.momentum for s in Q]


def charge(A, phi, masses=(1, 1, 1), q=Q):
    """H of a unit charge in the potentials."""
    p = [s.momentum for s in q]
    return Hamiltonian(
        sum((a - b) ** 2 / (2 * m) for a, b, m in zip(p, A, masses, strict=True)) + phi, list(q), p
    )


BOWL = (x**2 + y**2 + 2 * z**2) / 10 + x * z / 7
CURVED_A = [-y * (1 + z**2) / 2, x * (1 + z**2) / 2, x * y**2 / 5]
CURVED = charge(CURVED_A, BOWL)
CURVED_START = [1, 0, 0.3, 0.2, 0.7, 0.1]
PLANE = charge([0, x + x**2 / 2], (x**2 + y**2) ** 2 / 4, (1, 1), (x, y))
PLANE_START = [1, 0, 0.1, 1.2]
UNEQUAL = charge(CURVED_A, BOWL, (1, 2, sp.Rational(1, 2)))
DRIVEN = charge([-y * (2 + sp.sin(time)) / 2, x * (2 + sp.sin(time)) / 2], x * sp.cos(time), (1, 1), (x, y))
METHODS = [Boris(2), Boris(4), MagneticSplitting(2), MagneticSplitting(4)]
every = pytest.mark.parametrize("method", METHODS, ids=str)


def ratio(system, start, method, steps, span=3):
    """log₂ of the errors with steps and with steps of half the size."""
    true = propagate(system, (0, span), start, method=RK4(), step=span / 30_000, samples=1).final
    errors = [
        abs(propagate(system, (0, span), start, method=method, step=span / n, samples=1).final - true).max()
        for n in (steps, 2 * steps)
    ]
    return np.log2(errors[0] / errors[1])


@every
def test_halving_the_step_divides_the_error_by_two_to_the_order(method):
    assert ratio(PLANE, PLANE_START, method, 60) == pytest.approx(method.order, abs=0.06 * method.order)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "start"),
    [(CURVED, CURVED_START), (UNEQUAL, CURVED_START), (DRIVEN, [1, 0, 0.1, 0.5])],
    ids=["curved", "unequal", "driven"],
)
@pytest.mark.parametrize(
    "method", [kind(n) for kind in (Boris, MagneticSplitting) for n in (2, 4, 6, 8)], ids=str
)
def test_fitted_order(system, start, method):
    if system is DRIVEN and isinstance(method, MagneticSplitting):
        with pytest.raises(ValueError, match="H holds the time"):
            propagate(system, (0, 3), start, method=method, step=0.1)
        return
    steps = {2: 100, 4: 60, 6: 30, 8: 12}[method.order]
    assert ratio(system, start, method, steps) == pytest.approx(method.order, abs=0.08 * method.order)


@every
def test_time_reversal(method):
    assert abs(reversal_error(PLANE, (0, 10), PLANE_START, method=method, step=0.1)).max() < 1e-14


@pytest.mark.parametrize(
    ("system", "start"),
    [
        (PLANE, PLANE_START),
        pytest.param(CURVED, CURVED_START, marks=pytest.mark.slow),
        pytest.param(UNEQUAL, CURVED_START, marks=pytest.mark.slow),
    ],
    ids=["plane", "curved", "unequal"],
)
def test_the_splitting_is_symplectic_and_boris_keeps_volume_alone(system, start):
    for order in (2,) if system is PLANE else (2, 4):
        exact = flow_jacobian(system, (0, 1), start, method=MagneticSplitting(order), step=0.125)
        assert exact.symplecticity_defect[-1] < 4e-15
        push = flow_jacobian(system, (0, 1), start, method=Boris(order), step=0.125)
        assert push.symplecticity_defect[-1] > {2: 1e-4, 4: 1e-8}[order]
        assert np.linalg.det(push.final) == pytest.approx(1, abs=4e-15)
    lost = flow_jacobian(system, (0, 1), start, method=RK4(), step=0.125)
    assert abs(np.linalg.det(lost.final) - 1) > 1e-9


@pytest.mark.slow
@every
@pytest.mark.parametrize(
    ("system", "start"), [(CURVED, CURVED_START), (PLANE, PLANE_START)], ids=["curved", "plane"]
)
def test_jacobians_are_the_derivatives_of_the_steps(system, start, method):
    found = flow_jacobian(system, (0, 1), start, method=method, step=0.125).final
    weights, delta = {1: 45, 2: -9, 3: 1}, 2.0**-9
    for i, column in enumerate(found.T):
        ends = {
            k: propagate(
                system,
                (0, 1),
                np.array(start, dtype=float) + k * delta * np.eye(len(start))[i],
                method=method,
                step=0.125,
                samples=1,
            ).final
            for k in (-3, -2, -1, 1, 2, 3)
        }
        slope = sum(w * (ends[k] - ends[-k]) for k, w in weights.items()) / (60 * delta)
        np.testing.assert_allclose(slope, column, atol=1e-11)


# closed forms ----------------------------------------------------------------------------------------


def test_cyclotron_motion_in_a_uniform_field():
    """From the origin with v = (1, 0): a circle about (0, −1/ω), of which Boris's step turns 2 atan(ω h/2)."""
    H, h, n = charge([-3 * y / 2, 3 * x / 2], 0, (1, 1), (x, y)), 0.125, 400
    motion = propagate(H, (0, n * h), [0, 0, 1, 0], method=Boris(), step=h, samples=n)
    v = motion["p_x"] + 3 * motion["y"] / 2, motion["p_y"] - 3 * motion["x"] / 2
    angle = 2 * np.arctan(3 * h / 2) * np.arange(n + 1)
    np.testing.assert_allclose(v, [np.cos(angle), -np.sin(angle)], atol=2e-13)
    assert abs(np.hypot(*v) - 1).max() < 2e-15
    exact = propagate(H, (0, 5), [0, 0, 1, 0], method=MagneticSplitting(8), step=0.05, samples=50)
    np.testing.assert_allclose(exact["x"], np.sin(3 * exact.t) / 3, atol=1e-11)
    np.testing.assert_allclose(exact["y"], (np.cos(3 * exact.t) - 1) / 3, atol=1e-11)


def test_charges_drift_with_e_cross_b_whatever_the_step():
    """E = (1/5, 0), B = 2: at v = (0, −1/10) the forces cancel, and the charge goes straight on."""
    H = charge([0, 2 * x], -x / 5, (1, 1), (x, y))
    motion = propagate(H, (0, 100), [0, 0, 0, "-0.1"], method=Boris(), step=1.0, samples=100)
    np.testing.assert_allclose(motion["y"], -motion.t / 10, atol=1e-13)
    np.testing.assert_allclose(motion["x"], 0, atol=1e-13)
    wrong = charge([0, -2 * x], -x / 5, (1, 1), (x, y))
    assert abs(propagate(wrong, (0, 100), [0, 0, 0, "-0.1"], method=Boris(), step=0.1)["x"]).max() > 0.05


def relativistic(A, phi, c, q=Q):
    """H of a unit charge of unit mass where light has the speed c."""
    p = [s.momentum for s in q]
    root = sp.sqrt(c**2 + sum((a - b) ** 2 for a, b in zip(p, A, strict=True)))
    return Hamiltonian(c * root + phi, list(q), p)


def test_a_relativistic_charge_circles_more_slowly():
    """p = 2 m c across B = 3: the rate is B/γ, γ = √5, of which a step turns 2 atan(h B/2γ)."""
    H, h, n = relativistic([-3 * y / 2, 3 * x / 2], 0, 1, (x, y)), 0.125, 400
    motion = propagate(H, (0, n * h), [0, 0, 2, 0], method=Boris(), step=h, samples=n)
    kinetic = motion["p_x"] + 3 * motion["y"] / 2, motion["p_y"] - 3 * motion["x"] / 2
    angle = 2 * np.arctan(3 * h / 2 / np.sqrt(5)) * np.arange(n + 1)
    np.testing.assert_allclose(kinetic, [2 * np.cos(angle), -2 * np.sin(angle)], atol=4e-13)
    with pytest.raises(ValueError, match="this is a relativistic charge's; use Boris"):
        propagate(H, (0, 1), [0, 0, 2, 0], method=MagneticSplitting(), step=h)
    with pytest.raises(
        ValueError, match="the derivative of Boris's step of a relativistic charge is not known"
    ):
        flow_jacobian(H, (0, 1), [0, 0, 2, 0], method=Boris(), step=h)


@pytest.mark.slow
@pytest.mark.parametrize("order", [2, 4, 6])
def test_order_and_volume_of_a_relativistic_charge(order):
    fast = relativistic(CURVED_A, BOWL, 2)
    driven = relativistic(
        [-y * (2 + sp.sin(time)) / 2, x * (2 + sp.sin(time)) / 2], x * sp.cos(time), 1, (x, y)
    )
    assert ratio(fast, CURVED_START, Boris(order), 60) == pytest.approx(order, abs=0.08 * order)
    assert ratio(driven, [1, 0, 0.1, 0.5], Boris(order), 60) == pytest.approx(order, abs=0.08 * order)
    assert abs(reversal_error(fast, (0, 10), CURVED_START, method=Boris(order), step=0.1)).max() < 1e-14
    weights, delta = {1: 45, 2: -9, 3: 1}, 2.0**-9

    def end(i, k):
        start = np.array(CURVED_START) + k * delta * np.eye(6)[i]
        return propagate(fast, (0, 0.5), start, method=Boris(order), step=0.25, samples=1).final

    columns = [sum(w * (end(i, k) - end(i, -k)) for k, w in weights.items()) / (60 * delta) for i in range(6)]
    assert np.linalg.det(columns) == pytest.approx(1, abs=1e-10)


@pytest.mark.slow
def test_slow_charges_are_not_relativistic():
    slow, start = relativistic(CURVED_A, BOWL, 10**6), CURVED_START
    one = propagate(slow, (0, 3), start, method=Boris(4), step=0.01, samples=1).final
    two = propagate(CURVED, (0, 3), start, method=Boris(4), step=0.01, samples=1).final
    np.testing.assert_allclose(one, two, atol=1e-8)


@pytest.mark.slow
def test_the_gauge_of_a_does_not_matter_to_boris():
    chi = x**2 * y + sp.sin(x * z)
    other = charge([a + chi.diff(s) for a, s in zip(CURVED_A, Q, strict=True)], BOWL)
    moved = [chi.diff(s).subs(dict(zip(Q, CURVED_START, strict=False))) for s in Q]
    start = [*CURVED_START[:3], *(p + float(a) for p, a in zip(CURVED_START[3:], moved, strict=True))]
    setting = {"method": Boris(), "step": 0.1, "samples": 20}
    one = propagate(CURVED, (0, 10), CURVED_START, **setting)
    two = propagate(other, (0, 10), start, **setting)
    np.testing.assert_allclose(one.q, two.q, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("method", [Boris(2), MagneticSplitting(4)], ids=str)
def test_a_mirror_holds_charges_by_their_adiabatic_invariant(method):
    """B_z = 1 + z²/4 on the axis: the charge turns back where B = E/µ, at every one of some hundred bounces."""
    b = 1 + z**2 / 4
    H = charge([-y * b / 2, x * b / 2, 0], 0)
    v = np.array([0.0, 0.05, 0.05])
    q = np.array([0.05, 0.0, 0.0])
    start = [*q, v[0], v[1] + q[0] / 2, v[2]]
    motion = propagate(H, (0, 60_000), start, method=method, step=0.1, samples=120_000)
    X, Y, Z, px, py, pz = motion.y
    B = np.array([-X * Z / 4, -Y * Z / 4, 1 + Z**2 / 4])
    size = np.sqrt((B**2).sum(axis=0))
    speed = np.array([px + Y * B[2] / 2, py - X * B[2] / 2, pz])
    along = (speed * B).sum(axis=0) / size
    mu = ((speed**2).sum(axis=0) - along**2) / (2 * size)
    assert (np.diff(np.sign(along)) != 0).sum() > 100
    assert mu.std() < 0.02 * mu.mean()
    tenth = len(mu) // 10
    assert mu[-tenth:].mean() == pytest.approx(mu[:tenth].mean(), rel=2e-4)
    turns = np.flatnonzero(np.diff(np.sign(along)))
    np.testing.assert_allclose(size[turns], motion.energy[0] / mu.mean(), rtol=0.02)
    angular = X * py - Y * px
    assert abs(angular - angular[0]).max() < 1e-5
    assert abs(motion.energy_error).max() < 1e-4


def test_energy_stays_bounded_over_a_hundred_thousand_steps():
    for method in (Boris(), MagneticSplitting(2)):
        error = abs(propagate(PLANE, (0, 5000), PLANE_START, method=method, step=0.05).energy_error)
        assert error.max() < 0.02
        assert error[-100:].max() < 2 * error[1:101].max()
    lost = abs(propagate(PLANE, (0, 5000), PLANE_START, method=RK4(), step=0.1).energy_error)
    assert lost[-100:].max() > 5 * lost[1:101].max()


@pytest.mark.slow
def test_the_speed_in_a_uniform_field_wanders_less_than_the_root_of_the_steps():
    for A, start in (
        ([-y / 2, x / 2, 0], [1, 0, 0, 0.3, 0.4, 0.2]),
        ([z * 3 / 4 - y / 2, x / 2 - z / 5, y / 5 - x * 3 / 4], [1, 0, 0, 0.3, 0.9, -1.47]),
    ):
        motion = propagate(charge(A, 0), (0, 10**5), start, method=Boris(), step=0.1, samples=100)
        assert motion.steps == 10**6
        assert abs(motion.energy_error).max() < 2.0**-53 * 1000


@pytest.mark.slow
def test_penning_trap_against_its_closed_form():
    trap = find("penning-trap")
    for method in (Boris(6), MagneticSplitting(6)):
        motion = propagate(trap, (0, 1e-7), method=method, step=5e-13, samples=50)
        axial, radial = trap.solutions
        for solution, name in ((axial, "z"), (radial, "x")):
            true = solution.value(trap.values, motion.t)
            assert abs(motion[name] - true).max() < 1e-8 * abs(true).max()


# many orbits, and going on -----------------------------------------------------------------------------


@every
def test_same_bits_among_others(method):
    one = propagate(PLANE, (0, 4), PLANE_START, method=method, step=0.125, samples=4)
    many = propagate(
        PLANE, (0, 4), np.array(PLANE_START)[:, None] * np.ones(5), method=method, step=0.125, samples=4
    )
    np.testing.assert_array_equal(many.y[:, :, 3], one.y)


@pytest.mark.slow
@every
def test_resumed_and_kept(method, tmp_path):
    setting = {"method": method, "step": 0.125}
    whole = propagate(CURVED, (0, 4), CURVED_START, samples=8, **setting)
    half = propagate(CURVED, (0, 2), CURVED_START, samples=3, **setting)
    np.testing.assert_array_equal(half.resume(4).final, whole.final)
    half.save(tmp_path / "half.npz")
    np.testing.assert_array_equal(load_motion(tmp_path / "half.npz").resume(4).final, whole.final)


@pytest.mark.slow
@every
def test_parameters_by_orbit(method):
    m, b = parameters("m b", positive=True)
    H = charge([0, b * x + b * x**2], (x**2 + y**2) / 2, (m, m), (x, y))
    setting = {"method": method, "step": 0.01, "samples": 1}
    both = propagate(H, (0, 3), PLANE_START, parameters={m: [1, 2, 3], b: [0.5, 1, 1.5]}, **setting)
    one = propagate(H, (0, 3), PLANE_START, parameters={m: 2, b: 1}, **setting)
    assert abs(both.final[:, 1] - one.final).max() < 1e-13


@pytest.mark.slow
@pytest.mark.parametrize("system", [CURVED, UNEQUAL], ids=["curved", "unequal"])
@every
def test_precisions_differ_by_their_rounding(system, method):
    ends = {
        precision: propagate(
            system, (0, 2), CURVED_START, method=method, step=0.125, samples=1, precision=precision
        )
        for precision in ("single", "double", "compensated", "extended", "double-double")
    }
    true = ends["double-double"]
    for precision, unit in (("single", 1e-5), ("double", 1e-14), ("compensated", 5e-15), ("extended", 1e-17)):
        found = ends[precision]
        assert abs((found.y - true.y) + (found.carried - true.carried)).max() < unit


@pytest.mark.slow
def test_a_chaotic_orbit_has_the_same_exponent_by_the_splitting():
    found = lyapunov_spectrum(PLANE, (0, 2000), PLANE_START, method=MagneticSplitting(4), step=0.05)
    assert abs(found.exponents.sum()) < 1e-6


factors = st.integers(-3, 3)


@settings(max_examples=50, deadline=None)  # a third of a second each: four compiled loops
@given(
    first=st.lists(factors, min_size=5, max_size=5),
    second=st.lists(factors, min_size=5, max_size=5),
    masses=st.tuples(st.integers(1, 3), st.integers(1, 3)),
    start=st.lists(st.floats(-1, 1).map(lambda z: round(z, 2)), min_size=4, max_size=4),
)
def test_laws_of_any_polynomial_field(first, second, masses, start):
    """Symplectic or with phase volume kept, and back at the start, whatever the field."""
    terms = (x, y, x * y, x**2 * y, y**3)
    A = [sum(c * term for c, term in zip(row, terms, strict=True)) / 5 for row in (first, second)]
    H = charge(A, (x**2 + y**2) / 2 + x**3 / 9, masses, (x, y))
    one = flow_jacobian(H, (0, 0.25), start, method=MagneticSplitting(2), step=0.125)
    size = 1 + abs(one.final).max() ** 2
    assert one.symplecticity_defect[-1] < 1e-14 * size
    push = flow_jacobian(H, (0, 0.25), start, method=Boris(2), step=0.125)
    assert np.linalg.det(push.final) == pytest.approx(1, abs=1e-13 * size)
    for method in (MagneticSplitting(2), Boris(2)):
        assert abs(reversal_error(H, (0, 0.25), start, method=method, step=0.125)).max() < 1e-13 * size


# trouble -----------------------------------------------------------------------------------------------

MASSIVE = Hamiltonian(sp.sqrt(1 + P[0] ** 2) + P[0] ** 2 + x**2, [x], [P[0]])
COUPLED = Hamiltonian((P[0] + P[1]) ** 2 / 2 + P[0] ** 2 / 2 + x * y, [x, y], P[:2])
VARYING = Hamiltonian(P[0] ** 2 * x**2 / 2, [x], [P[0]])


@pytest.mark.parametrize(
    ("system", "start", "message"),
    [
        (MASSIVE, [1, 0], r"∂²H/∂p_x² is no inverse of a constant mass; use Gauss"),
        (COUPLED, [1, 0, 0, 0], r"constant masses, ∂H/∂p_x depends on p_y"),
        (VARYING, [1, 0], r"∂²H/∂p_x² is no inverse"),
    ],
)
@pytest.mark.parametrize("method", ["boris", "magnetic-4"])
def test_other_hamiltonians_are_refused(system, start, message, method):
    with pytest.raises(ValueError, match=message):
        propagate(system, (0, 1), start, method=method, step=0.1)


def test_integrals_that_are_not_known_and_wrong_orders_are_refused():
    H = charge([y * sp.exp(sp.sin(x)), 0], 0, (1, 1), (x, y))
    with pytest.raises(
        ValueError, match=r"∫ y\*exp\(sin\(x\)\) dx is not known in closed form: choose another gauge"
    ):
        propagate(H, (0, 1), [1, 0, 0, 0], method=MagneticSplitting(), step=0.1)
    for kind in (Boris, MagneticSplitting):
        with pytest.raises(ValueError, match=rf"{kind.__name__}\(5\): the order is one of 2, 4, 6, 8"):
            kind(5)


def test_a_choice_considers_them_where_they_apply():
    methods = candidate_methods(Question(PLANE, np.array(PLANE_START, dtype=float), {}, 10.0))
    assert {Boris(4), MagneticSplitting(4)} <= {*methods}
    pendulum = find("double-pendulum")
    start = np.array(pendulum.state(), dtype=float)
    others = candidate_methods(Question(pendulum.hamiltonian, start, pendulum.values, 10.0))
    assert not any(isinstance(m, Boris | MagneticSplitting) for m in others)


@pytest.mark.slow
def test_a_choice_takes_them_for_a_trap():
    trap = find("penning-trap")
    found = choose(trap, 1e-6, accuracy=1e-6)
    assert isinstance(found.method, Boris | MagneticSplitting)
    assert abs(found.run().energy_error).max() < 1e-6
