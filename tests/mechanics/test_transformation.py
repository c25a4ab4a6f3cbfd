"""The five tests of canonicity on the collection of maps and their twins."""

import pytest
import sympy as sp
from map_collection import MAPS, MOVING, NOTES, E, linear_symplectic, m, p, px, py, q, qp, t, w, x, y

from canon.mechanics.algebra.constraint_manifold import on_manifold
from canon.mechanics.algebra.linear import SingularMatrixError
from canon.mechanics.canonical.canonicity_tests import disagreement
from canon.mechanics.canonical.find_generating_function import generating_function
from canon.mechanics.canonical.generating_function import NoGeneratingFunctionError
from canon.mechanics.canonical.implicit_transformation import ImplicitTransformation
from canon.mechanics.canonical.integrator_step import midpoint_step, runge_kutta_step, splitting_step
from canon.mechanics.canonical.inverse.inverse_transformation import (
    NoClosedInverseError,
    inverse_transformation,
)
from canon.mechanics.canonical.map_branches import near_the_identity
from canon.mechanics.canonical.new_hamiltonian import is_new_hamiltonian, new_hamiltonian
from canon.mechanics.canonical.repair_hint import constant_value, repair_hint
from canon.mechanics.canonical.transformation import CanonicalTransformation, point_transformation
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.hamilton.pfaffian_form import (
    bilinear_covariant,
    canonical_covariant,
    displacements,
    is_exact,
)
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Status, Verdict
from canon.proof.vanish import vanishes

Q, P = sp.symbols("Q P", real=True)
EXCHANGE = CanonicalTransformation(q, p, p, -q)
TESTS = ["poisson", "lagrange", "symplectic", "bilinear", "contact"]


@pytest.mark.parametrize("name", MAPS)
def test_canonical_maps_are_recognized(name):
    assert MAPS[name].map.is_canonical().holds


@pytest.mark.parametrize("name", MAPS)
def test_twins_are_refused(name):
    for twin in MAPS[name].twins:
        assert twin.is_canonical().fails


@pytest.mark.parametrize("test", TESTS)
@pytest.mark.parametrize("name", NOTES)
def test_every_test_agrees_on_the_maps_of_the_notes(name, test):
    assert NOTES[name].map.is_canonical(by=test).holds
    assert all(twin.is_canonical(by=test).fails for twin in NOTES[name].twins)


@pytest.mark.parametrize("name", MOVING)
def test_all_tests_together_on_moving_maps(name):
    verdict = MOVING[name].map.is_canonical(by="all")
    assert verdict.holds
    assert [e.kind for e in verdict.evidence] == [f"{test} test" for test in TESTS]
    assert MOVING[name].twins[0].is_canonical(by="all").fails


def test_the_linear_map_of_ten_degrees():
    case = linear_symplectic(10)
    assert case.map.is_canonical().holds
    assert case.twins[0].is_canonical().fails


def test_valence_is_found_and_told():
    T = CanonicalTransformation(q, p, 3 * q, p * m)
    assert T.is_canonical().fails
    assert T.is_canonical().feedback.startswith(
        "{Q, P} = 3*m, not 1: canonical with valence 3*m; multiply P by 1/(3*m)"
    )
    assert T.valence == 3 * m
    assert T.is_canonical(valence=3 * m).holds
    assert T.is_canonical(valence=3).fails
    assert T.is_canonical(valence=None).holds
    assert CanonicalTransformation(q, p, q**2, p).is_canonical(valence=None).fails
    assert CanonicalTransformation(q, p, q, q).is_canonical(valence=None).fails


@pytest.mark.parametrize(
    ("T", "words"),
    [
        (CanonicalTransformation(q, p, p, q), "exchange Q and P, or change the sign"),
        (CanonicalTransformation((x, y), (px, py), (x, y), (py, px)), "P1 = old P2, P2 = old P1"),
        (
            CanonicalTransformation((x, y), (px, py), (x, y), (px, 2 * py)),
            "{Q2, P2} = 2, not 1: multiply P2 by 1/2",
        ),
        (CanonicalTransformation(q, p, q * p, q * p), "Q and P depend on each other"),
        (NOTES["oscillator"].twins[0], "valence 2; multiply P by 1/2"),
    ],
)
def test_feedback_says_what_would_mend(T, words):
    verdict = T.is_canonical()
    assert verdict.fails
    assert words in verdict.feedback


