"""Generating functions: judged, recovered from maps, and turned into maps."""

import math

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from map_collection import (
    ELEMENTARY,
    MAPS,
    MOVING,
    NOTES,
    STEPS,
    E,
    k,
    m,
    p,
    px,
    py,
    q,
    qp,
    t,
    upper,
    w,
    x,
    y,
)
from sympy import acos, acot, asin, cos, cot, exp, pi, sin, sqrt, tan

from canon.mechanics.algebra.linear import is_regular
from canon.mechanics.canonical.find_generating_function import generating_function
from canon.mechanics.canonical.from_generating_function import (
    generated_hamiltonian,
    generated_inverse,
    generated_transformation,
    implicit_map,
    of_kind,
)
from canon.mechanics.canonical.generating_function import (
    GeneratingFunction,
    NoGeneratingFunctionError,
)
from canon.mechanics.canonical.inverse.inverse_transformation import NoClosedInverseError
from canon.mechanics.canonical.parametric_generating_function import ParametricGeneratingFunction
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

Q, P = sp.symbols("Q P", real=True)
oscillator = NOTES["oscillator"].map
roots = NOTES["square roots"].map
log1 = NOTES["log of 1 + sqrt(q) cos p"].map
root = sqrt(2 * m * w * P - m**2 * w**2 * qp**2)


def judged(kind, F, T, domain=None):
    return GeneratingFunction(kind, F, T.q, T.p, Q, P).generates(T, domain)


# (type, map, right, wrong, domain): the wrong ones are the lecture notes' printed answers where they err
ENTRIES = {
    "oscillator F1": (1, oscillator, m * w * qp**2 * cot(Q) / 2, m * w * qp**2 * cot(Q), None),
    "oscillator F2": (
        2,
        oscillator,
        qp * root / 2 + P * acot(root / (m * w * qp)),
        root + P * acot(root / (m * w * qp)),
        upper,
    ),
    "oscillator F2 without the half": (
        2,
        oscillator,
        qp * root / 2 + P * acot(root / (m * w * qp)),
        qp * root + P * acot(root / (m * w * qp)),
        upper,
    ),
    "oscillator F3": (3, oscillator, -(p**2) * tan(Q) / (2 * m * w), sp.S.Zero, None),
    "oscillator F4": (
        4,
        oscillator,
        P * acot(p / sqrt(2 * m * w * P - p**2)) - p * sqrt(2 * m * w * P - p**2) / (2 * m * w),
        P * acot(p / sqrt(2 * m * w * P - p**2)),
        upper,
    ),
    "log F3": (3, log1, -((exp(Q) - 1) ** 2) * tan(p), -tan(p) * (exp(Q) - 1), None),
    "log F3, line before last": (
        3,
        log1,
        -(((exp(Q) - 1) / cos(p)) ** 2) * sin(p) * cos(p),
        -(((exp(Q) - 1) / cos(p)) ** 2) * sin(p) * cos(p) / 2,
        None,
    ),
    "roots F1": (
        1,
        roots,
        acos(Q * sqrt(k) / sqrt(2 * qp)) * qp
        - qp * sin(acos(Q * sqrt(k) / sqrt(2 * qp))) * cos(acos(Q * sqrt(k) / sqrt(2 * qp))),
        acos(Q * sqrt(k) / sqrt(2 * qp)) * qp,
        None,
    ),
    "roots F2": (
        2,
        roots,
        qp * asin(P / sqrt(2 * k * qp)) + P * sqrt(2 * k * qp - P**2) / (2 * k),
        qp * asin(P / sqrt(2 * k * qp)),
        None,
    ),
    "roots F3": (3, roots, -(Q**2 * k / (2 * cos(p) ** 2)) * sin(p) * cos(p), Q**2 * k * tan(p) / 2, None),
    "roots F4": (4, roots, P**2 * cot(p) / (2 * k), -(P**2) * cot(p) / (2 * k), None),
}


@pytest.mark.parametrize("name", ENTRIES)
def test_entries_of_the_notes(name):
    kind, T, right, wrong, domain = ENTRIES[name]
    assert judged(kind, right, T, domain or T.domain).holds
    assert judged(kind, wrong, T, domain or T.domain).fails


