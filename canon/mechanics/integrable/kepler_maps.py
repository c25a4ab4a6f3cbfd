"""The canonical maps that Delaunay's and Poincaré's variables of Kepler's problem are made of."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol, atan, atan2, cos, pi, sin, sqrt

from canon.expression.symbols.user_input import counted, given_symbols
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.proof.domain.domain import Domain

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy.logic.boolalg import Boolean

__all__ = [
    "beside",
    "delaunay_from_poincare",
    "kepler_hamiltonian",
    "longitude_and_tilt",
    "pairs_of",
    "planar_delaunay",
    "planar_poincare",
    "plane_of_the_orbit",
    "poincare_from_delaunay",
    "polar_symbols",
]


def poincare_from_delaunay(angles: Sequence[Symbol], momenta: Sequence[Symbol]) -> CanonicalTransformation:
    """Return the map from Delaunay's variables to Poincaré's, of polar type, where e ≠ 0 and i ≠ 0.

    Parameters
    ----------
    angles
        (l, g) or (l, g, h).
    momenta
        (L, G) or (L, G, H).

    Examples
    --------
    >>> l, g = sp.symbols("l g", real=True)
    >>> L, G = sp.symbols("L G", positive=True)
    >>> T = poincare_from_delaunay([l, g], [L, G])
    >>> T.images
    (g + l, -sqrt(-2*G + 2*L)*sin(g), L, sqrt(-2*G + 2*L)*cos(g))
    >>> T.is_canonical().status.name
    'HOLDS'
    """
    q, p = pairs_of(angles, momenta)
    longitudes = [sp.Add(*q[i:]) for i in range(1, len(q))]
    deficits = [sp.expand(2 * (p[i] - p[i + 1])) for i in range(len(q) - 1)]
    pairs = list(zip(deficits, longitudes, strict=True))
    return CanonicalTransformation(
        q,
        p,
        [sp.Add(*q), *(-sqrt(d) * sin(x) for d, x in pairs)],
        [p[0], *(sqrt(d) * cos(x) for d, x in pairs)],
        Domain(tuple(sp.Gt(d, 0) for d in deficits)),
    )


def delaunay_from_poincare(
    coordinates: Sequence[Symbol], momenta: Sequence[Symbol]
) -> CanonicalTransformation:
    """Return the map from Poincaré's variables to Delaunay's, where e ≠ 0 and i ≠ 0.

    Parameters
    ----------
    coordinates
        (λ, η), or (λ, η_1, η_2).
    momenta
        (Λ, ξ), or (Λ, ξ_1, ξ_2).

    Examples
    --------
    >>> x, eta, xi = sp.symbols("lambda eta xi", real=True)
    >>> Lambda = sp.Symbol("Lambda", positive=True)
    >>> T = delaunay_from_poincare([x, eta], [Lambda, xi])
    >>> T.images
    (lambda - atan2(-eta, xi), atan2(-eta, xi), Lambda, Lambda - eta**2/2 - xi**2/2)
    >>> T.is_canonical().status.name
    'HOLDS'
    """
    q, p = pairs_of(coordinates, momenta)
    longitudes = [q[0], *(atan2(-eta, xi) for eta, xi in zip(q[1:], p[1:], strict=True)), sp.S.Zero]
    actions: list[Expr] = [p[0]]
    for eta, xi in zip(q[1:], p[1:], strict=True):
        actions.append(actions[-1] - (eta**2 + xi**2) / 2)
    angles = [longitudes[i] - longitudes[i + 1] for i in range(len(q))]
    off_axis = (sp.Gt(eta**2 + xi**2, 0) for eta, xi in zip(q[1:], p[1:], strict=True))
    return CanonicalTransformation(q, p, angles, actions, Domain((*off_axis, sp.Gt(actions[1], 0))))


def kepler_hamiltonian(q: tuple[Symbol, ...], p: tuple[Symbol, ...], k: Expr, m: Expr) -> Hamiltonian:
    """Return (p_r² + (r × p)²/r²)/(2m) − k/r in polar or spherical coordinates."""
    r, p_r = q[0], p[0]
    return Hamiltonian((p_r**2 + _angular_momentum(q, p) ** 2 / r**2) / (2 * m) - k / r, q, p)


def _angular_momentum(q: tuple[Symbol, ...], p: tuple[Symbol, ...]) -> Expr:
    """Return the length of r × p, where p_φ > 0 in a plane."""
    return p[1] if len(q) == 2 else sqrt(p[1] ** 2 + p[2] ** 2 / sin(q[1]) ** 2)


def planar_delaunay(
    q: tuple[Symbol, ...], p: tuple[Symbol, ...], k: Expr, m: Expr
) -> CanonicalTransformation:
    """Return l, g, L, G of polar coordinates, by the eccentric and the true anomaly."""
    (r, phi, p_r, G), H = (*q, *p), kepler_hamiltonian(q, p, k, m).H
    L = k * sqrt(m / (-2 * H))
    u = atan2(r * p_r / L, 1 - m * k * r / L**2)
    f = atan2(G * p_r / (m * k), G**2 / (m * k * r) - 1)
    eccentric = sp.Gt(m * k**2 + 2 * H * G**2, 0)
    return CanonicalTransformation(
        q, p, [u - r * p_r / L, phi - f], [L, G], _domain((r, G), (sp.Lt(H, 0), eccentric))
    )


def planar_poincare(
    q: tuple[Symbol, ...], p: tuple[Symbol, ...], k: Expr, m: Expr
) -> CanonicalTransformation:
    """Return λ, η, Λ, ξ of polar coordinates.

    f − u = 2 arctan(β sin u/(1 − β cos u)) with β = e/(1 + √(1 − e²)) = e L/(L + G); √(2(L − G)) = e L √(2/(L + G)).
    """
    (r, phi, p_r, G), H = (*q, *p), kepler_hamiltonian(q, p, k, m).H
    L = k * sqrt(m / (-2 * H))
    mean_longitude = phi - 2 * atan(r * p_r / (G + m * k * r / L)) - r * p_r / L
    e_cos_f, e_sin_f = G**2 / (m * k * r) - 1, G * p_r / (m * k)
    scale = L * sqrt(2 / (L + G))
    eta = scale * (e_sin_f * cos(phi) - e_cos_f * sin(phi))
    xi = scale * (e_cos_f * cos(phi) + e_sin_f * sin(phi))
    return CanonicalTransformation(q, p, [mean_longitude, eta], [L, xi], _domain((r, G), (sp.Lt(H, 0),)))


def plane_of_the_orbit(q: tuple[Symbol, ...], p: tuple[Symbol, ...]) -> CanonicalTransformation:
    """Return r, the argument of latitude w, the node h; p_r, G, H = p_φ: Whittaker's variables.

    sin i sin w = cos θ, G sin i cos w = −p_θ sin θ, and φ − h is the angle of cos w and cos i sin w.
    """
    (r, theta, phi, p_r, p_theta, p_phi), G = (*q, *p), _angular_momentum(q, p)
    north = -p_theta * sin(theta)
    w = atan2(G * cos(theta), north)
    h = phi - atan2(p_phi * cos(theta), north)
    tilted = sp.Gt(p_theta**2 + cos(theta) ** 2, 0)
    return CanonicalTransformation(
        q, p, [r, w, h], [p_r, G, p_phi], _domain((r, theta), (sp.Lt(theta, pi), tilted))
    )


def longitude_and_tilt(q: tuple[Symbol, ...], p: tuple[Symbol, ...]) -> CanonicalTransformation:
    """Return r, w + h, −√(2(G − H)) sin h; p_r, G, √(2(G − H)) cos h, regular for i = 0.

    The last pair is −√(2/(G + H)) times the components of the angular momentum along x and y, and
    w + h − φ = arctan(τ sin 2w/(1 + τ cos 2w)) with τ = tan²(i/2) = (G − H)/(G + H).
    """
    (r, theta, phi, p_r, p_theta, H), G = (*q, *p), _angular_momentum(q, p)
    up, north = G * cos(theta), -p_theta * sin(theta)
    longitude = phi + atan(2 * up * north / ((G + H) ** 2 + north**2 - up**2))
    scale = sqrt(2 / (G + H))
    along_x = -p_theta * sin(phi) - H * cos(phi) * cos(theta) / sin(theta)
    along_y = p_theta * cos(phi) - H * sin(phi) * cos(theta) / sin(theta)
    return CanonicalTransformation(
        q,
        p,
        [r, longitude, -scale * along_x],
        [p_r, G, -scale * along_y],
        _domain((r, theta, H), (sp.Lt(theta, pi),)),
    )


def polar_symbols() -> tuple[tuple[Symbol, ...], tuple[Symbol, ...]]:
    """Return (r, w) and (p_r, G), polar coordinates in the plane of an orbit and their momenta."""
    r, G = sp.symbols("r G", positive=True)
    w, p_r = sp.symbols("w p_r", real=True)
    return (r, w), (p_r, G)


def beside(planar: CanonicalTransformation) -> CanonicalTransformation:
    """Return a planar map with a third pair of variables that stay as they are."""
    h, H = sp.symbols("h H", real=True)
    return CanonicalTransformation(
        (*planar.q, h), (*planar.p, H), (*planar.new_q, h), (*planar.new_p, H), planar.domain
    )


def _domain(positive: tuple[Symbol, ...], conditions: tuple[Boolean, ...]) -> Domain:
    return Domain((*(cast("Boolean", sp.Gt(z, 0)) for z in positive if not z.is_positive), *conditions))


def pairs_of(q: Sequence[Symbol], p: Sequence[Symbol]) -> tuple[tuple[Symbol, ...], tuple[Symbol, ...]]:
    """Return coordinates and momenta of a plane or of space."""
    coordinates, momenta = given_symbols(q, "q"), given_symbols(p, "p")
    if len(coordinates) not in (2, 3) or len(momenta) != len(coordinates):
        raise ValueError(
            f"{counted(len(coordinates), 'coordinate')} and {counted(len(momenta), 'momentum', 'momenta')}; give "
            "two of each in a plane, three in space"
        )
    return coordinates, momenta
