"""Galerkin variational integrators: orders, other routes to the same steps, symplecticity, momenta, forces, trouble."""

import numpy as np
import pytest
import sympy as sp
from scipy.optimize import root
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

from canon import (
    RK4,
    ConstrainedLagrangian,
    Event,
    Gauss,
    Lagrangian,
    Splitting,
    choose,
    coordinates,
    drift,
    flow_jacobian,
    hamiltonian,
    load_motion,
    propagate,
)
from canon import time as t
from canon.flow import GalerkinVariational, NonFiniteStateError, reversal_error

theta, phi, x, y = coordinates("theta phi x y")
PENDULUM = Lagrangian(theta.dot**2 / 2 + sp.cos(theta), [theta])
SWING = [2.0, 0.3]
COUPLED = (
    theta.dot**2
    + phi.dot**2 / 2
    + theta.dot * phi.dot * sp.cos(theta - phi)
    + 2 * sp.cos(theta)
    + sp.cos(phi)
)
DOUBLE = Lagrangian(COUPLED, [theta, phi])
START = [1.0, 0.4, 0.2, -0.3]
FORCES = [-theta.dot / 10, -phi.dot * sp.sin(theta) ** 2 / 5]
DAMPED = Lagrangian(COUPLED, [theta, phi], forces=FORCES)
R2 = x**2 + y**2
CENTRAL = (x.dot**2 + y.dot**2) / 2 + 1 / sp.sqrt(R2)
DRIVEN = Lagrangian(x.dot**2 / 2 * (1 + sp.sin(t) / 3) - x**4 / 4, [x], forces=[sp.cos(2 * t) - x.dot / 7])
HENON_HEILES = Lagrangian((x.dot**2 + y.dot**2 - R2) / 2 - x**2 * y + y**3 / 3, [x, y])

KINDS = [
    GalerkinVariational(1),
    GalerkinVariational(2),
    GalerkinVariational(3),
    GalerkinVariational(1, 3),
    GalerkinVariational(2, 4),
    GalerkinVariational(1, quadrature="lobatto"),
    GalerkinVariational(2, quadrature="lobatto"),
    GalerkinVariational(2, 2, "lobatto"),
    GalerkinVariational(3, 3, "lobatto"),
    GalerkinVariational(3, 6, "lobatto"),
]
LOBATTO, MORE = KINDS[6], KINDS[4]


def order_seen(system, start, method, steps, span=3):
    """log₂ of the errors with steps and with steps of half the size."""
    true = propagate(system, (0, span), start).final
    errors = [
        abs(propagate(system, (0, span), start, method=method, step=span / n, samples=1).final - true).max()
        for n in (steps, 2 * steps)
    ]
    return np.log2(errors[0] / errors[1])


@pytest.mark.parametrize("method", [LOBATTO, pytest.param(MORE, marks=pytest.mark.slow)], ids=str)
@pytest.mark.parametrize(("system", "start"), [(DAMPED, START), (DRIVEN, [1, 0.3])], ids=["damped", "driven"])
def test_halving_the_step_divides_the_error_by_two_to_the_order(system, start, method):
    assert order_seen(system, start, method, 40) == pytest.approx(method.order, abs=0.05 * method.order)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "start"),
    [
        (DOUBLE, START),
        (DAMPED, START),
        (DRIVEN, [1, 0.3]),
        (HENON_HEILES, [0.3, 0.1, 0.1, 0.3]),
        (PENDULUM, SWING),
    ],
    ids=["double", "damped", "driven", "hénon-heiles", "pendulum"],
)
@pytest.mark.parametrize("method", KINDS, ids=str)
def test_order_of_every_kind(system, start, method):
    assert order_seen(system, start, method, 40) == pytest.approx(method.order, abs=0.08 * method.order)


