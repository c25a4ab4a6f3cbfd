"""Nonholonomic leapfrog: its equations, order, constraints, reversal, momenta and energy in long runs, trouble."""

import functools

import mpmath
import numpy as np
import pytest
import sympy as sp
from sympy import cos, sin
from sympy.physics import mechanics as me

from canon import (
    ConstrainedLagrangian,
    Event,
    GibbsAppell,
    Lagrangian,
    coordinates,
    drift,
    flow_jacobian,
    load_motion,
    parameters,
    propagate,
)
from canon.expression.symbols.symbol import time
from canon.flow import NonholonomicLeapfrog, Rattle, reversal_error
from canon.flow.method.method import RK4
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.mechanics.lagrange.body import PlanarBody
from canon.scene import find
from canon.study import Growth
from canon.study.method_choice.candidate import candidate_methods
from canon.study.method_choice.choice_question import Question

U = 2.0**-53
x, y, z, u, w, theta, phi, psi = coordinates("x y z u w theta phi psi")


def particle(potential=(x**2 + y**2) / 2):
    """The nonholonomic particle (Rosenberg; Bates & Śniatycki), integrable and reversible in this potential."""
    L = Lagrangian((x.dot**2 + y.dot**2 + z.dot**2) / 2 - potential, [x, y, z])
    return ConstrainedLagrangian(L, nonholonomic=[z.dot - y * x.dot])


def everything():
    """Masses that depend on the place, momenta with a vector potential, and a constraint."""
    K = (x.dot**2 + y.dot**2 + z.dot**2) / 2 + (2 + sin(x)) * w.dot**2 / 2 + z * y.dot + x.dot * w.dot / 4
    L = Lagrangian(K - cos(x) - x**2 * y**2, [x, y, z, w])
    return ConstrainedLagrangian(L, nonholonomic=[z.dot - (y + sin(x) / 2) * x.dot + x * y.dot])


def driven():
    """The same with friction, and a constraint and a force that depend on the time."""
    K = (x.dot**2 + y.dot**2 + z.dot**2) / 2 + (2 + sin(x)) * w.dot**2 / 2 + z * y.dot
    L = Lagrangian(
        K - cos(x) - x**2 * y**2 - sin(time) * y, [x, y, z, w], forces=[0, -y.dot / 5, 0, x * cos(time)]
    )
    rolls = z.dot - (y + sin(time) * x) * x.dot + cos(time) * y - 1
    return ConstrainedLagrangian(L, nonholonomic=[rolls])


def snakeboard():
    """Masses and lengths 1; wheels turned by ±φ, a rotor ψ (J. P. Ostrowski et al., ICRA 1994)."""
    K = (x.dot**2 + y.dot**2 + theta.dot**2) / 2 + psi.dot**2 / 8 + psi.dot * theta.dot / 4 + phi.dot**2 / 10
    L = Lagrangian(K - phi**2 / 10 - sin(psi) / 3, [x, y, theta, psi, phi])
    wheels = [
        -sin(theta + s * phi) * x.dot + cos(theta + s * phi) * y.dot + s * cos(phi) * theta.dot
        for s in (1, -1)
    ]
    return ConstrainedLagrangian(L, nonholonomic=wheels)


def contact_oscillators(n):
    """Oscillators with ẋ + Σ yᵢ żᵢ = 0, McLachlan and Perlmutter's contact oscillator (§ 5.2), coupled: chaotic."""
    q = coordinates(" ".join(["x", *(f"{s}{i}" for i in range(n) for s in "yz")]))
    Y, Z = q[1::2], q[2::2]
    coupled = [Z[i] * Z[(i + 1) % n] for i in range(n)] + [a * b for a, b in zip(Y, Z, strict=True)]
    L = Lagrangian(sum(s.dot**2 - s**2 for s in q) / 2 - sum(c**2 for c in coupled) / 2, list(q))
    rolls = q[0].dot + sum(a * b.dot for a, b in zip(Y, Z, strict=True))
    return ConstrainedLagrangian(L, nonholonomic=[rolls])


def start_of(system, places, speeds, at=0.0):
    """A start on the constraints: the least change, in the usual sense, of the speeds."""
    q, v = system.lagrangian.q, system.lagrangian.velocities
    point = dict(zip(q, places, strict=True)) | {time: at}
    given = [sp.sympify(g).subs(point) for g in system.nonholonomic]
    A = np.array([[float(g.coeff(s)) for s in v] for g in map(sp.expand, given)])
    a = np.array([float(g.subs(dict.fromkeys(v, 0))) for g in given])
    speeds = np.array(speeds, dtype=float)
    return [*places, *(speeds - np.linalg.lstsq(A, A @ speeds + a)[0])]