@pytest.mark.parametrize("name", ENTRIES)
def test_entries_are_recovered(name):
    """The recovered function differs from the right one by a constant only: same rules on the map."""
    kind, T, right, _, domain = ENTRIES[name]
    found = generating_function(T, kind)
    assert isinstance(found, GeneratingFunction)
    F = GeneratingFunction(kind, right, T.q, T.p, Q, P)
    there = dict(zip((Q, P), T.images, strict=True))
    for ours, theirs in zip(found.rules, F.rules, strict=True):
        gap = (ours.value - theirs.value).xreplace(there)
        assert vanishes(gap, domain or found.domain).holds


def test_contact_function_of_the_notes():
    """F = pq is printed for the oscillator, where pq/2 is right; pq − q sin p cos p for the other two is right."""
    for T, right, wrong in (
        (oscillator, p * qp / 2, p * qp),
        (roots, p * qp - qp * sin(p) * cos(p), p * qp),
        (log1, p * qp - qp * sin(p) * cos(p), p * qp + qp * sin(p) * cos(p)),
    ):
        form = T.contact_form()
        assert all(
            vanishes(right.diff(z) - a, T.domain).holds for z, a in zip(T.variables, form, strict=True)
        )
        assert any(
            vanishes(wrong.diff(z) - a, T.domain).fails for z, a in zip(T.variables, form, strict=True)
        )


FORMS = [
    # map, printed M and N of M dq + N dp = p dq − P dQ, whether each is right
    (NOTES["action and minus angle"].map, p + q * sp.atan(q / p), p * sp.atan(q / p), (True, True)),
    (NOTES["log of sin p / q"].map, p + cot(p), cot(p) ** 2, (True, False)),
    (NOTES["log of sin p / q"].map, p + cot(p), -qp * cot(p) ** 2, (True, True)),
    (log1, p - sin(p) * cos(p), 2 * qp * sin(p) ** 2, (True, True)),
    (roots, p - sin(p) * cos(p), 2 * qp * sin(p) ** 2, (True, True)),
    (oscillator, p / 2, qp / 2, (True, True)),
]


@pytest.mark.parametrize(("T", "M", "N", "right"), FORMS)
def test_printed_contact_forms(T, M, N, right):
    for printed, coefficient, expected in zip((M, N), T.contact_form(), right, strict=True):
        assert vanishes(printed - coefficient, T.domain).holds == expected


def test_printed_inversions():
    there = dict(zip((Q, P), log1.images, strict=True))
    assert vanishes((((exp(Q) - 1) / cos(p)) ** 2).xreplace(there) - qp, log1.domain).holds
    there = dict(zip((Q, P), oscillator.images, strict=True))
    assert vanishes((sqrt(2 * m * w * P - p**2) / (m * w)).xreplace(there) - qp).holds
    assert vanishes((-sqrt(2 * m * w * P - p**2) / (m * w)).xreplace(there) - qp).fails


def test_feedback_shows_the_factor():
    assert (
        judged(1, m * w * qp**2 * cot(Q), oscillator).feedback
        == "on the map p = ∂F/∂q should be p, but is 2*p"
    )


CHECKED = {**NOTES, **ELEMENTARY, **MOVING, **STEPS}


@pytest.mark.parametrize("name", CHECKED)
def test_exactly_the_right_types_exist(name):
    case = CHECKED[name]
    T = case.map
    blocks = {1: (T.new_q, T.p), 2: (T.new_p, T.p), 3: (T.new_q, T.q), 4: (T.new_p, T.q)}
    for kind, (images, variables) in blocks.items():
        block = sp.Matrix([[f.diff(s) for s in variables] for f in images])
        assert is_regular(block, T.domain).holds == (kind in case.kinds)
        if kind not in case.kinds:
            with pytest.raises(
                NoGeneratingFunctionError, match=r"maps the direction \(1\) to zero"
            ) as caught:
                generating_function(T, kind)
            assert caught.value.verdict.fails


