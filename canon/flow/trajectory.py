"""Trajectories, and the energy along them in higher precision than their states."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from canon.expression.symbols.symbol import momentum, velocity
from canon.expression.symbols.user_input import counted
from canon.flow.error_estimate import ErrorEstimate, error_estimate
from canon.flow.integrate import integrate, silently
from canon.flow.interpolation import states_at
from canon.flow.labelled_motion import labelled
from canon.flow.run.observables_along import measured, size_of_terms, warn_of_jumps
from canon.flow.run.samples import Samples, Statistics
from canon.flow.system.left_out import check_left_out
from canon.flow.system.named_values import node_along, variables_of
from canon.frozen_mapping import FrozenMapping
from canon.kernel.program.hamilton_equations import exact_number
from canon.progress import reporting

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy.typing as npt
    import pandas
    import xarray
    from sympy import Expr, Symbol

    from canon.array import Array
    from canon.flow.method.method import Method
    from canon.flow.run.event import Crossing
    from canon.flow.system.first_order_motion import MovingSystem
    from canon.flow.task import Task

__all__ = ["Interrupted", "Trajectory", "carried_out"]

_ROUNDING = 2.0**-44
"""A starting energy below this part of the size of H's terms is what rounding the start has left of zero."""


class Energies(NamedTuple):
    """The energy along a motion, its change, and what the change exceeds the work done by, each of shape (times,)."""

    values: Array
    change: Array
    defect: Array


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
    energies
        The energy at the samples and its change, evaluated in higher precision than the states; None of a system
        of which no energy is known.
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
    events
        The events met, in their order.
    task, samples
        What was to be done, and what came out in full: what :meth:`resume` goes on from.
    moving
        Of other systems than Hamiltonians: what their states, energies and constraints are.
    """

    t: Array
    y: Array
    carried: Array
    energies: Energies | None
    method: Method
    precision: str
    step: float | None
    steps: int
    evaluations: int
    cpu_seconds: float
    compile_seconds: float
    autonomous: bool
    observables: Mapping[str, Array] = field(default_factory=lambda: FrozenMapping({}))
    changes: Mapping[str, Array] = field(default_factory=lambda: FrozenMapping({}))
    statistics: Mapping[str, Statistics] = field(default_factory=lambda: FrozenMapping({}))
    events: tuple[Crossing, ...] = ()
    task: Task | None = field(default=None, repr=False, compare=False)
    samples: Samples | None = field(default=None, repr=False, compare=False)
    moving: MovingSystem | None = field(default=None, repr=False, compare=False)

    def __repr__(self) -> str:
        return (
            f"Trajectory({self._size}, t = {self.t[0]:g} … {self.t[-1]:g}, "
            f"{counted(len(self.t), 'sample')}, {self.method}, "
            f"{counted(self.steps, 'step')}, {self.cpu_seconds:.3g} s)"
        )

    @property
    def _size(self) -> str:
        if self.moving is None:
            return f"{counted(len(self.q), 'degree')} of freedom"
        return f"{self.moving.kind} in {', '.join(s.name for s in self.moving.state)}"

    @property
    def q(self) -> Array:
        """Coordinates, shape (n, times)."""
        return self.y[: len(self.y) // 2 if self.moving is None else len(self.moving.q)]

    @property
    def p(self) -> Array:
        """Momenta, shape (n, times): of the state, or ∂L/∂q̇ of a motion whose state is (q, q̇)."""
        if self.moving is None:
            return self.y[len(self.y) // 2 :]
        return self._of_each(momentum, "momenta")

    @property
    def v(self) -> Array:
        """Velocities q̇, shape (n, times)."""
        if self.moving is not None and self.moving.letter == "v":
            return self.y[len(self.moving.q) :]
        return self._of_each(velocity, "velocities")

    @property
    def u(self) -> Array:
        """Quasi-velocities, shape (quasi-velocities, times).

        Raises
        ------
        AttributeError
            The state of the system has none.
        """
        if self.moving is None or self.moving.letter not in ("u", "v"):
            raise AttributeError("the state of this system has no quasi-velocities")
        return self.y[len(self.moving.q) :]

    @property
    def multipliers(self) -> Array:
        """The multipliers λ of the constraints, d/dt ∂L/∂q̇ − ∂L/∂q = Q + Σ λ a, shape (constraints, times).

        That of a constraint which depends on others is 0: only the forces of constraint are determined then.
        """
        return self._read("multipliers", () if self.moving is None else self.moving.multipliers)

    @property
    def reactions(self) -> Array:
        """The generalized forces of constraint Σ λ a, shape (n, times)."""
        return self._read("reactions", () if self.moving is None else self.moving.reactions)

    @property
    def residuals(self) -> Array:
        """What the constraints f and the rates A q̇ + a₀ are along the motion, where they should be 0."""
        kept = () if self.moving is None else tuple(each.node for each in self.moving.residuals)
        return self._read("residuals", kept)

    def __getitem__(self, what: str | Expr) -> Array:
        """Return a variable, velocity, momentum, multiplier or observable by name, or any function of them.

        Parameters
        ----------
        what
            ``"theta"``, ``"theta_dot"``, ``"p_theta"``, ``"lambda_1"``, ``"t"``, ``"energy"``, ``"work"``, an
            observable's name; or a SymPy expression in what moves, the time and the parameters.

        Returns
        -------
        ndarray
            Of shape (times,), or (times, orbits).

        Raises
        ------
        KeyError
            Nothing is called so.

        Examples
        --------
        >>> from canon import Lagrangian, coordinates, propagate
        >>> x = coordinates("x")
        >>> spring, start = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x]), {"x": 1, "x_dot": 0}
        >>> motion = propagate(spring, y0=start, t_span=(0, 1), samples=2)
        >>> motion["x"].round(6), motion[x**2 + x.dot**2].round(6)
        (array([1.      , 0.877583, 0.540302]), array([1., 1., 1.]))
        """
        if isinstance(what, str):
            if what in self.observables:
                return self.observables[what]
            if what in ("t", "energy", "work"):
                return {"t": lambda: self.t, "energy": lambda: self.energy, "work": lambda: self.work}[what]()
        task, _ = self.origin
        for row, symbol in enumerate(variables_of(task.system)):
            if what in (symbol, symbol.name):
                return self.y[row]
        return self._values([node_along(task.system, what)])[0]

    @property
    def energy(self) -> Array:
        """The energy at the samples: H; T + V or Jacobi's function of other systems; shape (times,).

        Raises
        ------
        AttributeError
            No energy is known of the system.
        """
        return self._energies.values

    @property
    def energy_change(self) -> Array:
        """The energy less that at the start, subtracted before rounding, shape (times,)."""
        return self._energies.change

    @property
    def energy_defect(self) -> Array:
        """The energy's change less the work done, which is an error; of a Hamiltonian the change; shape (times,)."""
        return self._energies.defect

    @property
    def work(self) -> Array:
        """The work done on the system since the start, by forces and by what depends on time, shape (times,).

        It was integrated along as a further variable; 0 where the energy is conserved.
        """
        if self.moving is None:
            raise AttributeError("the work done on a Hamiltonian system is its energy_change")
        node = self.moving.work
        return np.zeros_like(self.energy) if node is None else self._values([node])[0]

    @property
    def _energies(self) -> Energies:
        if self.energies is None:
            kind = "system" if self.moving is None else self.moving.kind
            raise AttributeError(
                f"no energy is known of a {kind}: give it as an observable, observables={{name: expression}}"
            )
        return self.energies

    def _of_each(self, made: Callable[[Symbol], Symbol], what: str) -> Array:
        """Return what belongs to each coordinate."""
        task, _ = self.origin
        q = (
            task.system.q[: len(task.system.q) - task.system.varying]
            if self.moving is None
            else self.moving.q
        )
        try:
            return np.array([self[made(s).name] for s in q])
        except KeyError:
            raise AttributeError(
                f"{what} are not known of this system: its variables are {', '.join(map(str, q))}"
            ) from None

    def _read(self, what: str, nodes: Sequence[int]) -> Array:
        if not nodes:
            raise AttributeError(f"the system has no constraints, so the motion has no {what}")
        return np.array(self._values(nodes))

    def _values(self, nodes: Sequence[int]) -> list[Array]:
        """Return nodes at the samples, evaluated in higher precision than the states."""
        task, samples = self.origin
        found = _single(samples) if task.single else samples
        return [value for value, _ in measured(task.system, nodes, found, task.precision_name)]

    @property
    def final(self) -> Array:
        """The state at the last time, shape (2n,)."""
        return self.y[:, -1]

    @cached_property
    def relative(self) -> bool:
        """Whether ``energy_error`` is relative: the starting energy is not zero but for rounding (of no orbit)."""
        start = self.energy[0]
        if self.moving is not None or self.task is None or self.samples is None or not np.all(start != 0):
            return bool(np.all(start != 0))
        return bool(np.all(np.abs(start) > _ROUNDING * size_of_terms(self.task.system, self.samples)))

    @cached_property
    def energy_error(self) -> Array:
        """Relative error of the energy, (H − H₀)/abs(H₀), or H − H₀ where H₀ = H(start) is zero; shape (times,).

        Where forces or what depends on time do work on a system, the defect of its energy balance,
        E(t) − E(0) − W(t) with W = ∫ power dt, takes the place of H − H₀.
        An H₀ that is nothing beside the terms of H, as of a pendulum −cos θ released from π/2, counts as zero.

        Raises
        ------
        ValueError
            H depends on time, so that its change is no error; see ``energy_change``.
        """
        if self.moving is None and not self.autonomous:
            raise ValueError("H depends on t, so its change is no error; energy_change has it")
        defect = self._energies.defect
        return defect / abs(self.energy[0]) if self.relative else defect

    def error_estimate(self, orbits: Sequence[int] | None = None) -> ErrorEstimate:
        """Return how far this motion is from the true one, by a companion run that is more exact.

        A method of fixed steps is repeated with half the step in wider numbers, which takes many times as long
        as the motion did; others are compared with Taylor's method in wider numbers. See
        :mod:`canon.flow.error_estimate`.

        Parameters
        ----------
        orbits
            Which orbits of many to estimate; all of them where not given.

        Raises
        ------
        ValueError
            The trajectory does not come from ``propagate``.

        Examples
        --------
        >>> from canon import Hamiltonian, Splitting, coordinates, propagate
        >>> import sympy
        >>> x = coordinates("x")
        >>> pendulum = Hamiltonian(x.momentum**2 / 2 - sympy.cos(x), [x], [x.momentum])
        >>> motion = propagate(pendulum, (0, 100), [1.0, 0.0], method=Splitting("verlet"), step=0.1)
        >>> estimate = motion.error_estimate()
        >>> bool(0.02 < estimate.relative[-1] < 0.1), estimate.meaningful_until, estimate.lyapunov_time
        (True, None, None)
        """
        task, samples = self.origin
        change = np.zeros(self.y.shape[1:]) if self.energies is None else self.energies.defect
        return error_estimate(task, samples, change, orbits)

    def to_xarray(self) -> xarray.Dataset:
        """Return the variables, the energy and the observables as an xarray dataset along ``t`` (extra ``export``)."""
        task, _ = self.origin
        columns = {symbol.name: self.y[row] for row, symbol in enumerate(variables_of(task.system))}
        if self.energies is not None:
            columns["energy"] = self.energy
        said = {"method": str(self.method), "precision": self.precision, "steps": self.steps}
        return labelled(self.t, {**columns, **self.observables}, said)

    def to_pandas(self) -> pandas.DataFrame:
        """Return the same as a pandas frame, a row a time, or a row a time and orbit (extra ``export``)."""
        return self.to_xarray().to_dataframe()

    @property
    def stopped(self) -> bool:
        """Whether an event ended the motion."""
        return bool(self.events) and self.events[-1].event.action == "stop"

    def __call__(self, t: npt.ArrayLike) -> Array:
        """Return the state at any time inside the span, shape (2n,), or at many, (2n, times).

        Taylor, where ``propagate(…, dense=True)`` kept its polynomials: as accurate as the steps, that is to the
        method's tolerance. Methods of fixed steps: the states of the run, bit for bit at its steps (implicit methods:
        to round-off), from the sample before by steps of the run and one shorter step, which errs as one step of
        the method.

        Raises
        ------
        ValueError
            A time lies outside the span; or what is needed was not kept.
        """
        task, samples = self.origin
        times = np.atleast_1d(np.asarray(t, dtype=np.float64))
        found = states_at(task, samples, times)[task.system.rows]
        found = found[:, :, 0] if task.single else found
        return found[:, 0] if np.ndim(t) == 0 else found

    def resume(
        self,
        until: float | None = None,
        *,
        samples: int | None = None,
        times: npt.ArrayLike | None = None,
        progress: Callable[[float], None] | bool | None = None,
    ) -> Trajectory:
        """Go on with the motion and return all of it, from its first time on.

        Methods of fixed steps, time-transformed ones too, take the steps that a run without the break would have
        taken: its states, observables and statistics are the same bits. Taylor's are too where an interrupted run is
        completed; DOP853 chooses its first step anew.

        Parameters
        ----------
        until
            The new last time, a whole number of fixed steps away; where not given, an interrupted run is completed.
        samples, times
            When to keep the state on the new part; as densely as before where not given. A time-transformed motion
            that keeps states evenly in steps does so anew, about so many in all.
        progress
            As :func:`canon.flow.propagate.propagate` takes it.

        Raises
        ------
        ValueError
            The motion has arrived and there is no new last time, or it lies behind, or not on a step; or an
            event has ended the motion.

        Examples
        --------
        >>> from canon import Hamiltonian, Splitting, coordinates, propagate
        >>> import sympy
        >>> x = coordinates("x")
        >>> pendulum = Hamiltonian(x.momentum**2 / 2 - sympy.cos(x), [x], [x.momentum])
        >>> chosen = {"method": Splitting("verlet"), "step": 0.125}
        >>> half = propagate(pendulum, (0, 10), [1.0, 0.0], samples=10, **chosen)
        >>> whole = propagate(pendulum, (0, 20), [1.0, 0.0], samples=20, **chosen)
        >>> bool((half.resume(20).y == whole.y).all())
        True
        """
        task, kept = self.origin
        if self.stopped:
            raise ValueError(f"the motion was ended by the event {self.events[-1].event}: it does not go on")
        if until is not None:
            if not task.arrived(kept):
                raise ValueError("complete the interrupted run first: run.resume()")
            task = task.until(exact_number(until, "until"), kept, samples, times)
        elif task.arrived(kept):
            raise ValueError(f"the motion has arrived at t = {self.t[-1]:g}: say how far to go on, until=")
        with reporting(progress) as report:
            return carried_out(task, report, kept, self.moving)

    @property
    def origin(self) -> tuple[Task, Samples]:
        """What was to be done and what came out in full."""
        if self.task is None or self.samples is None:
            raise ValueError("this trajectory does not come from propagate(): its task is not known")
        return self.task, self.samples


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run; what was done up to the last sample is kept.

    Parameters
    ----------
    motion
        The motion so far; ``motion.resume()`` completes it.
    """

    def __init__(self, motion: Trajectory) -> None:
        super().__init__(
            f"interrupted at t = {motion.t[-1]:g}; the error's .motion has the motion so far, .motion.resume() goes on"
        )
        self.motion = motion


def carried_out(
    task: Task,
    progress: Callable[[float], None] = silently,
    so_far: Samples | None = None,
    moving: MovingSystem | None = None,
) -> Trajectory:
    """Carry a task out, from the start or from what was done before.

    Raises
    ------
    Interrupted
        Ctrl-C; the error has the motion as far as it came.
    NonFiniteStateError
        The motion can't be continued.
    ValueError
        A constraint that was left out, as others imply it at the start, is violated on the way.
    """
    found = integrate(task, progress, so_far)
    made = _trajectory_of(task, found, moving)
    if not (task.arrived(found) or made.stopped):
        raise Interrupted(made)
    return made


def _single(samples: Samples) -> Samples:
    """Return the samples of one orbit without the axis of the orbits."""
    return replace(samples, y=samples.y[:, :, 0], carried=samples.carried[:, :, 0])


def _trajectory_of(task: Task, found: Samples, moving: MovingSystem | None) -> Trajectory:
    """Return what samples say, with the energy and the observables along them."""
    watched, kept = found.watched, found
    if task.single:
        watched = None if watched is None else watched[..., 0]
        found = _single(found)
    extra = () if moving is None or moving.energy is None else (moving.energy,)
    (value, defect), *rest = measured(task.system, (*task.nodes, *extra), found, task.precision_name)
    energy, change = rest.pop() if extra else (value, defect)
    rows, names = task.system.rows, ("energy", *task.names)
    all_rows = len(rows) == len(found.y)
    changed = any(met.after is not None for met in found.crossings)
    if task.system.autonomous and not changed:
        warn_of_jumps(task.system, kept, defect.reshape(len(defect), -1))
    if moving is not None:
        check_left_out(moving, kept)
    return Trajectory(
        t=found.t,
        y=found.y if all_rows else found.y[rows],
        carried=found.carried if all_rows else found.carried[rows],
        energies=None if moving is not None and not extra else Energies(energy, change, defect),
        method=task.method,
        precision=task.precision_name,
        step=found.step,
        steps=found.steps,
        evaluations=found.evaluations,
        cpu_seconds=found.cpu_seconds,
        compile_seconds=found.compile_seconds,
        autonomous=task.system.autonomous,
        observables=FrozenMapping(dict(zip(task.names, (value for value, _ in rest), strict=True))),
        changes=FrozenMapping(dict(zip(task.names, (each for _, each in rest), strict=True))),
        statistics=FrozenMapping(
            {} if watched is None else {k: Statistics(*v) for k, v in zip(names, watched, strict=True)}
        ),
        events=found.crossings,
        task=task.ended(found),
        samples=kept,
        moving=moving,
    )
