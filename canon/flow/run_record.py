"""Record of a run: what was to be done, what came out in full, and what is evaluated along it or goes on from it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import momentum, velocity
from canon.expression.symbols.user_input import counted, listed
from canon.flow.equations.contact_regimes import check_contacts, impacts_pile_up, regimes_of
from canon.flow.equations.left_out import check_left_out
from canon.flow.integrate import integrate, silently
from canon.flow.method.adaptive_methods import DOP853, Taylor
from canon.flow.run.non_finite_state import NonFiniteStateError, PiledUpError, named
from canon.flow.run.observables_along import (
    IMPLAUSIBLE,
    measured,
    measured_with_energy,
    size_of_terms,
    warn_of_jumps,
)
from canon.flow.run.samples import Samples, Statistics
from canon.flow.system.named_values import node_along, variables_of
from canon.frozen_mapping import FrozenMapping
from canon.kernel.program.hamilton_equations import exact_number

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    import numpy.typing as npt
    from sympy import Expr

    from canon.array import Array
    from canon.flow.equations.contact_regimes import ContactRegime
    from canon.flow.equations.first_order_motion import MovingSystem
    from canon.flow.method.method import Method
    from canon.flow.task import Task

__all__ = ["Energies", "Measured", "RunRecord", "recorded"]


_MISSED, _TOLERANCES = 1e-4, 1e4
"""Where a method that chooses its steps loses such a part of the energy, or so many tolerances, it missed something."""

_ROUNDING = 2.0**-44
"""A starting energy below this part of the size of H's terms is what rounding the start has left of zero."""


class Energies(NamedTuple):
    """The energy along a motion, its change, and what the change exceeds the work done by, each of shape (times,)."""

    values: Array
    change: Array
    defect: Array


class Measured(NamedTuple):
    """What was evaluated along a motion: its energy where one is known, and observables by name."""

    energies: Energies | None
    defect: Array
    observables: Mapping[str, Array]
    changes: Mapping[str, Array]
    statistics: Mapping[str, Statistics]


