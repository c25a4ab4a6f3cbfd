"""Trigonometric polynomials in the true anomaly f: derivatives by Delaunay's variables, means over the mean anomaly.

The coefficients are rational functions of L, of the eccentricity e, of η = √(1 − e²) = G/L and of the other momenta. Of
e only e² = (1 − η²) is left in a mean, which is therefore a rational function of η.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol, cos, sin

from canon.mechanics.algebra.substitution import exchanged
from canon.mechanics.perturbation.fourier_series import NoFourierSeriesError, fourier_expression

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["Ellipse"]

Waves = dict[int, Expr]
"""Coefficients without f, by the multiple of g of which exp(i m g) is the wave."""


@dataclass(frozen=True)
class Ellipse:
    """The symbols of an orbit, and the calculus of functions of them.

    Parameters
    ----------
    f, g
        True anomaly and argument of pericentre.
    L, G
        Delaunay's momenta of the mean anomaly and of g.
    e, eta
        Names for √(1 − G²/L²) and G/L.
    """

    f: Symbol
    g: Symbol
    L: Symbol
    G: Symbol
    e: Symbol
    eta: Symbol

    @property
    def f_l(self) -> Expr:
        """∂f/∂l = (1 + e cos f)²/η³, Kepler's second law."""
        return (1 + self.e * cos(self.f)) ** 2 / self.eta**3

    @property
    def f_e(self) -> Expr:
        """∂f/∂e at a fixed mean anomaly (D. Brouwer, G. Clemence, Methods of Celestial Mechanics, ch. XI)."""
        return sin(self.f) * (2 + self.e * cos(self.f)) / self.eta**2

    @property
    def _e_by_momenta(self) -> Mapping[Symbol, Expr]:
        e, eta, L = self.e, self.eta, self.L
        return {self.L: eta**2 / (e * L), self.G: -eta / (e * L)}

    def f_by(self, momentum: Symbol) -> Expr:
        """∂f/∂L, ∂f/∂G or, of every other momentum, zero."""
        return self.f_e * self._e_by_momenta.get(momentum, sp.S.Zero)

    def by_momentum(self, F: Expr, momentum: Symbol) -> Expr:
        """Return ∂F/∂L, ∂F/∂G or that by another momentum, with e, η and f as the functions that they are."""
        eta_by = {self.L: -self.eta / self.L, self.G: 1 / self.L}.get(momentum, sp.S.Zero)
        return (
            F.diff(momentum)
            + F.diff(self.eta) * eta_by
            + F.diff(self.e) * self._e_by_momenta.get(momentum, sp.S.Zero)
            + F.diff(self.f) * self.f_by(momentum)
        )

    def mean_in_f(self, F: Expr) -> Waves:
        """Return (1/2π) ∫ F df over one turn, by the multiples of g."""
        return {m: c for (k, m), c in self._waves(F).items() if k == 0}

    def mean(self, F: Expr) -> Waves:
        """Return (1/2π) ∫ F dl over one turn, by the multiples of g.

        The mean of exp(i k f) is (−β)^|k| (1 + |k| η) with β = e/(1 + η) (F. Tisserand, Traité de mécanique céleste I,
        ch. XV).

        Examples
        --------
        >>> f, g, L, G, e, eta = sp.symbols("f g L G e eta", positive=True)
        >>> x = Ellipse(f, g, L, G, e, eta)
        >>> x.in_g(x.mean((1 + e*cos(f))**2))
        eta**3
        """
        beta = self.e / (1 + self.eta)
        found: Waves = {}
        for (k, m), c in self._waves(F).items():
            found[m] = found.get(m, sp.S.Zero) + c * (-beta) ** abs(k) * (1 + abs(k) * self.eta)
        return found

    def in_g(self, waves: Waves) -> Expr:
        """Return Σ c exp(i m g), each c in lowest terms, with 1 − η² for e² where e stands in squares."""
        return fourier_expression({(m,): self._lowest(c) for m, c in waves.items()}, [self.g])

    def integral_in_f(self, F: Expr) -> Expr:
        """Return the antiderivative by f of all terms with f in them, wave by wave."""
        waves = {(k, m): c / (sp.I * k) for (k, m), c in self._waves(F).items() if k}
        return fourier_expression(waves, [self.f, self.g])

    def _waves(self, F: Expr) -> Mapping[tuple[int, int], Expr]:
        """Return the coefficients of exp(i (k f + m g)) of a polynomial in sines and cosines of sums of f and g.

        Raises
        ------
        NoFourierSeriesError
            Where F is none.
        """
        z, w = sp.symbols("z w", cls=sp.Dummy, positive=True)
        values: dict[Expr, Expr] = {}
        for wave in F.atoms(sin, cos):
            angle = sp.expand(wave.args[0])
            k, m = angle.coeff(self.f), angle.coeff(self.g)
            rest = sp.expand(angle - k * self.f - m * self.g)
            if k.is_Integer and m.is_Integer and not rest.has(self.f, self.g):
                there = z**k * w**m
                even, odd = (there + 1 / there) / 2, (there - 1 / there) / (2 * sp.I)
                both = (even, -odd) if isinstance(wave, cos) else (odd, even)
                values[wave] = both[0] * cos(rest) + both[1] * sin(rest)
        turning = exchanged(F, values)
        found: dict[tuple[int, int], list[Expr]] = {}
        for term in sp.Add.make_args(sp.expand(turning)):
            if term == 0:
                continue
            c, moving = term.as_independent(z, w, self.f, self.g, as_Add=False)
            powers: Any = moving.as_powers_dict()
            if set(powers) - {z, w, sp.S.One} or not all(n.is_Integer for n in powers.values()):
                raise NoFourierSeriesError(
                    f"{F} is no polynomial in sines and cosines of {self.f} and {self.g}"
                )
            found.setdefault((int(powers.get(z, 0)), int(powers.get(w, 0))), []).append(c)
        return {key: sp.Add(*numbers) for key, numbers in found.items()}

    def _lowest(self, c: Expr) -> Expr:
        above, below = (sp.Poly(part, self.e) for part in sp.fraction(sp.together(c)))
        lowest = sp.cancel(self._without_squares(above) / self._without_squares(below))
        factored: Any = sp.factor(lowest)
        return factored

    def _without_squares(self, poly: Any) -> Expr:
        return sp.Add(*(k * self.e ** (n % 2) * (1 - self.eta**2) ** (n // 2) for (n,), k in poly.terms()))

    def in_momenta(self, F: Expr) -> Expr:
        """Return F with G/L for η and √(1 − G²/L²) for e."""
        return exchanged(F, {self.eta: self.G / self.L, self.e: sp.sqrt(1 - self.G**2 / self.L**2)})
