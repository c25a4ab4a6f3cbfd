"""Splittings of H = A + εB by exactly solvable parts: schemes for small ε, and symplectic correctors.

Here a scheme's a are the times of A's flow and its b those of B's. Errors are counted by powers of ε: a scheme
of orders (n₁, n₂, …) errs by ε τ^n₁ + ε² τ^n₂ + …. SABA and SBAB schemes are the quadrature formulas of Gauss and
of Lobatto; what is linear in ε is all they care for, ε² τ² remains. Kicks by B together with the commutator
{B, {A, B}}, where that is a function of q alone, take this away too: SABAC, SBABC, and Wisdom and Holman's map with
the modified kick.

Sources: J. Laskar, P. Robutel, High order symplectic integrators for perturbed Hamiltonian systems, Celest. Mech.
Dyn. Astron. 80 (2001) 39–62, doi:10.1023/A:1012098603882; J. Wisdom, M. Holman, J. Touma, Symplectic correctors,
Fields Inst. Commun. 10 (1996) 217–244; H. Rein, D. Tamayo, G. Brown, High order symplectic integrators for planetary
dynamics and their implementation in REBOUND, Mon. Not. R. Astron. Soc. 489 (2019) 4632–4640, doi:10.1093/mnras/stz2503.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.schemes.gauss_tableau import gauss_tableau
from canon.kernel.schemes.splitting_schemes import Scheme, palindrome

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "ABA",
    "HIGHEST_CORRECTOR",
    "LASKAR_ROBUTEL",
    "Corrector",
    "corrector",
    "saba",
    "sbab",
    "wisdom_holman",
    "with_commutator",
]

HIGHEST_STAGES = 8
HIGHEST_CORRECTOR = 17

LASKAR_ROBUTEL = (
    "J. Laskar, P. Robutel, High order symplectic integrators for perturbed Hamiltonian systems, Celest. Mech. Dyn. "
    "Astron. 80 (2001) 39–62, doi:10.1023/A:1012098603882"
)


def wisdom_holman() -> Scheme:
    """Return Wisdom and Holman's map: A for half a step, B for one, A for half a step."""
    citation = (
        "J. Wisdom, M. Holman, Symplectic maps for the N-body problem, Astron. J. 102 (1991) 1528–1538, "
        "doi:10.1086/115978"
    )
    return Scheme("wisdom-holman", 2, (Fraction(1, 2),) * 2, (Fraction(1),), citation)


@functools.cache
def saba(stages: int) -> Scheme:
    """Return SABA_n: kicks at the n nodes of Gauss's quadrature, errors ε τ^2n + ε² τ².

    Examples
    --------
    >>> [float(b) for b in saba(2).b]
    [0.5, 0.5]
    """
    tableau = gauss_tableau(_stages(stages, "SABA"))
    nodes = [Fraction(0), *tableau.c, Fraction(1)]
    a = [right - left for left, right in itertools.pairwise(nodes)]
    b = list(tableau.b)
    return Scheme(f"saba-{stages}", 2, _symmetric(a), _symmetric(b), LASKAR_ROBUTEL)


@functools.cache
def sbab(stages: int) -> Scheme:
    """Return SBAB_n: kicks at the n + 1 nodes of Lobatto's quadrature, errors ε τ^2n + ε² τ².

    Examples
    --------
    >>> [float(b) for b in sbab(1).b]
    [0.5, 0.5]
    """
    nodes = _lobatto_nodes(_stages(stages, "SBAB"))
    a = [Fraction(0), *(right - left for left, right in itertools.pairwise(nodes)), Fraction(0)]
    moments = [Fraction(1, k + 1) for k in range(stages + 1)]
    b = _solve([[node**k for node in nodes] for k in range(stages + 1)], moments)
    return Scheme(f"sbab-{stages}", 2, _symmetric(a), _symmetric(b), LASKAR_ROBUTEL)


def _stages(stages: int, family: str) -> int:
    if stages not in range(1, HIGHEST_STAGES + 1):
        raise ValueError(f"{family}({stages}): the number of stages is 1 … {HIGHEST_STAGES}")
    return stages


_BLANES = (
    "S. Blanes, F. Casas, A. Farrés, J. Laskar, J. Makazaga, A. Murua, New families of symplectic splitting "
    "methods for numerical integration in dynamical astronomy, "
    "Appl. Numer. Math. 68 (2013) 58–72, doi:10.1016/j.apnum.2013.01.003"
)

