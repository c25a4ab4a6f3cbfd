"""Derivatives at exact points with their round-off, and residuals of brackets and of rates made of them."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

import sympy as sp
from sympy.core.function import AppliedUndef

from canon.expression.graph.graph import Graph
from canon.expression.graph.number_systems import multiprecision
from canon.proof.trees.sympy_types import free_symbols, rational

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.mechanics.canonical.transformation import CanonicalTransformation

__all__ = ["FINE", "Residual", "RoundedValue", "bracket_residuals", "definite_node", "values_at"]

_COARSE, FINE = 30, 50
"""Digits of the two evaluations, whose difference shows the round-off."""

_UNCERTAIN = Fraction(1, 10**12)
"""What misses by less than this part of its terms may do so for rounded numbers in the claim."""

_TRIES = 4
"""Points drawn for every point wanted, as the map need not be real everywhere."""


class Residual(NamedTuple):
    """What should vanish at an exact point: its size, its round-off and its terms' size, all absolute."""

    size: Fraction
    unit: Fraction
    scale: Fraction
    what: str
    where: Mapping[Symbol, Fraction]

    @property
    def rounded(self) -> bool:
        """Whether it is no larger than round-off."""
        return self.size <= self.unit

    @property
    def certain(self) -> bool:
        """Whether it is far from zero."""
        return self.size > max(self.unit, _UNCERTAIN * self.scale)


def bracket_residuals(
    T: CanonicalTransformation, valence: Expr, count: int, seed: int, fixed: Mapping[str, Fraction]
) -> Iterator[list[Residual]]:
    """Yield the misses of M J Mᵀ = c J at each point where the map has a finite real value."""
    graph = Graph()
    images = [definite_node(graph, f, "the map") for f in T.images]
    nodes = [slope for f in images for slope in graph.gradient(f, T.variables)]
    nodes += [*images, definite_node(graph, valence, "the valence")]
    symbols = {*T.variables, *(s for f in (*T.images, valence) for s in free_symbols(f))}
    found = 0
    for drawn in T.domain.points(symbols, _TRIES * count, seed=seed):
        point = {s: Fraction(int(x.p), int(x.q)) for s, x in drawn.items()}
        point |= {s: fixed[s.name] for s in point if s.name in fixed}
        if fixed and not T.domain.contains(
            {s: rational(sp.Rational(*x.as_integer_ratio())) for s, x in point.items()}
        ):
            continue
        values = values_at(graph, nodes, point)
        if values is not None:
            yield list(_point_misses(values, len(T.q), point))
            found += 1
        if found == count:
            return


def _point_misses(
    values: Sequence[RoundedValue], n: int, point: Mapping[Symbol, Fraction]
) -> Iterator[Residual]:
    rows = [values[2 * n * i : 2 * n * (i + 1)] for i in range(2 * n)]
    c = values[-1]
    names = [f"{letter}{i + 1}" for letter in "QP" for i in range(n)]
    for i in range(2 * n):
        for j in range(i + 1, 2 * n):
            expected = (
                RoundedValue(c.number, c.error) if j == i + n else RoundedValue(Fraction(0), Fraction(0))
            )
            miss, unit, scale = -expected.number, expected.error, abs(expected.number)
            for k in range(n):
                for sign, a, b in ((1, rows[i][k], rows[j][n + k]), (-1, rows[i][n + k], rows[j][k])):
                    miss += sign * a.number * b.number
                    scale += abs(a.number * b.number)
                    unit += abs(a.number) * b.error + abs(b.number) * a.error
            name = f"{{{names[i]}, {names[j]}}} differs from {float(expected.number):g}"
            yield Residual(abs(miss), unit, scale, name, point)


class RoundedValue(NamedTuple):
    """A number and the size of its round-off."""

    number: Fraction
    error: Fraction


def values_at(
    graph: Graph, nodes: Sequence[int], point: Mapping[Symbol, Fraction]
) -> list[RoundedValue] | None:
    """Return nodes at an exact point, or None where one has no finite real value there."""
    coarse, fine = (_evaluated(graph, nodes, point, digits) for digits in (_COARSE, FINE))
    if coarse is None or fine is None:
        return None
    gain, last = Fraction(1, 10 ** (FINE - _COARSE - 2)), Fraction(1, 10 ** (FINE - 2))
    return [RoundedValue(b, abs(b - a) * gain + abs(b) * last) for a, b in zip(coarse, fine, strict=True)]


def _evaluated(
    graph: Graph, nodes: Sequence[int], point: Mapping[Symbol, Fraction], digits: int
) -> list[Fraction] | None:
    arithmetic = multiprecision(digits)
    values = {s: arithmetic.number(x) for s, x in point.items()}
    try:
        found = graph.evaluate(nodes, values, arithmetic)
    except (ValueError, ZeroDivisionError, OverflowError):  # a pole, or log 0
        return None
    if not all(hasattr(x, "man_exp") and math.isfinite(x) for x in found):
        return None
    return [_fraction(x) for x in found]


def _fraction(x: Any) -> Fraction:
    mantissa, exponent = x.man_exp  # of the absolute value
    size = abs(int(mantissa)) * Fraction(2) ** int(exponent)
    return -size if x < 0 else size


def definite_node(graph: Graph, f: Expr, what: str) -> int:
    """Return the node of an expression without arbitrary functions; ``what`` names it in errors."""
    arbitrary = sorted(map(str, sp.sympify(f, strict=True).atoms(AppliedUndef)))
    if arbitrary:
        raise ValueError(
            f"{what} holds the arbitrary function {arbitrary[0]}, which has no numbers: put a definite one in its place"
        )
    return graph.from_sympy(f)
