"""Routh's function: the Lagrangian after its ignorable coordinates are eliminated.

The momenta of ignorable coordinates are constant. Routh's function R = L − Σ p q̇ over them, with their velocities
eliminated for the constant momenta, is a Lagrangian of the other coordinates; the ignored ones follow by
quadrature, q = −∫ ∂R/∂p dt (E. J. Routh 1877; H. Goldstein, Classical Mechanics, § 8.3).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, cast, get_args

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import acceleration, momentum, time, time_derivative, velocity
from canon.expression.symbols.user_input import counted, given_kind
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols, plain_places
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.hamilton.legendre import check_momenta, eliminate_velocities
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.reduction.ignorable import ignorable_coordinates, is_ignorable
from canon.proof.domain.domain import Domain, as_domain

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Convention", "Routhian", "routhian"]

Convention = Literal["L-pq", "pq-L"]
"""The two signs of Routh's function in use: R = L − Σ p q̇, or R = Σ p q̇ − L."""


@dataclass(frozen=True)
class Routhian:
    """Routh's function of a system with ignorable coordinates.

    Parameters
    ----------
    R
        Routh's function in the sign of ``convention``.
    q
        The coordinates that remain.
    ignorable, momenta
        The ignorable coordinates and their constant momenta.
    convention
        ``"L-pq"`` or ``"pq-L"``.
    forces
        Generalized forces on the remaining coordinates.
    t
        The time.
    """

    R: Expr
    q: tuple[Symbol, ...]
    ignorable: tuple[Symbol, ...]
    momenta: tuple[Symbol, ...]
    convention: Convention = "L-pq"
    forces: tuple[Expr, ...] = ()
    t: Symbol = time

    @property
    def note(self) -> str:
        """In words, what was reduced."""
        if not self.ignorable:
            return (
                "no coordinate is ignorable, so R = L"
                if self._sign == 1
                else "no coordinate is ignorable, so R = −L"
            )
        pairs = ", ".join(f"{p} of {s}" for s, p in zip(self.ignorable, self.momenta, strict=True))
        total = len(self.q) + len(self.ignorable)
        return f"{len(self.ignorable)} of {total} coordinates ignored; constant momenta: {pairs}"

    @cached_property
    def lagrangian(self) -> Lagrangian:
        """L − Σ p q̇ as the Lagrangian of the remaining coordinates, at constant momenta."""
        return Lagrangian(self._sign * self.R, self.q, self.forces or None, self.t)

    @property
    def equations(self) -> tuple[Expr, ...]:
        """The reduced equations of the remaining coordinates, each expression = 0."""
        return self.lagrangian.equations

    @cached_property
    def effective_potential(self) -> Expr:
        """The part of −(L − Σ p q̇) without the remaining velocities: V and what the momenta add to it."""
        return -exchanged(self.lagrangian.L, dict.fromkeys(self.lagrangian.velocities, sp.S.Zero))

    @cached_property
    def gyroscopic(self) -> tuple[Expr, ...]:
        """The coefficients of the terms of R linear in the remaining velocities; nothing potential does their work."""
        at_rest = dict.fromkeys(self.lagrangian.velocities, sp.S.Zero)
        return tuple(exchanged(p, at_rest) for p in self.lagrangian.momenta)

    @cached_property
    def ignorable_velocities(self) -> tuple[Expr, ...]:
        """The velocities of the ignorable coordinates as functions of the rest, q̇ = −∂(L − Σ p q̇)/∂p."""
        return tuple(-self._sign * self.R.diff(p) for p in self.momenta)

    def quadrature(self, motion: Mapping[Symbol, Expr], start: Mapping[Symbol, Expr]) -> tuple[Expr, ...]:
        """Return the ignorable coordinates as functions of time along a known motion of the others.

        Parameters
        ----------
        motion
            Each remaining coordinate as an expression in ``t``.
        start
            The values of the ignorable coordinates at t = 0.

        Returns
        -------
        tuple of sympy.Expr
            Integrals that SymPy's tables do not have stay as ``Integral``.

        Raises
        ------
        ValueError
            Where a remaining coordinate has no motion, or an ignorable one no start.
        """
        motion = plain_places(motion, self.q, self.ignorable, self.t)
        start = plain_places(start, self.q, self.ignorable, self.t)
        for what, known, needed in (("motion", motion, self.q), ("start", start, self.ignorable)):
            if missing := [str(s) for s in needed if s not in known]:
                raise ValueError(f"no {what} is given of {', '.join(missing)}; give one of each")
        along = {s: motion[s] for s in self.q} | {velocity(s): motion[s].diff(self.t) for s in self.q}
        return tuple(
            start[s] + _integral_from_zero(substitute(rate, along), self.t)
            for s, rate in zip(self.ignorable, self.ignorable_velocities, strict=True)
        )

    def quadrature_at(
        self,
        motion: Callable[[NDArray[np.float64]], tuple[NDArray[np.float64], NDArray[np.float64]]],
        times: Sequence[float],
        start: Sequence[float],
        parameters: Mapping[Symbol, float],
    ) -> NDArray[np.float64]:
        """Return the ignorable coordinates at times, by Gauss–Legendre quadrature with 8 nodes an interval.

        Parameters
        ----------
        motion
            A function of an array of times, shape ``(m,)``, that returns positions and velocities of the
            remaining coordinates, each of shape ``(n, m)``.
        times
            Increasing times; ``start`` holds at the first.
        start
            One value for each ignorable coordinate.
        parameters
            Numbers for the parameters and the constant momenta.

        Returns
        -------
        ndarray
            Of shape ``(ignorable, times)``.
        """
        import numpy as np

        from canon.expression.graph.graph import Graph

        graph = Graph()
        nodes = [graph.from_sympy(rate) for rate in self.ignorable_velocities]
        points, weights = np.polynomial.legendre.leggauss(8)
        edges = np.asarray(times, dtype=np.float64)
        half = np.diff(edges) / 2
        when = (edges[:-1] + half)[:, None] + half[:, None] * points
        q, v = motion(when.ravel())
        values = {**parameters, self.t: when.ravel()}
        values |= dict(zip(self.q, q, strict=True)) | dict(zip(self.lagrangian.velocities, v, strict=True))
        rates = [np.broadcast_to(f, when.size).reshape(when.shape) for f in graph.evaluate(nodes, values)]
        steps = np.array([(rate @ weights) * half for rate in rates])
        first = np.asarray(start, dtype=np.float64)[:, None]
        return first + np.concatenate([np.zeros_like(first), np.cumsum(steps, axis=1)], axis=1)

    @property
    def _sign(self) -> int:
        return 1 if self.convention == "L-pq" else -1

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle R = {sp.latex(self.R)}$"


