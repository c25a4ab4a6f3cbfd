"""|u|, sign(u), Max and pieces: no claim of any kind is wrong at a kink only, one that is wrong on a piece fails."""

import pytest
import sympy as sp

from canon import Hamiltonian, Lagrangian, coordinates, vanishes
from canon.exercise.claim_verdict import examine, judge
from canon.exercise.diagnose.right_answer import corrected
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import Claim
from canon.mechanics.algebra.linear import is_regular
from canon.mechanics.hamilton.symmetry import have_same_equations
from canon.proof.domain.domain import Domain
from canon.proof.kinks import off_kinks, vanishes_off_kinks

FALLING = {"q": "y", "parameters": {"m": "positive", "g": "positive"}, "L": "m*y_dot**2/2 - m*g*Abs(y)"}
WALL = {"q": ["x", "y"], "L": "(x_dot**2 + y_dot**2)/2 - Abs(y)", "multipliers": "lam"}
CYCLIC = {"q": ["x", "y"], "cyclic": "y", "momenta": "b", "convention": "L-pq"}
BODY = {"q": "x", "bodies": [{"m": "m", "r": ["Abs(x)"]}], "parameters": {"m": "positive"}}
PHASE = {"q": "q", "p": "p"}
NEW = {**PHASE, "new_q": "Q", "new_p": "P"}
ROPE = {
    "q": ["r", "th"],
    "parameters": {"m": "positive", "g": "positive", "a": "positive"},
    "L": "m*(r_dot**2 + r**2*th_dot**2)/2 - m*g*r*cos(th)",
    "contact": "r - a",
}
UP = "Piecewise((1, {0} > 0), (-1, True))"
"""What sign is off the kink, and at the kink is not."""


def up(u):
    return UP.format(u)


SMALL = {"small": "e", "parameters": {"e": "real"}}

