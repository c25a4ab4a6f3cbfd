"""Values of integrands: which part of one may have no value on the range, such as ``log(x)`` from -2 to -1.

What an evaluation leaves out, as in 0 log x, can't be asked any more whether it has a value; so the tree is asked.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from canon.expression.ranges.range_of_call import INTEGRAL, PRODUCT, SUM
from canon.expression.text.differentials import PARTIAL, TOTAL
from canon.expression.text.syntax import Call, Name, Node, Number, Power, Product, parts

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr

    from canon.expression.ranges.range_of_call import Range
    from canon.expression.text.scope import Scope

__all__ = ["part_without_value"]

_EVERYWHERE = ("sin", "cos", "exp", "sinh", "cosh", "tanh", "atan", "asinh", "Abs", "Derivative", "diff", "D",
               TOTAL, PARTIAL, INTEGRAL, SUM, PRODUCT)  # fmt: skip
"""Functions with a value wherever their arguments, which are asked as well, have one."""


class _Builder(Protocol):
    text: str
    scope: Scope

    def __init__(self, text: str, scope: Scope) -> None: ...
    def expression(self, node: Node) -> Expr: ...


def part_without_value(builder: _Builder, integral: Call, over: Sequence[Range]) -> Node | None:
    """Return a part of an integral that depends on a variable and is not known to have a value; None if there is none.

    Parameters
    ----------
    builder
        Gives trees their meaning outside the integral.
    integral
        The whole call, bounds that depend on other variables included.
    over
        Its ranges, the innermost first.
    """
    scope = builder.scope
    for one in reversed(over):
        bounds = [type(builder)(builder.text, scope).expression(bound) for bound in (one.lower, one.upper)]
        positive = all(bound.is_positive for bound in bounds) or None
        scope = scope.with_variable(one.variable.text, positive=positive)
    on_range = type(builder)(builder.text, scope)
    names = frozenset(one.variable.text for one in over)
    for part in (part for argument in integral.arguments for part in parts(argument)):
        if isinstance(part, Call) and part.function not in (*_EVERYWHERE, "sqrt") and _depends(part, names):
            return part
        for base, root in _divisors_and_roots(part):
            if _depends(base, names) and not _has_values(on_range, base, names, root=root):
                return base
    return None


def _depends(node: Node, names: frozenset[str]) -> bool:
    return any(
        (isinstance(part, Name) and part.text in names) or (isinstance(part, Call) and part.function in names)
        for part in parts(node)
    )


def _divisors_and_roots(node: Node) -> Iterator[tuple[Node, bool]]:
    """Yield what a part divides by, and what it takes a root of, each with whether it is a root."""
    match node:
        case Product(factors):
            yield from ((factor, False) for divides, factor in factors if divides)
        case Power(base, Number(_, 1)):
            del base
        case Power(base, exponent):
            yield base, True
            yield exponent, True
        case Call("sqrt", (radicand,)):
            yield radicand, True
        case _:
            pass


def _has_values(on_range: _Builder, base: Node, names: frozenset[str], *, root: bool) -> bool:
    """Tell whether something is positive on the range; of a divisor only what depends on the variable is asked."""
    value = on_range.expression(base)
    if root:
        return bool(value.is_positive)
    variables = [symbol for name in names if (symbol := on_range.scope.symbol(name)) is not None]
    return bool(value.as_independent(*variables, as_Add=False)[1].is_nonzero)
