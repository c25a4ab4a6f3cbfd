"""Trajectories: sampled motions with their energies and observables, and what is asked of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.cached_property import cached_property
from canon.expression.symbols.user_input import counted
from canon.flow.equations.contact_regimes import seen_by_people
from canon.flow.estimate.error_estimate import ErrorEstimate, chosen_orbits, error_estimate
from canon.flow.interpolation import states_at
from canon.flow.record_file import write_record
from canon.flow.run.labelled_motion import labelled
from canon.flow.run_record import recorded
from canon.progress import reporting

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence

    import numpy.typing as npt
    import pandas
    import xarray
    from sympy import Expr

    from canon.array import Array
    from canon.flow.equations.contact_regimes import ContactRegime
    from canon.flow.method.method import Method
    from canon.flow.run.samples import Statistics
    from canon.flow.run_record import Energies, RunRecord

__all__ = ["Interrupted", "Trajectory", "finished", "trajectory_of"]


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A sampled motion and what it cost.

    A motion is equal to itself only: whether two have the same states, ``numpy.array_equal(one.y, other.y)`` tells.

    Parameters
    ----------
    t
        Sample times, shape (times,).
    y
        States (q, p), shape (2n, times); of many orbits, shape (2n, times, orbits), and so on below.
    carried
        What the states are beyond doubles (compensation, or the digits of a higher precision): the state is
        y + carried, shape (2n, times). ``final`` and a variable by name, ``motion["x"]``, are rows of y alone;
        energies, observables and functions such as ``motion[2 * x]`` are evaluated with both, and rounded to doubles
        last.
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
        The events met, in their order; of many orbits a tuple of them for each.
    record
        What was to be done and what came out in full, from which all else is read and goes on.
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
    observables: Mapping[str, Array]
    changes: Mapping[str, Array]
    statistics: Mapping[str, Statistics]
    events: tuple[Any, ...]
    record: RunRecord = field(repr=False)

    def __repr__(self) -> str:
        return (
            f"Trajectory({self.record}, t = {self.t[0]:g} … {self.t[-1]:g}, "
            f"{counted(len(self.t), 'sample')}, {self.method}, "
            f"{counted(self.steps, 'step')}, {self.cpu_seconds:.3g} s)"
        )

    @property
    def q(self) -> Array:
        """Coordinates, shape (n, times)."""
        return self.record.part("q")

    @property
    def p(self) -> Array:
        """Momenta, shape (n, times): of the state, or ∂L/∂q̇ of a motion whose state is (q, q̇)."""
        return self.record.part("p")

    @property
    def v(self) -> Array:
        """Velocities q̇, shape (n, times)."""
        return self.record.part("v")

    @property
    def u(self) -> Array:
        """Quasi-velocities, shape (quasi-velocities, times).

        Raises
        ------
        AttributeError
            The state of the system has none.
        """
        return self.record.part("u")

    @property
    def multipliers(self) -> Array:
        """The multipliers λ of the constraints, d/dt ∂L/∂q̇ − ∂L/∂q = Q + Σ λ a, shape (constraints, times).

        That of a constraint which depends on others is 0: only the forces of constraint are determined then.
        """
        return self.record.of_constraints("multipliers")

    @property
    def reactions(self) -> Array:
        """The generalized forces of constraint Σ λ a, shape (n, times)."""
        return self.record.of_constraints("reactions")

    @property
    def residuals(self) -> Array:
        """What the constraints f and the rates A q̇ + a₀ are along the motion, where they should be 0."""
        return self.record.of_constraints("residuals")

    @property
    def regimes(self) -> tuple[ContactRegime, ...]:
        """Which unilateral constraints were in contact when; an AttributeError where there are none."""
        return self.record.regimes

    def __getitem__(self, what: str | Expr) -> Array:
        """Return a variable, velocity, momentum, multiplier or observable by name, or any function of them.

        Parameters
        ----------
        what
            ``"theta"``, ``"theta_dot"``, ``"p_theta"``, ``"lambda_1"``, ``"t"``, ``"energy"``, ``"work"``, an
            observable's name; or a SymPy expression in what moves, the time and the parameters. A variable of the state
            that is called ``t``, ``energy`` or ``work`` comes before these: ``motion.energy`` has the energy then.

        Returns
        -------
        ndarray
            Of shape (times,), or (times, orbits).

        Raises
        ------
        KeyError
            Nothing is called so.
        TypeError
            It is a number.

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
            if what in ("t", "energy", "work") and what not in self.record.names:
                return {"t": lambda: self.t, "energy": lambda: self.energy, "work": lambda: self.work}[what]()
        if isinstance(what, int | float | slice | tuple):
            raise TypeError(
                f"motion[{what!r}] asks for no variable: write motion[{self.record.names[0]!r}], or motion.y[{what!r}]"
            )
        return self.record.along(what)

    @property
    def energy(self) -> Array:
        """The energy at the samples: H; T + V or Jacobi's function of other systems; shape (times,).

        Raises
        ------
        AttributeError
            No energy is known of the system.
        """
        return self.record.energies.values

    @property
    def energy_change(self) -> Array:
        """The energy less that at the start, subtracted before rounding, shape (times,)."""
        return self.record.energies.change

    @property
    def energy_defect(self) -> Array:
        """The energy's change less the work done, which is an error; of a Hamiltonian the change; shape (times,).

        Of a Hamiltonian that depends on time the change is work, and no error.
        """
        return self.record.energies.defect

    @property
    def work(self) -> Array:
        """The work done on the system since the start, by forces and by what depends on time, shape (times,).

        It was integrated along as a further variable by whatever method carries the motion, of fixed steps too; 0 where
        the energy is conserved.

        Raises
        ------
        AttributeError
            The system is a Hamiltonian, along whose motion no work is integrated: what is done on one that depends on
            time is ``energy_change``. Or no energy is known of the system.
        """
        return self.record.work

    @property
    def final(self) -> Array:
        """The state at the last time, shape (2n,), in doubles: what is beyond them is ``carried[:, -1]``."""
        return self.y[:, -1]

    @property
    def relative(self) -> bool:
        """Whether ``energy_error`` is relative: the starting energy is not zero but for rounding (of no orbit)."""
        return self.record.relative

    @cached_property
    def energy_error(self) -> Array:
        """Relative error of the energy, (H − H₀)/abs(H₀), or H − H₀ where H₀ = H(start) is zero; shape (times,).

        Of systems that were not given as a Hamiltonian, such as a ``Lagrangian``, the defect of the energy balance,
        E(t) − E(0) − W(t) with W = ∫ power dt, takes the place of H − H₀ where forces or what depends on time do work.
        An H₀ that is nothing beside the terms of H counts as zero. What a user's own events change the energy by is in
        it, and is no error.

        Raises
        ------
        ValueError
            The system is a Hamiltonian that depends on time: its change is work, which is not integrated along, and no
            error. ``energy_change`` has it; the motion of the Lagrangian has the work as well.
        AttributeError
            No energy is known of the system.
        """
        if self.record.moving is None and not self.autonomous:
            raise ValueError(
                "H depends on t, so its change is no error; energy_change has it. The motion of a Lagrangian has the "
                "work done as well, and with it an error; drift_study(system, …) follows one of a Hamiltonian too"
            )
        defect = self.record.energies.defect
        return defect / abs(self.energy[0]) if self.relative else defect

    def error_estimate(self, orbits: Sequence[int] | None = None) -> ErrorEstimate:
        """Return how far this motion is from the true one, by a companion run that is more exact.

        A method of fixed steps is repeated with half the step in wider numbers, which takes many times as long as the
        motion did; others are compared with Taylor's method in wider numbers:
        :mod:`canon.flow.estimate.error_estimate`.

        Parameters
        ----------
        orbits
            Which orbits of many to estimate; all of them where not given.

        Raises
        ------
        ValueError
            The motion has no such orbit, or is that of a map.

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
        record = self.record
        change = np.zeros(self.y.shape[1:]) if self.energies is None else self.energies.defect
        if orbits is not None:
            orbits = chosen_orbits(orbits, self.y.shape[2] if self.y.ndim == 3 else 1)
        return error_estimate(record.task, record.with_events_of(orbits), change, orbits)

    def to_xarray(self) -> xarray.Dataset:
        """Return the variables, the energy and the observables as an xarray dataset along ``t`` (extra ``export``).

        Of many orbits its dimensions are ``t`` and ``orbit``, counted from 0. Attributes say the method, the precision
        and the number of steps.
        """
        columns = dict(zip(self.record.names, self.y, strict=True))
        if self.energies is not None and "energy" not in columns:
            columns["energy"] = self.energy
        said = {"method": str(self.method), "precision": self.precision, "steps": self.steps}
        return labelled(self.t, {**columns, **self.observables}, said)

    def to_pandas(self) -> pandas.DataFrame:
        """Return the same as a pandas frame, a row a time, or a row a time and orbit (extra ``export``)."""
        return self.to_xarray().to_dataframe()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the motion to one file, ``"pendulum.npz"``, from which :func:`canon.load_motion` has it back exactly.

        Raises
        ------
        ValueError
            It can't be kept exactly, as Taylor's polynomials of ``dense=True`` can't; the message says what to do.
        """
        write_record(self.record, path)

    @property
    def stopped(self) -> bool:
        """Whether an event ended the motion."""
        return self.record.stopped

    def __call__(self, t: npt.ArrayLike) -> Array:
        """Return the state at any time inside the span, shape (2n,), or at many, (2n, times).

        Taylor, where ``propagate(…, dense=True)`` kept its polynomials: as accurate as the steps, that is to the
        method's tolerance. Methods of fixed steps: the states of the run, bit for bit at its steps (implicit ones and
        :class:`canon.flow.ExtendedPhaseSpace`: to round-off), from the sample before by steps of the run and one
        shorter step, which errs as one of the method.

        Raises
        ------
        ValueError
            A time lies outside the span, or times are no list; or what is needed was not kept.
        """
        record = self.record
        task, times = record.task, np.atleast_1d(np.asarray(t, dtype=np.float64))
        if times.ndim > 1:
            raise ValueError(
                f"times of shape {times.shape}: give one time or a list of them, such as t.ravel()"
            )
        found = states_at(task, record.samples, times)[task.system.rows]
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

        Methods of fixed steps, time-transformed ones too, take the steps that a run without the break would have taken:
        its states, observables and statistics are the same bits. Taylor's too, where an interrupted run is completed;
        DOP853 chooses its first step anew.

        Parameters
        ----------
        until
            The new last time, a whole number of fixed steps ``motion.step`` away, which may be shorter than the one
            asked for (the error names the nearest); anything later with adaptive methods. Where not given, an
            interrupted run is completed.
        samples, times
            When to keep the state on the new part; as densely as before where not given. A time-transformed motion
            that keeps states evenly in steps does so anew, about so many in all.
        progress
            As :func:`canon.flow.propagation.propagate` takes it.

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
        record = self.record
        task = record.continued(until, samples, times)
        with reporting(progress) as report:
            return finished(recorded(task, report, record.samples, record.moving))


class Interrupted(KeyboardInterrupt):
    """Raised by Ctrl-C during a run; what was done up to the last sample is kept.

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

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes this error again, in another process too."""
        return type(self), (self.motion,)


def finished(record: RunRecord) -> Trajectory:
    """Return the trajectory of a record whose run was not interrupted.

    Raises
    ------
    Interrupted
        It was; the error has the motion as far as it came.
    """
    motion = trajectory_of(record)
    if not (record.task.arrived(record.samples) or record.stopped):
        raise Interrupted(motion)
    return motion


def trajectory_of(record: RunRecord) -> Trajectory:
    """Return the trajectory of a record, with the energy and the observables along it."""
    task, found, seen = record.task, record.shown, record.measured
    return Trajectory(
        found.t, found.y, found.carried, seen.energies, task.method, task.precision_name, found.step, found.steps,
        found.evaluations, found.cpu_seconds, found.compile_seconds, task.system.autonomous,
        seen.observables, seen.changes, seen.statistics, seen_by_people(found), record,
    )  # fmt: skip
