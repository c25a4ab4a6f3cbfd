"""The seed sheets: every claim judged, every verdict confirmed by a second route that shares no code with canon.

The second route reads the claims with SymPy alone, puts one concrete function in the place of each arbitrary
one, forms the definition of the kind (Lagrange's equations, brackets, rules of a generating function, …) and
evaluates both sides at random points with 40 digits. Motions under constraints are found there by
Gauss-Newton steps and a linear solve for accelerations and multipliers.
"""

import functools
import itertools
import random
import re
import tomllib
from pathlib import Path

import mpmath as mp
import pytest
import sympy as sp

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim, read_sheet

ROOT = Path(__file__).parents[1]
SHEETS = sorted((ROOT / "examples" / "sheets" / "seeds").glob("*.toml"))
CLAIMS = {c["id"]: c for path in SHEETS for c in tomllib.loads(path.read_text("utf-8"))["claim"]}
ENTRIES = tomllib.loads((ROOT / "docs" / "seeds" / "entries.toml").read_text("utf-8"))["entry"]
SLOW = {
    "piston-multiplier-eoms",
    "dalembert-principle-000.virtual",
    "dalembert-principle-000.power",
    "dalembert-principle-003.principle",
    "lagrange-particle-I-II",
    "newton-euler-equations.Tx",
    "newton-euler-equations.Ty",
    "newton-euler-equations.Tz",
}

# Each of these answers is wrong as printed (or as read); the second route below refutes every one of them.
FAILS = frozenset(
    {
        "piston-ks",
        "bead-parabola-kinetic.T",
        "bead-parabola-kinetic.c",
        "rod-double-pendulum-T-middle",
        "rod-double-pendulum-eom1",
        "rod-double-pendulum-eom2",
        "metric-polar-Aq.Aq12",
        "bead-parabola-lagrangian.L",
        "bead-parabola-lagrangian.p",
        "bead-parabola-lagrangian.pdot",
        "bead-parabola-lagrangian.L_zeta",
        "bead-parabola-eom",
        "cylindrical-p-phi",
        "cylindrical-eom-phi-middle",
        "incline-roller-Lprime",
        "hemisphere-eom-r",
        "hemisphere-lambda",
        "gyro-pendulum-angular-velocity.w_bc",
        "block-in-pipe-generalized-forces.Q_theta",
        "block-in-pipe-generalized-forces.Q_y",
        "block-in-pipe-y",
        "cart-pendulum-kinematics-lagrange",
        "cart-pendulum-T1.T1",
        "cart-pendulum-partials.p_x",
        "cart-pendulum-partials.p_theta",
        "cart-pendulum-x-lagrange",
        "cart-pendulum-theta-lagrange",
        "cart-pendulum-acceleration-ne",
        "pendulum-first-kind-T.T",
        "pendulum-first-kind-T.L",
        "pendulum-first-kind-lambda.eq_r",
        "pendulum-first-kind-lambda.eq_r-read-as",
        "pendulum-first-kind-lambda.lam1",
        "pendulum-first-kind-lambda.lam1-read-as",
        "double-pendulum-L-003.V",
        "double-pendulum-L-003.L",
        "spherical-zdot",
        "routh-2dof-momentum.P1",
        "routh-2dof-solution",
        "routh-2dof-aux-ode.D",
        "routh-2dof-q1",
        "routh-cylindrical-lagrange-theta",
        "routh-cylindrical-lagrange-z",
        "routh-cylindrical-R",
        "routh-cylindrical-eom-r",
        "routh-cylindrical-eom-r-read-as",
        "routh-cylindrical-eom-z",
        "routh-spherical-R",
        "routh-spherical-eom-theta-1",
        "routh-spherical-eom-theta",
        "hamilton-projectile-equations.p1",
        "hamilton-projectile-equations.p2",
        "hamilton-from-hamilton-principle",
        "routh-double-pendulum-V.V",
        "routh-double-pendulum-V.L",
        "routh-double-pendulum-theta-middle.eq_first",
        "routh-double-pendulum-theta-middle.eq_third",
        "routh-double-pendulum-theta",
        "routh-double-pendulum-phi",
        "routh-double-pendulum-phi-read-as",
        "hamilton-invariance-canonical-P",
        "lagrange-bracket-i",
        "em-quiz-L",
        "em-quiz-x",
        "em-quiz-y",
        "em-quiz-Pdot-middle",
        "bilinear-covariant",
        "jacobi-poisson-proof",
        "poisson-form-line1",
        "logsin-MN.N",
        "ho-F",
        "ho-F1",
        "ho-F2",
        "ho-F2-read-as",
        "ho-F3",
        "ho-F4",
        "ho-hamilton-via-F2",
        "log1-statement",
        "log1-F3-middle",
        "sqrt2q-F2.F2",
        "sqrt2q-F2.p",
        "sqrt2q-F4.F4",
        "gibbs-function",
        "gibbs-equation-conservative",
        "gibbs-equation-conservative-read-as",
        "mass-spring",
        "piston-inertia-first-order",
        "routh-spherical-small",
        "routh-spherical-small-read-as",
        "nonholonomic-examples-003.c1",
        "nonholonomic-examples-003.c2",
        "nonholonomic-examples-003.c1-read-as",
        "nonholonomic-examples-003.c2-read-as",
        "first-kind-constraint-force",
        "simple-pendulum-small-box",
        "axis-translation-label",
        "pr-theorem-residue",
        "types-of-forces",
        "dalembert-004.dof",
        "dalembert-004.work",
        "dalembert-004.forces",
        "generalised-force-power-004",
    }
)


