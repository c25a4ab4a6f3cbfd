"""Jacobians of flows and of discrete maps: symplecticity defect, reversal error."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from canon.expression.symbols.user_input import counted
from canon.flow.geometry.compiled_jacobian import compiled_jacobian
from canon.flow.geometry.jacobian_in_stretches import jacobian_in_stretches
from canon.flow.geometry.transformed_jacobian import transformed_jacobian
from canon.flow.propagation import propagated
from canon.flow.request import Request
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.run.sampling_plan import Plan, fixed_plan
from canon.flow.run_record import recorded
from canon.flow.system.hamiltonian_map import DRIFT_AND_KICK, KICK_AND_DRIFT
from canon.flow.system.scene_as_system import is_scene, opened
from canon.flow.system_request import any_task, refuse_contacts
from canon.flow.trajectory import finished
from canon.kernel.program.variational import of_all_variables, variational

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy.typing as npt
    from sympy import Symbol

    from canon.array import Array
    from canon.flow.equations.first_order_motion import MovingSystem
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.flow.system.recognised_system import MovableSystem
    from canon.flow.task import Task

__all__ = ["FlowJacobian", "flow_jacobian", "reversal_error", "symplecticity_defect"]

_UNIT = 2**200
"""Jacobians are multiplied in whole numbers of 2⁻²⁰⁰, so that a defect is theirs and not the product's."""


@dataclass(frozen=True, eq=False)
class FlowJacobian:
    """The derivative M = ∂(q, p)(t)/∂(q, p)(start) of a motion by its starting state.

    Parameters
    ----------
    t
        Times, shape (times,).
    y
        The motion itself, shape (2n, times).
    M
        The Jacobian, shape (2n, 2n, times): ``M[i, j]`` is ∂y_i/∂y0_j; the identity at the start.
    low
        Digits beyond double precision: the Jacobian is M + low.
    exponent
        Of a motion whose neighbours part by more than doubles can hold: the Jacobian is M · 2**exponent at each time,
        with 0 where doubles hold it. Empty where they always do.
    """

    t: Array
    y: Array
    M: Array
    low: Array
    exponent: tuple[int, ...] = ()

    def __repr__(self) -> str:
        n = len(self.M)
        return (
            f"<FlowJacobian: {n} × {n} at {counted(len(self.t), 'time')}, t = {self.t[0]:g} … {self.t[-1]:g}>"
        )

    @property
    def final(self) -> Array:
        """The Jacobian at the last time, shape (2n, 2n).

        Raises
        ------
        OverflowError
            It is beyond the largest doubles.
        """
        if any(self.exponent[-1:]):
            raise OverflowError(
                "the Jacobian is beyond 1e308: it is M[:, :, -1] · 2**exponent[-1], see log_size"
            )
        return self.M[:, :, -1]

    @property
    def log_size(self) -> Array:
        """The logarithm of the size of the largest entry at each time; over the time a Lyapunov exponent, nearly."""
        powers = np.array(self.exponent or (0,) * len(self.t)) * np.log(2.0)
        return np.log(abs(self.M).max(axis=(0, 1))) + powers

    @property
    def symplecticity_defect(self) -> Array:
        """The largest size of an entry of MᵀJM − J at each time, see :func:`symplecticity_defect`."""
        if any(self.exponent):
            raise ValueError(
                "the Jacobian is beyond 1e308, and nothing of its symplecticity is left: look earlier"
            )
        pairs = zip(self.M.ravel().tolist(), self.low.ravel().tolist(), strict=True)
        whole = [round((Fraction(high) + Fraction(low)) * _UNIT) for high, low in pairs]
        exact = np.array(whole, dtype=object).reshape(self.M.shape)
        return np.array(
            [float(Fraction(_defect(exact[:, :, k], _UNIT**2), _UNIT**2)) for k in range(len(self.t))]
        )


