"""Symbolic extremes: expressions, domains and sheets at their ends, and what is said of them."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Abs, Function, I, Max, Piecewise, Rational, cos, exp, log, pi, sign, sin, sqrt

from extremes.row import Outcome, Row, refused, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

x, y, z = sp.symbols("x y z", real=True)
a, b = sp.symbols("a b", positive=True)

Sides = "Callable[[], tuple[sp.Expr, sp.Expr]]"


def rows() -> Iterator[Row]:
    """Yield the rows."""
    yield from _radicals()
    yield from _edges()
    yield from _domains()
    yield from _large()
    yield from _maps()
    yield from _lagrangians()
    yield from _names()
    yield from _sheets()


def judged(verdict: Any, expected: str) -> Outcome:
    """Return the outcome of a verdict: right, wrong, or open with its reason."""
    if verdict.undecided:
        return Outcome(shown("UNDECIDED: " + "; ".join(e.text for e in verdict.evidence), 160), refused=True)
    example = f", {verdict.counterexample}" if verdict.counterexample else ""
    noted = f"; assumed: {verdict.assumed[0]}" if verdict.assumed else ""
    said = f"{verdict.status.name} ({verdict.certificate}){example}{noted}"
    return Outcome(shown(said, 160), right=verdict.status.value == expected)


def claim(
    name: str, tried: str, expected: str, sides: Sides, conditions: Sequence[Any] = (), budget: float = 10.0
) -> Row:
    """Return a row about an equality, judged by canon and by SymPy's simplify and equals."""

    def canon() -> Outcome:
        from canon import Domain, equal

        start = time.monotonic()
        left, right = sides()
        built, cpu = time.monotonic(), time.process_time()
        found = judged(equal(left, right, Domain(tuple(conditions)), budget), expected)
        spent = time.monotonic() - built
        late = time.process_time() - cpu > budget + 2.0  # the machine may be busy with others
        said = f"{found.said}; {spent:.1f} s of {budget:g} s" + (
            f", built in {built - start:.1f} s" if built - start > 0.5 else ""
        )
        return Outcome(said, right=False if late else found.right, refused=found.refused and not late)

    def simplified() -> Outcome:
        left, right = sides()
        rest = sp.simplify(left - right)
        if rest == 0:
            return Outcome("0", right=expected == "holds")
        return Outcome(shown(f"{rest}", 60), refused=True)

    def equals() -> Outcome:
        left, right = sides()
        answer = left.equals(right)
        if answer is None:
            return Outcome("None", refused=True)
        return Outcome(str(answer), right=answer is (expected == "holds"))

    ordinary = {} if conditions else {"simplify": simplified, "equals": equals}
    return Row(name, tried, canon, ordinary, limit=budget + 30.0)


def nested(depth: int, seed: int = 2) -> sp.Expr:
    """Return (√(n + √n))² − √n … nested: a radical of so many levels whose square is rational in the one below."""
    r: sp.Expr = sp.Integer(seed)
    for k in range(depth):
        r = sqrt(r + k + 1)
    return r


def _radicals() -> Iterator[Row]:
    def unnested() -> tuple[sp.Expr, sp.Expr]:
        r = nested(6)
        return sp.expand(((((r**2 - 6) ** 2 - 5) ** 2 - 4) ** 2 - 3) ** 2, deep=False), (
            sp.Integer(2) + sqrt(3)
        )

    yield claim("radicals-6-deep", "√(6+√(5+√(4+√(3+√(2+√3))))) unwound by four squarings", "holds", unnested)
    yield claim(
        "radicals-6-deep-twin",
        "the same, the result off by 1e-40",
        "fails",
        lambda: (unnested()[0], unnested()[1] + Rational(1, 10**40)),
    )
    yield claim(
        "ramanujan-cube",
        "∛(∛2 − 1) = ∛(1/9) − ∛(2/9) + ∛(4/9)",
        "holds",
        lambda: (
            sp.cbrt(sp.cbrt(2) - 1),
            sp.cbrt(Rational(1, 9)) - sp.cbrt(Rational(2, 9)) + sp.cbrt(Rational(4, 9)),
        ),
    )
    yield claim(
        "shanks",
        "√5 + √(22 + 2√5) = √(11 + 2√29) + √(16 − 2√29 + 2√(55 − 10√29))",
        "holds",
        lambda: (
            sqrt(5) + sqrt(22 + 2 * sqrt(5)),
            sqrt(11 + 2 * sqrt(29)) + sqrt(16 - 2 * sqrt(29) + 2 * sqrt(55 - 10 * sqrt(29))),
        ),
    )
    yield claim(
        "sum-of-roots",
        "√2 + √3 + √5 + √7 + √11 against its square root of the square with one unit in the 41st decimal",
        "fails",
        lambda: (
            sqrt(2) + sqrt(3) + sqrt(5) + sqrt(7) + sqrt(11),
            sqrt((sqrt(2) + sqrt(3) + sqrt(5) + sqrt(7) + sqrt(11)) ** 2 + Rational(1, 10**41)),
        ),
    )


