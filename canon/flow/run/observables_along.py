"""Observables along a motion, evaluated in higher precision than its states."""

from __future__ import annotations

import functools
import inspect
import warnings
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from canon.array import all_finite
from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE, multiprecision
from canon.flow.run.values_at_states import energy_terms, size_of_energy, values_of_sums
from canon.kernel.program.localised_terms import exponents_of
from canon.kernel.quad_arithmetic import quad_array, quad_for

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array
    from canon.expression.graph.number_systems import Arithmetic
    from canon.flow.run.samples import Samples
    from canon.kernel.llvm.number_types import MachineType
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.repeated.repeated_terms import KeptFunction, RepeatedTerms

__all__ = [
    "IMPLAUSIBLE",
    "AccuracyWarning",
    "energy_rounding",
    "frames_of_canon",
    "jumped",
    "measured",
    "measured_with_energy",
    "size_of_terms",
    "values_in",
    "warn_of_jumps",
]  # fmt: skip

IMPLAUSIBLE = 0.5
"""An energy that changes by more than this part of the size of H's terms at the start is no small error."""

_SMALL = 0.1
"""But it is one below this part of that change, measured by the mean size of the terms on the way up to there."""

_VANISHING = 1e-6
"""Terms of H that are smaller at the start than this part of their median size on the way are nothing to measure by."""

_NARROWER_THAN_QUAD = ("single", "double", "compensated", "extended", "double-double")
"""Precisions of states whose functions are evaluated in 113 bits, where long doubles do not do."""

_FEW = 4
"""Functions of so many states are evaluated one by one."""

_WIDE = bool(np.finfo(np.longdouble).nmant >= 63)


def measured(
    system: HamiltonEquations, nodes: Sequence[int], samples: Samples, precision: str
) -> list[tuple[Array, Array]]:
    """Return each node's values along a trajectory and their changes since the start.

    They are evaluated with a 64-bit mantissa where the states are doubles and the platform's long double has
    one (x86), in 113 bits where they are wider, and with 40 digits where they have as many or heyoka has no numbers
    of 113 bits, at the state with what it is beyond doubles: what is reported is the trajectory's error, not the
    evaluation's.
    """
    values = _values_for(system, nodes, precision)
    found = values(system, nodes, samples.t, samples.y, samples.carried)
    return [(_rounded(value), _rounded(value - value[:1])) for value in found]


def measured_with_energy(
    system: HamiltonEquations, observed: Sequence[int | KeptFunction], samples: Samples, precision: str
) -> list[tuple[Array, Array]]:
    """Return the same of H and of each observable; sums over rows are not written out where long doubles do."""
    if not (system.sums and _in_long_doubles(precision)):
        return measured(system, (system.hamiltonian, *map(system.node_of, observed)), samples, precision)
    state = samples.y.astype(np.longdouble) + samples.carried
    nodes = [each for each in observed if isinstance(each, int)]
    of_nodes = iter(measured(system, nodes, samples, precision) if nodes else [])

    def of_sums(sums: Sequence[RepeatedTerms]) -> tuple[Array, Array]:
        value = values_of_sums(system, sums, state, samples.t)
        return _rounded(value), _rounded(value - value[:1])

    return [
        of_sums(system.sums),
        *(next(of_nodes) if isinstance(each, int) else of_sums(each.sums) for each in observed),
    ]


def _rounding_of(precision: str) -> float:
    """Return the part of the size of its terms that :func:`measured` may get a function of the state wrong by."""
    if _in_long_doubles(precision):
        return 2.0**-60
    return 2.0**-109 if precision in _NARROWER_THAN_QUAD else 1e-37


def _in_long_doubles(precision: str) -> bool:
    return _WIDE and precision in ("single", "double", "compensated")


