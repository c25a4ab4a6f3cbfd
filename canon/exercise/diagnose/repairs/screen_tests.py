"""Screening tests by kind of claim: what must vanish near a point for the answers to be right.

From values and slopes alone; the laws are those of the judges. A kind of claim names the function that makes its test.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, TypeAlias

import sympy as sp
from flint import acb
from sympy import Expr, Symbol

from canon.exercise.claim_verdict import questions
from canon.exercise.diagnose.repairs.answer_places import answers_of
from canon.exercise.diagnose.repairs.point_derivatives import small
from canon.exercise.diagnose.repairs.unbuilt import built
from canon.exercise.judges.canonical import map_values
from canon.exercise.judges.conserved import motion_of
from canon.exercise.question.question import Same
from canon.exercise.sheet.reading import InvalidClaim
from canon.expression.symbols.symbol import acceleration, time_derivative, velocity
from canon.mechanics.algebra.substitution import substitute, symbols_of
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from canon.exercise.diagnose.repairs.point_derivatives import Neighbourhood
    from canon.exercise.diagnose.repairs.unbuilt import Form
    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = [
    "Screened", "Test", "bilinear_covariant", "by_question", "canonicity", "constant", "equality",
    "gauge", "generating", "lagrange_brackets", "motion", "new_hamiltonian", "poisson_brackets", "solution",
]  # fmt: skip

MOST_KNOWN = 4
QUESTION_STEPS = 2_000
"""Steps to derive anew what a judge compares."""

Answers: TypeAlias = "Callable[[str], Form]"
"""Gives the answer under a key."""
Test: TypeAlias = "Callable[[Answers, Neighbourhood], bool]"


@dataclass(frozen=True)
class Screened:
    """The test of a claim's answers, what needs a value, where, what is not answered, and the steps of a candidate."""

    test: Test
    symbols: tuple[Symbol, ...]
    domain: Domain
    given: tuple[Expr, ...] = ()
    steps: int = 0


def _screened(
    reading: Reading, test: Test, given: Sequence[Expr] = (), more: Sequence[Symbol] = ()
) -> Screened:
    """Return a test in which every name of a claim, the time and some more symbols have values."""
    symbols = (*reading.scope.names.values(), reading.time, *more)
    return Screened(test, symbols, reading.domain, tuple(given))


def _on_the_map(reading: Reading, test: Test, given: Sequence[Expr] = ()) -> Screened:
    """Return a test in which the variables that a map gives have the values that follow."""
    names = (*reading.scope.names.values(), reading.time)
    following = _dependent(reading)
    free = tuple(s for s in names if s not in following)
    return Screened(test, free, map_values(reading)[1], tuple(given))


def _keys(*names: str, like: Sequence[Symbol]) -> list[str]:
    return [f"{name}[{i}]" for name in names for i in range(len(like))]


def _dependent(reading: Reading) -> tuple[Symbol, ...]:
    """Return the variables that a map gives."""
    keys = ("new_q", "new_p") if reading.has("map") else ("q", "p")
    return tuple(s for key in keys for s in reading.symbols(key))


def _bracket(a: Sequence[acb], b: Sequence[acb]) -> list[acb]:
    """Return the terms of Poisson's bracket of two functions with these slopes by (q, p)."""
    n = len(a) // 2
    return [term for k in range(n) for term in (a[k] * b[n + k], -a[n + k] * b[k])]


def _symplectic(M: Sequence[Sequence[acb]], valence: acb) -> bool:
    """Whether M J Mᵀ = c J."""
    n = len(M) // 2
    return all(
        small([*_bracket(a, b), *([-valence] if j - i == n else [])])
        for (i, a), (j, b) in combinations(enumerate(M), 2)
    )


def canonicity(reading: Reading) -> Screened:
    """The map is canonical, as functions give it or as equations do."""
    return _screened(reading, _implicit(reading) if reading.has("implicit") else _canonical_map(reading))


def bilinear_covariant(reading: Reading) -> Screened | None:
    """A map multiplies the bilinear covariant by a factor as it does the brackets."""
    return _screened(reading, _canonical_map(reading)) if reading.has("Q") else None