CLAIMS = [
    ("euler-lagrange", FALLING | {"domain": ["y >= 0"]}, "claim", "y_ddot + g", "y_ddot - g"),
    ("euler-lagrange", FALLING, "claim", f"y_ddot + g*{up('y')}", "y_ddot + g"),
    ("euler-lagrange", {"q": "x", "L": "x_dot*Abs(x_dot)"}, "claim", "x_ddot", "x_ddot + x"),
    (
        "euler-lagrange",
        {"q": ["r", "f"], "L": "(r_dot**2 + r**2*f_dot**2)/2"},
        "claim",
        ["r_ddot - r*f_dot**2", "Abs(r)*f_ddot + 2*r_dot*f_dot*sign(r)"],
        ["r_ddot - r*f_dot**2", "Abs(r)*f_ddot + 2*r_dot*f_dot"],
    ),
    (
        "dissipative",
        {"q": "x", "L": "x_dot**2/2", "F": "Abs(x_dot)"},
        "claim",
        f"x_ddot + {up('x_dot')}",
        "x_ddot + Piecewise((1, x_dot > -1), (-1, True))",
    ),
    (
        "dissipative",
        {"q": "x", "L": "x_dot**2/2", "F": "Max(x_dot, 0)"},
        "energy_rate",
        "-Max(x_dot, 0)",
        "-x_dot",
    ),
    (
        "multiplier-holonomic",
        WALL | {"constraints": "x - y"},
        "claim",
        [f"2*x_ddot + {up('y')}"],
        ["2*x_ddot + 1"],
    ),
    (
        "nonholonomic",
        WALL | {"constraints": "x_dot - y_dot"},
        "claim",
        [f"2*x_ddot + {up('y')}"],
        [f"2*x_ddot - {up('y')}"],
    ),
    (
        "legendre-hamiltonian",
        {"q": "x", "p": "p", "L": "x_dot**2/2 + Abs(x_dot)"},
        "H",
        "(Abs(p) - 1)**2/2",
        "p**2/2",
    ),
    (
        "legendre-hamiltonian",
        {"q": "x", "p": "p", "L": "x_dot**2/2 + Abs(x_dot)"},
        "H",
        "Piecewise(((p - 1)**2/2, p > 1), ((p + 1)**2/2, True))",
        "Piecewise(((p - 1)**2/2, p > 3), ((p + 1)**2/2, True))",
    ),
    (
        "hamilton-equations",
        PHASE | {"H": "p**2/2 + Max(q, 0)", "q_dot": ["p"]},
        "p_dot",
        ["-Piecewise((1, q > 0), (0, True))"],
        ["-Piecewise((1, q > -1), (0, True))"],
    ),
    (
        "hamilton-equations",
        PHASE | {"H": "p + Abs(q)"},
        "solution",
        {"q": "t", "p": "-Abs(t)"},
        {"q": "t", "p": "-t"},
    ),
    ("routhian", CYCLIC | {"L": "(x_dot**2 + y_dot**2)/2 + Abs(y_dot)"}, "R",
     "x_dot**2/2 - (Abs(b) - 1)**2/2", "x_dot**2/2 - b**2/2"),
    ("routhian", CYCLIC | {"L": "(x_dot**2 + y_dot**2)/2 - Abs(x)"}, "claim",
     [f"x_ddot + {up('x')}"], ["x_ddot + 1"]),
    ("gibbs-appell", BODY, "S", "m*x_ddot**2/2", "m*x_ddot**2*sign(x)/2"),
    ("gibbs-appell", BODY | {"V": "Abs(x)"}, "claim", f"m*x_ddot + {up('x')}", "m*x_ddot + 1"),
    ("poisson-bracket", PHASE, "pairs",
     [{"f": "q*sign(q)", "g": "p", "value": up("q")}], [{"f": "q*sign(q)", "g": "p", "value": "-sign(q)"}]),
    ("lagrange-bracket", {"variables": ["a", "b"], "q": "Abs(a)", "p": "b"}, "pairs",
     [{"u": "a", "v": "b", "value": up("a")}], [{"u": "a", "v": "b", "value": "1"}]),
    ("lie-bracket", {"x": "x", "X": "1", "Y": "Abs(x)"}, "claim", up("x"), "1"),
    ("lie-bracket", {"x": "x", "X": "sign(x)", "Y": "x**2"}, "claim", "2*x*sign(x)", "-2*x*sign(x)"),
    ("canonicity", PHASE | {"Q": "q*sign(q)"}, "P", "p*sign(q)", "p"),
    ("canonicity", NEW, "implicit", ["Q - Abs(q)", f"P*{up('q')} - p"], ["Q - Abs(q)", "P - p"]),
    ("canonicity-time-dependent", PHASE | {"Q": "q*sign(t)"}, "P", f"p*{up('t')}", "p"),
    ("bilinear-covariant", {"x": ["x", "y"], "form": ["Abs(y)", "0"]}, "claim",
     f"{up('y')}*(delta_y*d_x - d_y*delta_x)", "delta_y*d_x - d_y*delta_x"),
    ("bilinear-covariant", PHASE | {"Q": "Abs(q)", "factor": "1"}, "P", f"p*{up('q')}", "p"),
    ("parameters", {"of": "constant-of-motion", "q": "x", "L": "x_dot**2/2 - Abs(x)", "I": "x_dot**2/2 + a*Abs(x)",
                    "parameters": {"a": "real"}, "find": "a"}, "values", [{"a": "1"}], [{"a": "2"}]),
    ("generating-F1", NEW | {"F": "Abs(q)*Q"}, "map",
     {"Q": f"p*{up('q')}", "P": "-Abs(q)"}, {"Q": "p", "P": "-Abs(q)"}),
    ("generating-F2", NEW | {"F": "Abs(q)*P"}, "map",
     {"Q": "Abs(q)", "P": f"p*{up('q')}"}, {"Q": "Abs(q)", "P": "p"}),
    ("generating-F3", NEW | {"F": "-Abs(p)*Q"}, "map",
     {"Q": f"q*{up('p')}", "P": "Abs(p)"}, {"Q": "q", "P": "Abs(p)"}),
    ("generating-F4", NEW | {"F": "Abs(p)*P"}, "map",
     {"Q": "Abs(p)", "P": f"-q*{up('p')}"}, {"Q": "Abs(p)", "P": "-q"}),
    (
        "transformed-hamiltonian-K",
        NEW | {"H": "p**2/2 + Abs(q)", "map": {"Q": "q + Abs(t)", "P": "p"}},
        "K",
        f"P**2/2 + Abs(Q - Abs(t)) + P*{up('t')}",
        "P**2/2 + Abs(Q - Abs(t)) + P",
    ),
    (
        "constant-of-motion",
        {**PHASE, "parameters": {"q": "positive"}, "H": "p**2*q**2/2", "domain": ["Ne(p, 0)"]},
        "I",
        "q*p*sign(p)",
        "q*sign(p)",
    ),
    ("constant-of-motion", PHASE | {"H": "p**2/2 + Abs(q)"}, "I", "p**2/2 + Max(q, -q)", "p**2/2 + Max(q, 0)"),
    ("lagrangian-equivalence", {"q": "x", "relation": "equations", "L1": "x_dot**2/2 - Abs(x)"}, "L2",
     "x_dot**2 - 2*Max(x, -x)", "x_dot**2 - 2*Max(x, 0)"),
    ("lagrangian-equivalence",
     {"q": "x", "relation": "gauge", "L1": "x_dot**2/2", "L2": f"x_dot**2/2 + x_dot*{up('x')}"}, "F",
     "Abs(x)", "x"),
    ("equality-only", {"parameters": {"x": "real"}, "lhs": "Derivative(Abs(x), x)"}, "rhs", up("x"), "1"),
    ("equality-only", {"parameters": {"x": "real"}, "lhs": "sign(x)**2"}, "rhs", "1", "sign(x)"),
    ("kinetic-energy", {**BODY, "q": "r", "bodies": [{"m": "m", "r": ["Abs(r)"]}]}, "T",
     "m*r_dot**2/2", "m*r_dot**2*Piecewise((1, r > 0), (2, True))/2"),
    ("generalized-force", {"q": "x", "V": "Abs(x)"}, "Q", f"-{up('x')}", "-1"),
    ("constraint-class", {"q": ["x", "y"], "constraints": ["y_dot - x_dot*sign(t)**2"]}, "class",
     ["scleronomic"], ["rheonomic"]),
    ("degrees-of-freedom", {"q": ["x", "y"], "constraints": ["y - Abs(x)"], "domain": ["x > 0"]}, "dof",
     "1", "2"),
    ("reaction", WALL | {"constraints": "x - y"}, "values", {"lam": f"-{up('y')}/2"}, {"lam": "-1/2"}),
    ("leaving-condition", ROPE, "leaves", "a*th_dot**2*sign(th)**2 - g*cos(th)", "a*th_dot**2*sign(th) - g*cos(th)"),
    ("conserved-or-not", PHASE | {"H": "p**2/2 + Abs(q)"}, "conserved",
     ["p**2/2 + Max(q, -q)"], ["p**2/2 + Max(q, 0)"]),
    ("conserved-or-not", PHASE | {"H": "p**2/2 + Abs(q)"}, "not_conserved",
     ["p**2/2 + Max(q, 0)"], ["p**2/2 + Max(q, -q)"]),
    ("solution", {"q": "x", "L": "x_dot**2/2 - Abs(x)", "domain": ["t >= 0", "t <= 2"]}, "solution",
     {"x": "t*(2 - t)/2"}, {"x": "t*(1 - t)/2"}),
    ("solution", {"q": "x", "equations": ["x_ddot - sign(x)"]}, "solution", {"x": "t**2/2"}, {"x": "t**2"}),
    ("linearisation", {"q": "x", "parameters": {"k": "real"}, "L": "x_dot**2/2 - k**2*x**2/2",
     "equilibrium": {"x": "0"}}, "claim", "x_ddot*sign(k)**2 + k**2*x", "x_ddot + k*Abs(k)*x"),
    ("first-order", {"exact": ["Abs(a)*exp(h)"], "small": "h", "parameters": {"a": "real", "h": "real"}}, "claim",
     [f"a*{up('a')}*(1 + h)"], ["a*(1 + h)"]),
    ("invariance", PHASE | {"of": "phase-volume", "P": "p"}, "Q", "Abs(q)", "Max(q, 0)"),
    ("invariance", PHASE | {"of": "hamilton-equations", "Q": "Abs(q)"}, "P", f"p*{up('q')}", "p"),
    ("jacobi-identity", {"x": ["x", "y", "z"], "pairs": [{"u": "x", "v": "y", "value": "Abs(z)"}]}, "casimirs",
     ["Abs(z)"], ["Abs(x)"]),
    ("positive-real", {"variables": "s", "is": ["positive-real"], "parameters": {"a": "real"}, "domain": ["a >= 0"]},
     "H", "1/(s + Abs(a))", f"{up('a - 1')}/(s + 1)"),
    ("number", {"value": "Abs(-2)"}, "claim", "Max(2, -2)", "Min(2, -2)"),
    ("variation", {"q": "x", "L": "x_dot**2/2 - Abs(x)", "boundary": "x_dot*delta_x"}, "integrand",
     f"-(x_ddot + {up('x')})*delta_x", "-(x_ddot + 1)*delta_x"),
    ("differential", {"x": "x", "f": "Abs(x)"}, "claim", f"{up('x')}*d_x", "d_x"),
    ("hamilton-jacobi", PHASE | {"H": "p**2/2 + Abs(q)", "constants": "E"}, "gradient",
     "sqrt(2*E - 2*Max(q, -q))", "sqrt(2*E - 2*q)"),
    ("separable", {"q": ["x", "y"], "p": ["a", "b"], "H": "a**2 + b**2 + Abs(x) + Abs(y)"}, "is",
     ["separable"], ["not separable"]),
    ("action-angle", PHASE | {"H": "p**2/2 + c**2*q**2/2", "parameters": {"c": "nonzero", "E": "positive"}}, "J",
     "E/Abs(c)", "E/c"),
    ("frequency", PHASE | {"H": "p**2/2 + c**2*q**2/2", "parameters": {"c": "nonzero"}}, "omega", "Abs(c)", "c"),
    ("lie-series", PHASE | SMALL | {"f": "Abs(q)", "W": "p"}, "claim", f"Abs(q) + e*{up('q')}", "Abs(q) + e"),
    ("normal-form", PHASE | {"H": "p**2/2 + q**2/2 + c*q**4", "parameters": {"c": "nonzero"}, "actions": "J",
                             "degree": 4}, "K", "J + 3*c*sign(c)**2*J**2/2", "J + 3*Abs(c)*J**2/2"),
    ("averaged-hamiltonian", PHASE | SMALL | {"H": "p + e*Abs(p)*cos(q)**2", "angles": "q"}, "K",
     "p + e*Max(p, -p)/2", "p + e*p/2"),
    ("generating-first-order", PHASE | SMALL | {"H": "p + e*Abs(p)*cos(q)"}, "W", "Abs(p)*sin(q)", "p*sin(q)"),
    ("adiabatic-invariant", PHASE | SMALL | {"H": "p + e*Abs(p)*cos(q)"}, "I",
     "p + e*Max(p, -p)*cos(q)", "p + e*p*cos(q)"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "keys", "key", "right", "wrong"), CLAIMS, ids=[f"{c[0]}-{c[3]}"[:50] for c in CLAIMS]
)
def test_beside_the_kink(kind, keys, key, right, wrong):
    assert examine(Claim("a", kind, {**keys, key: right})).verdict.holds
    finding = examine(Claim("a", kind, {**keys, key: wrong}))
    assert finding.verdict.fails
    assert "DiracDelta" not in corrected(finding) + finding.verdict.feedback


