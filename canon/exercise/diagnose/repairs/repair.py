"""Repairs of an answer that are right: small changes, tried at points and then proved.

Each change is what a person may have got wrong: a sign, a factor, a term, a function, an exponent, a symbol.
Candidates are screened by their values at a few points of the domain, and what survives is proved before
anyone is told.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import chain, islice, starmap
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr

from canon.exercise.diagnose.change import Change, Mistake, rank
from canon.exercise.diagnose.effort import proved_to_vanish
from canon.exercise.diagnose.repairs.component_screen import PRECISION, Screen
from canon.exercise.diagnose.repairs.lost_factor import Monomials
from canon.exercise.diagnose.repairs.lost_inside import in_some_terms, symbol_restored, terms_lost_inside
from canon.exercise.diagnose.repairs.slips import (
    RARER,
    lost_factors,
    of_one_coefficient,
    plain_variants,
    rarer_variants,
    variants,
)
from canon.exercise.diagnose.repairs.unbuilt import Joined, built
from canon.expression.symbols.symbol import Momentum, Rate
from canon.mechanics.algebra.substitution import size, symbols_of
from canon.proof.domain.balls import precision

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from fractions import Fraction

    from canon.exercise.diagnose.effort import Effort
    from canon.exercise.diagnose.repairs.unbuilt import Form
    from canon.exercise.question.question import Part
    from canon.proof.domain.domain import Domain

__all__ = ["Repair", "common_ratio", "is_wrong", "repair", "repairs"]

MOST_VARIANTS = 3_000
MOST_TERMS = 6
MOST_NODES = 200
NODES_A_STEP = 3
"""Nodes of an answer for a step of a candidate, most of which were evaluated for others before."""


@dataclass(frozen=True)
class Repair:
    """A right expression in place of a wrong one, and what was changed."""

    right: Expr
    change: Change
    besides: Change | None = None

    @property
    def rank(self) -> int:
        """Rank among repairs that are right too; the likeliest has the lowest."""
        return rank(self.change) + (0 if self.besides is None else 3 + rank(self.besides))

    @property
    def length(self) -> int:
        """Of a term that is missing: one in momenta is told where several would do, else the shortest."""
        missing = self.change.mistake in (Mistake.TERM_MISSING, Mistake.CORIOLIS_TERM_MISSING)
        term = cast("Expr", self.change.items[0]) if missing else sp.S.Zero
        return size(term) if missing and not term.atoms(Momentum) else 0

    @property
    def changes(self) -> tuple[Change, ...]:
        """What was changed, one thing after the other."""
        return (self.change,) if self.besides is None else (self.change, self.besides)


@dataclass(frozen=True, slots=True)
class _Trial:
    """A candidate: what may be right, not built yet, and what would be changed."""

    form: Form
    change: Change
    besides: Change | None = None

    def built(self, place: str) -> Repair | None:
        """Return the repair of a component, None where SymPy has no such expression."""
        try:
            right = built(self.form)
        except (TypeError, ValueError):
            return None
        return Repair(right, self.change.at(place), self.besides and self.besides.at(place))


def repair(part: Part, domain: Domain, effort: Effort, hints: Sequence[Expr] = ()) -> Repair | None:
    """Return the simplest change that makes one component of an answer right, if one is found and proved."""
    return next(repairs(part, domain, effort, hints), None)


def repairs(part: Part, domain: Domain, effort: Effort, hints: Sequence[Expr] = ()) -> Iterator[Repair]:
    """Yield changes that make one component of an answer right, the simplest first, each of them proved.

    A system whose equations are right one by one can still lack one, so that the whole claim is to be judged
    with the change put in before anyone is told.

    Parameters
    ----------
    part
        The component that is wrong.
    domain
        Where it is meant.
    effort
        What may be spent on looking.
    hints
        Terms that the right answer has, one of which may be missing.
    """
    screen = Screen(part, domain)
    if not screen.points:
        return
    cost = max(1, size(part.claimed) // NODES_A_STEP)
    passing: list[Repair] = []
    for family, least_to_come in _families(part, screen, hints):
        for candidate in family:
            if not effort.spend(cost):
                break
            found = _left_open(candidate, part, screen)
            if found is not None:
                passing.append(found)
        passing.sort(key=lambda candidate: (candidate.rank, candidate.length))
        while passing and (effort.spent or passing[0].rank < least_to_come):
            candidate = passing.pop(0)
            if _is_right(part, candidate.right, domain, effort):
                yield candidate
        if effort.spent:
            return


def _left_open(candidate: _Trial, part: Part, screen: Screen) -> Repair | None:
    """Return a candidate, built, where its values leave open that it is right and it says something."""
    found = candidate.built(part.name) if screen.passes(candidate.form) else None
    if found is None or not _says_something(part, found.right) or _says_only_zeros(part, found.right, screen):
        return None
    return found


def common_ratio(parts: Sequence[Part], domain: Domain) -> Fraction | None:
    """Return the one constant right/claimed that all components share, those that vanish left out."""
    ratios: set[Fraction | None] = set()
    for part in parts:
        screen = Screen(part, domain)
        if screen.vanish(part.right) and screen.vanish(part.claimed):
            continue
        ratios.add(screen.ratio(part.right, part.claimed))
    return ratios.pop() if len(ratios) == 1 else None


def is_wrong(part: Part, domain: Domain) -> bool:
    """Whether a component is wrong as far as its values tell."""
    return not Screen(part, domain).passes(part.claimed)


def _is_right(part: Part, expression: Expr, domain: Domain, effort: Effort) -> bool:
    residual = replace(part, claimed=expression).residual
    return proved_to_vanish(residual, domain, effort)


def _families(part: Part, screen: Screen, hints: Sequence[Expr]) -> Iterator[tuple[Iterator[_Trial], float]]:
    """Yield the candidates in groups, each with the rank below which one that passes is told before those to come."""
    likely = chain(
        _of_all(part, screen),
        _terms_rescaled(part, screen),
        _terms_missing(part, screen, hints),
        starmap(_Trial, symbol_restored(part, screen)),
        _monomials(part, screen),
        _slips(plain_variants(part.claimed)),
        _slips(lost_factors(part.claimed, _symbols(part))),
    )
    yield likely, RARER
    yield _slips(rarer_variants(part.claimed, _symbols(part))), math.inf
    yield _inside(part, screen), math.inf
    yield _two_slips(part, hints), math.inf


def _of_all(part: Part, screen: Screen) -> Iterator[_Trial]:
    """The component as a whole: its sign, or a factor."""
    claimed, name = part.claimed, part.name
    if part.right != 0:
        factor = screen.ratio(part.right, claimed)
        if factor == -1:
            yield _Trial(-claimed, Change.of(Mistake.WRONG_SIGN, place=name))
        elif factor is not None and factor != 0:
            right = sp.Rational(factor.numerator, factor.denominator) * claimed
            yield _Trial(right, Change.of(Mistake.WRONG_FACTOR, factor, place=name))


def _symbols(part: Part) -> list[sp.Symbol]:
    """Return what may have been meant in place of a symbol."""
    return symbols_of(part.claimed, part.right, *part.through, *part.through.values())


def _slips(changed: Iterator[tuple[Form, Change]]) -> Iterator[_Trial]:
    """One slip at one place, or the same one everywhere."""
    for new, change in islice(changed, MOST_VARIANTS):
        yield _Trial(new, change)


def _two_slips(part: Part, hints: Sequence[Expr]) -> Iterator[_Trial]:
    """A slip, and a term is missing besides."""
    for term in (term for term in hints if not term.is_Add):
        for slip in _slips(variants(part.claimed, _symbols(part))):
            yield _Trial(Joined(sp.Add, (slip.form, term)), _missing(term, part), slip.change)


def _terms_rescaled(part: Part, screen: Screen) -> Iterator[_Trial]:
    """One term with a wrong coefficient: the residual is a constant multiple of it.

    It is rather blamed on another term than on that of the acceleration or multiplier.
    """
    claimed, name = part.claimed, part.name
    for terms in _as_sums(claimed):
        for term in sorted(terms, key=lambda term: term.has(*part.determined)):
            share = screen.share_of_residual(term)
            if share is None or share == 0:
                continue
            factor, right = 1 - share, claimed - sp.Rational(share.numerator, share.denominator) * term
            if factor == 0:
                yield _Trial(right, Change.of(Mistake.TERM_SUPERFLUOUS, term, place=name))
            elif factor == -1:
                yield _Trial(right, Change.of(Mistake.TERM_SIGN, term, place=name))
            else:
                yield _Trial(right, Change.of(Mistake.TERM_FACTOR, term, factor, place=name))


def _terms_missing(part: Part, screen: Screen, hints: Sequence[Expr]) -> Iterator[_Trial]:
    """One term of the right answer is not there; its coefficient is found from the residual."""
    known = () if part.through else [term for terms in _as_sums(part.right) for term in terms]
    for term in (*known, *hints):
        share = screen.share_of_residual(term)
        if share is not None and share != 0:
            missing = -sp.Rational(share.numerator, share.denominator) * term
            yield _Trial(part.claimed + missing, _missing(missing, part))


def _monomials(part: Part, screen: Screen) -> Iterator[_Trial]:
    """A term or a factor lost that is a product of powers, found from how the residual scales."""
    claimed, name = part.claimed, part.name
    found = Monomials(part, screen.first, screen.memo)
    with precision(PRECISION):
        missing = list(found.of_residual())
        terms = sorted(sp.Add.make_args(claimed), key=lambda term: term.has(*part.determined))
        factors = [(t, list(found.of_share(t))) for t in terms] if len(terms) <= MOST_TERMS else []
        brackets = [
            (t, s, list(found.of_bracket(t / s))) for t in terms for s in sp.Mul.make_args(t) if s.is_Add
        ]
    for term in missing:
        yield _Trial(claimed - term, _missing(-term, part))
    for term, bracket, lost in brackets:
        for inner in lost:
            change = Change.of(Mistake.TERM_MISSING_IN, bracket, -inner, place=name)
            yield _Trial(claimed - term + term / bracket * (bracket - inner), change)
    for term, products in factors:
        for factor in products:
            yield _Trial(claimed - term + factor * term, lacking(term, factor).at(name))


def _inside(part: Part, screen: Screen) -> Iterator[_Trial]:
    """A term lost in a bracket, a denominator or under a root; a factor that only some terms have."""
    yield from starmap(_Trial, in_some_terms(part, screen))
    with precision(PRECISION):
        lost = list(terms_lost_inside(part, Monomials(part, screen.first, screen.memo)))
    yield from starmap(_Trial, lost)


def _missing(term: Expr, part: Part) -> Change:
    """Return that a term is missing; in an equation of motion with two different velocities it is Coriolis's."""
    velocities = {s for s in sp.Mul.make_args(term) if isinstance(s, Rate)}
    coriolis = bool(part.determined) and len(velocities - {*part.determined}) == 2 == len(velocities)
    mistake = Mistake.CORIOLIS_TERM_MISSING if coriolis else Mistake.TERM_MISSING
    return Change.of(mistake, term, place=part.name)


