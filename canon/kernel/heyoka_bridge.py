"""heyoka's Taylor integrator for Hamilton's equations, and expression graphs as heyoka expressions."""

from __future__ import annotations

import decimal
import math
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import LONGDOUBLE
from canon.expression.symbols.input_in_words import module_of
from canon.kernel.heyoka_compiled import compiled_integrator
from canon.kernel.program.program import exact_value

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Symbol

    from canon.array import Array
    from canon.expression.graph.graph import Graph
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = [
    "fraction_of", "heyoka_doubles", "heyoka_equations", "heyoka_expressions", "heyoka_functions", "heyoka_number",
    "is_heyoka_number", "taylor_integrator",
]  # fmt: skip

_SAME_NAME = (
    "sin", "cos", "tan", "exp", "log", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh",
    "atanh", "atan2", "erf", "erfc",
)  # fmt: skip

_COMPACT_FROM = 300
"""Graphs with more nodes are compiled in heyoka's compact mode, which keeps compile times short."""


_ONE = Fraction(1)

_SMALL = 2.0**-512
"""Smaller numbers are scaled up before a double is made of them."""

_LARGEST_PRODUCT = 64
"""Natural powers up to this one are written as products."""


def heyoka_number(precision: str | int) -> Callable[[Fraction], Any]:
    """Return what turns exact numbers into heyoka's numbers of a precision.

    Parameters
    ----------
    precision
        ``"double"``, ``"extended"`` (the platform's long double), ``"quad"`` (113 bits) or decimal digits.

    Raises
    ------
    ValueError
        There is no such precision.
    """
    import heyoka as hy

    if precision == "double":
        return float
    if precision == "extended":
        return LONGDOUBLE.number
    if precision == "quad":
        if not hasattr(hy, "real128"):
            raise ValueError(
                f"heyoka {hy.__version__} was built without quad precision here; install a newer one, or take 34 "
                "decimal digits"
            )
        return lambda value: hy.real128(_decimal(value, 40))
    if not isinstance(precision, int) or not 16 <= precision <= 1000:
        raise ValueError(
            f"precision={precision!r}: Taylor() has 'double', 'extended', 'quad' and decimal digits, 16 … 1000"
        )
    bits = _bits(precision)
    return lambda value: hy.real(_decimal(value, precision + 5), bits)


def heyoka_doubles(x: Array, precision: str | int) -> Any:
    """Return doubles as an array of heyoka's numbers of a precision: the same numbers, none is rounded.

    Examples
    --------
    >>> heyoka_doubles(np.array([0.5, 3.0]), "double")
    array([0.5, 3. ])
    """
    import heyoka as hy

    if not isinstance(precision, int):
        if precision != "quad":
            return x.astype(np.longdouble if precision == "extended" else np.float64)
        return np.array([hy.real128(each) for each in x.ravel().tolist()]).reshape(x.shape)
    bits = _bits(precision)
    return np.array([hy.real(each, bits) for each in x.ravel().tolist()]).reshape(x.shape)


def _bits(digits: int) -> int:
    return math.ceil(digits * math.log2(10)) + 2


def _decimal(value: Fraction, digits: int) -> str:
    with decimal.localcontext(prec=digits):
        return str(decimal.Decimal(value.numerator) / decimal.Decimal(value.denominator))


def is_heyoka_number(x: object) -> bool:
    """Tell whether a number is one of heyoka's own, wider than the platform's."""
    return module_of(type(x)).startswith("heyoka") and type(x).__name__ in ("real128", "real")


def fraction_of(x: Any) -> Fraction:
    """Return one of heyoka's numbers, or a long double, exactly.

    Raises
    ------
    ValueError
        It is not finite.

    Examples
    --------
    >>> fraction_of(heyoka_number(40)(Fraction(3, 8)))
    Fraction(3, 8)
    """
    if not math.isfinite(float(x)):
        raise ValueError(f"{x} is no finite number")
    if hasattr(x, "as_integer_ratio"):
        return Fraction(*x.as_integer_ratio())
    kind, found, scale = type(x), Fraction(0), Fraction(1)
    while x != kind(0.0):
        part = float(x)
        if abs(part) < _SMALL:
            x, scale = x * kind(1 / _SMALL), scale * Fraction(_SMALL)
            continue
        found += Fraction(part) * scale
        x = x - kind(part)
    return found


