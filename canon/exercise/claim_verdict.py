"""Judge of a claim: the kind says what must vanish, the proof room decides whether it does."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING

from canon.exercise.question.answer import links, other_variables
from canon.exercise.question.answer_values import without_value
from canon.exercise.question.deadline import Deadline, Worked
from canon.exercise.question.question import Determines, Question, Stated, Tells, decide
from canon.exercise.sheet.key_shapes import faults, with_plain_names
from canon.exercise.sheet.kind import named_function
from canon.exercise.sheet.quantities.given_functions import key_at
from canon.exercise.sheet.reading import InvalidClaim, Reading
from canon.exercise.sheet.sheet import Claim, ClaimError
from canon.expression.parse import LanguageError, parse_expression
from canon.expression.symbols.user_input import NotFiniteError, given_kind
from canon.mechanics.algebra.constraint_manifold import EmptyDomainError
from canon.mechanics.algebra.linear import SingularMatrixError
from canon.proof.domain.verdict import Evidence, Status, Undecided, Verdict, all_hold

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Finding", "InvalidClaim", "examine", "examined", "judge", "questions"]

_ONE_VALUE = ("energy_rate", "T", "values", "force", "J", "omega")
"""Keys whose answers are values, equal on the motion, on the constraints or at its energy if both are right."""


@dataclass(frozen=True)
class Finding:
    """A verdict on a claim, the question on which it turned where it FAILS, and how many held before it.

    ``asked`` has every question with its answer, in the order they were asked; ``beside`` what was not asked,
    because no complete answer is wanted; ``start`` when the judgement began.
    """

    reading: Reading
    verdict: Verdict
    question: Question | None = None
    held: int = 0
    asked: tuple[tuple[Question, Verdict], ...] = ()
    beside: tuple[Determines, ...] = ()
    start: Worked = field(default_factory=Worked.now, compare=False)

    def left_open(self) -> tuple[str, ...]:
        """Return in sentences what the answer leaves open, as far as that can be told."""
        found: list[str] = []
        for question in self.beside:
            with suppress(Undecided):
                found += question.left_open()
        return tuple(dict.fromkeys(found))


def questions(reading: Reading) -> Iterator[Question]:
    """Yield everything that a claim comes down to.

    Raises
    ------
    InvalidClaim
        Where the claim does not say something that could be judged.
    """
    for _, question in _asked(reading):
        yield question


def _asked(reading: Reading) -> Iterator[tuple[Reading, Question]]:
    """Yield every question with the claim, of the upper or of the lower signs, that comes down to it."""
    for signed in reading.signs:
        for question in _of_one_sign(signed):
            yield signed, question


def _of_one_sign(reading: Reading) -> Iterator[Question]:
    """Yield what a claim without ``±`` comes down to."""
    yield from other_variables(reading)
    judge_of_kind = named_function("canon.exercise.judges", reading.kind.judge)
    inside = {"ask": questions} if reading.kind.about else {}
    for question in judge_of_kind(reading, **inside):
        asked = isinstance(question, Determines)
        yield replace(question, wanted=reading.complete) if asked else question
    yield from links(reading, partial(_with_side, reading))


def _with_side(reading: Reading, place: str, text: str) -> Iterator[Question]:
    """Yield what a claim comes down to with another side of a chain as its answer; nothing where that can't be one.

    Only of answers that have one value on every motion: two constants of the motion need not be equal.
    """
    if key_at(place) not in _ONE_VALUE:
        return
    with suppress(InvalidClaim, LanguageError):
        side = parse_expression(text, reading.scope)
        judge_of_kind = named_function("canon.exercise.judges", reading.kind.judge)
        yield from judge_of_kind(reading.with_instead(place, side))


def judge(claim: Claim) -> Verdict:
    """Judge one claim of a sheet.

    Parameters
    ----------
    claim
        A claim as :func:`canon.read_sheet` gives it. Its ``expect`` is not looked at.

    Returns
    -------
    Verdict
        HOLDS or FAILS, or UNDECIDED with what is known; ``feedback`` says in one sentence where a false
        claim is wrong, where that was found and proved.

    Raises
    ------
    InvalidClaim
        Where the claim does not say something that could be judged; ``error`` names key and column.

    Examples
    --------
    >>> from canon.exercise import Claim
    >>> print(judge(Claim("a", "equality-only", {"lhs": "sin(t)**2", "rhs": "1 - cos(t)**2"})))
    HOLDS ...
    """
    return examine(claim).verdict


def examine(claim: Claim) -> Finding:
    """Judge one claim, and keep the question on which it turned.

    Raises
    ------
    InvalidClaim
        As :func:`judge` does.
    """
    given_kind(claim, Claim, "what is judged", "write Claim(id, kind, keys), or ask expect(kind, …)")
    if claim.errors:
        raise InvalidClaim(claim.errors[0])
    claim = replace(claim, keys=with_plain_names(claim.kind, claim.keys))
    for key, reason in faults(claim.kind, claim.keys):  # a claim made by hand was not looked at before
        raise InvalidClaim(ClaimError(claim.id, key, reason, file=claim.file))
    deadline, reading = Deadline.after(claim.budget), Reading.of(claim)
    if reading.has("dimensions"):
        from canon.exercise.question.declared_dimensions import declared_dimensions

        declared_dimensions(reading)  # refused before anything is judged, whatever the answer
    return examined(reading, deadline)


def examined(reading: Reading, deadline: Deadline) -> Finding:
    """Judge a claim that was read, such as one with other answers put in, and keep the question on which it turned.

    Raises
    ------
    InvalidClaim
        Where nothing is claimed, or the domain is empty.
    """
    start, claim = time.monotonic(), reading.claim
    answered: list[Verdict] = []
    asked: list[tuple[Question, Verdict]] = []
    beside: list[Determines] = []
    turned: Question | None = None
    named, held = "", 0
    try:
        answered += [lack for signed in reading.signs for lack in without_value(signed, deadline)]
        asks = () if any(verdict.fails for verdict in answered) else _asked(reading)
        for number, (signed, question) in enumerate(asks):
            if isinstance(question, Determines) and not question.wanted:
                beside.append(question)
                continue
            verdict = decide(question, deadline)
            if isinstance(question, Determines | Tells) and verdict.holds:
                continue
            named = (
                verdict.question if isinstance(question, Stated) and verdict.holds and not answered else ""
            )
            answered.append(verdict)
            asked.append((question, verdict))
            if verdict.fails:
                turned, held, reading = question, number, signed
                break
    except (Undecided, NotFiniteError) as reason:
        answered.append(Verdict(Status.UNDECIDED, evidence=(Evidence("open", str(reason)),)))
    except (SingularMatrixError, EmptyDomainError) as error:
        raise InvalidClaim(ClaimError(claim.id, "", str(error), file=claim.file)) from error
    if not answered:
        raise InvalidClaim(ClaimError(claim.id, "", "nothing is claimed", file=claim.file))
    verdict = replace(all_hold(answered, named), seconds=time.monotonic() - start)
    verdict = verdict if verdict.question else verdict.about(_title(claim))
    return Finding(reading, verdict, turned, held, tuple(asked), tuple(beside), deadline.start)


def _title(claim: Claim) -> str:
    title = claim.keys.get("title")
    return str(title) if title else f"{claim.kind} {claim.id}"
