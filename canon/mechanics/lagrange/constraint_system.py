"""Constraints f(q, t) = 0, g(q, q̇, t) = 0 and h ≥ 0: integrable or not, with the time in them or not, how many."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass, replace
from itertools import combinations, product
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import time_derivative, velocity
from canon.mechanics.algebra.all_vanish import vanish_together
from canon.mechanics.algebra.constraint_manifold import (
    Branch,
    EmptyDomainError,
    check_not_empty,
    check_whole,
    inhabited,
    on_manifold,
)
from canon.mechanics.algebra.linear import eliminate
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.lagrange.frobenius import Pfaffian, exterior_derivative
from canon.proof.continuity.smooth import PIECED, without_pieces
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import Status, Undecided, Verdict, all_hold
from canon.proof.trees.affine_form import is_affine

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian

__all__ = ["ConstraintSystem", "is_integrable", "positional_freedom"]

SECONDS = 10.0
"""Time for the questions about a system."""


@dataclass(frozen=True)
class ConstraintSystem:
    """Constraints on coordinates and velocities, and the time for questions about them.

    Parameters
    ----------
    q
        Coordinates.
    positions, velocities, inequalities
        f(q, t) = 0, g(q, q̇, t) = 0 and h = 0 at the edge of an inequality.
    domain
        Where they are meant.
    until
        When the questions should be answered, on the clock of ``time.monotonic``.
    t
        The time.

    Examples
    --------
    >>> from canon import Domain, coordinates
    >>> import time as clock
    >>> x, y, theta = q = coordinates("x y theta")
    >>> blade = x.dot * sp.sin(theta) - y.dot * sp.cos(theta)
    >>> t = sp.Symbol("t", real=True)
    >>> system = ConstraintSystem(q, (), (blade,), (), Domain(), clock.monotonic() + 10, t)
    >>> system.integrable.status.name, system.freedom("velocities"), system.freedom("positions")
    ('FAILS', 2, 3)
    """

    q: tuple[Symbol, ...]
    positions: tuple[Expr, ...]
    velocities: tuple[Expr, ...]
    inequalities: tuple[Expr, ...]
    domain: Domain
    until: float
    t: Symbol

    @property
    def rates(self) -> tuple[Expr, ...]:
        """What vanishes in every allowed velocity: ḟ and g."""
        return (*(time_derivative(f, self.q, self.t) for f in self.positions), *self.velocities)

    @cached_property
    def branches(self) -> list[Branch]:
        """The positions and velocities that are allowed."""
        v = tuple(velocity(x) for x in self.q)
        constraints = (*self.positions, *self.rates)
        return inhabited(on_manifold(constraints, self.domain, keep=(self.t,), prefer=v, until=self.until))

    @cached_property
    def forms(self) -> Pfaffian:
        """The constraints as forms in dq and dt."""
        v = {velocity(x): sp.S.Zero for x in self.q}
        rows = tuple((*(g.diff(u) for u in v), exchanged(g, v)) for g in self.rates)
        return Pfaffian(rows, (*self.q, self.t), self.domain)

    @cached_property
    def affine(self) -> Verdict:
        """Whether every constraint is affine in the velocities: by its form, or as Σ slope·v + rest is proved to be it.

        Second derivatives that vanish would not do: that of ẏ = atan(tan ẋ) does, which is no plane.
        """
        name, v = "affine in the velocities", [velocity(x) for x in self.q]
        doubtful = [g for g in self.velocities if not is_affine(g, v)]
        if not doubtful:
            return Verdict(Status.HOLDS, name, "structure")
        curved = self.all_vanish(name, [g.diff(a, b) for g in doubtful for a in v for b in v])
        if not curved.holds:
            return curved
        at_rest = dict.fromkeys(v, sp.S.Zero)
        rebuilt = [
            sp.Add(exchanged(g, at_rest), *(u * exchanged(g.diff(u), at_rest) for u in v)) for g in doubtful
        ]
        same = self.all_vanish(name, [g - plane for g, plane in zip(doubtful, rebuilt, strict=True)])
        return same if same.holds else replace(same, status=Status.UNDECIDED)

    @cached_property
    def integrable(self) -> Verdict:
        """Whether the constraints together restrict positions only: dω(X, Y) = 0 on allowed displacements."""
        if not self.velocities:
            check_not_empty(self.positions, self.q, self.domain, self.t)
            return Verdict(Status.HOLDS, "the constraints are integrable", "structure")
        if not self.affine.holds:
            return self._curved
        self.check_consistent()
        branches = self.branches
        verdicts = (
            self._vanish("dω on allowed displacements", self._curvatures(b), b.domain) for b in branches
        )
        return all_hold(verdicts, "the constraints are integrable")

    def _vanish(self, name: str, expressions: Iterable[Expr], domain: Domain) -> Verdict:
        left = max(0.05, self.until - clock.monotonic())
        return vanish_together(tuple(expressions), domain, left).about(name)

    def _curvatures(self, branch: Branch) -> Iterator[Expr]:
        """Yield dω(X, Y) where the constraints hold, for a basis of the displacements that are allowed there.

        The basis belongs to the forms on the branch: off it another pivot may divide by what vanishes there.
        """
        forms, z = self.forms.forms, self.forms.z
        here = sp.Matrix([[substitute(a, branch.values) for a in row] for row in forms])
        allowed = eliminate(here, domain=branch.domain).null_directions
        yield sp.S.Zero  # where nothing moves, nothing is curved
        for X, Y in combinations(allowed, 2):
            for form in forms:
                yield substitute(exterior_derivative(form, z, X, Y), branch.values)

    def check_consistent(self) -> None:
        """Refuse constraints such as ẋ = 0, ẋ = z, that contradict each other off positions they do not name."""
        whole = self.forms.forms
        if self.rank(whole) != self.rank([row[:-1] for row in whole]):
            raise Undecided(
                "the constraints contradict each other, or restrict positions by what they say together; "
                "write that as a constraint too"
            )

    @property
    def _curved(self) -> Verdict:
        """A set of velocities that is not flat belongs to no equation f(q, t) = 0, whose rate is affine."""
        if len(self.velocities) > 1 or self.positions:
            raise Undecided(
                "constraints that are not affine in the velocities are decided only one at a time; "
                "make a claim of each"
            )
        [g] = list(self.velocities)
        v = [velocity(x) for x in self.q]
        for bend, b in product(_second_form(g, v), self.branches):
            here = substitute(bend, b.values)
            flat = self._vanish("the curvature of the set of velocities", [here], b.domain)
            if flat.fails:
                return flat
        raise Undecided(
            "the constraint is not affine in the velocities, and was not proved to be curved; "
            "say the signs of its parameters, or solve it for a velocity"
        )

    def rank(self, rows: Sequence[Sequence[Expr]]) -> int:
        """Return the rank of some rows, the same off the constraints and on them."""
        matrix = sp.Matrix([list(row) for row in rows])
        if matrix.has(*PIECED) and not without_pieces(matrix.flat(), self.domain):
            raise Undecided(
                "the constraints hold functions with pieces, whose rank may differ from piece to piece; "
                "narrow the domain to one piece"
            )
        ranks = {eliminate(matrix, domain=self.domain).rank}
        for branch in self.branches if self.positions else ():
            here = matrix.applyfunc(lambda f, b=branch: substitute(f, b.values))
            ranks.add(eliminate(here, domain=branch.domain).rank)
        if len(ranks) > 1:
            raise Undecided(
                "the constraints become dependent where they hold; leave one out, or narrow the domain"
            )
        return ranks.pop()

    @cached_property
    def at_rest_in_time(self) -> Verdict:
        """Whether what is allowed does not depend on the time explicitly.

        What is allowed at one instant is allowed at every other: constraints are put at another instant t₁, and must
        vanish where they do at t, for all t and t₁ of the domain. Derivatives by t would not do: that of sign t is
        zero on both sides of the step.
        """
        later, v = self._later, [velocity(x) for x in self.q]
        check_whole([g for g in self.velocities if g.has(*PIECED)], v, self.domain)
        changing = [g for g in (*self.positions, *self.rates) if g.has(self.t)]
        verdict = self.all_vanish("free of the time", [exchanged(g, later) for g in changing], self._at_both)
        moving = [h for h in self.inequalities if h.has(self.t)]
        if verdict.fails and self.positions and self.velocities:
            self._check_regular()  # or more velocities were looked at than are allowed
        if not verdict.holds or not moving:
            return verdict
        sides = [side for h in moving for side in self._moves(h)]
        if any(side.fails for side in sides):
            return next(side for side in sides if side.fails)
        raise Undecided("whether the inequality depends on the time was not decided; narrow the domain")

    @cached_property
    def _later(self) -> dict[Symbol, Symbol]:
        """Another instant in place of the time."""
        return {self.t: sp.Dummy("t1", **self.t.assumptions0)}

    @property
    def _at_both(self) -> tuple[Boolean, ...]:
        """What the domain says of the other instant: all other symbols are in it at both."""
        return tuple(
            cast("Boolean", c.xreplace(self._later)) for c in self.domain.conditions if c.has(self.t)
        )

    def _moves(self, h: Expr) -> Iterator[Verdict]:
        """Yield whether h stays at zero on its edge, as far as the other inequalities leave it bare.

        Where ∂h/∂t does not vanish at the edge, h has another sign just before than just after; where h < 0 at
        another instant, the point is not allowed then, as it is on the edge.
        """
        others = [sp.Gt(other, 0) for other in self.inequalities if other != h]
        try:
            seen = Domain((*self.domain.conditions, *(c for c in others if c != sp.true)), self.domain.box)
            edge = on_manifold([*self.positions, h], seen, keep=(self.t,))
        except EmptyDomainError:
            return
        then = exchanged(h, self._later)
        for b in edge:
            yield self._vanish("∂/∂t", [substitute(h.diff(self.t), b.values)], b.domain)
            there = substitute(then, b.values)
            left = sp.Lt(there, 0)
            if left not in (sp.true, sp.false):
                forbidden = _narrowed(b, (*self._at_both, left))
                yield self._vanish("what is allowed at another time", [there], forbidden)

    def _check_regular(self) -> None:
        """Refuse constraints such as (x − t)² = 0, whose derivatives vanish where they hold."""
        v = [velocity(x) for x in self.q]
        for functions, variables in ((self.positions, self.q), (self.velocities, v)):
            slopes = sp.Matrix([[f.diff(x) for x in variables] for f in functions])
            for branch in self.branches if functions else ():
                here = slopes.applyfunc(lambda f, b=branch: substitute(f, b.values))
                if eliminate(here, domain=branch.domain).rank < eliminate(slopes, domain=self.domain).rank:
                    raise Undecided(
                        "the derivatives of the constraints vanish or become dependent where they hold; "
                        "write each without a power, as x − t = 0 instead of (x − t)² = 0"
                    )

    def all_vanish(self, name: str, expressions: Sequence[Expr], besides: Sequence[Boolean] = ()) -> Verdict:
        """Tell whether expressions vanish wherever the constraints, and some conditions besides, hold."""
        wanted = [e for e in expressions if e != 0]
        if not wanted:
            return Verdict(Status.HOLDS, name, "structure")
        verdicts = (
            self._vanish(
                name,
                [substitute(e, b.values) for e in wanted],
                _narrowed(b, besides),
            )
            for b in self.branches
        )
        return all_hold(verdicts, name)

    def freedom(self, counting: str) -> int:
        """Return the number of independent virtual displacements, or of positions that can be reached."""
        if not self.affine.holds:
            raise Undecided(
                "degrees of freedom are counted for constraints affine in the velocities; "
                "write these so, if they can be"
            )
        if not self.rates:
            return len(self.q)
        self.check_consistent()
        if counting == "velocities":
            return len(self.q) - self.rank([row[:-1] for row in self.forms.forms])
        return len(self.q) - self._restrictions()

    def _restrictions(self) -> int:
        whole = self.rank(self.forms.forms)
        if self.integrable.holds:
            return whole
        if self.integrable.undecided or self.positions:
            raise Undecided(
                "which combinations of the constraints are integrable was not decided; "
                "eliminate positions with those that hold no velocities"
            )
        return len(self.forms.holonomic_part.forms)


def _narrowed(branch: Branch, conditions: Sequence[Boolean]) -> Domain:
    """Return the domain of a branch with more conditions, in the symbols that are free there."""
    here = (cast("Boolean", c.subs(list(branch.values.items()), simultaneous=True)) for c in conditions)
    return Domain((*branch.domain.conditions, *(c for c in here if c != sp.true)), branch.domain.box)


def is_integrable(constrained: ConstrainedLagrangian, domain: Domain | None = None) -> Verdict:
    """Tell whether constraints on velocities can be integrated, all together, to constraints on positions.

    They are looked at where they hold, branch by branch: ẋ = z ẏ is integrable on z = 0, though not off it.

    Returns
    -------
    Verdict
        HOLDS where positions are restricted; FAILS where the constraints are truly nonholonomic, with a
        counterexample: a point where two allowed displacements do not close.

    Raises
    ------
    Undecided
        Where the constraints contradict each other, could not be solved, or hold functions with pieces.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    >>> from sympy import cos, sin
    >>> x, y, theta = coordinates("x y theta")
    >>> L = Lagrangian((x.dot**2 + y.dot**2 + theta.dot**2)/2, [x, y, theta])
    >>> blade = ConstrainedLagrangian(L, nonholonomic=[x.dot*sin(theta) - y.dot*cos(theta)])
    >>> rolling = ConstrainedLagrangian(L, nonholonomic=[x.dot - theta.dot])
    >>> is_integrable(blade).status.name, is_integrable(rolling).status.name
    ('FAILS', 'HOLDS')
    """
    return _system_of(constrained, domain).integrable


def positional_freedom(constrained: ConstrainedLagrangian, domain: Domain | None = None) -> int:
    """Return the dimension of the positions that can be reached: coordinates less restrictions of positions.

    Truly nonholonomic constraints restrict none; those that are holonomic in disguise do.

    Raises
    ------
    Undecided
        Where it was not decided which combinations of the constraints are integrable.

    Examples
    --------
    A unicycle reaches every place in every heading, although one velocity is barred:

    >>> from canon import Lagrangian, coordinates
    >>> from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    >>> from sympy import tan
    >>> x, y, theta = coordinates("x y theta")
    >>> L = Lagrangian((x.dot**2 + y.dot**2 + theta.dot**2)/2, [x, y, theta])
    >>> unicycle = ConstrainedLagrangian(L, nonholonomic=[y.dot - x.dot*tan(theta)])
    >>> positional_freedom(unicycle), unicycle.degrees_of_freedom
    (3, 2)
    """
    return _system_of(constrained, domain).freedom("positions")


def _system_of(constrained: ConstrainedLagrangian, domain: Domain | None) -> ConstraintSystem:
    q, t = constrained.lagrangian.q, constrained.lagrangian.t
    holonomic, nonholonomic = constrained.holonomic, constrained.nonholonomic
    return ConstraintSystem(q, holonomic, nonholonomic, (), as_domain(domain), clock.monotonic() + SECONDS, t)


def _second_form(g: Expr, v: Sequence[Symbol]) -> Iterator[Expr]:
    """Yield uᵀ (∂²g/∂v²) u for vectors u = gⱼ eᵢ − gᵢ eⱼ tangent to g = 0: zero where the set is flat."""
    slope = {u: g.diff(u) for u in v}
    for a, b in combinations(v, 2):
        yield (
            slope[b] ** 2 * g.diff(a, 2)
            - 2 * slope[a] * slope[b] * g.diff(a, b)
            + slope[a] ** 2 * g.diff(b, 2)
        )
