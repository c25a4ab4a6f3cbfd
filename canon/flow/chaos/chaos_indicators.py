"""Indicators of chaos from one deviation: MEGNO, and the fast Lyapunov indicator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.symbols.user_input import counted
from canon.flow.chaos.regularity import Judged, Regularity, judged_growth, mean_megno, of_their_systems, told
from canon.flow.tangent.deviation_frame import given_frame, random_vectors
from canon.flow.tangent.deviation_growth import DeviationRun, deviation_growth, deviation_task

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Symbol

    from canon.array import Array
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.system.recognised_system import MovableSystem
    from canon.flow.tangent.deviation_growth import DeviationGrowth

__all__ = ["ChaosIndicator", "fast_lyapunov_indicator", "indicator_of", "megno"]


@dataclass(frozen=True)
class ChaosIndicator:
    """An indicator of chaos of an orbit, or of many.

    Parameters
    ----------
    name
        What it is called.
    value
        What it has come to: a number, or one for each orbit, shape (orbits,).
    t, history
        Times since the start, and what it was at each, shape (times,) or (times, orbits).
    verdict
        A :class:`canon.flow.Regularity`, or an array of them.
    detection_limit
        A rate of parting above this one, per unit of time, would have been found.
    reason
        Why the verdict, in words, or one for each orbit.
    method
        What carried the motion.
    """

    name: str
    value: Any
    t: Array
    history: Array
    verdict: Regularity | npt.NDArray[Any]
    detection_limit: float
    reason: str | tuple[str, ...]
    method: str

    def __repr__(self) -> str:
        if isinstance(self.verdict, Regularity):
            return f"<{self.name} {self.value:.4g}: {told(self.verdict, self.detection_limit)}>"
        kinds = [f"{int((self.verdict == kind).sum())} {kind.value}" for kind in Regularity]
        said = ", ".join(words for words in kinds if not words.startswith("0 "))
        return f"<{self.name} of {counted(len(self.verdict), 'orbit')}: {said}>"


def indicator_of(name: str, growth: DeviationGrowth, history: Array, judged: Judged) -> ChaosIndicator:
    """Return an indicator from its history, shape (times, orbits), and the verdicts."""
    judged = of_their_systems(judged, growth)
    only = 0 if growth.single else slice(None)
    own = history[:, only]
    return ChaosIndicator(
        name,
        own[-1],
        growth.t,
        own,
        judged.verdicts[only],
        judged.detection_limit,
        judged.reasons[only],
        growth.method,
    )


def megno(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
    *,
    method: MethodGiven | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    precision: str | int | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
    samples: int | None = None,
    deviation: npt.ArrayLike | None = None,
    seed: int = 0,
    progress: Callable[[float], None] | bool | None = None,
) -> ChaosIndicator:
    """Return the mean exponential growth factor of nearby orbits, MEGNO, averaged over time.

    Y(t) = (2/t) ∫₀ᵗ (δ̇·δ)/(δ·δ) s ds = 2 (ln δ(t) − the mean of ln δ so far), of which the mean over time is given. It
    comes to 2 beside regular motion whose frequencies depend on the orbit, to 0 where they do not, as of oscillators,
    and grows as λt/2 in chaos.

    Parameters
    ----------
    system, t_span, y0, method, step, tolerance, precision, parameters, samples, seed, progress
        As :func:`canon.flow.lyapunov_spectrum` takes them. A map of many orbits takes y0 of shape (2n, orbits).
    deviation
        The deviation at the start, shape (2n,), in place of a random one; only its direction matters. One of special
        symmetry, such as along the orbit, shows nothing of the chaos about it, and of a regular orbit gives 0.

    Raises
    ------
    ValueError, NonFiniteStateError
        As :func:`canon.flow.lyapunov_spectrum`; the deviation is zero.

    References
    ----------
    P. M. Cincotta, C. Simó, Simple tools to study global dynamics in non-axisymmetric galactic potentials, Astron.
    Astrophys. Suppl. 147 (2000) 205–228, doi:10.1051/aas:2000108.

    Examples
    --------
    >>> from canon import Splitting
    >>> how = dict(method=Splitting("kahan-li-8"), step=0.2)
    >>> megno("henon-heiles", (0, 3000), "regular", **how)
    <MEGNO 2.065: regular, no rate above 0.004>
    >>> megno("henon-heiles", (0, 3000), "chaotic", **how).verdict
    <Regularity.CHAOTIC: 'chaotic'>
    """
    growth = _one_deviation(
        DeviationRun(system, t_span, y0, method, step, tolerance, precision, parameters, samples, progress),
        deviation,
        seed,
    )
    return indicator_of(
        "MEGNO", growth, mean_megno(growth.t, growth.log[0]), judged_growth(growth.t, growth.log[0])
    )


def fast_lyapunov_indicator(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
    *,
    method: MethodGiven | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    precision: str | int | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
    samples: int | None = None,
    deviation: npt.ArrayLike | None = None,
    seed: int = 0,
    progress: Callable[[float], None] | bool | None = None,
) -> ChaosIndicator:
    """Return the fast Lyapunov indicator, the largest ln δ(t)/δ(0) up to the end.

    It grows as ln t beside regular orbits, fastest where they shear most, which shows the web of resonances, and as λt
    in chaos. The verdict is that of the whole history, not of one number.

    Parameters
    ----------
    system, t_span, y0, method, step, tolerance, precision, parameters, samples, deviation, seed, progress
        As :func:`megno` takes them.

    Raises
    ------
    ValueError, NonFiniteStateError
        As :func:`megno`.

    References
    ----------
    C. Froeschlé, E. Lega, R. Gonczi, Fast Lyapunov indicators. Application to asteroidal motion, Celest. Mech. Dyn.
    Astron. 67 (1997) 41–62, doi:10.1023/A:1008276418601.

    Examples
    --------
    >>> from canon import Splitting
    >>> found = fast_lyapunov_indicator("henon-heiles", (0, 3000), "regular", method=Splitting("kahan-li-8"), step=0.2)
    >>> bool(found.value < 10), found.verdict
    (True, <Regularity.REGULAR: 'regular'>)
    """
    growth = _one_deviation(
        DeviationRun(system, t_span, y0, method, step, tolerance, precision, parameters, samples, progress),
        deviation,
        seed,
    )
    log = growth.log[0]
    return indicator_of("FLI", growth, np.maximum.accumulate(log, axis=0), judged_growth(growth.t, log))


def _one_deviation(run: DeviationRun, deviation: npt.ArrayLike | None, seed: int) -> DeviationGrowth:
    task = deviation_task(run)
    size = len(task.system.rows)
    frame = random_vectors(size, 1, seed) if deviation is None else given_frame(deviation, size)
    if frame.shape[1] != 1:
        raise ValueError(f"deviation: {frame.shape[1]} vectors; give one vector, shape ({size},)")
    given = deviation is not None
    return deviation_growth(task, frame, orthogonal=False, given=given, progress=run.progress)
