"""What a reader of the code found: symbols that only look like the variable or the time, and maps with other pairs."""

import pytest
import sympy as sp
from sympy import Abs, Rational, Symbol, cos, cot, pi, symbols

from canon import (
    CanonicalTransformation,
    Domain,
    GeneratingFunction,
    Hamiltonian,
    Lagrangian,
    coordinates,
    parameters,
)
from canon import time as t
from canon.mechanics.at_scale.second_order import derivation
from canon.mechanics.canonical.from_generating_function import generated_hamiltonian, of_kind
from canon.mechanics.canonical.implicit_transformation import ImplicitTransformation
from canon.mechanics.canonical.integrator_step import runge_kutta_step
from canon.mechanics.canonical.new_hamiltonian import is_new_hamiltonian, new_hamiltonian
from canon.mechanics.canonical.transformation import point_transformation
from canon.mechanics.canonical.transformed_hamiltonian import transformed_hamiltonian
from canon.mechanics.hamilton.legendre_pair import hamiltonian
from canon.mechanics.hamilton.poisson_system import PoissonSystem
from canon.mechanics.hamilton.rotating_body import free_body
from canon.mechanics.hamilton.symmetry import is_constant_of_motion
from canon.mechanics.hamilton.vector_field import VectorField, hamiltonian_field
from canon.mechanics.lagrange.body import Particle, kinetic_energy
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.force import electric_field, magnetic_field
from canon.mechanics.reduction.eliminate_constraints import embedded
from canon.mechanics.reduction.routh import routhian

q, p, Q, P = symbols("q p Q P", real=True)
x, y, r, th, phi = coordinates("x y r theta phi")
m, g, c, v = parameters("m g c v", positive=True)
bare = Symbol("t")
NAMESAKE = "is another symbol than the variable"


# The time, as anybody writes it


@pytest.mark.parametrize("clock", [t, bare])
def test_a_boost_in_the_plain_time(clock):
    boost = CanonicalTransformation(q, p, q - v * clock, p - m * v)
    assert sp.expand(new_hamiltonian(boost, p**2 / (2 * m)) - p**2 / (2 * m) + v * p) == 0
    assert is_new_hamiltonian(boost, p**2 / (2 * m), (P + m * v) ** 2 / (2 * m), [Q, P]).fails
    right = (P + m * v) ** 2 / (2 * m) - v * (P + m * v)
    assert is_new_hamiltonian(boost, p**2 / (2 * m), right, [Q, P]).holds
    K = transformed_hamiltonian(boost, p**2 / (2 * m), [Q], [P]).H
    assert sp.expand(K - right).is_constant(Q, P)
    F = GeneratingFunction(2, (q - v * clock) * P, q, p, Q, P)
    assert sp.expand(generated_hamiltonian(F, p**2 / (2 * m)).H - P**2 / (2 * m) + v * P) == 0


@pytest.mark.parametrize("clock", [t, bare])
def test_the_plain_time_of_valences_systems_and_fields(clock):
    assert CanonicalTransformation(q, p, q * clock, p).is_canonical(valence=None).fails
    free = PoissonSystem(p**2 / 2, [q, p], [[0, 1], [-1, 0]])
    assert free.is_constant_of_motion(q - p * clock).holds
    assert free.is_constant_of_motion(q + p * clock).fails
    assert electric_field((0, x * clock, 0), 0, [x, y, r]) == (0, -x, 0)
    with pytest.raises(ValueError, match="the brackets of the variables hold t"):
        PoissonSystem(p**2 / 2, [q, p], [[0, clock], [-clock, 0]])
    assert point_transformation(q, p, q + clock).new_q == (q + t,)


def test_a_time_with_assumptions_is_refused_or_given():
    other = Symbol("t", positive=True)
    with pytest.raises(ValueError, match="t is another symbol than the time t"):
        Lagrangian(m * sp.exp(2 * g * other) * x.dot**2 / 2, [x])
    with pytest.raises(ValueError, match="t is another symbol than the time t"):
        CanonicalTransformation(q, p, q - v * other, p - m * v)
    damped = Lagrangian(m * sp.exp(2 * g * other) * x.dot**2 / 2, [x], t=other)
    assert damped.equations[0].has(g * x.dot)
    assert Lagrangian(x.dot**2 / 2 + sp.Dummy("t") * x, [x]).L.has(x)


# Symbols that look like a variable


@pytest.mark.parametrize("name", ["p_theta", "theta"])
@pytest.mark.parametrize("assumed", [{}, {"real": True}])
def test_a_namesake_of_a_variable_is_no_constant(name, assumed):
    H = hamiltonian(Lagrangian(m * th.dot**2 / 2 + m * g * cos(th), [th]))
    with pytest.raises(ValueError, match=f"{name} {NAMESAKE} {name}"):
        is_constant_of_motion(Symbol(name, **assumed), H)
    assert is_constant_of_motion(th.momentum, H).fails
    assert is_constant_of_motion(sp.Dummy(name), H).holds