def constrained_disc():
    """The scene's disc with its numbers."""
    disc = find("rolling-disc")
    given, values = disc.constrained, disc.values_by_symbol()
    L = Lagrangian(given.lagrangian.L.subs(values), given.lagrangian.q)
    return ConstrainedLagrangian(L, nonholonomic=[g.subs(values) for g in given.nonholonomic])


PARTICLE, PARTICLE_START = particle(), [1, 0, 0, 0, 1, 0]
EVERYTHING = everything()
EVERYTHING_START = start_of(EVERYTHING, [1, 0.3, 0, 0], [0.2, 0.5, 0, 0.3])
DRIVEN = driven()
DRIVEN_START = start_of(DRIVEN, [1, 0.3, 0, 0], [0.2, 0.5, 0, 0.3])


def scales(motion, system):
    """The largest Σ |A q̇| along a motion, by constraint: what residuals are measured in."""
    q = system.lagrangian.q
    for g in system.nonholonomic:
        row = [sp.lambdify((*q, time), g.diff(s.dot))(*motion.q, motion.t) for s in q]
        yield sum(abs(a * b) for a, b in zip(row, motion.v, strict=True)).max()


def worst_residual(motion, system):
    return max(
        float(abs(row).max() / size)
        for row, size in zip(motion.residuals, scales(motion, system), strict=True)
    )


def fitted_order(system, start, order, steps, true, span=3, **given):
    ends = [
        propagate(
            system, (0, span), start, method=NonholonomicLeapfrog(order), step=span / n, samples=1, **given
        ).final
        for n in (steps, 2 * steps)
    ]
    errors = [abs(end - true).max() for end in ends]
    assert errors[1] > 1e-13
    return np.log2(errors[0] / errors[1])


@pytest.mark.parametrize(
    "order", [pytest.param(2, marks=pytest.mark.slow), 4, pytest.param(6, marks=pytest.mark.slow)]
)
def test_order_against_the_reduced_equations_of_the_particle(order):
    """ÿ = −∂V/∂y, (1 + y²) ẍ + y ẏ ẋ = −∂V/∂x, ż = y ẋ, integrated by heyoka as equations of first order."""
    from canon import VectorField

    a, b = sp.symbols("a b", real=True)
    V = x**4 / 4 + x * y + y**2
    reduced = VectorField([a, b, y * a, -(V.diff(x) + y * b * a) / (1 + y**2), -V.diff(y)], [x, y, z, a, b])
    true = propagate(reduced, (0, 3), [1, 0.5, 0, 0.3, -0.4], samples=1).y[:, -1]
    start = [1, 0.5, 0, 0.3, -0.4, 0.15]
    found = fitted_order(particle(V), start, order, {2: 200, 4: 60, 6: 30}[order], [*true, true[1] * true[3]])
    assert found == pytest.approx(order, abs=0.05 * order)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "start", "eighth"),
    [
        (EVERYTHING, EVERYTHING_START, 20),
        (DRIVEN, DRIVEN_START, 20),
        (snakeboard(), start_of(snakeboard(), [0, 0, 0.4, 0.2, 0.5], [1, 0, 0.3, 0.4, 0.2]), 12),
        (
            contact_oscillators(4),
            start_of(contact_oscillators(4), [0.1 * i for i in range(9)], [0.5, -0.2, 0.3] * 3),
            20,
        ),
    ],
    ids=["everything", "driven", "snakeboard", "contact"],
)
@pytest.mark.parametrize("order", [2, 4, 6, 8])
def test_order_by_halving_the_step(system, start, eighth, order):
    """The contact oscillators have more velocities and constraints than are eliminated in registers."""
    true = propagate(system, (0, 3), start, samples=1).final
    found = fitted_order(system, start, order, {2: 200, 4: 80, 6: 40, 8: eighth}[order], true)
    assert found == pytest.approx(order, abs=0.07 * order)


