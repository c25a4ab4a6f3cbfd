"""Events that touch, come together, come at the start, pile up."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from mpmath import mp, mpf

from canon import Event, Hamiltonian, Splitting, coordinates, propagate
from canon.flow import NonFiniteStateError
from extremes.row import Outcome, Row, refused

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

x, y = coordinates("x y")
OSCILLATOR = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])
FREE = Hamiltonian(x.momentum**2 / 2, [x], [x.momentum])
FALLING = Hamiltonian(x.momentum**2 / 2 + x, [x], [x.momentum])
METHODS = {"taylor": {}, "split": {"method": Splitting("kahan-li-8"), "step": 0.1}}


def rows() -> Iterator[Row]:
    """Yield the rows."""
    for kind, how in METHODS.items():
        yield Row(
            f"event-touch-{kind}",
            f"an oscillator of amplitude 1 touches x − 1 = 0 and turns back: nothing is crossed, {kind}",
            lambda how=how: touch(how),
            scipy_events([lambda _t, s: s[0] - 1], "touches"),
        )
        yield Row(
            f"event-near-touch-{kind}",
            f"it passes x = 1 − 1e-10 for 2.8e-5 of time, once a period, {kind}",
            lambda how=how: near_touch(how),
            scipy_events([lambda _t, s: s[0] - (1 - 1e-10)], "crosses 9 times"),
        )
        yield Row(
            f"event-many-{kind}",
            f"sin(40 x) of a free particle, v = 1, changes sign 1273 times in t = 0 … 100 ({kind}: h = 0.1)",
            lambda how=how: many(how),
        )
        yield Row(
            f"event-start-{kind}",
            f"an event exactly at the start is none, the next after half a period, {kind}",
            lambda how=how: at_start(how),
        )
        yield Row(
            f"event-simultaneous-{kind}",
            f"three events at the same instant, {kind}",
            lambda how=how: simultaneous(how),
        )
        yield Row(
            f"event-last-{kind}", f"an event at the very end of the span, {kind}", lambda how=how: at_end(how)
        )
        yield Row(
            f"event-zeno-{kind}",
            f"a ball that keeps half its speed at each bounce: infinitely many by t = 3√2, {kind}",
            lambda how=how: refused(lambda: zeno(how), NonFiniteStateError, holds="pile up"),
        )
        yield Row(
            f"event-corner-{kind}",
            f"a ball into a corner: two walls in the same step, 20 000 bounces, {kind}",
            lambda how=how: corner(how),
            limit=120,
        )
        yield Row(
            f"event-nan-{kind}",
            f"an event log(x) on a motion through x = 0, {kind}",
            lambda how=how: refused(
                lambda: run(OSCILLATOR, [1.0, 0.0], 5, how, Event(sp.log(x))).events,
                NonFiniteStateError,
                ArithmeticError,
                ValueError,
            ),
        )


def run(H: Hamiltonian, y0: Sequence[float], until: float, how: dict[str, object], *events: Event) -> object:
    return propagate(H, (0, until), y0, events=events, samples=4, **how)


def _times(motion: object, true: Sequence[float]) -> Outcome:
    times = [met.t for met in motion.events]
    if len(times) != len(true):
        return Outcome(f"{len(times)} events rather than {len(true)}", right=False)
    error = max((abs(float(mpf(a) - b)) for a, b in zip(times, true, strict=True)), default=0.0)
    stated = float(np.max(motion.error_estimate().events, initial=0.0))
    return Outcome(f"{len(times)} events", error, stated)


def touch(how: dict[str, object]) -> Outcome:
    motion = run(OSCILLATOR, [0.0, 1.0], 50, how, Event(x - 1))
    # Where rounding carries the motion over 1, it is by less than 1e-15, for less than 1e-7 of time.
    met = [m.t for m in motion.events]
    away = [abs((t - np.pi / 2) / (2 * np.pi) - round((t - np.pi / 2) / (2 * np.pi))) for t in met]
    return Outcome(
        f"{len(met)} crossings" + (", each within 1e-7 of the touch" if met else ""),
        right=not met or max(away) < 1e-7,
    )


def near_touch(how: dict[str, object]) -> Outcome:
    level = sp.Rational(1) - sp.Rational(1, 10**10)
    motion = run(OSCILLATOR, [0.0, 1.0], 50, how, Event(x - level))
    with mp.workdps(40):
        a = mp.asin(1 - mpf(10) ** -10)
        true = [k * 2 * mp.pi + s for k in range(8) for s in (a, mp.pi - a) if k * 2 * mp.pi + s < 50]
    return _times(motion, true)


def many(how: dict[str, object]) -> Outcome:
    motion = run(FREE, [0.0, 1.0], 100, how, Event(sp.sin(40 * x)))
    true = [k * mp.pi / 40 for k in range(1, int(4000 / np.pi) + 1)]
    return _times(motion, true)


def at_start(how: dict[str, object]) -> Outcome:
    motion = run(OSCILLATOR, [0.0, 1.0], 7, how, Event(x))
    return _times(motion, [mp.pi, 2 * mp.pi])


def simultaneous(how: dict[str, object]) -> Outcome:
    motion = run(FREE, [-1.0, 1.0], 2, how, Event(x), Event(2 * x), Event(x**3 + x))
    return _times(motion, [mpf(1)] * 3)


def at_end(how: dict[str, object]) -> Outcome:
    motion = run(FREE, [-1.0, 1.0], 1, how, Event(x))
    met = [m.t for m in motion.events]
    return Outcome(f"events at {met}", right=met in ([], [1.0]))


def zeno(how: dict[str, object]) -> object:
    return run(FALLING, [1.0, 0.0], 10, how, Event(x, -1, {x.momentum: -x.momentum / 2})).events[-1]


def corner(how: dict[str, object]) -> Outcome:
    """Diagonally in the unit square with two walls moving by nothing: x and y at once in every corner."""
    H = Hamiltonian((x.momentum**2 + y.momentum**2) / 2, [x, y], [x.momentum, y.momentum])
    walls = [
        Event(x, -1, "bounce"),
        Event(y, -1, "bounce"),
        Event(1 - x, -1, "bounce"),
        Event(1 - y, -1, "bounce"),
    ]
    motion = run(H, [0.5, 0.5, 1.0, 1.0], 500, how, *walls)
    place = 0.5 + 500.0
    folded = 1 - abs(1 - place % 2)
    error = float(abs(motion.final[:2] - folded).max())
    return Outcome(
        f"{len(motion.events)} bounces, energy error {abs(motion.energy_error).max():.0e}",
        error,
        float(motion.error_estimate().error[:2, -1].max()) + 1e-15,
    )


def scipy_events(
    functions: Sequence[Callable[[float, np.ndarray], float]], expected: str
) -> dict[str, Callable[[], Outcome]]:
    def found() -> Outcome:
        from scipy.integrate import solve_ivp

        made = solve_ivp(
            lambda _t, s: [s[1], -s[0]],
            (0, 50),
            [0.0, 1.0],
            method="DOP853",
            rtol=1e-12,
            atol=1e-12,
            events=functions,
        )
        return Outcome(f"{len(made.t_events[0])} events ({expected})", right=None)

    return {"SciPy DOP853": found}
