"""Normal forms: canon's exact arithmetic on FLINT beside the same algorithm with SymPy's polynomials, in one run.

    python benchmarks/normal_forms.py            # orders 8, 16, 24; SymPy to 8; L1 to degree 12; 10⁵ terms
    python benchmarks/normal_forms.py --large    # and order 32; L1 to degree 16
    python benchmarks/normal_forms.py --hiten ENV/bin/python    # beside HITEN, from an environment that has it
    python benchmarks/normal_forms.py --celmech ENV/bin/python  # beside celmech's birkhoff_normalize, likewise

The Hénon–Heiles system, exactly over ℚ; the centre manifold of L1 in balls.
Seconds are of the processor; ratios within one run are what can be compared.
"""

from __future__ import annotations

import argparse
import random
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import sympy as sp

sys.path.insert(0, str(Path(__file__).parents[1]))
from canon import Hamiltonian, birkhoff_normal_form
from canon.mechanics import centre_manifold
from canon.mechanics.perturbation.lie_transform import Brackets
from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial, PolynomialRing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from canon.mechanics import CentreManifold

x, y, px, py = sp.symbols("x y p_x p_y", real=True)
HENON_HEILES = Hamiltonian((px**2 + py**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py])
EARTH_MOON = sp.Rational("0.0121505856")
Z = sp.symbols("z1 z2 zbar1 zbar2")


def seconds(work: Callable[[], object], repeats: int) -> float:
    best = float("inf")
    for _ in range(repeats):
        started = time.process_time()
        work()
        best = min(best, time.process_time() - started)
    return best


def by_sympy(order: int) -> dict[int, sp.Poly]:
    """The same steps on SymPy's sparse polynomials over ℚ(i)."""
    ring = {"gens": Z, "domain": "QQ_I"}
    z1, z2, w1, w2 = Z
    a, b = (z1 + w1) / 2, (z2 + w2) / 2
    parts = {2: sp.Poly((z1 * w1 + z2 * w2) / 2, **ring), 3: sp.Poly(a**2 * b - b**3 / 3, **ring)}
    for degree in range(3, order + 1):
        if degree not in parts:
            continue
        chi = {}
        for powers, c in parts[degree].terms():
            k = powers[0] + powers[1] - powers[2] - powers[3]
            if k:
                chi[powers] = c / (-sp.I * k)
        if chi:
            parts = transformed(parts, sp.Poly(chi, **ring), degree, order)
    return parts


def transformed(parts: dict[int, sp.Poly], chi: sp.Poly, degree: int, order: int) -> dict[int, sp.Poly]:
    found = dict(parts)
    for start, part in parts.items():
        term, at, k = part, start, 1
        while at + degree - 2 <= order:
            brackets = [
                term.diff(Z[j]) * chi.diff(Z[2 + j]) - term.diff(Z[2 + j]) * chi.diff(Z[j]) for j in (0, 1)
            ]
            term = (brackets[0] + brackets[1]) * sp.Poly(-2 * sp.I / k, *Z, domain="QQ_I")
            at, k = at + degree - 2, k + 1
            found[at] = found[at] + term if at in found else term
    return {d: f for d, f in found.items() if not f.is_zero}


def at_l1(order: int, mass: sp.Expr = EARTH_MOON) -> CentreManifold:
    """The centre manifold of the point between Earth and Moon, every coefficient to 15 certain digits."""
    z, pz, mu = sp.symbols("z p_z mu", real=True)
    to_earth, to_moon = (sp.sqrt((x + s) ** 2 + y**2 + z**2) for s in (mu, mu - 1))
    kinetic = (px**2 + py**2 + pz**2) / 2 + y * px - x * py
    H = Hamiltonian(kinetic - (1 - mu) / to_earth - mu / to_moon, [x, y, z], [px, py, pz])
    return centre_manifold(H, order, at={x: 0.83, py: 0.83}, parameters={mu: mass})


IN_HITEN = """
import sys, time
from hiten import System

def manifold(degree):
    point = System.from_bodies("earth", "moon").get_libration_point(1)
    started = time.process_time()
    found = point.get_center_manifold(degree=degree)
    found.compute()
    return point, found, time.process_time() - started

if sys.argv[2] == "compiled":
    manifold(4)
point, found, seconds = manifold(int(sys.argv[1]))
print("OF HITEN", repr(float(point.mu)), repr(float(point.gamma)), seconds)
print(found.coefficients())
"""
HITENS_TERM = re.compile(r"\b0\s+0\s+(\d+)\s+(\d+)\s+(\d+)\s+(\d+)\s+(-?\d\.\d+e[-+]\d+)")


