"""Solving equations for variables on the branch that a given point shows.

Every step peels one operation; where several inverses exist, the one that gives the true value at the
witness is taken, and what it takes for granted is noted as a condition (cos y = x gives y = acos x where
0 < y < π). Whoever uses the result proves it on the domain narrowed by those conditions.
"""

from __future__ import annotations

import math
import time as clock
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.linear import SingularMatrixError, solve
from canon.mechanics.algebra.single_equation import generator_values
from canon.mechanics.algebra.substitution import entry, exchanged, size, substitute
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.mechanics.algebra.branch_point import BranchPoint

__all__ = ["Inversion", "isolate", "solve_system"]

_LARGEST = 200
"""Nodes of an equation above which it is not treated as a polynomial in a generator."""
_HALF = sp.pi / 2


def _asin(y: Expr) -> list[tuple[Expr, Expr, Expr]]:
    return [(sp.asin(y), -_HALF, _HALF), (sp.pi - sp.asin(y), _HALF, 3 * _HALF)]


def _acos(y: Expr) -> list[tuple[Expr, Expr, Expr]]:
    return [(sp.acos(y), sp.S.Zero, sp.pi), (-sp.acos(y), -sp.pi, sp.S.Zero)]


def _atan(y: Expr) -> list[tuple[Expr, Expr, Expr]]:
    return [(sp.atan(y), -_HALF, _HALF)]


def _acot(y: Expr) -> list[tuple[Expr, Expr, Expr]]:
    return [(sp.acot(y), -_HALF, _HALF)]


_PERIODIC: dict[Any, tuple[Callable[[Expr], list[tuple[Expr, Expr, Expr]]], Expr]] = {
    sp.sin: (_asin, 2 * sp.pi),
    sp.cos: (_acos, 2 * sp.pi),
    sp.tan: (_atan, sp.pi),
    sp.cot: (_acot, sp.pi),
}
"""Inverses with the open interval of values on which each is the inverse, and the period."""
_INVERSES: dict[Any, Callable[[Expr], Expr]] = {
    sp.exp: sp.log,
    sp.log: sp.exp,
    sp.sinh: sp.asinh,
    sp.tanh: sp.atanh,
    sp.asin: sp.sin,
    sp.acos: sp.cos,
    sp.atan: sp.tan,
    sp.acot: sp.cot,
    sp.asinh: sp.sinh,
    sp.acosh: sp.cosh,
    sp.atanh: sp.tanh,
}


class UnstatableError(Exception):
    """What tells a branch from its neighbour is too long to be stated, or not to be seen at the witness."""


@dataclass
class Inversion:
    """An inversion under way.

    Parameters
    ----------
    witness
        The point that chooses branches.
    conditions
        What the branch takes for granted, in the old variables, noted on the way.
    known
        Values found on the way for expressions that hold the unknowns, such as √q before q.
    deadline
        When to give up, on the monotonic clock; equations too large for one step are not begun.
    """

    witness: BranchPoint
    conditions: list[Boolean] = field(default_factory=list)
    known: dict[Expr, Expr] = field(default_factory=dict)
    deadline: float = math.inf

    def choose(self, inner: Expr, candidates: Sequence[Expr], x: Symbol) -> Expr | None:
        """Take the candidate that is right at the witness; of ± pairs, note the sign of ``inner``."""
        for candidate in candidates:
            if self.witness.agree(inner, candidate):
                if len(candidates) > 1:
                    self.note_sign(inner)
                return isolate(inner, candidate, x, self)
        return None

    def note_sign(self, f: Expr) -> None:
        """Note that f keeps the sign it has at the witness, in the old variables, as simply as possible."""
        positive = self._is_positive_at_witness(f)
        f = substitute(f, self.witness.meaning)
        remaining: list[Expr] = []
        numerator, denominator = sp.fraction(sp.together(f))
        for factor in sp.Mul.make_args(sp.factor_terms(numerator * denominator)):
            base, exponent = factor.as_base_exp()
            if factor.is_negative:
                positive = not positive
            elif exponent.is_Integer and exponent % 2 == 1 and not base.is_positive:
                remaining.append(base)
            elif not factor.is_positive:
                remaining.append(factor)
        if remaining:
            self._note(sp.Gt(sp.Mul(*remaining), 0) if positive else sp.Lt(sp.Mul(*remaining), 0))

    def _is_positive_at_witness(self, f: Expr) -> bool:
        """Tell the sign of f there; a witness where f vanishes lies on both branches and shows none."""
        ball = self.witness.value(f)
        if ball is None or ball.real.contains(0) or not ball.imag.contains(0):
            raise UnstatableError
        return bool(ball.real > 0)

    def note_between(self, low: Expr, f: Expr, high: Expr) -> None:
        """Note that low < f < high, in the old variables."""
        f = substitute(f, self.witness.meaning)
        self._note(sp.Gt(f, low))
        self._note(sp.Lt(f, high))

    def _note(self, condition: Boolean) -> None:
        if size(condition) > _LARGEST:
            raise UnstatableError
        if condition not in (sp.true, sp.false) and condition not in self.conditions:
            self.conditions.append(condition)


