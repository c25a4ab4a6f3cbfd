"""Right-hand side of the equations of motion, compiled: f(t, y), for integrators and searches of one's own."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.cached_property import cached_property
from canon.flow.request import Request
from canon.flow.run.compiled_nodes import CompiledNodes, compiled_nodes
from canon.flow.system.named_values import variables_of
from canon.flow.system_request import any_task, refuse_contacts

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy.typing as npt
    from sympy import Symbol

    from canon.array import Array
    from canon.flow.system.recognised_system import MovableSystem
    from canon.flow.task import Task

__all__ = ["RightHandSide", "right_hand_side"]


@dataclass(frozen=True, eq=False)
class RightHandSide:
    """The rates f(t, y) of a system's variables, compiled when first called.

    Parameters
    ----------
    system, y0, parameters
        As :func:`right_hand_side` takes them.
    """

    system: Any
    y0: Any
    parameters: Mapping[Symbol | str, Any] | None
    _task: Task = field(repr=False)

    def __reduce__(self) -> tuple[Any, ...]:
        return right_hand_side, (self.system, self.y0, self.parameters)

    @property
    def variables(self) -> tuple[Symbol, ...]:
        """The variables y in their order."""
        shown = variables_of(self._task.system)
        return tuple(shown)

    @property
    def start(self) -> Array:
        """The state y0 in that order, shape (variables,)."""
        return self._task.states[0][self._task.system.rows, 0]

    @cached_property
    def _compiled(self) -> CompiledNodes:
        return compiled_nodes(self._task.system, self._task.system.rates)

    def __call__(self, t: float, y: npt.ArrayLike) -> Array:
        """Return dy/dt, of the shape of y: (variables,), as SciPy's integrators and root finders take it."""
        whole, rows = self._task.states[0][:, 0].copy(), self._task.system.rows
        whole[rows] = np.asarray(y, dtype=np.float64)
        return self._compiled.call(t, whole)[rows]


def right_hand_side(
    system: MovableSystem,
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
) -> RightHandSide:
    """Return the compiled right-hand side of the equations that :func:`canon.propagate` integrates.

    Constraints are differentiated and stabilised in it as they are there. Any consistent units.

    Parameters
    ----------
    system, parameters
        As :func:`canon.propagate` takes them.
    y0
        One state, as :func:`canon.propagate` takes it: where the motion of constrained systems is, whose pivots are
        chosen there; of a Hamiltonian any state at which it is regular.

    Raises
    ------
    KeyError, TypeError, ValueError
        As :func:`canon.propagate`; or several states or parameters by orbit are given.

    Examples
    --------
    >>> from canon import Hamiltonian, coordinates, parameters
    >>> from canon.flow import right_hand_side
    >>> import sympy
    >>> theta = coordinates("theta")
    >>> g = parameters("g", positive=True)
    >>> pendulum = Hamiltonian(theta.momentum**2 / 2 - g * sympy.cos(theta), [theta], [theta.momentum])
    >>> rates = right_hand_side(pendulum, [0, 1], {g: 9.81})
    >>> rates.variables, rates(0.0, [0.0, 0.5])
    ((theta, p_theta), array([ 0.5, -0. ]))

    Where it vanishes a motion rests:

    >>> from scipy.optimize import root
    >>> bool(abs(root(lambda y: rates(0.0, y), [3.0, 0.1]).x - [3.14159265, 0]).max() < 1e-8)
    True
    """
    task, moving = any_task(Request(system, (0.0, 1.0), y0, parameters=parameters, samples=1))
    refuse_contacts(moving, "a right-hand side")
    if not task.single:
        raise ValueError(
            "a right-hand side is that of one motion: give one state, and one number for a parameter"
        )
    return RightHandSide(system, y0, parameters, task)