def test_every_kind_is_tried():
    assert {c[0] for c in CLAIMS} == set(KINDS)


def test_a_factor_that_vanishes_on_a_piece_is_no_equation():
    keys = {"q": ["r", "f"], "L": "(r_dot**2 + r**2*f_dot**2)/2"}
    claim = ["r_ddot - r*f_dot**2", "(Abs(r) + r)*(r*f_ddot + 2*r_dot*f_dot)"]
    assert not examine(Claim("a", "euler-lagrange", {**keys, "claim": claim})).verdict.holds


SPRING = {"q": "x", "L": "x_dot**2/2 - x**2/2"}
TWO = {"q": ["x", "y"], "L": "(x_dot**2 + y_dot**2)/2 - (x**2 + y**2)/2"}
SKATE = {
    "q": ["x", "y", "theta"],
    "quasi": ["u", "w"],
    "q_dot": ["u*cos(theta)", "u*sin(theta)", "w"],
    "bodies": [{"m": "m", "r": ["x", "y"], "I": "J", "angle": "theta"}],
    "V": "m*g*x*sin(alpha)",
    "parameters": {"m": "positive", "J": "positive", "g": "positive", "alpha": "real"},
}
SILENT = [
    ("euler-lagrange", SPRING, ["({f})*(x_ddot + x)"], "Abs(x - 100) + x - 100", "Abs(x - 100) + 1", "x > 100"),
    ("euler-lagrange", SPRING, ["({f})*(x_ddot + x)"],
     "Piecewise((0, x > 3), (1, True))", "Piecewise((2, x > 3), (1, True))", "x < 3"),
    ("euler-lagrange", TWO, ["x_ddot + x", "({f})*(y_ddot + y)"], "Max(y, 0)", "Max(y, 1)", "y > 0"),
    ("euler-lagrange", TWO, ["x_ddot + x", "({f})*(y_ddot + y)"], "1 + sign(x*y)", "2 + sign(x*y)", "x*y > 0"),
    ("dissipative", {**SPRING, "F": "x_dot**2/2"}, ["({f})*(x_ddot + x_dot + x)"],
     "x - Abs(x)", "x - 2*Abs(x)", "x < 0"),
    ("gibbs-appell", SKATE, ["u_dot = -g*sin(alpha)*cos(theta)", "w_dot*({f}) = 0"],
     "Max(u, 0)", "Max(u, 0) + 1", "u > 0"),
    ("routhian", CYCLIC | {"L": "(x_dot**2 + y_dot**2)/2 - x**2/2"}, ["({f})*(x_ddot + x)"],
     "Abs(b) - b", "Abs(b) + 1", "b < 0"),
]  # fmt: skip
"""Equations with a factor that is zero on a piece; one that is not; and where the first is not zero."""