CLOSED = [
    ("identity", 2, lambda: q * P),
    ("exchange", 1, lambda: q * Q),
    ("exchange", 4, lambda: p * P),
    ("gauge", 2, lambda: q * P + q**4 / 4),
    ("exponential", 3, lambda: -p * sp.log(Q)),
    ("Galilean boost", 2, lambda: (q - sp.Symbol("b", real=True) * t) * (P + m * sp.Symbol("b", real=True))),
    (
        "moving scale",
        2,
        lambda: (q * P + m * q**2 * sp.Function("rho")(t).diff(t) / 2) / sp.Function("rho")(t),
    ),
    ("symplectic Euler step", 2, lambda: q * P + sp.Symbol("h", positive=True) * (P**2 / 2 - cos(q))),
]


@pytest.mark.parametrize(("name", "kind", "expected"), CLOSED)
def test_known_functions_are_recovered(name, kind, expected):
    found = generating_function(MAPS[name].map, kind)
    gap = found.F - expected()
    assert all(vanishes(gap.diff(s), found.domain).holds for s in (*found.old, *found.new))


def test_the_branch_is_stated():
    found = generating_function(oscillator, 2)
    assert found.domain.conditions == (p > 0,)
    assert found.generates(oscillator, Domain((p > 0,))).holds
    assert found.generates(oscillator, Domain((p < 0,))).fails


def test_a_map_that_is_not_canonical_has_none():
    with pytest.raises(NoGeneratingFunctionError, match=r"not canonical.*multiply P by 1/2"):
        generating_function(NOTES["oscillator"].twins[0], 1)


def test_mixed_types():
    """Exchange of one pair, identity in the other: no pure type exists, (1, 2) does."""
    T = MAPS["exchange of one"].map
    Q1, Q2, P1, P2 = sp.symbols("Q1 Q2 P1 P2", real=True)
    for kind in (1, 2, 3, 4):
        with pytest.raises(NoGeneratingFunctionError, match="maps the direction"):
            generating_function(T, kind)
    found = generating_function(T, (1, 2))
    assert vanishes(found.F - (x * Q1 + y * P2)).holds
    twin = GeneratingFunction((1, 2), x * Q1 - y * P2, (x, y), (px, py), (Q1, Q2), (P1, P2))
    assert twin.generates(T).fails


def test_what_cannot_be_inverted_is_parametric():
    T = CanonicalTransformation(q, p, q + p**5 + p, p)
    found = generating_function(T, 1)
    assert isinstance(found, ParametricGeneratingFunction)
    assert found.relations == ((Q, q + p**5 + p),)
    assert found.F is not None
    assert found.is_right().holds
    wrong = ParametricGeneratingFunction((1,), 2 * found.F, found.relations, T)
    assert wrong.is_right().fails


def test_parametric_functions_are_evaluated():
    T = CanonicalTransformation(q, p, q + p**5 + p, p)
    found = generating_function(T, 1)
    value = found.evaluate({q: 0.5, Q: 0.5 + 2.0**5 + 2.0}, {p: 1.5})
    assert value == pytest.approx(float(found.F.subs({q: 0.5, p: 2})), rel=1e-12)


def test_an_unknown_parametric_function_is_undecided():
    unknown = ParametricGeneratingFunction((1,), None, ((Q, p),), MAPS["exchange"].map)
    assert unknown.is_right().undecided
    with pytest.raises(ValueError, match="no formula"):
        unknown.evaluate({q: 0.5, Q: 1.0}, {p: 1.0})


def test_the_variables_of_a_function_are_all_different():
    for variables in (([q], [q], [Q], [P]), ([q], [p], [Q], [Q]), ([q], [p], [Q], [p])):
        with pytest.raises(ValueError, match="of 1 degree of freedom needs 4 different symbols"):
            GeneratingFunction(1, q * Q, *variables)
    with pytest.raises(ValueError, match="of 2 degrees of freedom needs 8 different symbols"):
        GeneratingFunction(1, q * Q, [q, x], [p, px], [Q], [P])


def test_from_f_to_the_map_and_back():
    P_ = sp.Symbol("P", positive=True)
    F1 = GeneratingFunction(1, m * w * qp**2 * cot(Q) / 2, qp, p, Q, P_)
    first = Domain((Q > 0, pi / 2 > Q))
    T = generated_transformation(F1, first)
    assert T.is_canonical().holds
    assert vanishes(T.new_p[0] - E, T.domain).holds
    back = generated_inverse(F1, first)
    assert vanishes(back.new_q[0] - sqrt(2 * P_ / (m * w)) * sin(Q), first).holds
    assert vanishes(back.new_q[0] + sqrt(2 * P_ / (m * w)) * sin(Q), first).fails
    K = generated_hamiltonian(F1, p**2 / (2 * m) + m * w**2 * qp**2 / 2, first)
    assert vanishes(K.H - w * P_, first).holds
    assert vanishes(K.q_dot[0] - w, first).holds
    assert vanishes(K.p_dot[0], first).holds


