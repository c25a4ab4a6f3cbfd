"""Questions of proof that a claim comes down to, and their answers."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeAlias, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.question.deadline import SIDE_SECONDS
from canon.exercise.question.equation_systems import same_equations
from canon.expression.symbols.magnitude import written
from canon.expression.symbols.symbol import Momentum
from canon.frozen_mapping import FrozenMapping
from canon.mechanics.algebra.linear import is_regular
from canon.mechanics.algebra.substitution import substitute
from canon.proof.analytic import proved_sign
from canon.proof.domain.verdict import Status, Undecided, Verdict, all_hold
from canon.proof.kinks import off_kinks, vanishes_off_kinks
from canon.proof.vanish import equal, vanishes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from canon.exercise.question.deadline import Deadline
    from canon.proof.domain.domain import Domain

__all__ = [
    "COMPLETE",
    "TELLING",
    "Answer",
    "Chain",
    "Determines",
    "Differ",
    "Part",
    "Question",
    "Regular",
    "Same",
    "SameEquations",
    "Stated",
    "Tells",
    "decide",
    "fails",
    "more_than_zero",
    "opposite",
    "wrong_variables",
]

TELLING = "the answer says something about the motion"
COMPLETE = "the answer determines every unknown"
_SMALL = 3
"""Rows of a matrix of which it is said where it is singular."""

Answer: TypeAlias = "Callable[[], object]"
"""Finds the right answer; called only where a claim fails."""


@dataclass(frozen=True)
class Part:
    """One component of an answer: ``claimed``, seen through a substitution, should equal ``right``.

    Parameters
    ----------
    name
        What a person would call it.
    claimed
        The expression as it was given.
    right
        What it should equal, after the substitution.
    through
        The substitution, such as p = ∂L/∂q̇ or q̈ = the true accelerations.
    key
        Where the claim has the expression, such as ``claim[0]``; empty where it follows from what was claimed.
    written
        How the claim writes what a symbol of the expression stands for.
    bracket_of
        The names of the two new variables whose bracket it is; empty where it is none.
    """

    name: str
    claimed: Expr
    right: Expr = sp.S.Zero
    through: Mapping[Symbol, Expr] = field(default_factory=lambda: FrozenMapping({}))
    key: str = ""
    written: Mapping[Symbol, Expr] = field(default_factory=lambda: FrozenMapping({}))
    bracket_of: tuple[str, ...] = ()

    def seen(self, expression: Expr) -> Expr:
        """Return an expression after the substitution."""
        return substitute(expression, self.through)

    @property
    def determined(self) -> tuple[Symbol, ...]:
        """The accelerations and multipliers among the replaced symbols."""
        return tuple(s for s in self.through if not isinstance(s, Momentum))

    @property
    def residual(self) -> Expr:
        """What vanishes where the component is right."""
        return self.seen(self.claimed) - self.right


@dataclass(frozen=True)
class Same:
    """All these components are right.

    Parameters
    ----------
    parts, domain
        The components, and where they are meant.
    answer
        What would be right.
    said
        A sentence on a component that was refuted, where no better diagnosis is found.
    answers
        The key that the answer stands under, where it is told only once the claim is judged to hold with it.
    """

    parts: tuple[Part, ...]
    domain: Domain
    answer: Answer | None = None
    said: Callable[[Part], str] | None = None
    answers: str = ""


@dataclass(frozen=True)
class SameEquations:
    """Two systems, affine in the unknowns, have the same solutions at generic points.

    Parameters
    ----------
    claimed, right, unknowns
        The systems, and what they determine.
    domain
        Where they are meant.
    answer
        The right equations as they are shown.
    written
        The equations under ``claim`` as they stand there; none where the claimed system follows from something
        else, and then there is no equation to repair.
    through
        What their symbols are in terms of those of the systems, such as p = ∂L/∂q̇.
    before
        How many equations of the claimed system stand before those that were written.
    time
        The time, where the rates of equations that bind the state are meant to follow from them.
    """

    claimed: tuple[Expr, ...]
    right: tuple[Expr, ...]
    unknowns: tuple[Symbol, ...]
    domain: Domain
    answer: Answer | None = None
    written: tuple[Expr, ...] = ()
    through: Mapping[Symbol, Expr] = field(default_factory=lambda: FrozenMapping({}))
    before: int = 0
    time: Symbol | None = None


@dataclass(frozen=True)
class Regular:
    """A matrix is regular at generic points.

    Parameters
    ----------
    matrix, domain
        The matrix, and where.
    name
        What a person would call it.
    singular_is
        What is said where it is singular everywhere.
    exceptions
        Whether it is said where it may be singular.
    """

    matrix: sp.MatrixBase
    name: str
    domain: Domain
    singular_is: str = ""
    exceptions: bool = False


@dataclass(frozen=True)
class Stated:
    """A verdict that was reached elsewhere, and what would be right."""

    verdict: Verdict
    answer: Answer | None = None


@dataclass(frozen=True)
class Differ:
    """A component is not what it is compared with: its residual does not vanish identically."""

    part: Part
    domain: Domain
    feedback: str


@dataclass(frozen=True)
class Tells:
    """An answer says something: not all of these questions, true of anything at all where they hold, hold.

    Parameters
    ----------
    trivial
        What would hold if the answer were true of every motion, whatever the system.
    feedback
        What an answer that says nothing follows from.
    """

    trivial: tuple[Same | SameEquations, ...]
    feedback: str = "it is true of anything"


@dataclass(frozen=True)
class Determines:
    """An answer leaves none of the unknowns of its kind open.

    Parameters
    ----------
    left_open
        Tells in sentences what stays open.
    wanted
        Whether a complete answer is wanted; otherwise what stays open is only told.
    """

    left_open: Callable[[], tuple[str, ...]]
    wanted: bool = False


@dataclass(frozen=True)
class Chain:
    """Two sides of a chain ``a = b = c`` in an answer are the same; ``said`` is told where they are not.

    Sides that are the same only by the equations of motion, or on the constraints, are answers each by itself:
    ``otherwise`` yields what the left one comes down to as the answer.
    """

    part: Part
    domain: Domain
    said: str
    otherwise: Callable[[], Iterator[Question]] = field(default=lambda: iter(()), compare=False)


Question: TypeAlias = Chain | Same | SameEquations | Regular | Stated | Differ | Tells | Determines | Verdict


def wrong_variables(f: Expr, foreign: Sequence[Symbol], name: str, variables: str) -> Iterator[Verdict]:
    """Yield FAILS where an answer depends on variables that it can't depend on; otherwise nothing."""
    found = [str(s) for s in foreign if f.has(s)]
    if found:
        why = f"{name} is a function of {variables}; {', '.join(found)} must be eliminated"
        yield Verdict(
            Status.FAILS, f"the variables of {name}", certificate="structure", residual=f, feedback=why
        )