@dataclass(frozen=True, eq=False)
class RunRecord:
    """What was to be done, and what came out in full.

    Parameters
    ----------
    task, samples
        The task and the samples of all its orbits.
    moving
        Of other systems than Hamiltonians: what their states, energies and constraints are.
    """

    task: Task
    samples: Samples
    moving: MovingSystem | None = None

    @cached_property
    def whole(self) -> Samples:
        """The samples, of one orbit without the axis of the orbits."""
        return self.samples.of_one() if self.task.single else self.samples

    @cached_property
    def shown(self) -> Samples:
        """The same without what is integrated along unseen."""
        whole, rows = self.whole, self.task.system.rows
        if len(rows) == len(whole.y):
            return whole
        return replace(whole, y=whole.y[rows], carried=whole.carried[rows])

    @property
    def stopped(self) -> bool:
        """Whether an event ended the motion."""
        met = self.samples.crossings
        return bool(met) and met[-1].event.action == "stop"

    def with_events_of(self, orbits: Sequence[int] | None) -> Samples:
        """Return the samples with the events of some orbits only, all where not given."""
        found = self.samples
        if orbits is None or not found.each:
            return found
        return replace(found, crossings=tuple(met for k in orbits for met in found.each[k].crossings))

    @property
    def names(self) -> list[str]:
        """The names of the variables that are shown."""
        return [symbol.name for symbol in variables_of(self.task.system)]

    def part(self, letter: Literal["q", "p", "v", "u"]) -> Array:
        """Return coordinates, momenta, velocities or quasi-velocities, from the state where it holds them.

        Raises
        ------
        AttributeError
            They are not known of this system.
        """
        y, moving = self.shown.y, self.moving
        n = len(y) // 2 if moving is None else len(moving.q)
        own = "p" if moving is None else moving.letter
        if letter == "q":
            return y[:n]
        if letter == "u":
            if own not in ("u", "v"):
                raise AttributeError("the state of this system has no quasi-velocities")
            return y[n:]
        if letter == own and (letter == "v" or moving is None):
            return y[n:]
        return self._of_coordinates("momenta" if letter == "p" else "velocities")

    def values(self, nodes: Sequence[int]) -> list[Array]:
        """Return nodes at the samples, evaluated in higher precision than the states."""
        task = self.task
        return [value for value, _ in measured(task.system, nodes, self.whole, task.precision_name)]

    def along(self, what: str | Expr) -> Array:
        """Return a variable or a function of what moves, by name or as an expression.

        Raises
        ------
        KeyError
            Nothing is called so.
        """
        system = self.task.system
        for row, symbol in zip(self.shown.y, variables_of(system), strict=True):
            if what in (symbol, symbol.name):
                return row
        return self.values([node_along(system, what)])[0]

    def _of_coordinates(self, kind: str) -> Array:
        """Return the ``"momenta"`` or the ``"velocities"`` of the coordinates, shape (n, times)."""
        made, system = {"momenta": momentum, "velocities": velocity}[kind], self.task.system
        q = system.q[: len(system.q) - system.varying] if self.moving is None else self.moving.q
        try:
            return np.array([self.along(made(s).name) for s in q])
        except KeyError:
            raise AttributeError(
                f"{kind} are not known of this system: its variables are {listed(q)}"
            ) from None

    def of_constraints(self, kind: str) -> Array:
        """Return the ``"multipliers"``, ``"reactions"`` or ``"residuals"`` of constraints, shape (constraints, times).

        Raises
        ------
        AttributeError
            The system has no constraints.
        """
        moving, nodes = self.moving, ()
        if moving is not None:
            residuals = tuple(each.node for each in moving.residuals)
            nodes = {
                "multipliers": moving.multipliers,
                "reactions": moving.reactions,
                "residuals": residuals,
            }[kind]
        if not nodes:
            raise AttributeError(f"the system has no constraints, so the motion has no {kind}")
        return np.array(self.values(nodes))

    @property
    def regimes(self) -> tuple[ContactRegime, ...]:
        """Which unilateral constraints were in contact when.

        Raises
        ------
        AttributeError
            The system has none.
        """
        if self.moving is None or self.moving.contacts is None:
            raise AttributeError(
                "the system has no unilateral constraints, so the motion has no regimes of contact"
            )
        return regimes_of(self.moving, self.samples)

    @property
    def energies(self) -> Energies:
        """The energy at the samples.

        Raises
        ------
        AttributeError
            No energy is known of the system.
        """
        if self.measured.energies is None:
            kind = "system" if self.moving is None else self.moving.kind
            if names := self.task.names:
                raise AttributeError(
                    f"no energy is known of a {kind}, and the motion has followed {listed(names)}: judge that, "
                    f"drift(motion, observable={names[0]!r}); motion.changes[{names[0]!r}] is how it changed"
                )
            raise AttributeError(
                f"no energy is known of a {kind}: give it as an observable, observables={{name: expression}}, and "
                "judge that by its name, drift(motion, observable=name)"
            )
        return self.measured.energies

    @property
    def work(self) -> Array:
        """The work done since the start, shape (times,).

        Raises
        ------
        AttributeError
            The system is a Hamiltonian, along whose motion no work is integrated; or no energy is known.
        """
        if self.moving is None:
            raise AttributeError(
                "the work done on a Hamiltonian system is its energy_change; the motion of a Lagrangian has the work "
                "that was integrated along"
            )
        node = self.moving.work
        return np.zeros_like(self.energies.values) if node is None else self.values([node])[0]

    @cached_property
    def relative(self) -> bool:
        """Whether the starting energy is not zero but for rounding (of no orbit), so that its error is relative."""
        start, least = self.energies.values[0], np.zeros(1)
        if np.all(start != 0):
            least = _ROUNDING * size_of_terms(self.task.system, self.samples)
        return bool(np.all(np.abs(start) > least))

    @cached_property
    def measured(self) -> Measured:
        """The energy and the observables at the samples."""
        task, found, moving, watched = self.task, self.whole, self.moving, self.samples.watched
        if task.single and watched is not None:
            watched = watched[..., 0]
        extra = () if moving is None or moving.energy is None else (moving.energy,)
        observed = (*task.observed, *extra)
        (value, defect), *rest = measured_with_energy(task.system, observed, found, task.precision_name)
        energy, change = rest.pop() if extra else (value, defect)
        names = ("energy", *task.names)
        statistics = (
            {} if watched is None else {k: Statistics(*v) for k, v in zip(names, watched, strict=True)}
        )
        return Measured(
            energies=None if moving is not None and not extra else Energies(energy, change, defect),
            defect=defect,
            observables=FrozenMapping(dict(zip(task.names, (value for value, _ in rest), strict=True))),
            changes=FrozenMapping(dict(zip(task.names, (each for _, each in rest), strict=True))),
            statistics=FrozenMapping(statistics),
        )

    def continued(
        self, until: float | None, samples: int | None = None, times: npt.ArrayLike | None = None
    ) -> Task:
        """Return the task that goes on from the last sample, to a new last time or to the one that was meant.

        Raises
        ------
        ValueError
            An event has ended the motion; or it has arrived and there is no new last time; or it has not arrived and
            there is one.
        """
        task, found = self.task, self.samples
        if self.stopped:
            raise ValueError(
                f"the motion was ended by the event {found.crossings[-1].event}: it does not go on; start another one "
                f"there, propagate(system, ({found.t[-1]:g}, …), motion.final), without the event or beyond it"
            )
        if until is not None:
            if not task.arrived(found):
                raise ValueError("complete the interrupted run first: run.resume()")
            return task.until(exact_number(until, "until"), found, samples, times)
        if task.arrived(found):
            raise ValueError(f"the motion has arrived at t = {found.t[-1]:g}: say how far to go on, until=")
        return task

    def __str__(self) -> str:
        if self.moving is None:
            return f"{counted(len(self.task.system.rows) // 2, 'degree')} of freedom"
        return f"{self.moving.kind} in {listed(self.moving.state)}"