def test_the_inverse_map_serves_as_well():
    """The oscillator's F₁ on q(Q, P), p(Q, P)."""
    P_ = sp.Symbol("P", positive=True)
    back = CanonicalTransformation(Q, P_, sqrt(2 * P_ / (m * w)) * sin(Q), sqrt(2 * m * w * P_) * cos(Q))
    assert GeneratingFunction(1, m * w * q**2 * cot(Q) / 2, q, p, Q, P_).generates(back).holds
    assert GeneratingFunction(1, m * w * q**2 * cot(Q), q, p, Q, P_).generates(back).fails


def test_explicit_time_enters_the_new_hamiltonian():
    b = sp.Symbol("b", real=True)
    boost = GeneratingFunction(2, (q - b * t) * (P + m * b), q, p, Q, P)
    K = generated_hamiltonian(boost, p**2 / (2 * m))
    assert vanishes(K.H - (P**2 / (2 * m) - m * b**2 / 2)).holds


@pytest.mark.parametrize("kind", [2, 3, 4])
def test_legendre_relations_among_the_types(kind):
    """Of F₁ = −a(q − Q)²/2 − c q²: converting and converting back leaves the rules as they were."""
    a, c = sp.symbols("a c", positive=True)
    F1 = GeneratingFunction(1, -a * (q - Q) ** 2 / 2 - c * q**2, q, p, Q, P)
    other = of_kind(F1, kind)
    assert other.generates(generated_transformation(F1)).holds
    assert vanishes(of_kind(other, 1).F - F1.F).holds


def test_rules_without_a_formula_are_tested_and_evaluated():
    """F₂ = qP + h (P²/2 − cos q cos P): implicit in P, canonical all the same."""
    h = sp.Symbol("h", positive=True)
    T = implicit_map(GeneratingFunction(2, q * P + h * (P**2 / 2 - cos(q) * cos(P)), q, p, Q, P))
    assert T.is_canonical().holds
    assert T.is_canonical(valence=2).fails
    new = T.evaluate({q: 0.7, p: 0.3, h: 0.1}, {Q: 0.7, P: 0.3})
    assert new[P] + 0.1 * math.sin(0.7) * math.cos(new[P]) == pytest.approx(0.3, abs=1e-14)
    assert new[Q] == pytest.approx(0.7 + 0.1 * (new[P] + math.cos(0.7) * math.sin(new[P])), abs=1e-14)


small = st.integers(-2, 2)


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 3), small, small, small, small)
def test_generated_functions_come_back_from_their_maps(s, a, b, c, d):
    """F₂ = s qP + a q³ + b q² + c P² + d P sin t → map → F₂, up to a function of t."""
    F2 = GeneratingFunction(2, s * q * P + a * q**3 + b * q**2 + c * P**2 + d * P * sin(t), q, p, Q, P)
    T = generated_transformation(F2)
    assert T.is_canonical(by="contact").holds
    assert F2.generates(T).holds
    back = generating_function(T, 2)
    assert vanishes((back.F - F2.F).diff(q)).holds
    assert vanishes((back.F - F2.F).diff(P)).holds
    assert vanishes(generated_inverse(F2).then(T).new_q[0] - Q).holds


def test_arbitrary_functions_in_generating_functions():
    V = sp.Function("V")
    T = CanonicalTransformation(q, p, q, p - V(q).diff(q))
    assert vanishes(generating_function(T, 2).F - (q * P + V(q))).holds
    assert vanishes(generating_function(T, 3).F - (-p * Q + V(Q))).holds


def test_a_closed_form_is_proved_in_the_time_that_is_left(monkeypatch):
    left, generates = [], GeneratingFunction.generates

    def timed(F, T, domain, budget):
        left.append(budget)
        return generates(F, T, domain, budget)

    monkeypatch.setattr(GeneratingFunction, "generates", timed)
    assert isinstance(
        generating_function(CanonicalTransformation(q, p, p, -q), 1, budget=30.0), GeneratingFunction
    )
    assert left
    assert all(0.0 < seconds <= 30.0 for seconds in left)


