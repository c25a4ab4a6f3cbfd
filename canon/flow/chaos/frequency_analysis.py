"""Frequency analysis: the lines of a quasiperiodic signal to many more digits than its length resolves, Laskar's NAFF.

The signal is multiplied with a window of Hann's kind, (1 + cos)ᵖ, beside which the leakage of other lines falls as
T^(−2p−2); each line is where the windowed transform is largest, found by Newton's method from the nearest place of a
fast Fourier transform. Lines found are taken out with amplitudes fitted together, and each is found anew without the
others.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.chaos.regularity import Regularity

if TYPE_CHECKING:
    import numpy.typing as npt

    from canon.array import Array

__all__ = ["FrequencyAnalysis", "FrequencyDiffusion", "frequency_analysis", "frequency_diffusion"]

_LEAST = 16
"""Samples below which there is nothing to analyse."""

_EVEN = 1e-9
"""In parts of their distance, what sample times may miss."""

_ROUNDS, _NEWTON = 4, 30


@dataclass(frozen=True, eq=False)
class FrequencyAnalysis:
    """Lines of a signal, z(t) ≈ Σ_k a_k exp(i ω_k t), the largest first.

    Parameters
    ----------
    frequencies
        Angular frequencies ω_k, shape (terms,).
    amplitudes
        a_k, complex, shape (terms,), for times as they were given. Of a real signal z = Re Σ a_k exp(i ω_k t), ω_k ≥ 0.
    errors
        How far the windows of powers p and p + 1 differ on ω_k, or what the rest of the signal beside the line moves it
        by where that is more, shape (terms,): the leakage of lines that were not taken out, and noise. It is no less
        than rounding makes of it.
    residual
        What is left of the signal's root mean square, in parts of it.
    """

    frequencies: Array
    amplitudes: npt.NDArray[np.complex128]
    errors: Array
    residual: float

    @property
    def digits(self) -> Array:
        """Decimal digits of each frequency that can be relied on."""
        with np.errstate(divide="ignore"):
            return np.log10(np.abs(self.frequencies) / self.errors).clip(0, 16)

    def __repr__(self) -> str:
        lines = [f"{w:.{max(1, round(d))}g}" for w, d in zip(self.frequencies, self.digits, strict=True)]
        more = ", …" if len(lines) > 4 else ""
        return f"<FrequencyAnalysis: {', '.join(lines[:4])}{more}; {self.residual:.2g} left>"


def frequency_analysis(
    t: npt.ArrayLike, values: npt.ArrayLike, *, terms: int = 1, window: int = 2
) -> FrequencyAnalysis:
    """Return the largest lines of a signal at evenly spaced times.

    Parameters
    ----------
    t
        Times, evenly spaced to 10⁻⁹ of their distance, shape (times,); of a motion back in time they fall. Those of
        ``propagate`` are where Taylor() or DOP853() carried the motion, and with fixed steps where ``samples`` divides
        the number of steps: give ``span = samples * k * step`` with a whole k.
    values
        The signal, complex such as q − i p, in which a motion q = cos ωt has the one line ω, or real, shape (times,).
        Lines above π over the distance of two times are taken for lower ones.
    terms
        How many lines; fewer are found where nothing but rounding is left.
    window
        The power p of Hann's window, 1 … 5. Higher ones leak less and tell near lines apart later: two lines should
        differ by more than 4π(p + 1)/T.

    Raises
    ------
    ValueError
        There are fewer than 16 times, they are not evenly spaced, or a value is not finite.

    References
    ----------
    J. Laskar, Frequency analysis for multi-dimensional systems. Global dynamics and diffusion, Physica D 67 (1993)
    257–281, doi:10.1016/0167-2789(93)90210-R. The lines are found anew without the others as in M. Šidlichovský,
    D. Nesvorný, Celest. Mech. Dyn. Astron. 65 (1996) 137–148, doi:10.1007/BF00048443.

    Examples
    --------
    >>> t = np.linspace(0, 400, 2001)
    >>> found = frequency_analysis(t, np.exp(1j * t) + 0.25 * np.exp(-0.618j * t), terms=2)
    >>> bool(abs(found.frequencies[0] - 1) < 1e-11), found.amplitudes.round(9).real.tolist()
    (True, [1.0, 0.25])
    """
    times, signal = _checked(t, values)
    if terms not in range(1, len(times) // 4 + 1) or window not in range(1, 6):
        raise ValueError(
            f"terms={terms}, window={window}: give 1 … {len(times) // 4} terms and a window of power 1 … 5"
        )
    middle = (times[0] + times[-1]) / 2
    own = _Signal(times - middle, signal, real=not np.iscomplexobj(signal))
    found = own.lines(terms, window)
    finer = own.found_anew(found, window + 1)
    amplitudes = own.amplitudes(found, window)
    left = signal - own.sum_of(found, amplitudes)
    size = float(np.sqrt(np.mean(np.abs(signal) ** 2)))
    rounding = 2.0**-52 * np.maximum(np.abs(found), 1 / (times[-1] - times[0]))
    order = np.argsort(-np.abs(amplitudes), kind="stable")
    turned = amplitudes * np.exp(-1j * found * middle)
    moved = np.maximum(np.abs(finer - found), own.moved_by(left, found, amplitudes, window))
    return FrequencyAnalysis(
        found[order],
        turned[order],
        np.maximum(moved, rounding)[order],
        float(np.sqrt(np.mean(np.abs(left) ** 2))) / size if size else 0.0,
    )


@dataclass(frozen=True)
class FrequencyDiffusion:
    """How far the main frequency of a motion moves from the first half of a run to the second.

    Parameters
    ----------
    first, second
        The main frequency in the first half, and the line next to it among the largest three of the second.
    error
        How exactly each is known, the larger of the two.
    rate
        The size of second − first per unit of time.
    verdict
        ``CHAOTIC`` where it moves by more than its error and twice the distance that half of the run
        resolves, ``REGULAR`` where by less than a thousandth of that distance.
    detection_limit
        A rate above this one would have been found.
    reason
        Why the verdict, in words.
    """

    first: float
    second: float
    error: float
    rate: float
    verdict: Regularity
    detection_limit: float
    reason: str


_MOVES, _STAYS = 2.0, 1e-3
"""In parts of 2π over half of the time. Regular orbits whose lines are too near to be told apart move by up to 1.4."""


_STRAIGHT = 0.05
"""A signal of which a straight line leaves a smaller part goes on, or has a period of ten times the span."""


def frequency_diffusion(t: npt.ArrayLike, values: npt.ArrayLike, *, window: int = 2) -> FrequencyDiffusion:
    """Return how far the main frequency of a signal moves from the first half of the times to the second.

    Beside regular motion it stays; chaotic motion diffuses in frequency. The mean is taken out first.

    Parameters
    ----------
    t, values, window
        As :func:`frequency_analysis` takes them.

    Raises
    ------
    ValueError
        As :func:`frequency_analysis`; the signal is constant.

    References
    ----------
    J. Laskar, The chaotic motion of the solar system. A numerical estimate of the size of the chaotic zones, Icarus 88
    (1990) 266–291, doi:10.1016/0019-1035(90)90084-M.

    Examples
    --------
    >>> t = np.linspace(0, 1000, 4001)
    >>> frequency_diffusion(t, np.cos(1.25 * t) + 0.1 * np.cos(3 * t)).verdict
    <Regularity.REGULAR: 'regular'>
    >>> frequency_diffusion(t, np.cos(1.25 * t + 1e-4 * t**2)).verdict
    <Regularity.CHAOTIC: 'chaotic'>
    """
    times, signal = _checked(t, values)
    if not np.ptp(np.abs(signal - signal[0])):
        raise ValueError("the signal is constant, and has no frequency")
    half = len(times) // 2 + 1
    halves = [(times[:half], signal[:half]), (times[-half:], signal[-half:])]
    weights = _window(half, window)
    found = [
        frequency_analysis(a, z - np.average(z, weights=weights), terms=3, window=window) for a, z in halves
    ]
    first = float(found[0].frequencies[0])
    # Of two lines nearly alike the other may be the larger one in the second half.
    same = int(np.argmin(np.abs(found[1].frequencies - first)))
    second, error = float(found[1].frequencies[same]), float(max(found[0].errors[0], found[1].errors[same]))
    span = float(times[-1] - times[0]) / 2
    moved, unit = abs(second - first), 2 * math.pi / span
    verdict = Regularity.NOT_KNOWN
    if moved > max(_MOVES * unit, 2 * error):
        verdict = Regularity.CHAOTIC
    elif moved < _STAYS * unit:
        verdict = Regularity.REGULAR
    reason = f"from {first:.9g} to {second:.9g} (± {error:.1g}), {moved / unit:.2g} of what half of the run resolves"
    return FrequencyDiffusion(first, second, error, moved / span, verdict, _MOVES * unit / span, reason)


def _checked(t: npt.ArrayLike, values: npt.ArrayLike) -> tuple[Array, npt.NDArray[Any]]:
    times, signal = np.asarray(t, dtype=np.float64), np.asarray(values)
    if times.ndim != 1 or times.shape != signal.shape or len(times) < _LEAST:
        raise ValueError(
            f"times of shape {times.shape} and values of shape {signal.shape}: give one value at each of at least "
            f"{_LEAST} times"
        )
    signal = signal.astype(np.complex128 if np.iscomplexobj(signal) else np.float64)
    if not (np.isfinite(times).all() and np.isfinite(signal).all()):
        raise ValueError("a time or a value is not finite")
    if times[-1] < times[0]:  # a motion back in time
        times, signal = times[::-1], signal[::-1]
    even = np.linspace(times[0], times[-1], len(times))
    if not np.abs(times - even).max() <= _EVEN * abs(even[1] - even[0]):
        raise ValueError(
            "the times are not evenly spaced: take samples= that divides the number of steps, or Taylor(), which is "
            "sampled anywhere"
        )
    if _goes_on(even, signal):
        raise ValueError(
            "the signal goes on in one direction, as an angle that turns does, and has no lines: give the sine of the "
            "angle, or np.exp(1j * angle)"
        )
    return times, signal


def _goes_on(t: Array, signal: npt.NDArray[Any]) -> bool:
    """Tell whether a straight line is nearly all of a signal."""
    if np.iscomplexobj(signal):
        return False
    beside = signal - np.polynomial.Polynomial.fit(t, signal, 1)(t)
    return bool(np.std(beside) < _STRAIGHT * np.std(signal))


def _window(count: int, power: int) -> Array:
    """Return Hann's window to a power, with the mean 1."""
    whole = (1 + np.cos(np.linspace(-np.pi, np.pi, count))) ** power
    return whole / whole.mean()