def entry_of(claim_id):
    return claim_id.removesuffix("-read-as").split(".")[0]


def expected(claim_id):
    return "fails" if claim_id in FAILS else "holds"


# --- the second route -----------------------------------------------------------------------------


class Second:
    """One claim, read by SymPy, at random points."""

    def __init__(self, claim, seed):
        self.claim, self.random = claim, random.Random(f"{claim['id']} {seed}")
        lists = ("q", "p", "x", "variables", "new_q", "new_p", "momenta", "multipliers", "small")
        if claim["kind"] == "lagrange-bracket":
            lists = ("variables",)
        declared = [n for key in lists for n in claim.get(key, [])] + list(claim.get("parameters", {}))
        derived = [n + end for n in claim.get("q", []) + claim.get("x", []) for end in ("_dot", "_ddot")]
        marks = [mark + n for n in claim.get("x", []) for mark in ("d_", "delta_")] + ["d_t"]
        marks += [f"delta_{n}{end}" for n in claim.get("q", []) for end in ("", "_dot")]
        self.names = {n: sp.Symbol(n) for n in (*declared, *derived, *marks, "t")}
        self.names |= {f: self.concrete(f) for f in claim.get("functions", {})}

    def concrete(self, name):
        """Return a generic smooth function to stand for an arbitrary one."""
        seed = sum(i * ord(letter) for i, letter in enumerate(name, 2)) % 97
        a, b = sp.Rational(seed + 11, 60), sp.Rational(seed + 31, 90)

        def function(*args):
            mixed = sum((a + sp.Rational(i, 3)) * x for i, x in enumerate(args))
            product = sp.prod([x + b for x in args])
            return sp.sin(mixed + b) + b * product**2 + sp.exp(a * product / 4) + 2

        return function

    def read(self, text):
        text = re.sub(r"(\w)''", r"\1_ddot", str(text))
        text = re.sub(r"(\w)'", r"\1_dot", text)
        return sp.sympify(text, locals=self.names).doit()

    def all(self, key):
        return [self.equation(text) for text in self.claim.get(key, [])]

    def equation(self, text):
        left, _, right = str(text).partition(" = ")
        return self.read(left) - (self.read(right) if right else 0)

    def symbols(self, key, end=""):
        return [sp.Symbol(n + end) for n in self.claim.get(key, [])]

    def point(self):
        """Return random values for all symbols that satisfy assumptions and domain."""
        signs = self.claim.get("parameters", {})
        conditions = [self.read(text) for text in self.claim.get("domain", [])]
        while True:
            values = {}
            for name, symbol in self.names.items():
                if isinstance(symbol, sp.Symbol):
                    size = sp.Rational(self.random.randint(200, 1200), 997)
                    free = signs.get(name, "real") != "positive"
                    values[symbol] = -size if free and self.random.random() < 0.5 else size
            if all(c.subs(values) == True for c in conditions):  # noqa: E712  (a SymPy relation)
                return values