def flow_jacobian(
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
    times: npt.ArrayLike | None = None,
    sizes: npt.ArrayLike | None = None,
) -> FlowJacobian:
    """Return the Jacobian of the flow by the variational equations, with the method that carries the motion.

    Where neighbours part by more than doubles can hold, the variations begin anew on the way and are multiplied.
    For methods of fixed steps it is the exact derivative of the discrete map that the compiled steps make, up to
    round-off, so that a symplectic method's is symplectic to round-off at any step; but that of
    :class:`canon.flow.ExtendedPhaseSpace`, which is symplectic in two copies of phase space: M is the derivative of
    their mean, from copies that begin alike, and symplectic to the method's error. For Taylor and DOP853 it is
    the flow's, to their tolerance, with the jumps of variations where rates jump at kinks, which steps of one size pass
    unseen. On a Poisson manifold, by :class:`canon.flow.LiePoissonSplitting`, M Π Mᵀ = Π′ holds to round-off.

    Parameters
    ----------
    system, t_span, method, step, tolerance, precision, parameters, samples, times
        As :func:`canon.propagate` takes them; one sample, at the end, where neither samples nor times are given. Of
        systems other than Hamiltonians M is the derivative in their own variables, as (q, q̇), in which nothing need be
        symplectic; under constraints it holds for variations that keep them.
    y0
        One starting state, (q, p) of a Hamiltonian, shape (2n,).
    sizes
        How large variations of each variable are to begin, shape (2n,), where their units make them very different
        from 1: an adaptive method's tolerance is a part of the largest number in the state. M is the derivative all
        the same.

    Raises
    ------
    ValueError
        As ``propagate``; or several states or parameters by orbit are given; or sizes that are not positive; or the
        motion stays on a kink or is refracted there.

    Examples
    --------
    >>> from canon import Hamiltonian, Splitting, coordinates
    >>> import sympy
    >>> x = coordinates("x")
    >>> pendulum = Hamiltonian(x.momentum**2 / 2 - sympy.cos(x), [x], [x.momentum])
    >>> coarse = flow_jacobian(pendulum, (0, 50), [1.0, 0.0], method=Splitting("verlet"), step=0.5)
    >>> coarse.final.shape, bool(coarse.symplecticity_defect[-1] < 1e-13)
    ((2, 2), True)
    """
    if samples is None and times is None:
        samples = 1
    request = Request(
        system, t_span, y0, method=method, step=step, tolerance=tolerance, precision=precision,
        parameters=parameters, samples=samples, times=times,
    )  # fmt: skip
    task, moving = any_task(request)
    refuse_contacts(moving, "the Jacobian of a flow")
    if not task.single:
        raise ValueError(
            "the Jacobian is made of one orbit at a time: give one state and one set of parameters"
        )
    if task.fictitious is not None:
        given = opened(cast("Any", system), y0, parameters or {}) if is_scene(system) else None
        frame, values = (system, parameters or {}) if given is None else (given.system, given.parameters)
        return FlowJacobian(*transformed_jacobian(task, cast("HamiltonianSystem", frame), values))
    rows = slice(None) if moving is None else task.system.rows
    units = _units(len(task.states[0]), rows, sizes)
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            t, motion, slopes, low = _with_variations(task, moving, units)
    except NonFiniteStateError:
        t, motion, slopes, powers = jacobian_in_stretches(
            task, lambda stretch: _with_variations(stretch, moving, units)[2][:, :, -1]
        )
        found = slopes[rows][:, rows]
        return FlowJacobian(t, motion[rows], found, np.zeros_like(found), powers)
    return FlowJacobian(t, motion[rows], slopes[rows][:, rows], low[rows][:, rows])


def _units(count: int, rows: Any, sizes: npt.ArrayLike | None) -> Array:
    """Return powers of two near the sizes, so that dividing by them rounds nothing."""
    units = np.ones(count)
    if sizes is not None:
        given, shape = np.asarray(sizes, dtype=np.float64), units[rows].shape
        if given.shape != shape or not (np.isfinite(given) & (given > 0)).all():
            raise ValueError(f"sizes={sizes}: give a positive number for each of the {shape[0]} variables")
        units[rows] = 2.0 ** np.round(np.log2(given))
    return units


def _with_variations(
    task: Task, moving: MovingSystem | None, units: Array
) -> tuple[Array, Array, Array, Array]:
    """Return times, motion, Jacobians and what they are beyond doubles, of all that is integrated."""
    if task.method.solvable is not None or task.system.lie_poisson is not None:
        return compiled_jacobian(task)
    size = len(task.states[0])
    # What is integrated along unseen depends on the start too, and is shown here on the way only.
    whole = task.system if moving is None else of_all_variables(task.system)
    # Orbits side by side, one variation each; where steps adapt, all variations of one orbit.
    orbits, columns = (size, 1) if task.method.engine.takes_step else (1, size)
    made = replace(
        task,
        system=variational(whole, columns),
        states=(
            _varied(task.states[0], orbits, columns, units),
            _varied(task.states[1], orbits, columns, np.zeros(size)),
        ),
        single=False,
    )
    found = finished(recorded(made))
    motion, slopes = _parted(found.y, size, columns)
    _, low = _parted(found.carried, size, columns)
    columns_of = units[np.newaxis, :, np.newaxis]
    return found.t, motion, slopes / columns_of, low / columns_of


def _varied(state: Array, orbits: int, columns: int, units: Array) -> Array:
    """Return starting states of shape (2n (1 + columns), orbits) with a variation of each variable by its unit."""
    n = len(state) // 2
    each = np.diag(units)
    shape = (columns, 2, n, orbits)
    varied = each.reshape(columns, 2 * n, 1) if orbits == 1 else each.reshape(1, 2 * n, orbits)
    varied = varied.reshape(shape).transpose(1, 0, 2, 3).reshape(2, -1, orbits)
    own = np.broadcast_to(state, (2 * n, orbits)).reshape(2, n, orbits)
    return np.concatenate([own, varied], axis=1).reshape(-1, orbits)


