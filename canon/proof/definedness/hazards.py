"""What takes the value from an expression: denominators, logarithms and poles, each by what must not vanish."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.function import AppliedUndef

from canon.expression.symbols.jacobi_functions import JACOBI, jacobi_sn
from canon.proof.analytic import ENTIRE
from canon.proof.domain.reality import certainly_real
from canon.proof.trees.replacement import LAZY
from canon.proof.trees.sympy_types import arguments
from canon.proof.trees.worked_out import known

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from sympy import Expr

__all__ = ["Hazard", "branching", "hazards", "incomplete", "unconditional"]


@dataclass(frozen=True)
class Hazard:
    """An argument whose zeros leave a part of an expression without a value.

    Parameters
    ----------
    part
        What has no value where the argument vanishes.
    argument
        What must not vanish.
    said
        The part in words, with a place for the argument.
    """

    part: sp.Basic
    argument: Expr
    said: str

    def __str__(self) -> str:
        return self.said.format(self.argument)


_BELOW = "its denominator {} is zero"
_LOGARITHM = "it takes the logarithm of {}, which is zero"


def hazards(parts: Iterable[sp.Basic]) -> list[Hazard]:
    """Return what must not vanish in the parts of an expression; numbers that are not zero are left out.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> [str(found) for found in hazards([1 / (x + y), sp.log(x), sp.sin(x)])]
    ['its denominator x + y is zero', 'it takes the logarithm of x, which is zero']
    """
    found = (risk for part in parts for risk in _of(part))
    return [risk for risk in found if known("is_zero", risk.argument) is not False]


def _of(part: sp.Basic) -> Iterator[Hazard]:
    if isinstance(part, sp.Pow):
        base, exponent = arguments(part)
        harmless = known("is_nonnegative", exponent)
        if known("is_negative", exponent) or (not harmless and exponent.could_extract_minus_sign()):
            yield Hazard(part, base, _BELOW)
        return
    if not isinstance(part, sp.Function) or isinstance(part, AppliedUndef):
        return
    args = arguments(part)
    match part:
        case sp.log():
            yield from (Hazard(part, u, _LOGARITHM) for u in args[:1])
            yield from (
                Hazard(part, u - 1, "it takes a logarithm to the base 1, as {} is zero") for u in args[1:]
            )
        case sp.tan() | sp.sec():
            yield Hazard(part, sp.cos(args[0]), f"it has the pole of {part.func}, as {{}} is zero")
        case sp.cot() | sp.csc():
            yield Hazard(part, sp.sin(args[0]), f"it has the pole of {part.func}, as {{}} is zero")
        case sp.coth() | sp.csch():
            yield Hazard(part, sp.sinh(args[0]), f"it has the pole of {part.func}, as {{}} is zero")
        case sp.acoth() | sp.asec() | sp.acsc() | sp.asech() | sp.acsch() | sp.arg():
            yield Hazard(part, args[0], f"it takes {part.func} of {{}}, which is zero")
        case sp.atanh():
            yield Hazard(part, 1 - args[0] ** 2, "it takes atanh of ±1, as {} is zero")
        case sp.atan2():
            yield Hazard(part, args[0] ** 2 + args[1] ** 2, "it takes atan2(0, 0), as {} is zero")
        case sp.elliptic_k():
            yield Hazard(part, 1 - args[0], "it has the pole of elliptic_k, as {} is zero")
        case sp.elliptic_pi():
            yield Hazard(part, 1 - args[-1], "it has the pole of elliptic_pi, as {} is zero")
            yield Hazard(part, 1 - args[0], "it has the pole of elliptic_pi, as {} is zero")
        case _ if isinstance(part, JACOBI) and not all(map(certainly_real, args)):
            u, m = args
            from_pole = jacobi_sn(u - sp.I * sp.elliptic_k(1 - m), m)
            yield Hazard(part, from_pole, f"it has the pole of {part.func}, as {{}} is zero")
        case sp.LambertW() if len(args) > 1:
            yield Hazard(part, args[0], "it takes a branch of LambertW of {}, which is zero")
        case _:
            return


def unconditional(expr: sp.Basic) -> set[sp.Basic]:
    """Return the parts without whose value the whole has none: not those of pieces, which need not apply.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> 1 / x in unconditional(1 / x + 1), 1 / x in unconditional(sp.Piecewise((1 / x, x > 0), (0, True)))
    (True, False)
    """
    seen: set[sp.Basic] = set()
    stack = [expr]
    while stack:
        part = stack.pop()
        if part not in seen:
            seen.add(part)
            if not isinstance(part, LAZY):
                stack.extend(part.args)
    return seen


def branching(parts: Sequence[sp.Basic]) -> set[sp.Basic]:
    """Return the parts with roots, logarithms, moduli, pieces or integers: those may vanish on one branch alone.

    Whatever else there is, is meromorphic everywhere: it vanishes identically or almost nowhere.

    Parameters
    ----------
    parts
        The parts of an expression, what each consists of before it.

    Examples
    --------
    >>> from canon.proof.trees.anatomy import anatomy
    >>> x = sp.Symbol("x", real=True)
    >>> sorted(map(str, branching(anatomy([sp.sin(x) + abs(x)]).parts)))
    ['Abs(x)', 'sin(x) + Abs(x)']
    """
    found: set[sp.Basic] = set()
    for part in parts:
        if _branches(part) or not found.isdisjoint(part.args):
            found.add(part)
    return found


def _branches(part: sp.Basic) -> bool:
    if isinstance(part, sp.Symbol):
        return bool(part.is_integer)
    if isinstance(part, sp.Pow):
        base, exponent = arguments(part)
        return not (known("is_integer", exponent) or known("is_positive", base))
    if isinstance(part, sp.log):
        return not known("is_positive", arguments(part)[0])
    return isinstance(part, sp.Function) and not isinstance(part, (*ENTIRE, AppliedUndef))


def incomplete(parts: Iterable[sp.Basic]) -> list[sp.Piecewise]:
    """Return the pieces that leave something open: where no condition holds there is no value."""
    found = (part for part in parts if isinstance(part, sp.Piecewise))
    return [part for part in found if not part.args or _last_condition(part) != sp.true]


def _last_condition(part: sp.Piecewise) -> sp.Basic:
    return cast("tuple[tuple[Expr, sp.Basic], ...]", part.args)[-1][1]
