"""Screening: could a claim with another answer be right, judged by values and slopes at two points?

For the kinds whose claims are judged as a whole: the answer is differentiated there, so that a candidate would
have to be differentiated, and its residual refuted, before it is dropped. Here each costs some evaluations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import acb

from canon.exercise.diagnose.repairs.point_derivatives import BITS, Examples, Neighbourhood
from canon.exercise.sheet.kind import named_function
from canon.exercise.sheet.reading import InvalidClaim
from canon.mechanics.algebra.constraint_manifold import EmptyDomainError
from canon.mechanics.algebra.linear import SingularMatrixError
from canon.mechanics.algebra.substitution import size
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision
from canon.proof.domain.verdict import Undecided
from canon.proof.rungs.ladder import REFUSALS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr

    from canon.exercise.diagnose.repairs.screen_tests import Screened, Test
    from canon.exercise.diagnose.repairs.unbuilt import Form
    from canon.exercise.sheet.reading import Reading

__all__ = ["Screening", "screening"]

POINTS = 2
PARTS = 8
"""Share of the nodes of an answer that is evaluated anew for a candidate, beside those that were before."""


@dataclass(frozen=True)
class Screening:
    """Quick test of changed answers by their values at points, and how many steps one test takes."""

    answers: Mapping[str, Expr]
    test: Test
    places: Sequence[Neighbourhood]
    steps: int = 0

    def passes(self, changed: Mapping[str, Form]) -> bool:
        """Whether the claim could be right with some answers changed."""

        def answer(key: str) -> Form:
            return changed[key] if key in changed else self.answers[key]

        try:
            with precision(BITS):
                return all(self.test(answer, place) for place in self.places)
        except Unmodelled:
            return True
        except (Undefined, NotDecided, ZeroDivisionError, *REFUSALS):
            return False


def screening(reading: Reading, answers: Mapping[str, Expr]) -> Screening | None:
    """Return the screening of a claim's answers, None for kinds or domains in which there is none.

    Parameters
    ----------
    reading
        A claim.
    answers
        What it answers, by keys such as ``Q[0]``.
    """
    if not reading.kind.screen:
        return None
    try:
        found: Screened | None = named_function(
            "canon.exercise.diagnose.repairs.screen_tests", reading.kind.screen
        )(reading)
    except (InvalidClaim, EmptyDomainError, SingularMatrixError, Undecided):
        return None
    if found is None:
        return None
    examples = Examples((*answers.values(), *found.given))
    with precision(BITS):
        places = [
            Neighbourhood({s: acb(int(v.p)) / acb(int(v.q)) for s, v in point.items()}, examples)
            for point in found.domain.points(found.symbols, POINTS, seed=23, but_functions=True)
        ]
    steps = found.steps + sum(map(size, answers.values())) * len(found.symbols) // PARTS
    return Screening(answers, found.test, places, steps) if len(places) == POINTS else None
