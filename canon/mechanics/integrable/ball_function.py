"""Functions of one complex variable on balls, which tell where they are holomorphic.

As the quadrature of Arb asks (F. Johansson, Numerical integration in arbitrary-precision ball arithmetic,
doi:10.1007/978-3-319-96418-8_30): called with ``analytic`` the value is finite only where the function is holomorphic
on the whole ball.
"""

from __future__ import annotations

import operator
from functools import reduce
from typing import TYPE_CHECKING, Any, TypeAlias

import sympy as sp
from flint import acb, arb
from sympy import Expr, Symbol

from canon.proof.domain.balls import value

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

__all__ = ["BallFunction", "NotHolomorphicError"]

ENTIRE: dict[Any, Callable[[acb], acb]] = {
    sp.sin: lambda z: z.sin(),
    sp.cos: lambda z: z.cos(),
    sp.sinh: lambda z: z.sinh(),
    sp.cosh: lambda z: z.cosh(),
    sp.exp: lambda z: z.exp(),
    sp.tan: lambda z: z.tan(),
    sp.cot: lambda z: z.cot(),
    sp.sec: lambda z: z.sec(),
    sp.csc: lambda z: z.csc(),
    sp.tanh: lambda z: z.tanh(),
    sp.coth: lambda z: z.coth(),
    sp.sech: lambda z: z.sech(),
    sp.csch: lambda z: z.csch(),
}
"""Functions without branch cuts; at poles their balls are not finite."""

NOWHERE = acb("nan")

_Step: TypeAlias = "Callable[[tuple[acb, acb], bool], acb]"
"""An operation, and whether it has to be holomorphic; what has one operand is given it twice."""


class NotHolomorphicError(ValueError):
    """Raised for functions that have no holomorphic continuation here, such as absolute values."""


class BallFunction:
    """A function of one variable, compiled once for many balls.

    Parameters
    ----------
    f
        The function, of elementary functions.
    variable
        Its variable.
    values
        The values of all its other symbols.

    Raises
    ------
    NotHolomorphicError
        Where a function in f is not modelled.

    Examples
    --------
    >>> q, k = sp.symbols("q k")
    >>> f = BallFunction(sp.sqrt(q) + k, q, {k: acb(1)})
    >>> f(acb(4)).overlaps(acb(3)), f(acb(-4), analytic=True).is_finite()
    (True, False)
    """

    def __init__(self, f: Expr, variable: Symbol, values: Mapping[Symbol, acb]) -> None:
        self.f = f
        self._variable, self._values = variable, values
        self._constants: list[acb] = [NOWHERE]
        self._steps: list[tuple[int, int, int, Callable[..., acb], bool]] = []
        self._places: dict[sp.Basic, int] = {variable: 0}
        self._last = self._place(f)

    def __call__(self, z: acb, analytic: bool = False) -> acb:
        """Return the value on a ball; not finite where ``analytic`` and not certainly holomorphic there."""
        memory = self._constants.copy()
        memory[0] = z
        for place, i, j, operation, is_entire in self._steps:  # sums and products, without a call in between
            if is_entire:
                memory[place] = operation(memory[i], memory[j])
            else:
                memory[place] = operation((memory[i], memory[j]), analytic)
        return memory[self._last]

    def _place(self, node: sp.Basic) -> int:
        known = self._places.get(node)
        if known is None:
            known = self._places[node] = self._new_place(node)
        return known

    def _new_place(self, node: sp.Basic) -> int:
        if not node.has(self._variable):
            return self._kept(_constant(node, self._values))
        if isinstance(node, sp.Add | sp.Mul):
            return self._two_by_two(node.args, operator.add if isinstance(node, sp.Add) else operator.mul)
        operands = [self._place(each) for each in _operands(node)]
        return self._added(operands[0], operands[-1], _operation(node), is_entire=False)

    def _two_by_two(self, operands: Sequence[sp.Basic], two: Callable[[acb, acb], acb]) -> int:
        """Return the place of a sum or product: of what is constant once, then of each of the others."""
        still = [_constant(each, self._values) for each in operands if not each.has(self._variable)]
        places = [self._kept(reduce(two, still))] if still else []
        places += [self._place(each) for each in operands if each.has(self._variable)]
        return reduce(lambda i, j: self._added(i, j, two, is_entire=True), places)

    def _added(self, i: int, j: int, operation: Callable[..., acb], *, is_entire: bool) -> int:
        place = self._kept(NOWHERE)
        self._steps.append((place, i, j, operation, is_entire))
        return place

    def _kept(self, constant: acb) -> int:
        self._constants.append(constant)
        return len(self._constants) - 1


