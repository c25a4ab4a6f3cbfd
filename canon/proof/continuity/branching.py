"""Branch points: surfaces across which roots, logarithms and what is taken of poles may hide a jump.

Near a surface g = 0 each root or logarithm of c gᵐ, c ≠ 0, is the boundary value of one function that is analytic where
Im g > 0, if c > 0, and where Im g < 0, if c < 0. Where all of them in an expression are of one kind, so is the whole,
and limits from both sides are then equal (E. Lindelöf, Acta Soc. Sci. Fenn. 46 (1915) no. 4: an analytic function
bounded in a sector has one limit along both sides; with limits on both sides, what grows there no faster than a power
is bounded). A sum of terms of which each is a composition of continuous
functions, no denominator vanishing on the surface, is continuous too. What is neither may be as sqrt(-q)/(I*sqrt(q)),
which is the sign of q. A function of what has a pole, as tanh(1/x), may have any two limits.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.function import AppliedUndef

from canon.proof.analytic import proved_sign
from canon.proof.domain.declarations import declared_complex
from canon.proof.domain.domain import Domain
from canon.proof.domain.reality import certainly_real
from canon.proof.rungs.ladder import is_empty
from canon.proof.trees.affine_form import is_affine
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.polynomial import polynomial_factors
from canon.proof.trees.sympy_types import arguments, by_name, free_symbols
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

__all__ = ["Branch", "OpenSurface", "open_surfaces"]

SECONDS = 0.5
"""Time for the question whether a surface lies in the domain."""

LARGE = 400
"""Size of a radicand that is still factored."""

BOUNDED = (sp.atan, sp.acot, sp.atan2, sp.tanh, sp.sign, sp.Heaviside)
"""Functions without poles on the real line, of whatever they are taken."""

PIECES = (sp.Abs, sp.Max, sp.Min, sp.Piecewise, *BOUNDED)


@dataclass(frozen=True)
class Branch:
    """A part of an expression that has a branch point where ``gap`` vanishes.

    Parameters
    ----------
    part
        The root, logarithm or other function.
    gap, count, cofactor
        What it branches by is gap**count · cofactor.
    bounded
        Whether the part is continuous where the gap vanishes.
    """

    part: Expr
    gap: Expr
    count: int
    cofactor: Expr
    bounded: bool


@dataclass(frozen=True)
class OpenSurface:
    """A surface across which a function was not proved to be continuous, and the parts that branch there."""

    gap: Expr
    branches: tuple[Branch, ...] = ()


@dataclass
class _Pool:
    """What branches at one surface in terms that are not bounded there."""

    branches: dict[tuple[Expr, Expr], Branch] = field(default_factory=dict["tuple[Expr, Expr]", "Branch"])


def open_surfaces(f: Expr, moving: Sequence[Symbol], domain: Domain) -> list[OpenSurface]:
    """Return the surfaces across which branches and poles inside functions leave the continuity of f open.

    Examples
    --------
    >>> from canon.proof.domain.domain import Domain
    >>> q = sp.Symbol("q", real=True)
    >>> [s.gap for s in open_surfaces(sp.sqrt(-q) / sp.sqrt(q) + sp.tanh(1 / (q - 1)), [q], Domain())]
    [q, q - 1]
    >>> open_surfaces(q * sp.sqrt(1 - q**2) + sp.asin(q) + sp.log(q) * sp.sqrt(q), [q], Domain())
    []
    """
    if any(map(declared_complex, free_symbols(f))):
        return []
    terms = [t for t in sp.Add.make_args(f) if t.has(*moving)]
    pools: dict[Expr, _Pool] = {}
    for term in terms:
        found = list(_branches(term, moving))
        for branch in found:
            pool = pools.setdefault(branch.gap, _Pool())
            here = [b for b in found if b.gap == branch.gap]
            if not all(b.bounded for b in here) or _is_divided_by(term, branch.gap, [b.part for b in here]):
                pool.branches[branch.part, branch.cofactor] = branch
    mixed = [
        OpenSurface(gap, tuple(pool.branches.values()))
        for gap, pool in pools.items()
        if not _is_of_one_kind(list(pool.branches.values()), domain) and not _keeps_away(gap, domain)
    ]
    at_poles = [*_whole_numbers(terms, moving), *_poles_inside(terms, moving, domain)]
    inside = [OpenSurface(gap) for gap in at_poles if not _keeps_away(gap, domain)]
    known = {surface.gap for surface in mixed}
    return [*mixed, *(surface for surface in inside if surface.gap not in known)]


def _keeps_away(gap: Expr, domain: Domain) -> bool:
    """Tell whether a gap is proved not to change its sign: it vanishes nowhere on the domain, or is touched only."""
    if proved_sign(gap, domain) != "":
        return True
    on_surface = (*domain.conditions, cast("Boolean", sp.Eq(gap, 0, evaluate=False)))
    return bool(domain.conditions) and is_empty(Domain(on_surface), time.monotonic() + SECONDS)


def _is_of_one_kind(branches: Sequence[Branch], domain: Domain) -> bool:
    """Tell whether what a surface branches by has everywhere on it one sign in all parts, compared with one another."""
    if len(branches) <= 1:
        return True
    first, *others = branches
    if any(b.count % 2 == 0 for b in branches):
        return False
    for b in others:
        ratio = _on_surface(cast("Expr", sp.cancel(b.cofactor / first.cofactor)), first.gap)
        if not ratio.is_positive and proved_sign(ratio, domain) != "+":
            return False
    return True


def _on_surface(f: Expr, gap: Expr) -> Expr:
    """Return a function with the value of a symbol put in that the surface gives to it, if it is affine in one."""
    for s in by_name(gap):
        slope = gap.diff(s)
        if slope.is_number and slope.is_nonzero and is_affine(gap, [s]):
            there = {s: sp.expand(s - gap / slope)}
            return cast("Expr", f.xreplace(there))
    return f


# -- branches ------------------------------------------------------------------------------------------


def _branches(term: Expr, moving: Sequence[Symbol]) -> Iterator[Branch]:
    for part in anatomy([term]).parts:
        if isinstance(part, sp.Expr) and part.has(*moving):
            for base, bounded in _bases(part):
                found = _zeros_and_poles(base, moving)
                yield from (
                    _branch(part, base, gap, count, bounded)
                    for gap, count in found
                    if _branches_by(part, gap, count)
                )


def _branches_by(part: Expr, gap: Expr, count: int) -> bool:
    """Tell whether a factor makes a branch point; a root of one that it has twice is a modulus, which has a cut."""
    return count % 2 == 1 or not (isinstance(part, sp.Pow) and certainly_real(gap))


def _branch(part: Expr, base: Expr, gap: Expr, count: int, bounded: bool) -> Branch:
    cofactor = cast("Expr", sp.cancel(base / gap**count)) if gap != base else sp.S.One
    return Branch(part, gap, count, cofactor, bounded and count > 0)


def _bases(part: Expr) -> Iterator[tuple[Expr, bool]]:
    """Yield what a function branches by where that vanishes or is infinite, and whether it is continuous at zeros."""
    match part:
        case sp.Pow() if part.exp.is_integer is not True and not part.base.is_positive:
            yield part.base, part.exp.is_positive is True
        case sp.log() if len(part.args) == 1:
            yield arguments(part)[0], False
        case sp.asin() | sp.acos():
            yield 1 - arguments(part)[0] ** 2, True
        case sp.asec() | sp.acsc():
            yield 1 - 1 / arguments(part)[0] ** 2, True
        case sp.acosh():
            yield from ((arguments(part)[0] + sign, True) for sign in (1, -1))
        case sp.asech():
            yield from ((1 / arguments(part)[0] + sign, True) for sign in (1, -1))
        case sp.atanh():
            yield from ((1 + sign * arguments(part)[0], False) for sign in (1, -1))
        case sp.acoth():
            yield from ((1 + sign / arguments(part)[0], False) for sign in (1, -1))
        case sp.asinh():
            yield 1 + arguments(part)[0] ** 2, True
        case sp.acsch():
            yield 1 + 1 / arguments(part)[0] ** 2, True
        case sp.atan() | sp.acot() if not certainly_real(arguments(part)[0]):
            yield 1 + arguments(part)[0] ** 2, False
        case sp.elliptic_k() | sp.elliptic_e() if len(part.args) == 1:
            yield 1 - arguments(part)[0], False
        case _:
            pass


def _zeros_and_poles(base: Expr, moving: Sequence[Symbol]) -> Iterator[tuple[Expr, int]]:
    """Yield the factors of a fraction that hold what varies, those of its denominator counted below zero."""
    if anatomy([base]).tree > LARGE:
        yield base, 1
        return
    for fraction, sign in ((base, 1), (1 / base, -1)):
        for factor, count in polynomial_factors(fraction):
            if factor.has(*moving) and not (factor.is_positive or factor.is_negative):
                yield factor, sign * count


def _is_divided_by(term: Expr, gap: Expr, parts: Sequence[Expr]) -> bool:
    """Tell whether a denominator in a term may vanish where the gap does: it has it as a factor, or holds the parts."""
    found = anatomy([term])
    below: list[Expr] = [e.base for e in found.of(sp.Pow) if not e.exp.is_nonnegative and e not in parts]
    below += [sp.cos(e.args[0]) for e in found.of(sp.tan, sp.sec)]
    below += [sp.sin(e.args[0]) for e in found.of(sp.cot, sp.csc)]
    for base in below:
        if base.has(*parts) or any(
            sp.expand(g - s * gap) == 0 for g, _ in polynomial_factors(base) for s in (1, -1)
        ):
            return True
    return False


# -- poles inside functions ----------------------------------------------------------------------------


def _whole_numbers(terms: Sequence[Expr], moving: Sequence[Symbol]) -> list[Expr]:
    """Return what vanishes where the argument of floor, ceiling, frac or Mod is a whole number or a multiple."""
    steps = (sp.floor, sp.ceiling, sp.frac, sp.Mod)
    found = {part for term in terms for part in term.atoms(*steps) if part.has(*moving)}
    inside = (arguments(part) for part in sorted(found, key=sp.default_sort_key))
    return [sp.sin(sp.pi * sp.Mul(u, *(1 / m for m in rest))) for u, *rest in inside]


def _poles_inside(terms: Sequence[Expr], moving: Sequence[Symbol], domain: Domain) -> list[Expr]:
    """Return where functions in some terms are taken of poles across which what they are taken of changes its sign.

    One exponential that is a factor of all these terms is zero or infinite on either side, whatever else they hold.
    """
    found: dict[Expr, list[tuple[Expr, Expr]]] = {}
    for term in terms:
        for part in anatomy([term]).parts:
            if isinstance(part, sp.Expr) and part.has(*moving):
                for gap in _poles_of_arguments(part, moving, domain):
                    found.setdefault(gap, []).append((part, term))
    return [gap for gap, uses in found.items() if not _is_common_exponential(uses)]


def _is_common_exponential(uses: Sequence[tuple[Expr, Expr]]) -> bool:
    parts = {part for part, _ in uses}
    if len(parts) != 1:
        return False
    (part,) = parts
    if not isinstance(part, sp.exp) or not certainly_real(arguments(part)[0]):
        return False
    factors = ([f for f in sp.Mul.make_args(term) if f.has(part)] for _, term in uses)
    return all(len(holding) == 1 and holding[0].as_base_exp()[0] in (part, sp.E) for holding in factors)


def _poles_of_arguments(part: Expr, moving: Sequence[Symbol], domain: Domain) -> Iterator[Expr]:
    given: tuple[Expr, ...] = ()
    if isinstance(part, sp.Pow) and part.exp.has(*moving):
        given = (part.exp,)
    elif isinstance(part, sp.tanh) or (
        isinstance(part, sp.Function | AppliedUndef)
        and not isinstance(part, PIECES)
        and not any(_bases(part))
    ):
        given = arguments(part)
    for a in given:
        if any(_poles(a, moving)) and not _cancel(a, moving, domain):
            yield from _poles(cast("Expr", sp.cancel(a)) if anatomy([a]).tree <= LARGE else a, moving)


def _cancel(a: Expr, moving: Sequence[Symbol], domain: Domain) -> bool:
    """Tell whether the terms of a sum that have poles are together proved to be zero, as tan x − sin x/cos x is."""
    terms = [term for term in sp.Add.make_args(a) if any(_poles(term, moving))]
    return len(terms) > 1 and vanishes(sp.Add(*terms), domain, SECONDS).holds


def _poles(u: Expr, moving: Sequence[Symbol]) -> Iterator[Expr]:
    """Yield the factors by which an expression is divided an odd number of times."""
    if not u.has(*moving):
        return
    below: Expr | None = None
    match u:
        case sp.Pow() if u.exp.is_negative:
            below = u.base ** (-u.exp)
        case sp.tan() | sp.sec():
            below = sp.cos(arguments(u)[0])
        case sp.cot() | sp.csc():
            below = sp.sin(arguments(u)[0])
        case sp.sin() | sp.cos() if certainly_real(arguments(u)[0]):
            return
        case _ if isinstance(u, BOUNDED):
            return
        case sp.Add() | sp.Mul() | sp.Pow() | sp.Function():
            for a in arguments(u):
                yield from _poles(a, moving)
        case _:
            return
    if below is not None:
        for factor, count in polynomial_factors(below):
            if count % 2 and factor.has(*moving) and not (factor.is_positive or factor.is_negative):
                yield factor
