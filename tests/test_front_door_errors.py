"""Wrong types and swapped arguments at the front door: the error says what was wrong and what to give instead."""

import pytest
import sympy as sp

import canon
from canon import (
    CanonicalTransformation,
    ConstrainedLagrangian,
    Domain,
    GeneratingFunction,
    GibbsAppell,
    Hamiltonian,
    Lagrangian,
    Particle,
    VectorField,
    coordinates,
    parameters,
)
from canon.exercise import Claim, Sheet
from canon.exercise.sheet.sheet import sheet_from
from canon.mechanics import ImplicitTransformation

q = coordinates("q")
p = q.momentum
x, y = sp.symbols("x y", real=True)
H = Hamiltonian(p**2 / 2 + q**2 / 2, [q], [p])
L = Lagrangian(q.dot**2 / 2 - q**2 / 2, [q])
T = CanonicalTransformation(q, p, p, -q)
X = VectorField([q], [q])

WRONG = [
    (lambda: canon.is_constant_of_motion(H, H.H), TypeError, "the function comes first, then the system"),
    (lambda: canon.is_constant_of_motion("q*p", H), TypeError, "not the text 'q.p'; make its symbols with"),
    (lambda: canon.is_constant_of_motion(H, H), TypeError, "not a Hamiltonian .*give its .H"),
    (lambda: canon.is_constant_of_motion(q, T), TypeError, "a Hamiltonian or a Lagrangian"),
    (lambda: canon.new_hamiltonian(H, T), TypeError, "the map comes first"),
    (lambda: canon.new_hamiltonian(T, "q"), TypeError, "H should be an expression"),
    (lambda: canon.new_hamiltonian(T, Hamiltonian(x**2, [x], [y])), ValueError, "same variables"),
    (lambda: Hamiltonian(L, [q], [p]), TypeError, "give its .L"),
    (lambda: Hamiltonian([q], [p], q), TypeError, "leave the brackets out"),
    (lambda: Hamiltonian(sp.Eq(q, p), [q], [p]), TypeError, "write lhs - rhs"),
    (lambda: Hamiltonian(sp.nan, [q], [p]), ValueError, "no finite quantity"),
    (lambda: Hamiltonian(q, "q", "p"), TypeError, "is no coordinate"),
    (lambda: Hamiltonian(q, [q], [p], "t"), TypeError, "the time should be a Symbol"),
    (lambda: Hamiltonian(q, [], []), ValueError, "no coordinates"),
    (lambda: Lagrangian(H, [q]), TypeError, "give its .H"),
    (lambda: Lagrangian([q], q.dot**2), TypeError, "is no coordinate"),
    (lambda: Lagrangian(q.dot**2, [q, q]), ValueError, "not all different"),
    (lambda: Lagrangian(q.dot**2, [q], None, Domain()), TypeError, "the time should be a Symbol"),
    (lambda: canon.hamiltonian(H), TypeError, "should be a Lagrangian"),
    (lambda: canon.hamiltonian(L, domain=q > 0), TypeError, r"write Domain\(\(q > 0,\)\)"),
    (lambda: canon.vanishes("x"), TypeError, "not the text 'x'"),
    (lambda: canon.vanishes(sp.Eq(x, y)), TypeError, "write lhs - rhs"),
    (lambda: canon.vanishes(0.1 * x), ValueError, "rounded number"),
    (lambda: canon.vanishes(x, x > 0), TypeError, r"write Domain\(\(x > 0,\)\)"),
    (lambda: canon.vanishes(x, 2.0), TypeError, "a domain is needed, not 2.0"),
    (lambda: canon.vanishes(x, budget="3"), TypeError, "a number of seconds"),
    (lambda: canon.vanishes(x, budget=float("nan")), ValueError, "not NaN"),
    (lambda: canon.equal(sp.Matrix([x]), x), TypeError, "an expression is needed"),
    (lambda: Domain(x > 0), TypeError, "should be a tuple"),
    (lambda: Domain(("x > 0",)), TypeError, "not 'x > 0'"),
    (lambda: Domain(box={"x": (0, 1)}), TypeError, "with the symbol x"),
    (lambda: Domain(box={x: 3}), TypeError, "pair"),
    (lambda: CanonicalTransformation("q", "p", "Q", "P"), TypeError, "q should be symbols"),
    (lambda: CanonicalTransformation(2 * q, p, q, p), TypeError, "q should be symbols"),
    (lambda: CanonicalTransformation(q, p, q, p, t=Domain()), TypeError, "the domain comes before it"),
    (lambda: T.is_canonical(valence=0), ValueError, "other than 0"),
    (lambda: T.is_canonical(valence=q), ValueError, "a constant"),
    (lambda: T.then(H), TypeError, "what follows should be a CanonicalTransformation"),
    (lambda: canon.poisson_bracket([q], [p], q, p), TypeError, "f should be an expression"),
    (lambda: canon.poisson_bracket("q", "p", [q], [p]), TypeError, "f should be an expression, not the text"),
    (lambda: canon.lagrange_bracket("q", p, [q], [p]), TypeError, "u should be symbols"),
    (lambda: canon.lie_bracket(X, X, [q]), TypeError, r"X.bracket\(Y\)"),
    (lambda: VectorField(q, 1), TypeError, "x should be symbols"),
    (lambda: canon.point_transformation([x, y], [p], [x]), ValueError, "as many of each"),
    (lambda: coordinates(["a", "b"]), TypeError, "one text"),
    (lambda: parameters("m", postive=True), ValueError, "is positive meant"),
    (lambda: parameters("m", positive="yes"), TypeError, "True or False"),
    (lambda: parameters("m", positive=True, negative=True), ValueError, "at once"),
    (lambda: canon.time_derivative("x", [q]), TypeError, "f should be an expression"),
    (lambda: canon.expression.parse_expression("x", {}), TypeError, "write Scope"),
    (lambda: canon.noether_charge(H, [1]), TypeError, "the system should be a Lagrangian"),
    (lambda: canon.noether_charge(L, 1), TypeError, "xi should be a list"),
    (lambda: canon.mechanics.is_gauge_equivalent(L, H), TypeError, "should be a Lagrangian"),
    (lambda: canon.routhian(H, [q]), TypeError, "should be a Lagrangian"),
    (lambda: canon.kinetic_energy([q], [q]), TypeError, r"write Particle\(m"),
    (lambda: GibbsAppell([3], [q]), TypeError, r"write Particle\(m"),
    (lambda: Particle([q], x), TypeError, "m should be an expression"),
    (lambda: ConstrainedLagrangian(q, [q]), TypeError, "the system should be a Lagrangian"),
    (lambda: canon.generating_function(H, 1), TypeError, "should be a CanonicalTransformation"),
    (lambda: canon.generating_function(T, "F1"), ValueError, "1, 2, 3 or 4"),
    (lambda: canon.generated_transformation(q * p), TypeError, "write GeneratingFunction"),
    (lambda: GeneratingFunction(2, "q*P", q, p, x, y), TypeError, "F should be an expression"),
    (lambda: canon.inverse_transformation(H, [x], [y]), TypeError, "should be a CanonicalTransformation"),
    (lambda: canon.inverse_transformation(T, [x], []), ValueError, "give one each"),
    (lambda: ImplicitTransformation(q, p, x, y, q), ValueError, "as many as variables"),
    (lambda: canon.equivalent_equations(x, y, [x]), TypeError, "into brackets"),
    (lambda: canon.equivalent_equations([sp.Eq(x, y)], [y], [x]), TypeError, "write lhs - rhs"),
    (lambda: canon.bilinear_covariant(["q"], [q]), TypeError, "not the text 'q'"),
    (lambda: canon.check(3), TypeError, "should be a Sheet"),
    (lambda: canon.check(Sheet("", ()), jobs=0), ValueError, "1 or more"),
    (lambda: canon.judge({"id": "a"}), TypeError, "should be a Claim"),
    (lambda: canon.judge(Claim("a", "equality-onyl", {})), canon.exercise.InvalidClaim, "is equality-only meant"),
    (lambda: canon.judge(Claim("a", "equality-only", {"lhs": "1"})), canon.exercise.InvalidClaim, "key rhs: missing"),
    (lambda: canon.read_sheet(3), TypeError, "path of the sheet"),
    (lambda: sheet_from(b'[[claim]]\nlhs = "$\\sin x$"', toml=True), canon.exercise.SheetError, "single quotes"),
]  # fmt: skip


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_the_error_says_what_to_do(number):
    run, kind, words = WRONG[number]
    with pytest.raises(kind, match=words):
        run()