@pytest.mark.parametrize(("kind", "keys", "claim", "silent", "loud", "domain"), SILENT)
def test_an_equation_that_says_nothing_on_a_piece_fails_there(kind, keys, claim, silent, loud, domain):
    def judged(factor, **more):
        return judge(Claim("a", kind, {**keys, "claim": [e.format(f=factor) for e in claim], **more}))

    verdict = judged(silent)
    assert verdict.fails
    assert verdict.counterexample is not None
    assert judged(loud).holds
    assert not judged(silent, domain=[domain]).fails
    assert judged(
        silent, domain=[domain.replace(">", "<") if ">" in domain else domain.replace("<", ">")]
    ).fails


def test_a_box_does_not_make_an_equation_say_something():
    for box in ({"x": [101, 200]}, {"x": [-3, 3]}):
        claim = {**SPRING, "claim": ["(Abs(x - 100) + x - 100)*(x_ddot + x)"], "box": box}
        assert judge(Claim("a", "euler-lagrange", claim)).fails


def test_a_single_place_where_an_equation_says_nothing_does_no_harm():
    for factor in ("sign(x)", "Abs(x)*Max(x, -x)", "x*Max(x, 1)"):
        claim = {**SPRING, "claim": [f"({factor})*(x_ddot + x)"]}
        assert judge(Claim("a", "euler-lagrange", claim)).holds, factor
        assert judge(Claim("a", "euler-lagrange", {**claim, "domain": ["x <= 1"]})).holds, factor
    at_one = {**SPRING, "claim": ["Piecewise((0, (x - 1)**2 <= 0), (1, True))*(x_ddot + x)"]}
    assert not judge(Claim("a", "euler-lagrange", at_one)).fails