def _canonical_map(reading: Reading) -> Test:
    """M J Mᵀ = c J with M = ∂(Q, P)/∂(q, p)."""
    q, p = reading.phase_space("q", "p")
    keys = _keys("Q", "P", like=q)
    key = "factor" if reading.has("factor") else "valence"
    valence = reading.expression(key) if reading.has(key) else None

    def test(answer: Answers, place: Neighbourhood) -> bool:
        M = [place.slopes(answer(key), (*q, *p)) for key in keys]
        return _symplectic(M, acb(1) if valence is None else place.value(valence))

    return test


def equality(reading: Reading) -> Screened:
    """Both sides have the same value."""

    def test(answer: Answers, place: Neighbourhood) -> bool:
        return small([place.value(answer("lhs")), -place.value(answer("rhs"))])

    return _screened(reading, test)


def poisson_brackets(reading: Reading) -> Screened:
    """{f, g} is the value of each pair."""
    z, pairs = (*reading.symbols("q"), *reading.symbols("p")), range(len(reading.brackets("f", "g")))

    def test(answer: Answers, place: Neighbourhood) -> bool:
        return all(
            small(
                [
                    *_bracket(*(place.slopes(answer(f"pairs[{i}].{k}"), z) for k in "fg")),
                    -place.value(answer(f"pairs[{i}].value")),
                ]
            )
            for i in pairs
        )

    return _screened(reading, test)


def lagrange_brackets(reading: Reading) -> Screened:
    """Σ (∂q/∂u ∂p/∂v − ∂q/∂v ∂p/∂u) is the value of each pair."""
    pairs = reading.brackets("u", "v")
    like = reading.expressions("q")
    size = range(len(like))

    def test(answer: Answers, place: Neighbourhood) -> bool:
        return all(
            small([*_lagrange(answer, place, size, u, v), -place.value(value)]) for u, v, value in pairs
        )

    return _screened(reading, test, [value for *_, value in pairs])


def _lagrange(answer: Answers, place: Neighbourhood, size: range, u: Expr, v: Expr) -> Iterator[acb]:
    for i in size:
        (qu, qv), (pu, pv) = (place.slopes(answer(f"{k}[{i}]"), _symbols(u, v)) for k in "qp")
        yield from (qu * pv, -qv * pu)


def _symbols(*found: Expr) -> list[Symbol]:
    return [s for s in found if isinstance(s, Symbol)]


def _implicit(reading: Reading) -> Test:
    """B J Bᵀ = c A J Aᵀ with A = ∂G/∂Z and B = ∂G/∂z, for any Z: a sufficient condition, and one for most schemes.

    It says that all the maps G(z, Z) = constant are canonical.
    """
    old = (*reading.symbols("q"), *reading.symbols("p"))
    new = (*reading.symbols("new_q"), *reading.symbols("new_p"))
    keys = _keys("implicit", like=new)
    valence = reading.expression("valence") if reading.has("valence") else None
    pairs = list(combinations(range(len(keys)), 2))

    def test(answer: Answers, place: Neighbourhood) -> bool:
        G = [answer(key) for key in keys]
        A, B = ([place.slopes(g, z) for g in G] for z in (new, old))
        c = acb(1) if valence is None else place.value(valence)
        return all(
            small([*_bracket(B[i], B[j]), *(-c * term for term in _bracket(A[i], A[j]))]) for i, j in pairs
        )

    return test


def generating(reading: Reading) -> Screened:
    """The rules of the type of generating function."""
    number = reading.kind.implied["type"]
    q, p, Q, P = (reading.symbols(key) for key in ("q", "p", "new_q", "new_p"))
    there = _mapping(reading)
    old, other_old, sign_old = (q, p, 1) if number in (1, 2) else (p, q, -1)
    new, other_new, sign_new = (Q, P, -1) if number in (1, 3) else (P, Q, 1)
    rules = [(y, x, sign_old) for y, x in zip(other_old, old, strict=True)]
    rules += [(y, x, sign_new) for y, x in zip(other_new, new, strict=True)]

    def test(answer: Answers, place: Neighbourhood) -> bool:
        here, F = there(answer, place), answer("F")
        return all(small([here.point[y], -sign * here.slope(F, x)]) for y, x, sign in rules)

    return _on_the_map(reading, test)


