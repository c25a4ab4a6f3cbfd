"""Homogeneous polynomials in balls by how far their terms lie from a centre manifold.

The grade of a term is how many variables of hyperbolic pairs it holds. On the manifold these are zero, and only grade 0
is left. A generator has grade 1 at least, and a bracket takes two such variables away at most, so each bracket lowers
the grade by one at most while it raises the degree by one at least: of degree d only grades up to order + 1 − d bear on
what is left at the order, and on the map to it. The others are never computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.cached_property import cached_property
from canon.mechanics.perturbation.enclosed.enclosed_polynomial import EnclosedPolynomial, complex_product

if TYPE_CHECKING:
    from collections.abc import Mapping

    from flint import fmpz_mpoly

    from canon.mechanics.perturbation.enclosed.enclosed_polynomial import FixedPointRing

__all__ = ["GradedPolynomial", "PairBrackets", "graded"]

Both = tuple["fmpz_mpoly", "fmpz_mpoly"]
"""Real and imaginary part."""


@dataclass(frozen=True)
class GradedPolynomial:
    """A homogeneous polynomial as the sum of its grades, up to a highest one.

    Parameters
    ----------
    ring
        The ring.
    grades
        Real and imaginary part of each grade, in units of 2⁻ᵇⁱᵗˢ.
    error
        A bound on ‖δ‖₁ over these grades, in the same units.
    """

    ring: FixedPointRing
    grades: Mapping[int, Both]
    error: int

    def __neg__(self) -> GradedPolynomial:
        return GradedPolynomial(self.ring, {h: (-re, -im) for h, (re, im) in self.grades.items()}, self.error)

    def __add__(self, other: GradedPolynomial) -> GradedPolynomial:
        total = dict(self.grades)
        for h, both in other.grades.items():
            _add(total, h, both)
        return GradedPolynomial(self.ring, total, self.error + other.error)

    def __sub__(self, other: GradedPolynomial) -> GradedPolynomial:
        return self + (-other)

    def __len__(self) -> int:
        return sum(len(re) + len(im) for re, im in self.grades.values())

    @cached_property
    def norm(self) -> int:
        """An upper bound of ‖F + i G‖₁, in units of 2⁻ᵇⁱᵗˢ."""
        return sum(abs(int(c)) for both in self.grades.values() for part in both for c in part.coeffs())

    @cached_property
    def slopes(self) -> tuple[dict[int, Both], ...]:
        """The derivative by each variable, by its own grade; what vanishes is left out."""
        n = self.ring.size // 2
        found: list[dict[int, Both]] = []
        for j in range(self.ring.size):
            lowered = int(j % n < self.ring.hyperbolic)
            slopes = {
                h - lowered: (re.derivative(j), im.derivative(j)) for h, (re, im) in self.grades.items()
            }
            found.append({h: both for h, both in slopes.items() if both[0] or both[1]})
        return tuple(found)

    def over(self, number: int) -> GradedPolynomial:
        """Return the quotient by a whole number from 1, each coefficient rounded down."""
        if number == 1:
            return self
        grades = {h: (re // number, im // number) for h, (re, im) in self.grades.items()}
        return GradedPolynomial(self.ring, grades, self.error // number + len(self) + 1)

    def grade(self, h: int) -> EnclosedPolynomial:
        """Return the terms of one grade."""
        zero = self.ring.zero.re
        re, im = self.grades.get(h, (zero, zero))
        return EnclosedPolynomial(self.ring, re, im, self.error)


def graded(f: EnclosedPolynomial, highest: int) -> GradedPolynomial:
    """Return the grades of a polynomial up to a highest one."""
    n, h = f.ring.size // 2, f.ring.hyperbolic
    found: dict[int, tuple[dict[tuple[int, ...], int], dict[tuple[int, ...], int]]] = {}
    for side, part in enumerate((f.re, f.im)):
        for powers, c in part.to_dict().items():
            grade = int(sum(powers[:h]) + sum(powers[n : n + h]))
            if grade <= highest:
                found.setdefault(grade, ({}, {}))[side][tuple(map(int, powers))] = int(c)
    made = f.ring.context.from_dict
    return GradedPolynomial(f.ring, {k: (made(re), made(im)) for k, (re, im) in found.items()}, f.error)


@dataclass(frozen=True)
class PairBrackets:
    """Poisson's bracket in a₁ … aₙ, b₁ … bₙ: {a, b} = 1 of hyperbolic pairs, which come first, −2i of elliptic ones.

    Parameters
    ----------
    hyperbolic, elliptic
        How many pairs there are of each sort.
    """

    hyperbolic: int
    elliptic: int

    def __call__(
        self, f: GradedPolynomial, g: GradedPolynomial, degrees: int, highest: int
    ) -> GradedPolynomial:
        """Return {f, g} up to a highest grade, rounded once; ``degrees`` is the product of theirs."""
        total: dict[int, Both] = {}
        for j in range(self.hyperbolic + self.elliptic):
            for h, (re, im) in self._pair(f, g, j, highest).items():
                if j >= self.hyperbolic:  # times −2i
                    re, im = 2 * im, -2 * re
                _add(total, h, (re, im))
        unit = f.ring.unit
        # Σ over pairs of ‖∂f‖ ‖∂g‖ is at most deg f ‖f‖ · deg g ‖g‖, and |c| is 1 or 2
        error = 2 * degrees * (f.norm * g.error + f.error * (g.norm + g.error)) // unit + 1
        error += sum(len(re) + len(im) for re, im in total.values())
        return GradedPolynomial(f.ring, {h: (re // unit, im // unit) for h, (re, im) in total.items()}, error)

    def _pair(self, f: GradedPolynomial, g: GradedPolynomial, j: int, highest: int) -> dict[int, Both]:
        """Return ∂f/∂a ∂g/∂b − ∂f/∂b ∂g/∂a of one pair by grade, in units of 4⁻ᵇⁱᵗˢ."""
        n = self.hyperbolic + self.elliptic
        total: dict[int, Both] = {}
        for by, other, sign in ((j, n + j, 1), (n + j, j, -1)):
            for h, left in f.slopes[by].items():
                for k, right in g.slopes[other].items():
                    if h + k <= highest:
                        re, im = complex_product(left, right)
                        _add(total, h + k, (re, im) if sign > 0 else (-re, -im))
        return total


def _add(total: dict[int, Both], h: int, both: Both) -> None:
    """Add real and imaginary part to those of a grade."""
    had = total.get(h)
    total[h] = both if had is None else (had[0] + both[0], had[1] + both[1])