def _constant(node: sp.Basic, values: Mapping[Symbol, acb]) -> acb:
    if isinstance(node, Symbol):
        if node not in values:
            raise ValueError(f"{node} has no value; give it among the parameters")
        return values[node]
    if not node.free_symbols:
        return value(node, {})  # pyright: ignore[reportArgumentType]
    memory = dict(values)
    return value(node, {}, memory)  # pyright: ignore[reportArgumentType]


def _operands(node: sp.Basic) -> tuple[sp.Basic, ...]:
    """Return what has to be known for a node; the exponent of a power is part of the operation."""
    if isinstance(node, sp.Pow) and isinstance(node.exp, sp.Rational):
        return (node.base,)
    return node.args


def _operation(node: sp.Basic) -> _Step:
    if isinstance(node, sp.Pow) and isinstance(node.exp, sp.Rational):
        return _rational_power(node.exp, modulus=isinstance(node.base, sp.Abs))
    if isinstance(node, sp.Pow):
        return _power
    function = ENTIRE.get(node.func)
    if function is not None:
        return _entire(function)
    if isinstance(node, sp.Abs | sp.sign):
        return _of_sides(modulus=isinstance(node, sp.Abs))
    if isinstance(node, sp.log) and len(node.args) == 1:
        return lambda arguments, analytic: arguments[0].log(analytic=analytic)
    raise NotHolomorphicError(
        f"{node.func.__name__} is not among the functions that cycles are integrated over; write the potential "
        "with powers, exponentials, logarithms, trigonometric and hyperbolic functions"
    )


def _entire(function: Callable[[acb], acb]) -> _Step:
    def applied(arguments: tuple[acb, acb], _analytic: bool) -> acb:
        return function(arguments[0])

    return applied


def _of_sides(*, modulus: bool) -> _Step:
    """Return |z| or sign z of a real z, continued from each side of zero: ±z and ±1."""

    def applied(arguments: tuple[acb, acb], analytic: bool) -> acb:
        z = arguments[0]
        if z.real > 0 or z.real < 0:
            side = 1 if z.real > 0 else -1
            return side * z if modulus else acb(side)
        if analytic or not z.imag.is_zero():
            return NOWHERE
        return acb(abs(z.real) if modulus else arb(0, 1))

    return applied


def _power(arguments: tuple[acb, acb], analytic: bool) -> acb:
    base, exponent = arguments
    return (exponent * base.log(analytic=analytic)).exp()


def _of_nothing_less(x: arb, exponent: arb) -> acb:
    """Return the power of a modulus of which a ball tells that it may be zero."""
    top = x.upper()
    return acb(arb(0).union(top**exponent)) if top > 0 else acb(0)


def _rational_power(exponent: sp.Rational, *, modulus: bool) -> _Step:
    n, d = int(exponent.p), int(exponent.q)

    def power(arguments: tuple[acb, acb], analytic: bool) -> acb:
        base = arguments[0]
        if modulus and d > 1 and n > 0 and not analytic and base.real.contains(0):
            return _of_nothing_less(base.real, arb(n) / d)
        if n < 0 and base.contains(0):
            return NOWHERE
        if d == 1:
            return base**n
        if d == 2:
            return base.sqrt(analytic=analytic) ** n
        return (base.log(analytic=analytic) * n / d).exp()

    return power
