"""Rest under a drag that falls slower than the speed, as √|v|: it is reached in a finite time, and kept.

There the rate has no Taylor series, and its slope is infinite: equations do not say that v = 0 is the only motion from
there. It is where the drag leads to rest from both sides; where it leads away a body may start at any time. Rest is
told where what is left of the speed is rounding, which may be a while before: |v|^(9/10) takes its time.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from canon.flow.kinked.regime_signs import HELD, put

if TYPE_CHECKING:
    from canon.flow.kinked.place import Place
    from canon.flow.kinked.regime_signs import Signs
    from canon.flow.kinked.regimes import Kinks

__all__ = ["is_kept", "nothing_moves"]

_BESIDE, _NEARER = 2.0**-20, 2.0**-20
"""Where the rate beside rest is looked at, in parts of the largest number of the state, and how much nearer again."""


def nothing_moves(kinks: Kinks, signs: Signs, k: int, at: Place) -> bool:
    """Tell whether a variable stays 0 for ever where it is 0, by its rate there: always, or as all else rests too."""
    rate = kinks.rate_at_rest(signs, k)
    if rate is None or rate == kinks.system.graph.zero:
        return rate is not None
    try:
        resting = kinks.regime(put(signs, k, HELD)).system
    except ZeroDivisionError:  # rates that are infinite there, as of a potential √|x|
        return False
    rates = [rate, *resting.velocity, *resting.force]
    return kinks.system.autonomous and not any(at.values(resting, rates))


def is_kept(kinks: Kinks, k: int, at: Place, forward: int) -> bool:
    """Tell whether staying 0 is the only motion of a variable that nothing moves: what moves it beside 0 leads back.

    It is so too where the rate falls as fast as the variable does, or faster.
    """
    size = float(abs(at.y).max()) or 1.0
    for side in (1, -1):
        far, near = (_rate_beside(kinks, k, at, side * size * part) for part in (_BESIDE, _BESIDE * _NEARER))
        leads_back = near * side * forward <= 0
        if not leads_back and abs(near) > _NEARER * abs(far):
            return False
    return True


def _rate_beside(kinks: Kinks, k: int, at: Place, value: float) -> float:
    row, y, carried = kinks.row(k), at.y.copy(), at.carried.copy()
    y[row], carried[row] = value, 0.0
    rates = [*kinks.system.velocity, *kinks.system.force]
    return replace(at, y=y, carried=carried).value(kinks.system, rates[row])