@pytest.mark.slow
@pytest.mark.parametrize("order", [2, 4, 6])
def test_order_on_a_sleigh_against_gibbs_and_appell(order):
    """u̇ = a ω², ω̇ = −m a u ω/(I + m a²) by quasi-velocities, of which there are as many as are free."""
    s = sp.symbols("s omega", real=True)
    body = PlanarBody(2, (x + cos(theta) / 3, y + sin(theta) / 3), sp.Rational(1, 2), theta)
    q, rates = [x, y, theta], [s[0] * cos(theta), s[0] * sin(theta), s[1]]
    free = propagate(
        GibbsAppell([body], q, V=sin(x) * cos(y), u=list(s), q_dot=rates),
        (0, 3),
        [0, 0, 0.2, 0.5, 2],
        samples=1,
    )
    X, Y, angle, forward, turning = free.y[:5, -1]
    true = [X, Y, angle, forward * np.cos(angle), forward * np.sin(angle), turning]
    centre = [x.dot - sin(theta) * theta.dot / 3, y.dot + cos(theta) * theta.dot / 3]
    L = Lagrangian(centre[0] ** 2 + centre[1] ** 2 + theta.dot**2 / 4 - sin(x) * cos(y), q)
    sleigh = ConstrainedLagrangian(L, nonholonomic=[y.dot * cos(theta) - x.dot * sin(theta)])
    start = [0, 0, 0.2, 0.5 * np.cos(0.2), 0.5 * np.sin(0.2), 2]
    found = fitted_order(sleigh, start, order, {2: 300, 4: 80, 6: 50}[order], true)
    assert found == pytest.approx(order, abs=0.05 * order)


def residuals_of_a_step(system, before, after, h, *, kick_at_ends=False):
    """What the discrete Lagrange–d'Alembert equations of a step lack, in mpmath's numbers, multipliers eliminated."""
    L, q, v = system.lagrangian.L, system.lagrangian.q, system.lagrangian.velocities
    n, rest = len(q), dict.fromkeys(v, 0)

    def values(expressions, place, speed):
        point = dict(zip((*q, *v), (*place, *speed), strict=True))
        return [sp.lambdify(list(point), e, "mpmath")(*point.values()) for e in map(sp.sympify, expressions)]

    p, V = [L.diff(s) for s in v], -L.subs(rest)
    R = [(L + V).diff(s) for s in q]
    middle = [a + h / 2 * b for a, b in zip(before[:n], before[n:], strict=True)]
    at = [values([*p, *R], state[:n], state[n:]) for state in (before, after)]
    if kick_at_ends:
        pair = [values([-V.diff(s) for s in q], state[:n], state[n:]) for state in (before, after)]
        kick = [(a + b) / 2 for a, b in zip(*pair, strict=True)]
    else:
        kick = values([-V.diff(s) for s in q], middle, before[n:])
    lacking = [at[1][i] - at[0][i] - h / 2 * (at[0][n + i] + at[1][n + i]) - h * kick[i] for i in range(n)]
    rows = mpmath.matrix([values([g.diff(s) for s in v], middle, before[n:]) for g in system.nonholonomic])
    share = mpmath.lu_solve(rows * rows.T, rows * mpmath.matrix(lacking))
    across = mpmath.matrix(lacking) - rows.T * share
    places = [b - a - h / 2 * (c + d) for a, b, c, d in zip(
        before[:n], after[:n], before[n:], after[n:], strict=True
    )]  # fmt: skip
    return [*across, *places, *values(system.nonholonomic, after[:n], after[n:])]


@pytest.mark.slow
def test_a_step_solves_the_discrete_equations_to_thirty_digits():
    with mpmath.workdps(40):
        step = {"method": NonholonomicLeapfrog(2), "step": 0.125, "samples": 1, "precision": "double-double"}
        two = propagate(EVERYTHING, (0, 0.25), EVERYTHING_START, times=[0.125], **step | {"samples": None})
        one, other = (
            [mpmath.mpf(a) + mpmath.mpf(b) for a, b in zip(two.y[:, k], two.carried[:, k], strict=True)]
            for k in (1, 2)
        )
        lacking = residuals_of_a_step(EVERYTHING, one, other, mpmath.mpf(0.125))
        assert max(map(abs, lacking)) < 1e-29
        assert (
            max(map(abs, residuals_of_a_step(EVERYTHING, one, other, mpmath.mpf(0.125), kick_at_ends=True)))
            > 1e-5
        )