def lacking(term: Expr, factor: Expr) -> Change:
    """Return in what way a term lacks a factor b/a: a stands for b in it, or a fraction is upside down.

    Examples
    --------
    >>> c, x, y, g, l = sp.symbols("c x y g l")
    >>> lacking(c * x, y / x)
    Change(mistake=<Mistake.SYMBOL: ...>, items=(c*x, c*y), ...)
    >>> lacking(l / g * x, g**2 / l**2).mistake.name, lacking(x, l).mistake.name
    ('UPSIDE_DOWN', 'FACTOR_MISSING')
    """
    above, below = factor.as_numer_denom()
    fraction = sp.sqrt(sp.powsimp(factor))
    if below.is_Symbol and above.is_Symbol and term.as_powers_dict().get(below, 0) > 0:
        return Change.of(Mistake.SYMBOL, term, factor * term)
    if above.is_Function and above.args == (below,):
        return Change.of(Mistake.FUNCTION_MISSING, below, above)
    symbols = fraction.free_symbols
    if len(symbols) == 2 and all(abs(e) == 2 for e in factor.as_powers_dict().values()):
        powers = term.as_powers_dict()
        if all(powers.get(s, 0) * factor.as_powers_dict()[s] < 0 for s in symbols):
            return Change.of(Mistake.UPSIDE_DOWN, term, factor * term)
    return Change.of(Mistake.FACTOR_MISSING, term, factor)


def _says_something(part: Part, right: Expr) -> bool:
    """Whether a repaired equation still holds an acceleration or multiplier, if the wrong one did."""
    return part.right != 0 or not part.claimed.has(*part.determined) or right.has(*part.determined)


def _says_only_zeros(part: Part, right: Expr, screen: Screen) -> bool:
    """Whether a repaired equation is 0 = 0, or every term of it vanishes by itself on the motion."""
    if part.right != 0:
        return False
    new = (s for s in part.determined if right.is_Mul and right.has(s) and not part.claimed.has(s))
    if right == 0 or (size(right) < MOST_NODES and sp.expand(right) == 0) or any(map(screen.vanish, new)):
        return True
    terms = sp.Add.make_args(right)
    return bool(part.through) and len(terms) > 1 and all(map(screen.vanish, terms))


def _as_sums(expression: Expr) -> Iterator[Sequence[Expr]]:
    """Yield the terms as written, then those of the expanded expression."""
    written = sp.Add.make_args(expression)
    yield written
    yield list(of_one_coefficient(expression))
    if sp.count_ops(expression) < 300:
        expanded = sp.Add.make_args(sp.expand(expression))
        if set(expanded) != set(written):
            yield expanded
