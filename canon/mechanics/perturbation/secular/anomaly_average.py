"""Perturbations of Kepler's ellipse averaged over the mean anomaly, in closed form in the eccentricity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol, cos

from canon.expression.symbols.user_input import counted, free_name, given_expression, given_symbols
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.substitution import exchanged
from canon.mechanics.perturbation.averaging import AveragingError
from canon.mechanics.perturbation.fourier_series import NoFourierSeriesError
from canon.mechanics.perturbation.secular.anomaly_series import Ellipse

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.proof.domain.verdict import Verdict

__all__ = ["AnomalyAverage", "average_over_anomaly"]


@dataclass(frozen=True)
class AnomalyAverage:
    """A perturbed Kepler problem without its mean anomaly: K = −μ²/2L² + ε K₁ + ε² K₂, and what removes it.

    Parameters
    ----------
    K
        K₁ and, where it was asked for, K₂, in η = G/L, the momenta and the angles other than the mean anomaly.
    W
        Lie's generator of the first order, in the true anomaly f, e, η, the momenta and ``centre``, which is f − l: the
        old Hamiltonian is exp(L_W) of the new one's variables, L_W = {·, ε W}.
    perturbation
        H₁ in the same symbols.
    ellipse
        Their names and their calculus.
    mu
        The strength μ of −μ/r.
    centre
        The equation of the centre f − l.
    angles, momenta
        g and perhaps h; L, G and perhaps H.
    """

    K: tuple[Expr, ...]
    W: Expr
    perturbation: Expr
    ellipse: Ellipse
    mu: Expr
    centre: Symbol
    angles: tuple[Symbol, ...]
    momenta: tuple[Symbol, ...]

    def in_momenta(self) -> tuple[Expr, ...]:
        """Return K₁ and K₂ with G/L for η."""
        return tuple(map(self.ellipse.in_momenta, self.K))

    def removes_the_anomaly(self) -> Verdict:
        """Tell whether n ∂W/∂l = H₁ − K₁ with n = μ²/L³, exactly: with it the first order is free of l.

        Examples
        --------
        >>> mu, r, f, L, G, H, g = sp.symbols("mu r f L G H g", positive=True)
        >>> average_over_anomaly(1/r**2, mu, r, f, [g], [L, G]).removes_the_anomaly().holds
        True
        """
        x, n = self.ellipse, self.mu**2 / self.ellipse.L**3
        claim = exchanged(
            n * self._by_mean_anomaly() - self.perturbation + self.K[0], {x.e: sp.sqrt(1 - x.eta**2)}
        )
        return all_vanish([("n dW/dl = H1 - K1", claim)], "the generator removes the mean anomaly")

    def shifts(self) -> tuple[Expr, ...]:
        """Return {·, W} of l, of the angles and of the momenta, by which the osculating elements differ from mean ones.

        In f, e, η, the momenta and ``centre``. What is left of the osculating elements less ε times it are the mean
        elements up to terms of ε². Those of l and g divide by e, and have no value on a circle.

        Examples
        --------
        The momentum L is μ²/2L² + H₁ made free of l, so that its shift is −(H₁ − K₁)/n:

        >>> mu, r, f, L, G, g, k = sp.symbols("mu r f L G g k", positive=True)
        >>> found = average_over_anomaly(k/r**2, mu, r, f, [g], [L, G])
        >>> sp.simplify(found.shifts()[2] * mu**2 / L**3 + found.perturbation - found.K[0])
        0
        """
        x, W = self.ellipse, self.W
        by_momenta = (x.by_momentum(W, J) + W.diff(self.centre) * x.f_by(J) for J in self.momenta)
        by_angles = (self._by_mean_anomaly(), *(W.diff(angle) for angle in self.angles))
        return (*by_momenta, *(-each for each in by_angles))

    def _by_mean_anomaly(self) -> Expr:
        """Return ∂W/∂l."""
        f_l = self.ellipse.f_l
        return self.W.diff(self.ellipse.f) * f_l + self.W.diff(self.centre) * (f_l - 1)


def average_over_anomaly(
    perturbation: Expr,
    mu: Expr,
    r: Symbol,
    f: Symbol,
    angles: Sequence[Symbol],
    momenta: Sequence[Symbol],
    order: int = 1,
) -> AnomalyAverage:
    """Return the average over the mean anomaly of a perturbation of −μ/r, in closed form, to first or second order.

    With dl = (r²/a²η) df a perturbation by powers of 1/r from 1/r² is a trigonometric polynomial in f, and so are its
    generator W₁, but for the equation of the centre f − l, and ½ {H₁ + K₁, W₁}, whose mean is K₂ (D. Brouwer, Astr. J.
    64, 378 (1959), doi:10.1086/107958, here by Lie's generators in place of von Zeipel's). W₁ has a mean of zero over
    f, not over l, as Brouwer's has. Any consistent units; the mass is 1.

    Parameters
    ----------
    perturbation
        H₁, a polynomial in 1/r with terms from 1/r² on, in sines and cosines of f and the angles, and in the momenta.
        Other symbols are constants: an ``e`` or ``eta`` among them makes ``ellipse`` call its own ``e_``, ``eta_``.
    mu
        The strength of the attraction, a constant.
    r, f
        The symbols of the distance and of the true anomaly in it.
    angles
        g, and after it the node h where there is one: Delaunay's angles but for the mean anomaly.
    momenta
        L, G and, with h, H: Delaunay's momenta, of which L belongs to the mean anomaly.
    order
        1 or 2.

    Raises
    ------
    AveragingError
        Where H₁ is no such polynomial, or K₂ is asked for and K₁ still has an angle in it, or H₁ has the node in it.
    ValueError
        Where angles and momenta do not belong together, the order is another one, or μ depends on a variable.

    Examples
    --------
    The oblate planet in first order, K₁ = −μ⁴ J₂R² (3 H²/G² − 1)/(4 L³ G³):

    >>> mu, r, f, L, G, H, g, h, k = sp.symbols("mu r f L G H g h k", positive=True)
    >>> J2 = k/(2*r**3) * (3*(1 - H**2/G**2)*sp.sin(f + g)**2 - 1)
    >>> sp.factor(average_over_anomaly(J2, mu, r, f, [g, h], [L, G, H]).in_momenta()[0])
    k*mu**3*(G**2 - 3*H**2)/(4*G**5*L**3)
    """
    angles, momenta = given_symbols(angles, "angles"), given_symbols(momenta, "momenta")
    if len(momenta) != len(angles) + 1 or len(momenta) not in (2, 3):
        raise ValueError(
            f"{counted(len(angles), 'angle')} and {counted(len(momenta), 'momentum', 'momenta')}; give g with L, G "
            "or g, h with L, G, H"
        )
    if order not in (1, 2):
        raise ValueError(f"the order should be 1 or 2, not {order!r}")
    mu, given = given_expression(mu, "mu"), given_expression(perturbation, "the perturbation")
    variables = (r, f, *angles, *momenta)
    _check_constant(mu, variables)
    taken = {s.name for s in (mu + given).free_symbols | {*variables} if isinstance(s, Symbol)}
    e, eta = (Symbol(free_name(name, taken), positive=True) for name in ("e", "eta"))
    centre = Symbol(free_name("centre", taken), real=True)
    x = Ellipse(f, angles[0], momenta[0], momenta[1], e, eta)
    H1, reduced = _in_anomaly(given, mu, r, x)
    try:
        return _Averaging(x, H1, reduced, mu, centre, angles, momenta).to(order)
    except NoFourierSeriesError as reason:
        raise AveragingError(f"the perturbation is no trigonometric polynomial: {reason}") from None


def _check_constant(mu: Expr, variables: Sequence[Symbol]) -> None:
    """Refuse a strength with a symbol in it that is called as a variable is, as G M beside the momentum G."""
    names = {s.name for s in variables}
    clash = sorted(s.name for s in mu.free_symbols if isinstance(s, Symbol) and s.name in names)
    if clash:
        raise ValueError(
            f"mu = {mu} is a constant, and {', '.join(clash)} is the name of a variable; call one of them otherwise"
        )


def _in_anomaly(H1: Expr, mu: Expr, r: Symbol, x: Ellipse) -> tuple[Expr, Expr]:
    """Return H₁ and H₁/(∂f/∂l) with 1/r = μ (1 + e cos f)/(L² η²)."""
    inverse = sp.Dummy(positive=True)
    poly = exchanged(sp.expand(H1), {r: 1 / inverse, x.G: x.eta * x.L})
    if not poly.is_polynomial(inverse) or any(n < 2 for (n,) in sp.Poly(poly, inverse).monoms()):
        raise AveragingError(
            f"the perturbation should be a polynomial in 1/{r} with terms from 1/{r}**2 on, for which the average "
            "over the mean anomaly is an integral over the true one"
        )
    near = 1 + x.e * cos(x.f)
    scale = mu / (x.L**2 * x.eta**2)
    terms = [(n, c * scale**n) for (n,), c in sp.Poly(poly, inverse).terms()]
    whole = sp.Add(*(c * near**n for n, c in terms))
    return whole, sp.Add(*(c * near ** (n - 2) * x.eta**3 for n, c in terms))


@dataclass(frozen=True)
class _Averaging:
    x: Ellipse
    H1: Expr
    reduced: Expr
    mu: Expr
    centre: Symbol
    angles: tuple[Symbol, ...]
    momenta: tuple[Symbol, ...]

    def to(self, order: int) -> AnomalyAverage:
        x, n = self.x, self.mu**2 / self.x.L**3
        K1 = x.in_g(x.mean_in_f(self.reduced))
        waves = x.integral_in_f(self.reduced)
        K = (K1,) if order == 1 else (K1, self._second(K1, waves))
        generator = (K1 * self.centre + waves) / n
        return AnomalyAverage(K, generator, self.H1, x, self.mu, self.centre, self.angles, self.momenta)

    def _second(self, K1: Expr, waves: Expr) -> Expr:
        """Return ½ ⟨{H₁ + K₁, W}⟩ with W = (K₁ (f − l) + S)/n.

        The means that hold f − l are integrated by parts: ⟨(f − l) ∂A/∂l⟩ = ⟨A⟩ − ⟨A ∂f/∂l⟩, the last being the mean of
        A over f; and ∂H₁/∂g = ∂(∂S/∂g)/∂l where K₁ is free of g.
        """
        x, (g, *others), (L, G, *_) = self.x, self.angles, self.momenta
        if K1.has(g, *others) or self.H1.has(*others):
            raise AveragingError(
                "the second order is known where the first average has no angle in it, and the perturbation no node; "
                f"K1 is {K1}"
            )
        n = self.mu**2 / L**3
        S_g, H1, C = waves.diff(g), self.H1, K1 / n
        plain = H1.diff(x.f) * x.f_l * (C * x.f_by(L) + x.by_momentum(waves / n, L))
        plain += H1.diff(g) * (C * x.f_by(G) + x.by_momentum(waves / n, G))
        plain -= x.by_momentum(H1, L) * (H1 - K1) / n
        plain -= x.by_momentum(H1 + K1, G) * S_g / n
        with_centre = (
            (x.by_momentum(C, L), {0: K1}, x.mean_in_f(H1)),
            (x.by_momentum(C, G), x.mean(S_g), x.mean_in_f(S_g)),
        )
        total = x.mean(plain)
        for factor, mean, in_f in with_centre:
            for m in {*mean, *in_f}:
                share = factor * (mean.get(m, sp.S.Zero) - in_f.get(m, sp.S.Zero))
                total[m] = total.get(m, sp.S.Zero) + share
        return x.in_g({m: c / 2 for m, c in total.items()})