def test_what_mends_a_map_is_a_value():
    found = repair_hint(CanonicalTransformation(q, p, 3 * q, p * m), sp.S.One)
    assert (found.valence, found.bracket, found.is_renumbering) == (3 * m, 3 * m, False)
    found = repair_hint(CanonicalTransformation(q, p, p, q), sp.S.One)
    assert (found.valence, found.bracket) == (None, -1)
    found = repair_hint(CanonicalTransformation((x, y), (px, py), (x, y), (py, px)), sp.S.One)
    assert (found.valence, found.partners, found.is_renumbering) == (None, (1, 0), True)
    found = repair_hint(CanonicalTransformation((x, y), (px, py), (x, y), (px, 2 * py)), sp.S.One)
    assert (found.valence, found.brackets) == (None, (1, 2))
    assert repair_hint(CanonicalTransformation(q, p, q**2, p), sp.S.One) is None


def test_what_mends_a_map_is_not_found_without_time():
    T = CanonicalTransformation((x, y), (px, py), (2 * x, y), (px, 3 * py))
    assert repair_hint(T, sp.S.One).brackets == (2, 3)
    assert repair_hint(T, sp.S.One, seconds=0.0) is None


def test_a_constant_bracket_is_said_as_a_short_number():
    """Where q = 0 is singular the constant comes from q = 1, as 2 sin² 1 + 2 cos² 1."""
    one = sp.sin(1 / q) ** 2 + sp.cos(1 / q) ** 2
    T = CanonicalTransformation(q, p, -sp.log(q), 2 * p * q * one)
    assert T.is_canonical().feedback.startswith(
        "{Q, P} = -2, not 1: canonical with valence -2; multiply P by -1/2"
    )
    assert CanonicalTransformation(q, p, T.new_q, [-T.new_p[0] / 2]).is_canonical().holds
    assert constant_value(3 * one, [q], Domain()) == 3
    assert constant_value(sp.sqrt(2) + one - one, [q], Domain()) == sp.sqrt(2)
    assert constant_value(3 * one - 6 * sp.cos(1 / q) ** 2, [q], Domain()) is None


def test_a_valence_that_time_does_not_allow_to_decide_is_left_open():
    T = CanonicalTransformation(q, p, q, p * (2 + sp.sin(q)))
    without_time = T.is_canonical(valence=None, budget=0.0)
    assert without_time.status is Status.UNDECIDED
    assert without_time.residual == T.poisson_brackets[0, 1]
    assert T.is_canonical(valence=None).feedback.endswith(
        "is not constant, so no valence makes the map canonical"
    )


def test_a_map_that_follows_is_meant_at_the_same_time():
    """Q + t, then Q exp s with its time called s: (q + t) exp t."""
    tau = sp.Symbol("s", real=True)
    drift = CanonicalTransformation(q, p, q + t, p, t=t)
    stretch = CanonicalTransformation(Q, P, Q * sp.exp(tau), P * sp.exp(-tau), t=tau)
    both = drift.then(stretch)
    assert both.images == ((q + t) * sp.exp(t), p * sp.exp(-t))
    assert both.t == t
    assert both.is_canonical().holds
    assert drift.then(CanonicalTransformation(Q, P, Q * tau, P, t=tau)).is_canonical().fails


@pytest.mark.parametrize(
    ("refused", "message"),
    [
        (lambda: bilinear_covariant([p], [q, p]), "1 coefficient for 2 variables; a form has one for each"),
        (
            lambda: is_new_hamiltonian(EXCHANGE, p**2, Q**2, [Q]),
            r"1 symbol for the 2 new variables; give \(\*Q, \*P\)",
        ),
        (
            lambda: ImplicitTransformation((q,), (p,), (Q,), (Q,), (Q - q, P - p)),
            "old and new variables need different symbols, as many of each",
        ),
        (
            lambda: Hamiltonian(p**2 / 2, q, p).has_equations([p], []),
            "1 rate given for 2 canonical variables; give one each",
        ),
    ],
)
def test_as_many_are_asked_for_as_there_are_variables(refused, message):
    with pytest.raises(ValueError, match=message):
        refused()


