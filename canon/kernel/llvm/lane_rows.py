"""Rows of lanes in memory: numbers that lie one by one, read into SIMD lanes and stored from them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from canon.kernel.llvm.writer import Writer

__all__ = ["row_of", "store_row"]


def row_of(w: Writer, v: Writer, table: str, k: int | str) -> str:
    """Read numbers that lie in memory one by one into lanes."""
    lanes = v.number.lanes
    if lanes == 1 or not (v.number.pair or v.number.scalar == "x86_fp80"):
        return v.load(table, k)
    first = w.let(f"mul i64 {k}, {lanes}")
    return v.from_lanes([w.load(table, w.let(f"add i64 {first}, {lane}")) for lane in range(lanes)])


def store_row(w: Writer, v: Writer, value: str, table: str, k: str) -> None:
    """Store lanes as numbers that lie in memory one by one."""
    first = w.let(f"mul i64 {k}, {v.number.lanes}")
    for lane in range(v.number.lanes):
        w.store(v.lane(value, lane), table, w.let(f"add i64 {first}, {lane}"))
