"""Where expressions are real: what their roots, logarithms and arcs ask for, and expressions that are real nowhere."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.analytic import is_analytic, proved_sign
from canon.proof.domain.domain import Domain
from canon.proof.rungs.ladder import is_empty
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from sympy import Expr
    from sympy.logic.boolalg import Boolean

__all__ = ["is_nowhere_real", "real_bounds"]

LONGEST = 500
"""Operations of an expression whose imaginary part is still worked out."""
SECONDS = 0.5
"""Time for the proof that a radicand is negative."""

_INSIDE_ONE = (sp.asin, sp.acos, sp.atanh)
_BEYOND_ONE = (sp.asec, sp.acsc, sp.acoth)


def real_bounds(functions: Iterable[Expr], domain: Domain) -> list[Boolean]:
    """Return conditions under which roots, logarithms and arcs are real, where they are not known to be.

    Functions may be real elsewhere too, as √(−a)² is: these are conditions under which they are looked at.

    Examples
    --------
    >>> t = sp.Symbol("t", real=True)
    >>> real_bounds([sp.sqrt(t - 5) + sp.asin(t / 6)], Domain())
    [t - 5 > 0, 1 - t**2/36 > 0]
    """
    kinds = (sp.Pow, sp.log, sp.acosh, *_INSIDE_ONE, *_BEYOND_ONE)
    parts = sorted({part for f in functions for part in f.atoms(*kinds)}, key=sp.default_sort_key)
    asked = dict.fromkeys(gap for part in parts for gap in _must_be_positive(part))
    open_ = [gap for gap in asked if gap.is_extended_real and not proved_sign(gap, domain).endswith("+")]
    return [bound for gap in open_ if (bound := sp.Gt(gap, 0)) not in (sp.true, sp.false)]


def _must_be_positive(part: Expr) -> Iterator[Expr]:
    """Yield what is positive where a function is real, the ends left out."""
    if isinstance(part, sp.Pow):
        if not part.exp.is_integer:
            yield part.base
        return
    inside = arguments(part)[0]
    if isinstance(part, sp.log):
        yield inside
    elif isinstance(part, sp.acosh):
        yield inside - 1
    else:
        yield 1 - inside**2 if isinstance(part, _INSIDE_ONE) else inside**2 - 1


def is_nowhere_real(f: Expr, domain: Domain) -> bool:
    """Tell whether it is proved of a function, which is not real at one point of the domain, that it is almost nowhere.

    Roots and logarithms of what is proved negative are written with i, √−r = i √r and log(−r) = log r + i π for r > 0.
    All else is real then, and so are both parts. An imaginary part of one sign vanishes nowhere; one that is analytic
    on a connected set that holds the domain, and not zero at one point, vanishes almost nowhere.

    Examples
    --------
    >>> t = sp.Symbol("t", real=True)
    >>> is_nowhere_real(t + sp.sqrt(-1 - t**2), Domain()), is_nowhere_real(sp.sqrt(t - 1000), Domain())
    (True, False)
    """
    if sp.count_ops(f) > LONGEST:
        return False
    bases = {part: gap for part in f.atoms(sp.Pow, sp.log) for gap in _must_be_positive(part)}
    open_ = {part: gap for part, gap in bases.items() if not proved_sign(gap, domain).endswith("+")}
    if not all(gap.is_extended_real and _is_negative(gap, domain) for gap in open_.values()):
        return False
    written = cast("Expr", f.xreplace({part: _with_i(part) for part in open_}))
    above = written.as_real_imag()[1]
    if above.has(sp.im, sp.re, sp.arg, sp.conjugate) or above.has(sp.I):
        return False
    return proved_sign(above, domain) in ("+", "-") or (above != 0 and is_analytic([above], domain))


def _is_negative(f: Expr, domain: Domain) -> bool:
    """Whether a function is negative but for thin zeros: those of an analytic one that is negative somewhere."""
    sign = proved_sign(f, domain)
    if sign.endswith("-"):
        return sign == "-" or (f != 0 and is_analytic([f], domain))
    elsewhere = Domain((*domain.conditions, cast("Boolean", sp.Ge(f, 0))), domain.box)
    return is_empty(elsewhere, time.monotonic() + SECONDS)


def _with_i(part: Expr) -> Expr:
    """Return a power or logarithm of what is negative, written with i."""
    if isinstance(part, sp.log):
        return sp.log(-arguments(part)[0]) + sp.I * sp.pi
    base, exponent = arguments(part)
    return (-base) ** exponent * (sp.cos(sp.pi * exponent) + sp.I * sp.sin(sp.pi * exponent))