def test_a_hamiltonian_without_a_value_is_no_new_hamiltonian():
    """Of the logarithm of a hidden zero all derivatives are zero."""
    hidden = sp.log(sp.sin(Q) ** 2 + sp.cos(Q) ** 2 - 1)
    assert is_new_hamiltonian(EXCHANGE, p**2 + w * q, Q**2 - w * P, [Q, P]).holds
    refused = is_new_hamiltonian(EXCHANGE, p**2 + w * q, Q**2 - w * P + hidden, [Q, P])
    assert refused.fails
    assert refused.feedback.startswith("K has a value nowhere")
    unknown = is_new_hamiltonian(EXCHANGE, p**2 + w * q, Q**2 - w * P + sp.log(sp.besselj(0, w)), [Q, P])
    assert unknown.status is Status.UNDECIDED
    assert unknown.evidence[0].text.startswith("it was not shown that K has a value anywhere")


def test_an_implicit_map_that_can_not_be_solved_is_left_open():
    """sinh Q = sinh q is the identity, but says so of no set of variables in which it is linear."""
    alike = ImplicitTransformation((q,), (p,), (Q,), (P,), (sp.sinh(Q) - sp.sinh(q), sp.sinh(P) - sp.sinh(p)))
    verdict = alike.is_canonical()
    assert verdict.status is Status.UNDECIDED
    assert verdict.feedback == "the equations could not be solved for a set of variables that would decide it"
    half = ImplicitTransformation((q,), (p,), (Q,), (P,), (Q - q, sp.sinh(P) - sp.sinh(p)))
    assert half.is_canonical().status is Status.UNDECIDED
    assert ImplicitTransformation((q,), (p,), (Q,), (P,), (Q - q, P - p)).is_canonical().holds


def test_the_identity_is_looked_for_at_steps_that_are_zero_and_at_no_variable():
    """Q = q + h P, P² = p²: of P = ±p one is near the identity, whatever range the variables have."""
    h = sp.Symbol("h", real=True)
    equations = [Q - q - h * P, P**2 - p**2]
    for box in ({h: (0, 1)}, {q: (0, 1), h: (0, 1)}, {q: (0, 1), p: (1, 2), Q: (0, 1), h: (0, 1)}):
        domain = Domain((), box)
        branches = on_manifold(equations, domain, prefer=(Q, P, q, p))
        (near,) = near_the_identity(equations, branches, (q, p), (Q, P), domain)
        assert vanishes((P - p).subs(near.values)).holds
    assert near_the_identity(equations, branches, (q, p), (Q, P), Domain((), {q: (0, 1)})) is None


def test_composition_and_inversion():
    oscillator = CanonicalTransformation(qp, p, NOTES["oscillator"].map.new_q, E, domain=Domain((p > 0,)))
    back = inverse_transformation(oscillator, [Q], [P])
    assert vanishes(
        back.new_q[0] - sp.sqrt(2 * P / (m * w)) * sp.sin(Q), Domain((P > 0, Q > 0, sp.pi / 2 > Q))
    ).holds
    both = oscillator.then(back)
    assert vanishes(both.new_q[0] - qp, oscillator.domain).holds
    assert vanishes(both.new_p[0] - p, oscillator.domain).holds
    with pytest.raises(ValueError, match="a map of 1 degree of freedom cannot precede"):
        oscillator.then(point_transformation((x, y), (px, py), (x + y, y)))


def test_composed_leapfrog_steps_stay_canonical():
    step = MAPS["leapfrog step"].map
    assert step.then(step).is_canonical().holds
    assert step.then(MAPS["leapfrog step"].twins[0]).is_canonical().fails


def test_an_inverse_that_is_no_formula_is_refused():
    with pytest.raises(NoClosedInverseError, match="narrow the domain"):
        inverse_transformation(CanonicalTransformation(q, p, q**5 + q, p / (5 * q**4 + 1)), [Q], [P])