def _edges() -> Iterator[Row]:
    yield claim("residual-1e-40", "x + 1e-40 = x", "fails", lambda: (x + Rational(1, 10**40), x))
    yield claim("residual-1e-400", "x + 1e-400 = x", "fails", lambda: (x + Rational(1, 10**400), x))
    yield claim(
        "almost-integer",
        "exp(π√163) = 640320³ + 744, which agrees to 30 digits",
        "fails",
        lambda: (exp(pi * sqrt(163)), sp.Integer(640320**3 + 744)),
    )
    yield claim(
        "machin", "π/4 = 4 atan(1/5) − atan(1/239)", "holds",
        lambda: (pi / 4, 4 * sp.atan(Rational(1, 5)) - sp.atan(Rational(1, 239))),
    )  # fmt: skip
    yield claim("null-set", "|x| = x, true on half the line", "fails", lambda: (Abs(x), x))
    yield claim(
        "one-point",
        "sin(10¹² π x) = 0, true at every multiple of 1e-12",
        "fails",
        lambda: (sin(10**12 * pi * x), sp.Integer(0)),
    )
    yield claim(
        "off-a-point",
        "sign(x)² = 1, false at x = 0 only",
        "fails",
        lambda: (sign(x) ** 2, sp.Integer(1)),
    )
    yield claim(
        "off-far-point",
        "sign(x − 123456789/1000)² = 1, false at one far point only",
        "fails",
        lambda: (sign(x - Rational(123456789, 1000)) ** 2, sp.Integer(1)),
    )
    yield claim(
        "bump",
        "Max(0, 1e-30 − (x − 7/3)²) = 0, false on an interval 2e-15 wide",
        "fails",
        lambda: (Max(0, Rational(1, 10**30) - (x - Rational(7, 3)) ** 2), sp.Integer(0)),
    )
    yield claim("branch", "√(x²) = x", "fails", lambda: (sqrt(x**2), x))
    yield claim(
        "winding", "log(exp(i x)) = i x, true for −π < x ≤ π", "fails", lambda: (log(exp(I * x)), I * x)
    )
    yield claim(
        "atan-tan-sum",
        "atan x + atan y = atan((x + y)/(1 − x y)), true where x y < 1",
        "fails",
        lambda: (sp.atan(x) + sp.atan(y), sp.atan((x + y) / (1 - x * y))),
    )
    yield claim(
        "tower", "exp(exp(exp(x))) = exp(exp(exp(−x)))", "fails",
        lambda: (exp(exp(exp(x))), exp(exp(exp(-x)))),
    )  # fmt: skip
    yield claim(
        "huge-power", "(1 + x)^(10⁶) = 1 + 10⁶ x", "fails", lambda: ((1 + x) ** 10**6, 1 + 10**6 * x),
        budget=5.0,
    )  # fmt: skip
    yield claim(
        "derivative-by-function",
        "d/dx U(r(x)) = U′(r(x)) r′(x) for every U and r",
        "holds",
        lambda: (lambda U, r: (U(r(x)).diff(x), sp.Subs(U(y).diff(y), y, r(x)) * r(x).diff(x)))(
            Function("U"), Function("r")
        ),
    )
    yield claim(
        "derivative-by-function-twin",
        "d/dx U(r(x)) = U′(r(x)) for every U and r",
        "fails",
        lambda: (lambda U, r: (U(r(x)).diff(x), sp.Subs(U(y).diff(y), y, r(x))))(
            Function("U"), Function("r")
        ),
    )


