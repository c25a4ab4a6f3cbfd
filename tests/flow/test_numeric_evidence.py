"""Numeric evidence: each true claim has a wrong twin, and evidence decides nothing."""

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from sympy import Function, cos, sin, sqrt, symbols

from canon.expression.symbols.symbol import time
from canon.flow.geometry import numeric_evidence
from canon.flow.geometry.certified_derivatives import RoundedValue, _point_misses
from canon.flow.geometry.numeric_evidence import (
    bilinear_covariant,
    brackets_at_points,
    integral_along_motion,
    symplectic_flow,
)
from canon.flow.geometry.vector_field_motion import step_error
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.hamilton.vector_field import VectorField
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Evidence, Status, Undecided, Verdict

q, p, x, y, px, py = symbols("q p x y p_x p_y", real=True)
m, k, w = symbols("m k omega", positive=True)
r = sqrt(x**2 + y**2)

PENDULUM = Hamiltonian(p**2 / 2 - cos(q), q, p)
KEPLER = Hamiltonian((px**2 + py**2) / (2 * m) - k / r, (x, y), (px, py))
KEPLER_START = [1, 0, 0.1, 1.2]
UNITS = {m: 1, k: 1}
HENON_HEILES = Hamiltonian((px**2 + py**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3, (x, y), (px, py))
DRIVEN = Hamiltonian(p**2 / 2 - (1 + cos(2 * time) / 5) * cos(q), q, p)


def runge_lenz(sign):
    return (x * py - y * px) * py + sign * m * k * x / r


# brackets at points --------------------------------------------------------------------------------

POLAR = ((x, y), (px, py), (r, sp.atan2(y, x)), ((x * px + y * py) / r, x * py - y * px))


def test_brackets_of_a_canonical_map_vanish_and_with_p_doubled_they_do_not():
    old_q, old_p, Q, P = POLAR
    seen = brackets_at_points(CanonicalTransformation(old_q, old_p, Q, P))
    assert seen.speaks == "for"
    assert seen.largest < 1e-40
    assert seen.looks == 20
    twin = brackets_at_points(CanonicalTransformation(old_q, old_p, Q, [2 * f for f in P]))
    assert twin.speaks == "against"
    assert twin.largest == pytest.approx(1, abs=1e-12)
    assert "certainly not canonical with valence 1" in twin.text


def test_the_valence_is_taken_into_account():
    doubled = CanonicalTransformation(q, p, q, w * p)
    assert brackets_at_points(doubled, valence=w).speaks == "for"
    assert brackets_at_points(doubled, valence=w, parameters={w: "3.5"}).speaks == "for"
    wrong = brackets_at_points(doubled, parameters={w: "3.5"})
    assert (wrong.speaks, wrong.largest) == ("against", 2.5)
    assert brackets_at_points(doubled, parameters={w: 1}).speaks == "for"


def test_points_where_the_map_is_not_real_are_no_evidence():
    root = sqrt(2 * q)
    seen = brackets_at_points(CanonicalTransformation(q, p, root * sin(p), root * cos(p)), points=9)
    assert (seen.speaks, seen.looks) == ("against", 9)
    assert seen.largest == pytest.approx(2)  # {Q, P} = −1
    good = brackets_at_points(CanonicalTransformation(q, p, root * cos(p), root * sin(p)), points=9)
    assert (good.speaks, good.looks) == ("for", 9)
    domain = Domain(conditions=(q < 0,))
    with pytest.raises(ValueError, match="no finite real value"):
        brackets_at_points(CanonicalTransformation(q, p, root * cos(p), root * sin(p), domain=domain))


def test_points_stay_in_the_domain_when_a_parameter_is_fixed():
    # Canonical where q < w only: |q − w| has slope −1 there.
    flip = CanonicalTransformation(q, p, sp.Abs(q - w), -p, domain=Domain(conditions=(q < w,)))
    assert brackets_at_points(flip, parameters={w: "1/2"}).speaks == "for"
    other = CanonicalTransformation(q, p, sp.Abs(q - w), -p, domain=Domain(conditions=(q > w,)))
    assert brackets_at_points(other, parameters={w: "1/2"}).speaks == "against"


def test_rounded_numbers_in_a_map_decide_nothing():
    rounded = sp.Rational("0.3333333333333333")
    seen = brackets_at_points(CanonicalTransformation(q, p, rounded * q, 3 * p))
    assert seen.speaks == "neither"
    assert seen.roundoff < seen.largest < 1e-15


def test_a_map_with_an_arbitrary_function_is_refused():
    f = Function("f")
    with pytest.raises(ValueError, match=r"arbitrary function f\(q\)"):
        brackets_at_points(CanonicalTransformation(q, p, q, p + f(q)))


def test_the_round_off_of_a_bracket_is_that_of_its_products_and_of_the_valence():
    """Of {Q, P} = a d − b c, with errors of 1, 2, 4, 8 and of 16 for the valence, in units of 10⁻⁶."""
    size = Fraction(1, 10**6)
    a, b, c, d, valence = (
        RoundedValue(Fraction(number), error * size)
        for number, error in ((2, 1), (-3, 2), (5, 4), (7, 8), (1, 16))
    )
    (miss,) = _point_misses([a, b, c, d, valence], 1, {})
    assert (miss.size, miss.scale) == (2 * 7 + 3 * 5 - 1, 2 * 7 + 3 * 5 + 1)
    assert miss.unit == (2 * 8 + 7 * 1 + 3 * 4 + 5 * 2 + 16) * size


# flow ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("motion", "start", "parameters"),
    [(PENDULUM, [1, 0.3], {}), (DRIVEN, [1, 0.3], {}), (KEPLER, KEPLER_START, UNITS),
     (HENON_HEILES, [0.1, 0.2, 0.3, 0.1], {})],
)  # fmt: skip
def test_a_hamiltonian_flow_is_symplectic(motion, start, parameters):
    for measure in (symplectic_flow, bilinear_covariant):
        seen = measure(motion, (0, 15), start, parameters=parameters)
        assert seen.speaks == "for", seen.text
        assert seen.largest < 1e-10
        assert seen.looks == 101