ABA = {
    "8-6-4": palindrome(
        "aba-8-6-4",
        4,
        (
            "0.0711334264982231177779387300061549964174022959237396067",
            "0.2411534279566400987364877953262896496178146780493351793",
            "0.5214117617728147892121360780679942299914364788502635428",
        ),
        (
            "0.1830836874721972219617037571664302910726241265515976168",
            "0.3107828598985748695075222910542627963751573211162577268",
            "-0.0265646185119588006972121379164987592663297728525475852",
        ),
        _BLANES,
        odd="b",
    ),
    "10-6-4": palindrome(
        "aba-10-6-4",
        4,
        (
            "0.0380944974224121954569753223086375653406600603958069702",
            "0.1452987161169137492940200726606637497443088851461260237",
            "0.2076276957255412507162056113249882065158369684461609151",
            "0.4359097036515261592231548624010651844006887964943272550",
        ),
        (
            "0.0958588808370752106107715037714588477693422260407147003",
            "0.2044461531429987806805077839164344779763299586173710678",
            "0.2170703479789911017143385924306336714529759820421083216",
        ),
        _BLANES,
        odd="a",
    ),
}
"""Schemes that take ε² τ² away too, named by their orders in ε, ε² and ε³.

The digits beyond those published are by Newton's method on the order conditions.
"""

_DIGITS = 60