def _mapping(reading: Reading) -> Callable[[Answers, Neighbourhood], Neighbourhood]:
    """Return what adds to a place the values of the dependent variables."""
    which = ("map.Q", "map.P") if reading.has("map") else ("inverse_map.q", "inverse_map.p")
    keys, names = _keys(*which, like=reading.symbols("q")), _dependent(reading)
    known: dict[tuple[int, tuple[Form, ...]], Neighbourhood] = {}

    def there(answer: Answers, place: Neighbourhood) -> Neighbourhood:
        images = tuple(answer(key) for key in keys)
        found = known.get((id(place), images))
        if found is None:
            values = {name: place.value(f) for name, f in zip(names, images, strict=True)}
            found = place.beyond(values)
            if len(known) < MOST_KNOWN:
                known[id(place), images] = found
        return found

    return there


def new_hamiltonian(reading: Reading) -> Screened:
    """With Z = Z(z, t): ∂Z/∂t + M J ∇H = J ∇K; the same with z and Z, H and K exchanged for the inverse map."""
    there, t, H = _mapping(reading), reading.time, reading.expression("H")
    z = (*reading.symbols("q"), *reading.symbols("p"))
    Z = (*reading.symbols("new_q"), *reading.symbols("new_p"))
    forward = reading.has("map")
    which = ("map.Q", "map.P") if forward else ("inverse_map.q", "inverse_map.p")
    keys = _keys(*which, like=reading.symbols("q"))
    start, end = (z, Z) if forward else (Z, z)

    def test(answer: Answers, place: Neighbourhood) -> bool:
        M = [place.slopes(answer(key), start) for key in keys]
        if not _symplectic(M, acb(1)):
            return False
        here, K = there(answer, place), answer("K")
        before, after = (H, K) if forward else (K, H)
        field, wanted = _field(place.slopes(before, start)), _field(here.slopes(after, end))
        return all(
            small([place.slope(answer(key), t), *(a * b for a, b in zip(row, field, strict=True)), -rate])
            for key, row, rate in zip(keys, M, wanted, strict=True)
        )

    return _on_the_map(reading, test, [H])


def _field(slopes: Sequence[acb]) -> list[acb]:
    n = len(slopes) // 2
    return [*slopes[n:], *(-s for s in slopes[:n])]


def constant(reading: Reading) -> Screened | None:
    """Σ ∂I/∂x ẋ + ∂I/∂t = 0."""
    if reading.has("restrict"):
        return None
    t, rates = reading.time, motion_of(reading)

    def test(answer: Answers, place: Neighbourhood) -> bool:
        I = answer("I")
        slopes = {x: place.slope(I, x) for x in rates}
        if all(small([slope]) for slope in slopes.values()):
            return False  # constant anyway
        return small([place.slope(I, t), *(slopes[x] * place.value(f) for x, f in rates.items())])

    return _screened(reading, test, tuple(rates.values()), tuple(rates))


def gauge(reading: Reading) -> Screened | None:
    """L₂ − L₁ = dF/dt."""
    if not reading.has("F"):
        return None
    q, t, first = reading.symbols("q"), reading.time, reading.expression("L1")

    def test(answer: Answers, place: Neighbourhood) -> bool:
        F = answer("F")
        moving = (place.slope(F, x) * place.point[velocity(x)] for x in q)
        return small(
            [place.value(answer("L2")), -place.value(first), -place.slope(F, t), *(-m for m in moving)]
        )

    return _screened(reading, test, [first], [velocity(x) for x in q])


def solution(reading: Reading) -> Screened | None:
    """The functions of time solve Hamilton's equations."""
    if not reading.has("solution"):
        return None
    q, p = reading.phase_space("q", "p")
    H, t, z = reading.expression("H"), reading.time, (*q, *p)

    def test(answer: Answers, place: Neighbourhood) -> bool:
        motion = [answer(f"solution.{x.name}") for x in z]
        here = place.beyond({x: place.value(f) for x, f in zip(z, motion, strict=True)})
        rates = _field(here.slopes(H, z))
        return all(small([place.slope(f, t), -rate]) for f, rate in zip(motion, rates, strict=True))

    return _screened(reading, test, [H])


