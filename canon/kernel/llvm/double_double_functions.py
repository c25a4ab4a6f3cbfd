"""Elementary functions in double-double, as LLVM functions made of its sums, products and quotients.

Arguments are reduced by Cody and Waite's method with constants of four doubles, so that the products with the whole
number of periods are exact (W. J. Cody, W. Waite, Software Manual for the Elementary Functions, Prentice-Hall
1980); then Taylor's series, or for inverse functions one Newton step from libm's double. Absolute errors
are some 10⁻³² for results of size 1.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Protocol, Self

from mpmath import MPContext

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.kernel.llvm.number_types import MachineType

__all__ = ["LARGEST_ANGLE", "PAIR_FUNCTIONS", "call_pair_function"]

_SINE_TERMS, _COSINE_TERMS, _EXPONENTIAL_TERMS, _HALVINGS = 14, 15, 12, 6
LARGEST_ANGLE = Fraction(2**45)
"""Angles beyond it have lost their place in the period: NaN."""

_LARGEST_EXPONENT = 2040


@functools.cache
def _parts(name: str) -> tuple[Fraction, ...]:
    """Return π/2 or ln 2 as a sum of four doubles."""
    context = MPContext()
    context.prec = 300
    value = context.pi / 2 if name == "half pi" else context.ln2
    mantissa, exponent = value.man_exp
    rest = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    parts = list[Fraction]()
    for _ in range(4):
        parts.append(Fraction(float(rest)))
        rest -= parts[-1]
    return tuple(parts)


class PairWriter(Protocol):
    """The operations of a :class:`canon.kernel.llvm.writer.Writer` that these functions are written with."""

    number: MachineType
    reserved: list[str]
    lines: list[str]
    declarations: set[str]

    def in_numbers(self, number: MachineType) -> Self: ...
    def let(self, text: str) -> str: ...
    def paired(self, high: str, low: str) -> str: ...
    def constant(self, value: Fraction) -> str: ...
    def nan(self) -> str: ...
    def algebra(self, operation: str, a: str, b: str) -> str: ...
    def negative(self, a: str) -> str: ...
    def operation(self, operation: str, x: list[str]) -> str: ...
    def intrinsic(self, name: str, *operands: str) -> str: ...
    def library(self, name: str, *operands: str) -> str: ...
    def less(self, a: str, b: str) -> str: ...
    def equal(self, a: str, b: str) -> str: ...
    def select(self, flag: str, where_true: str, where_false: str) -> str: ...


class _Base:
    """The doubles (or lanes of them) that pairs are made of, in the same function."""

    def __init__(self, w: PairWriter) -> None:
        self.w = w
        self.b = w.in_numbers(dataclasses.replace(w.number, pair=False))

    def high(self, x: str) -> str:
        return self.w.let(f"extractvalue {self.w.number.name} {x}, 0")

    def pair(self, high: str) -> str:
        return self.w.paired(high, self.b.constant(Fraction(0)))

    def choose(self, flag: str, where_true: str, where_false: str) -> str:
        """Choose between two pairs, lane by lane."""
        w, base = self.w, self.w.number.base
        parts = [
            self.b.select(
                flag, *(w.let(f"extractvalue {w.number.name} {x}, {k}") for x in (where_true, where_false))
            )
            for k in (0, 1)
        ]
        assert base
        return w.paired(*parts)


def _reduced(w: PairWriter, x: str, name: str) -> tuple[str, str]:
    """Return the whole number k of periods nearest to x, a double, and x − k·period, a pair."""
    base, parts = _Base(w), _parts(name)
    inverse = base.b.constant(1 / parts[0])
    k = base.b.intrinsic("rint", base.b.algebra("mul", base.high(x), inverse))
    whole = base.pair(k)
    for part in parts:
        x = w.algebra("sub", x, w.algebra("mul", whole, w.constant(part)))
    return k, x


def _series(w: PairWriter, square: str, first: int, terms: int) -> str:
    """Return Σ (−1)^k square^k / (2k + first)! over so many terms, by Horner's rule."""
    total = w.constant(Fraction((-1) ** (terms - 1), math.factorial(2 * (terms - 1) + first)))
    for k in range(terms - 2, -1, -1):
        coefficient = w.constant(Fraction((-1) ** k, math.factorial(2 * k + first)))
        total = w.algebra("add", w.algebra("mul", total, square), coefficient)
    return total