def routhian(
    lagrangian: Lagrangian,
    ignorable: Sequence[Symbol] | None = None,
    momenta: Sequence[Symbol] | None = None,
    convention: Convention = "L-pq",
    domain: Domain | None = None,
) -> Routhian:
    """Return Routh's function with the velocities of the ignorable coordinates eliminated.

    Parameters
    ----------
    lagrangian
        A Lagrangian without non-potential forces on the ignorable coordinates.
    ignorable
        The coordinates to ignore; all ignorable ones unless given. With none, R = L, and ``note`` says so.
    momenta
        Symbols for their constant momenta; ``q.momentum`` unless given.
    convention
        ``"L-pq"`` for R = L − Σ p q̇, ``"pq-L"`` for its negative.
    domain
        Where L is meant.

    Raises
    ------
    ValueError
        Where a coordinate is not known to be ignorable, or a momentum is called as another symbol in L is.
    LegendreError
        Where the velocities cannot be eliminated.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, parameters
    >>> r, phi = coordinates("r phi")
    >>> m = parameters("m", positive=True)
    >>> central = routhian(Lagrangian(m*(r.dot**2 + r**2*phi.dot**2)/2, [r, phi]))
    >>> central.R, central.effective_potential
    (m*r_dot**2/2 - p_phi**2/(2*m*r**2), p_phi**2/(2*m*r**2))
    """
    if convention not in get_args(Convention):
        raise ValueError(f"convention {convention!r} is unknown; write 'L-pq' or 'pq-L'")
    given_kind(lagrangian, Lagrangian, "what routhian() reduces")
    ignored, p = _ignored(lagrangian, ignorable, momenta, domain)
    rest, t = tuple(s for s in lagrangian.q if s not in ignored), lagrangian.t
    pairs = dict(zip(lagrangian.q, lagrangian.forces, strict=False))
    forces = tuple(pairs[s] for s in rest) if pairs else ()
    if not ignored:
        same = lagrangian.L if convention == "L-pq" else -lagrangian.L
        return Routhian(same, rest, (), (), convention, forces, t)
    velocities = [velocity(s) for s in ignored]
    # The shortest diagonal entry of the Hessian first: the pivots after it stay short.
    order = sorted(range(len(ignored)), key=lambda i: int(sp.count_ops(lagrangian.L.diff(velocities[i], 2))))
    negative = eliminate_velocities(
        lagrangian.L,
        [velocities[i] for i in order],
        [p[i] for i in order],
        as_domain(domain),
        "L",
        "ignorable velocities",
    )
    R = -negative if convention == "L-pq" else negative
    forces = _without_ignored(forces, {s: negative.diff(x) for s, x in zip(ignored, p, strict=True)}, rest, t)
    return Routhian(R, rest, ignored, p, convention, forces, t)


