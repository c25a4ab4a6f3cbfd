"""Where answers have a value, asked of a busy machine: what was not looked at is not known."""

import time

import sympy as sp

from canon.proof.definedness.definedness import lack_beside
from canon.proof.domain.domain import EVERYWHERE


def test_where_the_time_has_ended_nothing_is_said():
    """A worthless answer held on a busy machine: nobody had looked where it has no value."""
    x = sp.Symbol("x", real=True)
    sharp = sp.Piecewise((x, sp.Abs(x) > sp.Rational(1, 10**9)))
    assert lack_beside(sharp, [x], EVERYWHERE, time.monotonic() + 10).proved
    assert not lack_beside(sharp, [x], EVERYWHERE, time.monotonic() - 1).proved
    assert lack_beside(x, [x], EVERYWHERE, time.monotonic() - 1) is None
