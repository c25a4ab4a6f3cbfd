"""Proved share of a wrong answer: its components, and the terms of a sum, that stand unchanged in an answer that holds.

Only what was proved counts: a diagnosis brings back an answer that is judged to hold, or components were compared one
by one. An answer that is right under another convention, for some values only, or by another question has no share.
"""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.diagnose.effort import PROOF_SECONDS, Effort, proved_to_vanish
from canon.exercise.question.question import Same, SameEquations
from canon.exercise.sheet.kind import Shape

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sympy import Expr

    from canon.exercise.claim_verdict import Finding
    from canon.exercise.diagnose.diagnosis import Diagnosis
    from canon.exercise.sheet.reading import Reading

__all__ = ["EQUATIONS", "components_of", "proved_share", "repaired_components", "share_of_terms"]

EQUATIONS = ("claim", "implicit", "equations")
"""Keys of lists whose equations need not be as many as what is asked."""


def proved_share(finding: Finding, found: Diagnosis | None) -> Fraction:
    """Return which share of a wrong answer is proved to be right.

    Parameters
    ----------
    finding
        The failed judgement.
    found
        Its diagnosis, if there is one.

    Raises
    ------
    BudgetSpent
        Where a proof was ended by its seconds.
    """
    answers = dict(components_of(finding.reading))
    if not answers or not _as_many_as_asked(finding, answers):
        return Fraction(0)
    if found is None or found.repaired is None:
        return _compared_one_by_one(finding, answers)
    repaired = repaired_components(finding.reading, found.repaired)
    if not repaired or not repaired.keys() <= answers.keys():
        return Fraction(0)
    shares = (
        share_of_terms(f, repaired[key]) if key in repaired else Fraction(1) for key, f in answers.items()
    )
    return sum(shares, Fraction(0)) / len(answers)


def share_of_terms(claimed: Expr, right: Expr) -> Fraction:
    """Return how many of the terms of a sum stand in the right one, of the terms of the longer one.

    Examples
    --------
    >>> x, y, z = sp.symbols("x y z")
    >>> share_of_terms(x + y - z, x + y + z), share_of_terms(x + y, x + y + z), share_of_terms(2 * x, x)
    (Fraction(2, 3), Fraction(2, 3), Fraction(0, 1))
    """
    here, there = (Counter(sp.Add.make_args(f)) for f in (claimed, right))
    return Fraction((here & there).total(), max(here.total(), there.total()))


def repaired_components(reading: Reading, repaired: Reading) -> dict[str, Expr]:
    """Return the components of a repaired answer that were changed; none where something else was changed."""
    same = repaired.claim == reading.claim and repaired.at == reading.at and repaired.names == reading.names
    return dict(repaired.instead) if same else {}


def components_of(reading: Reading) -> Iterator[tuple[str, Expr]]:
    """Yield the components of the answer, by the keys that a repair gives them."""
    for key in reading.kind.answer:
        if not reading.has(key):
            continue
        value = reading.claim.keys[key]
        match reading.kind.shapes[key]:
            case Shape.TEXT:
                yield key, reading.expression(key)
            case Shape.TEXTS:
                equations = key in EQUATIONS and key not in reading.kind.components
                items = reading.equations(key) if equations else reading.expressions(key)
                alone = not isinstance(value, list) and not equations
                yield from ((key if alone else f"{key}[{i}]", f) for i, f in enumerate(items))
            case Shape.EXPRESSIONS:
                yield from ((f"{key}.{name}", f) for name, f in reading.table(key).items())
            case Shape.BRACKETS:
                names = ("f", "g") if "f" in value[0] else ("u", "v")
                yield from ((f"{key}[{i}].value", b[2]) for i, b in enumerate(reading.brackets(*names)))
            case _:
                return


def _as_many_as_asked(finding: Finding, answers: dict[str, Expr]) -> bool:
    """Tell whether no component can be there for nothing: equations are as many as what they determine."""
    equations = [key for key in answers if key.partition("[")[0] in EQUATIONS and "[" in key]
    listed = [key for key in equations if key.partition("[")[0] not in finding.reading.kind.components]
    if len(listed) < 2:
        return True
    question = finding.question
    return isinstance(question, SameEquations) and len(listed) == len(question.unknowns)


def _compared_one_by_one(finding: Finding, answers: dict[str, Expr]) -> Fraction:
    question = finding.question
    if not isinstance(question, Same) or finding.reading.kind.derived:
        return Fraction(0)
    effort = Effort(PROOF_SECONDS)
    right = {
        part.key
        for part in question.parts
        if part.key in answers and proved_to_vanish(part.residual, question.domain, effort)
    }
    return Fraction(len(right), len(answers))
