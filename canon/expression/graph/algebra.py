"""Algebra of the expression graph: equal terms and bases merged, short sums and products flattened.

Only exact numbers are worked with, and nothing is expanded. Like SymPy, x·x⁻¹ becomes 1.
"""

from __future__ import annotations

from fractions import Fraction
from math import isqrt
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from canon.expression.graph.arena import Arena

__all__ = ["add", "factored", "folded_power", "mul", "negative", "power", "raised", "scaled"]

_FOLDED_BITS = 4096
"""Powers of exact numbers are worked out up to this size."""

_FLATTENED = 8
"""Sums and products longer than this stay one shared node when they are part of a longer one."""

_NUMBER_AND_ONE = 2
"""Operands of c·x, whose x may be a product of its own."""

_REWRITTEN = frozenset({"number", "mul", "pow"})
"""Bases whose powers may be written otherwise."""


def add(arena: Arena, terms: Iterable[int]) -> int:
    """Return the sum of nodes, equal terms merged."""
    constant, coefficients, alone = 0, dict[int, Fraction | int](), dict[int, int]()
    for term in _flat(arena, "add", terms):
        factor, rest = factored(arena, term)
        if rest is None:
            constant += factor
        elif rest in coefficients:
            coefficients[rest] += factor
            alone.pop(rest, None)
        else:
            coefficients[rest] = factor
            if factor == 1 or _has_one_number(arena, term):
                alone[rest] = term  # as it stands: its number and its factors are not put together again
    operands = sorted(
        alone[rest] if rest in alone else rest if factor == 1 else scaled(arena, factor, rest)
        for rest, factor in coefficients.items()
        if factor
    )
    if constant:
        operands.insert(0, arena.number(constant))
    if len(operands) < 2:
        return operands[0] if operands else arena.number(0)
    return arena.operation("add", tuple(operands))


def mul(arena: Arena, factors: Iterable[int]) -> int:
    """Return the product of nodes, powers of equal bases merged."""
    constant, exponents, alone = _merged(arena, factors)
    operands: list[int] = []
    for base, exponent in exponents.items():
        if base in alone:
            operands.append(alone[base])
            continue
        raised = base if exponent == 1 else power(arena, base, arena.number(exponent))
        if arena.nodes[raised].kind == "number":
            constant *= arena.nodes[raised].value
        else:
            operands.append(raised)
    if not constant:
        return arena.number(0)
    return _product(arena, constant, tuple(sorted(operands)))


def _merged(
    arena: Arena, factors: Iterable[int]
) -> tuple[Fraction | int, dict[int, Fraction | int], dict[int, int]]:
    """Return the number before a product, the exponents of its bases, and the powers that may stay as they stand."""
    constant: Fraction | int = 1
    exponents, alone = dict[int, Fraction | int](), dict[int, int]()
    for factor in _flat(arena, "mul", factors):
        node = arena.nodes[factor]
        if node.kind == "number":
            constant = node.value if constant == 1 else constant * node.value
            continue
        base, exponent = _powered(arena, factor)
        if base in exponents:
            exponents[base] += exponent
            alone.pop(base, None)
        else:
            exponents[base] = exponent
            if base == factor or arena.nodes[base].kind not in _REWRITTEN:
                alone[base] = factor  # as it stands: it is the power that would be made again
    return constant, exponents, alone


def power(arena: Arena, base: int, exponent: int) -> int:
    """Return base**exponent, the principal value."""
    if arena.nodes[exponent].kind != "number":
        return arena.operation("pow", (base, exponent))
    exact: Fraction = arena.nodes[exponent].value
    if exact in (0, 1):
        return base if exact else arena.number(1)
    node = arena.nodes[base]
    if node.kind == "number":
        folded = folded_power(node.value, exact)
        return arena.operation("pow", (base, exponent)) if folded is None else arena.number(folded)
    if exact.denominator == 1:
        inner, own = _powered(arena, base)
        if own != 1:
            return power(arena, inner, arena.number(own * exact))
        factor, rest = factored(arena, base)
        if factor != 1 and rest is not None:
            return mul(arena, [power(arena, arena.number(factor), exponent), power(arena, rest, exponent)])
    return arena.operation("pow", (base, exponent))


def scaled(arena: Arena, factor: Fraction | int, node: int) -> int:
    """Return factor · node without looking at anything but node's own numerical factor."""
    own, rest = factored(arena, node)
    if rest is None or not factor:
        return arena.number(factor * own)
    operands = arena.nodes[rest].operands if arena.nodes[rest].kind == "mul" else (rest,)
    return _product(arena, factor * own, operands)


def factored(arena: Arena, node: int) -> tuple[Fraction | int, int | None]:
    """Split c·x into its number c and the rest x (None where the node is a number)."""
    kind, operands, value = arena.nodes[node]
    if kind == "number":
        return value, None
    if kind == "mul" and arena.nodes[operands[0]].kind == "number":
        return arena.nodes[operands[0]].value, _product(arena, 1, operands[1:])
    return 1, node


def _has_one_number(arena: Arena, product: int) -> bool:
    """Return whether c·x is a product of c and several factors: putting these together again gives the same node."""
    operands = arena.nodes[product].operands
    return len(operands) > _NUMBER_AND_ONE and arena.nodes[operands[1]].kind != "number"


def _powered(arena: Arena, node: int) -> tuple[int, Fraction | int]:
    """Split x**c into x and the exact number c (1 for what is no such power)."""
    kind, operands, _ = arena.nodes[node]
    if kind == "pow" and arena.nodes[operands[1]].kind == "number":
        return operands[0], arena.nodes[operands[1]].value
    return node, 1


def _product(arena: Arena, constant: Fraction | int, operands: tuple[int, ...]) -> int:
    if constant != 1 or not operands:
        operands = (arena.number(constant), *operands)
    return operands[0] if len(operands) == 1 else arena.operation("mul", operands)


def _flat(arena: Arena, kind: str, operands: Iterable[int]) -> list[int]:
    flat: list[int] = []
    for operand in operands:
        node = arena.nodes[operand]
        flat.extend(node.operands if node.kind == kind and len(node.operands) <= _FLATTENED else (operand,))
    return flat


def folded_power(base: Fraction, power: Fraction) -> Fraction | None:
    """Return base**power where that is a rational number of modest size."""
    if not base and power < 0:
        raise ZeroDivisionError("the expression divides by zero: an exact 0 is raised to a negative power")
    if base == 1 or (not base and power > 0):
        return base
    if power.denominator == 2 and base >= 0:
        roots = Fraction(isqrt(base.numerator), isqrt(base.denominator))
        if roots * roots != base:
            return None
        base, power = roots, power * 2
    size = max(base.numerator.bit_length(), base.denominator.bit_length())
    if power.denominator != 1 or size * abs(power) > _FOLDED_BITS:
        return None
    return Fraction(base**power.numerator)


def raised(arena: Arena, base: int, exponent: Fraction | int) -> int:
    """Return base**exponent for an exact exponent."""
    return power(arena, base, arena.number(exponent))


def negative(arena: Arena, node: int) -> int:
    """Return −node."""
    found = arena.negatives.get(node)
    if found is None:
        found = arena.negatives[node] = scaled(arena, -1, node)
    return found
