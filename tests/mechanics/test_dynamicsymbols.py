"""SymPy's dynamicsymbols at every door: the same question with functions of time and with canon's symbols."""

import pytest
import sympy as sp
from sympy.physics.mechanics import dynamicsymbols

from canon.expression.symbols.symbol import acceleration, coordinates, parameters, time, time_derivative
from canon.flow.propagation import propagate
from canon.mechanics.algebra.dynamicsymbols import plain
from canon.mechanics.at_scale.constrained import constrained
from canon.mechanics.at_scale.first_order import canonical_derivation
from canon.mechanics.at_scale.second_order import derivation, derivation_of_lagrangian
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.hamilton.legendre_pair import hamiltonian, is_hamiltonian_of
from canon.mechanics.hamilton.symmetry import (
    is_constant_of_motion,
    is_gauge_equivalent,
    is_symmetry,
    noether_charge,
)
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.mechanics.lagrange.appell import GibbsAppell
from canon.mechanics.lagrange.body import (
    Particle,
    PlanarBody,
    RigidBody,
    euler_rotation,
    is_scleronomic,
    kinetic_energy,
    kinetic_form,
)
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.constraint_system import is_integrable, positional_freedom
from canon.mechanics.lagrange.force import (
    charge_term,
    damper,
    do_no_work,
    generalized_forces,
    generalized_moments,
    generalized_torques,
    lagrangian_of_bodies,
    rayleigh_forces,
)
from canon.mechanics.lagrange.frobenius import integrals
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.lagrange.newton_euler import Load, NewtonEuler
from canon.mechanics.lagrange.quasi_velocity import Kinematics, independent_velocities, maggi_equations
from canon.mechanics.reduction.constrained_motion import constrained_motions
from canon.mechanics.reduction.contact import multiplier_along, multiplier_in_contact
from canon.mechanics.reduction.eliminate_constraints import eliminated, embedded
from canon.mechanics.reduction.ignorable import adapted, is_ignorable
from canon.mechanics.reduction.routh import routhian
from canon.mechanics.reduction.singular import singularity
from canon.proof.domain.verdict import Status
from canon.study.motion.system_text import system_text

m, l, g, k, c, e, B, a = parameters("m l g k c e B a", positive=True)
TAU = dynamicsymbols._t


class Names:
    """The coordinates, their rates and the time, in one way of writing or the other."""

    def __init__(self, functions):
        make = dynamicsymbols if functions else coordinates
        self.x, self.y, self.theta, self.r = make("x y theta r")
        self.phi, self.psi, self.s = make("phi psi s")
        self.t = TAU if functions else time
        self.functions = functions

    def dot(self, q):
        return q.diff(TAU) if self.functions else q.dot

    def symbol(self, name):
        return dynamicsymbols(name) if self.functions else coordinates(name)

    def momentum(self, q):
        return dynamicsymbols(f"p_{q.func.__name__}") if self.functions else coordinates(f"p_{q.name}")


def dump(equations):
    graph = equations.graph
    return [graph.to_sympy(node) for node in equations.nodes]


def polar(n):
    """A particle on a spring in polar coordinates, pushed by a force that depends on time."""
    L = m * (n.dot(n.r) ** 2 + n.r**2 * n.dot(n.theta) ** 2) / 2 - k * n.r**2 / 2
    return Lagrangian(L, [n.r, n.theta])


def plane(n):
    return Lagrangian(m * (n.dot(n.x) ** 2 + n.dot(n.y) ** 2) / 2 - m * g * n.y, [n.x, n.y])


def blade(n):
    L = m * (n.dot(n.x) ** 2 + n.dot(n.y) ** 2 + n.dot(n.theta) ** 2) / 2
    rule = n.dot(n.x) * sp.sin(n.theta) - n.dot(n.y) * sp.cos(n.theta)
    return ConstrainedLagrangian(Lagrangian(L, [n.x, n.y, n.theta]), nonholonomic=[rule])


def bob(n):
    return Particle(m, (l * sp.sin(n.theta) + a * sp.cos(n.t), -l * sp.cos(n.theta)))


def oscillator(n):
    return Hamiltonian((n.momentum(n.x) ** 2 + n.x**2) / 2, [n.x], [n.momentum(n.x)])


def top(n):
    return RigidBody(m, (), (a, a, c), euler_rotation(n.phi, n.theta, n.psi))