def test_a_sign_alone_is_still_no_constant():
    keys = {"q": "q", "p": "p", "H": "p**2/2 + q**2/2", "domain": ["Ne(p, 0)"]}
    assert not examine(Claim("a", "constant-of-motion", {**keys, "I": "sign(p)"})).verdict.holds


def test_a_motion_that_jumps_is_no_solution_though_its_rate_is_right():
    keys = {**PHASE, "H": "p**2/2", "solution": {"q": "Abs(t)", "p": "sign(t)"}}
    assert not examine(Claim("a", "hamilton-equations", keys)).verdict.holds
    q, p = sp.symbols("q p", real=True)
    free = Hamiltonian(p**2 / 2, q, p)
    assert not free.is_solution({q: abs(free.t), p: sp.sign(free.t)}).holds
    assert free.is_solution({q: free.t, p: sp.Integer(1)}).holds


@pytest.mark.parametrize("sign", ["+", "-"])
def test_conditions_on_functions_in_equations_of_motion(sign):
    keys = {"q": "x", "functions": {"V": ["x"]}, "L": "V(x)*x_dot**2/2", "domain": ["V(x) > 0"]}
    claim = f"V(x)*x_ddot {sign} Derivative(V(x), x)*x_dot**2/2"
    verdict = examine(Claim("a", "euler-lagrange", {**keys, "claim": claim})).verdict
    assert (verdict.holds, verdict.fails) == (sign == "+", sign == "-")