@pytest.mark.slow
@pytest.mark.parametrize("degree", [4, 5, 6])
@pytest.mark.parametrize("quadrature", ["gauss", "lobatto"])
def test_high_orders(degree, quadrature):
    """In double-double beside Taylor's method in 113 bits, as doubles round away what is left of the errors."""
    method, errors = GalerkinVariational(degree, quadrature=quadrature), []
    true = propagate(PENDULUM, (0, 12), SWING, precision="quad", samples=1)
    for n in (80, 160):
        how = {"method": method, "step": 12 / n, "samples": 1, "precision": "double-double"}
        found = propagate(PENDULUM, (0, 12), SWING, **how)
        errors.append(abs((found.y - true.y) + (found.carried - true.carried))[:, -1].max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2 * degree, abs=0.1 * degree)


def discrete_step(L, forces, q, state, h, nodes, weights):
    """A step with a parabola through q(0), q(h/2) and q(h), by SciPy: what makes the sum of L stationary."""
    v = [s.dot for s in q]
    pushed = [sp.diff(L, s) + f for s, f in zip(q, forces, strict=True)]
    F, p = (sp.lambdify([[*q, *v]], each, "numpy") for each in (pushed, [sp.diff(L, s) for s in v]))
    n = len(q)
    ell = [lambda c: 2 * (c - 0.5) * (c - 1), lambda c: 4 * c * (1 - c), lambda c: 2 * c * (c - 0.5)]
    slope = [lambda c: 4 * c - 3, lambda c: 4 - 8 * c, lambda c: 4 * c - 1]

    def sums(middle, end):
        """The derivatives of the action by the three positions, with the work of the forces."""
        three, found = [state[:n], middle, end], np.zeros((3, n))
        for c, b in zip(nodes, weights, strict=True):
            here = [
                *sum(e(c) * k for e, k in zip(ell, three, strict=True)),
                *(sum(d(c) * k for d, k in zip(slope, three, strict=True)) / h),
            ]
            for k in range(3):
                found[k] += h * b * (ell[k](c) * np.array(F(here)) + slope[k](c) / h * np.array(p(here)))
        return found

    p0 = np.array(p(state))
    both = root(
        lambda z: np.concatenate([sums(z[:n], z[n:])[0] + p0, sums(z[:n], z[n:])[1]]),
        np.concatenate([state[:n] + h / 2 * state[n:], state[:n] + h * state[n:]]),
        tol=1e-14,
    ).x
    p1 = sums(both[:n], both[n:])[2]
    end = root(lambda v1: np.array(p([*both[n:], *v1])) - p1, state[n:], tol=1e-14).x
    return np.concatenate([both[n:], end])


@pytest.mark.parametrize(
    ("points", "quadrature"), [(3, "lobatto"), pytest.param(4, "gauss", marks=pytest.mark.slow)]
)
def test_a_step_makes_the_discrete_action_stationary(points, quadrature):
    legendre = np.polynomial.legendre.leggauss(points)
    nodes, weights = (legendre[0] + 1) / 2, legendre[1] / 2
    if quadrature == "lobatto":
        nodes, weights = [0, 0.5, 1], [1 / 6, 2 / 3, 1 / 6]
    known = discrete_step(COUPLED, FORCES, [theta, phi], np.array(START), 0.25, nodes, weights)
    method = GalerkinVariational(2, points, quadrature)
    found = propagate(DAMPED, (0, 0.25), START, method=method, step=0.25, samples=1).final
    np.testing.assert_allclose(found, known, atol=1e-12)
    free = discrete_step(COUPLED, [0, 0], [theta, phi], np.array(START), 0.25, nodes, weights)
    assert abs(found - free).max() > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("s", [1, 2, 4])
def test_with_as_many_points_of_gauss_it_is_the_gauss_method(s):
    how = {"t_span": (0, 5), "step": 0.1, "samples": 5}
    found = propagate(DOUBLE, y0=START, method=GalerkinVariational(s), **how)
    values = {theta: START[0], phi: START[1], theta.dot: START[2], phi.dot: START[3]}
    p0 = [float(sp.diff(COUPLED, v).subs(values)) for v in (theta.dot, phi.dot)]
    known = propagate(hamiltonian(DOUBLE), y0=[*START[:2], *p0], method=Gauss(s), **how)
    assert abs(found.y[:2] - known.y[:2]).max() < 5e-14
    other = propagate(DOUBLE, y0=START, method=GalerkinVariational(s, s + 1), **how)
    assert abs(other.y[:2] - known.y[:2]).max() > {1: 1e-3, 2: 1e-8, 4: 2e-11}[s]
    oscillator = Lagrangian(x.dot**2 / 2 - x**4 / 4, [x], forces=[-x.dot / 3])
    one, two = (
        propagate(oscillator, y0=[1, 0], method=each(s), **how) for each in (GalerkinVariational, Gauss)
    )
    assert abs(one.y - two.y).max() < 1e-14


