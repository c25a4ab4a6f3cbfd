"""Sentences about wrong answers: each kind of mistake in a teacher's words, made once, when a report is made."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, TypeAlias

from canon.exercise.diagnose.change import Mistake
from canon.exercise.diagnose.diagnosis_search import OUTER_SECONDS, diagnosis
from canon.exercise.sheet.sympy_trees import shown as written

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from sympy import Expr

    from canon.exercise.claim_verdict import Finding
    from canon.exercise.diagnose.change import Change
    from canon.exercise.diagnose.diagnosis import Diagnosis
    from canon.exercise.sheet.quantities.dimension_texts import Dimension

__all__ = ["SENTENCES", "feedback", "sentence", "times"]

Pattern: TypeAlias = "str | Callable[..., str]"
"""What is said, the items in place of the braces; or a function that says it, where that depends on an item."""
A_LINE = 120
"""Characters of the longest term that is shown."""
_ORDINALS = ("zeroth", "first", "second", "third")


def times(factor: object) -> str:
    """Return a factor in words: half, twice, 3/2 times.

    Examples
    --------
    >>> from sympy import Rational
    >>> times(Rational(1, 2)), times(Rational(3, 2))
    ('half', '3/2 times')
    """
    return {"1/2": "half", "2": "twice", "-1": "minus"}.get(str(factor), f"{factor} times")


def shown(item: object) -> str:
    """Return an expression as a sheet writes it, unless nobody would read it: longer than a line."""
    text = written(item)
    return text if len(text) <= A_LINE and "Subs(" not in text else "(too long to be shown)"


def _is_short(node: object) -> bool:
    return node is not None and len(written(node)) <= A_LINE


def _listed(items: Iterable[object]) -> str:
    return ", ".join(map(shown, items))


def _only_where(item: object, relation: str) -> str:
    """Say that a claim holds for a symbol of one sign, or where an expression has it."""
    word = "for" if getattr(item, "is_Symbol", False) else "where"
    return f"right {word} {shown(item)} {relation} 0, but not on the whole domain"


def _measured(dimension: Dimension, subject: str) -> str:
    """Say which dimension something has, or that it is a number.

    Examples
    --------
    >>> from canon.exercise.sheet.quantities.dimension_texts import dimension_from
    >>> [_measured(dimension_from(text), "x") for text in ("force", "mass*length^3", "1")]
    ['x has the dimension of force', 'x has the dimension length^3*mass', 'x is a pure number']
    """
    if dimension.is_number:
        return f"{subject} is a pure number"
    return f"{subject} has {_called(dimension)}"


def _called(dimension: Dimension) -> str:
    return f"the dimension {'of ' if dimension.name else ''}{dimension}"


def _of_other_dimension(all_told: bool, *groups: tuple[tuple[Expr, ...], Dimension]) -> str:
    """Say which terms of a sum differ in dimension."""
    (few, of_few), (many, of_many), *more = groups
    if len(few) == 1 and len(many) > 1 and not more:
        others = f"{'the ' if all_told else ''}other terms"
        measured = "are pure numbers" if of_many.is_number else f"have {_called(of_many)}"
        return f"{_measured(of_few, shown(few[0]))}, {others} {measured}: one of them is wrong"
    *told, last = (_measured(dimension, shown(terms[0])) for terms, dimension in groups)
    ending = "not all of them can be right" if more else "one of them is wrong"
    return f"{', '.join(told)}, and {last}: {ending}"


OF_A_COMPONENT: Mapping[Mistake, Pattern] = MappingProxyType(
    {
        Mistake.WRONG_SIGN: "{place} has the wrong sign",
        Mistake.WRONG_FACTOR: lambda factor: f"{{place}} should be {times(factor)} what it is",
        Mistake.DIMENSION_OF_ANSWER: lambda here, there: (
            f"{_measured(here, '{place}')}, and {_measured(there, 'the right one')}"
        ),
        Mistake.TIME_TERM_MISSING: "{place} grows at the constant rate {}: in {place} the term {} is missing",
    }
)
"""What is said of a component as a whole."""

SENTENCES: Mapping[Mistake, Pattern] = MappingProxyType(
    {
        Mistake.TERM_SIGN: "the sign of {} is wrong",
        Mistake.TERM_FACTOR: lambda term, factor: f"the term {shown(term)} should be {times(factor)} that",
        Mistake.TERM_MISSING: "the term {} is missing",
        Mistake.CORIOLIS_TERM_MISSING: "the Coriolis term {} is missing",
        Mistake.TERM_MISSING_IN: "in {} the term {} is missing",
        Mistake.TERM_SUPERFLUOUS: "the term {} does not belong",
        Mistake.FACTOR_MISSING: "the term {} lacks the factor {}",
        Mistake.DIVISOR_MISSING: "the term {} should be divided by {}",
        Mistake.FACTOR_SUPERFLUOUS: "the factor {} of {} does not belong",
        Mistake.UPSIDE_DOWN: "{} is upside down: it should be {}",
        Mistake.FUNCTION: "{} should be {}",
        Mistake.FUNCTION_MISSING: "{} should be {}",
        Mistake.ARGUMENT: "{} should be {}",
        Mistake.EXPONENT: "{} should be {}",
        Mistake.SYMBOL: "{} should be {}",
        Mistake.NUMBER: "{} should be {}",
        Mistake.SQUARE: "{} should be squared",
        Mistake.VARIABLE_OF_DERIVATIVE: "{} should be {}",
        Mistake.BRANCH: "{} is another branch of the inverse function: it should be {}",
        Mistake.SIGN_OF: "the sign of {} is wrong",
        Mistake.SYMBOLS_EXCHANGED: lambda node, a, b: (
            f"{f'in {shown(node)} the symbols ' if _is_short(node) else ''}{a} and {b} should be exchanged"
        ),
        Mistake.DERIVATIVE_NOT_TOTAL: lambda *terms: (
            f"d/dt ∂L/∂q̇ is a total derivative: the terms {_listed(terms)} are missing"
        ),
        Mistake.DERIVATIVE_NOT_TOTAL_IN: lambda term, factor: (
            (
                f"the sign of {shown(term)} is wrong"
                if factor == -1
                else f"the term {shown(term)} should be {times(factor)} that"
            )
            + ", as it is where d/dt ∂L/∂q̇ is taken at fixed coordinates"
        ),
        Mistake.TIME_DERIVATIVE_MISSING: "K is H in the new variables; ∂F/∂t is missing: K = H + ∂F/∂t",
        Mistake.TIME_DERIVATIVE_SIGN: "the sign of ∂F/∂t in K is wrong: K = H + ∂F/∂t",
        Mistake.MULTIPLIERS_OPPOSITE: lambda names: (
            f"right with the opposite sign of {_listed(names)}; the convention here is "
            "d/dt ∂L/∂q̇ − ∂L/∂q = Σ λ ∂f/∂q"
        ),
        Mistake.REACTIONS_OPPOSITE: lambda names: (
            f"right with the opposite sign of {_listed(names)}; the convention here is "
            "d/dt ∂L/∂q̇ − ∂L/∂q = Σ λ ∂g/∂q̇"
        ),
        Mistake.RULE_OPPOSITE: lambda rules: (
            f"right under the opposite sign of a rule: here {' and '.join(map(str, rules))}"
        ),
        Mistake.NEW_FOR_OLD: lambda letter: (
            f"the new {'momenta' if letter == 'P' else 'coordinates'} {letter} belong in place of the old ones"
        ),
        Mistake.OPPOSITE_CONVENTION: "right under the opposite sign convention; the convention here is {}",
        Mistake.ONLY_FOR: "right for {} = {}, but not in general",
        Mistake.ONLY_WHERE: _only_where,
        Mistake.ONLY_SMALL: lambda name, order: f"right only for small {name}, to {_ORDINALS[order]} order",
        Mistake.OTHER_TYPE: "F generates this map as a function of type {}, not {}",
        Mistake.OTHER_ROUTHIAN: "right under the other convention, {}",
        Mistake.INVERSE_MAP: "what is given as the map is its inverse",
        Mistake.MAP_EXCHANGED: "Q and P are exchanged in the map",
        Mistake.EQUATIONS_EXCHANGED: "the equations of q and p are exchanged",
        Mistake.OTHER_GAUGE: "L2 − L1 is dF/dt of some F(q, t), but not of this one",
        Mistake.ONLY_EQUATIONS: "L1 and L2 have the same equations of motion, "
        "but L2 − L1 is not dF/dt of any F(q, t)",
        Mistake.EQUATION_MISSING: "each equation is right, but together they do not determine the motion: "
        "an equation is missing",
        Mistake.FACTOR_OF_COVARIANT: "the factor is {}, not {}",
        Mistake.BRACKET_OPPOSITE: "{} = {}, not {}: exchange Q and P, or change the sign of one of them",
        Mistake.VALENCE: "canonical with valence {1}, not {2}: {0} = {1}; multiply P by {3}",
        Mistake.MAP_MENDED: str,
        Mistake.TERMS_OF_OTHER_DIMENSION: _of_other_dimension,
        Mistake.NO_NUMBER: lambda node, argument, dimension: (
            f"{_measured(dimension, shown(argument))}, and in {shown(node)} only a pure number makes sense"
        ),
        Mistake.MORE_WRONG: "{} more components are wrong",
        Mistake.AS_JUDGED: str,
    }
)
"""What is said of a mistake; where it is in a component, ``in equation 1`` stands before it."""
OF_DIMENSIONS = (Mistake.TERMS_OF_OTHER_DIMENSION, Mistake.NO_NUMBER)
"""What dimensional analysis says, beside another sentence or alone."""


def sentence(found: Diagnosis) -> str:
    """Return what a person is told of a wrong answer.

    Examples
    --------
    >>> from sympy import Symbol
    >>> from canon.exercise.diagnose.change import Change
    >>> from canon.exercise.diagnose.diagnosis import Diagnosis
    >>> x = Symbol("x")
    >>> sentence(Diagnosis((Change.of(Mistake.TERM_SIGN, x**2, place="H"),)))
    'in H the sign of x**2 is wrong'
    """
    said: list[str] = []
    places: list[str] = []
    for change in found.changes:
        if said and change.place and places[-1] == change.place and change.mistake in SENTENCES:
            said[-1] += f"{';' if change.mistake in OF_DIMENSIONS else ', and'} {_said(change)}"
            continue
        said.append(_of_a_place(change))
        places.append(change.place)
    told = "; ".join(said)
    return told if found.instead is None else f"{told}; or {sentence(found.instead)}"


def _in_words(place: str) -> str:
    """Return what a person calls the place of an answer.

    Examples
    --------
    >>> _in_words("implicit[1]"), _in_words("solution.p"), _in_words("P2")
    ('equation 2 of the map', 'the solution for p', 'P2')
    """
    if place.startswith("solution."):
        return f"the solution for {place.removeprefix('solution.')}"
    if place.startswith("implicit["):
        return f"equation {int(place[9:-1]) + 1} of the map"
    return place


def _of_a_place(change: Change) -> str:
    if change.mistake in OF_A_COMPONENT:
        return _said(change)
    return f"in {_in_words(change.place)} {_said(change)}" if change.place else _said(change)


def _said(change: Change) -> str:
    pattern = OF_A_COMPONENT.get(change.mistake) or SENTENCES[change.mistake]
    if callable(pattern):
        said = pattern(*change.items)
        said = said.replace("{place}", _in_words(change.place))
    else:
        said = pattern.format(*map(shown, change.items), place=_in_words(change.place))
    if change.inside is not None:
        return f"in {shown(change.inside)} {said}, everywhere"
    return f"{said} everywhere" if change.everywhere else said


def feedback(finding: Finding, seconds: float = OUTER_SECONDS) -> str:
    """Return in words what is wrong with a claim, or nothing.

    Parameters
    ----------
    finding
        A failed judgement with the question on which it turned.
    seconds
        The outer limit of the search; its steps are counted.
    """
    found = diagnosis(finding, seconds)
    return "" if found is None else sentence(found)