@functools.lru_cache(maxsize=512)
def compiled(expressions):
    """Return the symbols of expressions, and what evaluates these at values of those."""
    symbols = sorted(set().union(*(e.free_symbols for e in expressions)), key=str)
    return symbols, sp.lambdify(symbols, expressions, "mpmath", cse=True)


def numbers(expressions, values):
    """Return the values of expressions at a point, 40 digits."""
    symbols, evaluated = compiled(tuple(map(sp.sympify, expressions)))
    found = evaluated(
        *(v if isinstance(v, (mp.mpf, mp.mpc)) else mp.mpf(v.p) / v.q for v in (values[s] for s in symbols))
    )
    return [mp.mpmathify(v) for v in found]


def zero(values):
    """Whether all vanish; a value that is neither zero nor clearly not is an error of the test."""
    sizes = [abs(v) for v in values]
    assert all(size < mp.mpf(10) ** -25 or size > mp.mpf(10) ** -9 for size in sizes), sizes
    return all(size < mp.mpf(10) ** -25 for size in sizes)


def rate(e, q, v, a):
    return sum(e.diff(x) * y for x, y in zip((*q, *v), (*v, *a), strict=True)) + e.diff(sp.Symbol("t"))


def lagrange(L, s, forces=None):
    q, v, a = s.symbols("q"), s.symbols("q", "_dot"), s.symbols("q", "_ddot")
    forces = forces or [0] * len(q)
    return [rate(L.diff(y), q, v, a) - L.diff(x) - f for x, y, f in zip(q, v, forces, strict=True)]


def solve_affine(equations, unknowns, values):
    """Return values with the unknowns that solve equations affine in them."""
    at_zero = {**values, **dict.fromkeys(unknowns, sp.Integer(0))}
    n = len(unknowns)
    slopes = numbers([e.diff(u) for e in equations for u in unknowns], at_zero)
    rest = numbers(equations, at_zero)
    solution = mp.lu_solve(
        mp.matrix(n, n) + mp.matrix([slopes[n * i : n * i + n] for i in range(n)]), -mp.matrix(rest)
    )
    return {**values, **dict(zip(unknowns, solution, strict=True))}


def projected(equations, unknowns, values, steps):
    """Return values moved onto equations by Gauss-Newton steps of least length."""
    m, n = len(equations), len(unknowns)
    values = {**values, **{u: numbers([u], values)[0] for u in unknowns}}
    slopes = [e.diff(u) for e in equations for u in unknowns]
    for _ in range(steps):
        flat, rest = numbers(slopes, values), mp.matrix(numbers(equations, values))
        J = mp.matrix([flat[n * i : n * i + n] for i in range(m)])
        step = J.T * mp.lu_solve(J * J.T, rest)
        values = {**values, **{u: values[u] - step[i] for i, u in enumerate(unknowns)}}
    assert zero(numbers(equations, values)), "no point on the constraints was found"
    return values


def free_motion(s):
    L, a = s.read(s.claim["L"]), s.symbols("q", "_ddot")
    v = s.symbols("q", "_dot")
    damping = s.read(s.claim.get("F", "0")) if s.claim["kind"] == "dissipative" else sp.Integer(0)
    system = lagrange(
        L, s, [f - damping.diff(y) for f, y in zip(s.all("Qnc") or [0] * len(v), v, strict=True)]
    )
    values = s.point()
    momenta = [L.diff(sp.Symbol(c + "_dot")) for c in s.claim.get("cyclic", [])]
    if momenta:
        values |= dict(zip(s.symbols("momenta"), numbers(momenta, values), strict=True))
    return L, solve_affine(system, a, values)


def determined(claims, unknowns, values):
    """Whether the claims hold at the motion and determine these accelerations."""
    if not zero(numbers(claims, values)):
        return False
    n = len(unknowns)
    flat = numbers([e.diff(u) for e in claims for u in unknowns], values)
    return not zero([mp.det(mp.matrix([flat[n * i : n * i + n] for i in range(n)]))])