def _domains() -> Iterator[Row]:
    yield claim(
        "domain-empty",
        "x = 0 where x < 1 and x > 2: true of nothing; the verdict has to say so",
        "holds",
        lambda: (x, sp.Integer(0)),
        (x < 1, x > 2),
    )
    yield claim(
        "domain-point", "x = 1 where x ≤ 1 and x ≥ 1", "holds", lambda: (x, sp.Integer(1)), (x <= 1, x >= 1)
    )
    yield claim("domain-point-twin", "x = 2 where x = 1", "fails", lambda: (x, sp.Integer(2)), (sp.Eq(x, 1),))
    yield claim(
        "domain-irrational-point",
        "x = √2 where x² = 2 and x > 0: no rational point at all",
        "holds",
        lambda: (x, sqrt(2)),
        (sp.Eq(x**2, 2), x > 0),
        budget=5.0,
    )
    yield claim(
        "domain-sliver",
        "√((x − 1)²) = x − 1 where 1 < x < 1 + 1e-30",
        "holds",
        lambda: (sqrt((x - 1) ** 2), x - 1),
        (x > 1, x < 1 + Rational(1, 10**30)),
    )
    yield claim(
        "domain-circle",
        "√(1 − x²) = |y| on x² + y² = 1",
        "holds",
        lambda: (sqrt(1 - x**2), Abs(y)),
        (sp.Eq(x**2 + y**2, 1),),
    )

    def contradicting() -> Outcome:
        from canon import parameters

        return refused(lambda: parameters("m", positive=True, negative=True), ValueError, holds="at once")

    def plainly() -> Outcome:
        try:
            sp.Symbol("m", positive=True, negative=True)
        except ValueError as error:
            return Outcome(shown(str(error), 60), refused=True)
        return Outcome("accepted", right=False)

    yield Row("assumptions-contradict", "a mass positive and negative", contradicting, {"Symbol": plainly})

    def misspelt() -> Outcome:
        from canon import parameters

        return refused(lambda: parameters("m", postive=True), ValueError, holds="is positive meant")

    yield Row(
        "assumption-misspelt",
        "postive=True",
        misspelt,
        {
            "Symbol": lambda: Outcome(
                f"is_positive is {sp.Symbol('m', postive=True).is_positive}", right=False
            )
        },
    )


def _big_sum(blocks: int, levels: int) -> sp.Expr:
    """Return Σ k (1 + s (1 + s (1 + …))) over k, s = sin x + y, each bracket with its own numbers."""
    s = sin(x) + y
    terms: list[sp.Expr] = []
    for k in range(1, blocks + 1):
        h: sp.Expr = sp.Integer(k)
        for _ in range(levels):
            h = k + s * h
        terms.append(h)
    return sp.Add(*terms)


def _large() -> Iterator[Row]:
    def sides() -> tuple[sp.Expr, sp.Expr]:
        blocks, levels = 1600, 20
        s = sin(x) + y
        return _big_sum(blocks, levels), blocks * (blocks + 1) // 2 * sp.Add(
            *(s**i for i in range(levels + 1))
        )

    yield claim(
        "operations-1e5", "1600 polynomials of degree 20 in sin x + y in Horner's form, against their sum", "holds",
        sides, budget=60.0,
    )  # fmt: skip
    yield claim(
        "operations-1e5-twin", "the same, the sum plus 1e-40 x", "fails",
        lambda: (sides()[0], sides()[1] + x / 10**40), budget=60.0,
    )  # fmt: skip
    yield claim(
        "angles-200",
        "cos(Σ of 12 angles) against the product formula expanded",
        "holds",
        lambda: (lambda s: (cos(sp.Add(*s)), sp.re(sp.Mul(*(cos(t) + I * sin(t) for t in s)))))(
            sp.symbols("t0:12", real=True)
        ),
        budget=10.0,
    )

    def deep() -> tuple[sp.Expr, sp.Expr]:
        f: sp.Expr = x
        for _ in range(2000):
            f = sp.sin(f, evaluate=False)
        return f, sp.Integer(1)

    yield claim("nesting-2000", "sin sin … sin x 2000 deep, against 1", "fails", deep, budget=5.0)

    def swell() -> tuple[sp.Expr, sp.Expr]:
        f: sp.Expr = x
        for _ in range(40):
            f = f**2 + f
        return f, f + Rational(1, 10**40)

    yield claim(
        "shared-40",
        "f ↦ f² + f forty times: 80 distinct operations, a tree of 10¹²; against itself plus 1e-40",
        "fails",
        swell,
        budget=10.0,
    )

    def pendulum() -> Outcome:
        from canon import Lagrangian, coordinates, parameters

        q = coordinates(" ".join(f"q{k}" for k in range(40)) + ",")
        g, l = parameters("g l", positive=True)
        X = Y = sp.S.Zero
        T = V = sp.S.Zero
        for s in q:
            X, Y = X + l * cos(s) * s.dot, Y + l * sin(s) * s.dot
            T += (X**2 + Y**2) / 2
        V = -sp.Add(*((40 - k) * g * l * cos(s) for k, s in enumerate(q)))
        start = time.monotonic()
        from canon.mechanics.at_scale.second_order import derivation_of_lagrangian

        system = derivation_of_lagrangian(Lagrangian(T - V, q))
        seconds = time.monotonic() - start
        del system
        return Outcome(f"M and f on a graph in {seconds:.1f} s", right=True)

    def plainly() -> Outcome:
        from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

        q = dynamicsymbols("q0:40")
        t = sp.Symbol("t")
        X = Y = sp.S.Zero
        T = sp.S.Zero
        for s in q:
            X, Y = X + cos(s) * s.diff(t), Y + sin(s) * s.diff(t)
            T += (X**2 + Y**2) / 2
        LagrangesMethod(T, q).form_lagranges_equations()
        return Outcome("formed", right=True)

    yield Row(
        "pendulum-40-links", "the equations of a 40-link pendulum, M q̈ = f", pendulum,
        {"LagrangesMethod": plainly}, limit=60.0,
    )  # fmt: skip


