"""Zero test: an expression is proved zero, refuted with a certificate, or undecided.

The ladder: a few balls, the normal form, then more balls at more precision. A verdict HOLDS only where
the normal form is zero, and FAILS only where balls exclude zero at an exact point of the domain.
"""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.expression.symbols.repeated_sum import written_out
from canon.expression.symbols.user_input import given_expression, given_seconds
from canon.proof.definedness.definedness import lack_beside, lack_of_value, may_lack
from canon.proof.domain.domain import EVERYWHERE, Domain, as_domain
from canon.proof.domain.limits import QUICK
from canon.proof.domain.verdict import Evidence, Status, Verdict
from canon.proof.refute.refute import (
    Search,
    first_counterexample,
    look_for_counterexample,
    look_in_corners,
    search_widely,
)
from canon.proof.refute.root_branches import search_branches
from canon.proof.refute.sample_functions import evaluated
from canon.proof.refute.tiny_values import look_for_tiny_value
from canon.proof.rungs.ladder import REFUSALS, Attempt, is_empty, prove_each, prove_zero, refusal
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.bound_variables import with_own_bound_variables
from canon.proof.worker.budget import prove_in_worker

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from sympy import Expr
    from sympy.logic.boolalg import Boolean

__all__ = ["equal", "vanishes", "vanishes_where_defined"]

QUICK_SECONDS = 0.5
"""Time for the proving rungs in the user's own process."""

WORKER_SHARE = 0.8
"""Part of the time left that a matrix may use in the worker as a whole."""

SEARCH_SHARE = 0.3
"""Part of the time left that the wider search for a counterexample may use."""

CORNER_SHARE = 0.1
"""Part of the time left that the search near ends of the domain, kinks, poles and branch points may use."""

ALONE = ("the expression",)
SIDES = ("the first expression", "the second expression")
"""What is called what where one of two has no value."""


EMPTY = "no point satisfies the conditions, so that anything holds there"


def vanishes(expr: Expr | sp.MatrixBase, domain: Domain = EVERYWHERE, budget: float = 10.0) -> Verdict:
    """Decide whether an expression, or every entry of a matrix, is zero on a domain.

    Symbols are real unless declared complex. The claim is about every point of the domain where the
    expression has a value; one that has a value nowhere does not vanish.

    Parameters
    ----------
    expr
        SymPy expression or matrix.
    domain
        Conditions beside the symbols' own assumptions, and a box to draw points from.
    budget
        Seconds.

    Returns
    -------
    Verdict
        HOLDS with the certificate ``exact``, FAILS with ``ball`` and a counterexample, or UNDECIDED.

    Examples
    --------
    >>> from sympy import sin, cos, symbols
    >>> x = symbols("x")
    >>> vanishes(sin(x) ** 2 + cos(x) ** 2 - 1).status
    <Status.HOLDS: 'holds'>
    """
    start, domain, budget = time.monotonic(), as_domain(domain), given_seconds(budget)
    if isinstance(expr, sp.MatrixBase):
        matrix = expr.applyfunc(written_out)
        return _matrix_vanishes(matrix, domain, start, budget).about("the matrix is zero")
    verdict = _decide(written_out(expr), sp.Integer(0), domain, start + budget, ALONE)
    return replace(verdict, question="the expression is zero", seconds=time.monotonic() - start)


def vanishes_where_defined(expr: Expr, domain: Domain, budget: float) -> Verdict:
    """Decide whether an expression is zero wherever it has a value, be that nowhere.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> vanishes_where_defined(sp.log(x**2) - 2 * sp.log(x), Domain((sp.Eq(x, 0),)), 1.0).status.name
    'HOLDS'
    """
    start = time.monotonic()
    verdict = _decide(expr, sp.Integer(0), domain, start + budget, ())
    return replace(
        verdict, question="the expression is zero where it has a value", seconds=time.monotonic() - start
    )