class _Signal:
    """A signal at times evenly spaced about 0."""

    def __init__(self, t: Array, values: npt.NDArray[Any], *, real: bool) -> None:
        self.t, self.values, self.real = t, values, real

    def lines(self, terms: int, power: int) -> Array:
        """Return the frequencies of the largest lines, each found anew after the others have been taken out."""
        found = np.empty(0)
        floor = 2.0**-50 * float(np.abs(self.values).max())
        left = self.values
        for _ in range(terms):
            if float(np.abs(left).max()) <= floor:
                break
            more = np.append(found, self._nearest(left, power))
            for _ in range(_ROUNDS if len(more) > 1 else 1):
                more = self.found_anew(more, power)
            # What is left beside a line may be its own rounding, or a line that cannot be told from it.
            if len(more) > 1 and np.diff(np.sort(more)).min() < math.pi / (self.t[-1] - self.t[0]):
                break
            found = more
            left = self.values - self.sum_of(found, self.amplitudes(found, power))
        return found if len(found) else np.zeros(1)

    def found_anew(self, lines: Array, power: int) -> Array:
        """Return each line as it is found where the others have been taken out."""
        amplitudes = self.amplitudes(lines, power)
        whole = self.sum_of(lines, amplitudes)
        found = lines.copy()
        for k in range(len(lines)):
            own = self.sum_of(lines[[k]], amplitudes[[k]])
            found[k] = self._refined(self.values - whole + own, lines[k], power)
        return found

    def amplitudes(self, lines: Array, power: int) -> npt.NDArray[np.complex128]:
        """Return the amplitudes of lines, fitted together with the window as weights."""
        basis = self._basis(lines)
        root = np.sqrt(_window(len(self.t), power))[:, np.newaxis]
        fitted = np.linalg.lstsq(root * basis, root[:, 0] * self.values, rcond=None)[0]
        if not self.real:
            return fitted.astype(np.complex128)
        return fitted[: len(lines)] - 1j * fitted[len(lines) :]

    def sum_of(self, lines: Array, amplitudes: npt.NDArray[np.complex128]) -> npt.NDArray[Any]:
        """Return the signal that lines make."""
        if self.real:
            return self._basis(lines) @ np.concatenate([amplitudes.real, -amplitudes.imag])
        return self._basis(lines) @ amplitudes

    def moved_by(
        self, left: npt.NDArray[Any], lines: Array, amplitudes: npt.NDArray[np.complex128], power: int
    ) -> Array:
        """Return by how much a rest of the signal moves lines.

        A disturbance r moves the place where Σ w z exp(−iωt) is largest by |Σ w t r exp(−iωt)| / (|a| Σ w t²). At the
        line itself r has lost what the line could take of it; beside it, within the window's width, noise is as large.
        """
        weights = _window(len(self.t), power) * self.t
        spread = float(np.sum(weights * self.t))
        width = 2 * np.pi / (self.t[-1] - self.t[0])
        beside = width * np.array([k for k in range(-power - 2, power + 3) if k])
        sizes = np.abs(amplitudes) / (2 if self.real else 1)
        moments = [
            max(abs(np.sum(weights * left * np.exp(-1j * (w + d) * self.t))) for d in beside) for w in lines
        ]
        return np.divide(moments, sizes * spread, out=np.zeros(len(lines)), where=sizes > 0)

    def _basis(self, lines: Array) -> npt.NDArray[Any]:
        angles = self.t[:, np.newaxis] * lines
        return np.concatenate([np.cos(angles), np.sin(angles)], axis=1) if self.real else np.exp(1j * angles)

    def _nearest(self, values: npt.NDArray[Any], power: int) -> float:
        """Return the place of the largest value of a windowed Fourier transform, twice as fine as its own."""
        count = 2 * len(values)
        found = np.abs(np.fft.fft(_window(len(values), power) * values, count))
        places = 2 * np.pi * np.fft.fftfreq(count, self.t[1] - self.t[0])
        if self.real:
            found[places < 0] = 0
        return float(places[np.argmax(found)])

    def _refined(self, values: npt.NDArray[Any], near: float, power: int) -> float:
        """Return where the windowed transform is largest, by Newton's method on the slope of its square."""
        weights = _window(len(values), power) * values
        width = 2 * np.pi / (self.t[-1] - self.t[0])
        w = near
        for _ in range(_NEWTON):
            turned = weights * np.exp(-1j * w * self.t)
            moments = [np.sum(turned), np.sum(-1j * self.t * turned), np.sum(-(self.t**2) * turned)]
            slope = 2 * float(np.real(np.conj(moments[0]) * moments[1]))
            curve = 2 * float(np.real(np.conj(moments[0]) * moments[2]) + np.abs(moments[1]) ** 2)
            # Where the square is not curved as at a maximum, a part of the width towards it.
            change = -slope / curve if curve < 0 else math.copysign(width / 4, slope)
            change = float(np.clip(change, -width / 2, width / 2))
            w += change
            if abs(change) <= 2.0**-52 * max(abs(w), width):
                break
        return w if abs(w - near) <= 2 * width else near