@pytest.mark.parametrize(
    ("system", "start"),
    [(PARTICLE, PARTICLE_START), (DRIVEN, DRIVEN_START)],
    ids=["particle", "driven"],
)
def test_time_reversal(system, start):
    method = NonholonomicLeapfrog(4)
    assert abs(reversal_error(system, (0, 3), start, method=method, step=0.05)).max() < 4e-14


def test_reversed_velocities_lead_back():
    turning = np.array([1, 1, 1, -1, -1, -1])
    run = functools.partial(propagate, PARTICLE, (0, 50), step=0.1, samples=1)
    there = run(PARTICLE_START, method=NonholonomicLeapfrog(2)).final
    back = run(turning * there, method=NonholonomicLeapfrog(2)).final
    assert abs(back * turning - PARTICLE_START).max() < 1e-12
    # Where Runge and Kutta's method arrives is not even on the constraint.
    with pytest.raises(ValueError, match="the start is not on the constraints"):
        run(turning * run(PARTICLE_START, method=RK4()).final, method=RK4())


def test_a_million_steps_of_the_particle():
    motion = propagate(
        PARTICLE, (0, 10**5), PARTICLE_START, method=NonholonomicLeapfrog(2), step=0.1, samples=1000
    )
    assert motion.steps == 10**6
    assert worst_residual(motion, PARTICLE) < 4 * U
    error = abs(motion.energy_error)
    assert error.max() < 3e-3
    assert error[-100:].max() < 1.5 * error[1:101].max()
    # Runge and Kutta's method of order 4 is as near at first, and loses a quarter of the energy.
    worse = propagate(PARTICLE, (0, 10**4), PARTICLE_START, method=RK4(), step=0.25, samples=100)
    assert abs(worse.energy_error)[-10:].max() > 30 * abs(worse.energy_error)[1]


def test_a_knife_edge_on_a_slope_goes_down_and_up_again():
    """x = (g/2ω²) sin² ωt down the slope of gravity g, y = (g/2ω²)(ωt − ½ sin 2ωt) across (Neimark & Fufaev)."""
    L = Lagrangian((x.dot**2 + y.dot**2 + theta.dot**2) / 2 + 3 * x, [x, y, theta])
    edge = ConstrainedLagrangian(L, nonholonomic=[y.dot * cos(theta) - x.dot * sin(theta)])
    motion = propagate(edge, (0, 300), [0, 0, 0, 0, 0, 2], method=NonholonomicLeapfrog(4), step=0.02)
    turned, size = 2 * motion.t, 3 / 8
    assert abs(motion["x"] - size * np.sin(turned) ** 2).max() < 1e-6
    assert abs(motion["y"] - size * (turned - np.sin(2 * turned) / 2)).max() < 1e-4
    assert abs(motion["y"] - size * (turned + np.sin(2 * turned) / 2)).max() > 0.1
    assert worst_residual(motion, edge) < 4 * U


@pytest.mark.slow
def test_chaplygins_ball():
    """A ball with three different moments rolls on a plane; M about the point of contact is constant in space.

    Energy and |M| stay near what they are, M_z is the momentum of φ, which the constraints leave free, and is kept.
    M itself turns about the vertical as the angles err.
    """
    q, moments = [x, y, phi, theta, psi], (sp.Rational(3, 10), sp.Rational(2, 5), sp.Rational(1, 2))
    R = sp.rot_axis3(phi).T * sp.rot_axis1(theta).T * sp.rot_axis3(psi).T
    in_body = sp.Matrix(
        [
            phi.dot * sin(theta) * sin(psi) + theta.dot * cos(psi),
            phi.dot * sin(theta) * cos(psi) - theta.dot * sin(psi),
            phi.dot * cos(theta) + psi.dot,
        ]
    )
    spin = R * in_body
    T = (x.dot**2 + y.dot**2 + sum(a * b**2 for a, b in zip(moments, in_body, strict=True))) / 2
    rolls = [sp.expand(x.dot - spin[1]), sp.expand(y.dot + spin[0])]
    ball = ConstrainedLagrangian(Lagrangian(T, q), nonholonomic=rolls)
    M = R * sp.diag(*moments) * in_body + sp.Matrix([spin[0], spin[1], 0])
    constants = sp.lambdify([*q, *ball.lagrangian.velocities], [sp.sqrt(M.dot(M)), M[2], M[0]])
    start = start_of(ball, [0, 0, 0.3, 1.2, 0.5], [0, 0, 0.4, 0.1, 0.9])
    exact = propagate(ball, (0, 100), start, samples=100)
    assert all(np.ptp(found) < 1e-11 for found in constants(*exact.y))
    motion = propagate(ball, (0, 10**4), start, method=NonholonomicLeapfrog(4), step=0.05, samples=2000)
    assert worst_residual(motion, ball) < 4 * U
    size, vertical, _ = constants(*motion.y)
    assert np.ptp(vertical) < 1e-12
    for found in (motion.energy_error, size):
        error = abs(found - found[0])
        assert error.max() < 1e-6
        assert error[-200:].max() < 1.5 * error[1:201].max()


