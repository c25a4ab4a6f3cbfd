"""SymPy's mechanics models taken over: motions agree, multipliers have the other sign, Kane agrees with Appell."""

import pytest
import sympy as sp
from sympy.physics.mechanics import (
    KanesMethod,
    LagrangesMethod,
    Particle,
    Point,
    ReferenceFrame,
    RigidBody,
    dynamicsymbols,
    inertia,
)

from canon.expression.symbols.symbol import coordinates, parameters
from canon.mechanics.algebra.dynamicsymbols import plain
from canon.mechanics.lagrange.appell import GibbsAppell
from canon.mechanics.lagrange.body import Particle as Mass
from canon.mechanics.lagrange.body import PlanarBody, kinetic_energy
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.lagrange.sympy_bridge import from_sympy_mechanics
from canon.proof.vanish import vanishes

m, g, l, a, J, R, I1, I3, d = parameters("m g l a J R I1 I3 d", positive=True)
x, y, theta, phi, psi = coordinates("x y theta phi psi")
X, Y, TH, PHI, PSI = dynamicsymbols("x y theta phi psi")
sin, cos = sp.sin, sp.cos


def sleigh():
    """Chaplygin's sleigh as a LagrangesMethod."""
    (t,) = X.args
    V = [(X + a * cos(TH)).diff(t), (Y + a * sin(TH)).diff(t)]
    L = m * (V[0] ** 2 + V[1] ** 2) / 2 + J * TH.diff() ** 2 / 2
    return LagrangesMethod(L, [X, Y, TH], nonhol_coneqs=[X.diff() * sin(TH) - Y.diff() * cos(TH)])


def pendulum():
    L = m * (X.diff() ** 2 + Y.diff() ** 2) / 2 - m * g * Y
    return LagrangesMethod(L, [X, Y], hol_coneqs=[X**2 + Y**2 - l**2])


@pytest.mark.parametrize("make", [sleigh, pendulum])
def test_motion_agrees_and_multipliers_have_the_other_sign(make):
    method = make()
    taken = from_sympy_mechanics(method)
    method.form_lagranges_equations()
    q = taken.lagrangian.q
    found = dict(zip((s.ddot for s in q), taken.accelerations, strict=True))
    lam = sp.symbols(f"lam1:{len(taken.multipliers) + 1}", real=True)
    named = dict(zip(method.lam_vec, lam, strict=True))
    opposite = {symbol: -value for symbol, value in zip(lam, taken.multipliers, strict=True)}
    for equation in method.eom:
        here = plain(equation.xreplace(named), q)
        assert vanishes(here.xreplace(found).xreplace(opposite)).holds
    same = dict(zip(lam, taken.multipliers, strict=True))
    gaps = [plain(e.xreplace(named), q).xreplace(found).xreplace(same) for e in method.eom]
    assert any(vanishes(gap).fails for gap in gaps)


def test_holonomic_constraints_stay_holonomic():
    taken = from_sympy_mechanics(pendulum())
    assert taken.holonomic == (x**2 + y**2 - l**2,)
    assert taken.nonholonomic == ()
    mixed = LagrangesMethod(
        X.diff() ** 2 + Y.diff() ** 2, [X, Y], hol_coneqs=[X - 1], nonhol_coneqs=[Y.diff()]
    )
    assert from_sympy_mechanics(mixed).holonomic == (x - 1,)
    assert from_sympy_mechanics(mixed).nonholonomic == (y.dot,)


def test_forces_and_torques_are_taken_over():
    N = ReferenceFrame("N")
    B = N.orientnew("B", "Axis", [TH, N.z])
    O = Point("O")
    O.set_vel(N, 0)
    bob = O.locatenew("P", l * B.x)
    bob.v2pt_theory(O, N, B)
    M = sp.Symbol("M", real=True)
    loads = [(bob, -d * bob.vel(N)), (B, M * N.z)]
    method = LagrangesMethod(m * l**2 * TH.diff() ** 2 / 2, [TH], forcelist=loads, frame=N)
    taken = from_sympy_mechanics(method)
    assert vanishes(taken.lagrangian.forces[0] - (M - d * l**2 * theta.dot)).holds
    assert vanishes(taken.lagrangian.forces[0] + (M - d * l**2 * theta.dot)).fails


