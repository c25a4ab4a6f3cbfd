"""Hidden constraints: what follows for positions and velocities where equations do not determine all accelerations.

Equations of motion that no accelerations solve at a generic state bind the state; the rates of what they bind are
equations too, and may bind more (P. A. M. Dirac, Can. J. Math. 2 (1950) 129; reduction of the index of a
differential-algebraic system). Where nothing new comes, there is a motion through every generic state that is left.
"""

from __future__ import annotations

import time as clock
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from canon.expression.symbols.symbol import acceleration, time_derivative, velocity
from canon.mechanics.algebra.constraint_manifold import Branch, check_whole, inhabited, on_manifold
from canon.mechanics.algebra.linear import SingularMatrixError, eliminate
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.proof.domain.verdict import Undecided
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.mechanics.algebra.linear import Elimination
    from canon.mechanics.lagrange.lagrangian import Lagrangian
    from canon.proof.domain.domain import Domain

__all__ = ["Motions", "all_motions", "motions_of"]

MOST_ROUNDS = 5
SECONDS = 1.0
"""Time for the question whether one condition is new."""


@dataclass(frozen=True)
class Motions:
    """All motions of a system of equations.

    Parameters
    ----------
    branch
        The states through which there are motions.
    solution
        Accelerations and multipliers there; those that are not among them are free.
    """

    branch: Branch
    solution: Mapping[Symbol, Expr]

    @property
    def through(self) -> dict[Symbol, Expr]:
        """What is determined, in terms of what is free."""
        return {**self.branch.values, **self.solution}


def all_motions(
    system: Sequence[Expr],
    held: Sequence[Expr],
    q: Sequence[Symbol],
    unknowns: Sequence[Symbol],
    domain: Domain,
    t: Symbol,
) -> Motions:
    """Return the states and accelerations of all motions of equations that are affine in the unknowns.

    Equations of which no combination binds the state anew, nor do the rates of what binds it, are solved by
    accelerations at each state that is left, however the free ones are chosen: a vector field tangent to these states.
    So what does not vanish at one of them is refuted by a motion, and what vanishes at all of them holds on every one.

    Parameters
    ----------
    system, held
        Equations of motion, and constraints on positions and velocities, with the rates of those on positions.
    q, unknowns
        Coordinates; accelerations and multipliers.
    domain, t
        Where it is meant, and the time.

    Raises
    ------
    Undecided
        Where the states fall into several branches, nothing comes to an end, or a question is not decided.
    EmptyDomainError
        Where there are no motions.

    Examples
    --------
    >>> from canon import Domain, coordinates
    >>> x, y = q = coordinates("x y")
    >>> t = sp.Symbol("t", real=True)
    >>> all_motions([x.dot + y, y.dot - x], [], q, [x.ddot, y.ddot], Domain(), t).solution
    {x_ddot: -x, y_ddot: -y}
    """
    v, known = [velocity(x) for x in q], list(held)
    for _ in range(MOST_ROUNDS):
        branch = _where(known, v, domain, (t, *unknowns))
        rates = [time_derivative(g, q, t) for g in known if g.has(*v)]
        echelon = _in_echelon([*system, *rates], unknowns, branch)
        new = [sp.numer(sp.together(f)) for f in _left_over(echelon) if _is_new(f, branch.domain)]
        if not new:
            return Motions(branch, _solved(echelon.rows[: echelon.rank], echelon.pivots, unknowns))
        if none := [f for f in new if not f.has(*q, *v)]:
            raise Undecided(f"the equations ask for {none[0]} = 0, so that there is no motion")
        known += [*new, *(time_derivative(f, q, t) for f in new if not f.has(*v))]
    raise Undecided("the equations bind the state further with every rate that is taken")


def motions_of(lagrangian: Lagrangian, domain: Domain) -> Motions:
    """Return all motions of a Lagrangian with its forces, also where its equations bind the state.

    Raises
    ------
    Undecided
        As in :func:`all_motions`, or where a force is not affine in the accelerations.
    EmptyDomainError
        Where there are no motions.

    Examples
    --------
    >>> from canon import Domain, Lagrangian, coordinates
    >>> x, u = coordinates("x u")
    >>> motions_of(Lagrangian(u*x.dot - u**2/2 - x**2/2, [x, u]), Domain()).through
    {u_dot: -x, x_dot: u, x_ddot: -x, u_ddot: -u}
    """
    unknowns = tuple(acceleration(x) for x in lagrangian.q)
    try:
        solved: dict[sp.Symbol, Expr] = dict(zip(unknowns, lagrangian.accelerations, strict=True))
    except SingularMatrixError:
        return all_motions(lagrangian.equations, (), lagrangian.q, unknowns, domain, lagrangian.t)
    return Motions(Branch({}, domain), solved)


def _in_echelon(equations: Sequence[Expr], unknowns: Sequence[Symbol], branch: Branch) -> Elimination:
    here = [substitute(e, branch.values) for e in equations]
    slopes = [[e.diff(u) for u in unknowns] for e in here]
    rests = [exchanged(e, dict.fromkeys(unknowns, sp.S.Zero)) for e in here]
    _check_affine(here, slopes, rests, unknowns, branch.domain)
    return eliminate(sp.Matrix(slopes), sp.Matrix(rests), branch.domain)


def _left_over(echelon: Elimination) -> list[Expr]:
    """Return what vanishes of combinations in which no unknown is left."""
    return [row[-1] for row in echelon.rows[echelon.rank :]]


def _where(known: Sequence[Expr], v: Sequence[Symbol], domain: Domain, keep: Sequence[Symbol]) -> Branch:
    """Return the one branch of the states at which conditions hold."""
    check_whole(known, v, domain)
    branches = inhabited(on_manifold(known, domain, keep=keep, prefer=v))
    if len(branches) != 1:
        raise Undecided("the equations bind the state to several branches; split the claim by the domain")
    return branches[0]


def _is_new(f: Expr, domain: Domain) -> bool:
    verdict = vanishes_off_kinks(f, domain, SECONDS)
    if verdict.undecided:
        raise Undecided(f"whether the equations bind the state by {f} = 0 was not decided")
    return verdict.fails


def _check_affine(
    equations: Sequence[Expr],
    slopes: Sequence[Sequence[Expr]],
    rests: Sequence[Expr],
    unknowns: Sequence[Symbol],
    domain: Domain,
) -> None:
    """Refuse equations that are not slopes · u + rest with slopes free of the unknowns."""
    until = clock.monotonic() + SECONDS
    for equation, row, rest in zip(equations, slopes, rests, strict=True):
        affine = sp.Add(*(a * u for a, u in zip(row, unknowns, strict=True)), rest)
        left = max(0.1, until - clock.monotonic())
        if (
            any(a.has(*unknowns) for a in row)
            or not vanishes_off_kinks(equation - affine, domain, left).holds
        ):
            raise Undecided(f"{equation} = 0 is not affine in the accelerations")


def _solved(
    rows: Sequence[Sequence[Expr]], pivots: Sequence[int], unknowns: Sequence[Symbol]
) -> dict[Symbol, Expr]:
    """Return the unknowns of the pivots of an echelon form by back substitution, the last first."""
    found: dict[Symbol, Expr] = {}
    for row, pivot in reversed(list(zip(rows, pivots, strict=True))):
        others = [a * u for j, (a, u) in enumerate(zip(row, unknowns, strict=False)) if j != pivot]
        value = substitute(-sp.Add(*others, row[-1]) / row[pivot], found)
        found[unknowns[pivot]] = sp.cancel(value) if value.is_rational_function() else value
    return {u: found[u] for u in unknowns if u in found}
