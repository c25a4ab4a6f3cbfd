"""Lagrangians whose velocity Hessian is singular: what the momenta and the motion then have to satisfy.

Where M n = 0, the momenta p = ∂L/∂q̇ are bound by primary constraints, n·(p − b) = 0 for L = ½ q̇ᵀM q̇ + b·q̇ − V, and
Lagrange's equations hold no acceleration along n: n·(bias) = 0 restricts positions and velocities
(P. A. M. Dirac, Lectures on Quantum Mechanics, ch. 1).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbol import momentum
from canon.mechanics.dynamicsymbols import coordinate_symbols
from canon.mechanics.linear import eliminate
from canon.mechanics.substitution import exchanged

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.mechanics.lagrangian import Lagrangian
    from canon.proof.domain import Domain

__all__ = ["Singularity", "singularity"]


@dataclass(frozen=True)
class Singularity:
    """What a Lagrangian leaves undetermined.

    Parameters
    ----------
    rank
        The rank of the velocity Hessian M at generic points.
    null_directions
        A basis of the n(q, t) with M n = 0; none where L is regular.
    primary_constraints
        Functions of q, p, t, each = 0, that the momenta satisfy whatever the velocities.
    motion_constraints
        The combinations n·(d/dt ∂L/∂q̇ − ∂L/∂q − Q), each = 0, which hold no acceleration.
    q
        The coordinates.
    """

    rank: int
    null_directions: tuple[tuple[Expr, ...], ...]
    primary_constraints: tuple[Expr, ...]
    motion_constraints: tuple[Expr, ...]
    q: tuple[Symbol, ...]

    def __str__(self) -> str:
        n = len(self.q)
        if self.rank == n:
            return f"L is regular: its Hessian has the rank {n}, every velocity follows from the momenta"
        lines = [f"L is singular: its Hessian has the rank {self.rank} for {n} coordinates"]
        lines += [f"  primary constraint: {c} = 0" for c in self.primary_constraints]
        lines += [f"  without accelerations: {c} = 0" for c in self.motion_constraints]
        return "\n".join(lines)


def singularity(
    lagrangian: Lagrangian, p: Sequence[Symbol] | None = None, domain: Domain | None = None
) -> Singularity:
    """Return the null directions of the velocity Hessian and the primary constraints they make.

    Parameters
    ----------
    lagrangian
        A Lagrangian at most quadratic in the velocities.
    p
        Symbols for the momenta; ``q.momentum`` unless given.
    domain
        Where L is meant.

    Raises
    ------
    ValueError
        Where L is not quadratic in the velocities: the primary constraints are not linear in the momenta then.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> x, y = coordinates("x y")
    >>> print(singularity(Lagrangian((x.dot - y)**2/2, [x, y])))
    L is singular: its Hessian has the rank 1 for 2 coordinates
      primary constraint: p_y = 0
      without accelerations: x_dot - y = 0
    """
    M, v = lagrangian.mass_matrix, lagrangian.velocities
    if M.has(*v):
        raise ValueError(
            "the Hessian of L depends on the velocities; primary constraints are found only for L at most "
            "quadratic in them"
        )
    symbols = coordinate_symbols(p) if p is not None else tuple(momentum(s) for s in lagrangian.q)
    reduced = eliminate(M, domain=domain)
    at_rest = dict.fromkeys(v, sp.S.Zero)
    shifts = [s - exchanged(b, at_rest) for s, b in zip(symbols, lagrangian.momenta, strict=True)]
    null = reduced.null_directions
    primary = tuple(_along(n, shifts) for n in null)
    motion = tuple(sp.factor_terms(_along(n, lagrangian.bias)) for n in null)
    return Singularity(reduced.rank, null, primary, motion, lagrangian.q)


def _along(direction: Sequence[Expr], components: Sequence[Expr]) -> Expr:
    return sp.expand_mul(sp.Add(*(n * c for n, c in zip(direction, components, strict=True))))