def test_with_degree_one_and_lobattos_two_points_it_is_stoermer_and_verlets():
    how = {"t_span": (0, 10), "y0": SWING, "step": 0.1}
    found = propagate(PENDULUM, method=GalerkinVariational(1, quadrature="lobatto"), **how)
    kick_first, drift_first = Splitting(a=[0, 1], b=["1/2", "1/2"]), Splitting("verlet")
    one, other = (propagate(hamiltonian(PENDULUM), method=each, **how) for each in (kick_first, drift_first))
    assert abs(found.y - one.y).max() < 1e-14
    assert abs(found.y - other.y).max() > 1e-4


def jacobian_of_momenta(system, start, method, h):
    """∂(q, p)₁/∂(q, p)₀ of a step of the double pendulum, by differences of order 6."""
    q, v = [theta, phi], [theta.dot, phi.dot]
    momenta = sp.lambdify([[*q, *v]], [sp.diff(COUPLED, s) for s in v])
    masses = sp.lambdify([[*q, *v]], sp.Matrix([[sp.diff(COUPLED, a, b) for b in v] for a in v]))
    start = np.array(start)
    shift = np.zeros((4, 4))  # of (q, v) for shifts of (q, p) in turn: by columns
    M, at_rest = masses(start), sp.Matrix([sp.diff(COUPLED, s) for s in v]).jacobian(q)
    slopes = np.array(sp.lambdify([[*q, *v]], at_rest)(start), dtype=float)
    shift[:2, :2], shift[2:, :2], shift[2:, 2:] = np.eye(2), -np.linalg.solve(M, slopes), np.linalg.inv(M)

    def ends(k, delta):
        final = propagate(system, (0, h), start + k * delta, method=method, step=h, samples=1).final
        return np.array([*final[:2], *momenta(final)])

    columns, small = [], 2.0**-8
    for i in range(4):
        # (q, v) of a shifted (q, p): ∂²L/∂q̇² holds q only, so that v is found exactly.
        def state(k, i=i):
            q1 = start[:2] + k * small * np.eye(4)[i][:2]
            p1 = np.array(momenta(start)) + k * small * np.eye(4)[i][2:]
            return np.array([*q1, *np.linalg.solve(masses([*q1, *start[2:]]), p1)])

        weights = {1: 45, 2: -9, 3: 1}
        columns.append(
            sum(w * (ends(1, state(k) - start) - ends(1, state(-k) - start)) for k, w in weights.items())
            / (60 * small)
        )
    return np.array(columns).T


@pytest.mark.slow
@pytest.mark.parametrize("method", [*KINDS, RK4()], ids=str)
def test_without_forces_steps_are_symplectic(method):
    J = np.kron([[0, 1], [-1, 0]], np.eye(2))
    m = jacobian_of_momenta(DOUBLE, START, method, 0.25)
    defect = abs(m.T @ J @ m - J).max()
    assert defect < 1e-10 if method.is_symplectic else defect > 1e-5
    m = jacobian_of_momenta(DAMPED, START, method, 0.25)
    assert abs(m.T @ J @ m - J).max() > 1e-3


@pytest.mark.parametrize(
    "method",
    [LOBATTO, *(pytest.param(each, marks=pytest.mark.slow) for each in KINDS if each != LOBATTO)],
    ids=str,
)
def test_time_reversal(method):
    for system in (DOUBLE, DAMPED):
        assert abs(reversal_error(system, (0, 5), START, method=method, step=0.05)).max() < 1e-14
    assert abs(reversal_error(DAMPED, (0, 5), START, method=RK4(), step=0.05)).max() > 1e-9


