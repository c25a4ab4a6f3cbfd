"""Taylor series in balls by degree: powers and elementary functions by their differential equations along rays.

For g = u^α the derivative along a ray, r ∂/∂r, gives u r g′ = α g r u′, which by degree reads
k u₀ g_k = Σ_{j=1}^{k} (α j − (k − j)) u_j g_{k−j}: each degree costs as many products as u has parts (D. E. Knuth,
TAOCP 2, 4.7; À. Jorba, Exp. Math. 8, 155 (1999), doi:10.1080/10586458.1999.10504397).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp
from flint import acb, arb, fmpq

from canon.mechanics.perturbation.taylor_parts import NotAnalyticError
from canon.proof.domain.balls import value

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Expr, Symbol

    from canon.mechanics.perturbation.enclosed.enclosed_polynomial import EnclosedPolynomial, FixedPointRing

__all__ = ["enclosed_parts"]

Parts = list["EnclosedPolynomial"]


def enclosed_parts(
    f: Expr, displacements: Mapping[Symbol, EnclosedPolynomial], place: Mapping[Symbol, acb], order: int
) -> Parts:
    """Return the parts of degree 0 … order of f at a place that is enclosed in balls.

    Parameters
    ----------
    f
        A function of the variables.
    displacements
        Each variable less its place, a linear function of those of the ring.
    place
        The values of the variables there, and of all other symbols.
    order
        The highest degree.

    Raises
    ------
    NotAnalyticError
        Where f has no Taylor series.
    PrecisionError
        Where the balls are too wide to tell.

    Examples
    --------
    >>> from canon.mechanics.perturbation.enclosed.enclosed_polynomial import FixedPointRing
    >>> ring, q = FixedPointRing(1, 64), sp.Symbol("q")
    >>> parts = enclosed_parts(1 / q, {q: ring.variable(0)}, {q: acb(2)}, 3)
    >>> [float(part.coefficients[k,].real.mid()) for k, part in enumerate(parts)]
    [0.5, -0.25, 0.125, -0.0625]
    """
    ring = next(iter(displacements.values())).ring
    return _Expansion(ring, displacements, dict(place), order).of(f)


class _Expansion:
    """Series of the nodes of one expression, each expanded once."""

    def __init__(
        self,
        ring: FixedPointRing,
        displacements: Mapping[Symbol, EnclosedPolynomial],
        place: dict[Any, acb],
        order: int,
    ) -> None:
        self.ring, self.displacements, self.place, self.order = ring, displacements, place, order
        self._known: dict[Any, Parts] = {}

    def of(self, f: Any) -> Parts:
        """Return the parts of degree 0 … order."""
        found = self._known.get(f)
        if found is None:
            found = self._known[f] = self._fresh(f)
        return found

    def _fresh(self, f: Any) -> Parts:
        if not f.has(*self.displacements):
            return self._constant(value(f, {}, self.place))
        if f in self.displacements:
            return [self.ring.constant(self.place[f]), self.displacements[f], *self._zeros(2)][
                : self.order + 1
            ]
        if f.is_Add:
            return self._sum([self.of(part) for part in f.args])
        if f.is_Mul:
            return self._product([self.of(part) for part in f.args])
        if f.is_Pow:
            return self._power(f)
        return self._of_function(f)

    def _constant(self, number: acb) -> Parts:
        return [self.ring.constant(number), *self._zeros(1)]

    def _zeros(self, start: int) -> Parts:
        return [self.ring.zero] * (self.order + 1 - start)

    def _sum(self, several: list[Parts]) -> Parts:
        total = several[0]
        for other in several[1:]:
            total = [a + b for a, b in zip(total, other, strict=True)]
        return total

    def _product(self, several: list[Parts]) -> Parts:
        total = several[0]
        for other in several[1:]:
            total = [self._convolved(total, other, k) for k in range(self.order + 1)]
        return total

    def _convolved(self, f: Parts, g: Parts, k: int) -> EnclosedPolynomial:
        total = self.ring.zero
        for j in range(k + 1):
            if f[j] and g[k - j]:
                total = total + f[j] * g[k - j]
        return total

    def _start(self, u: Parts) -> arb:
        """Return u₀, which is real: all operations here are real of real numbers."""
        return u[0].coefficients.get((0,) * self.ring.size, acb(0)).real + arb(0, u[0].bound)

    def _power(self, f: Any) -> Parts:
        if not f.exp.is_Rational:
            raise NotAnalyticError(
                f"{f}: only powers with rational exponents are expanded in balls; write exp({f.exp}*log({f.base}))"
            )
        u, exponent = self.of(f.base), f.exp
        if exponent.is_Integer and 0 < exponent <= self.order + 1:
            return self._product([u] * int(exponent))
        start = self._start(u)
        if start.contains(0):
            raise NotAnalyticError(f"{f} has no Taylor series where {f.base} = 0")
        alpha = fmpq(int(exponent.p), int(exponent.q))
        if not exponent.is_Integer and not start > 0:
            raise NotAnalyticError(f"{f.base} is not certainly positive where {f} is expanded")
        first = start ** int(exponent) if exponent.is_Integer else (start.log() * alpha).exp()
        inverse, p, q = self.ring.constant(acb(1 / start)), int(alpha.p), int(alpha.q)
        g = [self.ring.constant(acb(first))]
        for k in range(1, self.order + 1):
            total = self.ring.zero
            for j in range(1, k + 1):
                if u[j] and g[k - j]:
                    total = total + (u[j] * g[k - j]).times(p * j - q * (k - j))
            g.append((total * inverse).over(q * k))
        return g

    def _of_function(self, f: Any) -> Parts:
        if not isinstance(f, sp.exp | sp.sin | sp.cos | sp.sinh | sp.cosh | sp.log):
            raise NotAnalyticError(
                f"{f.func.__name__} is not expanded in balls; write it with powers, exp, log, sin, cos, sinh or cosh"
            )
        u = self.of(f.args[0])
        start = self._start(u)
        if isinstance(f, sp.exp):
            return self._exponential(u, start)
        if isinstance(f, sp.log):
            return self._logarithm(u, start, f)
        even, odd = self._pair(u, start, isinstance(f, sp.sin | sp.cos))
        return odd if isinstance(f, sp.sin | sp.sinh) else even

    def _radial(self, u: Parts, g: Parts, k: int) -> EnclosedPolynomial:
        """Return Σ_{j=1}^{k} j u_j g_{k−j}/k, the part of degree k of ∫ g du."""
        total = self.ring.zero
        for j in range(1, k + 1):
            if u[j] and g[k - j]:
                total = total + (u[j] * g[k - j]).times(j)
        return total.over(k)

    def _exponential(self, u: Parts, start: arb) -> Parts:
        g = [self.ring.constant(acb(start.exp()))]
        for k in range(1, self.order + 1):
            g.append(self._radial(u, g, k))
        return g

    def _logarithm(self, u: Parts, start: arb, f: Any) -> Parts:
        if not start > 0:
            raise NotAnalyticError(f"{f.args[0]} is not certainly positive where {f} is expanded")
        inverse = self.ring.constant(acb(1 / start))
        g = [self.ring.constant(acb(start.log()))]
        for k in range(1, self.order + 1):
            total = u[k].times(k)
            for j in range(1, k):
                if g[j] and u[k - j]:
                    total = total - (g[j] * u[k - j]).times(j)
            g.append((total * inverse).over(k))
        return g

    def _pair(self, u: Parts, start: arb, circular: bool) -> tuple[Parts, Parts]:
        """Return cosine and sine of u, or their hyperbolic namesakes."""
        even = [self.ring.constant(acb(start.cos() if circular else start.cosh()))]
        odd = [self.ring.constant(acb(start.sin() if circular else start.sinh()))]
        for k in range(1, self.order + 1):
            slope = self._radial(u, odd, k)
            odd.append(self._radial(u, even, k))
            even.append(-slope if circular else slope)
        return even, odd
