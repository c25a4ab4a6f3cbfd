"""Terms lost inside an answer, and factors that some of its terms lack: found from the values that parts should have.

Where the value of the right answer is known, the one that a part of the wrong answer should have follows by undoing,
step by step, what stands around it: other terms are subtracted, other factors divided out, roots and powers undone.
What is found from values is a candidate, which is proved elsewhere.
"""

from __future__ import annotations

from itertools import chain, combinations, islice
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.diagnose.change import Change, Mistake
from canon.expression.symbols.symbol import Rate
from canon.mechanics.algebra.substitution import symbols_of
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from flint import acb
    from sympy import Expr, Symbol

    from canon.exercise.diagnose.repairs.component_screen import Screen
    from canon.exercise.diagnose.repairs.lost_factor import Monomials
    from canon.exercise.question.question import Part

    _Values = Mapping[Symbol | None, acb]
    _Whole = Callable[[Expr], Expr]

__all__ = ["in_some_terms", "symbol_restored", "terms_lost_inside"]

MOST_PARTS = 24
"""Parts of an answer in which a lost term is looked for."""
MOST_TERMS = 6


def terms_lost_inside(part: Part, found: Monomials) -> Iterator[tuple[Expr, Change]]:
    """Yield answers with one term more in a bracket, in a denominator, under a root or in a factor."""
    parts = sorted(islice(_parts(part, found), MOST_PARTS), key=lambda inner: not inner[0].is_Add)
    for node, should_be, whole in parts:
        for missing in found.of_difference(node, should_be):
            if not (missing / node).is_Number:
                change = Change.of(Mistake.TERM_MISSING_IN, node, missing, place=part.name)
                yield whole(node + missing), change
        if node.is_Symbol and node.is_positive:
            for missing in found.of_difference(node**2, {s: v * v for s, v in should_be.items()}):
                root = sp.sqrt(node**2 + missing)
                yield whole(root), Change.of(Mistake.SYMBOL, node, root, place=part.name)


def _parts(part: Part, found: Monomials) -> Iterator[tuple[Expr, _Values, _Whole]]:
    """Yield the inner parts of an answer, the values that each should have, and how the answer is put together."""
    waiting: list[tuple[Expr, _Values, _Whole]] = [(part.claimed, found.values(part.right), lambda new: new)]
    while waiting:
        node, should_be, whole = waiting.pop(0)
        if not should_be:
            continue
        if node is not part.claimed and not node.is_number:
            yield node, should_be, whole
        waiting += _inner(node, should_be, whole, found)


def _inner(
    node: Expr, should_be: _Values, whole: _Whole, found: Monomials
) -> Iterator[tuple[Expr, _Values, _Whole]]:
    """Yield the operands of a sum, product or power with the values that they should have."""
    if node.is_Add or node.is_Mul:
        operands = arguments(node)
        for i, operand in enumerate(operands):
            others = node.func(*operands[:i], *operands[i + 1 :])
            yield operand, _undone(node, others, should_be, found), _around(node.func, others, whole)
        below = node.as_numer_denom()[1] if node.is_Mul else sp.S.One
        if below.is_Mul and not below.is_number:
            above = node * below
            values = found.values(above)
            quotient = {s: values[s] / v for s, v in should_be.items() if s in values and not v.contains(0)}
            yield below, quotient, lambda new: whole(above / new)
    elif node.is_Pow and arguments(node)[1].is_Rational:
        base, exponent = arguments(node)
        above, below = int(sp.numer(exponent)), int(sp.denom(exponent))
        now = found.values(base)
        roots = {s: _root(v, (above, below), now[s]) for s, v in should_be.items() if s in now}
        yield base, {s: v for s, v in roots.items() if v is not None}, lambda new: whole(new**exponent)


def _undone(node: Expr, others: Expr, should_be: _Values, found: Monomials) -> dict[Symbol | None, acb]:
    """Return the values of one operand, the others being right."""
    beside = found.values(others)
    if not beside:
        return {}
    if node.is_Add:
        return {s: v - beside[s] for s, v in should_be.items()}
    return {s: v / beside[s] for s, v in should_be.items() if not beside[s].contains(0)}


