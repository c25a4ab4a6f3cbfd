"""Two systems of equations of motion compared, as the claim counts and calls them."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.sheet.sympy_trees import symbols_of
from canon.proof.domain.verdict import Status, Undecided, Verdict
from canon.proof.equivalence import equivalent_equations, without_solution
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr, Symbol

    from canon.exercise.question.deadline import Deadline
    from canon.proof.domain.domain import Domain

__all__ = ["in_our_words", "same_equations"]

LONGEST_FORMULA = 200
"""Characters of an equation that is still written out in a sentence."""


def same_equations(
    claimed: tuple[Expr, ...],
    right: tuple[Expr, ...],
    unknowns: tuple[Symbol, ...],
    domain: Domain,
    deadline: Deadline,
) -> Verdict:
    """Tell whether two systems, affine in the unknowns, have the same solutions at generic points."""
    for i, equation in enumerate(claimed, 1):
        slopes = sp.Matrix([[equation.diff(a).diff(b) for b in unknowns] for a in unknowns])
        affine = vanishes_off_kinks(slopes, domain, deadline.left)
        if not affine.holds:
            return replace(
                affine, residual=equation, feedback=f"equation {i} is not affine in {_listed(unknowns)}"
            )
    try:
        verdict = equivalent_equations(claimed, right, unknowns, domain, budget=deadline.left)
    except ValueError as not_affine:  # |u| + 1 = 0 has no second derivative off its kink
        return Verdict(
            Status.FAILS, "affine", "exact", feedback=str(not_affine).replace("of the first system ", "")
        )
    if verdict.holds and without_solution(right, unknowns, domain):
        return _equations_of_lower_order(claimed, right, unknowns, domain, deadline)
    return verdict


def _equations_of_lower_order(
    claimed: tuple[Expr, ...],
    right: tuple[Expr, ...],
    unknowns: tuple[Symbol, ...],
    domain: Domain,
    deadline: Deadline,
) -> Verdict:
    """Compare systems that no accelerations solve at a generic state, as they bind velocities or coordinates.

    With L = x ẏ − H both say ẋ = … and ẏ = …: what they determine are the velocities then.
    """
    known = {s.name: s for equation in (*claimed, *right) for s in symbols_of(equation)}
    bases = [u.name.removesuffix("_ddot").removesuffix("_dot") for u in unknowns]
    for ending in ("_dot", ""):
        names = (f"{base}{ending}" for base in bases)
        unknowns += tuple(known[n] for n in names if n in known and known[n] not in unknowns)
        try:
            verdict = equivalent_equations(claimed, right, unknowns, domain, budget=deadline.left)
        except ValueError:
            break
        if not verdict.holds or not without_solution(right, unknowns, domain):
            return verdict
    raise Undecided("the equations bind the state in a way that is not affine; solve them for the velocities")


def in_our_words(feedback: str, before: int) -> str:
    """Say "claimed" and "of motion" where the proof room says first and second, and count as the claim does."""
    feedback = re.sub(
        r"^equation (\d+) (?=of the first system|is not affine)",
        lambda found: f"equation {int(found[1]) - before} ",
        feedback,
    )
    sentence, _, formula = feedback.partition(": ")
    if len(formula) > LONGEST_FORMULA:
        feedback = sentence
    words = {
        "of the second system does not follow from the first": "of motion does not follow from the claimed ones",
        "of the first system does not follow from the second": "of the claim does not follow from those of motion",
    }
    for theirs, ours in words.items():
        feedback = feedback.replace(theirs, ours)
    return feedback


def _listed(symbols: Sequence[Symbol]) -> str:
    return ", ".join(map(str, symbols))