@pytest.mark.parametrize(
    "made",
    [
        lambda: Hamiltonian(Symbol("p_x", real=True) ** 2 / 2, [x], [x.momentum]),
        lambda: Lagrangian(x.dot**2 / 2 - Symbol("x", real=True) ** 2 / 2, [x]),
        lambda: ConstrainedLagrangian(Lagrangian(x.dot**2 + y.dot**2, [x, y]), holonomic=[Symbol("x") - y]),
        lambda: Hamiltonian((p**2 + q**2) / 2 + Symbol("q") ** 3, q, p),
        lambda: CanonicalTransformation(q, p, q, p + Symbol("q")),
        lambda: point_transformation(q, p, Symbol("q") + q),
        lambda: GeneratingFunction(2, q * Symbol("P"), q, p, Q, P),
        lambda: ImplicitTransformation((q,), (p,), (Q,), (P,), (Q - Symbol("q"), P - p)),
        lambda: new_hamiltonian(CanonicalTransformation(q, p, p, -q), Symbol("p") ** 2),
        lambda: is_new_hamiltonian(CanonicalTransformation(q, p, p, -q), p, Symbol("Q"), [Q, P]),
        lambda: PoissonSystem(p**2 / 2, [q, p], [[0, 1], [-1, 0]]).rate(Symbol("q")),
        lambda: PoissonSystem(p**2 / 2, [q, p], [[0, Symbol("q")], [-Symbol("q"), 0]]),
        lambda: VectorField([p, -Symbol("q")], [q, p]),
        lambda: hamiltonian_field(Symbol("p") ** 2 / 2, q, p),
        lambda: free_body([1, 2, 3]).is_constant_of_motion(Symbol("M_1")),
        lambda: embedded(Lagrangian(x.dot**2 + y.dot**2, [x, y]), {Symbol("x", real=True): 2 * y}, [y]),
        lambda: kinetic_energy([Particle(m, (Symbol("x"),))], [x]),
        lambda: derivation([Particle(m, (Symbol("x"),))], [x]),
        lambda: derivation([Particle(m, (x,))], [x], V=Symbol("x") ** 2),
    ],
)
def test_doors_refuse_namesakes(made):
    with pytest.raises(ValueError, match=NAMESAKE):
        made()


def test_rates_go_on_to_be_known_by_their_names():
    assert Lagrangian(Symbol("x_dot") ** 2 / 2, [x]).equations == (x.ddot,)
    later = Hamiltonian(p**2 / 2, coordinates("t"), p)  # a coordinate of that name beside the time
    assert Hamiltonian(p**2 / 2 + t * later.q[0], later.q, p).p_dot == (-t,)


# New symbols that are called as others


def test_momenta_are_called_as_nothing_else():
    free = Lagrangian(m * x.dot**2 / 2, [x])
    with pytest.raises(ValueError, match="m is the name of a momentum and"):
        hamiltonian(free, p=[m])
    with pytest.raises(ValueError, match="x is the name of a momentum and"):
        hamiltonian(Lagrangian(x.dot**2 / 2, [x]), p=[x])
    assert P**2 / (2 * m) == hamiltonian(free, p=[P]).H
    central = m * (r.dot**2 + r**2 * phi.dot**2) / 2
    with pytest.raises(ValueError, match="m is the name of a momentum and"):
        routhian(Lagrangian(central, [r, phi]), [phi], momenta=[m])
    with pytest.raises(ValueError, match="p_phi is the name of a momentum and"):
        routhian(Lagrangian(central - parameters("p_phi") * r, [r, phi]), [phi])
    assert routhian(Lagrangian(central, [r, phi]), [phi], momenta=[c]).R.has(c)


def test_the_energy_is_called_as_nothing_else():
    from canon.mechanics.integrable.complete_integral import hamilton_jacobi

    stiff = Hamiltonian(p**2 + Symbol("E", positive=True) * q**2, q, p)
    with pytest.raises(ValueError, match="E already stands in H"):
        hamilton_jacobi(stiff)
    e = Symbol("e", real=True)
    assert hamilton_jacobi(stiff, energy=e).momenta[0].square.has(e)


# Maps: pairs, times, valences, domains


