"""Kinks of moduli, maxima and pieces, left out of questions: a claim about mechanics is never wrong only there.

The derivative of |u| is sign(u) where u ≠ 0; where u = 0 it has none, though SymPy's sign(0) is 0. The set u = 0 may be
left out of a domain only where it is thin, that is without inner points: |max(0, x)| has its kinks at all x ≤ 0 by that
rule, and at x = 0 in truth.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from itertools import combinations
from types import MappingProxyType
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.relational import Relational

from canon.proof.analytic import is_analytic
from canon.proof.domain.domain import Domain
from canon.proof.domain.limits import QUICK
from canon.proof.domain.reality import certainly_real
from canon.proof.domain.verdict import Evidence, Status, Verdict
from canon.proof.refute.refute import look_for_counterexample
from canon.proof.refute.sample_functions import evaluated
from canon.proof.rungs.ladder import REFUSALS, is_empty, prove_zero
from canon.proof.trees.anatomy import Anatomy, anatomy
from canon.proof.trees.replacement import KINKED, NoValue, defined_nowhere, replaced
from canon.proof.trees.sympy_types import arguments
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

__all__ = [
    "WITH_PIECES",
    "OffKinks",
    "is_thin",
    "off_kinks",
    "vanishes_off_kinks",
    "vanishes_on_no_piece",
    "variants_of",
]

WITH_PIECES = (*KINKED, sp.Piecewise, sp.DiracDelta)
"""Functions with kinks, and what SymPy writes for the derivative of a jump."""

MOST_VARIANTS = 32
"""Ways to choose pieces and signs of roots in one function that are looked at."""

MOST_KINKS = 40
"""Kinks that are looked at; those of more parts are only left out where a claim would fail there."""

SECONDS = 0.3
"""Time to find out whether one function vanishes on a piece of the domain."""

POINTS = 6
BITS = 128

ONLY_AT_KINKS = (
    "points where the claim is wrong were found only at kinks, which may fill a piece of the domain"
)


@dataclass(frozen=True)
class OffKinks:
    """A domain without the kinks of some functions.

    Parameters
    ----------
    whole
        The domain itself.
    domain
        The domain without the kinks that are certainly thin.
    strictly
        The domain without those either of which it is not known.
    known
        What is known off the kinks: derivatives of jumps vanish, equalities that hold there only are false.
    """

    whole: Domain
    domain: Domain
    strictly: Domain
    known: Mapping[sp.Basic, sp.Basic] = field(default_factory=lambda: MappingProxyType({}))

    def seen(self, f: Expr) -> Expr:
        """Return an expression as it is off the kinks; as it stands where it has no value there."""
        if not self.known:
            return f
        try:
            found = replaced(f, self.known)
        except NoValue:
            return f
        return f if defined_nowhere(found) else found

    def ask(self, question: Callable[[Domain], Verdict], by_point: Status = Status.FAILS) -> Verdict:
        """Return the answer to a question off the kinks.

        Parameters
        ----------
        question
            Gives the answer for a domain.
        by_point
            The answer that one point is enough for: such a point must not be at a kink.
        """
        verdict = question(self.domain)
        if (
            verdict.holds
            and self.domain is not self.whole
            and is_empty(self.domain, time.monotonic() + SECONDS)
        ):
            return question(self.whole)
        if verdict.status is not by_point or self.strictly is self.domain:
            return verdict
        strict = question(self.strictly)
        if strict.status is by_point:
            return strict
        return replace(
            strict,
            status=Status.UNDECIDED,
            certificate="",
            evidence=(*strict.evidence, Evidence("kinks", ONLY_AT_KINKS)),
        )


def off_kinks(functions: Iterable[Expr], domain: Domain) -> OffKinks:
    """Return a domain without the kinks that some functions have.

    Parameters
    ----------
    functions
        What is differentiated, or follows from derivatives.
    domain
        The domain to be narrowed.

    Examples
    --------
    >>> x, k = sp.symbols("x k", real=True)
    >>> off_kinks([abs(k * x), sp.Max(x, 1)], Domain()).domain.conditions
    (Ne(k, 0), Ne(x, 0), Ne(1 - x, 0))
    >>> off_kinks([abs(sp.Max(x, 0))], Domain()).domain.conditions
    (Ne(x, 0),)
    """
    found = anatomy([evaluated(f) for f in functions])
    if not found.has(*WITH_PIECES):
        return OffKinks(domain, domain, domain)
    settled: dict[Expr, bool | None] = {}
    off: dict[sp.Basic, sp.Basic] = {}
    for part, gap in _gaps(found):
        variants = variants_of(gap) if len(settled) < MOST_KINKS else None
        factors = list(_factors([gap] if variants is None else variants))
        for factor in factors:
            if factor not in settled:
                settled[factor] = variants is not None and is_thin(factor, domain)
        if all(settled[factor] is True for factor in factors):
            off |= _off_its_kink(part, variants or [])
    thin, doubtful = _where(settled, so=True), _where(settled, so=False)
    narrowed = Domain((*domain.conditions, *thin), domain.box) if thin else domain
    strictly = Domain((*narrowed.conditions, *doubtful), domain.box) if doubtful else narrowed
    return OffKinks(domain, narrowed, strictly, off)


def _where(settled: Mapping[Expr, bool | None], *, so: bool) -> list[Boolean]:
    """Return that factors do not vanish, those of which it was found that they vanish on thin sets, or that not."""
    return [cast("Boolean", sp.Ne(f, 0, evaluate=False)) for f, is_thin in settled.items() if is_thin is so]


def _off_its_kink(part: sp.Basic, variants: Sequence[Expr]) -> dict[sp.Basic, sp.Basic]:
    """Return what δ(u), u = 0 and u ≠ 0 are off the places where u vanishes."""
    if isinstance(part, sp.DiracDelta):
        return {part: sp.Integer(0)}
    if isinstance(part, sp.Eq | sp.Ne) and _are_asked(variants):
        return {part: sp.true if isinstance(part, sp.Ne) else sp.false}
    return {}


def vanishes_off_kinks(expr: Expr | sp.MatrixBase, domain: Domain, budget: float = 10.0) -> Verdict:
    """Decide whether an expression, or every entry of a matrix, is zero off its kinks.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> vanishes_off_kinks(sp.sign(x) ** 2 - 1, Domain()).status.name
    'HOLDS'
    >>> vanishes_off_kinks(sp.sign(x) - 1, Domain()).status.name
    'FAILS'
    """
    deadline = time.monotonic() + budget
    off = off_kinks(expr.flat() if isinstance(expr, sp.MatrixBase) else [expr], domain)
    seen = expr.applyfunc(off.seen) if isinstance(expr, sp.MatrixBase) else off.seen(expr)
    return off.ask(lambda narrowed: vanishes(seen, narrowed, max(0.05, deadline - time.monotonic())))


def vanishes_on_no_piece(f: Expr, domain: Domain) -> bool:
    """Tell whether a function with pieces is certainly zero on no piece of a domain.

    Off kinks it is near every point one of the formulas that its pieces make it; none of these is zero on a piece.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> [vanishes_on_no_piece(f, Domain()) for f in (sp.Max(x, 1), x * abs(x - 1), sp.Max(x, 0), x + abs(x))]
    [True, True, False, False]
    """
    variants = variants_of(f)
    return bool(variants) and _are_asked(variants) and all(is_thin(g, domain) for g in _factors(variants))


def _gaps(found: Anatomy) -> Iterator[tuple[sp.Basic, Expr]]:
    """Yield each function with kinks, or bound of a piece, and what vanishes at them and may do so."""
    for part in found.of(*WITH_PIECES):
        for kink, gap in _gaps_of(part):
            if gap.free_symbols <= found.symbols and _varies(gap):
                yield kink, gap


def _gaps_of(part: sp.Basic) -> list[tuple[sp.Basic, Expr]]:
    if isinstance(part, sp.Max | sp.Min):
        return [(part, a - b) for a, b in combinations(arguments(part), 2)]
    if isinstance(part, sp.Piecewise):
        bounds = sorted(part.atoms(Relational), key=sp.default_sort_key)
        return [(c, cast("Expr", c.lhs) - cast("Expr", c.rhs)) for c in bounds]
    return [(part, arguments(part)[0])]


def _varies(f: Expr) -> bool:
    """Tell whether a function may go through zero: it depends on something that is not a whole number."""
    return not all(s.is_integer for s in f.free_symbols)


def variants_of(gap: Expr) -> list[Expr] | None:
    """Return a function with each choice of its pieces, of which one holds near every point off inner kinks."""
    chosen: list[Expr] = [gap]
    done: list[Expr] = []
    while chosen:
        f = chosen.pop()
        inner = next((e for e in anatomy([f]).of(*WITH_PIECES) if not _nested(e)), None)
        pieces = [] if inner is None else _pieces(inner)
        if pieces is None or len(chosen) + len(done) > MOST_VARIANTS:
            return None
        if inner is None:
            done.append(f)
            continue
        try:
            chosen += [replaced(f, {inner: piece}) for piece in pieces]
        except NoValue:
            return None
    return done


def _nested(function: sp.Basic) -> bool:
    return any(a.has(*WITH_PIECES) for a in function.args)


def _pieces(function: sp.Basic) -> list[Expr] | None:
    """Return what a function without inner kinks may be off its own kinks, None where that is not known."""
    if isinstance(function, sp.Piecewise):
        return [piece for piece, _ in cast("tuple[tuple[Expr, sp.Basic], ...]", function.args)]
    if isinstance(function, sp.Max | sp.Min):
        return list(arguments(function))
    if isinstance(function, sp.DiracDelta):
        return [sp.Integer(0)]
    u = arguments(function)[0]
    if not certainly_real(u):
        return None
    if isinstance(function, sp.Abs):
        return [u, -u]
    return [sp.Integer(1), sp.Integer(0) if isinstance(function, sp.Heaviside) else sp.Integer(-1)]


def _factors(variants: list[Expr]) -> Iterator[Expr]:
    """Yield what vanishes where one of some functions does, without what is known not to vanish."""
    for variant in variants:
        for factor in sp.Mul.make_args(variant):
            base = factor.as_base_exp()[0]
            if _varies(base) and not base.is_nonzero:
                yield base


def _are_asked(variants: Sequence[Expr]) -> bool:
    """Tell whether all factors that might vanish are among those that are looked at."""
    bases = (factor.as_base_exp()[0] for variant in variants for factor in sp.Mul.make_args(variant))
    return all(_varies(base) or base.is_nonzero for base in bases)


def is_thin(f: Expr, domain: Domain) -> bool | None:
    """Tell whether f = 0 has no inner points on the domain; None where f vanishes on all of it.

    An analytic function on a connected set that is not zero at one point vanishes on a thin set. One with square roots
    divides the product of its conjugates, which has none: at one point all of these must be different from zero.
    """
    deadline = time.monotonic() + SECONDS
    try:
        conjugates = _conjugates(f)
        if conjugates and _is_analytic_but_for_roots(f, domain):
            points = domain.points(anatomy([f]).symbols, POINTS, deadline=deadline, but_functions=True)
            if any(all(_nonzero_at(g, point, domain, deadline) for g in conjugates) for point in points):
                return True
        return None if prove_zero(f, domain, deadline, QUICK).holds else False
    except (*REFUSALS, NoValue):
        return False


def _roots(f: Expr) -> list[sp.Pow]:
    """Return the square roots in a function, outer ones before those inside them."""
    found = anatomy([f]).of(sp.Pow)[::-1]
    return [e for e in found if e.free_symbols and isinstance(e.exp, sp.Rational) and e.exp.q == 2]


def _conjugates(f: Expr) -> list[Expr]:
    """Return a function with each choice of signs of its square roots; none where there are too many."""
    found = [f]
    for root in _roots(f):
        if 2 * len(found) > MOST_VARIANTS:
            return []
        sign = sp.Dummy()
        marked = [replaced(g, {root: sign * root}) for g in found]
        found = [replaced(g, {sign: sp.Integer(s)}) for g in marked for s in (1, -1)]
    return found


def _is_analytic_but_for_roots(f: Expr, domain: Domain) -> bool:
    roots = _roots(f)
    signs: dict[sp.Basic, Expr] = {root: sp.Dummy(complex=True) for root in roots}
    return is_analytic([replaced(f, signs), *(replaced(root.base, signs) for root in roots)], domain)


def _nonzero_at(f: Expr, point: dict[Symbol, sp.Rational], domain: Domain, deadline: float) -> bool:
    search = look_for_counterexample(
        f, sp.Integer(0), [point], highest=BITS, deadline=deadline, conditions=domain.on_functions
    )
    return search.counterexample is not None
