"""What must vanish for a claim to be right, as a test of its answers in the neighbourhood of a point.

One test for each kind, from values and slopes alone; the laws are those of the judges.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, TypeAlias

from flint import acb
from sympy import Expr, Symbol

from canon.exercise.diagnose.point_derivatives import small
from canon.expression.symbols.symbol import velocity

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from canon.exercise.diagnose.point_derivatives import Neighbourhood
    from canon.exercise.sheet.reading import Reading

__all__ = [
    "Answers",
    "Test",
    "canonical_map",
    "constant",
    "dependent",
    "equality",
    "gauge",
    "generating",
    "implicit",
    "lagrange_brackets",
    "new_hamiltonian",
    "poisson_brackets",
    "solution",
]

MOST_KNOWN = 4

Answers: TypeAlias = "Callable[[str], Expr]"
"""Gives the answer under a key."""
Test: TypeAlias = "Callable[[Answers, Neighbourhood], bool]"


def _keys(*names: str, like: Sequence[Symbol]) -> list[str]:
    return [f"{name}[{i}]" for name in names for i in range(len(like))]


def dependent(reading: Reading) -> tuple[Symbol, ...]:
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


def canonical_map(reading: Reading) -> Test:
    """M J Mᵀ = c J with M = ∂(Q, P)/∂(q, p)."""
    q, p = reading.phase_space("q", "p")
    keys = _keys("Q", "P", like=q)
    key = "factor" if reading.has("factor") else "valence"
    valence = reading.expression(key) if reading.has(key) else None

    def test(answer: Answers, place: Neighbourhood) -> bool:
        M = [place.slopes(answer(key), (*q, *p)) for key in keys]
        return _symplectic(M, acb(1) if valence is None else place.value(valence))

    return test


def equality() -> Test:
    """Both sides have the same value."""

    def test(answer: Answers, place: Neighbourhood) -> bool:
        return small([place.value(answer("lhs")), -place.value(answer("rhs"))])

    return test


def poisson_brackets(reading: Reading) -> Test:
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

    return test


def lagrange_brackets(reading: Reading) -> Test:
    """Σ (∂q/∂u ∂p/∂v − ∂q/∂v ∂p/∂u) is the value of each pair."""
    pairs = reading.brackets("u", "v")
    like = reading.expressions("q")
    size = range(len(like))

    def test(answer: Answers, place: Neighbourhood) -> bool:
        return all(
            small([*_lagrange(answer, place, size, u, v), -place.value(value)]) for u, v, value in pairs
        )

    return test


def _lagrange(answer: Answers, place: Neighbourhood, size: range, u: Expr, v: Expr) -> Iterator[acb]:
    for i in size:
        (qu, qv), (pu, pv) = (place.slopes(answer(f"{k}[{i}]"), _symbols(u, v)) for k in "qp")
        yield from (qu * pv, -qv * pu)


def _symbols(*found: Expr) -> list[Symbol]:
    return [s for s in found if isinstance(s, Symbol)]


def implicit(reading: Reading) -> Test:
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


def generating(reading: Reading) -> Test:
    """The rules of the type of generating function."""
    kind = int(reading.claim.kind[-1])
    q, p, Q, P = (reading.symbols(key) for key in ("q", "p", "new_q", "new_p"))
    there = _mapping(reading)
    old, other_old, sign_old = (q, p, 1) if kind in (1, 2) else (p, q, -1)
    new, other_new, sign_new = (Q, P, -1) if kind in (1, 3) else (P, Q, 1)
    rules = [(y, x, sign_old) for y, x in zip(other_old, old, strict=True)]
    rules += [(y, x, sign_new) for y, x in zip(other_new, new, strict=True)]

    def test(answer: Answers, place: Neighbourhood) -> bool:
        here, F = there(answer, place), answer("F")
        return all(small([here.point[y], -sign * here.slope(F, x)]) for y, x, sign in rules)

    return test


def _mapping(reading: Reading) -> Callable[[Answers, Neighbourhood], Neighbourhood]:
    """Return what adds to a place the values of the dependent variables."""
    which = ("map.Q", "map.P") if reading.has("map") else ("inverse_map.q", "inverse_map.p")
    keys, names = _keys(*which, like=reading.symbols("q")), dependent(reading)
    known: dict[tuple[int, tuple[Expr, ...]], Neighbourhood] = {}

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


def new_hamiltonian(reading: Reading) -> Test:
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

    return test


def _field(slopes: Sequence[acb]) -> list[acb]:
    n = len(slopes) // 2
    return [*slopes[n:], *(-s for s in slopes[:n])]


def constant(reading: Reading, rates: Mapping[Symbol, Expr]) -> Test:
    """Σ ∂I/∂x ẋ + ∂I/∂t = 0."""
    t = reading.time

    def test(answer: Answers, place: Neighbourhood) -> bool:
        I = answer("I")
        slopes = {x: place.slope(I, x) for x in rates}
        if all(small([slope]) for slope in slopes.values()):
            return False  # constant anyway
        return small([place.slope(I, t), *(slopes[x] * place.value(f) for x, f in rates.items())])

    return test


def gauge(reading: Reading) -> Test:
    """L₂ − L₁ = dF/dt."""
    q, t, first = reading.symbols("q"), reading.time, reading.expression("L1")

    def test(answer: Answers, place: Neighbourhood) -> bool:
        F = answer("F")
        moving = (place.slope(F, x) * place.point[velocity(x)] for x in q)
        return small(
            [place.value(answer("L2")), -place.value(first), -place.slope(F, t), *(-m for m in moving)]
        )

    return test


def solution(reading: Reading) -> Test:
    """The functions of time solve Hamilton's equations."""
    q, p = reading.phase_space("q", "p")
    H, t, z = reading.expression("H"), reading.time, (*q, *p)

    def test(answer: Answers, place: Neighbourhood) -> bool:
        motion = [answer(f"solution.{x.name}") for x in z]
        here = place.beyond({x: place.value(f) for x, f in zip(z, motion, strict=True)})
        rates = _field(here.slopes(H, z))
        return all(small([place.slope(f, t), -rate]) for f, rate in zip(motion, rates, strict=True))

    return test
