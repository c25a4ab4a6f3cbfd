"""Trajectories, and the energy along them in higher precision than their states."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from canon.expression.arithmetic import FLOAT64, LONGDOUBLE, multiprecision

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.flow.method import Method
    from canon.kernel.machine import MachineType
    from canon.kernel.structure import Equations

__all__ = ["Samples", "Statistics", "Trajectory", "measured", "values_in"]

Array = npt.NDArray[np.float64]

_WIDE = bool(np.finfo(np.longdouble).nmant >= 63)


@dataclass(frozen=True)
class Samples:
    """What an integrator hands back: sampled states and what they cost.

    Parameters
    ----------
    t
        Sample times, shape (times,).
    y
        States, shape (2n, times).
    carried
        What the states are beyond doubles: the state is y + carried, shape (2n, times).
    steps, evaluations
        Steps taken, and evaluations of the force (Taylor: of the series).
    step
        The step size of a fixed-step method.
    cpu_seconds, compile_seconds
        Processor time of the integration, and the wall-clock time that compiling its loop took.
    watched
        Where observables were followed inside the loop: mean, least and greatest change of each between
        samples, shape (observables, 3, times − 1, orbits).
    """

    t: Array
    y: Array
    carried: Array
    steps: int
    evaluations: int
    step: float | None
    cpu_seconds: float
    compile_seconds: float
    watched: Array | None = None


@dataclass(frozen=True)
class Statistics:
    """Changes of a quantity since the start, gathered inside the loop between samples.

    Parameters
    ----------
    mean, least, greatest
        Over the steps watched in each block, from one sample to the next, shape (times − 1,) or
        (times − 1, orbits).
    """

    mean: Array
    least: Array
    greatest: Array

    @property
    def largest(self) -> Array:
        """The largest size of the change in each block."""
        return np.maximum(abs(self.least), abs(self.greatest))

    @property
    def running(self) -> Array:
        """The largest size of the change from the start to the end of each block."""
        return np.maximum.accumulate(self.largest, axis=0)


@dataclass(frozen=True)
class Trajectory:
    """A sampled motion and what it cost.

    Parameters
    ----------
    t
        Sample times, shape (times,).
    y
        States (q, p), shape (2n, times); of many orbits, shape (2n, times, orbits), and so on below.
    carried
        What the states are beyond doubles (compensation, or the digits of a higher precision): the state is
        y + carried, shape (2n, times).
    energy
        H at the samples, evaluated in higher precision than the states and then rounded, shape (times,).
    energy_change
        H − H(start), subtracted before rounding, shape (times,).
    method
        The method that was used.
    precision
        The precision of the states.
    step
        The step size of a fixed-step method, as adjusted to end at the last time; None for adaptive methods.
    steps, evaluations
        Steps taken; evaluations of the force (Taylor: of the series).
    cpu_seconds, compile_seconds
        Processor time of the integration, and the wall-clock time that compiling its loop took, be it now or
        in an earlier call.
    autonomous
        Whether H does not depend on t, so that its change is an error.
    observables, changes
        Values of the observables at the samples, and their changes since the start.
    statistics
        Where ``cadence`` was given: mean, least and greatest change of ``"energy"`` and the observables between
        one sample and the next, by name.
    """

    t: Array
    y: Array
    carried: Array
    energy: Array
    energy_change: Array
    method: Method
    precision: str
    step: float | None
    steps: int
    evaluations: int
    cpu_seconds: float
    compile_seconds: float
    autonomous: bool
    observables: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    changes: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    statistics: Mapping[str, Statistics] = field(default_factory=lambda: MappingProxyType({}))

    def __repr__(self) -> str:
        return (
            f"Trajectory({len(self.q)} degrees of freedom, t = {self.t[0]:g} … {self.t[-1]:g}, "
            f"{len(self.t)} samples, {self.method}, {self.steps} steps, {self.cpu_seconds:.3g} s)"
        )

    @property
    def q(self) -> Array:
        """Coordinates, shape (n, times)."""
        return self.y[: len(self.y) // 2]

    @property
    def p(self) -> Array:
        """Momenta, shape (n, times)."""
        return self.y[len(self.y) // 2 :]

    @property
    def final(self) -> Array:
        """The state at the last time, shape (2n,)."""
        return self.y[:, -1]

    @property
    def relative(self) -> bool:
        """Whether ``energy_error`` is relative: the starting energy is not zero (of no orbit)."""
        return bool(np.all(self.energy[0] != 0))

    @cached_property
    def energy_error(self) -> Array:
        """(H − H(start)) / |H(start)|, or H − H(start) where the starting energy is zero; shape (times,).

        Raises
        ------
        ValueError
            H depends on time, so that its change is no error; see ``energy_change``.
        """
        if not self.autonomous:
            raise ValueError("H depends on t, so its change is no error; energy_change has it")
        return self.energy_change / abs(self.energy[0]) if self.relative else self.energy_change


def measured(
    system: Equations, nodes: Sequence[int], samples: Samples, precision: str
) -> list[tuple[Array, Array]]:
    """Return each node's values along a trajectory and their changes since the start.

    They are evaluated with a 64-bit mantissa where the states are doubles and the platform's long double has
    one (x86), with 40 digits otherwise, at the state with what it is beyond doubles: what is reported is
    the trajectory's error, not the evaluation's.
    """
    doubles = precision in ("single", "double", "compensated")
    values = _wide_values if _WIDE and doubles else _many_digits
    found = values(system, nodes, samples.t, samples.y, samples.carried)
    return [(_rounded(value), _rounded(value - value[0])) for value in found]


def values_in(
    wide: MachineType, system: Equations, nodes: Sequence[int], t: float, y: Array, carried: Array
) -> npt.NDArray[Any]:
    """Return nodes at one time and states y + carried of shape (2n, orbits), as wide machine numbers.

    The shape is (nodes, orbits, 1), or (nodes, orbits, 2) where a number is the sum of two doubles.
    """
    if not wide.pair:
        arithmetic, dtype = (FLOAT64, np.float64) if wide.scalar == "double" else (LONGDOUBLE, np.longdouble)
        point = [a.astype(dtype) + b.astype(dtype) for a, b in zip(y, carried, strict=True)]
        found = system.graph.evaluate(
            nodes, dict(zip(system.inputs, (*point, dtype(t)), strict=True)), arithmetic
        )
        return np.stack([np.broadcast_to(np.asarray(v, dtype=dtype), y.shape[1:]) for v in found])[
            ..., np.newaxis
        ]
    exactly = np.stack(_many_digits(system, nodes, np.array([t]), y[:, np.newaxis], carried[:, np.newaxis]))[
        :, 0
    ]
    high = exactly.astype(np.float64)
    return np.stack([high, (exactly - high).astype(np.float64)], axis=-1)


def _rounded(values: npt.NDArray[Any]) -> Array:
    rounded = np.array(values, dtype=np.float64)
    if not np.isfinite(rounded).all():
        raise ArithmeticError(
            "the energy or an observable is not finite at a sample: it left its own domain there"
        )
    return rounded


def _wide_values(
    system: Equations, nodes: Sequence[int], t: Array, y: Array, carried: Array
) -> list[npt.NDArray[Any]]:
    state = y.astype(np.longdouble) + carried.astype(np.longdouble)
    times = t.astype(np.longdouble).reshape((-1,) + (1,) * (y.ndim - 2))
    found = system.graph.evaluate(nodes, dict(zip(system.inputs, (*state, times), strict=True)), LONGDOUBLE)
    return [np.broadcast_to(np.asarray(value, dtype=np.longdouble), y.shape[1:]) for value in found]


def _many_digits(
    system: Equations, nodes: Sequence[int], t: Array, y: Array, carried: Array
) -> list[npt.NDArray[Any]]:
    digits = multiprecision(40)
    found = np.empty((len(nodes), *y.shape[1:]), dtype=object)
    for place in np.ndindex(y.shape[1:]):
        pairs = zip(y[(slice(None), *place)].tolist(), carried[(slice(None), *place)].tolist(), strict=True)
        point = [*(Fraction(high) + Fraction(low) for high, low in pairs), Fraction(float(t[place[0]]))]
        values = dict(zip(system.inputs, map(digits.number, point), strict=True))
        for k, value in enumerate(system.graph.evaluate(nodes, values, digits)):
            # Outside a function's real domain mpmath goes on with complex numbers.
            found[(k, *place)] = value if hasattr(value, "man_exp") else np.nan
    return list(found)
