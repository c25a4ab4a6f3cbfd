"""Claims about parameters: for which of their values a claim of another kind holds, all of them and no other."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.question.answer_values import hazards_of_answers, without_value
from canon.exercise.question.deadline import BudgetSpent, Deadline
from canon.exercise.question.parameter_system import Family, covers, families
from canon.exercise.question.question import (
    Determines,
    Differ,
    Part,
    Question,
    Regular,
    Same,
    Stated,
    Tells,
    decide,
)
from canon.exercise.sheet.reading import InvalidClaim, Reading
from canon.exercise.sheet.sheet import Claim
from canon.frozen_mapping import FrozenMapping
from canon.mechanics.algebra.constraint_manifold import EmptyDomainError
from canon.mechanics.algebra.linear import SingularMatrixError
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.proof.domain.domain import has_point
from canon.proof.domain.verdict import Evidence, Status, Undecided, Verdict, all_hold
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from canon.proof.domain.domain import Domain

__all__ = ["parameters"]

SHARE = 0.4
"""Part of the budget for the values that are claimed, and for finding all of them."""
_OWN = ("of", "find", "values", "in", "complete")


Ask: TypeAlias = "Callable[[Reading], Iterator[Question]]"
"""What a claim of any kind comes down to."""


def parameters(reading: Reading, ask: Ask) -> Iterator[Question]:
    """The inner claim, which ``ask`` takes apart, holds at each of the claimed values and at no others."""
    inner, wanted = _inner(reading), _wanted(reading)
    claimed = [_assigned(reading, i, table, wanted) for i, table in enumerate(reading.claim.keys["values"])]
    budget = reading.claim.budget
    found: list[list[Family]] = []

    def all_of_them() -> tuple[str, ...] | None:
        deadline = Deadline.after(SHARE * budget)
        known = found or _found(ask, reading, inner, wanted, deadline)
        if not known and deadline.over:
            raise BudgetSpent
        return _told(ask, reading, inner, known[0], wanted, deadline) if known else None

    held: list[Verdict] = []
    for family in claimed:
        deadline = Deadline.after(SHARE * budget / len(claimed))
        verdict = _judged(ask, reading, inner, family, wanted, deadline)
        if verdict.fails:
            yield Stated(verdict, all_of_them)
            return
        held.append(verdict)
    whole = all_hold(held) if held else Verdict(Status.HOLDS, certificate="exact")
    deadline = Deadline.after(SHARE * budget)
    found += _found(ask, reading, inner, wanted, deadline)
    if not found:
        more = f"whether there are more was not decided{_in_time(deadline)}"
        yield Stated(
            _left_open(whole, f"the values that are claimed are right, as far as was decided; {more}")
        )
        return
    missing = [f for f in found[0] if not any(covers(c, f, inner.domain, deadline) for c in claimed)]
    missing = [f for f in missing if not _are_among(f, claimed, inner, deadline)]
    lost = next((f for f in missing if _has_others(f, claimed, inner, deadline)), None)
    if lost is not None:
        why = f"{'a solution is missing' if claimed else 'there is a solution'}: {_written(lost)}"
        yield Stated(Verdict(Status.FAILS, "all values", "exact", feedback=why), all_of_them)
        return
    if missing:
        among = f"whether {_written(missing[0])} is among the values that are claimed was not decided"
        among += _in_time(deadline)
        whole = _left_open(whole, among)
    certificate = " + ".join(dict.fromkeys([*(v.certificate for v in held), "exact"]))
    yield Stated(replace(whole, question="all values", certificate=certificate) if whole.holds else whole)


def _judged(
    ask: Ask, reading: Reading, inner: Reading, family: Family, wanted: Sequence[Symbol], deadline: Deadline
) -> Verdict:
    """Return whether claimed values are solutions, those of what they leave open included."""
    verdict = _holds_with(ask, inner, family, deadline)
    if verdict.fails:
        return _no_solution(family, verdict)
    beside = _exception(ask, reading, inner, family, wanted, deadline) if verdict.holds else None
    return verdict if beside is None else all_hold([verdict, beside])


def _in_time(deadline: Deadline) -> str:
    """Say in how many seconds something was not decided, where they may have ended it."""
    return f" in {deadline.seconds:g} s" if deadline.over else ""


def _no_solution(family: Family, verdict: Verdict) -> Verdict:
    """Return the verdict on claimed values at which the inner claim fails, with why it does."""
    why = verdict.feedback or (f"{verdict.question} comes out wrong" if verdict.question else "")
    wrong = replace(verdict, feedback=f"{_written(family)} is no solution{': ' if why else ''}{why}")
    return wrong.about(f"the claim with {_written(family)}")


def _left_open(verdict: Verdict, what: str) -> Verdict:
    return all_hold([verdict, Verdict(Status.UNDECIDED, evidence=(Evidence("open", what),))])


def _inner(reading: Reading) -> Reading:
    """Return the claim whose parameters are asked for."""
    kind = reading.word("of")
    claim = reading.claim
    keys = {key: value for key, value in claim.keys.items() if key not in _OWN}
    keys["kind"] = kind
    return Reading(Claim(claim.id, kind, FrozenMapping(keys), budget=claim.budget, file=claim.file))


def _wanted(reading: Reading) -> tuple[Symbol, ...]:
    names = reading.claim.keys["find"]
    declared = reading.claim.keys.get("parameters", {})
    found: list[Symbol] = []
    for name in names if isinstance(names, list) else [names]:
        symbol = reading.scope.symbol(name)
        if symbol is None or name not in declared or name in _state_names(reading):
            reading.fault("find", f"{name} is no parameter; {reading.scope.near(name)}")
        found.append(symbol)
    if not found:
        reading.fault("find", "at least one parameter is needed")
    return tuple(found)


def _state_names(reading: Reading) -> set[str]:
    """Return the names that stand for more than a parameter."""
    names = {reading.time.name}
    for key, value in reading.claim.keys.items():
        if key != "find" and reading.is_names(key):
            names |= set(value if isinstance(value, list) else [value])
    return names


def _given(reading: Reading, wanted: Sequence[Symbol]) -> tuple[Symbol, ...]:
    state = _state_names(reading)
    named = (
        reading.scope.symbol(name) for name in reading.claim.keys.get("parameters", {}) if name not in state
    )
    return tuple(s for s in named if s is not None and s not in wanted)


def _assigned(reading: Reading, i: int, table: Mapping[str, object], wanted: Sequence[Symbol]) -> Family:
    names = {s.name: s for s in wanted}
    family: Family = {}
    for name, text in table.items():
        if name not in names:
            reading.fault(f"values[{i}].{name}", f"is not among find = {', '.join(names)}")
        family[names[name]] = reading.inside(f"values[{i}].{name}", text)[0]
    allowed = {*wanted, *_given(reading, wanted)} - set(family)
    for s, value in family.items():
        foreign = ", ".join(sorted(str(f) for f in value.free_symbols - allowed))
        if foreign:
            reading.fault(f"values[{i}].{s}", f"holds {foreign}; write it in parameters that are left open")
    return family


def _holds_with(ask: Ask, inner: Reading, family: Family, deadline: Deadline) -> Verdict:
    """Judge the inner claim with values put in."""
    outside = _outside(family)
    if outside:
        return Verdict(Status.FAILS, certificate="exact", feedback=outside)
    try:
        there = _with(inner, family)
        verdicts = list(without_value(there, deadline)) if family else []
        if any(v.fails for v in verdicts):
            return all_hold(verdicts)
        for question in _questions(ask, there):
            if isinstance(question, Same) and any(
                p.residual.has(sp.zoo, sp.nan, sp.oo) for p in question.parts
            ):
                return Verdict(Status.FAILS, certificate="structure", feedback="there is no value then")
            verdicts.append(decide(question, deadline))
            if verdicts[-1].fails:
                break
    except InvalidClaim as invalid:
        if not invalid.error.key.startswith("domain"):
            raise
        return Verdict(Status.FAILS, certificate="exact", feedback="the domain excludes that")
    except (Undecided, SingularMatrixError, EmptyDomainError) as reason:
        return Verdict(Status.UNDECIDED, evidence=(Evidence("open", str(reason)),))
    verdicts += _whole(family, inner.domain, deadline) if not any(v.fails for v in verdicts) else []
    return all_hold(verdicts) if verdicts else Verdict(Status.UNDECIDED)


def _whole(family: Family, domain: Domain, deadline: Deadline) -> list[Verdict]:
    """Return whether values of whole parameters are whole numbers: n is one exactly where sin πn = 0.

    A value that is whole for some of the open parameters only, as k/2, may be meant where it is: that is UNDECIDED.
    """
    found: list[Verdict] = []
    for s, value in family.items():
        if not s.is_integer or value.is_integer:
            continue
        verdict = vanishes(sp.sin(sp.pi * value), domain, budget=deadline.left)
        if verdict.fails and value.is_number:
            verdict = replace(verdict, feedback=f"{value} is no whole number")
        elif not verdict.holds:
            why = f"{s} = {value} was not proved to be a whole number for all values of what it is written in"
            verdict = Verdict(Status.UNDECIDED, evidence=(Evidence("open", why),))
        found.append(verdict)
    return found


def _questions(ask: Ask, reading: Reading) -> Iterator[Question]:
    return (question for question in ask(reading) if not isinstance(question, Determines))


def _with(inner: Reading, family: Family) -> Reading:
    """Return the inner claim with values put in, what is assumed of their names said of them."""
    said: list[str] = []
    for s, value in family.items():
        sign = ">" if s.is_positive else "<" if s.is_negative else "!=" if s.is_nonzero else ""
        if sign and not value.is_number:
            said.append(f"{value} {sign} 0")
    domain = inner.claim.keys.get("domain", [])
    conditions = [*(domain if isinstance(domain, list) else [domain]), *said]
    keys = {**inner.claim.keys, **({"domain": conditions} if conditions else {})}
    return replace(inner, claim=replace(inner.claim, keys=FrozenMapping(keys)), at=FrozenMapping(family))


def _exception(
    ask: Ask, reading: Reading, inner: Reading, family: Family, wanted: Sequence[Symbol], deadline: Deadline
) -> Verdict | None:
    """Return FAILS where a value of what is left open is no solution, as an answer says nothing or has no value then.

    What has to be regular, or to say something, was asked at generic values; what is left open may have every value.
    Answers may lack a value at places that are not found in closed form, as tan a does at π/2.
    """
    open_, there = [s for s in wanted if s not in family], _with(inner, family)

    def first(gone: Sequence[Expr], why: str) -> Verdict | None:
        if not any(f.has(*open_) for f in gone):
            return None
        for exception in families(gone, open_, _given(reading, wanted), there.domain, deadline):
            together = {s: substitute(value, exception) for s, value in family.items()} | exception
            if exception and _is_allowed(inner, together):
                said = f"{_written(exception)} is left open, and is no solution: {why}"
                return Verdict(Status.FAILS, "all values", "exact", feedback=said)
        return None

    if not open_:
        return None
    try:
        for question in _questions(ask, there):
            if (found := first(*_not_all_zero(question))) is not None:
                return found
    except Undecided as reason:
        return Verdict(Status.UNDECIDED, evidence=(Evidence("open", str(reason)),))
    for risk in hazards_of_answers(there):
        with suppress(Undecided):
            if (found := first([risk.argument], f"{risk} then")) is not None:
                return found
    return None


def _not_all_zero(question: Question) -> tuple[list[Expr], str]:
    """Return what must not vanish altogether, and what is said where it does."""
    if isinstance(question, Regular):
        determinant = cast("Expr", question.matrix.det(method="berkowitz"))
        return [determinant], question.singular_is or f"{question.name} is singular then"
    if isinstance(question, Tells) and all(isinstance(each, Same) for each in question.trivial):
        same = [each for each in question.trivial if isinstance(each, Same)]
        return [part.residual for each in same for part in each.parts], question.feedback
    return [], ""


def _is_allowed(inner: Reading, family: Family) -> bool:
    """Whether there certainly are such values of the parameters by what is assumed of them."""
    if _outside(family) or any(value.has(sp.zoo, sp.nan) for value in family.values()):
        return False
    try:
        return has_point(_with(inner, family).domain)
    except InvalidClaim:  # the domain excludes them
        return False


def _outside(family: Family) -> str:
    """Say which value is none that the parameter may have."""
    for s, value in family.items():
        wrong = (
            (s.is_positive and value.is_nonpositive)
            or (s.is_negative and value.is_nonnegative)
            or (s.is_nonzero and value.is_zero)
            or (s.is_integer and value.is_integer is False)
            or value.is_real is False
        )
        if wrong:
            return f"{s} can't be {value} by what is assumed of it"
    return ""


def _found(
    ask: Ask, reading: Reading, inner: Reading, wanted: Sequence[Symbol], deadline: Deadline
) -> list[list[Family]]:
    """Return all values for which the inner claim holds, in a list; an empty one where they were not found."""
    asked: list[Question] = []
    try:
        asked += _questions(ask, inner)
    except (Undecided, SingularMatrixError, EmptyDomainError):
        return []
    residuals: list[Expr] = []
    domain = inner.domain
    for question in asked:
        if isinstance(question, Same):
            residuals += [part.residual for part in question.parts]
            domain = question.domain
        elif not isinstance(question, Regular | Tells) and not (
            isinstance(question, Verdict) and question.holds
        ):
            return []
    try:
        candidates = families(residuals, wanted, _given(reading, wanted), domain, deadline)
        verdicts = [_holds_with(ask, inner, family, deadline) for family in candidates]
    except (Undecided, InvalidClaim):
        return []
    if any(verdict.undecided for verdict in verdicts):
        return []
    return [[family for family, verdict in zip(candidates, verdicts, strict=True) if verdict.holds]]


def _are_among(family: Family, claimed: Sequence[Family], inner: Reading, deadline: Deadline) -> bool:
    """Whether every point of a family is one of several others, as ±a are of ±|a|."""
    apart = _distance(family, claimed)
    return len(claimed) > 1 and vanishes(apart, inner.domain, budget=deadline.left).holds


def _has_others(family: Family, claimed: Sequence[Family], inner: Reading, deadline: Deadline) -> bool:
    """Whether a family certainly has a point that is none of the others."""
    part = Part("the values", _distance(family, claimed), sp.S.Zero)
    return decide(Differ(part, inner.domain, ""), deadline).holds


def _distance(family: Family, claimed: Sequence[Family]) -> Expr:
    """Return what vanishes at the points of a family that are among those of others, and nowhere else."""
    return sp.Mul(
        *(
            sp.Add(*((exchanged(value, family) - family.get(s, s)) ** 2 for s, value in each.items()))
            for each in claimed
        )
    )


def _told(
    ask: Ask,
    reading: Reading,
    inner: Reading,
    found: Sequence[Family],
    wanted: Sequence[Symbol],
    deadline: Deadline,
) -> tuple[str, ...] | None:
    """Return the values as they are shown; None where some that they leave open are no solutions."""
    if any(_exception(ask, reading, inner, f, wanted, deadline) is not None for f in found):
        return None
    return tuple(_written(family) for family in found) or ("no values",)


def _written(family: Family) -> str:
    return ", ".join(f"{s} = {value}" for s, value in family.items()) or "any values"
