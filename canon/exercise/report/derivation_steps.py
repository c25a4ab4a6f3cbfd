"""Derivation shown step by step: what was derived from a claim, what was compared, how that was decided."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.question.question import Determines, Differ, Regular, Same, SameEquations, Tells
from canon.expression.symbols.magnitude import written
from canon.expression.symbols.symbol import velocity
from canon.proof.domain.verdict import Verdict

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from sympy import Basic, Symbol

    from canon.exercise.claim_verdict import Finding
    from canon.exercise.question.question import Part, Question
    from canon.exercise.sheet.reading import Reading

__all__ = ["Step", "shown", "steps"]

Step = tuple[str, str]
"""What was done, in words, and the formula that belongs to it; either may be empty."""
MOST_STEPS = 40
MOST_PARTS = 8
MOST_NODES = 400
"""Largest expression that is shown; a longer one is read by nobody."""
MOST_CHARACTERS = 2_000
_ANSWERS = {"holds": "it holds", "fails": "it fails", "undecided": "it was not decided"}


def steps(finding: Finding) -> tuple[Step, ...]:
    """Return the steps of a judgement, each a sentence and a formula.

    Parameters
    ----------
    finding
        A claim with its verdict, as :func:`canon.exercise.claim_verdict.examine` gives it.

    Examples
    --------
    >>> from canon.exercise import Claim
    >>> from canon.exercise.claim_verdict import examine
    >>> claim = {"q": ["x"], "p": ["p"], "pairs": [{"f": "x**2", "g": "p", "value": "2*x"}]}
    >>> for text, formula in steps(examine(Claim("a", "poisson-bracket", claim))):
    ...     print(text, formula)
    {f, g} of pair 1 should be 2*x
    so it holds, decided by: exact
    """
    found = list(_slopes(finding.reading))
    for question, verdict in finding.asked:
        found += _derived(question)
        found.append((_answer(question, verdict), ""))
        if len(found) > MOST_STEPS:
            break
    return tuple(found[:MOST_STEPS])


def _slopes(reading: Reading) -> Iterator[Step]:
    """Yield the derivatives of L or H that the equations of motion are made of."""
    if not all(reading.has(key) for key in ("q", "L")) and not all(
        reading.has(key) for key in ("q", "p", "H")
    ):
        return
    name = "L" if reading.has("L") else "H"
    f, q = reading.expression(name), reading.symbols("q")
    if not shown(f) or len(q) > MOST_PARTS // 2:
        return
    first = [velocity(x) for x in q] if name == "L" else reading.symbols("p")
    for pair in zip(first, q, strict=False):
        for symbol in pair:
            if text := shown(f.diff(symbol)):
                yield "", f"Derivative({name}, {symbol}) = {text}"


def _derived(question: Question) -> Iterator[Step]:
    match question:
        case Same(parts):
            known: Mapping[Symbol, Basic] = {}
            for part in parts[:MOST_PARTS]:
                if part.through != known:
                    known = part.through
                    yield from _with(known)
                yield from _compared(part)
            if len(parts) > MOST_PARTS:
                yield f"and {len(parts) - MOST_PARTS} more of the same sort", ""
        case SameEquations(_, right):
            for i, equation in enumerate(right[:MOST_PARTS], 1):
                yield f"equation {i} as canon derives it", f"{text} = 0" if (text := shown(equation)) else ""
            yield from _with(question.through)
        case Differ(part):
            yield f"{part.name} is compared with", shown(part.right)
        case Regular(matrix, name):
            yield f"{name} must be regular", shown(matrix[0, 0]) if matrix.shape == (1, 1) else ""
        case _:
            return


def _compared(part: Part) -> Iterator[Step]:
    """Yield what a component should be, and what it is where that follows from the answer."""
    if part.key:
        yield f"{part.name} should be", shown(part.right)
    elif part.right == 0:
        yield f"{part.name}: what must vanish is", shown(part.claimed)
    else:
        yield f"{part.name} comes out as", shown(part.claimed)
        yield f"{part.name} should be", shown(part.right)


def _with(through: Mapping[Symbol, Basic]) -> Iterator[Step]:
    for name, value in list(through.items())[:MOST_PARTS]:
        if text := shown(value):
            yield "with", f"{name} = {text}"


def _answer(question: Question, verdict: Verdict) -> str:
    said = _ANSWERS[verdict.status.value]
    if isinstance(question, Verdict | Tells | Determines):
        said = f"{verdict.question}: {said}" if verdict.question else said
    return f"so {said}, decided by: {verdict.certificate}" if verdict.certificate else f"so {said}"


def shown(f: Basic) -> str:
    """Return an expression as text, nothing where it is longer than anyone reads."""
    nodes = sum(1 for _ in zip(sp.preorder_traversal(f), range(MOST_NODES), strict=False))
    text = _written(f) if nodes < MOST_NODES else ""
    return text if len(text) <= MOST_CHARACTERS else ""


_written = functools.lru_cache(maxsize=256)(written)
"""What is derived from a question is the same for all who answer it."""