DOORS = {
    "Lagrangian, explicit time in a force": lambda n: Lagrangian(
        m * n.dot(n.x) ** 2, [n.x], forces=[sp.cos(n.t)]
    ),
    "derivation": lambda n: dump(
        derivation([bob(n)], [n.theta], k * n.theta**2, (0, -g), [-c * n.dot(n.theta) * sp.cos(n.t)])
    ),
    "derivation of a plane and a spatial body": lambda n: (
        dump(derivation([PlanarBody(m, (n.x, n.y), a, n.theta)], [n.x, n.y, n.theta])),
        dump(derivation([top(n)], [n.theta, n.phi, n.psi])),
    ),
    "derivation of a Lagrangian": lambda n: dump(derivation_of_lagrangian(polar(n))),
    "canonical derivation": lambda n: (lambda d: d.graph.to_sympy(d.hamiltonian))(
        canonical_derivation([bob(n)], [n.theta], k * n.theta**2, (0, -g))
    ),
    "constraints at scale": lambda n: (lambda d: [d.equations.graph.to_sympy(i) for i in d.nodes])(
        constrained(
            derivation([Particle(m, (n.x, n.y))], [n.x, n.y]),
            [n.x**2 + n.y**2 - l**2],
            [n.dot(n.x) - n.dot(n.y)],
        )
    ),
    "embedded": lambda n: embedded(
        plane(n), {n.x: l * sp.sin(n.theta), n.y: -l * sp.cos(n.theta)}, [n.theta]
    ),
    "eliminated": lambda n: eliminated(ConstrainedLagrangian(plane(n), holonomic=[n.y - n.x * k]), [n.y]),
    "multiplier in contact": lambda n: multiplier_in_contact(
        ConstrainedLagrangian(polar(n), holonomic=[n.r - a]), {n.r: a}, (n.theta,)
    ),
    "multiplier along": lambda n: multiplier_along(
        ConstrainedLagrangian(polar(n), holonomic=[n.r - a]), {n.r: a}, n.theta, sp.S(0), sp.S(1)
    ),
    "multipliers named by functions": lambda n: ConstrainedLagrangian(
        plane(n), holonomic=[n.x**2 + n.y**2 - l**2]
    ).equations([n.symbol("lamda")]),
    "routhian": lambda n: routhian(polar(n), [n.theta], [n.momentum(n.theta)]),
    "quadrature": lambda n: routhian(polar(n)).quadrature({n.r: a + 0 * n.t}, {n.theta: sp.S(1)}),
    "ignorable": lambda n: (is_ignorable(polar(n), n.theta).status, is_ignorable(polar(n), n.r).status),
    "adapted": lambda n: adapted(
        Lagrangian(n.dot(n.x) ** 2 + n.dot(n.y) ** 2 - (n.x - n.y) ** 2, [n.x, n.y])
    ),
    "frobenius": lambda n: (is_integrable(blade(n)).status, positional_freedom(blade(n))),
    "integrals": lambda n: integrals(
        ConstrainedLagrangian(plane(n), nonholonomic=[n.y * n.dot(n.x) + n.x * n.dot(n.y)])
    ),
    "kinematics": lambda n: (
        Kinematics(
            [n.x, n.y, n.theta],
            [n.symbol("u"), n.symbol("w")],
            [n.symbol("u") * sp.cos(n.theta), n.symbol("u") * sp.sin(n.theta), n.symbol("w")],
        ).q_ddot
    ),
    "independent velocities": lambda n: independent_velocities(blade(n), [n.x, n.theta]).q_dot,
    "maggi": lambda n: maggi_equations(blade(n).lagrangian, independent_velocities(blade(n), [n.x, n.theta])),
    "gibbs-appell": lambda n: GibbsAppell([bob(n)], [n.theta], -m * g * l * sp.cos(n.theta)).equations,
    "newton-euler": lambda n: (
        NewtonEuler(
            [bob(n)],
            [n.theta],
            [Load(0, (-n.symbol("S") * sp.sin(n.theta), n.symbol("S") * sp.cos(n.theta) - m * g))],
            [n.symbol("S")],
        ).solution
    ),
    "generalized forces": lambda n: generalized_forces([(-c * n.dot(n.theta), 0)], [bob(n).r], [n.theta]),
    "generalized torques": lambda n: generalized_torques([n.dot(n.x)], [n.x - n.theta], [n.x, n.theta]),
    "generalized moments": lambda n: generalized_moments(
        [(0, 0, n.dot(n.psi))], [top(n)], [n.theta, n.phi, n.psi]
    ),
    "ideal reactions": lambda n: (
        do_no_work(
            [(-k * sp.sin(n.theta), k * sp.cos(n.theta))],
            [(l * sp.sin(n.theta), -l * sp.cos(n.theta))],
            [n.theta],
        ).status
    ),
    "damper": lambda n: damper(c, (n.x, n.y), (0, 0), [n.x, n.y]),
    "rayleigh": lambda n: rayleigh_forces(c * n.dot(n.x) ** 2 / 2, [n.x]),
    "charge": lambda n: charge_term(e, (n.x, n.y), [n.x, n.y], (0, B * n.x), e * n.y),
    "lagrangian of bodies": lambda n: lagrangian_of_bodies(
        [bob(n)], [n.theta], k * n.theta, dissipation=n.dot(n.theta) ** 2
    ),
    "kinetic energy and its form": lambda n: (
        kinetic_energy([bob(n)], [n.theta]),
        kinetic_form(m * n.dot(n.x) ** 2 / 2 + n.dot(n.x) * n.x, [n.x]),
    ),
    "scleronomic": lambda n: (
        is_scleronomic([bob(n)], q=[n.theta]).status,
        is_scleronomic([Particle(m, (n.x, n.x**2))], q=[n.x]).status,
    ),
    "singularity": lambda n: (
        singularity(
            Lagrangian((n.dot(n.x) - n.y) ** 2 / 2, [n.x, n.y]), [n.momentum(n.x), n.momentum(n.y)]
        ).primary_constraints
    ),
    "constants of motion": lambda n: (
        is_constant_of_motion(n.r**2 * n.dot(n.theta), polar(n)).status,
        is_constant_of_motion(n.r * n.dot(n.theta), polar(n)).status,
    ),
    "noether": lambda n: (
        noether_charge(plane(n), [1, 0], K=n.x),
        is_symmetry(plane(n), [n.t, 0], K=m * n.x).status,
    ),
    "gauge": lambda n: (
        is_gauge_equivalent(plane(n), Lagrangian(plane(n).L, plane(n).q), F=n.x * n.y * 0).status
    ),
    "hamiltonian of L": lambda n: hamiltonian(plane(n), [n.momentum(n.x), n.momentum(n.y)]),
    "is hamiltonian of": lambda n: (
        is_hamiltonian_of(
            Lagrangian(n.dot(n.x) ** 2 / 2 - n.x**2, [n.x]),
            n.momentum(n.x) ** 2 / 2 + n.x**2,
            [n.momentum(n.x)],
        ).status
    ),
    "rates in phase space": lambda n: oscillator(n).rate(n.x * n.momentum(n.x) + n.t),
    "hamilton's equations": lambda n: oscillator(n).has_equations([n.momentum(n.x)], [-n.x]).status,
    "motion": lambda n: oscillator(n).is_solution({n.x: sp.sin(n.t), n.momentum(n.x): sp.cos(n.t)}).status,
    "hamiltonian": lambda n: (
        Hamiltonian(n.momentum(n.x) ** 2 / 2 + n.x**2 * sp.cos(n.t), [n.x], [n.momentum(n.x)]).vector_field
    ),
}