def test_a_hamiltonian_is_as_good_as_its_function():
    assert canon.new_hamiltonian(T, H) == canon.new_hamiltonian(T, H.H)


def test_single_symbols_stand_for_lists_of_one():
    assert canon.poisson_bracket(q, p, q, p) == 1
    assert canon.time_derivative(q**2, q) == 2 * q * q.dot


@pytest.mark.parametrize(
    "spelt", [r"$2\theta$", r"$\beta$", r"$\frac12$", r"$\rho$", r"$\nu$", r"$x\times2$"]
)
def test_latex_that_lost_its_backslashes_is_refused(spelt):
    claim = '[[claim]]\nid = "a"\nkind = "equality-only"\nrhs = "1"\nlhs = '
    eaten = sheet_from(f'{claim}"{spelt}"'.encode(), toml=True)
    assert "single quotes" in str(eaten.errors[0])
    assert not sheet_from(f"{claim}'{spelt}'".encode(), toml=True).errors


EMPTY = [(x < 1, x > 2), (sp.Eq(x, 1), sp.Eq(x, 2)), (x < 0, x + y > 0, y < 0), (False,)]
NOT_EMPTY = [(x <= 1, x >= 1), (x < 2, x > 1), (sp.Eq(x, 1), sp.Eq(y, 2)), (x < 0, x + y > 0), (True,)]