@pytest.mark.parametrize("measure", [symplectic_flow, bilinear_covariant])
def test_a_damped_flow_is_not_symplectic(measure):
    free = VectorField((p, -sin(q)), (q, p))
    assert measure(free, (0, 10), [1, 0]).speaks == "for"
    damped = VectorField((p, -sin(q) - k * p), (q, p))
    seen = measure(damped, (0, 10), [1, 0], parameters={"k": "0.01"})
    assert seen.speaks == "against"
    assert "not symplectic" in seen.text


def test_the_contraction_of_a_damped_flow_is_the_known_one():
    """The divergence is −γ, so MᵀJM = exp(−γt) J in one degree of freedom."""
    damped = VectorField((p, -sin(q) - p / 10), (q, p))
    contraction = 1 - np.exp(-0.5)
    assert symplectic_flow(damped, (0, 5), [1, 0]).largest == pytest.approx(contraction, rel=1e-12)
    seen = bilinear_covariant(damped, (0, 5), [1, 0], variations=[[1, 0], [0, 2]])
    assert seen.largest == pytest.approx(2 * contraction, rel=1e-12)
    assert "-2 at the start" in seen.text  # Σ(δp Δq − Δp δq) with δ = (1, 0), Δ = (0, 2)


def test_each_degree_of_freedom_counts():
    """A flow that turns volume into volume, yet is not symplectic: (x, p_x) shrinks as (y, p_y) swells."""
    field = VectorField((px, py, -x - px / 10, -y + py / 10), (x, y, px, py))
    for measure in (symplectic_flow, bilinear_covariant):
        assert measure(field, (0, 5), [1, 0, 0, 1]).speaks == "against"