def _parted(y: Array, size: int, columns: int) -> tuple[Array, Array]:
    """Return motion (2n, times) and Jacobian (2n, 2n, times) from states with variations."""
    n, (_, times, orbits) = size // 2, y.shape
    parts = y.reshape(2, 1 + columns, n, times, orbits)
    variations = parts[:, 1:].transpose(0, 2, 1, 4, 3).reshape(size, size, times)
    return parts[:, 0, :, :, 0].reshape(size, times), variations


def symplecticity_defect(M: npt.ArrayLike) -> float:
    """Return the largest size of an entry of MᵀJM − J, J = [[0, 1], [−1, 0]]; 0 where it is symplectic.

    Its round-off is some units of the last place of the square of M's largest entries.

    Parameters
    ----------
    M
        A matrix, shape (2n, 2n), rows and columns ordered (q, p).

    Raises
    ------
    ValueError
        The matrix is not of even size and finite.

    Examples
    --------
    >>> symplecticity_defect([[1.0, 0.5], [0.0, 1.0]]), symplecticity_defect([[1.0, 0.0], [0.0, 0.75]])
    (0.0, 0.25)
    """
    given = np.asarray(M)
    if given.ndim != 2 or given.shape[0] != given.shape[1] or given.shape[0] % 2 or not given.size:
        raise ValueError(f"a matrix of shape {given.shape}: a Jacobian of (q, p) has shape (2n, 2n)")
    if not np.isfinite(given).all():
        raise ValueError(
            "the matrix has entries that are not finite: the motion it belongs to has left the finite numbers"
        )
    return float(_defect(given, 1))


def _defect(M: npt.NDArray[Any], one: int) -> Any:
    """Return the largest size of an entry of MᵀJM − J for a matrix whose entries are given in parts of √one."""
    n = len(M) // 2
    upper, lower = M[:n], M[n:]
    found = upper.T @ lower - lower.T @ upper
    unit = np.array([[one * (i == j) for j in range(n)] for i in range(n)], dtype=M.dtype)
    found[:n, n:] -= unit
    found[n:, :n] += unit
    return abs(found).max()


def reversal_error(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
    *,
    method: MethodGiven | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    precision: str | int | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
) -> Array:
    """Return how far from its start a motion arrives that runs forward and then back, shape of y0.

    A symmetric method arrives to round-off, times what the motion makes of it; others miss by their error, and so do
    time-transformed ones, which land within a step. Tao's method goes back from both of its copies.

    Parameters
    ----------
    system, t_span, y0, method, step, tolerance, precision, parameters
        As :func:`canon.propagate` takes them.

    Examples
    --------
    >>> from canon import Hamiltonian, RK4, Splitting, coordinates
    >>> import sympy
    >>> x = coordinates("x")
    >>> pendulum = Hamiltonian(x.momentum**2 / 2 - sympy.cos(x), [x], [x.momentum])
    >>> far = [
    ...     abs(reversal_error(pendulum, (0, 50), [1.0, 0.0], method=method, step=0.25)).max()
    ...     for method in (Splitting("verlet"), RK4())
    ... ]
    >>> bool(far[0] < 1e-13), bool(far[1] > 1e-3)
    (True, True)
    """
    request = Request(
        system, t_span, y0, method=method, step=step, tolerance=tolerance, precision=precision,
        parameters=parameters, samples=1,
    )  # fmt: skip
    there = propagated(request).record
    task, kept = there.task, there.samples
    plan, (high, low) = task.plan, task.states
    if plan.h is None:
        back = Plan(Fraction(float(plan.instants[-1])), plan.instants[::-1].copy(), ends=plan.ends)
    else:
        back = fixed_plan(plan.last(-1), -plan.h, plan.stops)
    if task.system.kicked:
        forward = task.method == KICK_AND_DRIFT
        task = replace(task, method=DRIFT_AND_KICK if forward else KICK_AND_DRIFT)
    task = replace(task, states=(kept.y[:, -1], kept.carried[:, -1]), plan=back)
    from_copies = None  # the second copy is no part of the state
    if task.method.family == "extended_phase_space":
        from_copies = replace(
            kept, t=kept.t[-1:], y=kept.y[:, -1:], carried=kept.carried[:, -1:], steps=0, evaluations=0
        )
    end = finished(recorded(task, so_far=from_copies, moving=there.moving)).record.samples
    missed = ((end.y[:, -1] - high) + (end.carried[:, -1] - low))[task.system.rows]
    return missed[:, 0] if task.single else missed