@pytest.mark.slow
def test_the_steady_circle_of_a_disc():
    """The disc rolls on a circle with its tilt and rates as the closed form says, over 10⁶ steps and 1600 turns."""
    disc = find("rolling-disc")
    motion = propagate(disc, (0, 3000), "circle", method=NonholonomicLeapfrog(2), step=0.003, samples=1000)
    assert motion.steps == 10**6
    assert abs(motion["theta"] - 1.2).max() < 3e-6
    assert abs(motion["phi"] / (3 * motion.t[-1]) - motion.t / motion.t[-1]).max() < 1e-5
    assert abs(motion["theta_dot"]).max() < 1e-5
    assert abs(motion.energy_error).max() < 1e-8


@pytest.mark.slow
@pytest.mark.parametrize("start", ["wobbling", "straight"])
def test_the_energy_of_a_rolling_disc_is_bounded(start):
    """Its angles grow to thousands of turns, and what compensation carries of them counts in the constraints."""
    motion = propagate(
        "rolling-disc", (0, 2000), start, method=NonholonomicLeapfrog(4), step=0.005, samples=2000
    )
    error = abs(motion.energy_error)
    assert worst_residual(motion, constrained_disc()) < 4 * U
    assert error.max() < 1e-5
    assert error[-200:].max() < 2 * error[1:201].max() + 1e-14
    assert drift(motion).verdict in (Growth.BOUNDED, Growth.ROUND_OFF)


@pytest.mark.slow
def test_where_motion_is_chaotic_the_energy_wanders():
    """Reversible steps do not help there, and canon's verdict says so."""
    system = contact_oscillators(3)
    start = start_of(system, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], [0, 0.5, -0.2, 0.3, 0.4, -0.6, 0.1])
    motion = propagate(system, (0, 10**5), start, method=NonholonomicLeapfrog(4), step=0.1, samples=2000)
    assert worst_residual(motion, system) < 4 * U
    assert drift(motion).verdict is Growth.WANDERING


@pytest.mark.slow
def test_where_motion_is_not_reversible_the_energy_may_drift():
    """Two oscillators turn the plane of a third; out of phase no reversal leads back (Modin & Verdier 2020)."""
    L = Lagrangian((sum(s.dot**2 for s in (x, y, u, w)) - x**2 - y**2 - u**2 / 4 - w**2) / 2, [x, y, u, w])
    turning = ConstrainedLagrangian(L, nonholonomic=[y.dot - (0.8 * u + 0.5 * w) * x.dot])
    verdicts = {}
    for phase in (0.0, 1.0):
        start = [0.5, 0.2, 1, np.cos(phase), 0.3, 0.3 * (0.8 + 0.5 * np.cos(phase)), 0, -np.sin(phase)]
        motion = propagate(turning, (0, 10**5), start, method=NonholonomicLeapfrog(4), step=0.1, samples=2000)
        verdicts[phase] = drift(motion).verdict
    assert verdicts == {0.0: Growth.BOUNDED, 1.0: Growth.SECULAR}


def test_momenta_along_which_constraints_allow_motion_are_kept():
    """w is ignorable in K with masses 2 + sin x, and the constraint leaves it free; z is not left free."""
    K = (x.dot**2 + y.dot**2 + z.dot**2) / 2 + (2 + sin(x)) * w.dot**2 / 2
    L = Lagrangian(K - x**2 / 2 - y**4, [x, y, z, w])
    system = ConstrainedLagrangian(L, nonholonomic=[z.dot - y * x.dot])
    start = [1, 0.5, 0, 0, 0.3, -0.4, 0.15, 0.7]
    for method, kept in ((NonholonomicLeapfrog(2), True), (RK4(), False)):
        motion = propagate(system, (0, 200), start, method=method, step=0.1, samples=50)
        p = (2 + np.sin(motion["x"])) * motion["w_dot"]
        assert bool(abs(p - p[0]).max() < 1e-13) is kept
        assert np.ptp(motion["z_dot"]) > 0.1