def _circular(w: PairWriter, x: str, turned: int) -> str:
    """Return sin(x + turned π/2)."""
    base = _Base(w)
    b = base.b
    k, r = _reduced(w, x, "half pi")
    square = w.algebra("mul", r, r)
    sine = w.algebra("mul", r, _series(w, square, 1, _SINE_TERMS))
    cosine = _series(w, square, 0, _COSINE_TERMS)
    quarter = b.algebra("add", k, b.constant(Fraction(turned)))
    half = b.intrinsic("floor", b.algebra("mul", quarter, b.constant(Fraction(1, 2))))
    odd = b.less(b.algebra("add", half, half), quarter)
    found = base.choose(odd, cosine, sine)
    whole = b.intrinsic("floor", b.algebra("mul", half, b.constant(Fraction(1, 2))))
    negative = b.less(b.algebra("add", whole, whole), half)
    found = base.choose(negative, w.negative(found), found)
    known = b.less(b.intrinsic("fabs", base.high(x)), b.constant(LARGEST_ANGLE))
    return base.choose(known, found, base.pair(b.nan()))


def _exponential(w: PairWriter, x: str) -> str:
    base = _Base(w)
    b = base.b
    k, r = _reduced(w, x, "ln 2")
    r = w.algebra("mul", r, w.constant(Fraction(1, 2**_HALVINGS)))
    total = w.constant(Fraction(1, math.factorial(_EXPONENTIAL_TERMS)))
    for n in range(_EXPONENTIAL_TERMS - 1, 0, -1):
        total = w.algebra("add", w.algebra("mul", total, r), w.constant(Fraction(1, math.factorial(n))))
    less_one = w.algebra("mul", total, r)
    for _ in range(_HALVINGS):  # e^2x − 1 = (e^x − 1)(e^x + 1)
        less_one = w.algebra("mul", less_one, w.algebra("add", less_one, w.constant(Fraction(2))))
    found = w.algebra("add", less_one, w.constant(Fraction(1)))
    limit = b.constant(Fraction(_LARGEST_EXPONENT))
    k = b.intrinsic("minnum", b.intrinsic("maxnum", k, b.negative(limit)), limit)
    first = b.intrinsic("floor", b.algebra("mul", k, b.constant(Fraction(1, 2))))
    for part in (first, b.algebra("sub", k, first)):
        found = w.algebra("mul", found, base.pair(_power_of_two(b, part)))
    return found


def _power_of_two(b: PairWriter, k: str) -> str:
    """Return 2^k for whole doubles −1022 … 1023, made of its bits."""
    lanes, base = b.number.lanes, b.number.base
    integer = "i64" if lanes == 1 else f"<{lanes} x i64>"

    def each(value: int) -> str:
        return str(value) if lanes == 1 else "<" + ", ".join([f"i64 {value}"] * lanes) + ">"

    biased = b.let(f"add {integer} {b.let(f'fptosi {base} {k} to {integer}')}, {each(1023)}")
    return b.let(f"bitcast {integer} {b.let(f'shl {integer} {biased}, {each(52)}')} to {base}")


def _logarithm(w: PairWriter, x: str) -> str:
    base = _Base(w)
    near = base.pair(base.b.library("log", base.high(x)))
    e = w.operation("exp", [near])
    ratio = w.algebra("div", w.algebra("sub", x, e), w.algebra("add", x, e))
    return w.algebra("add", near, w.algebra("add", ratio, ratio))