def _without_ignored(
    forces: Sequence[Expr], rates: Mapping[Symbol, Expr], rest: Sequence[Symbol], t: Symbol
) -> tuple[Expr, ...]:
    """Return forces in which the ignored velocities are these rates, and their accelerations what these make them."""
    if not forces:
        return ()
    through = {velocity(s): rate for s, rate in rates.items()}
    through |= {acceleration(s): time_derivative(rate, rest, t) for s, rate in rates.items()}
    return tuple(exchanged(Q, through) for Q in forces)


def _ignored(
    lagrangian: Lagrangian,
    ignorable: Sequence[Symbol] | None,
    momenta: Sequence[Symbol] | None,
    domain: Domain | None,
) -> tuple[tuple[Symbol, ...], tuple[Symbol, ...]]:
    """Return the coordinates to ignore, each proved ignorable, and the symbols of their momenta."""
    ignored = (
        coordinate_symbols(ignorable) if ignorable is not None else ignorable_coordinates(lagrangian, domain)
    )
    for s in ignored:
        verdict = is_ignorable(lagrangian, s, domain)
        if not verdict.holds:
            raise ValueError(
                f"{s} is not ignorable: {verdict.feedback or verdict.status.name}; leave it out of ignorable"
            )
    p = coordinate_symbols(momenta) if momenta is not None else tuple(momentum(s) for s in ignored)
    if len(p) != len(ignored):
        raise ValueError(
            f"{counted(len(p), 'momentum', 'momenta')} for "
            f"{counted(len(ignored), 'ignorable coordinate')}; each needs one"
        )
    check_momenta(p, lagrangian, "routhian(L, [phi], momenta=[…])")
    return ignored, p


def _integral_from_zero(f: Expr, t: Symbol) -> Expr:
    """Return ∫₀ᵗ f, by SymPy's table where it has it."""
    from sympy.integrals.manualintegrate import manualintegrate
    from sympy.simplify.fu import TR8  # products of sines and cosines into sums

    named: dict[Expr, Expr] = {}
    waves = sp.expand(TR8(_constants_named(cast("Expr", sp.expand(f)), named, t)))
    found = sp.Add(*(manualintegrate(term, t) for term in sp.Add.make_args(waves)))
    if found.has(sp.Integral, sp.Piecewise):
        s = sp.Dummy("s", real=True)
        return sp.Integral(exchanged(f, {t: s}), (s, 0, t))
    values = {name: constant for constant, name in named.items()}
    return exchanged(found - exchanged(found, {t: sp.S.Zero}), values)


def _constants_named(f: Expr, named: dict[Expr, Expr], t: Symbol) -> Expr:
    """Exchange compound constants for symbols, so that the tables do not ask whether they vanish."""
    if not f.has(t):
        return f if f.is_number else named.setdefault(f, sp.Dummy(real=True, nonzero=True))
    if f == t:
        return f
    return f.func(*(_constants_named(cast("Expr", part), named, t) for part in f.args))