def equal(
    a: Expr | sp.MatrixBase, b: Expr | sp.MatrixBase, domain: Domain = EVERYWHERE, budget: float = 10.0
) -> Verdict:
    """Decide whether two expressions, or two matrices of one shape, are equal on a domain.

    Where one has a value the other must have one too, up to isolated points.

    Parameters
    ----------
    a, b
        SymPy expressions or matrices.
    domain, budget
        As for :func:`vanishes`.

    Examples
    --------
    >>> from sympy import symbols
    >>> x = symbols("x")
    >>> print(equal((x + 1)**2, x**2 + 1).status.value)
    fails
    """
    start, domain, budget = time.monotonic(), as_domain(domain), given_seconds(budget)
    if isinstance(a, sp.MatrixBase) and isinstance(b, sp.MatrixBase):
        if a.shape != b.shape:
            raise ValueError(f"matrices of shapes {a.shape} and {b.shape} cannot be compared entry by entry")
        first, second = a.applyfunc(written_out), b.applyfunc(written_out)
        verdict = _matrix_vanishes(first - second, domain, start, budget)
        if not verdict.fails:
            pairs = zip(cast("list[Expr]", first.flat()), cast("list[Expr]", second.flat()), strict=True)
            verdict = _entries_with_values(verdict, dict.fromkeys(pairs), domain, start + budget)
        return verdict.about("the matrices are equal")
    verdict = _decide(written_out(a), written_out(b), domain, start + budget, SIDES)
    return replace(verdict, question="the expressions are equal", seconds=time.monotonic() - start)


def _matrix_vanishes(matrix: sp.MatrixBase, domain: Domain, start: float, budget: float) -> Verdict:
    """Decide entry by entry, equal entries once; the first entry that fails decides."""
    deadline = start + budget
    there = [place for place in product(range(matrix.rows), range(matrix.cols)) if matrix[place] != 0]
    nonzero, domain = _apart([_exact(matrix[place]) for place in there], domain)
    places: dict[Expr, tuple[int, int]] = {}
    for entry, place in zip(nonzero, there, strict=True):
        places.setdefault(entry, place)
    entries = list(places)
    try:
        search, number = first_counterexample(entries, domain, deadline)
    except REFUSALS:
        search, number = Search(), None
    if number is not None:
        failed = _refuted(entries[number], sp.Integer(0), search)
        return _at_entry(failed, places[entries[number]], "does not vanish", start)
    rungs, open_ = _proved_together(entries, domain, deadline)
    answer = _one_by_one({entry: places[entry] for entry in open_}, rungs, domain, start, deadline)
    if answer is not None and answer.undecided:
        screened = Evidence("screen", f"no entry was refuted at {search.agreements} random points")
        return replace(answer, evidence=(screened, *answer.evidence))
    if answer is not None:
        return answer
    proved = Verdict(Status.HOLDS, certificate=" + ".join(rungs) or "exact")
    for number, entry in enumerate(entries):
        valued = number in search.valued
        verdict = _with_values(proved, (entry,), ALONE, domain, deadline, valued=valued)
        if not verdict.holds:
            return _at_entry(verdict, places[entry], verdict.feedback.removeprefix(ALONE[0]).strip(), start)
    return replace(proved, seconds=time.monotonic() - start)


def _proved_together(
    entries: list[Expr], domain: Domain, deadline: float
) -> tuple[dict[str, None], list[Expr]]:
    """Return the rungs that proved entries zero, first quickly, then in the worker; and the entries that are left."""
    rungs: dict[str, None] = {}

    def left_by(proofs: Sequence[Attempt], open_: list[Expr]) -> list[Expr]:
        rungs.update({rung: None for proof in proofs if proof.holds for rung in proof.rungs})
        return [entry for entry, proof in zip(open_, proofs, strict=True) if not proof.holds]

    quickly = min(deadline, time.monotonic() + QUICK_SECONDS)
    open_ = left_by(prove_each(entries, domain, quickly, QUICK), entries)
    if len(open_) > 1 and (seconds := deadline - time.monotonic()) > 0:
        answer = prove_in_worker(open_, domain, WORKER_SHARE * seconds)
        if not isinstance(answer, str):
            open_ = left_by(answer, open_)
    return rungs, open_


