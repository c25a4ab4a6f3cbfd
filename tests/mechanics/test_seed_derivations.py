"""The derivations of the lecture notes for arbitrary functions: principles, multipliers, Routh, with wrong twins."""

import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates, parameters, time, time_derivative
from canon.mechanics.hamilton.legendre_pair import hamiltonian
from canon.mechanics.lagrange.body import Particle
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.constraint_system import is_integrable
from canon.mechanics.lagrange.force import do_no_work, generalized_forces, lagrangian_of_bodies
from canon.mechanics.lagrange.frobenius import integrals
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.reduction.routh import routhian
from canon.proof.equivalence import equivalent_equations
from canon.proof.vanish import vanishes

m, g, R, J, K, La, Ra, k, a, b, c, r1, r2 = parameters("m g R J K L_a R_a k a b c r1 r2", positive=True)
m1, m2, m3, J0, J2 = parameters("m1 m2 m3 J0 J2", positive=True)
x, y, z, theta, phi, charge = coordinates("x y z theta phi charge")
u, load, alpha = sp.symbols("u T_load alpha", real=True)


def same(one, other):
    assert vanishes(sp.sympify(one) - other).holds


def different(one, other):
    assert vanishes(sp.sympify(one) - other).fails


def test_lagranges_equations_from_hamiltons_principle():
    """δL = Σ (L_q η + L_v η̇) = d/dt Σ p η + Σ (L_q − ṗ) η for any L(q, q̇, t) and any variation η(t)."""
    system = Lagrangian(sp.Function("L")(x, y, x.dot, y.dot, time), [x, y])
    eta = [sp.Function(f"eta{i}")(time) for i in range(2)]
    pairs = list(zip(system.q, eta, strict=True))
    variation = sum(system.L.diff(s) * n + system.L.diff(s.dot) * n.diff(time) for s, n in pairs)
    boundary = sum(p * n for p, n in zip(system.momenta, eta, strict=True))
    bulk = sum(e * n for e, n in zip(system.equations, eta, strict=True))
    same(variation, time_derivative(boundary, system.q) - bulk)
    different(variation, time_derivative(boundary, system.q) + bulk)


def test_multiplier_equations_for_any_L_and_any_constraints():
    """d/dt L_v − L_q − Q = Σ λ a for a·q̇ + a₀ = 0, n + m equations for n + m unknowns."""
    coefficients = [sp.Function(f"a{i}")(x, y, z, time) for i in range(3)]
    rest, f = sp.Function("a4")(x, y, z, time), sp.Function("f")(x, y, z, time)
    free = Lagrangian(
        sp.Function("L")(x, y, z, x.dot, y.dot, z.dot, time), [x, y, z], forces=[sp.Function("Q")(x), 0, 0]
    )
    rolling = sum(c_ * s.dot for c_, s in zip(coefficients, free.q, strict=True)) + rest
    bound = ConstrainedLagrangian(free, holonomic=[f], nonholonomic=[rolling])
    one, two = sp.symbols("lambda1 lambda2", real=True)
    equations = bound.equations([one, two])
    assert len(equations) == len(free.q) + 2
    for s, e, lagrange, c_ in zip(free.q, equations, free.equations, coefficients, strict=False):
        same(e, lagrange - one * f.diff(s) - two * c_)
        different(e, lagrange + one * f.diff(s) + two * c_)
    assert equations[3:] == (f, rolling)


def test_a_differentiated_constraint_is_holonomic_in_disguise():
    """Ḟ = Σ ∂F/∂q q̇ + ∂F/∂t restricts positions whatever F; a twin with one coefficient changed does not."""
    F = sp.Function("F")(x, y, z, time)
    free = Lagrangian((x.dot**2 + y.dot**2 + z.dot**2) / 2, [x, y, z])
    assert is_integrable(ConstrainedLagrangian(free, nonholonomic=[time_derivative(F, [x, y, z])])).holds
    rate = time_derivative(x * y + sp.sin(time) * z, [x, y, z])
    assert is_integrable(ConstrainedLagrangian(free, nonholonomic=[rate])).holds
    twin = ConstrainedLagrangian(free, nonholonomic=[rate + y * x.dot])
    assert is_integrable(twin).fails
    assert integrals(twin) == ()