x, y, k = sp.symbols("x y k", real=True)
n = sp.Symbol("n", integer=True)
FAT = [
    abs(sp.Max(x, 0)),
    abs(abs(x) + x),
    abs((x + 1) ** 2 - x**2 - 2 * x - 1),
    sp.sign(sp.Max(x, 0)),
    abs(sp.sqrt(x**2 - 2 * x + 1) - x + 1),
    sp.sign(sp.atan(sp.tan(x)) - x),
    sp.sign(sp.Piecewise((x, x > 1), (0, True))),
    sp.Max(abs(x), x, 0) + sp.Max(abs(x), x),
    abs(sp.acot(x) + sp.acot(y) - sp.acot(y) - sp.atan(1 / x)),
    sp.sign(sp.log(x**2) - 2 * sp.log(x)),
]
"""Functions whose argument vanishes on a whole piece: that is no kink."""


@pytest.mark.parametrize("f", FAT, ids=str)
def test_a_piece_where_an_argument_vanishes_is_not_left_out(f):
    there = off_kinks([f], Domain()).domain
    drawn = [{x: sp.Rational(a, 7), y: sp.Rational(3, 5)} for a in (-15, -10, -4, 3, 5, 9, 12, 31)]
    assert all(there.contains(point) for point in drawn)
    wrong = sp.Piecewise((1, x < sp.Rational(-1, 3)), (1, x > 3), (0, True))
    assert not vanishes_off_kinks(wrong * (1 + f), Domain()).holds


@pytest.mark.parametrize("condition", [sp.Eq(x, 0), sp.Eq(x, y), sp.And(x >= 0, x <= 0), x**2 <= 0])
def test_a_domain_is_not_emptied(condition):
    gap = x - y if condition == sp.Eq(x, y) else x
    domain = Domain((condition,))
    assert not vanishes_off_kinks(1 + sp.sign(gap), domain).holds
    assert not vanishes_off_kinks(sp.sign(gap) ** 2 - 1, domain).holds


def test_whole_numbers_have_no_kinks():
    assert vanishes_off_kinks(sp.sign(n) ** 2 - 1, Domain()).fails
    assert vanishes_off_kinks(sp.sign(x) ** 2 - 1, Domain()).holds
    assert not vanishes_off_kinks(sp.sign(n * x) ** 2 - 1, Domain()).holds


def test_the_library_leaves_out_kinks_where_it_differentiates_and_only_there():
    assert vanishes(sp.sign(x) ** 2 - 1).fails
    s = coordinates("s")
    moduli = Lagrangian(s.dot**2 / 2 - abs(s), [s])
    pieces = Lagrangian(s.dot**2 / 2 - sp.Piecewise((s, s > 0), (-s, True)), [s])
    half = Lagrangian(s.dot**2 / 2 - sp.Piecewise((s, s > 0), (0, True)), [s])
    assert have_same_equations(moduli, pieces).holds
    assert have_same_equations(moduli, half).fails
    q, p = sp.symbols("q p", real=True)
    kicked = Hamiltonian(p**2 / 2 + sp.Max(q, 0), q, p)
    assert kicked.has_equations([p], [-sp.Piecewise((1, q > 0), (0, True))]).holds
    assert kicked.has_equations([p], [-sp.Piecewise((1, q > -1), (0, True))]).fails
    at_an_instant = sp.Matrix([[sp.Piecewise((1, sp.Eq(x, 0)), (0, True))]])
    assert is_regular(at_an_instant).fails


@pytest.mark.parametrize("claim", ["Abs(x_ddot + x) = -1", "Abs(x_ddot + x) = 0"])
def test_a_modulus_of_accelerations_is_not_affine(claim):
    verdict = examine(
        Claim("a", "euler-lagrange", {"q": "x", "L": "(x_dot**2 - x**2)/2", "claim": claim})
    ).verdict
    assert verdict.fails
    assert verdict.feedback.startswith("equation 1 is not affine")