def _one_by_one(
    places: dict[Expr, tuple[int, int]],
    rungs: dict[str, None],
    domain: Domain,
    start: float,
    deadline: float,
) -> Verdict | None:
    """Decide each entry for itself: the first that fails, else the first that stays open; None where all vanish."""
    undecided: Verdict | None = None
    for entry, place in places.items():
        if time.monotonic() > deadline:
            late = Verdict(Status.UNDECIDED, evidence=(Evidence("tried", "not finished in time"),))
            return _at_entry(late if undecided is None else undecided, place, "was not decided", start)
        verdict = _decide(entry, sp.Integer(0), domain, deadline, ALONE)
        if verdict.fails:
            return _at_entry(verdict, place, "does not vanish", start)
        if verdict.holds:
            rungs[verdict.certificate] = None
        elif undecided is None:
            undecided = _at_entry(verdict, place, "was not decided", start)
    return undecided


def _entries_with_values(
    verdict: Verdict, pairs: Iterable[tuple[Expr, Expr]], domain: Domain, deadline: float
) -> Verdict:
    """Return the verdict that two matrices are equal, unless an entry of one has no value where the other has."""
    sides = ("an entry of the first matrix", "an entry of the second matrix")
    for pair in pairs:
        verdict = _with_values(verdict, pair, sides, domain, deadline, valued=False)
        if verdict.fails:
            break
    return verdict


def _at_entry(verdict: Verdict, place: tuple[int, int], what: str, start: float) -> Verdict:
    feedback = f"entry ({place[0]}, {place[1]}) {what}"
    return replace(verdict, feedback=feedback, seconds=time.monotonic() - start)


def _exact(expr: object) -> Expr:
    """Return an expression without floating-point numbers, which would absorb small terms."""
    if isinstance(expr, int):
        return sp.Integer(expr)
    expr = given_expression(expr)
    if isinstance(expr, sp.Lambda | sp.Order):
        raise TypeError(f"an expression is needed, not {type(expr).__name__}: {expr!r}")
    found = anatomy([expr])
    limits = found.of(sp.Limit)
    if limits:
        raise ValueError(
            f"{limits[0]} is not carried out, and the zero test does not model it; write its .doit()"
        )
    if not expr.is_commutative:
        raise ValueError(f"{expr} holds factors that do not commute, which the zero test does not model")
    floats = found.of(sp.Float)
    if floats:
        raise ValueError(
            f"{min(floats, key=str)} is a rounded number and nothing exact can be said of it; "
            "write it as a fraction, such as Rational('0.1') or Rational(1, 10)"
        )
    return evaluated(expr) if found.has(sp.Derivative, sp.Subs) else expr


def _apart(exprs: list[Expr], domain: Domain) -> tuple[list[Expr], Domain]:
    """Return expressions and a domain in which no variable of a sum, an integral or a substitution is free as well."""
    own = with_own_bound_variables([*exprs, *domain.conditions])
    conditions = cast("list[Boolean]", own[len(exprs) :])
    return cast("list[Expr]", own[: len(exprs)]), replace(domain, conditions=tuple(conditions))


def _decide(left: object, right: object, domain: Domain, deadline: float, names: tuple[str, ...]) -> Verdict:
    too_deep = Verdict(Status.UNDECIDED, evidence=(Evidence("tried", "the expression is nested too deeply"),))
    try:
        (a, b), domain = _apart([_exact(left), _exact(right)], domain)
    except RecursionError:
        return too_deep
    try:
        return _climb(a, b, domain, deadline, names)
    except RecursionError:
        return too_deep
    except REFUSALS as reason:
        said = f"no value could be given to a part of the expression or domain: {refusal(reason)}"
        return Verdict(Status.UNDECIDED, evidence=(Evidence("tried", said),))


def _difference(left: Expr, right: Expr) -> Expr:
    """Return left − right, without a sum where the sides are one: SymPy's may ask for digits that no memory holds."""
    return sp.Integer(0) if left == right else left - right


def _thorough(quick: Attempt, difference: Expr, domain: Domain, deadline: float) -> Attempt:
    """Return what the thorough rungs did in the worker; the quick attempt where they can add nothing in time."""
    seconds = deadline - time.monotonic()
    if not quick.capped or seconds <= 0:
        return quick
    answer = prove_in_worker([difference], domain, seconds)
    if isinstance(answer, str):
        return replace(quick, obstacles=[*quick.obstacles, answer])
    return answer[0]


