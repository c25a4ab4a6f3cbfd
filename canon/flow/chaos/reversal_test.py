"""Reversal test: how far from its start an orbit arrives that runs forward and back, which rounding alone decides."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.chaos.chaos_indicators import ChaosIndicator, indicator_of
from canon.flow.chaos.regularity import Judged, Regularity
from canon.flow.geometry.flow_jacobian import reversal_error
from canon.flow.method.energy_keeping_method import AverageVectorField
from canon.flow.method.method import Gauss, Splitting
from canon.flow.method.method_text import method_of
from canon.flow.request import Request
from canon.flow.system_request import any_task
from canon.flow.tangent.deviation_growth import DeviationGrowth
from canon.flow.tangent.growth_without_chaos import rests_or_is_linear
from canon.kernel.program.hamilton_equations import exact_number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Symbol

    from canon.array import Array
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.system.recognised_system import MovableSystem

__all__ = ["reversal_test"]

_SPANS = 8
"""Spans tried, each half of the next."""

_POWER = 1.5
"""Rounding makes a random walk of the actions, and with it angles err as the steps to this power."""

_REGULAR, _CHAOTIC = 1.0, 6.0
"""ln of the error over that of rounding: up to the one regular, from the other chaotic."""

_LATE, _LOST = 6.0, 1e-2
"""ln of the growth of the error from a quarter of the span on, of which a power has 2; the error of an orbit that has
forgotten where it came from."""


def reversal_test(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
    *,
    method: MethodGiven,
    step: float,
    parameters: Mapping[Symbol | str, Any] | None = None,
) -> ChaosIndicator:
    """Return how far from its start an orbit arrives that runs forward and back, for spans up to the whole.

    A symmetric method would return exactly if it did not round. What rounding does grows as a power of the number of
    steps, up to 3/2, beside regular motion, and as exp λt in chaos. It takes no tangent map. The error is that of the
    state, q and p together, in parts of its size. Within a millionth of a separatrix a regular orbit is enlarged at
    each passage of the saddle, and may be called chaotic.

    Parameters
    ----------
    system, t_span, y0, parameters
        As :func:`canon.propagate` takes them; many orbits too.
    method, step
        A symmetric method of fixed steps: a splitting, a Gauss or an average vector field method. It runs in plain
        doubles.

    Returns
    -------
    ChaosIndicator
        Its history is the error for spans T/128, …, T/2, T.

    Raises
    ------
    ValueError
        As ``propagate``; the method is not symmetric; there are so many steps that rounding alone hides chaos.
    NonFiniteStateError
        An orbit left the finite numbers.

    References
    ----------
    F. Panichi, K. Goździewski, G. Turchetti, The reversibility error method (REM): a new, dynamical fast indicator for
    planetary dynamics, Mon. Not. R. Astron. Soc. 468 (2017) 469–491, doi:10.1093/mnras/stx374.

    Examples
    --------
    >>> from canon import Splitting
    >>> how = dict(method=Splitting("verlet"), step=0.1)
    >>> [reversal_test("henon-heiles", (0, 800), name, **how).verdict.value for name in ("regular", "chaotic")]
    ['regular', 'chaotic']
    """
    chosen = method_of(method)
    _check_symmetric(chosen)
    task, moving = any_task(
        Request(
            system, t_span, y0, method=chosen, step=step, parameters=parameters, precision="double", samples=1
        )
    )
    rows = task.system.rows if moving is None else list(range(len(moving.state)))
    size = np.maximum(np.linalg.norm(task.states[0][rows], axis=0), 1e-300)
    begin, end = (exact_number(t, "t_span") for t in t_span)
    steps = task.plan.stops[-1]
    floor = np.log(2.0**-53) + _POWER * math.log(steps)
    if floor + _CHAOTIC > 0:
        raise ValueError(
            f"{steps} steps: rounding alone may have turned the whole orbit; run fewer, or take lyapunov_spectrum"
        )
    found: list[Array] = []
    for halvings in range(_SPANS - 1, -1, -1):
        part = begin + (end - begin) / 2**halvings
        missed = reversal_error(
            system, (begin, part), y0, method=chosen, step=step, parameters=parameters, precision="double"
        )
        missed = missed.reshape(len(missed), -1)
        found.append(np.linalg.norm(missed, axis=0) / size)
    history = np.array(found)
    spans = np.array([abs(float(end - begin)) / 2**halvings for halvings in range(_SPANS - 1, -1, -1)])
    growth = DeviationGrowth(
        spans,
        history[np.newaxis],
        None,
        np.empty(0),
        np.empty(0),
        task.single,
        str(chosen),
        np.zeros(len(size)),
        rests_or_is_linear(task),
    )
    return indicator_of("reversal error", growth, history, _judged(history, floor, float(spans[-1])))


def _judged(history: Array, floor: float, span: float) -> Judged:
    log = np.log(np.maximum(history, 1e-300))
    error, excess, late = history[-1], log[-1] - floor, log[-1] - log[-3]
    verdicts = np.full(len(error), Regularity.NOT_KNOWN, dtype=object)
    verdicts[excess < _REGULAR] = Regularity.REGULAR
    # One passage near a saddle enlarges the error once; chaos goes on to do so, up to the size of the motion.
    verdicts[(excess > _CHAOTIC) & ((late > _LATE) | (error > _LOST))] = Regularity.CHAOTIC
    reasons = tuple(
        f"it misses its start by {e:.2g} of its size, e^{x:.2g} of what rounding does beside regular motion"
        for e, x in zip(error, excess, strict=True)
    )
    limit = (floor - np.log(2.0**-53) + _CHAOTIC) / span
    return Judged(verdicts, float(limit), reasons)


def _check_symmetric(method: Any) -> None:
    if isinstance(method, Gauss | AverageVectorField):
        return
    if isinstance(method, Splitting):
        a, b = method.scheme.a, method.scheme.b
        if a == a[::-1] and b == b[::-1]:
            return
    raise ValueError(
        f"{method} is not symmetric, so that its own error and not rounding parts the way back from the way there: "
        "take Splitting('verlet'), Splitting('kahan-li-8') or Gauss(6)"
    )
