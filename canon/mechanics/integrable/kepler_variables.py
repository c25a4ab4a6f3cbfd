"""Delaunay's and Poincaré's canonical variables of Kepler's problem, in a plane and in space.

In space both go by one step that knows nothing of the force, from spherical coordinates to the plane of the orbit
(E. T. Whittaker, Analytical Dynamics, section 160), and by the planar variables in that plane. So every proof is one of
a small map.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol, atan2, sqrt

from canon.cached_property import cached_property
from canon.expression.symbols.user_input import given_expression, given_kind
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.canonical.generating_function import GeneratingFunction
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.kepler_maps import (
    beside,
    kepler_hamiltonian,
    longitude_and_tilt,
    pairs_of,
    planar_delaunay,
    planar_poincare,
    plane_of_the_orbit,
    polar_symbols,
)
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Verdict, all_hold

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.mechanics.canonical.transformation import CanonicalTransformation


__all__ = [
    "KeplerVariables",
    "delaunay_generating_function",
    "delaunay_variables",
    "poincare_variables",
]


@dataclass(frozen=True)
class KeplerVariables:
    """Canonical variables in which Kepler's Hamiltonian depends on one momentum alone, and the steps to them.

    Parameters
    ----------
    strength, mass
        k and m of H = p²/(2m) − k/r.
    old
        That H in polar or spherical coordinates.
    new
        −m k²/(2 L²) in the new variables, whose symbols are ``new.q`` and ``new.p``.
    steps
        The maps that lead from the old variables to the new ones, one after the other.

    Examples
    --------
    >>> r, mu, G = sp.symbols("r mu p_phi", positive=True)
    >>> phi, p_r = sp.symbols("phi p_r", real=True)
    >>> delaunay = delaunay_variables([r, phi], [p_r, G], mu)
    >>> delaunay.new.H, delaunay.new.q, delaunay.new.p
    (-mu**2/(2*L**2), (l, g), (L, G))
    >>> delaunay.is_canonical().status.name, delaunay.has_new_hamiltonian().status.name
    ('HOLDS', 'HOLDS')
    """

    strength: Expr
    mass: Expr
    old: Hamiltonian
    new: Hamiltonian
    steps: tuple[CanonicalTransformation, ...]

    @cached_property
    def transformation(self) -> CanonicalTransformation:
        """The whole map from the old variables to the new ones, where each step has values."""
        whole = self.steps[0]
        for step in self.steps[1:]:
            whole = whole.then(step)
        return whole

    def is_canonical(self, budget: float = 10.0) -> Verdict:
        """Tell whether the map is canonical: where each step is, so are they together."""
        question = "the map is canonical"
        by_steps = all_hold((step.is_canonical(budget=budget) for step in self.steps), question)
        return by_steps if by_steps.holds else self.transformation.is_canonical(budget=budget)

    def has_new_hamiltonian(self, budget: float = 10.0) -> Verdict:
        """Tell whether the map is canonical and the old Hamiltonian is the new one of the new variables."""
        question = "the map is canonical and K is the new Hamiltonian"

        def verdicts() -> Iterator[Verdict]:
            yield self.is_canonical(budget)
            T = self.transformation
            meaning = dict(zip((*self.new.q, *self.new.p), T.images, strict=True))
            gap = substitute(self.new.H, meaning) - self.old.H
            yield all_vanish([("K(Q(q, p), P(q, p)) = H(q, p)", gap)], question, T.domain, budget)

        return all_hold(verdicts(), question)


def delaunay_variables(
    q: Sequence[Symbol], p: Sequence[Symbol], strength: Expr | float, mass: Expr | float = 1
) -> KeplerVariables:
    """Return Delaunay's variables of H = p²/(2m) − k/r: mean anomaly, argument of pericentre, node, and momenta.

    L = √(m k a), G = ‖r × p‖ = L √(1 − e²), and in space H = G cos i. The mean anomaly l grows at the rate m k²/L³, all
    others stay. With k = μ and m = 1 they are those of a body of unit mass. Angles are those within −π … π of the
    anomalies: l steps back by 2π where the body passes the apocentre. Any consistent units.

    Parameters
    ----------
    q
        Polar coordinates (r, φ), or spherical ones (r, θ, φ) with θ from the pole.
    p
        Their momenta.
    strength
        k, positive.
    mass
        m, positive.

    Returns
    -------
    KeplerVariables
        With the domain H < 0 and p_φ > 0 in a plane; there the circular orbits, on which pericentre and mean anomaly
        mean nothing, have no images. In space p_φ may have any sign but the orbits in the plane of the equator have no
        images either. :func:`poincare_variables` has all of them.

    Raises
    ------
    ValueError
        Where there are neither two nor three coordinates, or k or m is not positive, or has a symbol in it that is
        called as a variable is.

    Examples
    --------
    >>> r, mu = sp.symbols("r mu", positive=True)
    >>> theta, phi, p_r, p_theta, p_phi = sp.symbols("theta phi p_r p_theta p_phi", real=True)
    >>> delaunay = delaunay_variables([r, theta, phi], [p_r, p_theta, p_phi], mu)
    >>> delaunay.new.q, delaunay.new.p, delaunay.is_canonical().status.name
    ((l, g, h), (L, G, H), 'HOLDS')

    Source: H. Goldstein, C. Poole, J. Safko, Classical Mechanics, 3rd ed., section 10.8; C. D. Murray, S. F. Dermott,
    Solar System Dynamics, section 2.10.
    """
    k, m = _positive(strength, "the strength k"), _positive(mass, "the mass m")
    coordinates, momenta = pairs_of(q, p)
    angles = sp.symbols("l g h", real=True)[: len(q)]
    actions = (*sp.symbols("L G", positive=True), Symbol("H", real=True))[: len(q)]
    _check_constant(k, m, (*coordinates, *momenta), (*angles, *actions))
    new = Hamiltonian(-m * k**2 / (2 * actions[0] ** 2), angles, actions)
    if len(coordinates) == 2:
        steps = (planar_delaunay(coordinates, momenta, k, m),)
    else:
        in_plane = plane_of_the_orbit(coordinates, momenta)
        steps = (in_plane, beside(planar_delaunay(*polar_symbols(), k, m)))
    return KeplerVariables(k, m, kepler_hamiltonian(coordinates, momenta, k, m), new, steps)


def poincare_variables(
    q: Sequence[Symbol], p: Sequence[Symbol], strength: Expr | float, mass: Expr | float = 1
) -> KeplerVariables:
    """Return Poincaré's variables of H = p²/(2m) − k/r, which are regular for circular orbits and those not inclined.

    Λ = L and λ = l + g, the mean longitude; ξ = √(2(L − G)) cos g and η = −√(2(L − G)) sin g; in space λ = l + g + h,
    g + h in place of g, and √(2(G − H)) cos h, −√(2(G − H)) sin h. The coordinates are λ, η, the momenta Λ, ξ. They are
    given in a form that needs no pericentre and no node, so that the domain holds the orbits with e = 0 and i = 0.

    Parameters
    ----------
    q
        Polar coordinates (r, φ), or spherical ones (r, θ, φ) with θ from the pole.
    p
        Their momenta.
    strength
        k, positive.
    mass
        m, positive.

    Returns
    -------
    KeplerVariables
        With the domain H < 0 and p_φ > 0.

    Raises
    ------
    ValueError
        Where there are neither two nor three coordinates, or k or m is not positive, or has a symbol in it that is
        called as a variable is.

    Examples
    --------
    >>> r, mu, G = sp.symbols("r mu p_phi", positive=True)
    >>> phi, p_r = sp.symbols("phi p_r", real=True)
    >>> poincare = poincare_variables([r, phi], [p_r, G], mu)
    >>> poincare.new.H, poincare.new.q, poincare.new.p
    (-mu**2/(2*Lambda**2), (lambda, eta), (Lambda, xi))
    >>> circle = {r: 1, phi: sp.pi/3, p_r: 0, G: 1, mu: 1}
    >>> [image.subs(circle) for image in poincare.transformation.images]
    [pi/3, 0, 1, 0]

    Source: H. Poincaré, Leçons de mécanique céleste, vol. I (1905), ch. III; C. D. Murray, S. F. Dermott, Solar System
    Dynamics, section 2.10.
    """
    k, m = _positive(strength, "the strength k"), _positive(mass, "the mass m")
    coordinates, momenta = pairs_of(q, p)
    planar = len(coordinates) == 2
    eta = sp.symbols("eta," if planar else "eta_1, eta_2", real=True)
    xi = sp.symbols("xi," if planar else "xi_1, xi_2", real=True)
    Lambda = Symbol("Lambda", positive=True)
    new_q, new_p = (Symbol("lambda", real=True), *eta), (Lambda, *xi)
    _check_constant(k, m, (*coordinates, *momenta), (*new_q, *new_p))
    new = Hamiltonian(-m * k**2 / (2 * Lambda**2), new_q, new_p)
    if planar:
        steps = (planar_poincare(coordinates, momenta, k, m),)
    else:
        tilted = longitude_and_tilt(coordinates, momenta)
        steps = (tilted, beside(planar_poincare(*polar_symbols(), k, m)))
    return KeplerVariables(k, m, kepler_hamiltonian(coordinates, momenta, k, m), new, steps)


def delaunay_generating_function(delaunay: KeplerVariables, outward: bool = True) -> GeneratingFunction:
    """Return F₂(r, φ, L, G), Hamilton's characteristic function of Kepler's problem in a plane, in closed form.

    With the eccentric anomaly u, the true anomaly f and p_r as functions of r, L and G,

        F₂ = G φ + L u + r p_r − G f,

    so that p = ∂F₂/∂q, l = ∂F₂/∂L, g = ∂F₂/∂G.

    Parameters
    ----------
    delaunay
        What :func:`delaunay_variables` returned for polar coordinates.
    outward
        Whether the body moves away from the centre: p_r > 0.

    Raises
    ------
    ValueError
        For other variables than those of Delaunay in a plane.

    Examples
    --------
    >>> r, mu, p_r, G = sp.symbols("r mu p_r p_phi", positive=True)
    >>> delaunay = delaunay_variables([r, sp.Symbol("phi", real=True)], [p_r, G], mu)
    >>> delaunay_generating_function(delaunay).generates(delaunay.transformation).status.name
    'HOLDS'

    Source: M. Born, Vorlesungen über Atommechanik, section 22; C. D. Murray, S. F. Dermott, Solar System Dynamics,
    section 2.10.
    """
    given_kind(delaunay, KeplerVariables, "what is generated", "delaunay_variables() finds it")
    if len(delaunay.old.q) != 2 or delaunay.new.p[0].name != "L":
        raise ValueError(
            "give Delaunay's variables in a plane, delaunay_variables([r, phi], [p_r, p_phi], k)"
        )
    k, m = delaunay.strength, delaunay.mass
    r, phi = delaunay.old.q
    L, G = delaunay.new.p
    square = -((m * k / L) ** 2) + 2 * m * k / r - G**2 / r**2
    p_r = sqrt(square) if outward else -sqrt(square)
    u = atan2(r * p_r / L, 1 - m * k * r / L**2)
    f = atan2(G * p_r / (m * k), G**2 / (m * k * r) - 1)
    F = G * phi + L * u + r * p_r - G * f
    real = Domain((sp.Gt(square, 0),))
    return GeneratingFunction(2, F, delaunay.old.q, delaunay.old.p, delaunay.new.q, delaunay.new.p, real)


def _check_constant(k: Expr, m: Expr, old: Sequence[Symbol], new: Sequence[Symbol]) -> None:
    """Refuse a strength or mass with a symbol in it that is called as a variable of the maps is: G M beside G."""
    in_plane = polar_symbols() if len(old) > 4 else ()
    names = {s.name for variables in (old, new, *in_plane) for s in variables}
    clash = sorted({str(s) for s in k.free_symbols | m.free_symbols} & names)
    if clash:
        raise ValueError(
            f"strength and mass are constants, and {', '.join(clash)} in them is the name of a variable of the orbit; "
            "call it otherwise, as mu in place of G*M"
        )


def _positive(given: Expr | float, name: str) -> Expr:
    value = given_expression(given, name)
    if not value.is_positive:
        raise ValueError(f"{name} should be positive, not {value}; declare its symbols positive")
    return value