def heyoka_expressions(
    graph: Graph,
    nodes: Sequence[int],
    variables: Mapping[Symbol, Any],
    number: Callable[[Fraction], Any] = float,
) -> list[Any]:
    """Return nodes as heyoka expressions in given heyoka variables, constants as numbers of one kind.

    Raises
    ------
    ValueError
        A node holds sign(x), which no Taylor series crosses.
    """
    import heyoka as hy

    done = dict[int, Any]()
    for each in graph.reachable(nodes):
        kind, operands, value = graph.nodes[each]
        x = [done[o] for o in operands]
        match kind:
            case "symbol":
                done[each] = variables[value]
            case "number":
                done[each] = hy.expression(number(value))
            case "named":
                is_pi = value == "pi"
                done[each] = hy.pi if is_pi else hy.expression(number(exact_value(graph, each)))
            case "add":
                done[each] = hy.sum(x)
            case "mul":
                done[each] = hy.prod(x)
            case "pow":
                exponent = graph.nodes[operands[1]]
                done[each] = _power(x[0], x[1], exponent.value if exponent.kind == "number" else None)
            case "Abs":
                done[each] = hy.select(hy.gte(x[0], hy.expression(0.0)), x[0], -x[0])
            case _ if kind in _SAME_NAME:
                done[each] = getattr(hy, kind)(*x)
            case _:
                raise ValueError(
                    f"{kind}(…) has no Taylor series where it jumps: use a smooth Hamiltonian, or RK4()"
                )
    return [done[node] for node in nodes]


def _power(base: Any, exponent: Any, known: Fraction | None) -> Any:
    """Return a power, by a root or by products where the exponent is a known number that allows it."""
    import heyoka as hy

    if known == Fraction(1, 2):
        return hy.sqrt(base)
    if known is not None and known.denominator == 1 and 2 < known <= _LARGEST_PRODUCT:
        return _product_of_squares(base, int(known))
    return base**exponent


def heyoka_functions(
    system: HamiltonEquations,
    nodes: Sequence[int],
    number: Callable[[Fraction], Any] = float,
    unit: Fraction = _ONE,
) -> list[Any]:
    """Return functions of (q, p, t) in the variables of :func:`heyoka_equations`."""
    import heyoka as hy

    variables = _variables(system)
    if unit != 1:
        size = hy.expression(number(unit))
        variables = {symbol: size * variable for symbol, variable in variables.items()}
    return heyoka_expressions(system.graph, nodes, {**variables, system.t: hy.time}, number)


def _product_of_squares(x: Any, power: int) -> Any:
    """Return xⁿ as products: heyoka's Taylor series of x ** 3 and higher powers divide by x, and are lost at x = 0."""
    result, square = None, x
    while True:
        if power & 1:
            result = square if result is None else result * square
        power >>= 1
        if not power:
            return result
        square = square * square


def heyoka_equations(
    system: HamiltonEquations, number: Callable[[Fraction], Any] = float, unit: Fraction = _ONE
) -> list[tuple[Any, Any]]:
    """Return Hamilton's equations as heyoka takes them: pairs of a variable and its rate, (q, p) in order.

    The variables are q and p in parts of ``unit``.
    """
    import heyoka as hy

    rates = heyoka_functions(system, system.rates, number, unit)
    if unit != 1:
        rates = [hy.expression(number(1 / unit)) * rate for rate in rates]
    return list(zip(_variables(system).values(), rates, strict=True))


def _variables(system: HamiltonEquations) -> dict[Symbol, Any]:
    import heyoka as hy

    names = [f"{letter}{i}" for letter, half in (("q", system.q), ("p", system.p)) for i in range(len(half))]
    return dict(zip((*system.q, *system.p), map(hy.expression, names), strict=True))


def taylor_integrator(
    system: HamiltonEquations,
    y0: Sequence[Fraction],
    t0: Fraction,
    tolerance: float | None,
    number: Callable[[Fraction], Any] = float,
    events: Mapping[str, Sequence[Any]] = MappingProxyType({}),
    unit: Fraction = _ONE,
) -> Any:
    """Return heyoka's adaptive integrator of Hamilton's equations.

    In doubles the terms of a Taylor coefficient may be added in any order, and quotients by one number become
    products with its reciprocal, which errs as little and takes less time (benchmarks/peers.py has both): not where
    events are looked for, whose search counts on the order of operations, and not in compact mode, which does not gain.

    Parameters
    ----------
    system
        The equations.
    y0, t0
        The state (q, p) and the time to start from.
    tolerance
        Relative tolerance of a step; the rounding unit where None.
    number
        Makes the numbers it computes with; see :func:`heyoka_number`.
    events
        heyoka's ``t_events`` and ``nt_events``.
    unit
        What the integrator's numbers are parts of, a power of two; heyoka takes the tolerance for an absolute one where
        all of them are below 1.
    """
    compact = number is not float or len(system.graph.reachable(system.rates)) > _COMPACT_FROM
    state = [number(x / unit) for x in y0]
    options: dict[str, Any] = {} if tolerance is None else {"tol": number(Fraction(tolerance))}
    return compiled_integrator(
        heyoka_equations(system, number, unit),
        np.array(state),
        time=number(t0),
        fp_type=type(state[0]),
        compact_mode=compact,
        fast_math=not compact and not events,
        **options,
        **events,
    )
