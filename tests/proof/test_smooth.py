"""Kinks and jumps: where derivatives exist, and what they do not show."""

import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from canon import CanonicalTransformation, Hamiltonian, Lagrangian, coordinates, is_constant_of_motion
from canon.mechanics import is_gauge_equivalent
from canon.proof.domain.domain import Domain
from canon.proof.kinks import off_kinks

x = sp.symbols("x", real=True)
whole = st.integers(-3, 3)


@given(a=whole, b=whole, c=whole, d=whole)
def test_every_kink_of_a_sum_of_moduli_and_maxima_is_excluded_and_no_other_point(a, b, c, d):
    f = sp.Abs((x - a) * (x - b)) + sp.Max(x - c, 0) + sp.Abs(x**2 + d**2 + 1)
    kept = off_kinks([f], Domain()).domain
    for place in range(-4, 5):
        inside = all(condition.subs(x, place) for condition in kept.conditions)
        assert bool(inside) is (place not in ((a, b, c) if a != b else (c,)))  # |(x − a)²| has no kink


def test_verdicts_of_mechanics_leave_out_kinks_and_mind_jumps():
    q, p = sp.symbols("q p", real=True)
    free = Hamiltonian(p**2 / 2, q, p)
    assert CanonicalTransformation(q, p, abs(q), p * sp.sign(q)).is_canonical("all").holds
    assert CanonicalTransformation(q, p, abs(q), p).is_canonical().fails
    assert is_constant_of_motion(sp.Piecewise((p**2, p > 0), (p**3, True)), free).holds
    assert is_constant_of_motion(sp.Piecewise((p, q > 0), (2 * p, True)), free).fails
    assert is_constant_of_motion(p * sp.sign(q), free).fails
    assert is_constant_of_motion(p * sp.sign(q), free, Domain((sp.Ne(q, 0),))).undecided
    assert is_constant_of_motion(p * sp.sign(q), free, Domain((q > 0,))).holds


def test_slopes_that_differ_from_piece_to_piece_are_no_gauge():
    s = coordinates("s")
    v = s.dot
    rest = Lagrangian(v**2 / 2, [s])

    def with_gauge(f):
        return Lagrangian(v**2 / 2 + f, [s])

    assert is_gauge_equivalent(rest, with_gauge(v * sp.sign(s)), abs(s)).holds
    assert is_gauge_equivalent(rest, with_gauge(sp.Piecewise((v, v > 0), (-v, True)))).fails
    assert is_gauge_equivalent(rest, with_gauge(sp.Piecewise((v, v > 0), (v, True)))).holds
