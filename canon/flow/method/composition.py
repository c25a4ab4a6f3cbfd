"""Symmetric compositions of steps of order 2: which lengths give the orders 4, 6 and 8."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.kernel.schemes.splitting_schemes import SCHEMES

if TYPE_CHECKING:
    from fractions import Fraction

__all__ = ["COMPOSITIONS", "check_order", "weights_of_order"]

COMPOSITIONS = {2: "verlet", 4: "suzuki-4", 6: "kahan-li-6", 8: "kahan-li-8"}
"""The scheme whose kicks are the lengths of the steps of order 2 that a method of each order is composed of."""


def weights_of_order(order: int) -> tuple[Fraction, ...]:
    """Return the lengths, in steps, of the steps of order 2 that a method of an order is composed of."""
    return SCHEMES[COMPOSITIONS[order]].b


def check_order(order: int, method: str) -> None:
    """Refuse an order that no composition has.

    Raises
    ------
    ValueError
        No such order.

    Examples
    --------
    >>> check_order(3, "Rattle")
    Traceback (most recent call last):
        ...
    ValueError: Rattle(3): the order is one of 2, 4, 6, 8
    """
    if order not in COMPOSITIONS:
        raise ValueError(f"{method}({order!r}): the order is one of {', '.join(map(str, COMPOSITIONS))}")