def test_a_type_that_does_not_exist_is_refused():
    identity = GeneratingFunction(2, q * P, q, p, Q, P)
    with pytest.raises(NoClosedInverseError, match="could not be solved"):
        of_kind(identity, 1)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: GeneratingFunction(5, q, q, p, Q, P), "should be 1, 2, 3 or 4"),
        (lambda: GeneratingFunction(1, q * P, q, p, Q, P), "depends on P"),
        (lambda: GeneratingFunction(1, q, q, p, q, P), "different symbols"),
        (
            lambda: GeneratingFunction(1, q * Q, q, p, Q, P).generates(MAPS["rotating frame"].map),
            "use the same symbols",
        ),
        (lambda: generating_function(CanonicalTransformation(Q, p, Q, p), 2), "used in the map already"),
    ],
)
def test_refusals_say_what_is_wrong(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_without_time_for_the_proof_the_generating_function_stays_parametric():
    T = CanonicalTransformation(q, p, q + p, p)
    proved = generating_function(T, 1)
    assert proved.generates(T).holds
    assert vanishes(proved.F + (q - Q) ** 2 / 2).holds
    unproved = generating_function(T, 1, budget=0.0)
    assert isinstance(unproved, ParametricGeneratingFunction)
    assert vanishes(unproved.F - proved.F.subs(Q, q + p)).holds


def test_rules_are_left_open_without_time():
    exchange = CanonicalTransformation(q, p, p, -q)
    disguised = GeneratingFunction(1, q * Q * (sin(q) ** 2 + cos(q) ** 2), q, p, Q, P)
    assert disguised.generates(exchange).holds
    assert GeneratingFunction(1, 2 * disguised.F, q, p, Q, P).generates(exchange).fails
    assert disguised.generates(exchange, budget=0.0).undecided


def test_a_function_without_a_value_generates_nothing():
    """Its rules read Q = q, P = p: the logarithm of a hidden zero has the derivative zero."""
    hidden = GeneratingFunction(2, q * P + sp.log(sin(q) ** 2 + cos(q) ** 2 - 1), q, p, Q, P)
    assert [rule.value for rule in hidden.rules] == [P, q]
    assert "F has a value nowhere" in hidden.generates(CanonicalTransformation(q, p, q, p)).feedback
    for refused in (generated_transformation, generated_inverse, lambda F: of_kind(F, 3)):
        with pytest.raises(NoClosedInverseError, match="F has a value nowhere"):
            refused(hidden)
    unknown = GeneratingFunction(2, q * P + sp.log(sp.besselj(0, w)), q, p, Q, P)
    assert unknown.generates(CanonicalTransformation(q, p, q, p)).undecided
    plain = GeneratingFunction(2, q * P, q, p, Q, P)
    assert generated_transformation(plain).images == (q, p)
    assert vanishes(of_kind(plain, 3).F + p * Q).holds


def test_rules_that_were_solved_and_not_proved_are_told_with_what_was_found():
    """The remedy that is named gives the map then: conditions on the branch."""
    arc = GeneratingFunction(2, P * sqrt(1 - q**2), q, p, Q, P)
    with pytest.raises(
        NoClosedInverseError, match=r"F = .*not shown to generate the same map: on the map q = "
    ):
        of_kind(arc, 3)
    within = Domain((q > 0, q < 1))
    other = of_kind(arc, 3, within)
    assert vanishes((other.F + p * sqrt(1 - Q**2)).subs(sp.Abs(Q), Q)).holds
    norm = GeneratingFunction(2, sqrt(q**2 + P**2), q, p, Q, P)
    with pytest.raises(
        NoClosedInverseError, match=r"P = .*not shown to keep them: on the map p = ∂F/∂q should be p"
    ):
        generated_transformation(norm)
    assert generated_transformation(norm, Domain((q > 0, P > 0, p > 0, p < 1))).is_canonical().holds
    with pytest.raises(
        NoClosedInverseError, match=r"^the rules for p, Q could not be solved in closed form; give"
    ):
        of_kind(GeneratingFunction(2, q * P + q**3 * P**3, q, p, Q, P), 3)