def test_dalemberts_principle_projects_newton():
    """Σ (F − m r̈)·∂r/∂q = 0 is Lagrange's equation, and reactions along the normal do no work."""
    place = (R * sp.sin(theta), -R * sp.cos(theta))
    tension = sp.Symbol("S", real=True)
    normal = (-tension * sp.sin(theta), tension * sp.cos(theta))
    assert do_no_work([normal], [place], [theta]).holds
    assert do_no_work([(tension * sp.cos(theta), 0)], [place], [theta]).fails
    applied = (-c * place[0].diff(theta) * theta.dot, -m * g)
    r_ddot = [time_derivative(time_derivative(p, [theta]), [theta]) for p in place]
    inertia = [F + N - m * A for F, N, A in zip(applied, normal, r_ddot, strict=True)]
    (projected,) = generalized_forces([inertia], [place], [theta])
    Q = generalized_forces([applied], [place], [theta])
    bob = lagrangian_of_bodies([Particle(m, place)], [theta], forces=Q)
    same(projected, -bob.equations[0])
    different(projected, bob.equations[0])


def test_generalized_force_of_a_potential():
    """Q = −∂U/∂q + τ on either side of d/dt ∂T/∂q̇ − ∂T/∂q, for any r(q)."""
    r, tau = [sp.Function(f"r{i}")(x) for i in range(2)], sp.Symbol("tau", real=True)
    potential = k * r[0] ** 2 * r[1] + sp.Function("U")(x)
    with_potential = lagrangian_of_bodies([Particle(m, r)], [x], potential, forces=[tau])
    as_force = lagrangian_of_bodies([Particle(m, r)], [x], forces=[tau - potential.diff(x)])
    same(with_potential.equations[0], as_force.equations[0])
    different(
        with_potential.equations[0], lagrangian_of_bodies([Particle(m, r)], [x], forces=[tau]).equations[0]
    )


def test_rouths_equations():
    """R_q = L_q, R_v = L_v, R_p = −φ̇, for every L quadratic in the velocities with coefficients free in x."""
    A, B, C, D, V = (sp.Function(name)(x) for name in "ABCDV")
    L = Lagrangian(A * x.dot**2 / 2 + B * x.dot * phi.dot + C * phi.dot**2 / 2 + D * phi.dot - V, [x, phi])
    reduced = routhian(L, [phi])
    (p,), (rate,) = reduced.momenta, reduced.ignorable_velocities
    through = {phi.dot: rate}
    same(rate, (p - B * x.dot - D) / C)
    same(reduced.R, (L.L - p * phi.dot).xreplace(through))
    for z_ in (x, x.dot):
        same(reduced.R.diff(z_), L.L.diff(z_).xreplace(through))
    same(reduced.R.diff(p), -rate)
    different(reduced.R.diff(p), rate)
    lagrange = L.equations[0].xreplace({phi.ddot: time_derivative(rate, [x])}).xreplace(through)
    same(reduced.equations[0], lagrange)


def test_hamiltons_equations():
    """H = Σ p q̇ − L, q̇ = ∂H/∂p, ṗ = −∂H/∂q with coefficients free in x."""
    A, D, V = (sp.Function(name)(x) for name in "ADV")
    L = Lagrangian(A * x.dot**2 / 2 + D * x.dot - V, [x])
    H = hamiltonian(L)
    there = dict(zip(H.p, L.momenta, strict=True))
    same(H.H.xreplace(there), x.dot * L.momenta[0] - L.L)
    same(H.q_dot[0].xreplace(there), x.dot)
    same(H.p_dot[0].xreplace(there), L.L.diff(x))
    different(H.p_dot[0].xreplace(there), -L.L.diff(x))


def augmented(L, rule):
    """L* = L + λ f with the velocity form f of a constraint, λ a coordinate of its own."""
    lam = coordinates("lam")
    return Lagrangian(L.L + lam * rule, [*L.q, lam]), lam


def test_the_augmented_lagrangian_of_the_hollow_cylinder():
    """L* = L + λ (R θ̇ − ẋ): right motion, as the constraint is integrable, and the friction is λ̇, not λ."""
    L = Lagrangian(m * x.dot**2 / 2 + m * R**2 * theta.dot**2 / 2 + m * g * x * sp.sin(alpha), [x, theta])
    rule = R * theta.dot - x.dot
    star, lam = augmented(L, rule)
    bound = ConstrainedLagrangian(L, nonholonomic=[rule])
    on_motion = dict(zip((x.ddot, theta.ddot), bound.accelerations, strict=True))
    for e in star.equations[:2]:
        same(e.xreplace(on_motion).xreplace({lam.dot: -bound.multipliers[0]}), 0)
    different(star.equations[0].xreplace(on_motion).xreplace({lam.dot: bound.multipliers[0]}), 0)


