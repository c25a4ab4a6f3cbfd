"""Zeros that fill a piece: whether a function with pieces vanishes on an open part of a domain, or on none.

One point where it is not zero is not enough for such a function: x + |x| is zero for all x < 0.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.relational import Relational

from canon.proof.analytic import proved_sign
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.domain import Domain
from canon.proof.domain.limits import QUICK
from canon.proof.kinks import WITH_PIECES, is_thin, variants_of
from canon.proof.rungs.cases import cases
from canon.proof.rungs.ladder import REFUSALS, is_empty, prove_zero
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.polynomial import polynomial_factors
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sympy import Expr
    from sympy.logic.boolalg import Boolean

__all__ = ["has_hidden_pieces", "zero_piece"]

MOST_PIECES = 24
BITS = 128


def zero_piece(f: Expr, domain: Domain, budget: float = 1.0) -> str | None:
    """Return an open part of the domain on which f is proved to vanish, "" where it has none, None where that is open.

    There is none where f is proved to have one sign, or where each of its factors, with every choice of pieces and of
    the signs of its roots, is analytic on a connected set that holds the domain and not zero at a point: near every
    point off the kinks f is one of these choices. The same may be shown of f on each of the open parts that its kinks
    leave.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> zero_piece(x + abs(x), Domain()), zero_piece(x + abs(x), Domain((x > 0,))), zero_piece(x + 2 * abs(x), Domain())
    ('x < 0', '', '')
    """
    deadline = time.monotonic() + budget
    if all(_vanishes_thinly(factor, domain) for factor in _factors(f)):
        return ""
    found = _pieces(f, domain, deadline)
    for part, where in found or ():
        if prove_zero(part, where, deadline, QUICK).holds and _is_met(part, where):
            said = [c for c in where.conditions if c not in domain.conditions]
            return ", ".join(map(str, said)) or "everywhere"
    if found and all(_vanishes_thinly(part, where) or is_empty(where, deadline) for part, where in found):
        return ""
    return None


def has_hidden_pieces(f: Expr, domain: Domain) -> bool:
    """Tell whether a root may be taken of what has a double pole, or an arc of what has a pole: these step as signs do.

    A root of what changes its sign at a pole is real on one side only.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> [has_hidden_pieces(g, Domain()) for g in (x * sp.sqrt(1 + 1 / x**2), sp.sqrt(1 + 1 / x), sp.sqrt(1 + x**2) / x)]
    [True, False, False]
    """
    found = anatomy([f])
    if not any(e.exp.is_negative and not e.base.is_number for e in found.of(sp.Pow)):
        return False
    roots = [p.base for p in found.of(sp.Pow) if p.exp.is_integer is not True]
    arcs = [arguments(arc)[0] for arc in found.of(sp.atan, sp.acot)]
    below = [(g, count) for base in roots for g, count in polynomial_factors(1 / base) if count % 2 == 0]
    below += [pole for u in arcs for pole in polynomial_factors(1 / u)]
    return not all(g.is_positive or g.is_negative or proved_sign(g, domain) in ("+", "-") for g, _ in below)


def _factors(f: Expr) -> Iterator[Expr]:
    """Yield the factors of a product, |g| and sign(g) as g, which vanishes where they do and nowhere else."""
    for factor in sp.Mul.make_args(f):
        base, exponent = factor.as_base_exp()
        if not (exponent.is_negative and exponent.is_number):
            yield arguments(base)[0] if isinstance(base, sp.Abs | sp.sign) else base


def _vanishes_thinly(f: Expr, domain: Domain) -> bool:
    if f.is_nonzero or proved_sign(f, domain) in ("+", "-"):
        return True
    variants = variants_of(f) if anatomy([f]).has(*WITH_PIECES) else [f]
    return variants is not None and all(g.is_nonzero or is_thin(g, domain) is True for g in variants)


def _pieces(f: Expr, domain: Domain, deadline: float) -> list[tuple[Expr, Domain]] | None:
    """Return the open parts that cover a domain but for thin sets, and what a function is on each, without pieces.

    Parts where it has no value are left out. None where not all of them are known.
    """
    done: list[tuple[Expr, Domain]] = []
    left: list[tuple[Expr, Domain]] = [(f, domain)]
    for _ in range(MOST_PIECES):
        if not left:
            return done
        part, where = left.pop()
        if not part.has(*WITH_PIECES):
            done.append((part, where))
            continue
        try:
            found = cases(part, where) if time.monotonic() < deadline else None
        except REFUSALS:
            found = None
        if found is None or any(_is_bound_otherwise(c) for case in found for c in case.domain.conditions):
            return None
        for case in found:
            inner = _open(case.domain)
            if case.expr is not None and inner is not None:
                left.append((case.expr, inner))
    return None


def _is_bound_otherwise(condition: sp.Basic) -> bool:
    return not isinstance(condition, Relational) and condition not in (sp.true, sp.false)


def _open(domain: Domain) -> Domain | None:
    """Return the inner points of a domain that inequalities bound; None where it has none."""
    if any(isinstance(c, sp.Eq) for c in domain.conditions):
        return None
    conditions = (sp.Gt(c.gts, c.lts) if isinstance(c, sp.Ge | sp.Le) else c for c in domain.conditions)
    kept = tuple(cast("Boolean", c) for c in conditions if c != sp.true)
    return None if sp.false in kept else Domain(kept, domain.box)


def _is_met(f: Expr, domain: Domain) -> bool:
    """Tell whether a point of the domain was found at which f has a value."""
    for point in domain.points(anatomy([f]).symbols, 1):
        with precision(BITS):
            try:
                value(f, point)
            except (NotDecided, Undefined, Unmodelled):
                return False
        return True
    return False