@pytest.mark.parametrize(
    "method",
    [LOBATTO, *(pytest.param(each, marks=pytest.mark.slow) for each in KINDS if each != LOBATTO)],
    ids=str,
)
def test_momenta_of_symmetries_are_kept_with_forces_that_do_not_turn(method):
    """Drag along the radius takes energy and no angular momentum, drag along the velocity takes both."""
    radial = (x * x.dot + y * y.dot) / R2 / 20
    how = {"t_span": (0, 60), "y0": [1, 0, 0, 1.2], "step": 0.1}

    def moments(forces, method):
        motion = propagate(Lagrangian(CENTRAL, [x, y], forces=forces), method=method, **how)
        return motion["x"] * motion["y_dot"] - motion["y"] * motion["x_dot"]

    kept = moments([-x * radial, -y * radial], method)
    assert abs(kept - 1.2).max() < 1e-14
    assert abs(moments([-x * radial, -y * radial], RK4()) - 1.2).max() > 1e-8
    if method != LOBATTO:
        assert abs(moments([], method) - 1.2).max() < 1e-14
        assert abs(moments([-x.dot / 100, -y.dot / 100], method) - 1.2).max() > 0.1


def test_the_energy_of_a_damped_swing_falls_as_it_should():
    """Of ẍ + 2γẋ + x = 0, in steps of a tenth of a turn, the amplitude after a thousand radians is exp(−γt)."""
    slow = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-x.dot / 1000])
    how = {"t_span": (0, 1000), "y0": [1, 0], "step": 0.6, "samples": 100}
    found = propagate(slow, method=LOBATTO, **how)
    energy = (found["x"] ** 2 + found["x_dot"] ** 2) / 2
    true = np.exp(-found.t / 1000) / 2
    assert abs(energy / true - 1).max() < 3e-3
    wrong = propagate(slow, method=RK4(), **how)
    assert abs((wrong["x"] ** 2 + wrong["x_dot"] ** 2) / 2 / true - 1).max() > 0.3


@pytest.mark.slow
@pytest.mark.parametrize("method", KINDS, ids=str)
def test_energy_errors_are_bounded_without_forces(method):
    motion = propagate(PENDULUM, (0, 20_000), SWING, method=method, step=0.1, samples=2000)
    assert drift(motion).verdict.value == "bounded"


@pytest.mark.slow
def test_round_off_is_a_random_walk():
    motion = propagate(PENDULUM, (0, 20_000), SWING, method=GalerkinVariational(8), step=0.2, samples=1000)
    assert abs(motion.energy_error).max() < 4 * 2.0**-53 * 10**5**0.5


def test_same_bits_however_sampled_resumed_and_kept(tmp_path):
    how = {"method": LOBATTO, "step": 0.1}
    whole = propagate(DAMPED, (0, 4), START, samples=7, **how).final
    np.testing.assert_array_equal(propagate(DAMPED, (0, 4), START, samples=1, **how).final, whole)
    half = propagate(DAMPED, (0, 2), START, **how)
    np.testing.assert_array_equal(half.resume(4).final, whole)
    half.save(tmp_path / "half")
    again = load_motion(tmp_path / "half")
    assert again.method == LOBATTO
    np.testing.assert_array_equal(again.resume(4).final, whole)
    many = propagate(DAMPED, (0, 4), np.array([START, [1, 2, 0, 0]]).T, samples=1, **how)
    np.testing.assert_array_equal(many.final[:, 0], whole)