def test_dependent_new_coordinates_are_refused_with_their_direction():
    with pytest.raises(SingularMatrixError) as caught:
        point_transformation((x, y), (px, py), (x + y, (x + y) ** 2))
    assert len(caught.value.null_direction) == 2
    with pytest.raises(ValueError, match="q and t only"):
        point_transformation(q, p, q * p)


h = sp.Symbol("h", positive=True)
half, third, sixth = sp.Rational(1, 2), sp.Rational(1, 3), sp.Rational(1, 6)
RK4 = ([[], [half], [0, half], [0, 0, 1]], [sixth, third, third, sixth])


def test_a_runge_kutta_step_is_not_canonical():
    """det M of RK4 on the oscillator is 1 − h⁶/72 + h⁸/576."""
    step = runge_kutta_step(Hamiltonian(p**2 / 2 + q**2 / 2, q, p), h, *RK4)
    assert step.is_canonical().fails
    assert vanishes(step.poisson_brackets[0, 1] - (1 - h**6 / 72 + h**8 / 576)).holds
    euler = runge_kutta_step(Hamiltonian(p**2 / 2 - sp.cos(q), q, p), h, [[]], [1])
    assert euler.is_canonical().fails


def test_splitting_steps_are_canonical():
    kepler = Hamiltonian((px**2 + py**2) / 2 - 1 / sp.sqrt(x**2 + y**2), (x, y), (px, py))
    assert splitting_step(kepler, h, [half], [1]).is_canonical().holds
    general = Hamiltonian(p**2 / 2 + sp.Function("V")(q), q, p)
    assert splitting_step(general, h, [third, 1 - third], [half, half]).is_canonical().holds
    with pytest.raises(ValueError, match="no drifts and kicks"):
        splitting_step(Hamiltonian(p**2 * q, q, p), h, [1], [1])
    with pytest.raises(ValueError, match="do not alternate"):
        splitting_step(general, h, [1], [1, 1])
    with pytest.raises(ValueError, match="row 2 of an explicit tableau"):
        runge_kutta_step(general, h, [[], []], [1])
    with pytest.raises(ValueError, match=r"row 1 of an explicit tableau needs 0 coefficients.*it is \[1/2\]"):
        runge_kutta_step(general, h, [[sp.Rational(1, 2)]], [1])
    square = runge_kutta_step(general, h, [[0, 0], [1, 0]], [sp.Rational(1, 2)] * 2)
    assert square == runge_kutta_step(general, h, [[], [1]], [sp.Rational(1, 2)] * 2)


def test_midpoint_steps_are_canonical():
    for H in (p**2 * sp.sin(q) / 2 + q * p, sp.exp(p * q), sp.Function("T")(p) + sp.Function("V")(q)):
        assert midpoint_step(Hamiltonian(H, q, p), h, [Q], [P]).is_canonical().holds


def implicit(equations):
    return ImplicitTransformation((q,), (p,), (Q,), (P,), tuple(equations))


def test_implicit_steps():
    f = sp.sin
    assert implicit([Q - q - h * (p + P) / 2, P - p + h * f((q + Q) / 2)]).is_canonical().holds
    assert implicit([Q - q - h * (p + P) / 2, P - p + h * (f(q) + f(Q)) / 2]).is_canonical().fails
    # symplectic Euler in its implicit form, and the backward Euler rule
    assert implicit([Q - q - h * P, P - p + h * f(q)]).is_canonical().holds
    assert implicit([Q - q - h * P, P - p + h * f(Q)]).is_canonical().fails


def test_an_implicit_map_has_an_equation_for_each_variable():
    old, new = sp.symbols("q:3 p:3", real=True), sp.symbols("Q:3 P:3", real=True)
    still = [b - a for a, b in zip(old, new, strict=True)]
    assert ImplicitTransformation(old[:3], old[3:], new[:3], new[3:], still).is_canonical().holds
    for equations in (still[:5], [*still, old[0], old[1]]):
        with pytest.raises(ValueError, match="equations for a map of 6 variables"):
            ImplicitTransformation(old[:3], old[3:], new[:3], new[3:], equations)


