"""Kept explanations: what was said of a wrong answer, said again where another person wrote the same in another order.

Most of the work for a class goes into looking for what is wrong with wrong answers, and many of them are one answer:
read as an expression, ``-g*sin(theta) + l*a`` is ``l*a - g*sin(theta)``. Nothing here decides whether a claim holds:
every claim is judged by itself, and only then is it asked whether the same was explained before.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from canon.exercise.question.equation_systems import AFFINE
from canon.exercise.sheet.kind import BESIDE, COMMON
from canon.exercise.sheet.reading import InvalidClaim
from canon.expression.text.vocabulary import FUNCTIONS

if TYPE_CHECKING:
    from collections.abc import Hashable

    from canon.exercise.claim_verdict import Finding
    from canon.exercise.sheet.reading import Reading
    from canon.expression.text.scope import Scope

__all__ = ["Explanation", "KeptExplanations", "meaning"]

MOST_KEPT = 512
LONGEST = 4_000
"""Characters of a claim whose explanation is kept, so that a process that lives for weeks stays small."""


@dataclass(frozen=True)
class Explanation:
    """What is said of a wrong answer.

    Parameters
    ----------
    corrected, feedback
        The right answer and what is wrong, each as text, empty where there is none.
    share
        The share of the answer that is proved to be right, where the claim asks for it.
    """

    corrected: str
    feedback: str
    share: float | None = None


class KeptExplanations:
    """What was said of wrong answers before, in the process that judges a class; the oldest is dropped first.

    A search is ended by its steps alone, and one that was cut off by its seconds says so and is not kept: the same
    claim gets the same explanation, whether it was kept or not.

    Examples
    --------
    >>> kept = KeptExplanations()
    >>> kept.keep("an answer", Explanation("x", "the sign is wrong"))
    >>> kept.of("an answer").feedback, kept.of("another")
    ('the sign is wrong', None)
    """

    def __init__(self) -> None:
        self._kept: dict[Hashable, Explanation] = {}

    def of(self, meant: Hashable) -> Explanation | None:
        """Return what was said of a wrong answer of the same meaning; None where nothing was, or nothing is meant."""
        return self._kept.get(meant)

    def keep(self, meant: Hashable, said: Explanation) -> None:
        """Keep what was said of an answer of some meaning; nothing where that is None."""
        if meant is None:
            return
        if len(self._kept) >= MOST_KEPT:
            del self._kept[next(iter(self._kept))]
        self._kept[meant] = said


def meaning(finding: Finding) -> Hashable:
    """Return what an explanation depends on: the claim, its answers as expressions, and how it failed.

    It is None for a claim too long to be kept.

    Answers are the same where they are the same expression in the same words, so that also a word to which the judge
    of a kind gives a meaning of its own, such as ``dx``, is told apart from a product.
    """
    reading, verdict = finding.reading, finding.verdict
    if len(repr(reading.claim.keys)) > LONGEST:
        return None
    said = tuple(
        (key, _read(value, reading) if key in reading.kind.answer and key not in COMMON else repr(value))
        for key, value in reading.claim.keys.items()
        if key not in BESIDE
    )
    affine = verdict.question == AFFINE
    how = (finding.held, type(finding.question).__name__, affine, verdict.feedback, len(finding.asked))
    return reading.claim.kind, said, reading.links, reading.passed, repr(reading.units), how


def _read(value: Any, reading: Reading) -> Hashable:
    """Return an answer with its texts as expressions; a text that can't be read alone stays a text."""
    if isinstance(value, str):
        try:
            return reading.equation("", value), value.count("="), _words(value, reading.scope)
        except InvalidClaim:
            return value
    if isinstance(value, dict):
        return tuple((key, _read(item, reading)) for key, item in value.items())
    if isinstance(value, list | tuple):
        return tuple(_read(item, reading) for item in value)
    return repr(value)


def _words(text: str, scope: Scope) -> frozenset[str]:
    """Return the words of a text that are no declared names or functions, of which an expression says all."""
    plain = text.replace("_{\\", "_").replace("_{", "_")
    spelled = "".join(letter if letter.isalnum() or letter in "_\\" else " " for letter in plain)
    words = spelled.replace("\\", " \\").split()
    return frozenset(
        w for w in words if not (w.isdigit() or w.startswith("\\") or w in FUNCTIONS or scope.declares(w))
    )
