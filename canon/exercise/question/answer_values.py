"""Values of an answer: what stands in a claim is looked at as it was written, before anything cancels."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.exercise.question.deadline import SIDE_SECONDS
from canon.exercise.sheet.kept_parses import parsed
from canon.exercise.sheet.kind import Shape
from canon.exercise.sheet.kinds import KINDS
from canon.expression.as_written import as_written
from canon.expression.symbols.symbol import Coordinate, acceleration, time_derivative, velocity
from canon.expression.text.tokens import LanguageError
from canon.mechanics.algebra.constraint_manifold import EmptyDomainError, inhabited, on_manifold
from canon.mechanics.algebra.substitution import substitute
from canon.proof.definedness.definedness import lack_beside, lack_of_value
from canon.proof.definedness.formula_around import put_in
from canon.proof.definedness.hazards import hazards
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Evidence, Status, Undecided, Verdict
from canon.proof.trees.anatomy import anatomy

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from sympy import Basic, Expr, Symbol

    from canon.exercise.question.deadline import Deadline
    from canon.exercise.sheet.reading import Reading
    from canon.proof.definedness.definedness import Lack
    from canon.proof.definedness.hazards import Hazard

__all__ = ["hazards_of_answers", "what_may_vanish", "without_value", "without_value_on"]

SHARE = 0.4
"""Part of the time of a claim that may be spent here."""

_EXPRESSIONS = (
    Shape.TEXT, Shape.TEXTS, Shape.EXPRESSIONS, Shape.LISTS, Shape.BRACKETS, Shape.BODIES, Shape.FORCES,
    Shape.VALUES,
)  # fmt: skip


_CONSTRAINTS = ("constraints", "contact")
"""Keys of what vanishes on every motion that has reactions."""


def without_value(reading: Reading, deadline: Deadline) -> Iterator[Verdict]:
    """Yield FAILS for what has a value nowhere, and for answers without one where all that is given has one.

    Where no value is found, and it is not proved that there is none, that is left UNDECIDED.

    Parameters
    ----------
    reading
        The claim.
    deadline
        When its judgement should end.
    """
    until = time.monotonic() + SHARE * deadline.left
    written = dict(_written(reading))
    for key, expression in written.items():
        if lack := lack_of_value(expression, reading.domain, until):
            yield _fails(lack, key) if lack.proved else _open(lack, key)
    following = _following(reading)
    answers = {key: f for key, f in written.items() if _is_answer(reading, key)}
    given = [_seen(f, following) for key, f in written.items() if key not in answers]
    for key, answer in answers.items():
        other = (
            [_seen(f, following) for k, f in answers.items() if k != key] if reading.kind.two_sided else []
        )
        lack = lack_beside(_seen(answer, following), [*given, *other], reading.domain, until)
        lack = lack or _lack_on_the_map(answer, following, until)
        if lack is not None:
            open_ = not lack.proved or _is_one_of_several(reading)
            yield _open(lack, key) if open_ else _fails(lack, key)
    yield from _without_value_on_motions(reading, answers, until)


def _lack_on_the_map(answer: Expr, following: Mapping[Symbol, Expr], until: float) -> Lack | None:
    """Return that an answer has a value nowhere where some variables follow from others, if that is proved."""
    if not _risks(answer, tuple(following)):
        return None
    lack = lack_of_value(_seen(answer, following), Domain(), until)
    return lack if lack is not None and lack.proved else None


def without_value_on(
    reading: Reading,
    key: str,
    bound: Sequence[Symbol],
    motions: Callable[[], Iterable[tuple[Mapping[Any, Expr], Domain]]],
    there: str = "on the motions",
) -> Iterator[Verdict]:
    """Yield what speaks against answers having values on the motions, nothing if they have.

    E²/E = 0 is true of no motion: exactly where E vanishes the quotient has no value. Cancelled it would be another
    equation, so that answers are looked at as they were written.

    Parameters
    ----------
    reading, key
        The claim, and where its answers stand.
    bound
        What motions determine, such as accelerations; answers that have a value whatever these are, are passed over.
    motions
        Yields what is determined in terms of what is free, and where; called only where it is needed.
    there
        In words, where that is.
    """
    risky = [(where, f, risks) for where, f in _written_under(reading, key) if (risks := _risks(f, bound))]
    if not risky:
        return
    until = time.monotonic() + SIDE_SECONDS
    for values, domain in motions():
        for where, f, risks in risky:
            if lack := lack_of_value(_seen(f, values), domain, until):
                said = replace(lack, why=str(risks[0])) if lack.proved and len(risks) == 1 else lack
                yield (_fails if lack.proved else _open)(said, f"{where}, {there},")


def what_may_vanish(reading: Reading, key: str, bound: Sequence[Symbol]) -> list[Expr]:
    """Return what stands below and in logarithms of answers, as they were written, and holds what motions determine.

    Parameters
    ----------
    reading, key, bound
        As for :func:`without_value_on`.
    """
    return [risk.argument for _, f in _written_under(reading, key) for risk in _risks(f, bound)]


def hazards_of_answers(reading: Reading) -> list[Hazard]:
    """Return what must not vanish in the answers of a claim as they were written, with values of parameters put in."""
    answers = [f for key, f in _written(reading) if _is_answer(reading, key)]
    return hazards(anatomy(answers).parts)


def _risks(f: Expr, bound: Sequence[Symbol]) -> list[Hazard]:
    found = hazards(anatomy([f]).parts)
    return [risk for risk in found if not risk.argument.free_symbols.isdisjoint(bound)]


def _written_under(reading: Reading, key: str) -> Iterator[tuple[str, Expr]]:
    """Yield the expressions under a key as they are written, but for those in whose place others are read."""
    for where, f in () if reading.at else _written(reading):
        if _outer(where) == key and where not in reading.instead:
            yield where, f


def _without_value_on_motions(
    reading: Reading, answers: Mapping[str, Expr], until: float
) -> Iterator[Verdict]:
    """Yield FAILS for answers that have a value nowhere on the motions that satisfy the constraints."""
    risky = {key: f for key, f in answers.items() if hazards(anatomy([f]).parts)}
    q = reading.symbols("q") if reading.is_names("q") else ()
    accelerations = [a for a in map(acceleration, q) if any(f.has(a) for f in risky.values())]
    held = _held(reading, second=bool(accelerations)) if risky else []
    if not held:
        return
    prefer = [*map(velocity, q), *accelerations]
    try:
        branches = inhabited(on_manifold(held, reading.domain, keep=(reading.time,), prefer=prefer))
    except (Undecided, EmptyDomainError):  # the judge of the kind says so
        return
    for key, f in risky.items():
        lacks = [lack_of_value(_seen(f, b.values), b.domain, until) for b in branches]
        nowhere = [lack for lack in lacks if lack is not None and lack.proved]
        if len(nowhere) == len(branches):
            yield _fails(nowhere[0], f"{key}, where the constraints hold,")


def _held(reading: Reading, *, second: bool) -> list[Expr]:
    """Return what vanishes on the motions that a claim is about, with first or also second rates of constraints."""
    found: list[Expr] = []
    if any(map(reading.has, ("multipliers", "contact", "T"))):
        found += [f for key in _CONSTRAINTS if reading.has(key) for f in reading.equations(key)]
        q, velocities = reading.symbols("q"), [velocity(x) for x in reading.symbols("q")]
        found += [time_derivative(f, q, reading.time) for f in found if not f.has(*velocities)]
        found += [time_derivative(f, q, reading.time) for f in found if second and f.has(*velocities)]
    return found + (list(reading.equations("restrict")) if reading.has("restrict") else [])


def _seen(f: Expr, following: Mapping[Any, Expr]) -> Expr:
    """Return an expression in the free variables, with nothing cancelled."""
    inside: dict[Basic, Basic] = {
        part: substitute(part, following) for part in f.atoms(sp.Derivative, sp.Subs)
    }
    return put_in(f, {**inside, **following})


def _fails(lack: Lack, key: str) -> Verdict:
    return Verdict(
        Status.FAILS,
        "the answer has a value",
        certificate="definedness",
        counterexample=lack.counterexample,
        feedback=lack.sentence(key),
    )


def _open(lack: Lack, key: str) -> Verdict:
    return Verdict(Status.UNDECIDED, evidence=(Evidence("open", lack.sentence(key)),))


def _is_one_of_several(reading: Reading) -> bool:
    """Whether what one answer leaves out may be said by another one, as values of parameters case by case."""
    kind, keys = KINDS[reading.claim.kind], reading.claim.keys
    return any(kind.shapes[key] is Shape.VALUES and len(keys[key]) > 1 for key in kind.answer if key in keys)


def _is_answer(reading: Reading, key: str) -> bool:
    outer = _outer(key)
    inner_is_given = outer == "pairs" and not key.endswith(".value")
    kind = KINDS[reading.claim.kind]
    return outer in (*kind.answer, *kind.claimed_too) and not inner_is_given


def _outer(where: str) -> str:
    """Return the key of a claim under which something stands."""
    return where.partition(".")[0].partition("[")[0]


def _written(reading: Reading) -> Iterator[tuple[str, Expr]]:
    """Yield every expression of a claim as it is written, by its key, with values of parameters put in."""
    shapes = KINDS[reading.claim.kind].shapes
    extended = reading.with_names(_displacements(reading))
    for key, value in reading.claim.keys.items():
        if shapes.get(key) in _EXPRESSIONS:
            for where, text in _texts(key, value):
                try:
                    yield where, _seen(parsed(as_written, text, extended.scope), reading.at)
                except LanguageError:  # the judge of the kind says what is wrong with it
                    continue


def _texts(key: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, str):
        yield key, value
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from _texts(f"{key}[{i}]", item)
    elif hasattr(value, "items"):
        for name, item in value.items():
            yield from _texts(f"{key}.{name}", item)


def _displacements(reading: Reading) -> dict[str, Symbol]:
    """Return the names d_x and delta_x that judges of variations and differentials add."""
    declared = reading.scope.names
    names = [str(s) for key in ("q", "x") if reading.is_names(key) for s in reading.symbols(key)]
    made: dict[str, Symbol] = {}
    for name in (*names, reading.time.name):
        made[f"d_{name}"] = sp.Symbol(f"d_{name}", real=True)
        made[f"delta_{name}"] = Coordinate(f"delta_{name}", real=True)
    return {name: symbol for name, symbol in made.items() if name not in declared}


def _following(reading: Reading) -> Mapping[Symbol, Expr]:
    """Return the variables that are not free in what is written, in terms of those that are."""
    for key, parts, like in (
        ("map", ("Q", "P"), ("new_q", "new_p")),
        ("inverse_map", ("q", "p"), ("q", "p")),
    ):
        if reading.has(key):
            names = [s for part in like for s in reading.symbols(part)]
            given = reading.claim.keys[key]
            images = [f for part in parts for f in reading.inside(f"{key}.{part}", given.get(part, []))]
            return dict(zip(names, images, strict=False))
    if "p" in reading.kind.following:
        L = reading.expression("L")
        return {p: L.diff(velocity(x)) for x, p in zip(*reading.phase_space("q", "p"), strict=True)}
    return {}