def _maps() -> Iterator[Row]:
    def rotations(n: int, off: int = 0) -> Outcome:
        from canon import CanonicalTransformation

        q, p = sp.symbols(f"q0:{n}", real=True), sp.symbols(f"p0:{n}", real=True)
        angle = sum(s**2 + r**2 for s, r in zip(q, p, strict=True)) / 2
        Q = [s * cos(angle) + r * sin(angle) for s, r in zip(q, p, strict=True)]
        P = [r * cos(angle) - s * sin(angle) + (off * q[0] * q[1] if k == 0 else 0)
             for k, (s, r) in enumerate(zip(q, p, strict=True))]  # fmt: skip
        found = CanonicalTransformation(q, p, Q, P).is_canonical(budget=60.0)
        return judged(found, "fails" if off else "holds")

    yield Row(
        "map-12-dof",
        "12 degrees of freedom, all rotated through the angle Σ(q² + p²)/2 that depends on all of them",
        lambda: rotations(12),
        limit=90.0,
    )
    yield Row("map-12-dof-twin", "the same, P1 with q0 q1 added", lambda: rotations(12, 1), limit=90.0)

    def composed(times: int, off: sp.Expr = sp.S.Zero) -> Outcome:
        from canon import CanonicalTransformation

        q, p = sp.symbols("q p", real=True)
        kick = CanonicalTransformation(q, p, q, p - sin(q))
        drift = CanonicalTransformation(q, p, q + p, p + off * q * p)
        whole = kick.then(drift)
        for _ in range(times - 1):
            whole = whole.then(kick).then(drift)
        return judged(whole.is_canonical(budget=20.0), "fails" if off else "holds")

    for times in (4, 8):
        yield Row(
            f"standard-map-{times}", f"Chirikov's standard map composed {times} times",
            lambda times=times: composed(times), limit=60.0,
        )  # fmt: skip
    yield Row(
        "standard-map-8-twin", "the same, each kick off by 1e-40 q p",
        lambda: composed(8, Rational(1, 10**40)), limit=60.0,
    )  # fmt: skip


