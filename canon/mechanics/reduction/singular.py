"""Singular Lagrangians, with a singular velocity Hessian: what momenta and motion then have to satisfy.

Where M n = 0, the momenta p = ∂L/∂q̇ are bound by primary constraints, and Lagrange's equations hold no acceleration
along n: n·(bias) = 0 restricts positions and velocities, or is an identity, and then the motion along n is arbitrary
(P. A. M. Dirac, Lectures on Quantum Mechanics, ch. 1). For L = ½ q̇ᵀM q̇ + b·q̇ − V the constraints are n·(p − b) = 0.
For any other L, such as those homogeneous of degree 1 in q̇, as many velocities as M has rank are eliminated for their
momenta; Σ pₐ q̇ₐ − L is then linear in the velocities that remain, and its slopes are −p_b.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, product
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.symbol import acceleration, momentum
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols
from canon.mechanics.algebra.linear import SingularMatrixError, eliminate
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.hamilton.legendre import LegendreError, eliminate_velocities
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.mechanics.lagrange.lagrangian import Lagrangian

__all__ = ["Singularity", "singularity"]


@dataclass(frozen=True)
class Singularity:
    """Null directions of a singular Lagrangian, and the constraints that follow from them.

    Parameters
    ----------
    rank
        The rank of the velocity Hessian M at generic points.
    null_directions
        A basis of the n(q, t) with M n = 0; none where L is regular.
    primary_constraints
        Functions of q, p, t, each = 0, that the momenta satisfy whatever the velocities.
    motion_constraints
        The combinations n·(d/dt ∂L/∂q̇ − ∂L/∂q − Q), each = 0, which hold no acceleration; 0 where the combination
        vanishes identically, so that the motion along n is arbitrary (a change of parameter, a gauge).
    q
        The coordinates.
    hamiltonian
        The canonical Hamiltonian Σ p q̇ − L on the primary constraints; None where L is regular
        (:func:`canon.mechanics.hamilton.legendre_pair.hamiltonian` gives it then) or it was not found in closed form.
    """

    rank: int
    null_directions: tuple[tuple[Expr, ...], ...]
    primary_constraints: tuple[Expr, ...]
    motion_constraints: tuple[Expr, ...]
    q: tuple[Symbol, ...]
    hamiltonian: Expr | None = None

    def __str__(self) -> str:
        n = len(self.q)
        if self.rank == n:
            return f"L is regular: its Hessian has the rank {n}, every velocity follows from the momenta"
        lines = [f"L is singular: its Hessian has the rank {self.rank} for {counted(n, 'coordinate')}"]
        lines += [f"  primary constraint: {c} = 0" for c in self.primary_constraints]
        lines += [
            f"  without accelerations: {c} = 0"
            if c != 0
            else f"  the motion along ({', '.join(map(str, n))}) is arbitrary: Lagrange's equations hold an identity"
            for n, c in zip(self.null_directions, self.motion_constraints, strict=True)
        ]
        return "\n".join(lines)


def singularity(
    lagrangian: Lagrangian, p: Sequence[Symbol] | None = None, domain: Domain | None = None
) -> Singularity:
    """Return the null directions of the velocity Hessian and the primary constraints they make.

    Parameters
    ----------
    lagrangian
        The Lagrangian.
    p
        Symbols for the momenta; ``q.momentum`` unless given.
    domain
        Where L is meant; for an L not quadratic in the velocities it decides between branches.

    Raises
    ------
    ValueError
        Where L is not quadratic in the velocities and the constraints were not found in closed form, or L is singular
        and forces hold accelerations.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> x, y = coordinates("x y")
    >>> print(singularity(Lagrangian((x.dot - y)**2/2, [x, y])))
    L is singular: its Hessian has the rank 1 for 2 coordinates
      primary constraint: p_y = 0
      without accelerations: x_dot - y = 0

    A free relativistic particle, its path in any parameter:

    >>> from canon import parameters
    >>> from canon.proof.domain.domain import Domain
    >>> t, x = coordinates("t x")
    >>> m, c = parameters("m c", positive=True)
    >>> free = Lagrangian(-m*c*sp.sqrt(c**2*t.dot**2 - x.dot**2), [t, x], t=sp.Symbol("tau", real=True))
    >>> print(singularity(free, domain=Domain((t.dot > 0, c*t.dot > x.dot, c*t.dot > -x.dot))))
    L is singular: its Hessian has the rank 1 for 2 coordinates
      primary constraint: c*sqrt(c**2*m**2 + p_x**2) + p_t = 0
      the motion along (t_dot, x_dot) is arbitrary: Lagrange's equations hold an identity
    """
    domain = as_domain(domain)
    symbols = coordinate_symbols(p) if p is not None else tuple(momentum(s) for s in lagrangian.q)
    reduced = eliminate(lagrangian.mass_matrix, domain=domain)
    null = reduced.null_directions
    if not null:
        return Singularity(reduced.rank, (), (), (), lagrangian.q)
    accelerations = [acceleration(s) for s in lagrangian.q]
    if any(Q.has(*accelerations) for Q in lagrangian.forces):
        raise ValueError(
            f"L is singular, but forces hold accelerations ({', '.join(map(str, accelerations))}), so the combinations "
            "along its null directions hold them too; look at lagrangian.inertia and lagrangian.accelerations"
        )
    motion = tuple(_simplest(_along(n, lagrangian.bias), domain) for n in null)
    if lagrangian.mass_matrix.has(*lagrangian.velocities):
        primary, H = _by_elimination(lagrangian, symbols, reduced.rank, domain)
        return Singularity(reduced.rank, null, primary, motion, lagrangian.q, H)
    at_rest = dict.fromkeys(lagrangian.velocities, sp.S.Zero)
    shifts = [s - exchanged(b, at_rest) for s, b in zip(symbols, lagrangian.momenta, strict=True)]
    R = _partial(lagrangian, symbols, reduced.pivots, domain)
    return Singularity(
        reduced.rank,
        null,
        tuple(_along(n, shifts) for n in null),
        motion,
        lagrangian.q,
        None if R is None else exchanged(R, at_rest),
    )


def _by_elimination(
    lagrangian: Lagrangian, p: tuple[Symbol, ...], rank: int, domain: Domain
) -> tuple[tuple[Expr, ...], Expr]:
    """Return primary constraints and the canonical Hamiltonian, both proved."""
    there = dict(zip(p, lagrangian.momenta, strict=True))
    n = len(lagrangian.q)
    for pivots in combinations(range(n), rank):
        R = _partial(lagrangian, p, pivots, domain)
        for primary, H in () if R is None else _candidates(R, lagrangian, p, pivots):
            claims = [
                *(substitute(f, there) for f in primary),
                substitute(H, there) - lagrangian.jacobi_energy,
            ]
            if all(vanishes_off_kinks(claim, domain).holds for claim in claims):
                return primary, _simplest(H, domain)
    raise ValueError(
        f"L is singular (its Hessian has the rank {rank} for {counted(n, 'coordinate')}), "
        "and its primary constraints were not "
        "found in closed form on this domain; narrow it with conditions that choose the branch, such as the sign of "
        "a velocity"
    )


def _candidates(
    R: Expr, lagrangian: Lagrangian, p: Sequence[Symbol], pivots: Sequence[int]
) -> Iterator[tuple[tuple[Expr, ...], Expr]]:
    """Yield p_b + ∂R/∂q̇_b and R − Σ q̇_b ∂R/∂q̇_b for each choice of the signs of the q̇_b, all they can depend on."""
    pairs = [(lagrangian.velocities[b], p[b]) for b in range(len(p)) if b not in pivots]
    rest = R - sp.Add(*(v * R.diff(v) for v, _ in pairs))
    for signs in product((1, -1), repeat=len(pairs)):
        values = {v: sp.Integer(sign) for (v, _), sign in zip(pairs, signs, strict=True)}
        yield (
            tuple(sp.factor_terms(b + exchanged(R.diff(v), values)) for v, b in pairs),
            exchanged(rest, values),
        )


def _partial(
    lagrangian: Lagrangian, p: Sequence[Symbol], pivots: Sequence[int], domain: Domain
) -> Expr | None:
    """Return R = Σ pₐ q̇ₐ − L over the pivots, their velocities eliminated; None where that was not possible."""
    old, new = [lagrangian.velocities[j] for j in pivots], [p[j] for j in pivots]
    if not old:
        return -lagrangian.L
    try:
        return eliminate_velocities(lagrangian.L, old, new, domain, "L", "velocities")
    except (LegendreError, SingularMatrixError):
        return None


def _simplest(f: Expr, domain: Domain) -> Expr:
    """Return 0 where f certainly vanishes, and else f with common factors taken out."""
    return sp.S.Zero if vanishes_off_kinks(f, domain).holds else sp.factor_terms(f)


def _along(direction: Sequence[Expr], components: Sequence[Expr]) -> Expr:
    return sp.expand_mul(sp.Add(*(n * c for n, c in zip(direction, components, strict=True))))