def _values_for(
    system: HamiltonEquations, nodes: Sequence[int], precision: str
) -> Callable[[HamiltonEquations, Sequence[int], Array, Array, Array], list[npt.NDArray[Any]]]:
    """Return what evaluates nodes in numbers that are wider than the states."""
    if _in_long_doubles(precision):
        return _wide_values
    quad = quad_for(system.graph, nodes) if precision in _NARROWER_THAN_QUAD else None
    return _many_digits if quad is None else functools.partial(_quad_values, quad)


def values_in(
    wide: MachineType, system: HamiltonEquations, nodes: Sequence[int], t: float, y: Array, carried: Array
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
    values = _values_for(system, nodes, "double-double")
    exactly = np.stack(values(system, nodes, np.array([t]), y[:, np.newaxis], carried[:, np.newaxis]))[:, 0]
    high = exactly.astype(np.float64)
    return np.stack([high, (exactly - high).astype(np.float64)], axis=-1)


class AccuracyWarning(UserWarning):
    """Warning that a computed motion is certainly not that of the system."""


def warn_of_jumps(
    system: HamiltonEquations, samples: Samples, start: Array, change: Array, at_once: float = IMPLAUSIBLE
) -> None:
    """Warn where the energy of an autonomous system changed as by a step over a singularity.

    Steps of one size may pass a collision from one side to the other without ever meeting an infinity. The
    energy does not survive it: where it has changed by half the size of H's terms at the start, the motion
    after that is not the system's. A motion that begins where the terms are small and goes where they are large is
    measured by their mean on its way: a pendulum let go at θ = 1.57 has H = −cos θ = −0.001, steps of 0.1 change that
    by 0.0006, and the terms are of the size of 1 half a period later.

    Parameters
    ----------
    system
        The equations.
    samples
        The motion.
    start, change
        H at the start, shape (orbits,), or 0 where it is not at hand; and how much it changes, shape (times, orbits).
    at_once
        Which part of the size of H's terms is no small error either where it comes from one sample to the next: less
        of methods that choose their steps. √(x² + 10⁻²⁴) has the series of x, which goes on beyond x = 0.

    Warns
    -----
    AccuracyWarning
        With the interval of time in which that was first seen.
    """
    if (np.abs(change) <= at_once / 2 * np.abs(start)).all():  # its terms together are no smaller
        return
    wrong = jumped(system, samples, change, at_once)
    if not wrong.any():
        return
    first, orbit = (int(k[0]) for k in np.nonzero(wrong))
    which = f" of orbit {orbit}" if change.shape[1] > 1 else ""
    warnings.warn(
        f"the energy{which} changes by {change[first, orbit]:.3g} up to t = {samples.t[first]:.9g} (t = "
        f"{samples.t[first - 1]:.9g} before that): a step jumped over a collision or is far too large; what follows is "
        "not the system's motion. Take a smaller step, Taylor(), or stop before with an Event",
        AccuracyWarning,
        stacklevel=frames_of_canon(),  # the line that called propagate() or resume()
    )


def frames_of_canon() -> int:
    """Return the stack level, for a warning of the caller, of the first line that is not canon's."""
    frame, level = inspect.currentframe(), 0
    while frame is not None and str(frame.f_globals.get("__name__")).startswith("canon."):
        frame, level = frame.f_back, level + 1
    return level


def jumped(
    system: HamiltonEquations, samples: Samples, change: Array, at_once: float = IMPLAUSIBLE
) -> npt.NDArray[np.bool_]:
    """Return where the energy has changed as :func:`warn_of_jumps` says, shape (times, orbits)."""
    size = size_of_terms(system, samples)
    wrong = np.abs(change) > IMPLAUSIBLE * size
    if at_once < IMPLAUSIBLE:
        wrong |= np.abs(np.diff(change, axis=0, prepend=0.0)) > at_once * size
    wrong &= size > 0  # where H and its terms are 0 there is nothing to compare with
    if wrong.any():
        sizes = size_of_energy(system, samples.y, samples.t).reshape(change.shape)
        means = np.cumsum(sizes, axis=0) / np.arange(1, len(sizes) + 1)[:, np.newaxis]
        wrong &= np.abs(change) > _SMALL * at_once * means
    return wrong


def size_of_terms(system: HamiltonEquations, samples: Samples) -> Array:
    """Return the size of H's terms together at the start, or on the way where they vanish there, shape (orbits,).

    They do where a pendulum −cos θ is released from the horizontal: what rounding leaves of them is no measure.
    """
    sizes = size_of_energy(system, samples.y, samples.t)
    if (sizes[0] > _VANISHING * sizes.max(axis=0)).all():
        return sizes[0]
    usual, large = np.median(sizes, axis=0), np.quantile(sizes, 0.9, axis=0)
    # A motion that begins and soon ends at rest, as with dry friction, has terms on the way only.
    usual = np.where(sizes[0] > 0, usual, large)
    return np.where(sizes[0] > _VANISHING * usual, sizes[0], usual)


def energy_rounding(system: HamiltonEquations, samples: Samples, precision: str) -> Array:
    """Return what :func:`measured` may get H wrong by along a motion, shape (orbits,).

    An exponential is wrong by its exponent times the rounding of a number, in parts of its own size.
    """
    graph, size = system.graph, size_of_terms(system, samples)
    values = dict(zip(system.inputs, (*samples.y, samples.t[:, np.newaxis]), strict=True))
    for term in energy_terms(system):
        exponents = exponents_of(graph, [term])
        if exponents:
            with np.errstate(all="ignore"):
                found, *powers = graph.evaluate([term, *exponents], values)
                wrong = np.max([np.abs(found * power) for power in powers], axis=0)
            size = size + np.broadcast_to(np.nan_to_num(wrong), samples.y.shape[1:]).max(axis=0)
    return _rounding_of(precision) * size


def _rounded(values: npt.NDArray[Any]) -> Array:
    rounded = values.astype(np.float64)
    if not all_finite(rounded):
        raise ArithmeticError(
            "the energy or an observable is not finite at a sample: it left its own domain there"
        )
    return rounded


def _wide_values(
    system: HamiltonEquations, nodes: Sequence[int], t: Array, y: Array, carried: Array
) -> list[npt.NDArray[Any]]:
    state = y.astype(np.longdouble) + carried
    if state[0].size <= _FEW:
        return _wide_values_one_by_one(system, nodes, t, state)
    times = t.astype(np.longdouble).reshape((-1,) + (1,) * (y.ndim - 2))
    found = system.graph.evaluate(nodes, dict(zip(system.inputs, (*state, times), strict=True)), LONGDOUBLE)
    return [np.broadcast_to(np.asarray(value, dtype=np.longdouble), y.shape[1:]) for value in found]


def _wide_values_one_by_one(
    system: HamiltonEquations, nodes: Sequence[int], t: Array, state: npt.NDArray[Any]
) -> list[npt.NDArray[Any]]:
    """Return the same of a few states: numbers are quicker than arrays of a few numbers."""
    points, shape = state.reshape(len(state), -1).T, state.shape[1:]
    times = t.repeat(len(points) // len(t)).astype(np.longdouble)
    found = [
        system.graph.evaluate(nodes, dict(zip(system.inputs, (*point, time), strict=True)), LONGDOUBLE)
        for point, time in zip(points, times, strict=True)
    ]
    return [np.array(each, dtype=np.longdouble).reshape(shape) for each in zip(*found, strict=True)]


def _quad_values(
    quad: Arithmetic, system: HamiltonEquations, nodes: Sequence[int], t: Array, y: Array, carried: Array
) -> list[npt.NDArray[Any]]:
    state = quad_array(y, carried)
    times = quad_array(t, np.zeros_like(t)).reshape((-1,) + (1,) * (y.ndim - 2))
    found = system.graph.evaluate(nodes, dict(zip(system.inputs, (*state, times), strict=True)), quad)
    return [np.broadcast_to(np.asarray(value, dtype=state.dtype), y.shape[1:]) for value in found]


def _many_digits(
    system: HamiltonEquations, nodes: Sequence[int], t: Array, y: Array, carried: Array
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