@pytest.mark.parametrize("door", DOORS)
def test_functions_of_time_are_taken_at_the_door(door):
    with_functions, with_symbols = DOORS[door](Names(functions=True)), DOORS[door](Names(functions=False))
    assert with_functions == with_symbols
    verdicts = with_functions if isinstance(with_functions, tuple) else (with_functions,)
    assert Status.UNDECIDED not in [v for v in verdicts if isinstance(v, Status)]


def test_another_function_of_time_is_not_a_coordinate():
    """A drive a(t) stays a function; only the named coordinates become symbols."""
    drive = sp.Function("drive")(time)
    x = dynamicsymbols("x")
    kept = plain(x * drive, [coordinates("x")])
    assert kept == coordinates("x") * drive
    with pytest.raises(ValueError, match="t is another symbol than the time t"):
        plain(sp.Symbol("t", positive=True) * TAU, [coordinates("x")])
    with pytest.raises(TypeError, match="no coordinate"):
        Lagrangian(x.diff(TAU) ** 2, [x**2])


def test_derivatives_as_they_are_written_are_taken():
    """d(l sin θ + x)/dt as SymPy leaves it holds two rates; with symbols it would be that of constants, zero."""
    theta, x = dynamicsymbols("theta x")
    q = coordinates("theta x")
    X, Y = x + l * sp.sin(theta), -l * sp.cos(theta)
    written = m * (sp.Derivative(X, TAU) ** 2 + sp.Derivative(Y, TAU) ** 2) / 2
    assert written.has(sp.Derivative(X, TAU))
    L = Lagrangian(written - m * g * Y, [theta, x])
    on_cart = [Particle(m, (q[1] + l * sp.sin(q[0]), -l * sp.cos(q[0])))]
    assert sp.simplify(L.L - lagrangian_of_bodies(on_cart, q, m * g * on_cart[0].r[1]).L) == 0
    assert sp.simplify(L.mass_matrix.det()) == m**2 * l**2 * sp.sin(q[0]) ** 2