def equations_of_motion(s):
    L, values = free_motion(s)
    if "energy_rate" in s.claim:
        q, v, a = (s.symbols("q", end) for end in ("", "_dot", "_ddot"))
        E = sum(y * L.diff(y) for y in v) - L
        if not zero(numbers([rate(E, q, v, a) - s.read(s.claim["energy_rate"])], values)):
            return False
    kept = [sp.Symbol(n + "_ddot") for n in s.claim["q"] if n not in s.claim.get("cyclic", [])]
    return determined(s.all("claim"), kept, values)


def routhian(s):
    if "claim" in s.claim:
        return equations_of_motion(s)
    L, values = free_motion(s)
    legendre = sum(
        p * sp.Symbol(c + "_dot") for p, c in zip(s.symbols("momenta"), s.claim["cyclic"], strict=True)
    )
    return zero(numbers([s.read(s.claim["R"]) - L + legendre], values))


def constrained(s):
    q, v, a = s.symbols("q"), s.symbols("q", "_dot"), s.symbols("q", "_ddot")
    given, multipliers = s.all("constraints"), s.symbols("multipliers")
    holonomic = s.claim["kind"] == "multiplier-holonomic"
    values = projected(given, q, s.point(), 60) if holonomic else s.point()
    held = [rate(f, q, v, a) for f in given] if holonomic else given
    values = projected(held, v, values, 2)
    directions = [[f.diff(x) for x in (q if holonomic else v)] for f in given]
    reactions = [
        sum(lam * d[i] for lam, d in zip(multipliers, directions, strict=True)) for i in range(len(q))
    ]
    system = lagrange(s.read(s.claim["L"]), s, reactions) + [rate(g, q, v, a) for g in held]
    return zero(numbers(s.all("claim"), solve_affine(system, [*a, *multipliers], values)))


def legendre(s):
    L, v = s.read(s.claim["L"]), s.symbols("q", "_dot")
    through = {p: L.diff(y) for p, y in zip(s.symbols("p"), v, strict=True)}
    H = s.read(s.claim["H"]).subs(through, simultaneous=True)
    return zero(numbers([H - sum(y * L.diff(y) for y in v) + L], s.point()))


def hamilton(s):
    q, p, H = s.symbols("q"), s.symbols("p"), s.read(s.claim["H"])
    field = [H.diff(y) for y in p] + [-H.diff(x) for x in q]
    if "solution" in s.claim:
        motion = {sp.Symbol(n): s.read(e) for n, e in s.claim["solution"].items()}
        rates = [motion[z].diff(sp.Symbol("t")) for z in (*q, *p)]
        return zero(numbers([r - f.subs(motion) for r, f in zip(rates, field, strict=True)], s.point()))
    return zero(
        numbers([c - f for c, f in zip(s.all("q_dot") + s.all("p_dot"), field, strict=True)], s.point())
    )


def bracket(f, g, q, p):
    return sum(f.diff(x) * g.diff(y) - f.diff(y) * g.diff(x) for x, y in zip(q, p, strict=True))


def brackets(s):
    values, residuals = s.point(), []
    for pair in s.claim["pairs"]:
        if "f" in pair:
            found = bracket(s.read(pair["f"]), s.read(pair["g"]), s.symbols("q"), s.symbols("p"))
        else:
            u, v = sp.Symbol(pair["u"]), sp.Symbol(pair["v"])
            found = sum(
                a.diff(u) * b.diff(v) - b.diff(u) * a.diff(v)
                for a, b in zip(s.all("q"), s.all("p"), strict=True)
            )
        residuals.append(found - s.read(pair["value"]))
    return zero(numbers(residuals, values))


def canonical(s):
    if "form" in s.claim:
        x, form = s.symbols("x"), s.all("form")
        d, delta = ([sp.Symbol(mark + y.name) for y in x] for mark in ("d_", "delta_"))
        pairs = itertools.product(range(len(x)), repeat=2)
        right = sum(form[i].diff(x[j]) * (delta[j] * d[i] - d[j] * delta[i]) for i, j in pairs)
        return zero(numbers([s.read(s.claim["claim"]) - right], s.point()))
    q, p, values = s.symbols("q"), s.symbols("p"), s.point()
    new, n = (*s.all("Q"), *s.all("P")), len(q)
    pairs = itertools.combinations(range(2 * n), 2)
    return zero(numbers([bracket(new[i], new[j], q, p) - int(j - i == n) for i, j in pairs], values))


