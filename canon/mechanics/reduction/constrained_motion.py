"""Motions on a constraint manifold: accelerations, multipliers and forces of constraint, first integrals put in.

Lagrange's equations with multipliers and the constraints differentiated, d/dt ∂L/∂q̇ − ∂L/∂q = Q + Σ λₐ aₐ and
A q̈ + b = 0, are linear in accelerations and multipliers. They are solved on each branch of the manifold where the
constraints and their rates vanish; first integrals with their values restrict it further, to the motions of one start.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from canon.expression.symbols.symbol import acceleration, time_derivative
from canon.expression.symbols.user_input import given_kind
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.constraint_manifold import Branch, check_whole, inhabited, on_manifold
from canon.mechanics.algebra.dynamicsymbols import plain
from canon.mechanics.algebra.jets import jets_of, with_jets
from canon.mechanics.algebra.linear import solve_affine
from canon.mechanics.algebra.substitution import as_tuple, exchanged, substitute, symbols_of
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Symbol

__all__ = ["MotionOnManifold", "constrained_motions", "motions_with_integrals"]


@dataclass(frozen=True)
class MotionOnManifold:
    """Motion on one branch of the constraint manifold, as functions of what stays free on it.

    Parameters
    ----------
    branch
        Positions and velocities that the constraints and integrals determine, and the domain of the others.
    solution
        The accelerations and the multipliers, by their symbols.
    unknown
        The symbols of the multipliers, of holonomic constraints first.
    forces, integral_rates
        Σ λₐ aₐ and the rates of the first integrals as they are written, in positions, velocities and unknowns.
    jets
        The symbols that stand for arbitrary functions and their derivatives.
    """

    branch: Branch
    solution: Mapping[Symbol, Expr]
    unknown: tuple[Symbol, ...]
    forces: tuple[Expr, ...]
    integral_rates: tuple[Expr, ...]
    jets: Mapping[Expr, Symbol]

    @property
    def multipliers(self) -> tuple[Expr, ...]:
        """The multipliers, of holonomic constraints first, in the order of the constraints."""
        return tuple(self.solution[s] for s in self.unknown)

    @property
    def reactions(self) -> tuple[Expr, ...]:
        """The generalized forces of constraint Σ λₐ aₐ, one a coordinate."""
        return tuple(self.along(force) for force in self.forces)

    @property
    def rates(self) -> tuple[Expr, ...]:
        """The rates of the first integrals, which vanish on a motion that keeps them."""
        return tuple(self.along(rate) for rate in self.integral_rates)

    def along(self, f: Expr) -> Expr:
        """Return a function of positions, velocities, accelerations and multipliers on the motion."""
        return substitute(exchanged(f, self.jets), {**self.branch.values, **self.solution})


def constrained_motions(
    constrained: ConstrainedLagrangian,
    integrals: Sequence[Expr] | Expr = (),
    domain: Domain | None = None,
    budget: float = 10.0,
) -> list[MotionOnManifold]:
    """Return the motions that constraints allow, one a branch of their manifold, first integrals put in.

    Unlike :attr:`canon.mechanics.lagrange.constraint.ConstrainedLagrangian.multipliers` the results hold on the
    constraints alone and are as short as these make them; integrals with their values, such as the energy of a start
    from rest, take velocities away too. Any consistent units.

    Parameters
    ----------
    constrained
        The system and its constraints.
    integrals
        Expressions in q, q̇ and t that vanish on the motions meant: first integrals less their values.
    domain
        Where the motions are meant.
    budget
        Seconds for the proof that the integrals are constant.

    Raises
    ------
    ValueError
        Where an integral is not proved constant along the motion.
    EmptyDomainError
        Where no point satisfies constraints and integrals.
    Undecided
        Where a constraint can't be solved for any symbol in closed form, or holds for all velocities at some places.

    Examples
    --------
    A particle slides off a sphere from rest at the top, to either side; the sphere pushes as long as 3 cos θ > 2:

    >>> from canon import ConstrainedLagrangian, Lagrangian, coordinates, parameters
    >>> r, theta = coordinates("r theta")
    >>> m, g, a = parameters("m g a", positive=True)
    >>> L = Lagrangian(m*(r.dot**2 + r**2*theta.dot**2)/2 - m*g*r*sp.cos(theta), [r, theta])
    >>> sphere = ConstrainedLagrangian(L, holonomic=[r - a])
    >>> from_rest = m*a**2*theta.dot**2/2 + m*g*a*sp.cos(theta) - m*g*a
    >>> [motion.multipliers[0].factor() for motion in constrained_motions(sphere, from_rest)]
    [g*m*(3*cos(theta) - 2), g*m*(3*cos(theta) - 2)]
    """
    given_kind(constrained, ConstrainedLagrangian, "the system")
    lagrangian = constrained.lagrangian
    held = tuple(plain(f, lagrangian.q, lagrangian.t) for f in as_tuple(integrals))
    unknown = [sp.Dummy(f"lambda_{i}", real=True) for i in range(1, constrained.directions.rows + 1)]
    found = list(motions_with_integrals(constrained, held, unknown, as_domain(domain)))
    for motion in found:
        claims = [(f"d/dt ({f}) = 0", rate) for f, rate in zip(held, motion.rates, strict=True)]
        kept = all_vanish(claims, "the integrals are constant", motion.branch.domain, budget / len(found))
        if not kept.holds:
            raise ValueError(f"an integral is not proved constant along the motion: {kept.feedback or kept}")
    return found


def motions_with_integrals(
    constrained: ConstrainedLagrangian,
    integrals: Sequence[Expr],
    multipliers: Sequence[Symbol],
    domain: Domain,
    beside: Sequence[Expr] = (),
) -> Iterator[MotionOnManifold]:
    """Yield the motions on each branch of the manifold; that integrals are constant is left to be asked of ``rates``.

    Parameters
    ----------
    constrained, integrals, domain
        As :func:`constrained_motions` takes them.
    multipliers
        Their symbols, of holonomic constraints first.
    beside
        Expressions with arbitrary functions that are to be seen along the motion.
    """
    q, v, t = constrained.lagrangian.q, constrained.lagrangian.velocities, constrained.lagrangian.t
    a = tuple(acceleration(x) for x in q)
    system, rates = (
        constrained.equations_of_motion(multipliers),
        [time_derivative(f, q, t) for f in integrals],
    )
    jets = jets_of((*system, *constrained.manifold, *integrals, *rates, *beside), domain, t)

    def plain_in_jets(expressions: Sequence[Expr]) -> tuple[Expr, ...]:
        return tuple(exchanged(f, jets) for f in expressions)

    manifold, held = plain_in_jets(constrained.manifold), plain_in_jets(integrals)
    forces, domain = plain_in_jets(constrained.reactions_of(multipliers)), with_jets(domain, jets)
    check_whole([*plain_in_jets((*constrained.holonomic, *constrained.nonholonomic)), *held], v, domain)
    for branch in inhabited(_with_integrals(on_manifold(manifold, domain, (t,), v), held, v, t)):
        here = [substitute(e, branch.values) for e in plain_in_jets(system)]
        solution = solve_affine(here, (*a, *multipliers), branch.domain)
        yield MotionOnManifold(branch, solution, tuple(multipliers), forces, tuple(rates), jets)


def _with_integrals(
    branches: Sequence[Branch], integrals: Sequence[Expr], v: Sequence[Symbol], t: Symbol
) -> Iterator[Branch]:
    """Restrict the manifold to given values of first integrals, solved for velocities where that can be done."""
    for branch in branches:
        here = [substitute(f, branch.values) for f in integrals]
        others = [s for s in symbols_of(*here) if s not in v]
        try:
            parts = on_manifold(here, branch.domain, (t, *others), v)
        except Undecided:
            parts = on_manifold(here, branch.domain, (t,), v)
        for part in parts:
            values = {s: substitute(f, part.values) for s, f in branch.values.items()}
            yield Branch({**values, **part.values}, part.domain)