def motion(reading: Reading) -> Screened | None:
    """The functions of time, or the velocities, satisfy the equations of motion and the initial values."""
    key, t = "solution" if reading.has("solution") else "rates", reading.time
    given = {
        s: f"{key}.{s.name}" for s in map(reading.scope.symbol, reading.claim.keys[key]) if s is not None
    }
    laws = _laws(reading)
    known: dict[tuple[Expr, ...], list[Expr]] = {}

    def test(answer: Answers, place: Neighbourhood) -> bool:
        claimed = tuple(built(answer(name)) for name in given.values())
        if claimed not in known:
            known.clear()
            known[claimed] = _left_over(laws, dict(zip(given, claimed, strict=True)), reading, key == "rates")
        return all(small([place.value(f)]) for f in known[claimed])

    moving = [rate(s) for s in given for rate in (velocity, acceleration)]
    return _screened(reading, test, laws, [t, *moving])


def _laws(reading: Reading) -> list[Expr]:
    """Return what vanishes along the motion, in accelerations or in rates."""
    if reading.has("equations"):
        return list(reading.equations("equations"))
    if not reading.has("L"):
        return [velocity(x) - f for x, f in motion_of(reading).items()]
    q = reading.symbols("q")
    forces = reading.expressions("Qnc", like="q") if reading.has("Qnc") else (sp.S.Zero,) * len(q)
    equations = Lagrangian(reading.expression("L"), q, t=reading.time).equations
    return [e - Q for e, Q in zip(equations, forces, strict=True)]


def _left_over(
    laws: Sequence[Expr], claimed: Mapping[Symbol, Expr], reading: Reading, are_rates: bool
) -> list[Expr]:
    """Return what is left of the laws and of the initial values with a motion put in."""
    t = reading.time
    if are_rates:
        motion: dict[Symbol, Expr] = {velocity(x): f for x, f in claimed.items()}
        rates = {x: time_derivative(f, tuple(claimed), t) for x, f in claimed.items()}
        motion |= {acceleration(x): substitute(f, motion) for x, f in rates.items()}
        return [substitute(e, motion) for e in laws]
    motion = dict[Symbol, Expr](claimed)
    for x, f in claimed.items():
        motion |= {velocity(x): f.diff(t), acceleration(x): f.diff(t, 2)}
    start = {t: reading.expression("t0", sp.S.Zero)}
    initial = reading.table("initial") if reading.has("initial") else {}
    found = [substitute(e, motion) for e in laws]
    for name, value in initial.items():
        s = reading.scope.symbol(name)
        if s is not None and s in motion:
            found.append(substitute(motion[s], start) - value)
    return found


def by_question(reading: Reading) -> Screened | None:
    """What the judge compares first, derived anew for each candidate: for kinds without a law of their own here."""
    keys = [key for key, _ in answers_of(reading)]
    first = _compared(reading)
    if first is None:
        return None

    def test(answer: Answers, place: Neighbourhood) -> bool:
        trial = reading
        for key in keys:
            trial = trial.with_instead(key, built(answer(key)))
        here = _compared(trial)
        return here is not None and all(
            small([place.value(part.seen(part.claimed)), -place.value(part.right)]) for part in here.parts
        )

    symbols = symbols_of(*(f for part in first.parts for f in (part.seen(part.claimed), part.right)))
    given = tuple(part.right for part in first.parts)
    names = dict.fromkeys((*reading.scope.names.values(), reading.time, *symbols))
    return Screened(test, tuple(names), first.domain, given, QUESTION_STEPS)


def _compared(reading: Reading) -> Same | None:
    """Return what a judge compares first; None where it does not come to compare anything."""
    try:
        return next((q for q in questions(reading) if isinstance(q, Same)), None)
    except (InvalidClaim, Undecided):
        return None
