"""Classical orthogonal coordinates over Cartesian ones: their scale factors, and Hamiltonians lifted to them.

(P. M. Morse and H. Feshbach, Methods of Theoretical Physics, section 5.1.)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol, cos, cosh, sin, sinh

from canon.expression.symbols.user_input import free_name, given_expression
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.canonical.transformation import CanonicalTransformation, point_transformation
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.proof.domain.domain import EVERYWHERE, Domain

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

__all__ = ["NAMES", "Chart", "charts_for"]


@dataclass(frozen=True)
class Chart:
    """Orthogonal coordinates of a plane or of space.

    Parameters
    ----------
    name
        What they are called.
    q, p
        Their symbols and those of their momenta.
    position
        The Cartesian coordinates as functions of them.
    squared_scales
        The squares h_i² of their scale factors, Σ dx² = Σ h_i² dq_i².
    domain
        Where they are one to one: lengths positive, angles within a turn or, from a pole, half a turn.
    """

    name: str
    q: tuple[Symbol, ...]
    p: tuple[Symbol, ...]
    position: tuple[Expr, ...]
    squared_scales: tuple[Expr, ...]
    domain: Domain = EVERYWHERE

    def lift(self) -> CanonicalTransformation:
        """Return the point transformation from these coordinates and momenta to the Cartesian ones, where one to one.

        Examples
        --------
        >>> from canon.mechanics import inverse_transformation
        >>> x, y, px, py = sp.symbols("x y p_x p_y", real=True)
        >>> (polar,) = charts_for(Hamiltonian(px**2 + py**2, [x, y], [px, py]), "polar", None)
        >>> inverse_transformation(polar.lift(), [x, y], [px, py]).new_q
        (sqrt(x**2 + y**2), atan2(y, x))
        """
        return replace(point_transformation(self.q, self.p, self.position), domain=self.domain)

    def hamiltonian(self, H: Hamiltonian) -> Hamiltonian:
        """Return H = κ Σ p² + V(x) in these coordinates: κ Σ P_i²/h_i² + V."""
        kappa = cast("Expr", isotropic_coefficient(H))
        resting = substitute(H.H, dict.fromkeys(H.p, sp.S.Zero))
        V = _with_plain_distances(substitute(resting, dict(zip(H.q, self.position, strict=True))))
        kinetic = sp.Add(*(kappa * P**2 / h for P, h in zip(self.p, self.squared_scales, strict=True)))
        return Hamiltonian(kinetic + V, self.q, self.p, H.t)


def _with_plain_distances(V: Expr) -> Expr:
    """Return V with the sums under its powers as squares where they are some: √(r² cos² φ + r² sin² φ) as r."""
    powers = sorted((f for f in V.atoms(sp.Pow) if isinstance(f.base, sp.Add)), key=sp.count_ops)
    plain: dict[Expr, Expr] = {}
    for power in powers:
        base = _by_one_function(power.base)
        if sp.count_ops(base) < sp.count_ops(power.base):
            plain[power] = _power(base, power.exp)
    return exchanged(V, plain)


def _by_one_function(f: Expr) -> Expr:
    """Return f with sin² = 1 − cos² and sinh² = cosh² − 1, in factors."""
    squares = {
        g: 1 - cos(g.base.args[0]) ** 2 if isinstance(g.base, sin) else cosh(g.base.args[0]) ** 2 - 1
        for g in f.atoms(sp.Pow)
        if isinstance(g.base, sin | sinh) and g.exp == 2
    }
    return cast("Expr", sp.factor(sp.expand(exchanged(f, squares))))


def _power(base: Expr, exponent: Expr) -> Expr:
    """Return base**exponent for a base in factors that is not negative: squares of distances come out of the root."""
    outside, inside = sp.S.One, sp.S.One
    for factor in cast("Sequence[Expr]", sp.Mul.make_args(base)):
        f, inner = factor.as_base_exp()
        distance = next((d for d in (f, -f) if _is_distance(d)), None) if inner == 2 else None
        if distance is not None:
            outside *= distance ** (2 * exponent)
        elif factor.is_nonnegative:
            outside *= factor**exponent
        else:
            inside *= factor
    return outside * inside**exponent


def _is_distance(f: Expr) -> bool:
    """Whether f is certainly not negative, by its symbols or as cosh u ± cos v."""
    if f.is_nonnegative:
        return True
    u, v = sp.Wild("u"), sp.Wild("v")
    return any(f.match(cosh(u) + sign * cos(v)) is not None for sign in (1, -1))


def isotropic_coefficient(H: Hamiltonian) -> Expr | None:
    """Return κ where H = κ Σ p² + V(q) with a constant κ, else None.

    Examples
    --------
    >>> x, y, p, s, m = sp.symbols("x y p s m")
    >>> isotropic_coefficient(Hamiltonian((p**2 + s**2)/(2*m) + x*y, [x, y], [p, s]))
    1/(2*m)
    """
    kappa = H.H.diff(H.p[0], 2) / 2
    V = substitute(H.H, dict.fromkeys(H.p, sp.S.Zero))
    due = kappa * sp.Add(*(p**2 for p in H.p)) + V
    if kappa == 0 or kappa.has(*H.q, *H.p) or sp.expand(H.H - V - (due - V)) != 0:
        return None
    return kappa


def charts_for(H: Hamiltonian, name: str, focal: Expr | None) -> list[Chart]:
    """Return the classical coordinates by name, or all that fit for ``"any"``, over the Cartesian ones of H.

    Raises
    ------
    ValueError
        For a name that is not known, or does not fit the number of coordinates, or needs ``focal``; where H is not
        κ Σ p² + V, so that its coordinates are not Cartesian; where ``focal`` is not positive.
    """
    if name not in ("any", *NAMES):
        raise ValueError(f"no coordinates are called {name!r}; choose given, any, {', '.join(NAMES)}")
    if isotropic_coefficient(H) is None:
        raise ValueError(
            "the classical coordinates are taken over Cartesian ones: H should be a constant times the sum of "
            "p**2, plus V(q); with coordinates='given' H is looked at as it stands"
        )
    count = len(H.q)
    chosen = [n for n in NAMES if _DIMENSION[n] == count] if name == "any" else [name]
    if any(_DIMENSION[n] != count for n in chosen):
        raise ValueError(
            f"{name} coordinates are of {_DIMENSION[name]} dimensions; H has {count} coordinates"
        )
    if name in _FOCAL and focal is None:
        raise ValueError(f"{name} coordinates need half the distance of their foci: focal=…")
    c = sp.S.One if focal is None else given_expression(focal, "focal")
    if c.is_positive is False:
        raise ValueError(f"focal is half the distance of the foci, a positive number, not {c}")
    usable = [n for n in chosen if focal is not None or n not in _FOCAL]
    return [_chart(n, c, H) for n in usable]


def _chart(name: str, c: Expr, H: Hamiltonian) -> Chart:
    build, spelled, positive = _CHARTS[name]
    taken = {s.name for s in H.H.free_symbols | {*H.q} if isinstance(s, Symbol)}
    names = [free_name(n, taken) for n in spelled]
    q = tuple(
        Symbol(n, **({"positive": True} if k in positive else {"real": True})) for k, n in enumerate(names)
    )
    p = tuple(Symbol(free_name(f"p_{s.name}", taken), real=True) for s in q)
    position, scales = build(q, c)
    between = (sp.Gt(q[k], low) & sp.Lt(q[k], high) for k, (low, high) in _BETWEEN.get(name, {}).items())
    return Chart(name, q, p, position, scales, Domain(tuple(between)))


Built = tuple[tuple[Expr, ...], tuple[Expr, ...]]


def _polar(q: Sequence[Symbol], _c: Expr) -> Built:
    r, phi = q
    return (r * cos(phi), r * sin(phi)), (sp.S.One, r**2)


def _parabolic(q: Sequence[Symbol], _c: Expr) -> Built:
    u, v = q
    return ((u**2 - v**2) / 2, u * v), (u**2 + v**2, u**2 + v**2)


def _elliptic(q: Sequence[Symbol], c: Expr) -> Built:
    u, v = q
    h = c**2 * (cosh(u) ** 2 - cos(v) ** 2)
    return (c * cosh(u) * cos(v), c * sinh(u) * sin(v)), (h, h)


def _spherical(q: Sequence[Symbol], _c: Expr) -> Built:
    r, theta, phi = q
    position = (r * sin(theta) * cos(phi), r * sin(theta) * sin(phi), r * cos(theta))
    return position, (sp.S.One, r**2, r**2 * sin(theta) ** 2)


def _cylindrical(q: Sequence[Symbol], _c: Expr) -> Built:
    rho, phi, z = q
    return (rho * cos(phi), rho * sin(phi), z), (sp.S.One, rho**2, sp.S.One)


def _paraboloidal(q: Sequence[Symbol], _c: Expr) -> Built:
    u, v, phi = q
    h = u**2 + v**2
    return (u * v * cos(phi), u * v * sin(phi), (u**2 - v**2) / 2), (h, h, u**2 * v**2)


def _prolate(q: Sequence[Symbol], c: Expr) -> Built:
    u, v, phi = q
    h = c**2 * (cosh(u) ** 2 - cos(v) ** 2)
    across = c * sinh(u) * sin(v)
    position = (across * cos(phi), across * sin(phi), c * cosh(u) * cos(v))
    return position, (h, h, c**2 * sinh(u) ** 2 * sin(v) ** 2)


_CHARTS: dict[str, tuple[Callable[[Sequence[Symbol], Expr], Built], tuple[str, ...], tuple[int, ...]]] = {
    "polar": (_polar, ("r", "phi"), (0,)),
    "parabolic": (_parabolic, ("u", "v"), (0, 1)),
    "elliptic": (_elliptic, ("u", "v"), (0,)),
    "spherical": (_spherical, ("r", "theta", "phi"), (0,)),
    "cylindrical": (_cylindrical, ("rho", "phi", "z"), (0,)),
    "paraboloidal": (_paraboloidal, ("u", "v", "phi"), (0, 1)),
    "prolate": (_prolate, ("u", "v", "phi"), (0,)),
}

_TURN, _HALF_TURN = (-sp.pi, sp.pi), (sp.S.Zero, sp.pi)
_BETWEEN: dict[str, dict[int, tuple[Expr, Expr]]] = {
    "polar": {1: _TURN},
    "elliptic": {1: _TURN},
    "spherical": {1: _HALF_TURN, 2: _TURN},
    "cylindrical": {1: _TURN},
    "paraboloidal": {2: _TURN},
    "prolate": {1: _HALF_TURN, 2: _TURN},
}
"""Between what the angles are one to one."""

_DIMENSION = {name: len(spelled) for name, (_, spelled, _) in _CHARTS.items()}
_FOCAL = ("elliptic", "prolate")
NAMES = tuple(_CHARTS)
"""What the classical coordinates are called."""