def of_hiten(python: str, order: int, state: str) -> tuple[float, float, float, list[tuple[str, ...]]]:
    """Mass, gamma, seconds and terms of HITEN in a process of its own.

    "compiled" is timed after one of degree 4 in the same process, of another System: Numba has compiled all by then.
    """
    done = subprocess.run(
        [python, "-c", IN_HITEN, str(order), state], capture_output=True, text=True, check=True
    )
    mass, gamma, spent = map(float, done.stdout.split("OF HITEN ")[1].split()[:3])
    return mass, gamma, spent, HITENS_TERM.findall(done.stdout)


def beside_hiten(python: str, order: int) -> str:
    """A row: seconds of both for the same manifold, and how far their coefficients differ.

    HITEN measures lengths in distances γ of the point from the Moon and turns each elliptic pair by an angle, so that
    its terms of degree d are ours times γ^(d−2), with Q = −p, P = q in the plane.
    """
    first = of_hiten(python, order, "with compiling")[2]
    mass, gamma, theirs, terms = of_hiten(python, order, "compiled")
    at_l1(4, sp.Rational(mass))
    started = time.process_time()
    found = at_l1(order, sp.Rational(mass))
    ours = time.process_time() - started
    (Q1, Q2), (P1, P2) = found.q, found.p
    q2, p2 = sp.symbols("q2 p2", real=True)
    turned = sp.Poly(found.hamiltonian.H.subs({Q1: -p2, P1: q2}, simultaneous=True), q2, p2, Q2, P2)
    gaps = [
        abs(
            float(turned.coeff_monomial(tuple(map(int, powers)))) * gamma ** (sum(map(int, powers)) - 2)
            - float(c)
        )
        for *powers, c in terms
    ]
    largest = max(abs(float(c)) for *_, c in terms)
    spent = f"{ours:.2f} | {theirs:.2f} | {theirs / ours:.1f} | {first:.1f}"
    return f"| {order} | {spent} | {len(terms)} | {max(gaps) / largest:.0e} |"


SAME_FORM = 8
IN_CELMECH = """
import math, sys, time
from itertools import product
from celmech.poisson_series import PoissonSeries, PSTerm, birkhoff_normalize

def series(terms):
    return PoissonSeries.from_PSTerms([PSTerm(c, k, l, [], []) for c, k, l in terms], N=2, M=0)

def power(choices, each):
    for signs in product((0, 1), repeat=len(choices)):
        k, l = [0, 0], [0, 0]
        for j, barred in zip(choices, signs):
            (l if barred else k)[j] += 1
        yield each / math.sqrt(8), k, l

order = int(sys.argv[1])
H = {degree: PoissonSeries(2, 0) for degree in range(2, order + 1)}
H[2] = series([(1.0, [1, 0], [1, 0]), (1.0, [0, 1], [0, 1])])
for term in (*power((0, 0, 1), 1.0), *power((1, 1, 1), -1 / 3)):
    H[3] = H[3] + series([term])
started = time.process_time()
_, found = birkhoff_normalize([1.0, 1.0], H, order, kres=[[1, -1]])
print("OF CELMECH", time.process_time() - started)
for part in found.values():
    for term in part.terms:
        print("TERM", *term.k, *term.kbar, repr(complex(term.C)))
"""


def beside_celmech(python: str, order: int) -> str:
    """A row: seconds of both for the normal form of Hénon and Heiles' system, and how far coefficients differ.

    celmech takes doubles and x = (q + i p)/√2, so that its terms of degree d are canon's times 2^(d/2). Its
    transformation is one exponential and canon's a product: resonant normal forms of the two are equal to some degree,
    here 8 (canon's as one exponential has a part that commutes with H₂ from degree 8: hori_generator). Coefficients
    are compared to that degree.
    """
    done = subprocess.run([python, "-c", IN_CELMECH, str(order)], capture_output=True, text=True, check=True)
    theirs = float(done.stdout.split("OF CELMECH ")[1].split()[0])
    terms = {
        tuple(map(int, words[1:5])): complex(words[5])
        for words in map(str.split, done.stdout.splitlines())
        if words[0] == "TERM"
    }
    ours = seconds(lambda: birkhoff_normal_form(HENON_HEILES, order), 3)
    form = birkhoff_normal_form(HENON_HEILES, order)
    exact = {k: float(c) * 2 ** (sum(k) / 2) for k, c in sp.Poly(form.K, *form.complex_variables).terms()}
    gap = max(abs(exact.get(k, 0) - terms.get(k, 0)) for k in exact | terms if sum(k) <= SAME_FORM)
    gap /= max(abs(c) for k, c in exact.items() if sum(k) <= SAME_FORM)
    return f"| {order} | {ours:.3f} | {theirs:.2f} | {theirs / ours:.0f} | {len(exact)} | {gap:.0e} |"