@pytest.mark.slow
def test_a_ball_on_a_turntable_goes_in_a_circle():
    """A homogeneous ball rolls on a circle with 2/7 of the table's rate, wherever it begins (K. Weltner 1979)."""
    R, K = sp.Rational(1, 2), phi.dot**2 + theta.dot**2 + psi.dot**2 + 2 * phi.dot * psi.dot * cos(theta)
    L = Lagrangian((x.dot**2 + y.dot**2) / 2 + R**2 * K / 5, [x, y, phi, theta, psi])
    spin = (
        theta.dot * cos(phi) + psi.dot * sin(theta) * sin(phi),
        theta.dot * sin(phi) - psi.dot * sin(theta) * cos(phi),
    )
    ball = ConstrainedLagrangian(L, nonholonomic=[x.dot - R * spin[1] + y, y.dot + R * spin[0] - x])
    start = [1, 0, 0, 1.2, 0, 0, 0.7, 0.1, 0.6, 0]
    motion = propagate(ball, (0, 2), start, method=NonholonomicLeapfrog(4), step=0.01, samples=20)
    rate, t = 2 / 7, motion.t
    # ẍ = −(2/7) ẏ, ÿ = (2/7) ẋ, v = (0, 0.7) at (1, 0).
    assert abs(motion["x"] - (1 - 0.7 / rate * (1 - np.cos(rate * t)))).max() < 1e-8
    assert abs(motion["y"] - 0.7 / rate * np.sin(rate * t)).max() < 1e-8
    assert abs(motion["y"] - 0.7 / rate * np.sin(1.1 * rate * t)).max() > 1e-2
    assert abs(motion.energy_error).max() < 1e-8
    assert worst_residual(motion, ball) < 8 * U


def test_work_of_a_motor_and_the_multiplier_of_a_unicycle():
    L = Lagrangian(x.dot**2 + y.dot**2 + theta.dot**2 / 2, [x, y, theta], forces=[0, 0, sp.Rational(1, 5)])
    system = ConstrainedLagrangian(L, nonholonomic=[y.dot * cos(theta) - x.dot * sin(theta)])
    motion = propagate(system, (0, 4), [0, 0, 0, 1.5, 0, 0.5], method=NonholonomicLeapfrog(4), step=0.01)
    turning = 0.5 + 0.2 * motion.t
    assert abs(motion["theta_dot"] - turning).max() < 1e-14
    assert abs(motion.work - (turning**2 - 0.25) / 2).max() < 1e-14
    assert abs(motion.multipliers[0] - 2 * 1.5 * turning).max() < 1e-9


def test_rolling_that_is_holonomic_in_disguise_is_rattles_motion():
    """A cylinder on the slope of a hill: x − θ = 0 as a condition on places and on velocities."""
    L = Lagrangian(x.dot**2 / 2 + theta.dot**2 / 2 - cos(x), [x, theta])
    setting = {"step": 0.01, "samples": 20}
    rolls = ConstrainedLagrangian(L, nonholonomic=[x.dot - theta.dot])
    held = ConstrainedLagrangian(L, holonomic=[x - theta])
    one = propagate(rolls, (0, 5), [1, 1, 0, 0], method=NonholonomicLeapfrog(4), **setting)
    other = propagate(held, (0, 5), [1, 1, 0, 0], method=Rattle(4), **setting)
    assert abs(one.y - other.y).max() < 1e-7
    assert abs(one["x"] - one["theta"]).max() < 1e-14


def test_constraints_that_follow_from_others_stay_fulfilled():
    twice = ConstrainedLagrangian(
        particle().lagrangian, nonholonomic=[z.dot - y * x.dot, 2 * z.dot - 2 * y * x.dot]
    )
    motion = propagate(twice, (0, 20), PARTICLE_START, method=NonholonomicLeapfrog(4), step=0.1)
    one = propagate(PARTICLE, (0, 20), PARTICLE_START, method=NonholonomicLeapfrog(4), step=0.1)
    np.testing.assert_array_equal(motion.y, one.y)
    assert motion.residuals.shape[0] == 2
    assert abs(motion.residuals).max() < 1e-15


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "start"),
    [(PARTICLE, PARTICLE_START), (EVERYTHING, EVERYTHING_START)],
    ids=["particle", "everything"],
)
def test_precisions_differ_by_their_rounding(system, start):
    ends = {
        precision: propagate(
            system, (0, 1), start, method=NonholonomicLeapfrog(2), step=0.125, samples=1, precision=precision
        )
        for precision in ("single", "double", "compensated", "extended", "double-double")
    }
    true = ends["double-double"]
    assert abs(true.residuals[:, 1:]).max() < 1e-30
    for precision, unit in (("single", 3e-6), ("double", 5e-15), ("compensated", 2e-15), ("extended", 3e-18)):
        found = ends[precision]
        assert abs((found.y - true.y) + (found.carried - true.carried)).max() < unit


