"""A class: 200 students, 10 questions each, answers right in many forms, wrong by typical slips, or mistyped.

    python benchmarks/classroom.py                 # 200 students, 2 processes
    python benchmarks/classroom.py --students 20 --jobs 1

Whether an answer is right is known without canon: forms are made by identities, and what a slip makes of an answer is
evaluated at random points with mpmath. Each student hands in a sheet; all sheets are judged in one run.
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import sympy as sp

sys.path.insert(0, str(Path(__file__).parents[1]))

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

NAMES = "theta theta_dot theta_ddot r r_dot p_r p_phi phi_dot q p Q x y x_dot m g l R k c omega"
S = {name: sp.Symbol(name, positive=True) for name in NAMES.split()}
LATEX = {S[f"{x}{rate}"]: rf"\{accent}{{{tex}}}" for x, tex in (("theta", r"\theta"), ("r", "r"), ("phi", r"\phi"),
         ("x", "x")) for rate, accent in (("_dot", "dot"), ("_ddot", "ddot")) if f"{x}{rate}" in S}  # fmt: skip
RIGHT, WRONG = 0.62, 0.33
"""Shares of right and of wrong answers; the rest is mistyped."""


@dataclass(frozen=True)
class Exercise:
    """A claim with a gap, what fills it rightly, and what is the same for all right answers."""

    name: str
    claim: dict[str, Any]
    answer: sp.Expr
    filled: Callable[[str], dict[str, Any]]
    motion: sp.Symbol | None = None


def parse(text: str) -> sp.Expr:
    return sp.sympify(text, locals=S)  # texts of this file only


def exercises() -> list[Exercise]:
    sign = dict.fromkeys(("m", "g", "l", "R", "k", "c", "omega", "r"), "positive")

    def used(*names: str) -> dict[str, str]:
        return {name: sign[name] for name in names}

    pendulum = {
        "q": ["theta"],
        "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
        "parameters": used("m", "g", "l"),
    }
    hoop = {"q": ["theta"], "L": "m*R**2*(theta_dot**2 + omega**2*sin(theta)**2)/2 + m*g*R*cos(theta)",
            "parameters": used("m", "g", "R", "omega")}  # fmt: skip
    kepler = {
        "q": ["r", "phi"],
        "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r",
        "parameters": used("m", "k", "r"),
    }
    energy = "p_r**2/(2*m) + p_phi**2/(2*m*r**2) - k/r"
    oscillator = used("m", "omega")
    phase = {"q": ["q"], "p": ["p"], "parameters": {**oscillator, "q": "positive", "p": "positive"}}
    theta_dd = S["theta_ddot"]
    rows: list[tuple[str, str, dict[str, Any], str, Callable[[str], dict[str, Any]], sp.Symbol | None]] = [
        ("pendulum", "euler-lagrange", pendulum, "m*l**2*theta_ddot + m*g*l*sin(theta)",
         lambda a: {"claim": [a]}, theta_dd),
        ("hoop", "euler-lagrange", hoop, "theta_ddot - omega**2*sin(theta)*cos(theta) + g/R*sin(theta)",
         lambda a: {"claim": [a]}, theta_dd),
        ("kepler-H", "legendre-hamiltonian", {**kepler, "p": ["p_r", "p_phi"]}, energy, lambda a: {"H": a}, None),
        ("bracket", "poisson-bracket", phase, "3*p**2*q**2*sin(q) + p**2*q**3*cos(q)",
         lambda a: {"pairs": [{"f": "q**3*p**2*sin(q)", "g": "p", "value": a}]}, None),
        ("energy", "constant-of-motion", {"q": ["r", "phi"], "p": ["p_r", "p_phi"], "H": energy,
         "parameters": used("m", "k", "r")}, energy, lambda a: {"I": a}, None),
        ("action", "canonicity", phase, "(p**2 + m**2*omega**2*q**2)/(2*m*omega)",
         lambda a: {"Q": ["atan(m*omega*q/p)"], "P": [a]}, None),
        ("F1", "generating-F1", {**phase, "new_q": ["Q"], "new_p": ["P"], "map": {"Q": ["atan(m*omega*q/p)"],
         "P": ["(p**2 + m**2*omega**2*q**2)/(2*m*omega)"]}}, "m*omega*q**2*cot(Q)/2", lambda a: {"F": a}, None),
        ("routhian", "routhian", {**kepler, "cyclic": ["phi"], "momenta": ["p_phi"], "convention": "L-pq"},
         "m*r_dot**2/2 - p_phi**2/(2*m*r**2) + k/r", lambda a: {"R": a}, None),
        ("lie", "lie-bracket", {"x": ["x", "y"], "X": ["-y", "x"], "Y": ["x**2*y", "sin(x)"]},
         "-2*x*y**2 + x**3 + sin(x)",
         lambda a: {"claim": [a, "-y*cos(x) - x**2*y"]}, None),
        ("friction", "dissipative", {"q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2", "F": "c*x_dot**4/4",
         "parameters": used("m", "k", "c")}, "-c*x_dot**4", lambda a: {"energy_rate": a}, None),
    ]  # fmt: skip
    return [Exercise(name, {"kind": kind, **claim}, parse(answer), filled, motion)
            for name, kind, claim, answer, filled, motion in rows]  # fmt: skip


def shuffled(f: sp.Expr, chance: random.Random) -> str:
    """Spell an expression with its terms and factors in any order."""
    if isinstance(f, sp.Add | sp.Mul):
        parts = [shuffled(a, chance) for a in f.args]
        chance.shuffle(parts)
        if isinstance(f, sp.Add):
            return " + ".join(parts)
        return "*".join(f"({part})" if " " in part or part.startswith("-") else part for part in parts)
    if isinstance(f, sp.Pow):
        base, exponent = (shuffled(a, chance) for a in f.args)
        return f"({base})**({exponent})"
    if f.args and not f.is_number:
        return f"{f.func.__name__}({', '.join(shuffled(a, chance) for a in f.args)})"
    return f"({f})" if f.is_Rational and (f.q != 1 or f < 0) else str(f)


def forms(f: sp.Expr, chance: random.Random) -> Iterator[str]:
    """Yield ways in which people write the same thing, the most usual ones first."""
    yield from (str(f), str(sp.expand(f)), str(sp.factor(f)), str(sp.together(f)))
    yield f"${sp.latex(sp.expand(f), symbol_names=LATEX)}$"
    yield f"${sp.latex(sp.together(f), symbol_names=LATEX)}$"
    x, theta, Q = S["x"], S["theta"], S["Q"]
    for old, new in ((sp.sin(theta) * sp.cos(theta), sp.sin(2 * theta) / 2), (sp.cot(Q), sp.cos(Q) / sp.sin(Q)),
                     (sp.sin(x), 2 * sp.sin(x / 2) * sp.cos(x / 2))):  # fmt: skip
        if f.has(old):
            yield str(f.subs(old, new))
    while True:
        yield shuffled(chance.choice((f, sp.expand(f), sp.factor(f))), chance)


def slip(f: sp.Expr, chance: random.Random) -> sp.Expr:
    """Return what comes of a typical slip: a sign, a half, a function, an exponent, a factor, a lost term."""
    terms = list(sp.Add.make_args(sp.expand(f)))
    place = chance.randrange(len(terms))
    kind = chance.choice(("sign", "half", "twice", "function", "power", "factor", "lost"))
    term = terms[place]
    if kind in ("sign", "half", "twice"):
        terms[place] = {"sign": -1, "half": sp.Rational(1, 2), "twice": 2}[kind] * term
    elif kind == "function":
        terms[place] = term.subs({sp.sin: sp.cos}) if term.has(sp.sin) else term.replace(sp.cos, sp.sin)
    elif kind == "power":
        powers = [p for p in sp.Mul.make_args(term) if p.is_Pow and p.base.is_Symbol]
        terms[place] = term * chance.choice(powers).base if powers else -term
    elif kind == "factor":
        terms[place] = term * chance.choice(sorted(f.free_symbols, key=str))
    elif len(terms) > 1:
        del terms[place]
    return sp.Add(*terms)


def mistyped(text: str, chance: random.Random) -> str:
    place = chance.randrange(len(text))
    return chance.choice(
        (text[:place] + ")" + text[place:], text + "*", text.replace("*", "*/", 1), f"{text} + zeta")
    )


def is_right(exercise: Exercise, f: sp.Expr) -> bool:
    """Whether an answer is right, by its values at random points, in 30 digits."""

    def essence(g: sp.Expr) -> sp.Expr:
        a = exercise.motion
        return g if a is None else -g.subs(a, 0) / g.diff(a) if g.has(a) else sp.oo

    difference = essence(f) - essence(exercise.answer)
    chance = random.Random(1)
    point = {s: sp.Rational(chance.randrange(10, 40), 17) for s in S.values()}
    if exercise.name in (
        "energy",
        "action",
        "lie",
    ):  # functions of constants, and what generates the same map
        difference = f - exercise.answer
    return bool(abs(sp.N(difference.subs(point), 30)) < 1e-20)


def homework(students: int, chance: random.Random) -> Iterator[tuple[dict[str, Any], list[str]]]:
    """Yield a sheet of each student, and what every verdict should be; empty where either will do."""
    asked = exercises()
    for student in range(students):
        claims, truths = [], []
        for exercise in asked:
            luck = chance.random()
            answer = exercise.answer if luck < RIGHT else slip(exercise.answer, chance)
            ways = forms(answer, chance)
            text = next(ways)
            for _ in range(min(int(chance.expovariate(0.35)), 12)):  # most people write it as everybody does
                text = next(ways)
            truth = "holds" if is_right(exercise, answer) else "fails"
            if exercise.name == "energy" and truth == "fails":
                truth = ""  # twice the energy is a constant too
            if luck >= RIGHT + WRONG:
                text, truth = mistyped(text, chance), "invalid" if "$" not in text else ""
            claims.append({"id": f"{exercise.name}", **exercise.claim, **exercise.filled(text)})
            truths.append(truth)
        yield {"title": f"student {student:03d}", "claims": claims}, truths


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--students", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=2026)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        names, truths, said = [], [], set()
        for number, (sheet, expected) in enumerate(
            homework(arguments.students, random.Random(arguments.seed))
        ):
            path = Path(folder) / f"{number:03d}.json"
            path.write_text(json.dumps(sheet), "utf-8")
            names.append(str(path))
            truths += [
                (number, claim["id"], truth, claim)
                for claim, truth in zip(sheet["claims"], expected, strict=True)
            ]
            said |= {json.dumps(claim, sort_keys=True) for claim in sheet["claims"]}
        start = time.monotonic()
        command = [
            sys.executable,
            "-m",
            "canon.cli",
            "check",
            "--json",
            "--jobs",
            str(arguments.jobs),
            *names,
        ]
        done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", check=False,
                              cwd=Path(__file__).parents[1])  # fmt: skip
        seconds = time.monotonic() - start
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(told) == len(truths), done.stderr
    counts = Counter(judgement["status"] for judgement in told)
    print(
        f"{arguments.students} students, {len(told)} claims, {len(said)} different ones, {arguments.jobs} processes"
    )
    print(f"{seconds:.0f} s in all, {1000 * seconds / len(said):.0f} ms for each different claim")
    print(", ".join(f"{counts[status]} {status}" for status in ("holds", "fails", "undecided", "invalid")))
    wrong = [(truth, judgement, claim) for (_, _, truth, claim), judgement in zip(truths, told, strict=True)
             if truth and judgement["status"] not in (truth, "undecided")]  # fmt: skip
    print(f"verdicts that differ from the truth found by evaluation: {len(wrong)}")
    for truth, judgement, claim in wrong[:10]:
        print(f"  {judgement['id']}: {judgement['status']}, should be {truth}: {claim} {judgement['known']}")
    fails = [judgement for judgement in told if judgement["status"] == "fails"]
    explained = sum(bool(judgement["feedback"]) for judgement in fails)
    print(
        f"wrong answers with feedback: {explained} of {len(fails)}; "
        f"slowest claim {max(judgement['seconds'] for judgement in told):.1f} s"
    )


if __name__ == "__main__":
    main()