def test_an_equation_that_is_zero_in_disguise_defines_no_map():
    keys = {
        "q": "q",
        "p": "p",
        "new_q": "Q",
        "new_p": "P",
        "parameters": {"h": "positive"},
        "box": {"h": [0, 1]},
    }
    for first, right in (
        ("Q - q - h*(p + P)/2", True),
        ("sin(q + p) - sin(q)*cos(p) - cos(q)*sin(p)", False),
    ):
        verdict = examine(
            Claim("a", "canonicity", {**keys, "implicit": [first, "P - p + h*(q + Q)/2"]})
        ).verdict
        assert (verdict.holds, verdict.fails) == (right, not right)


OFF_A_POINT = [
    ("euler-lagrange", {"q": "x", "L": "x_dot**2/2 - x**2/2"}, "claim", "x_ddot + x", "x_ddot - x"),
    ("dissipative", {"q": "x", "L": "x_dot**2/2", "F": "x_dot**2/2"}, "claim", "x_ddot + x_dot", "x_ddot - x_dot"),
    ("lagrangian-equivalence", {"q": "x", "L1": "x_dot**2/2", "relation": "equations"}, "L2",
     "x_dot**2/2 + x*x_dot", "x_dot**2/2 + x**2"),
    ("first-order", {"exact": "1/(1 + eps*x)", "small": "eps"}, "claim", "1 - eps*x", "1 + eps*x"),
]  # fmt: skip
LEFT_OUT = (
    "Piecewise(({0}, Ne(x, 0)))",
    "Piecewise(({0}, Ne(x, 0)), (7, True))",
    "Piecewise((7, x == 0), ({0}, True))",
    "Piecewise(({0}, Ne(x**3 - x, 0)))",
)


@pytest.mark.parametrize(
    ("kind", "keys", "key", "right", "wrong"), OFF_A_POINT, ids=[o[0] for o in OFF_A_POINT]
)
def test_what_is_said_off_a_point_holds_as_it_does_everywhere(kind, keys, key, right, wrong):
    keys = {**keys, "parameters": {"x": "real", "eps": "real"} if kind == "first-order" else {}}
    for form in LEFT_OUT:
        assert judge(Claim("a", kind, {**keys, key: form.format(right)})).holds, form
        assert judge(Claim("a", kind, {**keys, key: form.format(wrong)})).fails, form
    for half in ("Piecewise(({0}, x > 0))", "Piecewise(({0}, x == 0))", "Piecewise(({0}, Max(x, 0) == 0))"):
        assert judge(Claim("a", kind, {**keys, key: half.format(right)})).fails, half
    spoilt = f"Piecewise(({right}, Ne(Max(x, 0), 0)), (7, True))"
    assert not judge(Claim("a", kind, {**keys, key: spoilt})).holds


SINGLE_PLACES = (
    "(x - 1)**2 <= 0",
    "x**2 <= 0",
    "Eq(x, 1)",
    "And(x >= 1, x <= 1)",
    "Or(Eq(x, 1), x**4 <= 0)",
    "And(x <= 0, x**2 <= 0)",
    "x**2 - 2*x + 1 <= 0",
    "sqrt((x - 1)**2) <= 0",
    "Abs(x - sqrt(2)) <= 0",
    "x**2 + y**2 <= 0",
)
PIECES = (
    "x < 1",
    "(x - 1)**2 <= 10**(-60)",
    "Max(x, 1) <= 1",
    "Or(Eq(x, 2), Max(x, 0) <= 0)",
    "x**2 - y**2 <= 0",
)


@pytest.mark.parametrize("condition", SINGLE_PLACES)
def test_an_equality_is_not_wrong_at_single_places_only(condition):
    plane = {"parameters": {"x": "real", "y": "real"}, "lhs": f"Piecewise((x + 1, {condition}), (x, True))"}
    assert judge(Claim("a", "equality-only", {**plane, "rhs": "x"})).holds
    assert judge(Claim("a", "equality-only", {**plane, "rhs": "x + 1"})).fails
    motion = {
        **PHASE,
        "H": "p**2/2",
        "q_dot": [f"p + {plane['lhs']} - x".replace("x", "q").replace("y", "p")],
    }
    assert judge(Claim("a", "hamilton-equations", {**motion, "p_dot": ["0"]})).holds


