"""The numeric rows: close encounters, scales, stiffness, chaos, long runs, many bodies, constraints, events, NaN."""

from __future__ import annotations

from typing import TYPE_CHECKING

from extremes import (
    numeric_chaos,
    numeric_constraints,
    numeric_encounters,
    numeric_events,
    numeric_long,
    numeric_lost_digits,
    numeric_refusals,
    numeric_scales,
    numeric_stiff,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from extremes.row import Row


def rows() -> Iterator[Row]:
    """Yield them all."""
    for part in (
        numeric_encounters,
        numeric_scales,
        numeric_stiff,
        numeric_chaos,
        numeric_long,
        numeric_lost_digits,
        numeric_constraints,
        numeric_events,
        numeric_refusals,
    ):
        yield from part.rows()
