"""Lyapunov exponents: the mean rates at which deviations from an orbit grow, with errors, from a QR decomposition."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.symbols.user_input import counted
from canon.flow.chaos.regularity import Regularity, judged_growth, of_their_systems, told
from canon.flow.tangent.deviation_frame import random_frame
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

__all__ = ["LyapunovSpectrum", "largest_lyapunov_exponent", "lyapunov_spectrum"]

_ALIGNING = 5
"""The first of so many parts of a run, in which the deviations turn to their directions, counts for no exponent."""

_BLOCKS = (8, 16, 32)
"""Blocks whose growth is compared for the error; the largest is taken, as neighbouring blocks may be alike."""

_SHOWN = 4

_SLOW = 2.0
"""What growth as a power of time leaves of an exponent after the first fifth: ln 5/(4/5) ≈ 2, over the time."""


@dataclass(frozen=True)
class LyapunovSpectrum:
    """Lyapunov exponents of an orbit, or of many, each with its error.

    Parameters
    ----------
    exponents, errors
        λ₁ ≥ λ₂ ≥ …, per unit of time, and their standard errors, shape (vectors,) or (vectors, orbits). The error is
        that of the mean growth of blocks of the run, and 2/T beside it, which growth as a power of time would leave.
    t, history
        Times since the start, and ln of the growth so far over the time: what the exponents came to, shape
        (vectors, times) or (vectors, times, orbits). The exponents leave out the first fifth of the run.
    verdict
        A :class:`canon.flow.Regularity`, or an array of them.
    detection_limit
        An exponent above this one would have been found.
    reason
        Why the verdict, in words, or one for each orbit.
    dimension
        2n, the number of exponents that there are.
    method
        What carried the motion.
    """

    exponents: Array
    errors: Array
    t: Array
    history: Array
    verdict: Regularity | npt.NDArray[Any]
    detection_limit: float
    reason: str | tuple[str, ...]
    dimension: int
    method: str

    def __repr__(self) -> str:
        count = counted(len(self.exponents), "exponent")
        if not isinstance(self.verdict, Regularity):
            return f"<LyapunovSpectrum: {count} of {counted(len(self.verdict), 'orbit')}>"
        shown = [f"{x:.4g} ± {e:.1g}" for x, e in zip(self.exponents, self.errors, strict=True)]
        more = ", …" if len(shown) > _SHOWN else ""
        verdict = told(self.verdict, self.detection_limit)
        return f"<LyapunovSpectrum: {', '.join(shown[:_SHOWN])}{more}; {verdict}>"

    @property
    def largest(self) -> Any:
        """The largest exponent: a number, or one for each orbit."""
        return self.exponents[0]

    @property
    def pairing_defect(self) -> Any:
        """The largest size of λᵢ + λ₂ₙ₊₁₋ᵢ over the run; 0 to round-off for symplectic methods.

        The deviations start as an orthogonal frame that is symplectic, which makes the pairs exact at all times.

        Raises
        ------
        ValueError
            The spectrum is not whole: a pair takes both of its exponents.
        """
        if len(self.exponents) != self.dimension:
            raise ValueError(
                f"{counted(len(self.exponents), 'exponent')} of {self.dimension}: pairs take the whole spectrum, leave "
                "vectors out"
            )
        return np.abs(self.history[:, -1] + self.history[::-1, -1]).max(axis=0)


def lyapunov_spectrum(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
    *,
    method: MethodGiven | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    precision: str | int | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
    vectors: int | None = None,
    samples: int | None = None,
    seed: int = 0,
    progress: Callable[[float], None] | bool | None = None,
) -> LyapunovSpectrum:
    """Return the Lyapunov exponents of an orbit: the mean rates at which deviations from it grow.

    Of splittings, those by solvable parts included, and of Gauss methods deviations are moved by the exact derivative
    of each step, compiled beside the orbit, which is the one that :func:`canon.propagate` gives bit for bit; every so
    many steps they are made orthonormal again, as often as their digits ask for. Other methods carry them as part of a
    larger system.

    Parameters
    ----------
    system
        A Hamiltonian, a map, a scene that has one, a ``Lagrangian`` without forces and constraints in which time does
        not occur, a Poisson system, or a vector field of an even number of variables. The equations of a damped or
        driven system are written as a vector field, ``VectorField([v, force/m], [q, v])``; an odd number of variables
        is made even by one that rests, ``VectorField([…, 0], [x, y, z, rest])``, whose exponent is 0.
    t_span, y0, method, step, tolerance, precision, parameters, progress
        As :func:`canon.propagate` takes them. Many orbits, y0 of shape (2n, orbits) or parameters of shape (orbits,),
        run side by side; one that leaves the finite numbers gets the verdict ``LEFT`` and exponents NaN.
    vectors
        How many exponents, the largest first; all 2n where not given.
    samples
        At how many times the growth is kept; 1000, of many orbits 100, where not given.
    seed
        Of the random directions in which deviations start.

    Returns
    -------
    LyapunovSpectrum
        Exponents with errors, their history, the check of their pairs, and a verdict with its detection limit.

    Raises
    ------
    ValueError
        As ``propagate``; vectors are not 1 … 2n; the method carries no deviations.
    NonFiniteStateError
        The only orbit left the finite numbers: an escape, a collision, or a step too long.

    Notes
    -----
    Exponents do not depend on units, but how soon they are reached does: take units in which coordinates and momenta
    are of one size. Splittings by solvable parts measure lengths in √(mω) q and p/√(mω), which are in any unit, with ω
    a third of a radian a step. λ₁ of a regular orbit comes to 0 as ln T/T.

    References
    ----------
    G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn, Lyapunov characteristic exponents for smooth dynamical
    systems and for Hamiltonian systems, Meccanica 15 (1980) 9–20 and 21–30, doi:10.1007/BF02128236 and BF02128237.

    Examples
    --------
    >>> from canon import Splitting
    >>> found = lyapunov_spectrum("henon-heiles", (0, 2000), "chaotic", method=Splitting("kahan-li-8"), step=0.2)
    >>> found.verdict, bool(0.03 < found.largest < 0.08), bool(found.pairing_defect < 1e-13)
    (<Regularity.CHAOTIC: 'chaotic'>, True, True)
    """
    task = deviation_task(
        DeviationRun(system, t_span, y0, method, step, tolerance, precision, parameters, samples, progress)
    )
    size = len(task.system.rows)
    count = size if vectors is None else vectors
    if count not in range(1, size + 1):
        raise ValueError(f"vectors={vectors}: the system has exponents 1 … {size}")
    growth = deviation_growth(task, random_frame(size, int(count), seed), orthogonal=True, progress=progress)
    return _spectrum(growth, size)


def largest_lyapunov_exponent(
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
    seed: int = 0,
    progress: Callable[[float], None] | bool | None = None,
) -> LyapunovSpectrum:
    """Return the largest Lyapunov exponent of an orbit, by one deviation: a spectrum of one exponent.

    Parameters
    ----------
    system, t_span, y0, method, step, tolerance, precision, parameters, samples, seed, progress
        As :func:`lyapunov_spectrum` takes them.

    Raises
    ------
    ValueError, NonFiniteStateError
        As :func:`lyapunov_spectrum`.

    Examples
    --------
    >>> from canon import Splitting
    >>> largest_lyapunov_exponent("henon-heiles", (0, 2000), method=Splitting("kahan-li-8"), step=0.2).verdict
    <Regularity.REGULAR: 'regular'>
    """
    return lyapunov_spectrum(
        system, t_span, y0, method=method, step=step, tolerance=tolerance, precision=precision,
        parameters=parameters, vectors=1, samples=samples, seed=seed, progress=progress,
    )  # fmt: skip


def _spectrum(growth: DeviationGrowth, size: int) -> LyapunovSpectrum:
    t, log = growth.t, growth.log
    judged = of_their_systems(judged_growth(t, log[0]), growth)
    begin = len(t) // _ALIGNING
    exponents = (log[:, -1] - log[:, begin]) / (t[-1] - t[begin])
    errors = np.hypot(_error(t[begin:], log[:, begin:]), _SLOW / t[-1])
    history = np.zeros_like(log)
    history[:, 1:] = log[:, 1:] / t[1:, np.newaxis]
    only = 0 if growth.single else slice(None)
    # Where all are near zero the vectors have not settled into their order.
    falling = np.argsort(-exponents, axis=0, kind="stable")
    return LyapunovSpectrum(
        np.take_along_axis(exponents, falling, 0)[:, only],
        np.take_along_axis(errors, falling, 0)[:, only],
        t,
        np.take_along_axis(history, falling[:, np.newaxis], 0)[:, :, only],
        judged.verdicts[only],
        judged.detection_limit,
        judged.reasons[only],
        size,
        growth.method,
    )


def _error(t: Array, log: Array) -> Array:
    """Return the standard errors of mean growth, shape (vectors, orbits)."""
    found: list[Array] = []
    for blocks in _BLOCKS:
        ends = np.linspace(0, len(t) - 1, blocks + 1).round().astype(int)
        rates = np.diff(log[:, ends], axis=1) / np.diff(t[ends])[:, np.newaxis]
        found.append(rates.std(axis=1, ddof=1) / np.sqrt(blocks))
    return np.max(found, axis=0)
