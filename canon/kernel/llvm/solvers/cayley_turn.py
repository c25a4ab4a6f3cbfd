"""Cayley's turn, y ← y + s K (y + K y) with s = 2/(1 + |k|²), for K³ = −|k|² K: a turn whatever k is, by 2 atan |k|.

What rounding takes from s and from K y would make every turn by the same angle a little too long or too short, which
adds up: where round-off is carried along, both are worked out in two numbers.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.formulas import LaneFormulas
from canon.kernel.llvm.loop import increase

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.kernel.llvm.writer import Writer

__all__ = ["across", "turn_factor", "write_turn"]

Entry = tuple[int, int, str]
"""Components i and j, and k with Kᵢⱼ = −k, Kⱼᵢ = k."""


def turn_factor(w: Writer, k: Sequence[str]) -> tuple[str, str]:
    """Write s = 2/(1 + Σ kᵢ²), and what it lacks."""
    f, two = LaneFormulas(w), w.constant(Fraction(2))
    square, rest = f.zero, f.zero
    for each in k:
        product = f.mul(each, each)
        square, slip = f.two_sum(square, product)
        rest = f.add(rest, f.add(slip, f.fma(each, each, f.neg(product))))
    length, slip = f.two_sum(f.one, square)
    s, rest = f.div(two, length), f.add(slip, rest)
    return s, f.div(f.sub(f.fma(f.neg(s), length, two), f.mul(s, rest)), length)


def write_turn(w: Writer, y: str, e: str, entries: Sequence[Entry], factor: tuple[str, str]) -> None:
    """Write a turn of components of y with their compensation e, or "" where there is none."""
    f, (s, lost) = LaneFormulas(w), factor
    old = {i: w.load(y, i) for entry in entries for i in entry[:2]}
    if not e:
        halfway = {i: f.add(old[i], moved) for i, moved in across(f, entries, old).items()}
        for i, moved in across(f, entries, halfway).items():
            increase(w, y, "", str(i), s, moved)
            increase(w, y, "", str(i), lost, moved)
        return
    once, rest = _across_exactly(f, entries, old, {i: w.load(e, i) for i in old})
    twice = across(f, entries, once)
    for i, moved in once.items():
        total, slip = f.two_sum(moved, twice[i])
        small = f.fma(s, f.add(slip, rest[i]), f.mul(lost, total))
        w.store(f.add(w.load(e, i), small), e, i)
        increase(w, y, e, str(i), s, total)


def across(f: LaneFormulas, entries: Sequence[Entry], y: dict[int, str]) -> dict[int, str]:
    """Write K y."""
    total = dict.fromkeys(y, f.zero)
    for i, j, k in entries:
        total[i] = f.fma(f.neg(k), y[j], total[i])
        total[j] = f.fma(k, y[i], total[j])
    return total


def _across_exactly(
    f: LaneFormulas, entries: Sequence[Entry], y: dict[int, str], e: dict[int, str]
) -> tuple[dict[int, str], dict[int, str]]:
    """Write K (y + e) as sums of two numbers."""
    total, rest = dict.fromkeys(y, f.zero), dict.fromkeys(y, f.zero)
    for i, j, k in entries:
        for moved, by, factor in ((i, j, f.neg(k)), (j, i, k)):
            product = f.mul(factor, y[by])
            total[moved], slip = f.two_sum(total[moved], product)
            small = f.add(slip, f.fma(factor, y[by], f.neg(product)))
            rest[moved] = f.add(rest[moved], f.fma(factor, e[by], small))
    return total, rest