def generating(s):
    (q,), (p,), (Q,), (P,) = (s.symbols(key) for key in ("q", "p", "new_q", "new_p"))
    F, kind, values = s.read(s.claim["F"]), int(s.claim["kind"][-1]), s.point()
    old, new = (q if kind < 3 else p), (Q if kind % 2 else P)
    if F.free_symbols & ({q, p, Q, P} - {old, new}):
        return False
    values |= dict(zip((Q, P), numbers([s.read(s.claim["map"][n][0]) for n in "QP"], values), strict=True))
    rules = [p - F.diff(q) if kind < 3 else q + F.diff(p), P + F.diff(Q) if kind % 2 else Q - F.diff(P)]
    return zero(numbers(rules, values)) and not zero(numbers([F.diff(old).diff(new)], values))


def constant(s):
    I = s.read(s.claim["I"])
    if "H" in s.claim:
        H = s.read(s.claim["H"])
        return zero(
            numbers([bracket(I, H, s.symbols("q"), s.symbols("p")) + I.diff(sp.Symbol("t"))], s.point())
        )
    _, values = free_motion(s)
    return zero(numbers([rate(I, *(s.symbols("q", end) for end in ("", "_dot", "_ddot")))], values))


def same_up_to_a_gauge(s):
    return zero(numbers(lagrange(s.read(s.claim["L2"]) - s.read(s.claim["L1"]), s), s.point()))


def appell(s):
    a = sp.Symbol("x_ddot")
    force = s.read(s.claim.get("V", "0")).diff(sp.Symbol("x"))
    if "S" in s.claim:
        return zero(numbers([s.read(s.claim["S"]).diff(a) - sp.Symbol("m") * a], s.point()))
    return determined(s.all("claim"), [a], solve_affine([sp.Symbol("m") * a + force], [a], s.point()))


def variation(s):
    q, v, a = s.symbols("q"), s.symbols("q", "_dot"), s.symbols("q", "_ddot")
    d, d_dot = ([sp.Symbol(f"delta_{x}{end}") for x in q] for end in ("", "_dot"))
    L, B = s.read(s.claim["L"]), s.read(s.claim["boundary"])
    forces = s.all("Qnc") or [0] * len(q)
    right = sum(
        (L.diff(x) + Q) * e + L.diff(y) * f for x, y, e, f, Q in zip(q, v, d, d_dot, forces, strict=True)
    )
    whole = rate(B, [*q, *d], [*v, *d_dot], [*a, *(0 for _ in d)]) + s.read(s.claim["integrand"])
    return zero(numbers([whole - right], s.point()))


def reaction(s):
    q, v, a = s.symbols("q"), s.symbols("q", "_dot"), s.symbols("q", "_ddot")
    given, multipliers = s.all("constraints"), s.symbols("multipliers")
    places = [f for f in given if not f.has(*v)]
    values = projected(places, q, s.point(), 60) if places else s.point()
    held = [rate(f, q, v, a) if f in places else f for f in given]
    values = projected(held, v, values, 2)
    directions = [[g.diff(x) for x in v] for g in held]
    reactions = [
        sum(lam * d[i] for lam, d in zip(multipliers, directions, strict=True)) for i in range(len(q))
    ]
    forces = [Q + R for Q, R in zip(s.all("Qnc"), reactions, strict=True)]
    system = lagrange(s.read(s.claim["L"]), s, forces) + [rate(g, q, v, a) for g in held]
    values = solve_affine(system, [*a, *multipliers], values)
    return zero(numbers([f - R for f, R in zip(s.all("force"), reactions, strict=True)], values))