def test_motion_too_sensitive_for_doubles_decides_nothing():
    saddle = Hamiltonian(p**2 / 2 - q**2 / 2, q, p)
    seen = symplectic_flow(saddle, (0, 30), [1, 0])
    assert seen.speaks == "neither"
    assert "decides nothing" in seen.text
    assert symplectic_flow(saddle, (0, 3), [1, 0]).speaks == "for"


def test_errors_of_steps_add_up_as_those_of_a_random_walk():
    states = np.array([[1.0, -4.0], [3.0, 2.0]])
    assert step_error(states, 8) == pytest.approx(2.0**-52 * 3.0 * np.array([3.0, 4.0]), rel=1e-15, abs=0)


def test_the_round_off_to_be_expected_is_what_errors_of_the_states_make(monkeypatch):
    """Of the oscillator, whose flow is a rotation, with errors of 10⁻⁹ in everything; they do most at t = π/4."""
    monkeypatch.setattr(numeric_evidence, "step_error", lambda states, _: np.full(states.shape[1], 1e-9))
    oscillator, half = Hamiltonian((p**2 + q**2) / 2, q, p), {"samples": 2}
    span, start = (0, math.pi / 2), [1, 0]
    flow = symplectic_flow(oscillator, span, start, **half)
    assert flow.roundoff == pytest.approx(2 * math.sqrt(2) * 1e-9)
    pair = bilinear_covariant(oscillator, span, start, variations=[[1, 0], [0, 2]], **half)
    assert pair.roundoff == pytest.approx((1 + 2) * math.sqrt(2) * 1e-9)
    energy = integral_along_motion(oscillator.H, oscillator, span, start, **half)
    assert energy.roundoff == pytest.approx(math.sqrt(2) * 1e-9)


# integrals -----------------------------------------------------------------------------------------


def test_energy_is_kept_and_energy_with_something_added_is_not():
    seen = integral_along_motion(PENDULUM.H, PENDULUM, (0, 20), [1, 0])
    assert seen.speaks == "for"
    assert seen.largest < 1e-13
    twin = integral_along_motion(PENDULUM.H + q / 100, PENDULUM, (0, 20), [1, 0])
    assert twin.speaks == "against"
    assert twin.largest == pytest.approx(0.02, rel=1e-2)
    assert "certainly no constant of this motion" in twin.text


def test_the_runge_lenz_vector_has_one_sign():
    assert (
        integral_along_motion(runge_lenz(-1), KEPLER, (0, 20), KEPLER_START, parameters=UNITS).speaks == "for"
    )
    twin = integral_along_motion(runge_lenz(1), KEPLER, (0, 20), KEPLER_START, parameters=UNITS)
    assert twin.speaks == "against"


def test_an_integral_may_hold_the_time():
    oscillator = Hamiltonian((p**2 + w**2 * q**2) / 2, q, p)
    phase = q * cos(w * time) - p * sin(w * time) / w
    seen = integral_along_motion(phase, oscillator, (-3, 9), [1, 0.5], parameters={w: 2})
    assert seen.speaks == "for"
    assert "over t = -3 … 9" in seen.text
    twin = phase.subs(time, -time)
    assert integral_along_motion(twin, oscillator, (-3, 9), [1, 0.5], parameters={w: 2}).speaks == "against"
    assert integral_along_motion(DRIVEN.H, DRIVEN, (0, 9), [1, 0.3]).speaks == "against"


def test_an_integral_of_a_vector_field_of_three_variables():
    a, b, c = symbols("a b c", real=True)
    euler = VectorField((b * c, -2 * c * a, a * b), (a, b, c))
    assert integral_along_motion(a**2 + b**2 + c**2, euler, (0, 10), [1, 0.2, 0.4]).speaks == "for"
    assert integral_along_motion(a**2 + b**2 - c**2, euler, (0, 10), [1, 0.2, 0.4]).speaks == "against"
    with pytest.raises(ValueError, match="3 variables"):
        symplectic_flow(euler, (0, 10), [1, 0.2, 0.4])