def more_than_zero(equations: Sequence[Expr], domain: Domain) -> Tells:
    """Return the question whether equations say more than 0 = 0."""
    return Tells((Same(tuple(Part(f"equation {i}", e) for i, e in enumerate(equations, 1)), domain),))


def opposite(verdict: Verdict, feedback: str) -> Verdict:
    """Return the verdict on the opposite claim; an open question stays open.

    Examples
    --------
    >>> opposite(Verdict(Status.HOLDS, "x = y", "exact"), "they are equal").feedback
    'they are equal'
    """
    if verdict.undecided:
        return verdict
    if verdict.holds:
        return Verdict(
            Status.FAILS, verdict.question, verdict.certificate, assumed=verdict.assumed, feedback=feedback
        )
    return Verdict(Status.HOLDS, verdict.question, verdict.certificate)


def fails(question: str, feedback: str, residual: Expr | None = None) -> Verdict:
    """Return FAILS for what is wrong by its form or by an exact count."""
    return Verdict(Status.FAILS, question, "exact", residual, feedback=feedback)


def decide(question: Question, deadline: Deadline) -> Verdict:
    """Return the verdict on one question of proof that a claim comes down to."""
    match question:
        case Verdict():
            return question
        case Stated(verdict):
            return verdict
        case Differ(part, domain, feedback):
            verdict = replace(vanishes_off_kinks(part.residual, domain, deadline.left), feedback="")
            return opposite(verdict.about(part.name), feedback)
        case Tells(trivial, feedback):
            return _tells(trivial, feedback, deadline)
        case Determines(left_open):
            found = left_open()
            why = "; ".join(found)
            return fails(COMPLETE, why) if found else Verdict(Status.HOLDS, COMPLETE, "structure")
        case Same():
            return _all_vanish(question, deadline)
        case Chain(part, domain, said, otherwise):
            verdict = _all_vanish(Same((part,), domain), deadline)
            if not verdict.fails:
                return verdict
            asks = (each for each in otherwise() if not isinstance(each, Determines | Tells))
            other = [decide(each, deadline) for each in asks]
            if not other or any(each.fails for each in other):
                return replace(verdict, feedback=said)
            return all_hold(other, part.name)  # which may be open
        case SameEquations(claimed, right, unknowns, domain, before=before, time=t):
            return same_equations(claimed, right, unknowns, domain, deadline, before, t)
        case Regular(matrix, name, domain, singular_is, exceptions):
            off = off_kinks(matrix.flat(), domain)
            seen = matrix.applyfunc(off.seen)
            verdict = off.ask(lambda there: is_regular(seen, there, name), by_point=Status.HOLDS)
            if verdict.holds and exceptions:
                return replace(verdict, assumed=(*verdict.assumed, *_singular_places(matrix, name, domain)))
            everywhere = verdict.fails and "null direction" in {e.kind for e in verdict.evidence}
            return replace(verdict, feedback=singular_is or verdict.feedback) if everywhere else verdict