def recorded(
    task: Task,
    progress: Callable[[float], None] = silently,
    so_far: Samples | None = None,
    moving: MovingSystem | None = None,
) -> RunRecord:
    """Carry a task out, from the start or from what was done before.

    Raises
    ------
    NonFiniteStateError
        The motion can't be continued.
    ValueError
        A constraint that was left out, as others imply it at the start, is violated on the way.

    Warns
    -----
    AccuracyWarning
        The energy shows that the motion is not the system's.
    """
    if moving is None:
        return _carried_out(task, progress, so_far, moving)
    try:
        return _carried_out(task, progress, so_far, moving)
    except NonFiniteStateError as lost:
        raise named(lost, [s.name for s in variables_of(task.system)]) from None


def _at_once(method: Method) -> float:
    """Return which part of the energy no method loses from one sample to the next unless it has missed something."""
    if not isinstance(method, Taylor | DOP853):
        return IMPLAUSIBLE
    return min(IMPLAUSIBLE, max(_MISSED, _TOLERANCES * (method.tolerance or 0.0)))


def _carried_out(
    task: Task, progress: Callable[[float], None], so_far: Samples | None, moving: MovingSystem | None
) -> RunRecord:
    try:
        found = integrate(task, progress, so_far)
    except PiledUpError as lost:
        if moving is None or moving.contacts is None:
            raise
        raise impacts_pile_up(lost) from None
    record = RunRecord(task.ended(found), found, moving)
    defect = record.measured.defect
    if task.system.autonomous and not any(met.after is not None for met in found.crossings):
        start = np.zeros(1) if moving is not None else record.energies.values[0].reshape(-1)
        change = defect.reshape(len(defect), -1)
        warn_of_jumps(task.system, found, start, change, _at_once(task.method))
    if moving is not None:
        check_left_out(moving, found)
        check_contacts(moving, found)
    return record