def _angle(w: PairWriter, y: str, x: str) -> str:
    base = _Base(w)
    near = base.pair(base.b.library("atan2", base.high(y), base.high(x)))
    s, c = w.operation("sin", [near]), w.operation("cos", [near])
    across = w.algebra("sub", w.algebra("mul", y, c), w.algebra("mul", x, s))
    along = w.algebra("add", w.algebra("mul", x, c), w.algebra("mul", y, s))
    return w.algebra("add", near, w.algebra("div", across, along))


def _complement(w: PairWriter, x: str) -> str:
    """Return √(1 − x²) = √((1 − x)(1 + x))."""
    one = w.constant(Fraction(1))
    return w.operation("sqrt", [w.algebra("mul", w.algebra("sub", one, x), w.algebra("add", one, x))])


def _hyperbolic(w: PairWriter, x: str, sign: str) -> str:
    e = w.operation("exp", [x])
    both = w.algebra(sign, e, w.algebra("div", w.constant(Fraction(1)), e))
    return w.algebra("mul", both, w.constant(Fraction(1, 2)))


def _quotient(above: str, below: str) -> Callable[..., str]:
    return lambda w, x: w.algebra("div", w.operation(above, [x]), w.operation(below, [x]))


def _size(w: PairWriter, x: str) -> str:
    base = _Base(w)
    negative = base.b.less(base.high(x), base.b.constant(Fraction(0)))
    return base.choose(negative, w.negative(x), x)


def _sign(w: PairWriter, x: str) -> str:
    base = _Base(w)
    high, zero = base.high(x), base.b.constant(Fraction(0))
    unit = base.b.intrinsic("copysign", base.b.constant(Fraction(1)), high)
    return base.pair(base.b.select(base.b.equal(high, zero), zero, unit))


PAIR_FUNCTIONS: dict[str, Callable[..., str]] = {
    "sin": lambda w, x: _circular(w, x, 0),
    "cos": lambda w, x: _circular(w, x, 1),
    "tan": _quotient("sin", "cos"),
    "exp": _exponential,
    "log": _logarithm,
    "pow": lambda w, x, y: w.operation("exp", [w.algebra("mul", y, w.operation("log", [x]))]),
    "atan2": _angle,
    "atan": lambda w, x: _angle(w, x, w.constant(Fraction(1))),
    "asin": lambda w, x: _angle(w, x, _complement(w, x)),
    "acos": lambda w, x: _angle(w, _complement(w, x), x),
    "sinh": lambda w, x: _hyperbolic(w, x, "sub"),
    "cosh": lambda w, x: _hyperbolic(w, x, "add"),
    "tanh": _quotient("sinh", "cosh"),
    "Abs": _size,
    "sign": _sign,
}
"""What double-double has beyond sums, products, quotients and square roots."""


def call_pair_function(w: PairWriter, name: str, operands: list[str]) -> str:
    """Write a call of a double-double function and, among the declarations, the function itself."""
    kind = w.number.name
    text, declarations = _definition(type(w), w.number, name, len(operands))
    w.declarations.add(text)
    w.declarations |= declarations
    return w.let(
        f"call {kind} @pair.{name}.{w.number.intrinsic}({', '.join(f'{kind} {o}' for o in operands)})"
    )


@functools.cache
def _definition(
    writer: Callable[[MachineType], Any], number: MachineType, name: str, count: int
) -> tuple[str, frozenset[str]]:
    f: PairWriter = writer(number)
    arguments = [f"%x{k}" for k in range(count)]
    result = PAIR_FUNCTIONS[name](f, *arguments)
    kind = number.name
    head = f"define internal {kind} @pair.{name}.{number.intrinsic}({', '.join(f'{kind} {x}' for x in arguments)}) {{"
    text = "\n".join([head, "entry:", *f.reserved, *f.lines, f"  ret {kind} {result}", "}"])
    return text, frozenset(f.declarations)