def test_the_augmented_lagrangian_of_a_blade_is_not_dalemberts():
    """Where the constraint is not integrable, L* gives other (vakonomic) equations: they hold λ itself."""
    L = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 + J * theta.dot**2 / 2, [x, y, theta])
    rule = x.dot * sp.sin(theta) - y.dot * sp.cos(theta)
    star, lam = augmented(L, rule)
    bound = ConstrainedLagrangian(L, nonholonomic=[rule])
    on_motion = dict(zip((s.ddot for s in L.q), bound.accelerations, strict=True))
    turned = star.equations[2].xreplace(on_motion)
    assert turned.has(lam)
    different(turned, 0)
    for e in ConstrainedLagrangian(L, nonholonomic=[rule]).equations([sp.Symbol("l")])[2:3]:
        same(e.xreplace(on_motion), 0)


def test_dc_motor_with_its_armature():
    """Charge and angle as coordinates: L_a i̇ + R_a i + K ω = u, J ω̇ = K i − T_L (K_E = K_T)."""
    L = La * charge.dot**2 / 2 + J * theta.dot**2 / 2 + K * theta * charge.dot
    motor = Lagrangian(L, [charge, theta], forces=[u - Ra * charge.dot, -load])
    circuit = La * charge.ddot + Ra * charge.dot + K * theta.dot - u
    shaft = J * theta.ddot - K * charge.dot + load
    unknowns = [charge.ddot, theta.ddot]
    assert equivalent_equations(motor.equations, [circuit, shaft], unknowns).holds
    assert equivalent_equations(motor.equations, [circuit, shaft + 2 * K * charge.dot], unknowns).fails


def test_two_gears_in_mesh():
    """r₁ θ₁ = −r₂ θ₂: the torques at the teeth are r₁ λ and r₂ λ."""
    T1, T2 = sp.symbols("T1 T2", real=True)
    pair = Lagrangian(J0 * theta.dot**2 / 2 + J2 * phi.dot**2 / 2, [theta, phi], forces=[T1, T2])
    geared = ConstrainedLagrangian(pair, holonomic=[r1 * theta + r2 * phi])
    first, second = geared.reactions
    same(first / r1, second / r2)
    same(geared.accelerations[0], (T1 - T2 * r1 / r2) / (J0 + J2 * r1**2 / r2**2))
    different(geared.accelerations[0], (T1 + T2 * r1 / r2) / (J0 + J2 * r1**2 / r2**2))


@pytest.mark.parametrize("eccentric", [False, True])
def test_the_inertia_of_the_piston_engine_to_first_order(eccentric):
    """λ = r/l small: I = J₀ + m_A r² + (m₃ + m_B) r² sin² θ + J_AB λ² cos² θ, also for an e of the order of r."""
    lam, mA, mB, JAB = parameters("lamda m_A m_B J_AB", positive=True)
    offset = lam / 3 if eccentric else sp.S.Zero
    sine = lam * sp.sin(theta) - offset
    rod = sp.asin(sine)
    s = R * (sp.cos(theta) + sp.cos(rod) / lam)
    inertia = J0 + mA * R**2 + (m3 + mB) * s.diff(theta) ** 2 + JAB * rod.diff(theta) ** 2
    leading_s = sp.limit(s.diff(theta), lam, 0)
    leading_rod = sp.limit(rod.diff(theta) / lam, lam, 0)
    truncated = J0 + mA * R**2 + (m3 + mB) * leading_s**2 + JAB * lam**2 * leading_rod**2
    printed = J0 + mA * R**2 + (m3 + mB) * R**2 * sp.sin(theta) ** 2 + JAB * lam**2 * sp.cos(theta) ** 2
    same(truncated, printed)
    different(inertia, printed)
    assert sp.limit(inertia - printed, lam, 0) == 0


def test_small_angles_of_the_spherical_particle():
    """The printed small-angle form lacks r² in the last term, as its own equation before shows."""
    r = sp.Symbol("r", positive=True)
    P = sp.Symbol("P", real=True)
    L = Lagrangian(
        m * (r_.dot**2 + r_**2 * theta.dot**2 + r_**2 * sp.sin(theta) ** 2 * phi.dot**2) / 2
        + m * g * r_ * sp.cos(theta),
        [r_, theta, phi],
    )
    polar = routhian(L, [phi], [P]).equations[1] / m

    def centrifugal(equation):
        return (equation - equation.xreplace({P: sp.S.Zero})).xreplace({r_: r})

    small = sp.limit(centrifugal(polar) * theta**3, theta, 0)
    same(small, -(P**2) / (m**2 * r**2))
    different(small, -(P**2) / m**2)
    gravity = polar.xreplace({P: sp.S.Zero, theta.ddot: sp.S.Zero, theta.dot: sp.S.Zero})
    same(gravity.diff(theta).xreplace({theta: sp.S.Zero}), g * r_)


r_ = coordinates("r", positive=True)
