"""Resolution of the numbers: the least relative error that a motion in some precision can be promised to have.

Every step of a method is rounded, and so are its coefficients: a drift may be longer by a part u of it than the kick
beside it, which moves the energy to and fro by such a part of its terms whatever the step. What is kept beside the
doubles by compensation does not change that. A pilot run may err less by luck; with a step that differs in its last
digit it would not.
"""

from __future__ import annotations

from canon.flow.method.number_formats import unit_round_off

__all__ = ["RESOLVED", "least_error"]

RESOLVED = 0.5
"""Least relative error in units of rounding, the most that rounding a number changes it by: the few roundings that
remain whatever the step do not all cancel."""


def least_error(precision: str) -> float:
    """Return the least error that is promised in a precision.

    Examples
    --------
    >>> least_error("compensated") == least_error("double") == 2.0**-54
    True
    """
    return RESOLVED * unit_round_off(precision)