def wedge(form, z, values):
    """Return ω ∧ dω of a form in three variables, which vanishes where it is integrable."""
    curl = [form[(i + 2) % 3].diff(z[(i + 1) % 3]) - form[(i + 1) % 3].diff(z[(i + 2) % 3]) for i in range(3)]
    return numbers([sum(w * c for w, c in zip(form, curl, strict=True))], values)


def freedom(s):
    q, v = s.symbols("q"), s.symbols("q", "_dot")
    given, values = s.all("constraints"), s.point()
    if not given:
        return int(s.claim["dof"]) == len(q)
    places = [f for f in given if not f.has(*v)]
    values = projected(places, q, values, 60) if places else values
    rows = [[f.diff(x) for x in (q if f in places else v)] for f in given]
    if s.claim.get("counting") == "positions":
        (row,) = rows
        return int(s.claim["dof"]) == 3 - zero(wedge(row, q, values))
    flat = numbers([e for row in rows for e in row], values)
    J = mp.matrix([flat[len(q) * i : len(q) * (i + 1)] for i in range(len(rows))])
    rank = sum(abs(x) > mp.mpf(10) ** -20 for x in mp.svd_r(J, compute_uv=False))
    return int(s.claim["dof"]) == len(q) - rank


def constraint_class(s):
    if any(sign in text for text in s.claim["constraints"] for sign in "<>"):
        return set(s.claim["class"]) <= {"nonholonomic", "unilateral"}
    q, v, t = s.symbols("q"), s.symbols("q", "_dot"), sp.Symbol("t")
    given = s.all("constraints")
    right = {"holonomic", "bilateral"}
    if any(f.has(*v) for f in given):
        (g,) = given
        form = [g.diff(x) for x in v] + [g.subs(dict.fromkeys(v, 0))]
        assert len(q) == 2 or (len(q) == 3 and form[3] == 0 and not g.has(t)), "three variables are wanted"
        right = {"holonomic" if zero(wedge(form[:3], [*q, t][:3], s.point())) else "nonholonomic"}
        values = s.point()
    else:
        values = projected(given, q, s.point(), 60)
    moving = not zero(numbers([f.diff(t) for f in given], values)) if t not in q else False
    return set(s.claim["class"]) <= right | {"rheonomic" if moving else "scleronomic"}


def expansion(s):
    (small,) = (sp.Symbol(n) for n in s.claim["small"])
    order, values, ratios = s.claim.get("order", 1), s.point(), []
    for exact, claimed in zip(s.all("exact"), s.all("claim"), strict=True):
        size = sp.Rational(1, 10**9)
        (gap,) = numbers([exact - claimed], {**values, small: size})
        ratios.append(abs(gap) / mp.mpf(10) ** (-9 * order))
    assert all(r < 1e-5 or r > 1e-3 for r in ratios), ratios
    return all(r < 1e-5 for r in ratios)


def differential(s):
    f, x = s.read(s.claim["f"]), [*s.symbols("x"), sp.Symbol("t")]
    known = {y: sp.Symbol(f"d_{y}") for y in x}
    known |= {sp.Symbol(n): s.read(form) for n, form in s.claim.get("given", {}).items()}
    return zero(numbers([sum(f.diff(y) * d for y, d in known.items()) - s.read(s.claim["claim"])], s.point()))


def invariance(s):
    q, values = s.symbols("q"), s.point()
    n = len(q)
    if s.claim["of"] == "lagrange-equations":
        flat = numbers([f.diff(x) for f in s.all("Q") for x in q], values)
        return not zero([mp.det(mp.matrix([flat[n * i : n * i + n] for i in range(n)]))])
    F, kind, p, Q, P = s.read(s.claim["F"]), s.claim["type"], *map(s.symbols, ("p", "new_q", "new_p"))
    old = [*q, *(F.diff(x) for x in q)] if kind < 3 else [*(-F.diff(x) for x in p), *p]
    new = [*Q, *(-F.diff(x) for x in Q)] if kind % 2 else [*(F.diff(y) for y in P), *P]
    jacobians = []
    for functions in (old, new):
        z = (*(q if kind < 3 else p), *(Q if kind % 2 else P))
        flat = numbers([f.diff(x) for f in functions for x in z], values)
        jacobians.append(mp.matrix([flat[2 * n * i : 2 * n * (i + 1)] for i in range(2 * n)]))
    M = jacobians[1] * mp.inverse(jacobians[0])
    J = mp.matrix(2 * n, 2 * n)
    for i in range(n):
        J[i, n + i], J[n + i, i] = 1, -1
    gap = M * J * M.T - J if s.claim["of"] == "poisson-brackets" else M.T * J * M - J
    return zero(list(gap))


