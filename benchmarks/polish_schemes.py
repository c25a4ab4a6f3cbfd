"""Continue published splitting coefficients to 55 digits: Newton's method on the order conditions.

Most methods have free parameters, so that the conditions leave a family of solutions; each step is the shortest one
(Gauss–Newton with the pseudoinverse), which ends next to the published point. The table in
``canon/kernel/schemes/splitting_schemes.py`` is this script's output; ``--check`` compares the two.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import mpmath
import numpy as np
from mpmath import mp, mpf

from canon.kernel.schemes.order_conditions import conditions
from canon.kernel.schemes.splitting_schemes import SCHEMES

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

DIGITS = 55
WORKING_DIGITS = 130

Coefficients = tuple[list[mpf], list[mpf]]


def composition(x: Sequence[mpf]) -> Coefficients:
    """Verlet steps of lengths x and, after the last of these, which is the middle one, back again."""
    w = [*x, *reversed(x[:-1])]
    return [w[0] / 2, *((u + v) / 2 for u, v in itertools.pairwise(w)), w[-1] / 2], w


def palindrome(drifts: int, *, kick_first: bool = False) -> Callable[[Sequence[mpf]], Coefficients]:
    """So many drifts and the rest kicks, each the first half but for the middle that follows from Σ = 1."""

    def complete(x: Sequence[mpf]) -> Coefficients:
        a, b = list(x[:drifts]), list(x[drifts:])
        a = [mpf(0), *a] if kick_first else a
        b = [*b, mpf(1) / 2 - sum(b)]
        return [*a, 1 - 2 * sum(a), *reversed(a)], [*b, *reversed(b)]

    return complete


@dataclass(frozen=True)
class Published:
    """A method as printed: its unknowns and how they make up the coefficients."""

    name: str
    complete: Callable[[Sequence[mpf]], Coefficients]
    digits: str


PUBLISHED = (
    Published(
        "blanes-moan-4",
        palindrome(3),
        "0.0792036964311957 0.353172906049774 -0.0420650803577195 0.209515106613362 -0.143851773179818",
    ),
    Published(
        "blanes-moan-6",
        palindrome(5),
        "0.0502627644003922 0.413514300428344 0.0450798897943977 -0.188054853819569 0.541960678450780 "
        "0.148816447901042 -0.132385865767784 0.067307604692185 0.432666402578175",
    ),
    Published(
        "srkn-6b",
        palindrome(5, kick_first=True),
        "0.123229775946271 0.290553797799558 -0.127049212625417 -0.246331761062075 0.357208872795928 "
        "0.0414649985182624 0.198128671918067 -0.0400061921041533 0.0752539843015807 -0.0115113874206879",
    ),
    Published(
        "srkn-6a",
        palindrome(7),
        "0.0378593198406116 0.102635633102435 -0.0258678882665587 0.314241403071477 -0.130144459517415 "
        "0.106417700369543 -0.00879424312851058 0.09171915262446165 0.183983170005006 -0.05653436583288827 "
        "0.004914688774712854 0.143761127168358 0.328567693746804",
    ),
    Published(
        "kahan-li-6",
        composition,
        "0.39216144400731413927925056 0.33259913678935943859974864 -0.70624617255763935980996482 "
        "0.08221359629355080023149045 0.79854399093482996339895035",
    ),
    Published(
        "kahan-li-8",
        composition,
        "0.13020248308889008087881763 0.56116298177510838456196441 -0.38947496264484728640807860 "
        "0.15884190655515560089621075 -0.39590389413323757733623154 0.18453964097831570709183254 "
        "0.25837438768632204729397911 0.29501172360931029887096624 -0.60550853383003451169892108",
    ),
    Published(
        "sofroniou-spaletta-10",
        composition,
        "0.07879572252168641926390768 0.31309610341510852776481247 0.02791838323507806610952027 "
        "-0.22959284159390709415121340 0.13096206107716486317465686 -0.26973340565451071434460973 "
        "0.07497334315589143566613711 0.11199342399981020488957508 0.36613344954622675119314812 "
        "-0.39910563013603589787862981 0.10308739852747107731580277 0.41143087395589023782070412 "
        "-0.00486636058313526176219566 -0.39203335370863990644808194 0.05194250296244964703718290 "
        "0.05066509075992449633587434 0.04967437063972987905456880 0.04931773575959453791768001",
    ),
)


def polished(method: Published) -> Coefficients:
    """Return the coefficients that fulfil the order conditions next to the published ones."""
    scheme = SCHEMES[method.name]

    def residual(x: Sequence[mpf]) -> np.ndarray:
        a, b = method.complete(x)
        return np.concatenate(conditions(a, b, scheme.order, nystrom=scheme.nystrom))

    x = np.array([mpf(digits) for digits in method.digits.split()])
    for _ in range(8):
        r = residual(x)
        if max(abs(r)) < mpf(10) ** -(WORKING_DIGITS - 30):
            return method.complete(x)
        x = x - shortest_step(slopes(residual, x, r), r)
    raise ArithmeticError(f"{method.name}: Newton's method does not converge")


def slopes(residual: Callable[[Sequence[mpf]], np.ndarray], x: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Return ∂residual/∂x by differences, good to half the working digits."""
    delta = mpf(10) ** -(WORKING_DIGITS // 2)
    unit = np.identity(len(x), dtype=int)
    return np.array([(residual(x + delta * unit[i]) - r) / delta for i in range(len(x))]).T


def shortest_step(j: np.ndarray, r: np.ndarray) -> np.ndarray:
    """Return the shortest least-squares solution of j s = r."""
    sizes, vectors = mpmath.eigsy(mpmath.matrix((j.T @ j).tolist()))
    right = j.T @ r
    basis = np.array(vectors.tolist()).reshape(len(right), len(right))
    step = 0 * right
    for k, size in enumerate(sizes):
        if size > max(sizes) * mpf(10) ** -60:
            step = step + basis[:, k] * (basis[:, k] @ right) / size
    return step


def main() -> int:
    """Print the coefficients, or compare them with the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--check", action="store_true", help="only say whether the table is what comes out here"
    )
    check, worst = parser.parse_args().check, Fraction(0)
    mp.dps = WORKING_DIGITS
    for method in PUBLISHED:
        scheme = SCHEMES[method.name]
        for letter, ours, table in zip("ab", polished(method), (scheme.a, scheme.b), strict=True):
            for x, known in zip(ours, table, strict=True):
                exact = Fraction(int(mpmath.nint(x * mpf(10) ** (DIGITS + 10))), 10 ** (DIGITS + 10))
                worst = max(worst, abs(exact - known))
                if not check:
                    print(f"{method.name} {letter} {mpmath.nstr(x, DIGITS)}")
    print(f"largest difference from the table: {float(worst):.1e}")
    return int(worst > Fraction(1, 10 ** (DIGITS - 1)))


if __name__ == "__main__":
    sys.exit(main())