def rolling_disc_by_kane():
    """An upright disc that rolls down along x: speeds of heading and roll, two dependent ones."""
    u1, u2, u3, u4 = dynamicsymbols("u1 u2 u3 u4")
    N = ReferenceFrame("N")
    heading = N.orientnew("H", "Axis", [PHI, N.z])
    heading.set_ang_vel(N, u3 * N.z)
    body = ReferenceFrame("D")
    body.set_ang_vel(heading, u4 * heading.y)
    body.orient_axis(heading, heading.y, PSI)
    body.set_ang_vel(N, u3 * N.z + u4 * heading.y)
    O, C = Point("O"), Point("C")
    O.set_vel(N, 0)
    C.set_pos(O, X * N.x + Y * N.y)
    C.set_vel(N, u1 * N.x + u2 * N.y)
    spin = RigidBody("spin", C, body, 0, (inertia(heading, 0, I3, 0), C))
    plain_disc = RigidBody("d", C, heading, m, (inertia(heading, 0, 0, I1), C))
    rolling = [u1 - R * cos(PHI) * u4, u2 - R * sin(PHI) * u4]
    method = KanesMethod(
        N, [X, Y, PHI, PSI], [u3, u4],
        kd_eqs=[X.diff() - u1, Y.diff() - u2, PHI.diff() - u3, PSI.diff() - u4],
        u_dependent=[u1, u2], velocity_constraints=rolling,
    )  # fmt: skip
    method.kanes_equations([plain_disc, spin], [(C, m * g * N.x)])
    return method


def test_kane_agrees_with_appell():
    taken = from_sympy_mechanics(rolling_disc_by_kane())
    assert [s.name for s in taken.kinematics.u] == ["u3", "u4", "u1", "u2"]
    u3, u4, u1, u2 = taken.kinematics.u
    q = [x, y, phi, psi]
    bodies = [Mass(m, (x, y)), PlanarBody(0, (), I1, phi), PlanarBody(0, (), I3, psi)]
    rates = [R * cos(phi) * u4, R * sin(phi) * u4, u3, u4]
    appell = GibbsAppell(bodies, q, -m * g * x, u=[u3, u4], q_dot=rates)
    for ours, theirs in zip(appell.quasi_accelerations, taken.quasi_accelerations, strict=False):
        assert vanishes(ours - theirs).holds
    uphill = GibbsAppell(bodies, q, m * g * x, u=[u3, u4], q_dot=rates)
    assert vanishes(uphill.quasi_accelerations[1] - taken.quasi_accelerations[1]).fails
    assert len({u1, u2}) == 2


def test_kane_pendulum_agrees_with_lagrange():
    u = dynamicsymbols("u")
    N = ReferenceFrame("N")
    A = N.orientnew("A", "Axis", [TH, N.z])
    A.set_ang_vel(N, u * N.z)
    O = Point("O")
    O.set_vel(N, 0)
    bob = O.locatenew("P", -l * A.y)
    bob.v2pt_theory(O, N, A)
    method = KanesMethod(N, [TH], [u], kd_eqs=[TH.diff() - u])
    with pytest.raises(ValueError, match="call its kanes_equations"):
        from_sympy_mechanics(method)
    method.kanes_equations([Particle("bob", bob, m)], [(bob, -m * g * N.y)])
    taken = from_sympy_mechanics(method)
    assert vanishes(taken.quasi_accelerations[0] + g / l * sin(theta)).holds
    assert vanishes(taken.quasi_accelerations[0] - g / l * sin(theta)).fails


def test_dynamicsymbols_at_every_door():
    L = Lagrangian(m * (X.diff() ** 2 + Y.diff() ** 2) / 2 - m * g * Y, [X, Y])
    constrained = ConstrainedLagrangian(L, holonomic=[X**2 + Y**2 - l**2])
    same = ConstrainedLagrangian(L, holonomic=[x**2 + y**2 - l**2])
    assert constrained.holonomic == same.holonomic
    assert kinetic_energy([Mass(m, (l * sin(TH), l * cos(TH)))], [TH]) == kinetic_energy(
        [Mass(m, (l * sin(theta), l * cos(theta)))], [theta]
    )
    with_functions = GibbsAppell([Mass(m, (X, Y))], [X, Y], m * g * Y)
    assert with_functions.equations == GibbsAppell([Mass(m, (x, y))], [x, y], m * g * y).equations
    with pytest.raises(TypeError, match="neither a LagrangesMethod"):
        from_sympy_mechanics(L)