def virtual_power(s):
    q, v = s.symbols("q"), s.symbols("q", "_dot")
    given = s.read(s.claim.get("power", "0"))
    given -= sum(s.read(s.claim.get("V", "0")).diff(x) * y for x, y in zip(q, v, strict=True))
    for force in s.claim.get("forces", []):
        pairs = zip(map(s.read, force["F"]), map(s.read, force["r"]), strict=True)
        given += sum(F * sum(r.diff(x) * y for x, y in zip(q, v, strict=True)) for F, r in pairs)
    claimed = sum(Q * y for Q, y in zip(s.all("Q"), v, strict=True))
    return zero(numbers([claimed - given], s.point()))


def positive_real(s):
    H, values, least = s.read(s.claim["H"]), s.point(), mp.inf
    for _ in range(200):
        at = mp.mpc(s.random.expovariate(1), s.random.gauss(0, 3))
        least = min(least, mp.re(numbers([H], {**values, sp.Symbol("s"): at})[0]))
    return (least >= 0) != any(word.startswith("not ") for word in s.claim["is"])


def lie(s):
    x, X, Y, claimed = s.symbols("x"), s.all("X"), s.all("Y"), s.all("claim")
    found = [
        sum(a * g.diff(z) - b * f.diff(z) for a, b, z in zip(X, Y, x, strict=True))
        for f, g in zip(X, Y, strict=True)
    ]
    return zero(numbers([f - c for f, c in zip(found, claimed, strict=True)], s.point()))


def kinetic(s):
    q, v, t = s.symbols("q"), s.symbols("q", "_dot"), sp.Symbol("t")
    moving = [(body["m"], place) for body in s.claim["bodies"] for place in body["r"]]
    moving += [(body["I"], body["angle"]) for body in s.claim["bodies"] if "angle" in body]
    T = sum(s.read(m) * rate(s.read(place), q, v, v) ** 2 / 2 for m, place in moving)
    assert not T.has(t)
    values, given = s.point(), s.all("constraints")
    if given:
        values = projected(given, q, values, 60)
        values = projected([rate(f, q, v, v) for f in given], v, values, 2)
    return zero(numbers([s.read(s.claim["T"]) - T], values))


def equality(s):
    return zero(numbers([s.read(s.claim["lhs"]) - s.read(s.claim["rhs"])], s.point()))


ROUTES = {
    "euler-lagrange": equations_of_motion,
    "dissipative": equations_of_motion,
    "routhian": routhian,
    "multiplier-holonomic": constrained,
    "nonholonomic": constrained,
    "legendre-hamiltonian": legendre,
    "hamilton-equations": hamilton,
    "poisson-bracket": brackets,
    "lagrange-bracket": brackets,
    "lie-bracket": lie,
    "canonicity": canonical,
    "bilinear-covariant": canonical,
    **{f"generating-F{i}": generating for i in (1, 2, 3, 4)},
    "constant-of-motion": constant,
    "lagrangian-equivalence": same_up_to_a_gauge,
    "gibbs-appell": appell,
    "equality-only": equality,
    "variation": variation,
    "reaction": reaction,
    "degrees-of-freedom": freedom,
    "constraint-class": constraint_class,
    "first-order": expansion,
    "differential": differential,
    "invariance": invariance,
    "generalized-force": virtual_power,
    "positive-real": positive_real,
    "kinetic-energy": kinetic,
}


def held_at(claim, seed):
    with mp.workdps(40):
        return ROUTES[claim["kind"]](Second(claim, seed))


@pytest.mark.parametrize("claim_id", sorted(set(CLAIMS) - SLOW))
def test_a_second_route_confirms_the_frozen_verdict(claim_id):
    assert held_at(CLAIMS[claim_id], 0) == (expected(claim_id) == "holds")


