"""Ladder of proofs: the proving rungs one after another, then cases where none of them decides."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

from sympy import Add, Integer, LambertW, Ne, Piecewise, Pow, default_sort_key, false, true
from sympy.concrete.expr_with_limits import ExprWithLimits
from sympy.functions.elementary.hyperbolic import InverseHyperbolicFunction
from sympy.functions.elementary.trigonometric import InverseTrigonometricFunction

from canon.proof.domain.domain import Domain
from canon.proof.domain.limits import QUICK, THOROUGH, Full, Limits, OutOfTime, Refine, TooLarge
from canon.proof.functions.normal_form import NormalForm
from canon.proof.rungs.cases import cases, settle_equalities
from canon.proof.rungs.conjugates import radicals_cancel
from canon.proof.rungs.groups import groups
from canon.proof.rungs.phases import arcs_cancel
from canon.proof.trees.anatomy import Anatomy, anatomy
from canon.proof.trees.bound_variables import with_bound_variables
from canon.proof.trees.replacement import KINKED

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    from sympy import Expr
    from sympy.logic.boolalg import Boolean

__all__ = ["REFUSALS", "Attempt", "is_empty", "prove_each", "prove_zero", "refusal"]

MOST_STARTS = 60
"""Times that the normal form is begun anew because a kernel had to be refined."""

LARGE = 20_000
"""Size of a tree beyond which no cases are tried."""

SIZEABLE = 150
"""Size of a tree from which its groups are tried before the whole."""

GROUPS_SHARE = 0.5
"""Part of the time that the groups may use."""

MOST_CASES = 64
"""Cases into which one claim is cut at most."""


REFUSALS = (ValueError, TypeError, ArithmeticError, NotImplementedError)
"""What SymPy and flint raise for expressions to which they give no meaning."""


@dataclass
class Attempt:
    """What the proving rungs did."""

    holds: bool = False
    rungs: list[str] = field(default_factory=list[str])
    obstacles: list[str] = field(default_factory=list[str])
    cases: int = 1
    capped: bool = False
    large: bool = False

    def reach(self, rung: str) -> None:
        """Note a rung that was needed."""
        if rung not in self.rungs:
            self.rungs.append(rung)

    def stop(self, obstacle: str) -> None:
        """Note why a rung gave no proof."""
        if obstacle not in self.obstacles:
            self.obstacles.append(obstacle)


def prove_zero(expr: Expr, domain: Domain, deadline: float, limits: Limits = THOROUGH) -> Attempt:
    """Try to prove that an expression vanishes wherever it is defined on the domain.

    SymPy refuses some expressions that arise on the way (comparing what is not real, Max of it, …): then
    nothing is proved.
    """
    attempt = Attempt()
    found = anatomy([expr])
    attempt.large = found.tree > LARGE
    try:
        case = settle_equalities(expr, _where_defined(found, domain))
        attempt.holds = (
            case.expr is None
            or _zero_by_groups(case.expr, case.domain, deadline, limits, attempt)
            or _prove(case.expr, case.domain, deadline, limits, attempt)
        )
    except REFUSALS as reason:
        attempt.stop(f"no value could be given to a part: {refusal(reason)}")
    return attempt


def refusal(reason: Exception) -> str:
    """Return in words why SymPy or flint gave no meaning to an expression.

    Examples
    --------
    >>> refusal(OverflowError("int too large to convert to float"))
    'a number is too large to be computed with'
    """
    said = str(reason).strip().partition("\n")[0].rstrip(".")
    if isinstance(reason, OverflowError) or "integer string conversion" in said:
        return "a number is too large to be computed with"
    if isinstance(reason, ZeroDivisionError):
        return "a denominator vanishes"
    return said or "it has no meaning there"


def is_empty(domain: Domain, deadline: float) -> bool:
    """Tell whether it is proved that no point satisfies the conditions: there 1 = 0 holds.

    Examples
    --------
    >>> from sympy import symbols
    >>> x = symbols("x", real=True)
    >>> is_empty(Domain((x < 1, x > 2)), time.monotonic() + 1)
    True
    """
    return prove_zero(Integer(1), domain, min(deadline, time.monotonic() + 0.5), QUICK).holds


def prove_each(
    exprs: Sequence[Expr], domain: Domain, deadline: float, limits: Limits = THOROUGH
) -> list[Attempt]:
    """Try to prove of each expression that it vanishes: over one tower first, then one by one."""
    if len(exprs) == 1:
        return [prove_zero(exprs[0], domain, deadline, limits)]
    reduced = _zero_together(exprs, domain, deadline, limits)
    attempts: list[Attempt] = []
    for expr, zero in zip(exprs, reduced, strict=True):
        if zero:
            attempts.append(Attempt(holds=True, rungs=["exact"]))
        elif time.monotonic() > deadline:
            attempts.append(Attempt(capped=True, obstacles=["not finished in time"]))
        else:
            attempts.append(prove_zero(expr, domain, deadline, limits))
    return attempts


def _zero_together(exprs: Sequence[Expr], domain: Domain, deadline: float, limits: Limits) -> list[bool]:
    """Tell which expressions have the normal form zero, subexpressions being reduced once for all."""
    parts: dict[Hashable, Any] = {}
    capacity = 16
    found = [False] * len(exprs)
    for _ in range(MOST_STARTS):
        try:
            forms = NormalForm(domain, parts, deadline, limits, capacity)
            for place, expr in enumerate(exprs):
                try:
                    found[place] = found[place] or forms.tower.is_zero(forms.form(expr))
                except (TooLarge, *REFUSALS):
                    continue
        except Refine:
            continue
        except Full:
            capacity *= 2
            continue
        except (OutOfTime, TooLarge, *REFUSALS):
            pass
        return found
    return found


def _where_defined(found: Anatomy, domain: Domain) -> Domain:
    """Add that the denominators do not vanish: the claim is about points where the expression is defined."""
    if found.has(Piecewise, ExprWithLimits):
        return domain
    inside = with_bound_variables(found)
    below = {power.base for power in found.of(Pow) if power.exp.is_negative and power not in inside}
    below = {b for b in below if anatomy([b]).tree <= LARGE // 20}
    nonzero = [Ne(b, 0) for b in sorted(below, key=default_sort_key) if b.is_zero is None]
    added = [cast("Boolean", c) for c in nonzero if c not in (true, false)]
    return Domain((*domain.conditions, *added), domain.box)


def _zero_by_groups(expr: Expr, domain: Domain, deadline: float, limits: Limits, attempt: Attempt) -> bool:
    """Tell whether the sum of the terms with the same kernels is zero, kernels by kernels."""
    apart = groups(expr) if isinstance(expr, Add) and anatomy([expr]).tree >= SIZEABLE else None
    if apart is None:
        return False
    now = time.monotonic()
    deadline = now + GROUPS_SHARE * (deadline - now)
    unnoticed = Attempt()
    for group in apart:
        if group != 0 and not _without_cases(group, _about(group, domain), deadline, limits, unnoticed):
            return False
    attempt.reach("groups")
    return True


def _about(expr: Expr, domain: Domain) -> Domain:
    """Return the domain without the conditions on symbols that the expression does not have."""
    symbols = anatomy([expr]).symbols
    return Domain(tuple(c for c in domain.conditions if c.free_symbols <= symbols), domain.box)


def _prove(expr: Expr, domain: Domain, deadline: float, limits: Limits, attempt: Attempt) -> bool:
    if _without_cases(expr, domain, deadline, limits, attempt):
        return True
    if attempt.large or time.monotonic() > deadline:
        return False
    if not limits.killable and _is_slow_to_rebuild(expr):
        attempt.capped = True
        return False
    pieces = cases(expr, domain)
    if pieces is None:
        return False
    attempt.cases += len(pieces) - 1
    if attempt.cases > MOST_CASES:
        attempt.stop(f"more than {MOST_CASES} cases")
        return False
    for piece in pieces:
        if piece.expr is not None and not _prove(piece.expr, piece.domain, deadline, limits, attempt):
            attempt.stop(f"not proved for {piece.where}")
            return False
    attempt.reach("cases")
    return True


def _is_slow_to_rebuild(expr: Expr) -> bool:
    """Tell whether SymPy may look long for a sign when a case is put in; nothing can interrupt it here."""
    found = anatomy([expr])
    return found.has(InverseTrigonometricFunction, InverseHyperbolicFunction, LambertW) and found.has(*KINKED)


def _without_cases(expr: Expr, domain: Domain, deadline: float, limits: Limits, attempt: Attempt) -> bool:
    """Reduce to the normal form, refining kernels until every argument is a whole multiple."""
    parts: dict[Hashable, Any] = {}
    capacity = 16
    for _ in range(MOST_STARTS):
        try:
            forms = NormalForm(domain, parts, deadline, limits, capacity)
            if forms.empty:
                return True
            f = forms.form(expr)
            if forms.tower.is_zero(f):
                attempt.reach("exact")
                return True
            if arcs_cancel(forms, f):
                attempt.reach("exponentiation")
                return True
            if radicals_cancel(forms, f):
                attempt.reach("conjugates")
                return True
            attempt.capped = attempt.capped or forms.tower.capped
            attempt.stop("the normal form is not zero")
        except Refine:
            continue
        except Full:
            capacity *= 2
            continue
        except OutOfTime:
            attempt.capped = True
            attempt.stop("not finished in time")
        except TooLarge as reason:
            attempt.capped = True
            attempt.stop(f"too large: {reason}")
        except ZeroDivisionError as reason:
            attempt.stop(str(reason))
        return False
    attempt.stop("arguments without a common part")
    return False