def test_a_hamiltonian_has_the_pairs_and_the_time_of_the_map():
    shift = CanonicalTransformation(q, p, q + t, p)
    with pytest.raises(ValueError, match="the momentum of p is q in H and another one in the map"):
        new_hamiltonian(shift, Hamiltonian(q**2 / 2 + p**4, [p], [q]))
    tau = Symbol("tau", real=True)
    with pytest.raises(ValueError, match="the time of H is tau and that of the map is t"):
        new_hamiltonian(shift, Hamiltonian(p**2 + tau * q, q, p, tau))
    assert new_hamiltonian(shift, Hamiltonian(p**2, q, p, tau)) == p**2 + p
    a, b = symbols("a b", real=True)
    both = CanonicalTransformation([q, Q], [a, b], [q, Q], [a, b])
    assert new_hamiltonian(both, Hamiltonian(a**2 + b, [Q, q], [b, a])) == a**2 + b
    with pytest.raises(ValueError, match="pair coordinates and momenta alike"):
        new_hamiltonian(both, Hamiltonian(a**2 + b, [q, Q], [b, a]))
    with pytest.raises(ValueError, match="another one in the generating function"):
        generated_hamiltonian(GeneratingFunction(2, q * P, q, p, Q, P), Hamiltonian(q**2, p, q))
    identity = GeneratingFunction(2, q * P, q, p, Q, P)
    assert generated_hamiltonian(identity, Hamiltonian(p**2, q, p)).H == P**2


@pytest.mark.parametrize("valence", [p, t, 0])
def test_the_valence_of_an_implicit_map_is_a_constant(valence):
    step = ImplicitTransformation((q,), (p,), (Q,), (P,), (Q - q, P - p))
    with pytest.raises(ValueError, match="the valence should be a constant other than 0"):
        step.is_canonical(valence=valence)
    assert step.is_canonical(valence=1).holds
    assert step.is_canonical(valence=2).fails


def test_the_valence_of_a_new_hamiltonian_is_found():
    twice = CanonicalTransformation(q, p, q, 2 * p)
    assert is_new_hamiltonian(twice, p**2, P**2 / 2, [Q, P], valence=None).holds
    assert is_new_hamiltonian(twice, p**2, P**2, [Q, P], valence=None).fails
    bent = CanonicalTransformation(q, p, q, p**2)
    assert is_new_hamiltonian(bent, p**2, P, [Q, P], valence=None).fails


def test_a_map_is_judged_where_it_is_meant():
    folded = CanonicalTransformation(q, p, Abs(q), p)
    assert is_new_hamiltonian(folded, p**2 + q, P**2 + Q, [Q, P], Domain((q > 0,))).holds
    assert is_new_hamiltonian(folded, p**2 + q, P**2 + Q, [Q, P], Domain((q < 0,))).fails
    half = CanonicalTransformation(Q, P, Abs(Q), P, Domain((Q > 0,)))
    after = CanonicalTransformation(q, p, q, p).then(half)
    assert after.domain.conditions == (q > 0,)
    assert after.is_canonical().holds


def test_another_type_keeps_its_branch():
    positive = symbols("w", positive=True)
    F1 = GeneratingFunction(
        1, positive * q**2 * cot(Q) / 2, q, p, Q, P, Domain((Q > 0, pi / 2 > Q, q > 0, P > 0))
    )
    F2 = of_kind(F1, 2)
    there = {q: 1, P: 1, positive: 1}
    assert len(F2.domain.conditions) >= 2
    assert all(c.subs(there) == sp.true and Q not in c.free_symbols for c in F2.domain.conditions)


# Told in words


def test_words_for_shapes():
    assert hamiltonian_field(p**2 / 2, q, p).components == (p, 0)
    assert hamiltonian_field(0, [q], [p]).components == (0, 0)
    assert VectorField((q,), (q,))(1) == 0
    with pytest.raises(ValueError, match="2 coordinates and 1 momentum"):
        hamiltonian_field(p**2 / 2, [q, Q], [p])
    oscillator, h = Hamiltonian(p**2 / 2 + q**2 / 2, q, p), Symbol("h", real=True)
    with pytest.raises(ValueError, match="b has 2 entries for 1 stage"):
        runge_kutta_step(oscillator, h, [[]], [0, 1])
    heun = runge_kutta_step(oscillator, h, [[], [1]], [Rational(1, 2)] * 2)
    assert sp.expand(heun.new_q[0]) == q + h * p - h**2 * q / 2
    with pytest.raises(ValueError, match="three components"):
        magnetic_field((0, x), [x, y])
    assert magnetic_field((0, x, 0), [x, y, r]) == (0, 0, 1)


def test_momenta_of_a_lagrangian_are_its_own():
    """p_θ of a pendulum was taken for a parameter, which is constant."""
    m, g = sp.symbols("m g", positive=True)
    r, theta = coordinates("r theta")
    pendulum = Lagrangian(m * theta.dot**2 / 2 + m * g * sp.cos(theta), [theta])
    assert is_constant_of_motion(theta.momentum, pendulum).fails
    assert is_constant_of_motion(theta.momentum**2 / (2 * m) - m * g * sp.cos(theta), pendulum).holds
    turning = Lagrangian(m * (r.dot**2 + r**2 * theta.dot**2) / 2 - r**2, [r, theta])
    assert is_constant_of_motion(theta.momentum, turning).holds
    assert is_constant_of_motion(r.momentum, turning).fails
