"""Williamson's form of a quadratic Hamiltonian in balls, for characteristic exponents that are all different.

As in :mod:`~canon.mechanics.perturbation.quadratic_form`, but with roots: {a, b} = 1 of a hyperbolic pair, and of an
elliptic one {z, z̄} = −2i, so that z = q + i p with {q, p} = 1. With λ the number −λ̄ is an exponent too. Where the
mirror image of the enclosure of λ meets no other enclosure, −λ̄ is in that of λ and therefore is λ: it is proved to be
imaginary. In the same way an exponent is proved to be real.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import acb, acb_mat, arb

from canon.mechanics.perturbation.enclosed.enclosed_polynomial import PrecisionError
from canon.mechanics.perturbation.quadratic_form import NoDiagonalFormError

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["EnclosedDiagonalForm", "enclosed_diagonal_form"]

Row = list[acb]


@dataclass(frozen=True)
class EnclosedDiagonalForm:
    """Variables a₁ … aₙ, b₁ … bₙ, hyperbolic pairs first, with ȧⱼ = λⱼ aⱼ, ḃⱼ = −λⱼ bⱼ to first order.

    Parameters
    ----------
    columns
        (q, p) as linear functions of (a, b), of shape (2n, 2n).
    exponents
        λ₁ … λₙ: −iω of elliptic pairs, where ω < 0 if H₂ has the action with a minus sign.
    hyperbolic
        How many pairs are hyperbolic.
    """

    columns: tuple[tuple[acb, ...], ...]
    exponents: tuple[acb, ...]
    hyperbolic: int

    @property
    def frequencies(self) -> tuple[arb, ...]:
        """ω of the elliptic pairs."""
        return tuple(-e.imag for e in self.exponents[self.hyperbolic :])


def enclosed_diagonal_form(hessian: Sequence[Sequence[arb]]) -> EnclosedDiagonalForm:
    """Return Williamson's variables of ½ x·(hessian) x.

    Raises
    ------
    NoDiagonalFormError
        Where an exponent is zero or two are equal, as far as the precision tells, or where four belong together.
    """
    n = len(hessian) // 2
    flow = acb_mat([[*hessian[n + j]] for j in range(n)] + [[-h for h in hessian[j]] for j in range(n)])
    try:
        exponents, left = flow.eig(left=True)
    except ValueError as several:
        raise NoDiagonalFormError(
            "characteristic exponents are equal, or were not told apart; balls need different ones: use "
            "birkhoff_normal_form, which is exact"
        ) from several
    rows = [[left[k, j] for j in range(2 * n)] for k in range(2 * n)]
    real, imaginary = _axes(exponents)
    pairs = [_hyperbolic(k, real, exponents, rows) for k in real if exponents[k].real > 0]
    elliptic = [_elliptic(exponents[k], rows[k]) for k in imaginary if exponents[k].imag < 0]
    pairs += sorted(elliptic, key=lambda pair: -abs(float(pair[2].imag)))
    if len(pairs) < n:
        raise NoDiagonalFormError("four exponents ±α ± iβ belong together, which is not computed in balls")
    columns = [_coordinate(k, pairs, len(real) // 2) for k in range(2 * n)]
    return EnclosedDiagonalForm(tuple(columns), tuple(e for *_, e in pairs), len(real) // 2)


def _axes(exponents: Sequence[acb]) -> tuple[list[int], list[int]]:
    """Return which exponents are proved to be real, and which imaginary."""
    real: list[int] = []
    imaginary: list[int] = []
    for k, e in enumerate(exponents):
        if e.contains(0):
            raise NoDiagonalFormError(
                "an exponent is zero as far as the precision tells: the equilibrium is not isolated, or the pair is "
                "parabolic; reduce an ignorable coordinate first"
            )
        if e.imag.contains(0) and _meets_alone(e.conjugate(), k, exponents):
            real.append(k)
        elif e.real.contains(0) and _meets_alone(-e.conjugate(), k, exponents):
            imaginary.append(k)
    return real, imaginary


def _meets_alone(image: acb, k: int, exponents: Sequence[acb]) -> bool:
    """Tell whether an image of the k-th enclosure meets no other one: what it holds is then the same exponent."""
    return not any(image.overlaps(other) for j, other in enumerate(exponents) if j != k)


def _form(a: Sequence[acb], b: Sequence[acb]) -> acb:
    """Return {a·x, b·x}."""
    n = len(a) // 2
    total = acb(0)
    for j in range(n):
        total += a[j] * b[n + j] - a[n + j] * b[j]
    return total


def _hyperbolic(
    k: int, real: Sequence[int], exponents: Sequence[acb], rows: Sequence[Row]
) -> tuple[Row, Row, acb]:
    """Return real a, b with {a, b} = 1 for λ > 0 and −λ."""
    opposite = next(j for j in real if exponents[j].overlaps(-exponents[k]))
    a, b = (_real(_with_first_one(rows[j])) for j in (k, opposite))
    c = _form(a, b).real
    if c.contains(0):
        raise PrecisionError("the bracket of a hyperbolic pair is not known well enough; take more digits")
    scale, sign = abs(c).sqrt(), 1 if c > 0 else -1
    return [x / scale for x in a], [x / scale * sign for x in b], acb(exponents[k].real)


def _elliptic(exponent: acb, row: Row) -> tuple[Row, Row, acb]:
    """Return z, z̄ with {z, z̄} = −2i, and the exponent of z."""
    z = _with_first_one(row)
    bar = [x.conjugate() for x in z]
    kappa = -_form(z, bar).imag / 2
    if kappa.contains(0):
        raise PrecisionError("the sign of an elliptic pair is not known; take more digits")
    if kappa < 0:
        z, bar, kappa, exponent = bar, z, -kappa, -exponent
    scale = kappa.sqrt()
    return [x / scale for x in z], [x / scale for x in bar], acb(0, exponent.imag)


def _with_first_one(row: Row) -> Row:
    """Return a row with 1 for the first of its components that is not small, as far as it is known."""
    largest = max(abs(complex(x)) for x in row)
    first = next(x for x in row if abs(complex(x)) > 1e-6 * largest)
    return [x / first for x in row]


def _real(row: Row) -> Row:
    """Return the row of a real exponent with the component 1: it is real."""
    return [acb(x.real) for x in row]


def _coordinate(k: int, pairs: Sequence[tuple[Row, Row, acb]], hyperbolic: int) -> tuple[acb, ...]:
    """Return x_k = Σ ({x_k, b} a − {x_k, a} b)/c in the variables (a, b)."""
    size = 2 * len(pairs)
    unit = [acb(int(j == k)) for j in range(size)]
    c = [acb(1)] * hyperbolic + [acb(0, -2)] * (len(pairs) - hyperbolic)
    of_a = [_form(unit, b) / cj for (_, b, _), cj in zip(pairs, c, strict=True)]
    of_b = [-_form(unit, a) / cj for (a, _, _), cj in zip(pairs, c, strict=True)]
    return (*of_a, *of_b)