def _singular_places(matrix: sp.MatrixBase, name: str, domain: Domain) -> Iterator[str]:
    """Yield where a small matrix may be singular, unless it is proved to be regular everywhere."""
    if matrix.rows > _SMALL:
        return
    determinant = cast("Expr", matrix.det(method="berkowitz"))
    ways = (determinant, cast("Expr", sp.expand_trig(determinant)))
    if determinant.is_nonzero or any(proved_sign(way, domain) in ("+", "-") for way in ways):
        return
    yield f"{name} is singular where {written(determinant)} = 0; what is claimed is judged elsewhere"


def _tells(trivial: Sequence[Same | SameEquations], feedback: str, deadline: Deadline) -> Verdict:
    open_ = False
    for question in trivial:
        verdict = decide(question, deadline)
        if verdict.fails:
            return Verdict(Status.HOLDS, TELLING, verdict.certificate)
        open_ = open_ or verdict.undecided
    if open_:
        raise Undecided("whether the answer says more than what is true of every motion was not decided")
    return fails(TELLING, f"this says nothing about the motion: {feedback}")


def _all_vanish(question: Same, deadline: Deadline) -> Verdict:
    """Ask for all components at once, so that one that is easily refuted spares the long proofs of the others."""
    parts, said = question.parts, question.said
    sides = [(part.seen(part.claimed), part.right) for part in parts]
    off = off_kinks([side for pair in sides for side in pair], question.domain)
    residuals = [off.seen(claimed - right) for claimed, right in sides]
    verdict = off.ask(lambda there: vanishes(sp.Matrix(residuals), there, budget=deadline.left))
    verdict = replace(verdict, feedback="")
    if verdict.holds:
        return verdict
    turned = next((p for p, r in zip(parts, residuals, strict=True) if r == verdict.residual), None)
    if turned is None:
        return verdict
    if verdict.fails and turned.right != 0:  # ask again for the values of both sides
        seen, right = (off.seen(side) for side in (turned.seen(turned.claimed), turned.right))
        both = equal(seen, right, off.strictly, budget=SIDE_SECONDS)
        verdict = replace(verdict, counterexample=both.counterexample or verdict.counterexample)
    if verdict.fails and said is not None:
        verdict = replace(verdict, feedback=said(turned))
    return verdict.about(turned.name)
