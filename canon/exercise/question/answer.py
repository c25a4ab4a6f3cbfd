"""Answer of a claim: the variables in which it may be written, and what it leaves open."""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.exercise.question.deadline import SIDE_SECONDS
from canon.exercise.question.question import Chain, Part, Question, fails
from canon.exercise.sheet.kind import Shape
from canon.expression.symbols.symbol import Coordinate, Rate, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.linear import eliminate
from canon.proof.definedness.open_regimes import regimes
from canon.proof.domain.verdict import Undecided
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = ["equations_missing", "links", "open_brackets", "other_variables", "stay_open"]

MOST_NAMES = 6
"""Names that are listed in one sentence."""


def other_variables(reading: Reading) -> Iterator[Verdict]:
    """Yield FAILS where the answer is written in other variables than ``in`` allows; otherwise nothing."""
    if not reading.has("in"):
        return
    allowed = _allowed(reading)
    found = {str(s) for answer in _answers(reading) for s in answer.free_symbols} - allowed
    if found:
        names = ", ".join(reading.words("in")) or "parameters and the time alone"
        stand = f"{', '.join(sorted(found))} {'stands' if len(found) == 1 else 'stand'}"
        yield fails("the variables of the answer", f"{stand} in the answer; it should be written in {names}")


def _allowed(reading: Reading) -> set[str]:
    """Return the names under ``in``, of parameters and constants, of the time, and d_x and delta_x of variables."""
    scope, listed = reading.scope, set(reading.words("in"))
    for name in sorted(listed):
        if scope.symbol(name) is None and name not in scope.functions:
            reading.fault("in", f"{name} is not declared; {scope.near(name)}")
    shapes = reading.kind.shapes
    names = (key for key, shape in shapes.items() if shape is Shape.NAMES and reading.has(key))
    moving = {name for key in names if key not in ("constants", "small") for name in reading.words(key)}
    declared = {*scope.names, *reading.claim.keys.get("parameters", {})} - moving
    rates = {name for name in declared if isinstance(scope.symbol(name), Rate)}
    return (declared - rates) | listed | set(_displacements(reading)) | {reading.time.name}


def _displacements(reading: Reading) -> dict[str, Symbol]:
    """Return the names d_x and delta_x for each variable and the time."""
    keys = [key for key in ("q", "x") if reading.is_names(key)]
    names = [reading.time.name, *(name for key in keys for name in reading.words(key))]
    return {f"{mark}_{name}": Coordinate(f"{mark}_{name}") for name in names for mark in ("d", "delta")}


def _answers(reading: Reading) -> Iterator[Expr]:
    """Yield the expressions of the answer as they were written."""
    shapes, extended = reading.kind.shapes, reading.with_names(_displacements(reading))
    for key in reading.kind.answer:
        if reading.has(key) and shapes[key] is not Shape.WORDS:
            for where, text in _texts(key, shapes[key], reading.claim.keys[key]):
                yield extended.equation(where, text)


def _texts(key: str, shape: Shape, value: Any) -> list[tuple[str, Any]]:
    """Return the expressions under a key as texts, and where each of them stands."""
    if shape is Shape.BRACKETS:
        return [(f"{key}[{i}].value", pair["value"]) for i, pair in enumerate(value)]
    if shape is Shape.VALUES:
        return [(f"{key}[{i}].{name}", text) for i, row in enumerate(value) for name, text in row.items()]
    if shape is Shape.EXPRESSIONS:
        return [(f"{key}.{name}", text) for name, text in value.items()]
    if isinstance(value, list):  # a list under a key for one expression holds one
        return [(f"{key}[{i}]" if shape is Shape.TEXTS else key, text) for i, text in enumerate(value)]
    return [(key, value)]


def links(reading: Reading, answers: Callable[[str, str], Iterator[Question]]) -> Iterator[Chain]:
    """Yield the question whether the sides of each chain are the same, some variables following others."""
    through = _following(reading) if reading.links else {}
    for place, text, left in reading.links:
        part = Part(f"the chain under {place}", reading.equation(place, text), through=through)
        shown = " ".join(text.replace("=", " = ").split())
        said = f"two sides under {place} that are said to be equal are not: {shown}"
        yield Chain(part, reading.domain, said, partial(answers, place, left))