def test_new_hamiltonians_of_moving_maps():
    H = p**2 / (2 * m)
    boost = MOVING["Galilean boost"].map
    b = sp.Symbol("b", real=True)
    K = P**2 / (2 * m)
    assert is_new_hamiltonian(boost, H, K, [Q, P]).holds
    assert is_new_hamiltonian(boost, H, K + b * P, [Q, P]).fails
    motion = MOVING["oscillator's motion"].map
    assert is_new_hamiltonian(motion, -(H + m * w**2 * q**2 / 2), sp.S.Zero, [Q, P]).holds
    assert is_new_hamiltonian(motion, H + m * w**2 * q**2 / 2, sp.S.Zero, [Q, P]).fails


def test_new_hamiltonian_of_the_moving_scale_without_its_generating_function():
    """The damped-scale map with an arbitrary ρ(t) turns p²/2m + m w² q²/2 into a K whose equations agree."""
    T = MOVING["moving scale"].map
    H = p**2 / (2 * m)
    K = new_hamiltonian(T, H)
    assert K is not None
    rho = sp.Function("rho")(t)
    # second route: dQ/dt along H must be ∂K/∂P, with ∂/∂P = (1/ρ) ∂/∂p at fixed Q
    along = T.new_q[0].diff(q) * H.diff(p) + T.new_q[0].diff(t)
    assert vanishes(along - K.diff(p) / rho).holds


def test_the_inverse_map_serves_as_well():
    """K(Q, P) = ω P for the oscillator, with the map given as q(Q, P), p(Q, P)."""
    P_ = sp.Symbol("P", positive=True)
    back = CanonicalTransformation(
        Q, P_, sp.sqrt(2 * P_ / (m * w)) * sp.sin(Q), sp.sqrt(2 * m * w * P_) * sp.cos(Q)
    )
    H = p**2 / (2 * m) + m * w**2 * q**2 / 2
    assert is_new_hamiltonian(back, w * P_, H, [q, p]).holds
    assert is_new_hamiltonian(back, w * P_ / 2, H, [q, p]).fails


def test_action_and_angle_on_the_whole_plane():
    """The angle by atan2 and by acot, for either sign of q and p."""
    action = (p**2 + m**2 * w**2 * q**2) / (2 * m * w)
    for angle in (sp.atan2(m * w * q, p), sp.acot(p / (m * w * q)), sp.atan(m * w * q / p)):
        assert CanonicalTransformation(q, p, angle, action).is_canonical().holds
        assert CanonicalTransformation(q, p, -angle, action).is_canonical().fails


def test_rotation_of_the_axes():
    angle = sp.Symbol("alpha", real=True)
    c, s = sp.cos(angle), sp.sin(angle)
    T = point_transformation((x, y), (px, py), (c * x + s * y, -s * x + c * y))
    assert vanishes(T.new_p[0] - (c * px + s * py)).holds
    assert T.is_canonical().holds
    mirrored = CanonicalTransformation((x, y), (px, py), T.new_q, (c * px - s * py, s * px + c * py))
    assert mirrored.is_canonical().fails


def test_a_disagreement_would_be_reported():
    verdict = disagreement({"poisson": Verdict(Status.HOLDS), "contact": Verdict(Status.FAILS)})
    assert verdict.undecided
    assert "tests disagree" in verdict.feedback
    assert disagreement({"a": Verdict(Status.HOLDS), "b": Verdict(Status.UNDECIDED)}).holds


def test_the_contact_test_finds_its_function():
    verdict = NOTES["oscillator"].map.is_canonical(by="contact")
    assert [e.text for e in verdict.evidence if e.kind.startswith("F with")] == ["p*q/2"]
    doubled = CanonicalTransformation(q, p, 2 * q, p)
    assert doubled.is_canonical(by="contact").fails
    assert doubled.is_canonical(by="contact", valence=2).holds