def _symmetric(values: Sequence[Fraction]) -> tuple[Fraction, ...]:
    """Round to 60 digits, the same from both ends and with the sum 1."""
    half = [Fraction(round(x * 10**_DIGITS), 10**_DIGITS) for x in values[: len(values) // 2]]
    if len(values) % 2:
        return (*half, 1 - 2 * sum(half, Fraction(0)), *reversed(half))
    half[-1] = Fraction(1, 2) - sum(half[:-1])
    return (*half, *reversed(half))


def _lobatto_nodes(stages: int) -> list[Fraction]:
    """Return 0, the zeros of P_n'(2c − 1), 1."""
    import sympy as sp
    from mpmath import MPContext

    context = MPContext()
    context.dps = 80
    x = sp.Symbol("x")
    coefficients = sp.Poly(sp.diff(sp.legendre(stages, x), x), x).all_coeffs()
    zeros = (
        context.polyroots([context.mpf(c.p) / c.q for c in coefficients], maxsteps=200) if stages > 1 else []
    )
    inner = sorted((1 + context.re(zero)) / 2 for zero in zeros)
    scale = context.mpf(10) ** 75
    return [Fraction(0), *(Fraction(int(context.nint(c * scale)), 10**75) for c in inner), Fraction(1)]


def _solve(rows: Sequence[Sequence[Fraction]], right: Sequence[Fraction]) -> list[Fraction]:
    """Solve a small linear system in exact numbers."""
    table = [[*row, value] for row, value in zip(rows, right, strict=True)]
    n = len(table)
    for k in range(n):
        pivot = next(i for i in range(k, n) if table[i][k])
        table[k], table[pivot] = table[pivot], table[k]
        table[k] = [x / table[k][k] for x in table[k]]
        for i in range(n):
            if i != k and table[i][k]:
                table[i] = [x - table[i][k] * y for x, y in zip(table[i], table[k], strict=True)]
    return [row[-1] for row in table]


# commutators -----------------------------------------------------------------------------------------


def with_commutator(scheme: Scheme, *, corrected: bool = False) -> Scheme:
    """Return a scheme whose kicks hold the commutator {B, {A, B}}, so that ε² τ² becomes ε² τ⁴.

    The scheme's logarithm is A + εB − κ [B, [A, B]] + …, κ = 1/12 − ½ Σ_{i<j} b_i b_j (c_j − c_i), c_i the time of A
    before the kick b_i; a corrector that takes λ [A, [A, B]] away adds −λ [B, [A, B]] to it. Schemes that start and end
    with B, and those of one kick, have the weight κ + λ in these; others get kicks by the commutator alone at
    both ends.

    Parameters
    ----------
    scheme
        A symmetric scheme.
    corrected
        Whether a corrector goes with it.

    Examples
    --------
    >>> with_commutator(saba(1)).commutators, with_commutator(sbab(1)).commutators
    ((Fraction(1, 12),), (Fraction(-1, 48), Fraction(-1, 48)))
    >>> with_commutator(wisdom_holman(), corrected=True).commutators  # Rowlands; Wisdom, Holman and Touma
    (Fraction(1, 24),)
    """
    places, c = list[Fraction](), Fraction(0)
    for a in scheme.a[:-1]:
        c += a
        places.append(c)
    kicks = list(zip(scheme.b, places, strict=True))
    crossed = sum((p * q * (d - c) for (p, c), (q, d) in itertools.combinations(kicks, 2)), Fraction(0))
    weight = Fraction(1, 12) - crossed / 2 + (_generator(scheme, 1)[1] if corrected else 0)
    if len(kicks) == 1:
        return dataclasses.replace(scheme, commutators=(weight,))
    inner = (Fraction(0),) * (len(kicks) - 2)
    if scheme.kick_first:
        return dataclasses.replace(scheme, commutators=(weight / 2, *inner, weight / 2))
    none = Fraction(0)
    return dataclasses.replace(
        scheme,
        a=(none, *scheme.a, none),
        b=(none, *scheme.b, none),
        commutators=(weight / 2, none, none, *inner, weight / 2),
    )


# correctors ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Corrector:
    """A change of variables C that takes most of ε τ^n off a scheme: C⁻¹ ∘ step ∘ C, C only at the ends.

    C is the composition of exp(a_k A) exp(b_k B) exp(−2a_k A) exp(−b_k B) exp(a_k A), all times h, k = 1 … 2m, the
    later half being the earlier one mirrored with a and b negative: its logarithm is odd in h up to ε².

    Parameters
    ----------
    a, b
        The coefficients.
    order
        What remains linear in ε is of this order less one, counted in the energy: ε τ^(order).
    """

    a: tuple[Fraction, ...]
    b: tuple[Fraction, ...]
    order: int

    def pairs(self, *, inverse: bool) -> list[tuple[Fraction, Fraction]]:
        """Return (b, a) of B's and A's flows in the order of use, multiples of h; some are 0."""
        flows = list[tuple[str, Fraction]]()
        for a, b in zip(self.a, self.b, strict=True):
            flows += [("a", a), ("b", b), ("a", -2 * a), ("b", -b), ("a", a)]
        if inverse:
            flows = [(which, -time) for which, time in reversed(flows)]
        found = [(Fraction(0), Fraction(0))]
        for which, time in flows:
            b, a = found[-1]
            if which == "a":
                found[-1] = b, a + time
            else:
                found.append((time, Fraction(0)))
        return found


_ALPHA = Fraction("0.418330013267037777299001103648179443203398213310105872170598")
"""√(7/40), Wisdom, Holman and Touma's choice of a₁ = −a₂ = … ."""


@functools.cache
def corrector(scheme: Scheme, order: int) -> Corrector:
    """Return the corrector of a symmetric scheme that leaves ε τ^(order + 1).

    With x = h ad_A the scheme's logarithm is A + ε L(x) B, L(x) = (x/2)/sinh(x/2) · Σ b_i exp((c_i − ½)x), where c_i is
    the time of A before the kick b_i. The change of variables exp(ε g(x) B) takes away x g(x) = L(x) − 1; the terms
    of the composition add up to g(x) = −4 Σ b_k sinh(a_k x), a_k = kα, which fixes the b_k.

    Parameters
    ----------
    scheme
        The scheme.
    order
        3, 5, 7, 11 or 17; any odd number from 3 to 17.

    Raises
    ------
    ValueError
        The order is not one of those.
    """
    if order % 2 == 0 or not 3 <= order <= HIGHEST_CORRECTOR:
        raise ValueError(f"corrector={order}: correctors have odd orders from 3 to {HIGHEST_CORRECTOR}")
    stages = (order - 1) // 2
    target = _generator(scheme, 2 * stages)
    places = [k * _ALPHA for k in range(1, stages + 1)]
    rows = [[4 * place**n / math.factorial(n) for place in places] for n in range(1, 2 * stages, 2)]
    weights = _solve(rows, [target[n] for n in range(1, 2 * stages, 2)])
    a, b = [*reversed(places)], [*reversed(weights)]
    return Corrector((*a, *(-x for x in reversed(a))), (*b, *(-x for x in reversed(b))), order)


def _generator(scheme: Scheme, length: int) -> list[Fraction]:
    """Return the power series of (L(x) − 1)/x up to x^length."""
    count = length + 3
    kicks, c = [Fraction(0)] * count, Fraction(0)
    for a, b in zip(scheme.a, scheme.b, strict=False):
        c += a
        for n in range(count):
            kicks[n] += b * (c - Fraction(1, 2)) ** n / math.factorial(n)
    # The series of sinh(x/2)/(x/2).
    sinh = [Fraction(0) if n % 2 else Fraction(1, 2**n * math.factorial(n + 1)) for n in range(count)]
    quotient = list[Fraction]()
    for n in range(count):
        quotient.append(kicks[n] - sum((quotient[k] * sinh[n - k] for k in range(n)), Fraction(0)))
    return quotient[1 : length + 2]