def _following(reading: Reading) -> dict[Symbol, Expr]:
    """Return what follows from other variables: momenta are ∂L/∂q̇, new variables those of the map."""
    if reading.has("L") and ("p" in reading.kind.following or reading.has("cyclic")):
        L, names = reading.expression("L"), ("cyclic", "momenta") if reading.has("cyclic") else ("q", "p")
        q, p = reading.phase_space(*names)
        return {momentum: L.diff(velocity(x)) for x, momentum in zip(q, p, strict=True)}
    if reading.has("solution"):
        moves = reading.table("solution")
        known = {s: moves[s.name] for s in reading.symbols("q") if s.name in moves}
        return {**known, **{velocity(x): f.diff(reading.time) for x, f in known.items()}}
    for key, old, new in (("map", ("Q", "P"), ("new_q", "new_p")), ("inverse_map", ("q", "p"), ("q", "p"))):
        if (reading.has("K") or reading.has("F")) and reading.has(key):
            images = reading.lists(key, dict(zip(old, new, strict=True)))
            names = [*reading.symbols(new[0]), *reading.symbols(new[1])]
            return dict(zip(names, (*images[0], *images[1]), strict=True))
    return {}


def stay_open(names: Sequence[object]) -> tuple[str, ...]:
    """Return the sentence that some unknowns stay open, none where there are none.

    Examples
    --------
    >>> stay_open(["lam_2"]), stay_open(["x_ddot", "lam"]), stay_open([])
    (('lam_2 stays open',), ('x_ddot, lam stay open',), ())
    """
    if not names:
        return ()
    shown = ", ".join(map(str, names[:MOST_NAMES]))
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return (f"{shown}{more} {'stays' if len(names) == 1 else 'stay'} open",)


def open_brackets(wanted: Sequence[tuple[Expr, Expr]], given: Sequence[tuple[Expr, Expr]]) -> tuple[str, ...]:
    """Return which of the wanted brackets are not among those given, {g, f} being as good as {f, g}.

    Examples
    --------
    >>> x, y, z = sp.symbols("x y z")
    >>> open_brackets([(x, y), (y, x), (x, x), (x, z)], [(y, x)])
    ('{x, z} stays open',)
    """
    known = {frozenset(pair) for pair in given}
    missing: list[str] = []
    for f, g in wanted:
        if f != g and frozenset((f, g)) not in known:
            known.add(frozenset((f, g)))
            missing.append(f"{{{f}, {g}}}")
    return stay_open(missing)


def equations_missing(
    claimed: Sequence[Expr], right: Sequence[Expr], unknowns: Sequence[Symbol], domain: Domain
) -> tuple[str, ...]:
    """Return what claimed equations leave open of the unknowns that the right ones determine.

    That may be so on an open part of the domain alone, where a factor with pieces is zero.

    Raises
    ------
    Undecided
        Where an equation is not affine in the unknowns, or a rank was not decided.

    Examples
    --------
    >>> from canon import Domain
    >>> x, y = sp.symbols("x y")
    >>> equations_missing([x + y], [x - 1, y], [x, y], Domain())
    ('x, y stay open: 1 equation is missing',)
    >>> equations_missing([x + y, x - y], [x - 1, y], [x, y], Domain())
    ()
    >>> a = sp.Symbol("a", real=True)
    >>> equations_missing([sp.Max(a, 0) * x, y], [x - 1, y], [x, y], Domain())
    ('x stays open: 1 equation is missing, where a < 0',)
    """
    told, whole = (sp.Matrix([[e.diff(u) for u in unknowns] for e in some]) for some in (claimed, right))
    if told.has(*unknowns):
        raise Undecided(
            "an equation is not affine in the unknowns, so what it leaves open was not decided; solve it for them"
        )
    if found := _rank_missing(told, whole, unknowns, domain):
        return found
    entries = [*told.flat(), *whole.flat()]
    for regime in regimes(entries, domain, time.monotonic() + SIDE_SECONDS):
        size = told.rows * told.cols
        first = sp.Matrix(told.rows, told.cols, list(regime.formulas[:size]))
        second = sp.Matrix(whole.rows, whole.cols, list(regime.formulas[size:]))
        if found := _rank_missing(first, second, unknowns, regime.domain):
            return tuple(f"{sentence}, where {regime}" for sentence in found)
    return ()


def _rank_missing(
    told: sp.Matrix, whole: sp.Matrix, unknowns: Sequence[Symbol], domain: Domain
) -> tuple[str, ...]:
    """Return what equations with some slopes leave open that those with others determine, at generic points."""
    free, known = eliminate(told, domain=domain), eliminate(whole, domain=domain)
    missing = known.rank - free.rank
    if missing <= 0:
        return ()
    undetermined = _moved(free.null_directions, domain) - _moved(known.null_directions, domain)
    named = stay_open([unknowns[i] for i in sorted(undetermined)])
    lack = f"{counted(missing, 'equation')} {'is' if missing == 1 else 'are'} missing"
    return (f"{named[0]}: {lack}" if named else lack,)


def _moved(directions: Sequence[tuple[Expr, ...]], domain: Domain) -> set[int]:
    """Return the components that certainly do not vanish in all directions."""
    return {
        i
        for direction in directions
        for i, component in enumerate(direction)
        if component != 0 and vanishes(component, domain, budget=SIDE_SECONDS).fails
    }