@pytest.mark.slow
@pytest.mark.parametrize("claim_id", CLAIMS)
def test_a_second_route_confirms_it_at_more_points(claim_id):
    held = all(held_at(CLAIMS[claim_id], seed) for seed in range(1, 5))
    assert held == (expected(claim_id) == "holds")


# --- canon ----------------------------------------------------------------------------------------


def of_sheet(path):
    return [claim for claim in read_sheet(path).claims if claim.id not in SLOW]


@pytest.mark.parametrize("path", SHEETS, ids=lambda path: path.stem)
def test_canon_says_the_frozen_verdicts(path):
    said = {claim.id: judge(claim).status.value for claim in of_sheet(path)}
    assert said == {claim_id: expected(claim_id) for claim_id in said}


@pytest.mark.slow
@pytest.mark.parametrize("claim_id", sorted(SLOW))
def test_canon_says_the_frozen_verdict_of_a_slow_claim(claim_id):
    (claim,) = (claim for path in SHEETS for claim in read_sheet(path).claims if claim.id == claim_id)
    assert judge(claim).status.value == expected(claim_id)


# --- wrong twins ----------------------------------------------------------------------------------

SLIPS = ((" + ", " - "), (" - ", " + "), ("sin(", "cos("), ("cos(", "sin("), ("**2", "**3"), ("/2", "/3"))
ANSWERS = ("claim", "R", "H", "S", "I", "F", "L2", "q_dot", "p_dot", "lhs", "Q", "P")
ANSWERS += ("boundary", "integrand", "force", "T")
UNSLIPPED = ("constraint-class", "degrees-of-freedom", "invariance", "positive-real")
"""Kinds whose answer is a word or a number, or where the second route can only confirm."""


def twin(claim, chance):
    """Return the claim with one slip in its answer; where no slip fits, the answer is doubled."""
    key = chance.choice([key for key in ANSWERS if key in claim])
    texts = claim[key] if isinstance(claim[key], list) else [claim[key]]
    i = chance.randrange(len(texts))
    places = [(m.start(), a, b) for a, b in SLIPS for m in re.finditer(re.escape(a), texts[i])]
    place, a, b = chance.choice(places) if places else (0, "", "2*")
    slipped = [*texts[:i], texts[i][:place] + b + texts[i][place + len(a) :], *texts[i + 1 :]]
    return {**claim, key: slipped if isinstance(claim[key], list) else slipped[0]}


@pytest.mark.slow
@pytest.mark.parametrize(
    "claim_id",
    sorted(
        i
        for i, claim in CLAIMS.items()
        if i not in SLOW and not {"pairs", "solution"} & set(claim) and claim["kind"] not in UNSLIPPED
    ),
)
def test_canon_and_the_second_route_agree_on_a_slip(claim_id):
    slipped = twin(CLAIMS[claim_id], random.Random(claim_id))
    held = all(held_at(slipped, seed) for seed in range(3))
    said = judge(Claim(claim_id, slipped["kind"], slipped)).status.value
    assert said == ("holds" if held else "fails"), slipped


# --- the sheets, the entries and the page ---------------------------------------------------------


def test_no_claim_is_invalid_or_says_what_to_expect():
    for path in SHEETS:
        assert read_sheet(path).errors == ()
    assert not any("expect" in claim for claim in CLAIMS.values())
    assert set(CLAIMS) >= FAILS


def test_every_entry_is_judged_or_says_why_not():
    judged = {entry_of(claim_id) for claim_id in CLAIMS}
    assert len(ENTRIES) == len({entry["id"] for entry in ENTRIES}) == 260
    assert judged == {entry["id"] for entry in ENTRIES if "unjudged" not in entry}


def test_the_page_says_the_frozen_verdicts():
    page = (ROOT / "docs" / "seeds.md").read_text("utf-8")
    said = dict(re.findall(r"^\| `([^`]+)` \|.*\| \*\*(\w+)\*\* \|", page, re.MULTILINE))
    assert said == {claim_id: expected(claim_id) for claim_id in CLAIMS}
    assert all(f"`{entry['id']}`" in page for entry in ENTRIES if "unjudged" in entry)