@pytest.mark.slow
def test_events_between_samples_precisions_and_parameters():
    how = {"method": GalerkinVariational(3), "step": 0.1}
    motion, true = (propagate(DAMPED, (0, 10), START, events=[Event(theta)], **more) for more in (how, {}))
    assert len(motion.events) == len(true.events) > 1
    for one, other in zip(motion.events, true.events, strict=True):
        assert one.t == pytest.approx(other.t, abs=1e-5)
    assert abs(motion(3.03) - propagate(DAMPED, (0, 3.03), START).final).max() < 1e-6
    for precision, unit in (
        ("single", 1e-6),
        ("double", 1e-14),
        ("extended", 1e-17),
        ("double-double", 1e-28),
    ):
        found = propagate(
            PENDULUM, (0, 20), [1, 0], method=GalerkinVariational(8), step=0.1, precision=precision
        )
        assert abs(found.energy_error).max() < unit
    k = sp.Symbol("k")
    quartic = Lagrangian(x.dot**2 / 2 - k * x**4 / 4, [x], forces=[-x.dot / 7])
    several = propagate(quartic, (0, 5), [1, 0], parameters={k: [1, 2]}, **how)
    np.testing.assert_array_equal(
        several.y[:, :, 1], propagate(quartic, (0, 5), [1, 0], parameters={k: 2}, **how).y
    )


@pytest.mark.slow
def test_models_of_sympy_and_lagrangians_without_constraints_are_taken():
    q = dynamicsymbols("q")
    model = LagrangesMethod(q.diff() ** 2 / 2 + sp.cos(q), [q])
    model.form_lagranges_equations()
    how = {"t_span": (0, 3), "y0": SWING, "method": LOBATTO, "step": 0.1}
    known = propagate(PENDULUM, **how).y
    for other in (model, ConstrainedLagrangian(PENDULUM)):
        np.testing.assert_array_equal(propagate(other, **how).y, known)


def test_masses_may_depend_on_velocities():
    """A relativistic mass on a spring, L = −√(1 − v²) − x²/2; faster than light nothing goes on."""
    fast = Lagrangian(-sp.sqrt(1 - x.dot**2) - x**2 / 2, [x])
    motion = propagate(fast, (0, 10), [2, 0], method=GalerkinVariational(3), step=0.05)
    assert abs(motion.final - propagate(fast, (0, 10), [2, 0]).final).max() < 1e-6
    assert abs(motion["x_dot"]).max() > 0.9
    with pytest.raises(NonFiniteStateError, match="do not converge"):
        propagate(fast, (0, 10), [9, 0], method=GalerkinVariational(3), step=1.0)


@pytest.mark.slow
def test_it_is_chosen_where_it_is_named():
    found = choose(PENDULUM, 20.0, SWING, accuracy=1e-5, observable="position", methods=["galerkin-3"])
    assert found.method == GalerkinVariational(3)
    assert found.predicted_error < 1e-5


def test_what_it_is_not_for_is_told():
    for degree in (0, 9, True, 2.0):
        with pytest.raises(ValueError, match="the degree is 1 … 8"):
            GalerkinVariational(degree)
    with pytest.raises(ValueError, match="there are 'gauss' and 'lobatto'"):
        GalerkinVariational(2, quadrature="radau")
    for degree, points, quadrature in ((3, 2, "gauss"), (2, 10, "gauss"), (1, 1, "lobatto")):
        with pytest.raises(ValueError, match="the points of the quadrature are"):
            GalerkinVariational(degree, points, quadrature)
    how = {"method": "galerkin-2", "step": 0.1}
    with pytest.raises(ValueError, match="is for a Lagrangian, with its forces, and this is none"):
        propagate(hamiltonian(PENDULUM), (0, 1), [1, 0], **how)
    free = Lagrangian((x.dot**2 + y.dot**2) / 2 - y, [x, y])
    held = ConstrainedLagrangian(free, holonomic=[R2 - 1])
    with pytest.raises(
        ValueError, match="without constraints and does not apply to a constrained Lagrangian"
    ):
        propagate(held, (0, 1), [1, 0, 0, 0], **how)
    with pytest.raises(ValueError, match="derivative of steps of a discrete action is not known here"):
        flow_jacobian(PENDULUM, (0, 1), [1, 0], **how)
    near = Lagrangian(CENTRAL, [x, y])
    with pytest.raises(NonFiniteStateError, match="the velocities of step 1 do not converge") as caught:
        propagate(near, (0, 100), [0.01, 0, 0, 1], method="galerkin-2", step=0.5)
    assert np.isfinite(caught.value.state).all()
