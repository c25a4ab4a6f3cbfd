"""Argument types of the command line: numbers, with the range they are to be in."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["seconds", "whole_number"]


def whole_number(most: int) -> Callable[[str], int]:
    """Return what reads a whole number from 1 to ``most``.

    Examples
    --------
    >>> whole_number(256)("4")
    4
    """

    def read(text: str) -> int:
        if not text.isdecimal() or not 1 <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"{text!r} should be a whole number from 1 to {most}")
        return int(text)

    return read


def seconds(most: float = math.inf, *, none: bool = False) -> Callable[[str], float]:
    """Return what reads a number of seconds up to ``most``, and 0 where ``none`` is allowed.

    Examples
    --------
    >>> seconds(none=True)("0")
    0.0
    """
    wanted = "0 or more" if none else "above 0"
    if most < math.inf:
        wanted += f" and up to {most:g}"

    def read(text: str) -> float:
        try:
            found = float(text)
        except ValueError:
            found = math.nan
        if not (0 <= found <= most and math.isfinite(found) and (none or found > 0)):
            raise argparse.ArgumentTypeError(f"{text!r} should be a number of seconds, {wanted}")
        return found

    return read