@pytest.mark.parametrize(
    ("written", "taken"),
    [
        (lambda q, V: sp.Derivative(q**2, TAU), lambda s, V: 2 * s * s.dot),
        (lambda q, V: sp.Derivative(V(q), TAU), lambda s, V: V(s).diff(s) * s.dot),
        (
            lambda q, V: sp.Derivative(q * sp.Derivative(q, TAU), TAU),
            lambda s, V: s.dot**2 + s * acceleration(s),
        ),
        (lambda q, V: V(q).diff(q), lambda s, V: V(s).diff(s)),
        (lambda q, V: sp.Derivative(sp.Integral(V(k), (k, 0, q)), q), lambda s, V: V(s)),
    ],
    ids=["square", "potential", "nested", "force", "integral"],
)
def test_a_derivative_as_it_is_written_is_that_of_symbols(written, taken):
    V, s = sp.Function("V"), coordinates("theta")
    assert sp.expand(plain(written(dynamicsymbols("theta"), V), [s])) == taken(s, V)


def test_a_constraint_by_a_derivative_as_it_is_written_has_the_same_multiplier():
    x, y = coordinates("x y")
    V = sp.Function("V")
    L = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 - k * y**2 / 2, [x, y])
    curves = [sp.Derivative(x * V(x), x), V(x) + x * V(x).diff(x)]
    bound = (ConstrainedLagrangian(L, holonomic=[y - curve]) for curve in curves)
    written, taken = (constrained_motions(each, [])[0].multipliers for each in bound)
    assert written == taken


def test_a_bound_symbol_may_have_the_name_of_a_coordinate_or_of_the_time():
    """What an integral runs over is no coordinate; beside it the same symbol would be taken for one."""
    x, other, later = coordinates("x"), sp.Symbol("x"), sp.Symbol("t", positive=True)
    for bound, refused in (
        (other, "another symbol than the variable x"),
        (later, "another symbol than the time t"),
    ):
        area = sp.Integral(bound**2, (bound, 0, x))
        assert plain(area, [x]).doit() == x**3 / 3
        with pytest.raises(ValueError, match=refused):
            plain(area + bound, [x])


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (lambda x, p: time_derivative(x**2, [x]), r"q should be symbols, .* not x\(t\)"),
        (lambda x, p: poisson_bracket(x, p, [x], [p]), r"q should be symbols, .* not x\(t\)"),
        (lambda x, p: CanonicalTransformation(x, p, p, -x), r"q should be symbols, .* not x\(t\)"),
        (
            lambda x, p: hamilton_jacobi(x),
            r"should be a Hamiltonian, not x\(t\); give Hamiltonian\(H, q, p\)",
        ),
        (
            lambda x, p: propagate(x, (0, 1), [1]),
            r"x\(t\) is no system that can be propagated: give a Hamiltonian",
        ),
        (lambda x, p: system_text(x), r"x\(t\) is no system that can be propagated: give a Hamiltonian"),
    ],
)
def test_doors_for_symbols_say_that_a_function_of_time_is_none(asked, message):
    """The class of x(t) has no module that would tell whose it is."""
    x, p = dynamicsymbols("x p")
    assert type(x).__module__ is None
    with pytest.raises(TypeError, match=message):
        asked(x, p)


@pytest.mark.parametrize("clock", [time, TAU])
def test_a_derivative_of_a_symbol_by_the_time_is_no_rate(clock):
    """The kinetic energy would be lost, as x is a constant in it; a field V(x, t) is derived by the time alone."""
    x, V = coordinates("x"), sp.Function("V")
    for moving in (x, l * sp.sin(x), x * V(x, clock)):
        written = sp.Derivative(moving, clock)
        with pytest.raises(ValueError, match=r"takes the symbol x for a constant: write its rate as x\.dot"):
            Lagrangian(m * written**2 / 2, [x])
    assert x.dot**2 / 2 - V(x, time).diff(time) == Lagrangian(x.dot**2 / 2 - V(x, clock).diff(clock), [x]).L
    assert Lagrangian(x.dot**2 / 2 - sp.Derivative(a * clock**2, clock) * x, [x]).equations[0].doit() == (
        acceleration(x) + 2 * a * time
    )