def solve_system(
    equations: Sequence[tuple[Expr, Expr]], unknowns: Sequence[Symbol], inversion: Inversion
) -> dict[Symbol, Expr] | None:
    """Solve lhs = rhs for all unknowns, on the witness's branch.

    Parameters
    ----------
    equations
        As many as unknowns; the right-hand sides hold no unknowns.
    unknowns
        What to solve for.
    inversion
        Holds the witness; the conditions of the branch are noted in it.

    Returns
    -------
    dict or None
        Each unknown as an expression without unknowns; None where the peeling got stuck.
    """
    if not unknowns:
        return {}
    linear = _linear(equations, unknowns)
    if linear is not None:
        return linear
    pairs = [(lhs, rhs, x) for lhs, rhs in equations for x in unknowns if lhs.has(x)]
    pairs.sort(key=lambda pair: (len(pair[0].free_symbols & set(unknowns)), size(pair[0])))
    for lhs, rhs, x in pairs:
        if clock.monotonic() > inversion.deadline:
            return None
        before = len(inversion.conditions)
        found = _on_statable_branch(lhs, rhs, x, inversion)
        if found is None or found.has(x) or not inversion.witness.agree(found, x):
            del inversion.conditions[before:]
            continue
        others = [y for y in unknowns if y != x]
        rest = [
            _sorted_sides(substitute(a, {x: found}) - b, others) for a, b in equations if (a, b) != (lhs, rhs)
        ]
        solved = solve_system(rest, others, inversion)
        if solved is not None:
            return {**solved, x: substitute(found, solved)}
        del inversion.conditions[before:]
    return None


def _on_statable_branch(lhs: Expr, rhs: Expr, x: Symbol, inversion: Inversion) -> Expr | None:
    try:
        return isolate(lhs, rhs, x, inversion)
    except UnstatableError:
        return None


def isolate(lhs: Expr, rhs: Expr, x: Symbol, inversion: Inversion) -> Expr | None:
    """Solve lhs(x) = rhs for x on the witness's branch; None where that is not possible by peeling.

    Examples
    --------
    >>> from sympy import symbols, cos
    >>> from canon.mechanics.algebra.branch_point import BranchPoint
    >>> x, y = symbols("x y", real=True)
    >>> inversion = Inversion(BranchPoint({x: sp.Integer(4)}, {y: cos(x)}))
    >>> isolate(cos(x), y, x, inversion), inversion.conditions
    (-acos(y) + 2*pi, [x > pi, x < 2*pi])
    """
    if lhs == x:
        return rhs
    inversion.known[lhs] = rhs
    if lhs.is_Add or lhs.is_Mul:
        return _of_sum_or_product(lhs, rhs, x, inversion)
    if lhs.is_Pow:
        return _of_power(lhs, rhs, x, inversion)
    if lhs.func == sp.atan2:
        y, adjacent = lhs.args
        return isolate(cast("Expr", y) / cast("Expr", adjacent), sp.tan(rhs), x, inversion)
    if len(lhs.args) != 1:
        return None
    inner = cast("Expr", lhs.args[0])
    if lhs.func in _PERIODIC:
        return _of_periodic(lhs, inner, rhs, x, inversion)
    if lhs.func in _INVERSES:
        return inversion.choose(inner, [_INVERSES[lhs.func](rhs)], x)
    if lhs.func == sp.cosh:
        return inversion.choose(inner, [sp.acosh(rhs), -sp.acosh(rhs)], x)
    if lhs.func == sp.Abs:
        return inversion.choose(inner, [rhs, -rhs], x)
    return None


def _of_sum_or_product(lhs: Expr, rhs: Expr, x: Symbol, inversion: Inversion) -> Expr | None:
    free, bound = lhs.as_independent(x, as_Add=lhs.is_Add)
    if free != (0 if lhs.is_Add else 1):
        return isolate(bound, rhs - free if lhs.is_Add else rhs / free, x, inversion)
    if size(lhs - rhs) > _LARGEST:
        return None
    for kernel, value, signs in generator_values(lhs - rhs, x):
        if inversion.witness.agree(value, kernel):
            for sign in signs:
                inversion.note_sign(sign)
            return isolate(kernel, value, x, inversion)
    return None


def _of_periodic(lhs: Expr, inner: Expr, rhs: Expr, x: Symbol, inversion: Inversion) -> Expr | None:
    inverses, period = _PERIODIC[lhs.func]
    for candidate, low, high in inverses(rhs):
        turns = inversion.witness.nearest_multiple(inner - candidate, period)
        if turns is not None:
            inversion.note_between(low + turns * period, inner, high + turns * period)
            return isolate(inner, candidate + turns * period, x, inversion)
    return None


def _of_power(lhs: Expr, rhs: Expr, x: Symbol, inversion: Inversion) -> Expr | None:
    base, exponent = lhs.as_base_exp()
    if not base.has(x):
        return isolate(exponent, sp.log(rhs) / sp.log(base), x, inversion)
    if exponent.has(x):
        return None
    if not isinstance(exponent, sp.Rational):
        return inversion.choose(base, [rhs ** (1 / exponent)], x)
    root = sp.Pow(rhs, 1 / exponent)
    if exponent.p % 2 == 0:
        return inversion.choose(base, [root, -root], x)
    if abs(exponent.p) == 1 or base.is_positive:
        return inversion.choose(base, [root], x)
    return inversion.choose(base, [root, -sp.Pow(-rhs, 1 / exponent)], x)


def _linear(equations: Sequence[tuple[Expr, Expr]], unknowns: Sequence[Symbol]) -> dict[Symbol, Expr] | None:
    """Solve by elimination where every equation is linear in all unknowns together."""
    matrix = sp.Matrix([[lhs.diff(x) for x in unknowns] for lhs, _ in equations])
    if matrix.has(*unknowns):
        return None
    at_zero = dict.fromkeys(unknowns, sp.S.Zero)
    right = sp.Matrix([rhs - exchanged(lhs, at_zero) for lhs, rhs in equations])
    try:
        column = solve(matrix, right)
    except (SingularMatrixError, Undecided):
        return None
    return {x: entry(column, i, 0) for i, x in enumerate(unknowns)}


def _sorted_sides(difference: Expr, unknowns: Sequence[Symbol]) -> tuple[Expr, Expr]:
    free, bound = difference.as_independent(*unknowns, as_Add=True)
    return bound, -free
