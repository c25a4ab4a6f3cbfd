"""Lost terms of an answer that is judged as a whole: terms like those that stand elsewhere in the claim.

What is missing is seldom of a new shape. It is a term of the other components or of what the question gives, with
another coordinate or momentum in it, a momentum or velocity in place of its coordinate, a sine for a cosine, or with
one factor less.
"""

from __future__ import annotations

from itertools import combinations, product
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.repairs.symbol_slips import slipped
from canon.exercise.diagnose.repairs.unbuilt import Joined
from canon.exercise.sheet.kind import Shape
from canon.exercise.sheet.sympy_trees import shown
from canon.expression.symbols.symbol import Coordinate, Momentum, Rate, velocity
from canon.mechanics.algebra.substitution import size
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.exercise.diagnose.repairs.unbuilt import Form
    from canon.exercise.sheet.reading import Reading

__all__ = ["terms_lost"]

MOST_TERMS = 400
MOST_ALIKE = 12
"""Terms whose factors are compared."""
MOST_NODES = 60
"""Size of an expression whose terms are looked at, and of a term that is proposed: longer ones are no help."""
_COEFFICIENTS = tuple(map(sp.Rational, ("1", "-1", "1/2", "-1/2", "2", "-2", "1/3", "-1/3")))
_TWINS = {sp.sin: sp.cos, sp.cos: sp.sin}


def terms_lost(reading: Reading, key: str, answers: Mapping[str, Expr]) -> Iterator[tuple[Form, Change]]:
    """Yield an answer with one term more.

    Parameters
    ----------
    reading
        The claim.
    key
        Where the answer stands.
    answers
        All answers of the claim.
    """
    answer = answers[key]
    there = {
        term.as_coeff_Mul()[1] for term in _terms(answer)
    }  # to these a factor is wrong, not more of them missing
    for term in _vocabulary(reading, answers):
        if term in there:
            continue
        for coefficient in _COEFFICIENTS:
            missing = coefficient * term
            yield Joined(sp.Add, (answer, missing)), Change.of(Mistake.TERM_MISSING, missing)


def _vocabulary(reading: Reading, answers: Mapping[str, Expr]) -> list[Expr]:
    """Return terms without their numbers, those that stand in the claim before those like them."""
    found: dict[Expr, None] = {}
    plain = [t for f in _expressions(reading, answers) for t in _terms(f)]
    for term in _in_the_answers_scale(plain, answers):
        found.setdefault(term.as_coeff_Mul()[1])
    for make in (_itself, _renamed, _with_a_twin, _with_a_factor_less):
        for term in plain:
            for new in make(term, reading):
                bare = new.as_coeff_Mul()[1]
                if not bare.is_Number and size(bare) < MOST_NODES:
                    found.setdefault(bare)
            if len(found) > MOST_TERMS:
                return list(found)[:MOST_TERMS]
    return list(found)


def _expressions(reading: Reading, answers: Mapping[str, Expr]) -> Iterator[Expr]:
    """Yield the answers, then the expressions of the question."""
    yield from answers.values()
    for key, shape in reading.kind.shapes.items():
        if key in reading.kind.repaired or not reading.has(key):
            continue
        match shape:
            case Shape.TEXT:
                yield reading.expression(key)
            case Shape.TEXTS if key in ("Q", "P", "X", "Y"):
                yield from reading.expressions(key)
            case Shape.LISTS:
                value = reading.claim.keys[key]
                for inner in value:
                    yield from reading.inside(f"{key}.{inner}", value[inner])
            case Shape.EXPRESSIONS:
                yield from reading.table(key).values()
            case _:
                pass


def _terms(f: Expr) -> list[Expr]:
    if size(f) > MOST_NODES:
        return [t for t in sp.Add.make_args(f) if size(t) < MOST_NODES]
    return [*sp.Add.make_args(f), *sp.Add.make_args(sp.expand(f))]


def _in_the_answers_scale(plain: Sequence[Expr], answers: Mapping[str, Expr]) -> Iterator[Expr]:
    """Yield terms of the claim with the factor that an answer has beside it: l θ̇²/2 for m l² θ̇²/2 beside g cos θ."""
    own = [t for f in answers.values() for t in sp.Add.make_args(f)]
    for term, other in product(own[:MOST_ALIKE], plain[:MOST_ALIKE]):
        ratio = term / other
        if not ratio.is_Number and ratio.is_commutative and not _moves(ratio):
            yield from (ratio * t for t in plain[:MOST_ALIKE] if size(t) < MOST_NODES)


def _moves(f: Expr) -> bool:
    return bool(f.atoms(Coordinate, Rate, Momentum, sp.Function))


def _itself(term: Expr, _: Reading) -> Iterator[Expr]:
    yield term


def _renamed(term: Expr, reading: Reading) -> Iterator[Expr]:
    """Another degree of freedom; a momentum for its coordinate or the reverse, in one place or all; new for old."""
    names = [reading.symbols(key) if reading.is_names(key) else () for key in ("q", "p", "new_q", "new_p")]
    q, p, new_q, new_p = names
    for i, j in combinations(range(len(q)), 2):
        pairs = [(z[i], z[j]) for z in (q, p) if len(z) > j] + [(velocity(q[i]), velocity(q[j]))]
        yield _put(term, {**dict(pairs), **{b: a for a, b in pairs}})
        yield from (_put(term, {a: b}) for a, b in pairs)
    if p:
        yield _put(term, {**dict(zip(q, p, strict=True)), **dict(zip(p, q, strict=True))})
    both = [*zip(q, p, strict=False), *zip(p, q, strict=False), *((velocity(x), x) for x in q)]
    both += [*zip(q, new_q, strict=False), *zip(p, new_p, strict=False), *zip(q, new_p, strict=False)]
    for a, b in both:
        yield _put(term, {a: b})
        yield from _in_one_factor(term, a, b)


def _put(term: Expr, values: Mapping[Expr, Expr]) -> Expr:
    """Return a term with something else in it; as it is where that would stand behind a d/d…."""
    new = slipped(term, values)
    return term if new is None else new


def _in_one_factor(term: Expr, a: Symbol, b: Symbol) -> Iterator[Expr]:
    for factor in sp.Mul.make_args(term):
        if factor == a or (factor.is_Pow and arguments(factor)[0] == a):
            yield term / a * b


def _with_a_twin(term: Expr, reading: Reading) -> Iterator[Expr]:
    """Sine for cosine in one place or in all, each renamed as well."""
    waves = sorted(term.atoms(sp.sin, sp.cos), key=shown)
    for wave in waves:
        twin = _put(term, {wave: _TWINS[wave.func](arguments(wave)[0])})
        yield twin
        yield from _renamed(twin, reading)
    if len(waves) > 1:
        yield _put(term, {wave: _TWINS[wave.func](arguments(wave)[0]) for wave in waves})


def _with_a_factor_less(term: Expr, reading: Reading) -> Iterator[Expr]:
    for factor in sp.Mul.make_args(term):
        if not factor.is_Number:
            yield term / factor
            yield from _renamed(term / factor, reading)