def test_bilinear_covariants():
    (dq, dp), (ddq, ddp) = displacements((q, p))
    assert vanishes(bilinear_covariant([p, 0], [q, p]) - (ddp * dq - dp * ddq)).holds
    assert vanishes(bilinear_covariant([p, 0], [q, p]) - (dp * ddq - ddp * dq)).fails
    T = NOTES["square roots"].map
    difference = canonical_covariant(T.new_q, T.new_p, (qp, p)) - canonical_covariant([qp], [p], (qp, p))
    assert vanishes(difference, T.domain).holds
    assert is_exact(T.contact_form(), (qp, p), T.domain).holds
    assert is_exact(NOTES["square roots"].twins[0].contact_form(), (qp, p), T.domain).fails


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: CanonicalTransformation((x, y), (px,), (x, y), (px, py)), "2 q, 1 p"),
        (lambda: CanonicalTransformation(q, q, q, p), "not all different"),
        (lambda: CanonicalTransformation(q, p, q, p).is_canonical(by="determinant"), "no test is called"),
    ],
)
def test_refusals_say_what_is_wrong(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_an_inverse_takes_no_name_of_the_map():
    """q → p, p → −q has the inverse q = −P, p = Q; in the old names that would be the map once more."""
    exchange = CanonicalTransformation([q], [p], [p], [-q])
    assert inverse_transformation(exchange, [Q], [P]).images == (-P, Q)
    for new_q, new_p in ((q, p), (p, q), (Q, p), (q, P), (p, P), (Q, q), (Q, Q)):
        with pytest.raises(ValueError, match="different symbols, none of them an old variable"):
            inverse_transformation(exchange, [new_q], [new_p])


def test_maps_with_arbitrary_functions_have_their_valence_or_none():
    """{Q, P} = f′² is no constant, whatever simple points say; 2 f′/f′ is one."""
    f = sp.Function("f")
    q, p, a = sp.symbols("q p a", real=True)
    slope = f(q).diff(q)
    stretched = CanonicalTransformation([q], [p], [f(q)], [p * slope])
    assert stretched.valence is None
    assert stretched.is_canonical().fails
    with pytest.raises(NoGeneratingFunctionError, match="not canonical"):
        generating_function(stretched, 2)
    twice = CanonicalTransformation([q], [p], [a * f(q)], [2 * p / slope])
    assert twice.valence == 2 * a
    assert CanonicalTransformation([q], [p], [f(q)], [p / slope]).is_canonical().holds
    point = CanonicalTransformation([q], [p], [f(q)], [p / slope])
    assert vanishes(generating_function(point, 2).F - f(q) * sp.Symbol("P", real=True)).holds


def test_a_constant_behind_an_arbitrary_function_is_found():
    f, x, t = sp.Function("f"), sp.Symbol("x", real=True), sp.Symbol("t", real=True)
    slope = f(x).diff(x)
    hidden = (1 + slope) ** 2 - slope**2 - 2 * slope
    assert constant_value(hidden, [x], Domain(), t=t) == 1
    assert constant_value(hidden + slope, [x], Domain(), t=t) is None


def test_the_momenta_of_a_turn_have_no_poles_that_the_turn_has_not():
    """Elimination divides by cos(w t): a motion in the turning frame would end at a quarter of a turn."""
    t, w = sp.symbols("t omega", real=True)
    turned = [x * sp.cos(w * t) + y * sp.sin(w * t), y * sp.cos(w * t) - x * sp.sin(w * t)]
    frame = point_transformation([x, y], [px, py], turned, t=t)
    assert frame.new_p == (px * sp.cos(w * t) + py * sp.sin(w * t), -px * sp.sin(w * t) + py * sp.cos(w * t))
    assert frame.is_canonical().holds
    wrong = CanonicalTransformation([x, y], [px, py], turned, [frame.new_p[0], -frame.new_p[1]], t=t)
    assert wrong.is_canonical().fails
    polar = point_transformation([x, y], [px, py], [sp.sqrt(x**2 + y**2), sp.atan2(y, x)])
    assert vanishes(polar.new_p[1] - (x * py - y * px)).holds
    assert vanishes(polar.new_p[1] - (x * py + y * px)).fails