def long_bracket(partner: int) -> tuple[int, int, float]:
    """Terms of a dense polynomial in three degrees of freedom, terms of its bracket with a short one, and seconds."""
    chance, ring = random.Random(1), PolynomialRing(6)
    monomials = [powers for degree in range(18) for powers in exponents(degree, 6)]
    cubic = [powers for powers in monomials if sum(powers) in (3, 4)]

    def series(among: list[tuple[int, ...]]) -> PhasePolynomial:
        numbers = {
            (*powers, 0): chance.randint(1, 99) * 24 // chance.choice((1, 2, 3, 8)) for powers in among
        }
        return ring.real(ring.context.from_dict(numbers), ring.context.constant(24))

    f, g, bracket = series(monomials), series(chance.sample(cubic, partner)), Brackets((ring.one,) * 3)
    found = bracket(f, g)
    return len(f), len(found), seconds(lambda: bracket(f, g), 3)


def exponents(degree: int, count: int) -> Iterator[tuple[int, ...]]:
    """Yield the exponents of all monomials of one degree."""
    if count == 1:
        yield (degree,)
        return
    for first in range(degree + 1):
        for rest in exponents(degree - first, count - 1):
            yield first, *rest


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--large", action="store_true", help="order 32 too")
    parser.add_argument("--hiten", metavar="PYTHON", help="an interpreter that has HITEN")
    parser.add_argument("--celmech", metavar="PYTHON", help="an interpreter that has celmech")
    chosen = parser.parse_args()
    if chosen.celmech:
        print(
            "| degree | canon, exact, s | celmech, doubles, s | ratio | terms | "
            "largest difference to degree 8, of the largest |\n|---|---|---|---|---|---|"
        )
        for order in (6, 8, 10, *([12] if chosen.large else [])):
            print(beside_celmech(chosen.celmech, order), flush=True)
        return
    if chosen.hiten:
        print(
            "| degree | canon, s | HITEN compiled, s | ratio | HITEN with compiling, s | terms | "
            "largest difference, of the largest |\n|---|---|---|---|---|---|---|"
        )
        for order in (6, 8, *([10] if chosen.large else [])):
            print(beside_hiten(chosen.hiten, order))
        return
    canons = birkhoff_normal_form(HENON_HEILES, 8)
    assert sp.expand(sum(f.as_expr() for f in by_sympy(8).values()) - canons.K) == 0, "the two disagree"
    print("| order | canon, s | the same steps with SymPy's Poly, s | ratio |\n|---|---|---|---|")
    for order in (8, 16, 24, *([32] if chosen.large else [])):
        ours = seconds(lambda order=order: birkhoff_normal_form(HENON_HEILES, order), 3 if order < 32 else 1)
        if order > 8:
            print(f"| {order} | {ours:.3f} | – | – |")
            continue
        theirs = seconds(lambda order=order: by_sympy(order), 1)
        print(f"| {order} | {ours:.3f} | {theirs:.2f} | {theirs / ours:.0f} |")
    print(
        "\n| centre manifold of L1, Earth and Moon, degree | canon, s | largest error of a coefficient |\n|---|---|---|"
    )
    for order in (6, 10, 12, *([16] if chosen.large else [])):
        started = time.process_time()
        found = at_l1(order)
        print(f"| {order} | {time.process_time() - started:.2f} | {found.error:.0e} |")
    print(
        "\n| terms of a series | bracketed with a series of | terms of the bracket | canon, s |\n|---|---|---|---|"
    )
    for partner in (10, 100):
        terms, found, spent = long_bracket(partner)
        print(f"| {terms} | {partner} | {found} | {spent:.2f} |")


if __name__ == "__main__":
    main()