def test_same_bits_among_others_resumed_and_kept(tmp_path):
    arguments = {"method": NonholonomicLeapfrog(4), "step": 0.02}
    one = propagate(DRIVEN, (0, 2), DRIVEN_START, samples=7, **arguments)
    many = propagate(DRIVEN, (0, 2), np.array(DRIVEN_START)[:, None] * [1.0, 1.0], samples=7, **arguments)
    np.testing.assert_array_equal(many.y[:, :, 1], one.y)
    half = propagate(DRIVEN, (0, 1), DRIVEN_START, samples=3, **arguments)
    np.testing.assert_array_equal(half.resume(2).final, one.final)
    half.save(tmp_path / "half.npz")
    np.testing.assert_array_equal(load_motion(tmp_path / "half.npz").resume(2).final, one.final)


def test_parameters_by_orbit_observables_and_events():
    k = parameters("k", positive=True)
    system = particle(k * (x**2 + y**2) / 2)
    start = np.array(PARTICLE_START, dtype=float)[:, None] * [1.0, 1.0]
    setting = {"method": NonholonomicLeapfrog(2), "step": 0.02, "samples": 4, "observables": {"L": x * y.dot}}
    both = propagate(system, (0, 2), start, parameters={k: np.array([1.0, 2.0])}, **setting)
    one = propagate(system, (0, 2), PARTICLE_START, parameters={k: 2}, events=[Event(y - x)], **setting)
    assert abs(both.final[:, 1] - one.final).max() < 1e-14
    np.testing.assert_allclose(one["L"], one["x"] * one["y_dot"], atol=1e-15)
    met = one.events[0]
    assert abs(met.y[0] - met.y[1]) < 1e-12


@pytest.mark.filterwarnings("ignore:.*steps over the kinks")
def test_models_of_sympy_and_functions_made_of_pieces():
    """A spring that pushes and does not pull, taut on the way, as Piecewise, and as SymPy's LagrangesMethod has it."""
    a, b, c = me.dynamicsymbols("a b c")
    K = (a.diff() ** 2 + b.diff() ** 2 + c.diff() ** 2) / 2
    model = me.LagrangesMethod(K - (2 - a) ** 2, [a, b, c], nonhol_coneqs=[c.diff() - b * a.diff()])
    model.form_lagranges_equations()
    in_pieces = particle(sp.Piecewise(((2 - x) ** 2, x < 2), (0, True)))
    run = functools.partial(propagate, t_span=(0, 0.5), y0=[1, 0.5, 0, -0.2, 1, -0.1], step=0.01, samples=5)
    smooth = run(particle((2 - x) ** 2), method=NonholonomicLeapfrog(4))
    for system in (model, in_pieces):
        assert abs(run(system, method=NonholonomicLeapfrog(4)).y - smooth.y).max() < 1e-14
    ramp = Lagrangian(x.dot**2 / 2 + y.dot**2 / 2 - sp.Max(0, 2 - x) ** 2, [x, y])
    held = ConstrainedLagrangian(ramp, holonomic=[y - x])
    slid = propagate(held, (0, 0.5), [1, 1, 0, 0], method=Rattle(4), step=0.01)
    assert abs(slid["x"] - (2 - np.cos(slid.t))).max() < 1e-9
    rod = me.LagrangesMethod(
        (a.diff() ** 2 + b.diff() ** 2) / 2 - 9 * b, [a, b], hol_coneqs=[a**2 + b**2 - 1]
    )
    rod.form_lagranges_equations()
    own = ConstrainedLagrangian(
        Lagrangian((x.dot**2 + y.dot**2) / 2 - 9 * y, [x, y]), holonomic=[x**2 + y**2 - 1]
    )
    swung, same = (propagate(s, (0, 0.5), [1, 0, 0, 0], method=Rattle(4), step=0.01) for s in (rod, own))
    assert abs(swung.y - same.y).max() < 1e-14
    assert swung.final[1] < -0.5