@pytest.mark.parametrize("condition", PIECES)
def test_an_equality_is_wrong_on_pieces(condition):
    plane = {"parameters": {"x": "real", "y": "real"}, "lhs": f"Piecewise((x + 1, {condition}), (x, True))"}
    verdict = judge(Claim("a", "equality-only", {**plane, "rhs": "x"}))
    assert verdict.fails
    assert verdict.counterexample is not None


@pytest.mark.parametrize(
    ("domain", "holds"), [([], True), (["x <= 1"], True), (["x == 0"], False), (["x >= 0", "x <= 0"], False)]
)
def test_a_domain_that_is_a_kink_is_meant(domain, holds):
    keys = {"parameters": {"x": "real"}, "domain": domain, "rhs": "1"}
    for lhs in ("sign(x**2)", "sign(x)**2", "Piecewise((0, x**2 <= 0), (1, True))"):
        verdict = judge(Claim("a", "equality-only", {**keys, "lhs": lhs}))
        assert verdict.holds == holds
        assert verdict.fails or holds or len(domain) > 1


def test_no_torus_at_a_kink_refutes_an_action():
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 + tan(q)**2 + tan(q)", "domain": ["-pi/2 < q", "q < pi/2"]}
    root, u = "sqrt(E + 1 + sqrt((E + 1)**2 + 1))", sp.Symbol("q", real=True)
    drawn = Domain((-sp.pi / 2 < u, u < sp.pi / 2)).points([u, sp.Symbol("p", real=True)], 12)
    places = ", ".join(f"Eq(q, {point[u]})" for point in drawn)
    claim = {
        **keys,
        "parameters": {"E": "positive"},
        "J": [f"{root} - sqrt(2) + Piecewise((1, Or({places})), (0, True))"],
    }
    assert judge(Claim("a", "action-angle", claim)).undecided


def test_motions_may_be_written_with_kinks_that_cancel():
    free = {"q": "x", "equations": ["x_ddot"]}
    for motion in ("t + Max(t, 0) - (t + Abs(t))/2", "t + t*sign(t) - Abs(t)", "Piecewise((t, Ne(t, 0)))"):
        assert judge(Claim("a", "solution", {**free, "solution": {"x": motion}})).holds, motion
    for motion in (
        "t + Max(t, 0) - t/2",
        "t + t*sign(t)",
        "Abs(t - 10**9)",
        "Max(cos(t), -cos(t))",
        "sqrt(1 - cos(t)**2)",
    ):
        assert not judge(Claim("a", "solution", {**free, "solution": {"x": motion}})).holds, motion
    folded = {"q": "x", "equations": ["x_ddot + x"]}
    for motion in (
        "Abs(cos(t))",
        "Max(cos(t), -cos(t))",
        "sqrt(1 - cos(t)**2)",
        "Piecewise((cos(t), cos(t) > 0), (0, True))",
    ):
        assert not judge(Claim("a", "solution", {**folded, "solution": {"x": motion}})).holds, motion
    assert judge(Claim("a", "solution", {**folded, "solution": {"x": "Max(cos(t), cos(t))"}})).holds


@pytest.mark.parametrize(
    ("H", "holds"), [("c*sqrt(m**2*c**2 + p**2)", True), ("-c*sqrt(m**2*c**2 + p**2)", False)]
)
def test_a_relativistic_lagrangian_is_meant_below_the_speed_of_light(H, holds):
    keys = {"q": ["x"], "p": ["p"], "L": "-m*c**2*sqrt(1 - x_dot**2/c**2)", "H": H}
    parameters = {"m": "positive", "c": "positive"}
    verdict = examine(Claim("a", "legendre-hamiltonian", {**keys, "parameters": parameters})).verdict
    assert verdict.holds == holds
    assert verdict.fails != holds


def test_a_kink_inside_moves_the_kink_outside_to_either_side_of_a_jump() -> None:
    assert set(off_kinks([abs(x + sp.sign(y))], Domain()).domain.conditions) == {
        sp.Ne(y, 0),
        sp.Ne(x + 1, 0),
        sp.Ne(x - 1, 0),
    }
    assert set(off_kinks([abs(x - sp.Heaviside(y))], Domain()).domain.conditions) == {
        sp.Ne(y, 0),
        sp.Ne(x, 0),
        sp.Ne(x - 1, 0),
    }