def _lagrangians() -> Iterator[Row]:
    def system(L: Callable[[Any, Any], sp.Expr], then: Callable[[Any], Outcome]) -> Callable[[], Outcome]:
        def run() -> Outcome:
            from canon import Lagrangian, coordinates

            u, v = coordinates("u v")
            return then(Lagrangian(L(u, v), [u, v]))

        return run

    def says(words: str, *kinds: type[BaseException]) -> Callable[[Any], Outcome]:
        return lambda lagrangian: refused(lambda: lagrangian.accelerations, *kinds, holds=words)

    yield Row(
        "lagrangian-degenerate", "L = (u̇ + v̇)²: one acceleration is undetermined",
        system(lambda u, v: (u.dot + v.dot) ** 2, says("direction", ValueError)),
    )  # fmt: skip
    yield Row(
        "lagrangian-linear", "L = u v̇: no accelerations at all",
        system(lambda u, v: u * v.dot, says("does not determine", ValueError)),
    )  # fmt: skip
    yield Row(
        "lagrangian-without-velocities", "L = u² + v²",
        system(lambda u, v: u**2 + v**2, says("does not determine", ValueError)),
    )  # fmt: skip

    def complex_energy(lagrangian: Any) -> Outcome:
        from canon import is_constant_of_motion

        return judged(is_constant_of_motion(lagrangian.jacobi_energy, lagrangian), "holds")

    yield Row(
        "lagrangian-complex", "L = (u̇² + v̇²)/2 − (u + i v)⁴, its energy conserved",
        system(lambda u, v: (u.dot**2 + v.dot**2) / 2 - (u + I * v) ** 4, complex_energy),
    )  # fmt: skip
    yield Row(
        "lagrangian-kinked", "L = (u̇² + v̇²)/2 − |u| − Max(u, v), its energy conserved away from the kinks",
        system(lambda u, v: (u.dot**2 + v.dot**2) / 2 - Abs(u) - Max(u, v), complex_energy),
    )  # fmt: skip
    yield Row(
        "lagrangian-pieces", "L = u̇²/2 + v̇²/2 − V, V = u² where u > 0 and 0 elsewhere",
        system(lambda u, v: (u.dot**2 + v.dot**2) / 2 - Piecewise((u**2, u > 0), (0, True)), complex_energy),
    )  # fmt: skip

    def wrong_energy(lagrangian: Any) -> Outcome:
        from canon import is_constant_of_motion

        return judged(is_constant_of_motion(lagrangian.jacobi_energy + lagrangian.q[0], lagrangian), "fails")

    yield Row(
        "lagrangian-kinked-twin", "the same kinked L, the energy plus u",
        system(lambda u, v: (u.dot**2 + v.dot**2) / 2 - Abs(u) - Max(u, v), wrong_energy),
    )  # fmt: skip

    def negative_mass(lagrangian: Any) -> Outcome:
        return Outcome(str(lagrangian.accelerations), right=lagrangian.accelerations == (-lagrangian.q[0], 0))

    yield Row(
        "lagrangian-indefinite", "L = −u̇²/2 + v̇²/2 + u²/2, an indefinite mass matrix",
        system(lambda u, v: -(u.dot**2) / 2 + v.dot**2 / 2 + u**2 / 2, negative_mass),
    )  # fmt: skip


NAMES = ("I", "E", "N", "S", "Q", "O", "C", "pi", "beta", "gamma", "zeta", "lambda", "sin", "exp", "Max", "Abs",
         "sqrt", "Symbol", "Derivative", "im", "re", "def", "None", "diff")  # fmt: skip


def _names() -> Iterator[Row]:
    def named(name: str) -> Outcome:
        from canon import judge
        from canon.exercise import Claim

        one = Claim(
            "a", "constant-of-motion",
            {"q": ["x"], "p": ["p"], "H": f"p**2/2 + ({name})*x**2/2", "I": f"p**2 + ({name})*x**2",
             "parameters": {name: "positive"}},
        )  # fmt: skip
        wrong = Claim("b", one.kind, {**one.keys, "I": f"p**2 + ({name})**2*x**2"})
        first, second = judge(one).status.value, judge(wrong).status.value
        return Outcome(f"{first}, its twin {second}", right=(first, second) == ("holds", "fails"))

    def parsed(name: str) -> Outcome:
        try:
            found = sp.sympify(f"p**2/2 + ({name})*x**2/2")
        except Exception as error:  # noqa: BLE001, whatever SymPy raises is its answer
            return Outcome(shown(f"{type(error).__name__}", 60), refused=True)
        plain = sp.Symbol(name) in found.free_symbols
        return Outcome(
            shown(f"reads {found}", 60),
            right=plain or None,
            refused=False,
            error=None if plain else float("nan"),
        )

    for name in NAMES:
        yield Row(
            f"name-{name}", f"a parameter called {name}: H = p²/2 + {name} x²/2 is conserved",
            lambda name=name: named(name), {"sympify": lambda name=name: parsed(name)}, limit=40.0,
        )  # fmt: skip


