"""Claims about the class of constraints and the number of degrees of freedom.

Holonomic: all constraints are equations that restrict positions, velocities entering at most as the rate of such an
equation (Frobenius' theorem decides that, all constraints together); an inequality is not (H. Goldstein, Classical
Mechanics, § 1.3). Rheonomic: what is allowed depends explicitly on the time. Unilateral: an inequality.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.manifold import Branch, on_manifold
from canon.exercise.question import Deadline, Part, Question, Same, Stated, decide, fails, opposite
from canon.expression.symbol import acceleration, time_derivative, velocity
from canon.mechanics.frobenius import Pfaffian
from canon.mechanics.linear import eliminate
from canon.mechanics.substitution import exchanged, substitute
from canon.proof.verdict import Status, Undecided, Verdict, all_hold

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.exercise.reading import Reading
    from canon.proof.domain import Domain

__all__ = ["constraint_class", "degrees_of_freedom"]

_PAIRS = (("holonomic", "nonholonomic"), ("scleronomic", "rheonomic"), ("bilateral", "unilateral"))
_RELATION = re.compile(r"(<=|>=|<|>|=|≤|≥|\\leq?\b|\\geq?\b)")


@dataclass(frozen=True)
class _Constraints:
    """Constraints f(q, t) = 0, g(q, q̇, t) = 0 and h ≥ 0, and the time for questions about them."""

    q: tuple[Symbol, ...]
    t: Symbol
    positions: tuple[Expr, ...]
    velocities: tuple[Expr, ...]
    inequalities: tuple[Expr, ...]
    domain: Domain
    deadline: Deadline

    @property
    def rates(self) -> tuple[Expr, ...]:
        """What vanishes in every allowed velocity: ḟ and g."""
        return (*(time_derivative(f, self.q, self.t) for f in self.positions), *self.velocities)

    @cached_property
    def branches(self) -> list[Branch]:
        """The positions and velocities that are allowed."""
        v = tuple(velocity(x) for x in self.q)
        found = on_manifold((*self.positions, *self.rates), self.domain, keep=(self.t,), prefer=v)
        if not found:
            raise Undecided("no position and velocity was found that satisfies the constraints")
        return found

    @cached_property
    def forms(self) -> Pfaffian:
        """The constraints as forms in dq and dt."""
        v = {velocity(x): sp.S.Zero for x in self.q}
        rows = tuple((*(g.diff(u) for u in v), exchanged(g, v)) for g in self.rates)
        return Pfaffian(rows, (*self.q, self.t), self.domain)

    @cached_property
    def affine(self) -> Verdict:
        """Whether every constraint is affine in the velocities."""
        v = [velocity(x) for x in self.q]
        seconds = [g.diff(a, b) for g in self.velocities for a in v for b in v]
        return self.all_vanish("affine in the velocities", seconds)

    @cached_property
    def integrable(self) -> Verdict:
        """Whether the constraints together restrict positions only: dω(X, Y) = 0 on allowed displacements."""
        if not self.velocities:
            return Verdict(Status.HOLDS, "the constraints are integrable", "structure")
        if not self.affine.holds:
            return self._curved
        if self.positions:
            self.rank(self.forms.forms)  # refuses where it is another off the constraints
        values = [value for _, row in self.forms.curvatures for value in row]
        return self.all_vanish("the constraints are integrable", values)

    @property
    def _curved(self) -> Verdict:
        """A set of velocities that is not flat belongs to no equation f(q, t) = 0, whose rate is affine."""
        if len(self.velocities) > 1 or self.positions:
            raise Undecided(
                "constraints that are not affine in the velocities are decided only one at a time"
            )
        [g] = list(self.velocities)
        v = [velocity(x) for x in self.q]
        bends = tuple(Part("the curvature of the set of velocities", c) for c in _second_form(g, v))
        parts = [(replace(bend, through=b.values), b.domain) for bend in bends for b in self.branches]
        for part, domain in parts:
            flat = decide(Same((part,), domain), self.deadline)
            if flat.fails:
                return flat
        raise Undecided("the constraint is not affine in the velocities, and was not proved to be curved")

    def rank(self, rows: Sequence[Sequence[Expr]]) -> int:
        """Return the rank of some rows, the same off the constraints and on them."""
        matrix = sp.Matrix([list(row) for row in rows])
        ranks = {eliminate(matrix, domain=self.domain).rank}
        for branch in self.branches if self.positions else ():
            here = matrix.applyfunc(lambda f, b=branch: substitute(f, b.values))
            ranks.add(eliminate(here, domain=branch.domain).rank)
        if len(ranks) > 1:
            raise Undecided("the constraints become dependent where they hold")
        return ranks.pop()

    @cached_property
    def at_rest_in_time(self) -> Verdict:
        """Whether what is allowed does not depend on the time explicitly."""
        verdict = self.all_vanish(
            "free of the time", [g.diff(self.t) for g in (*self.positions, *self.rates)]
        )
        moving = [h for h in self.inequalities if h.has(self.t)]
        if verdict.holds and (self.positions or self.velocities):
            self._check_regular()
        if not verdict.holds or not moving:
            return verdict
        sides = [
            decide(Same((Part("∂/∂t", h.diff(self.t), through=b.values),), b.domain), self.deadline)
            for h in moving
            for b in on_manifold([*self.positions, h], self.domain, keep=(self.t,))
        ]
        if any(side.fails for side in sides):
            return next(side for side in sides if side.fails)
        raise Undecided("whether the inequality depends on the time was not decided")

    def _check_regular(self) -> None:
        """Refuse constraints such as (x − t)² = 0, whose derivatives vanish where they hold."""
        v = [velocity(x) for x in self.q]
        for functions, variables in ((self.positions, self.q), (self.velocities, v)):
            slopes = sp.Matrix([[f.diff(x) for x in variables] for f in functions])
            for branch in self.branches if functions else ():
                here = slopes.applyfunc(lambda f, b=branch: substitute(f, b.values))
                if eliminate(here, domain=branch.domain).rank < eliminate(slopes, domain=self.domain).rank:
                    raise Undecided(
                        "the derivatives of the constraints vanish or become dependent where they hold"
                    )

    def all_vanish(self, name: str, expressions: Sequence[Expr]) -> Verdict:
        """Tell whether expressions vanish wherever the constraints hold."""
        wanted = [e for e in expressions if e != 0]
        if not wanted:
            return Verdict(Status.HOLDS, name, "structure")
        parts = [[Part(name, e, through=b.values) for e in wanted] for b in self.branches]
        verdicts = (
            decide(Same(tuple(some), b.domain), self.deadline)
            for some, b in zip(parts, self.branches, strict=True)
        )
        return all_hold(verdicts, name)

    def freedom(self, counting: str) -> int:
        """Return the number of independent virtual displacements, or of positions that can be reached."""
        if not self.affine.holds:
            raise Undecided("degrees of freedom are counted for constraints affine in the velocities")
        if not self.rates:
            return len(self.q)
        if counting == "velocities":
            return len(self.q) - self.rank([row[:-1] for row in self.forms.forms])
        return len(self.q) - self._restrictions()

    def _restrictions(self) -> int:
        whole = self.rank(self.forms.forms)
        if self.integrable.holds:
            return whole
        if self.integrable.undecided or self.positions:
            raise Undecided(
                "which combinations of the constraints are integrable was not decided; eliminate positions"
            )
        return len(self.forms.holonomic_part.forms)


def constraint_class(reading: Reading) -> Iterator[Question]:
    """Each word of the claim is right for the constraints as a whole."""
    constraints = _constraints(reading)
    known = {word for pair in _PAIRS for word in pair}
    right: list[str] = []
    verdicts: list[Verdict] = []
    for i, word in enumerate(reading.claim.keys["class"]):
        if word not in known:
            reading.fault(f"class[{i}]", f"should be one of {', '.join(sorted(known))}")
        pair = next(pair for pair in _PAIRS if word in pair)
        first = _first_of(pair, constraints)
        right.append(pair[0] if first.holds else pair[1] if first.fails else "?")
        verdict = first if word == pair[0] else opposite(first, "")
        verdicts.append(verdict.about(word))
        if verdict.fails:
            said = Verdict(
                Status.FAILS,
                word,
                verdict.certificate if verdict.counterexample else "exact",
                verdict.residual,
                verdict.counterexample,
                feedback=_why(right[-1], constraints),
            )
            yield Stated(said, lambda: ", ".join(right))
            return
    yield Stated(all_hold(verdicts))


def degrees_of_freedom(reading: Reading) -> Iterator[Question]:
    """n coordinates less the constraints that are independent; ``positions`` counts only those that are integrable."""
    constraints = _constraints(reading)
    counting = reading.word("counting") if reading.has("counting") else "velocities"
    if counting not in ("velocities", "positions"):
        reading.fault("counting", "write velocities or positions")
    claimed = reading.expression("dof")
    if not isinstance(claimed, sp.Integer):
        reading.fault("dof", "should be a whole number")
    right = constraints.freedom(counting)
    if int(claimed) == right:
        yield Verdict(Status.HOLDS, "degrees of freedom", "exact")
        return
    n, m = len(constraints.q), len(constraints.q) - right
    what = f"constraint{'s' * (m != 1)}" + (" on positions" if counting == "positions" else "")
    why = f"{n} coordinates less {m} independent {what} leave {right}, not {claimed}"
    names = {"velocities": "independent virtual displacements", "positions": "positions that can be reached"}
    other = next(key for key in names if key != counting)
    try:
        if constraints.freedom(other) == int(claimed):
            why += f"; {claimed} is the number of {names[other]}"
    except Undecided:  # then the feedback says less
        pass
    yield Stated(fails("degrees of freedom", why), lambda: sp.Integer(right))


def _constraints(reading: Reading) -> _Constraints:
    q, t = reading.symbols("q"), reading.time
    given = reading.claim.keys.get("constraints", [])
    texts = given if isinstance(given, list) else [given]
    equations: list[Expr] = []
    inequalities: list[Expr] = []
    for i, text in enumerate(texts):
        latex = str(text).strip().startswith("$")
        pieces = _RELATION.split(str(text).strip().strip("$") if latex else str(text))
        sides = reading.inside(f"constraints[{i}]", [f"${p}$" if latex else p for p in pieces[::2]])
        relations = pieces[1::2]
        if len(sides) == 1:
            equations.append(sides[0])
        for left, relation, right in zip(sides, relations, sides[1:], strict=False):
            target = equations if relation == "=" else inequalities
            target.append(left - right)
        if any(side.has(*(acceleration(x) for x in q)) for side in sides):
            reading.fault(f"constraints[{i}]", "a constraint holds no accelerations")
    v = tuple(velocity(x) for x in q)
    for i, f in enumerate((*equations, *inequalities)):
        if not f.has(*q, *v):
            reading.fault(f"constraints[{i}]", "this constrains no coordinate and no velocity")
    return _Constraints(
        q,
        t,
        tuple(f for f in equations if not f.has(*v)),
        tuple(g for g in equations if g.has(*v)),
        tuple(inequalities),
        reading.domain,
        Deadline.after(0.8 * reading.claim.budget),
    )


def _second_form(g: Expr, v: Sequence[Symbol]) -> Iterator[Expr]:
    """Yield uᵀ (∂²g/∂v²) u for vectors u = gⱼ eᵢ − gᵢ eⱼ tangent to g = 0: zero where the set is flat."""
    slope = {u: g.diff(u) for u in v}
    for a, b in combinations(v, 2):
        yield (
            slope[b] ** 2 * g.diff(a, 2)
            - 2 * slope[a] * slope[b] * g.diff(a, b)
            + slope[a] ** 2 * g.diff(b, 2)
        )


def _first_of(pair: tuple[str, str], constraints: _Constraints) -> Verdict:
    """Return whether the first word of a pair is the right one."""
    one_sided = bool(constraints.inequalities)
    if pair[0] == "scleronomic":
        return constraints.at_rest_in_time
    if one_sided:
        return fails(pair[0], "")
    if pair[0] == "bilateral":
        return Verdict(Status.HOLDS, "bilateral", "structure")
    return constraints.integrable


def _why(right: str, constraints: _Constraints) -> str:
    """Say why a word is the right one."""
    match right:
        case "holonomic" if constraints.velocities:
            return "holonomic: the constraint on the velocities is integrable, it is the rate of one on positions"
        case "holonomic":
            return "holonomic: equations among the coordinates and the time only"
        case "nonholonomic" if constraints.inequalities:
            why = "nonholonomic: an inequality is no equation among the coordinates"
            return f"{why} (some call it holonomic and unilateral)"
        case "nonholonomic":
            return "nonholonomic: the constraint on the velocities is not integrable"
        case "scleronomic":
            return "scleronomic: the time does not occur explicitly"
        case "rheonomic":
            return "rheonomic: the time occurs explicitly"
        case "unilateral":
            return "unilateral: an inequality leaves one side free"
        case _:
            return "bilateral: the constraints are equations"