def _climb(left: Expr, right: Expr, domain: Domain, deadline: float, names: tuple[str, ...]) -> Verdict:
    """Climb the ladder: a few balls, the quick proof, many balls, the thorough proof in the worker."""
    found = anatomy([left, right])
    sides = (left, right)[: len(names)]
    search = look_for_counterexample(
        left,
        right,
        domain.points(found.symbols, 3, deadline=deadline, but_functions=True),
        highest=64,
        deadline=deadline,
        conditions=domain.on_functions,
    )
    if search.counterexample is not None:
        return _refuted(left, right, search)
    difference = _difference(left, right)
    proof = prove_zero(difference, domain, min(deadline, time.monotonic() + QUICK_SECONDS), QUICK)
    if proof.holds:
        if search.agreements == 0 and domain.conditions and is_empty(domain, deadline):
            return replace(_proved(proof), assumed=(EMPTY,))
        return _with_values(_proved(proof), sides, names, domain, deadline, valued=search.agreements > 0)
    if search.agreements == 0 and not search.unmodelled:
        nothing = Verdict(Status.UNDECIDED)
        without = _with_values(nothing, sides, names, domain, _share(SEARCH_SHARE, deadline), valued=False)
        if without.fails:
            return without
    wide = search_widely(left, right, domain, _share(SEARCH_SHARE, deadline))
    search = wide if wide.tried else search  # which knows something where no time was left
    if search.agreements == 0 and search.counterexample is None and not search.unmodelled:
        search = search_branches(left, right, domain, _share(SEARCH_SHARE, deadline))
    if search.counterexample is not None:
        return _refuted(left, right, search)
    search = look_in_corners(left, right, domain, _share(CORNER_SHARE, deadline), search)
    search = look_for_tiny_value(difference, domain, _share(CORNER_SHARE, deadline), search)
    if search.counterexample is not None:
        return _refuted(left, right, search)
    proof = _thorough(proof, difference, domain, deadline)
    if proof.holds:
        valued = search.agreements > 0
        return _with_values(_proved(proof), sides, names, domain, deadline, valued=valued)
    tried = tuple(Evidence("tried", obstacle) for obstacle in proof.obstacles)
    known = Evidence("balls", search.known)
    undecided = Verdict(Status.UNDECIDED, residual=difference, evidence=(*tried, known))
    if search.unmodelled:
        return undecided
    return _with_values(undecided, sides, names, domain, deadline, valued=search.agreements > 0)


def _with_values(
    verdict: Verdict,
    sides: Sequence[Expr],
    names: Sequence[str],
    domain: Domain,
    deadline: float,
    *,
    valued: bool,
) -> Verdict:
    """Return a verdict on expressions, unless one has no value: then it fails, and nothing holds of it."""
    lacks = [lack_of_value(side, domain, deadline, valued=valued) for side in sides]
    if len(sides) == 2 and may_lack(anatomy(sides)):
        this, that = sides
        lacks += [lack_beside(this, [that], domain, deadline), lack_beside(that, [this], domain, deadline)]
    for number, lack in enumerate(lacks):
        if lack is None:
            continue
        sentence = lack.sentence(names[number % len(names)])
        if lack.proved:
            return Verdict(
                Status.FAILS, certificate="definedness", counterexample=lack.counterexample, feedback=sentence
            )
        if verdict.holds:
            verdict = Verdict(Status.UNDECIDED, evidence=(Evidence("open", sentence),))
    return verdict


def _share(share: float, deadline: float) -> float:
    """Return the point in time at which a part of the time that is left is over."""
    now = time.monotonic()
    return now + share * (deadline - now)


def _refuted(left: Expr, right: Expr, search: Search) -> Verdict:
    return Verdict(
        Status.FAILS, certificate="ball", counterexample=search.counterexample, residual=left - right
    )


def _proved(proof: Attempt) -> Verdict:
    return Verdict(Status.HOLDS, certificate=" + ".join(proof.rungs) or "exact")