@pytest.mark.parametrize("conditions", EMPTY)
def test_a_verdict_about_no_point_says_so(conditions):
    assert "no point" in canon.vanishes(x + 2 * y + 7, Domain(conditions)).assumed[0]


@pytest.mark.parametrize("conditions", NOT_EMPTY)
def test_a_verdict_about_some_points_does_not(conditions):
    assert canon.vanishes(x**2 + y**2 + 7, Domain(conditions)).fails
    assert not canon.vanishes(sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1, Domain(conditions)).assumed


@pytest.mark.parametrize(("domain", "said"), [(["x < 1", "x > 2"], "no point"), (["x < 2", "x > 1"], "")])
def test_a_claim_about_no_point_is_invalid(domain, said):
    keys = {"lhs": "x", "rhs": "x + 1", "parameters": {"x": "real"}, "domain": domain}
    claim = Claim("a", "equality-only", keys)
    if said:
        with pytest.raises(canon.exercise.InvalidClaim, match=said):
            canon.judge(claim)
    else:
        assert canon.judge(claim).fails


def test_what_is_nested_too_deeply_is_undecided():
    f = x
    for _ in range(3000):
        f = sp.sin(f, evaluate=False)
    verdict = canon.equal(f, sp.Integer(1), budget=5.0)
    assert verdict.undecided
    assert "deep" in verdict.evidence[0].text


def test_a_map_of_many_degrees_of_freedom_that_fails_is_told_within_its_budget(processor_seconds):
    q, p = sp.symbols("q0:8", real=True), sp.symbols("p0:8", real=True)
    Q = [a + sp.sin(sp.Add(*p)) for a in q]
    P = [b + a * q[0] for a, b in zip(q, p, strict=True)]
    used = processor_seconds()
    verdict = CanonicalTransformation(q, p, Q, P).is_canonical(budget=10.0)
    assert verdict.fails
    assert processor_seconds() - used < 10.0


def test_json_that_lost_its_backslashes_is_told_how_json_writes_them(tmp_path):
    sheet = tmp_path / "sheet.json"
    sheet.write_text(
        r'{"claims": [{"id": "a", "kind": "equality-only", "lhs": "$2\theta$", "rhs": "1"}]}', "utf-8"
    )
    (claim,) = canon.read_sheet(sheet).claims
    assert "write it twice" in str(claim.errors[0])