# trouble ---------------------------------------------------------------------------------------------


def test_constraints_that_become_singular_on_the_way_are_told_with_the_state_before():
    free = Lagrangian((x.dot**2 + y.dot**2 + z.dot**2) / 2, [x, y, z])
    lost = ConstrainedLagrangian(free, nonholonomic=[x * z.dot + y * x.dot - x * y.dot])
    with pytest.raises(
        NonFiniteStateError, match=r"the constraints become dependent in the step after t = 0\.875"
    ) as caught:
        propagate(lost, (0, 3), [1, 1, 0, -1, -1, 0], method=NonholonomicLeapfrog(2), step=0.125)
    np.testing.assert_array_equal(caught.value.state, [0.125, 0.125, 0, -1, -1, 0])


def test_a_step_that_is_too_large_is_told_with_the_state_before():
    steep = ConstrainedLagrangian(PARTICLE.lagrangian, nonholonomic=[z.dot - sin(y + 9 * z) * x.dot])
    start = [1, 0, 0, 0, 1, 0]
    with pytest.raises(
        NonFiniteStateError, match=r"the velocities and multipliers of step 1 do not converge .*smaller step"
    ) as caught:
        propagate(steep, (0, 8), start, method=NonholonomicLeapfrog(2), step=1)
    np.testing.assert_array_equal(caught.value.state, start)


FREE = Lagrangian((x.dot**2 + y.dot**2) / 2 - y, [x, y])


@pytest.mark.parametrize(
    ("system", "start", "message"),
    [
        (PARTICLE, [1, 1, 0, 1, 0, 0], "the start is not on the constraints"),
        (
            ConstrainedLagrangian(FREE, [x**2 + y**2 - 1]),
            [1, 0, 0, 0],
            r"these are holonomic: Rattle\(\) keeps",
        ),
        (ConstrainedLagrangian(FREE, [y], [x * y.dot]), [1, 0, 1, 0], "there are holonomic ones too"),
        (ConstrainedLagrangian(FREE), [1, 0, 1, 0], "and there are none"),
        (
            ConstrainedLagrangian(Lagrangian(x.dot**2 / 2 - x * y, [x, y]), [], [y.dot - x.dot]),
            [1, 1, 0, 0],
            "the mass matrix is not positive along y",
        ),
    ],
)
def test_what_the_leapfrog_is_not_for_is_refused(system, start, message):
    with pytest.raises(ValueError, match=message):
        propagate(system, (0, 1), start, method=NonholonomicLeapfrog(), step=0.1)


def test_other_methods_and_the_leapfrog_name_each_other():
    with pytest.raises(TypeError, match="NonholonomicLeapfrog is for a ConstrainedLagrangian"):
        propagate(FREE, (0, 1), [0, 0, 0, 0], method="nonholonomic-leapfrog-4", step=0.1)
    with pytest.raises(ValueError, match="this is none; Splitting"):
        propagate("kepler", (0, 1), method=NonholonomicLeapfrog(), step=0.1)
    with pytest.raises(ValueError, match="NonholonomicLeapfrog keeps those"):
        propagate(PARTICLE, (0, 1), PARTICLE_START, method=Rattle(), step=0.1)
    with pytest.raises(ValueError, match=r"NonholonomicLeapfrog\(3\): the order is one of 2, 4, 6, 8"):
        NonholonomicLeapfrog(3)
    with pytest.raises(ValueError, match="derivative of steps that keep constraints"):
        flow_jacobian(PARTICLE, (0, 1), PARTICLE_START, method=NonholonomicLeapfrog(), step=0.1)


def test_a_choice_considers_it_where_it_applies():
    massless = ConstrainedLagrangian(Lagrangian(x.dot**2 / 2 - x * y, [x, y]), [], [y.dot - x.dot])
    chosen = candidate_methods(Question(PARTICLE, np.array(PARTICLE_START, dtype=float), {}, 10.0))
    assert NonholonomicLeapfrog(4) in chosen
    assert not any(isinstance(method, Rattle) for method in chosen)
    others = candidate_methods(Question(massless, np.array([1.0, 1, 0, 0]), {}, 10.0))
    assert not any(isinstance(method, NonholonomicLeapfrog) for method in others)