def _around(join: Callable[..., Expr], others: Expr, whole: _Whole) -> _Whole:
    return lambda new: whole(join(others, new))


def _root(power: acb, exponent: tuple[int, int], now: acb) -> acb | None:
    """Return the base whose power is known, of the sign that the wrong base has."""
    above, below = exponent
    if not power.imag.contains(0) or not now.imag.contains(0) or power.contains(0):
        return None
    negative = power.real < 0
    if negative and (above % 2 == 0 or below != 1):
        return None
    size = (-power if negative else power) ** (type(power)(below) / above)
    return -size if negative or (below == 1 and above % 2 == 0 and now.real < 0) else size


def symbol_restored(part: Part, screen: Screen) -> Iterator[tuple[Expr, Change]]:
    """Yield answers in which a symbol that some terms have is put to those that lack it, as a mass taken to be one."""
    symbols = symbols_of(part.claimed, part.right, *part.through.values())
    lost = [
        s for s in part.determined if isinstance(s, Rate) and not part.claimed.has(s) and not screen.vanish(s)
    ]
    kept = [s for s in symbols if not isinstance(s, Rate)]
    for terms in (sp.Add.make_args(part.claimed), sp.Add.make_args(sp.expand(part.claimed))):
        for symbol in (*lost, *kept):
            factors = (symbol,) if symbol in lost else (symbol, 1 / symbol, symbol**2, 1 / symbol**2)
            for group in _groups_without(symbol, terms, part, screen):
                for factor in factors:
                    right = sp.Add(*terms) - group + factor * group
                    yield right, Change.of(Mistake.FACTOR_MISSING, group, factor, place=part.name)


def _groups_without(symbol: Expr, terms: Sequence[Expr], part: Part, screen: Screen) -> Iterator[Expr]:
    """Yield the sum of all terms that lack a symbol, then those of every two of them."""
    without = [term for term in terms if not term.has(symbol) and not _is_still(term, part, screen)]
    if 1 < len(without) <= MOST_TERMS:
        yield sp.Add(*without)
    if 2 < len(without) <= MOST_TERMS:
        yield from (sp.Add(*two) for two in combinations(without, 2))


def in_some_terms(part: Part, screen: Screen) -> Iterator[tuple[Expr, Change]]:
    """Yield answers in which a factor that one term has, a(b + c) written as ab + c, is put to those that lack it."""
    terms = sp.Add.make_args(part.claimed)
    if not 1 < len(terms) <= 2 * MOST_TERMS:
        return
    for term in terms:
        others = [other for other in terms if other is not term]
        groups = [sp.Add(*others)]
        if 2 < len(others) <= MOST_TERMS:
            groups += [sp.Add(*(o for o in others if o is not one)) for one in others]
        for factor in _in_front(term):
            for group in groups:
                rest = part.claimed - group
                share = screen.quotient(part.right, rest, factor * group)
                if share is not None and share != 0:
                    whole = sp.Rational(share.numerator, share.denominator) * factor
                    change = Change.of(Mistake.FACTOR_MISSING, group, whole, place=part.name)
                    yield rest + whole * group, change


def _in_front(term: Expr) -> Iterator[Expr]:
    """Yield what may have stood before a bracket: one or two factors of its first term."""
    factors = [f for f in sp.Mul.make_args(term) if not f.is_number]
    powers = [b ** sp.sign(e) for f in factors for b, e in [f.as_base_exp()] if e.is_Integer and abs(e) > 1]
    single: Sequence[Expr] = tuple(dict.fromkeys((*factors, *powers)))
    yield from islice(
        chain(single, (a * b for a, b in combinations(single, 2) if a != 1 / b)), 4 * MOST_TERMS
    )


def _is_still(term: Expr, part: Part, screen: Screen) -> bool:
    """Whether a term holds an acceleration that is zero on the motion, so that no factor of it can be seen."""
    return term.has(*part.determined) and screen.vanish(term)