LOOKALIKES: Mapping[str, tuple[str, str]] = {
    "greek-omicron": ("ο", "the Greek letter omicron, declared o"),
    "cyrillic-a": ("а", "the Cyrillic letter a, declared a"),
    "fullwidth-x": ("ｘ", "a full-width x, declared x"),
    "script-l": ("ℓ", "the script l, declared l"),
    "minus-sign": ("a − a", "a typographical minus"),
    "zero-width": ("a\u200bb", "a zero-width space between a and b"),
    "right-to-left": ("a\u202e+b", "an override of the reading direction"),
    "superscript": ("a²", "a superscript two"),
    "fraction": ("½*a", "the fraction ½"),
    "multiplication": ("2×a", "the sign ×"),
    "digits": ("٣*a", "the Arabic-Indic digit three"),
    "combining": ("a\u0301", "a with a combining accent"),
}


def _sheets() -> Iterator[Row]:
    def lookalike(text: str) -> Outcome:
        from canon import judge
        from canon.exercise import Claim, InvalidClaim

        keys = {"lhs": text, "rhs": "12345", "parameters": dict.fromkeys("abolx", "real")}
        try:
            verdict = judge(Claim("a", "equality-only", keys))
        except InvalidClaim as error:
            return Outcome(shown(error.error.brief, 160), refused=True)
        read = str(verdict.residual)
        return Outcome(shown(f"read as {read}", 160), right=verdict.fails)

    for name, (text, said) in LOOKALIKES.items():
        yield Row(
            f"unicode-{name}",
            f"{said}: {text.encode('ascii', 'backslashreplace').decode()}",
            lambda text=text: lookalike(text),
        )

    def thousands() -> Outcome:
        from canon import check
        from canon.exercise import Claim, Sheet

        count = 3000
        claims = tuple(
            Claim(
                str(k), "equality-only",
                {"lhs": f"(x + {k})**2", "rhs": f"x**2 + {2 * k}*x + {k * k + (k % 7 == 0)}",
                 "parameters": {"x": "real"}},
            )
            for k in range(count)
        )  # fmt: skip
        start = time.monotonic()
        report = check(Sheet("many", claims), jobs=2)
        seconds = time.monotonic() - start
        wrong = sum(j.status != ("fails" if int(j.id) % 7 == 0 else "holds") for j in report.judgements)
        return Outcome(f"{count} claims in {seconds:.0f} s, {wrong} misjudged", right=wrong == 0)

    yield Row("claims-3000", "3000 claims in one sheet, every seventh wrong", thousands, limit=400.0)

    def bomb(text: str, words: str) -> Outcome:
        from canon import check
        from canon.exercise import Claim, Sheet

        start = time.monotonic()
        sheet = Sheet("b", (Claim("a", "equality-only", {"lhs": text, "rhs": "1"}, budget=5.0),))
        (found,) = check(sheet).judgements
        seconds = time.monotonic() - start
        said = f"{found.status}: {found.known or found.feedback} ({seconds:.1f} s)"
        said = said.encode("utf-8", "backslashreplace").decode()
        late = seconds > 5.0 + 8.0
        return Outcome(
            shown(said, 160),
            refused=found.status in ("invalid", "undecided") and words in said and not late,
            right=not late and found.status != "holds",
        )

    for name, text in {
        "power-tower": "9**9**9**9",
        "factor-10000": "2**10000 - 2**10000 + 2",
        "open-brackets": "(" * 5000 + "1" + ")" * 5000,
        "long-product": "*".join(["(1+x)"] * 20000),
        "code": "__import__('os').system('true')",
        "attribute": "(1).__class__.__bases__",
        "nul": "1\x00+1",
        "lone-surrogate": "\ud800",
    }.items():
        yield Row(f"text-{name}", f"lhs = {shown(text.encode('ascii', 'backslashreplace').decode(), 40)}",
                  lambda text=text: bomb(text, ""), limit=60.0)  # fmt: skip

    def twice_said() -> Outcome:
        from canon.exercise.sheet.sheet import SheetError, sheet_from

        return refused(
            lambda: sheet_from(b'[[claim]]\nlhs = "$\\sin x$"', toml=True), SheetError, holds="single quotes"
        )

    yield Row("toml-double-quotes", "LaTeX in TOML's double quotes", twice_said)
