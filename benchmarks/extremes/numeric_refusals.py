"""NaN, inf and nonsense anywhere: each is to be an error that names it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon import (
    Event,
    Hamiltonian,
    Splitting,
    Taylor,
    TimeTransformed,
    coordinates,
    drift,
    parameters,
    propagate,
)
from canon.flow import NonFiniteStateError
from extremes.row import Row, refused

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

x, y = coordinates("x y")
k = parameters("k", positive=True)
SPRING = Hamiltonian(x.momentum**2 / 2 + k * x**2 / 2, [x], [x.momentum])
VERLET = {"method": Splitting("verlet"), "step": 0.1}
NAN, INF = float("nan"), float("inf")


def rows() -> Iterator[Row]:
    """Yield the rows."""
    for name, tried, run in cases():
        yield Row(
            f"nan-{name}",
            tried,
            lambda run=run: refused(run, ValueError, ArithmeticError, NonFiniteStateError),
        )


def cases() -> Iterator[tuple[str, str, Callable[[], Any]]]:
    """Yield what may not pass."""
    for value in (NAN, INF, -INF):
        for kind, how in (
            ("taylor", {}),
            ("verlet", VERLET),
            ("extended", {"precision": "extended"}),
            ("transformed", {"method": TimeTransformed(Splitting("verlet")), "step": 0.1}),
        ):
            yield (
                f"start-{value}-{kind}",
                f"y0 holds {value}, {kind}",
                lambda v=value, h=how: go([v, 0.0], **h),
            )
    yield (
        "start-longdouble",
        "y0 of long doubles with NaN",
        lambda: go(np.array([NAN, 0], dtype=np.longdouble)),
    )
    yield "start-orbit", "one NaN among 1000 orbits", lambda: go(_one_nan(), **VERLET)
    yield "parameter-nan", "a parameter is NaN", lambda: go([1.0, 0.0], numbers={k: NAN})
    yield "parameter-inf", "a parameter is inf", lambda: go([1.0, 0.0], numbers={k: INF})
    yield (
        "parameter-orbit",
        "a parameter by orbit holds NaN",
        lambda: go(np.ones((2, 2)), numbers={k: np.array([1.0, NAN])}, **VERLET),
    )
    yield (
        "parameter-zoo",
        "a parameter is SymPy's complex infinity",
        lambda: go([1.0, 0.0], numbers={k: sp.zoo}),
    )
    yield (
        "parameter-1e400",
        "a parameter is 10⁴⁰⁰",
        lambda: go([1.0, 0.0], numbers={k: sp.Integer(10) ** 400}),
    )
    for value in (NAN, INF, 0.0, -0.1):
        yield (
            f"step-{value}",
            f"step = {value}",
            lambda v=value: go([1.0, 0.0], method=Splitting("verlet"), step=v),
        )
    for value in (NAN, 0.0, -1e-9, 2.0):
        yield f"tolerance-{value}", f"tolerance = {value}", lambda v=value: go([1.0, 0.0], tolerance=v)
    yield "span-inf", "t_span ends at inf", lambda: go([1.0, 0.0], span=(0, INF))
    yield "span-nan", "t_span begins at NaN", lambda: go([1.0, 0.0], span=(NAN, 1))
    yield "times-nan", "times holds NaN", lambda: go([1.0, 0.0], times=[0.5, NAN])
    yield "coefficient-nan", "a splitting's coefficient is NaN", lambda: Splitting(a=[NAN, 1], b=[1])
    yield "hamiltonian-nan", "H holds NaN", lambda: broken(sp.nan)
    yield "hamiltonian-inf", "H holds oo", lambda: broken(sp.oo)
    yield "hamiltonian-complex", "H holds the imaginary unit", lambda: broken(sp.I)
    yield (
        "domain-left",
        "H = p²/2 + x √x leaves its domain",
        lambda: propagate(
            Hamiltonian(x.momentum**2 / 2 + x * sp.sqrt(x), [x], [x.momentum]), (0, 10), [1.0, 0.0]
        ),
    )
    yield (
        "domain-left-verlet",
        "the same with Verlet",
        lambda: propagate(
            Hamiltonian(x.momentum**2 / 2 + x * sp.sqrt(x), [x], [x.momentum]), (0, 10), [1.0, 0.0], **VERLET
        ),
    )
    yield (
        "observable",
        "an observable log(x) where x becomes negative",
        lambda: go([1.0, 0.0], span=(0, 5), observables={"log": sp.log(x)}),
    )
    yield (
        "observable-cadence",
        "the same followed at every step",
        lambda: go([1.0, 0.0], span=(0, 5), observables={"log": sp.log(x)}, cadence=1, samples=2, **VERLET),
    )
    yield (
        "event-infinite",
        "an event 1/x through x = 0",
        lambda: go([1.0, 0.0], span=(0, 5), events=[Event(1 / (x - 1))]),
    )
    yield (
        "explodes",
        "H = p²/2 − x⁴: infinity in finite time",
        lambda: propagate(Hamiltonian(x.momentum**2 / 2 - x**4, [x], [x.momentum]), (0, 10), [1.0, 1.0]),
    )
    yield (
        "explodes-verlet",
        "the same with Verlet",
        lambda: propagate(
            Hamiltonian(x.momentum**2 / 2 - x**4, [x], [x.momentum]), (0, 10), [1.0, 1.0], **VERLET
        ),
    )
    yield (
        "explodes-single",
        "x⁴/4 in single precision from x = 1e12",
        lambda: propagate(
            Hamiltonian(x.momentum**2 / 2 + x**4 / 4, [x], [x.momentum]),
            (0, 1),
            [1e12, 1.0],
            precision="single",
            **VERLET,
        ),
    )
    yield (
        "drift",
        "drift statistics of a series with NaN",
        lambda: drift(np.linspace(0, 1, 500), np.where(np.arange(500) == 77, NAN, 1e-12)),
    )


def go(y0: Any, *, span: tuple[float, float] = (0, 1), numbers: Any = None, **how: Any) -> Any:
    if not how and isinstance(y0, np.ndarray):
        how = {"method": Taylor()}
    return propagate(SPRING, span, y0, parameters={k: 1.0} if numbers is None else numbers, **how).final


def broken(value: Any) -> Any:
    return propagate(
        Hamiltonian(x.momentum**2 / 2 + value * x**2, [x], [x.momentum]), (0, 1), [1.0, 0.0]
    ).final


def _one_nan() -> np.ndarray:
    starts = np.ones((2, 1000))
    starts[1, 617] = NAN
    return starts
