"""Running error of forces: by how much rounding puts the rates of change wrong, terms that cancel included.

Beside an equilibrium of e^q + e^−q the force is what two terms of size one leave of each other; their rounding is all
that a small motion there sees. Each operation adds the rounding of its own result to what its operands have (Higham,
Accuracy and Stability of Numerical Algorithms, 2nd ed., § 3.3, https://doi.org/10.1137/1.9780898718027).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE, Arithmetic

if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction

    import numpy.typing as npt

    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["rounding_of_rates", "sizes_of_rates"]

_BESIDE = 2.0**-20
"""So far beside its argument, in parts of it, a function is evaluated once more for its slope."""


def rounding_of_rates(system: HamiltonEquations, t: Array, y: Array) -> Array:
    """Return what numbers with the rounding unit one get the rates of change wrong by, at exact states.

    Parameters
    ----------
    system
        The equations.
    t, y
        Times and states, shapes (times,) and (2n, times, orbits).

    Returns
    -------
    array
        Of the rows of the state, shape (rows, times, orbits), to first order in the unit, which multiplies it.
    """
    nodes = (*system.velocity, *system.force)
    state = dict(zip(system.inputs, map(_exact, (*y, t[:, np.newaxis])), strict=True))
    found = system.graph.evaluate([nodes[row] for row in system.rows], state, _RUNNING)
    return np.array([np.broadcast_to(each.error, y.shape[1:]) for each in found])


def sizes_of_rates(system: HamiltonEquations, t: Array, y: Array) -> npt.NDArray[Any]:
    """Return the sizes of q̇ and ṗ, shape (2n, times, orbits)."""
    nodes = (*system.velocity, *system.force)
    wide = (part.astype(np.longdouble) for part in (*y, t[:, np.newaxis]))
    state = dict(zip(system.inputs, wide, strict=True))
    found = system.graph.evaluate([nodes[row] for row in system.rows], state, LONGDOUBLE)
    sizes = np.empty(y[system.rows].shape, dtype=np.longdouble)
    for each, x in zip(sizes, found, strict=True):
        each[:] = np.abs(np.broadcast_to(np.asarray(x), y.shape[1:]))
    return sizes


@dataclass(frozen=True, eq=False)
class _Running:
    """A value, and what rounding may have put it wrong by, in rounding units."""

    value: Any
    error: Any

    def __add__(self, other: _Running) -> _Running:
        value = self.value + other.value
        return _Running(value, self.error + other.error + abs(value))

    def __mul__(self, other: _Running) -> _Running:
        value = self.value * other.value
        return _Running(value, abs(self.value) * other.error + abs(other.value) * self.error + abs(value))

    def __pow__(self, power: int | _Running) -> _Running:
        if isinstance(power, _Running):
            return _function(np.power)(self, power)
        return _function(lambda x: x**power)(self)

    def __rtruediv__(self, one: int) -> _Running:
        value = one / self.value
        return _Running(value, self.error * value * value + abs(value))


def _exact(value: Any) -> _Running:
    return _Running(value, 0.0)


def _number(value: Fraction) -> _Running:
    number = FLOAT64.number(value)
    return _Running(number, 0.0 if value.denominator == 1 else abs(number))


def _named(name: str) -> _Running:
    number = FLOAT64.named(name)
    return _Running(number, abs(number))


def _function(of: Callable[..., Any]) -> Callable[..., _Running]:
    """Return a function with the errors of its arguments, by difference quotients for its slopes."""

    def carried(*given: _Running) -> _Running:
        at = [each.value for each in given]
        value = of(*at)
        error = abs(value)
        for k, each in enumerate(given):
            if np.any(each.error):
                step = _BESIDE * np.maximum(abs(each.value), _BESIDE)
                beside = of(*at[:k], each.value + step, *at[k + 1 :])
                error = error + abs(beside - value) / step * each.error
        return _Running(value, error)

    return carried


_RUNNING = Arithmetic(
    name="running error",
    digits=FLOAT64.digits,
    number=_number,
    named=_named,
    root=_function(np.sqrt),
    functions={name: _function(each) for name, each in FLOAT64.functions.items()},
)