def test_a_chaotic_motion_keeps_its_energy():
    seen = integral_along_motion(HENON_HEILES.H, HENON_HEILES, (0, 400), [0, -0.15, 0.5, 0])
    assert seen.speaks == "for", seen.text


@pytest.mark.parametrize("size", [sp.Integer(10) ** -40, sp.Integer(10) ** 40])
def test_how_large_a_claimed_integral_is_changes_nothing(size: sp.Expr) -> None:
    for claimed, speaks in ((PENDULUM.H, "for"), (PENDULUM.H + q / 100, "against")):
        plain, scaled = (
            integral_along_motion(factor * claimed, PENDULUM, (0, 5), [1, 0]) for factor in (1, size)
        )
        assert (plain.speaks, scaled.speaks) == (speaks, speaks)
        assert scaled.roundoff == pytest.approx(float(size) * plain.roundoff, rel=1e-6)


def test_units_may_be_far_from_one():
    """The Earth about the Sun in kilograms, metres and seconds."""
    parameters = {m: "5.97e24", k: "7.92e44"}
    start = ["1.496e11", 0, 0, "1.778e29"]
    seen = integral_along_motion(KEPLER.H, KEPLER, (0, "3.15e7"), start, parameters=parameters)
    assert seen.speaks == "for"
    assert seen.largest < 1e-13 * 2.65e33
    twin = integral_along_motion(
        KEPLER.H * (1 + x / 10**15), KEPLER, (0, "3.15e7"), start, parameters=parameters
    )
    assert twin.speaks == "against"


def test_what_changes_less_than_doubles_show_is_not_called_kept():
    seen = integral_along_motion(PENDULUM.H + q / 10**18, PENDULUM, (0, 20), [1, 0])
    assert seen.speaks == "neither"


def test_where_nothing_can_be_measured_there_is_no_evidence():
    with pytest.raises(ValueError, match="equilibrium"):
        integral_along_motion(q, PENDULUM, (0, 20), [0, 0])
    with pytest.raises(ValueError, match="no variable"):
        integral_along_motion(sp.Integer(5), PENDULUM, (0, 20), [1, 0])
    with pytest.raises(ValueError, match="no finite real value at t = 0"):
        integral_along_motion(sp.log(-(p**2)), PENDULUM, (0, 20), [1, 0])
    with pytest.raises(ValueError, match="arbitrary function"):
        integral_along_motion(Function("f")(q), PENDULUM, (0, 20), [1, 0])
    with pytest.raises(KeyError, match="k, m"):
        integral_along_motion(x, KEPLER, (0, 1), KEPLER_START)
    with pytest.raises(ValueError, match="3 numbers"):
        integral_along_motion(x, KEPLER, (0, 1), [1, 0, 0], parameters=UNITS)
    with pytest.raises(ValueError, match="no finite real number"):
        integral_along_motion(x, KEPLER, (0, 1), [1, 0, 0, float("nan")], parameters=UNITS)
    with pytest.raises(NonFiniteStateError):
        integral_along_motion(KEPLER.H, KEPLER, (0, 3), [1, 0, 0, 0], parameters=UNITS)


# verdicts ------------------------------------------------------------------------------------------


def test_evidence_leaves_the_status():
    seen = integral_along_motion(PENDULUM.H, PENDULUM, (0, 20), [1, 0])
    open_ = Verdict(Status.UNDECIDED, "the energy is constant", evidence=(Evidence("before", "known"),))
    told = open_.witness(seen.evidence)
    assert told.undecided
    assert [e.kind for e in told.evidence] == ["before", "drift of an integral"]
    with pytest.raises(Undecided):
        bool(told)
    against = integral_along_motion(q, PENDULUM, (0, 20), [1, 0])
    for status in Status:
        assert Verdict(status).witness(seen.evidence, against.evidence).status is status
    assert seen.text in str(told)
