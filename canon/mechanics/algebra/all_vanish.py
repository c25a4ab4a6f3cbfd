"""Vanishing of many expressions at once, each of which must be zero for a claim to hold."""

from __future__ import annotations

import time as clock
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp

from canon.mechanics.algebra.substitution import exchanged
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import Evidence, Status, Verdict, all_hold
from canon.proof.kinks import off_kinks, vanishes_off_kinks
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from sympy import Expr

__all__ = ["all_vanish", "differ", "having_values", "is_quadratic_in", "vanish_together"]

VALUE_SECONDS = 2.0
"""Time for the question whether an answer has a value."""


def all_vanish(
    claims: Iterable[tuple[str, Expr]], question: str, domain: Domain | None = None, budget: float = 10.0
) -> Verdict:
    """Tell whether all of these expressions vanish, within one budget of time.

    Parameters
    ----------
    claims
        Pairs of what is asked, in words, and the expression that should vanish.
    question
        The whole claim, in words.
    domain
        Where it is meant.
    budget
        Seconds for all of them together.

    Kinks are no part of the domain: an expression may have any value there.

    Returns
    -------
    Verdict
        The first claim that fails gives the residual, the counterexample and is named in the feedback.
    """
    domain = as_domain(domain)
    end = clock.monotonic() + budget

    def verdicts() -> Iterator[Verdict]:
        for part, expression in claims:
            if expression == 0:
                continue
            left = end - clock.monotonic()
            if left <= 0:
                yield Verdict(
                    Status.UNDECIDED,
                    part,
                    evidence=(Evidence("budget", f"{budget:.1f} s were spent before {part}"),),
                )
                return
            verdict = vanishes_off_kinks(expression, domain, left)
            if verdict.holds:
                yield verdict
                continue
            yield replace(
                verdict,
                question=part,
                residual=expression,
                feedback=verdict.feedback or (f"not so: {part}" if verdict.fails else ""),
            )

    verdict = all_hold(verdicts(), question)
    return replace(verdict, certificate=verdict.certificate or "exact") if verdict.holds else verdict


def vanish_together(expressions: Sequence[Expr], domain: Domain, budget: float) -> Verdict:
    """Tell whether expressions vanish, all asked at once: one that is easily refuted spares long proofs of the others.

    Kinks are no part of the domain, as for :func:`all_vanish`.
    """
    off = off_kinks(expressions, domain)
    residuals = sp.Matrix([off.seen(e) for e in expressions])
    return replace(off.ask(lambda there: vanishes(residuals, there, budget=budget)), feedback="")


def having_values(
    verdict: Verdict, answers: Mapping[str, Expr], beside: Sequence[Expr], domain: Domain | None = None
) -> Verdict:
    """Return a verdict on answers that are proved right where they have a value, unless one has none.

    Derivatives do not show it: those of log(h) where h is zero everywhere may cancel.

    Parameters
    ----------
    verdict
        What was found of the answers.
    answers
        The answers, by what they are called.
    beside
        What is given: where that has a value, the answers should have one.
    domain
        Where they are meant.

    Examples
    --------
    >>> from sympy import Symbol, log
    >>> x = Symbol("x", real=True)
    >>> hidden = (x + 1)**2 - x**2 - 2*x - 1
    >>> having_values(Verdict(Status.HOLDS), {"Q": log(hidden)}, [x]).feedback[:25]
    'Q has a value nowhere: it'
    """
    if not verdict.holds:
        return verdict
    from canon.proof.definedness.definedness import lack_beside, lack_of_value

    domain = as_domain(domain)
    until = clock.monotonic() + VALUE_SECONDS
    open_: Verdict | None = None
    for name, answer in answers.items():
        lack = lack_of_value(answer, domain, until) or lack_beside(answer, beside, domain, until)
        if lack is None:
            continue
        sentence = lack.sentence(name)
        if lack.proved:
            example = lack.counterexample
            return replace(
                verdict,
                status=Status.FAILS,
                certificate="definedness",
                counterexample=example,
                assumed=(),
                feedback=sentence,
            )
        open_ = Verdict(
            Status.UNDECIDED,
            verdict.question,
            evidence=(Evidence("open", sentence),),
            seconds=verdict.seconds,
        )
    return verdict if open_ is None else open_


def is_quadratic_in(f: Expr, variables: Sequence[sp.Symbol], domain: Domain | None = None) -> bool:
    """Tell whether f is certainly a polynomial of degree 2 at most, its coefficients free of the variables.

    That the second derivatives are free of them would not do: slopes in pieces may be constant and differ.

    Examples
    --------
    >>> v = sp.Symbol("v", real=True)
    >>> is_quadratic_in(v**2 / 2 + v, [v]), is_quadratic_in(v**2 / 2 + sp.Piecewise((v, v > 0), (0, True)), [v])
    (True, False)
    """
    slopes = [f.diff(v) for v in variables]
    if any(slope.diff(v).has(*variables) for slope in slopes for v in variables):
        return False
    if f.is_polynomial(*variables):
        return True
    at_rest = dict.fromkeys(variables, sp.S.Zero)
    linear = (exchanged(a, at_rest) * v for a, v in zip(slopes, variables, strict=True))
    square = (a.diff(v) * u * v / 2 for a, u in zip(slopes, variables, strict=True) for v in variables)
    form = sp.Add(exchanged(f, at_rest), *linear, *square)
    return vanishes_off_kinks(f - form, as_domain(domain)).holds


def differ(expression: Expr, domain: Domain | None = None) -> bool:
    """Whether an expression certainly does not vanish identically on the domain."""
    if expression.is_Rational:
        return bool(expression != 0)
    return vanishes_off_kinks(expression, as_domain(domain)).fails
