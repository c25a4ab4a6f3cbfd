"""Poincaré sections: where orbits pass a surface g(q, p, t) = 0, for ensembles at compiled speed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE
from canon.expression.symbols.user_input import counted, given_expression
from canon.flow.fixed_step.compiled_loop import compiled_loop, steps_between
from canon.flow.fixed_step.section_search import SectionPlaces, reads_affinely, section_places
from canon.flow.integrate import integrate
from canon.flow.method.engine import FIXED_STEPS
from canon.flow.method.number_formats import fixed_precision
from canon.flow.request import Request
from canon.flow.run.event import Event, prepared_events
from canon.flow.system.named_values import node_along, variables_of
from canon.flow.system_request import any_task, refuse_contacts
from canon.progress import reporting

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Expr, Symbol

    from canon.array import Array
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.system.recognised_system import MovableSystem
    from canon.flow.task import Task

__all__ = ["PoincareSection", "SectionNotMetError", "poincare_section"]


class SectionNotMetError(ValueError):
    """Raised where no orbit passes the surface of section."""


@dataclass(frozen=True, eq=False)
class PoincareSection:
    """Points at which orbits pass a surface, those of one orbit after those of another, each in order of time.

    Parameters
    ----------
    surface
        The function g whose zeros are meant.
    direction
        1: where g rises in the order of passing, −1: where it falls, 0: both.
    orbit
        Whose each point is, counted from 0, shape (points,).
    t
        When, shape (points,).
    y
        The states there, shape (2n, points).
    orbits
        How many orbits there were, those that never passed included.
    turned
        How often some g turned so near zero that within one step it may have passed it twice, unseen: points may be
        missing where orbits touch the surface. 0 where events were located by :class:`canon.Event`, which looks there.
    steps
        Steps taken by all orbits together.
    """

    surface: Expr
    direction: int
    orbit: npt.NDArray[np.int64]
    t: Array
    y: Array
    orbits: int
    turned: int
    steps: int
    _task: Task = field(repr=False)
    _high: Array = field(repr=False)
    _carried: Array = field(repr=False)

    def __repr__(self) -> str:
        points, orbits = counted(len(self.t), "point"), counted(self.orbits, "orbit")
        return f"<PoincareSection {self.surface} = 0: {points} of {orbits}>"

    def __getitem__(self, what: str | Expr) -> Array:
        """Return a variable by its name, or a function of them, at the points, shape (points,).

        Raises
        ------
        KeyError
            There is no such variable.
        """
        return self._values(node_along(self._task.system, what))

    @property
    def counts(self) -> npt.NDArray[np.int64]:
        """How many points each orbit has, shape (orbits,)."""
        return np.bincount(self.orbit, minlength=self.orbits)

    def of_orbit(self, k: int) -> Array:
        """Return the states at the points of one orbit, shape (2n, points)."""
        if not 0 <= k < self.orbits:
            raise ValueError(f"there are orbits 0 … {self.orbits - 1}, not {k}")
        return self.y[:, self.orbit == k]

    @property
    def energy_change(self) -> Array:
        """H at the points less H at the orbit's start, shape (points,), evaluated in wider numbers.

        Raises
        ------
        ValueError
            The system is no Hamiltonian: the work done up to the points is not kept.
        """
        task = self._task
        if not task.system.canonical:
            raise ValueError("the energy at points of a section is told of Hamiltonians only")
        there = self._values(task.system.hamiltonian, LONGDOUBLE)
        start = _evaluated(task, task.system.hamiltonian, *task.states, float(task.plan.start), LONGDOUBLE)
        return (there - np.broadcast_to(start, (self.orbits,))[self.orbit]).astype(np.float64)

    def _values(self, node: int, numbers: Any = FLOAT64) -> Any:
        found = _evaluated(self._task, node, self._high, self._carried, self.t, numbers)
        return np.broadcast_to(found, self.t.shape)


def poincare_section(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None,
    surface: Expr | str,
    *,
    direction: int = 1,
    points: int | None = None,
    method: MethodGiven | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    precision: str | int | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
    progress: Callable[[float], None] | bool | None = None,
) -> PoincareSection:
    """Return where orbits pass a surface g = 0 in the space of the state and the time.

    With splittings, RK4 and Gauss the steps of many orbits go side by side in SIMD lanes and on all processors, and
    each place is found by a partial step of the same method from the step's beginning, by Newton's method in a
    bracket, to the round-off of time. Of other methods the places are those of :class:`canon.Event`, orbit by orbit.

    Parameters
    ----------
    system, t_span, y0, method, step, tolerance, precision, parameters, progress
        As :func:`canon.propagate` takes them, any system but one with unilateral constraints; many orbits are a start
        of shape (2n, orbits).
    surface
        g, a function of the state and the time such as g(q, p, t) of a Hamiltonian (see :class:`canon.Event`), or the
        name of a variable: ``"x"`` for x = 0. A start on the surface is no passing.
    direction
        1: passings at which g rises, −1: at which it falls, 0: both.
    points
        End when every orbit has so many points, and keep no more of each; otherwise all within the span.

    Raises
    ------
    SectionNotMetError
        No orbit passes the surface within the span.
    NonFiniteStateError
        An orbit is lost before it has its points.
    KeyError, TypeError, ValueError
        As ``propagate``; ``points`` is no positive number; g does not depend on the motion.

    Notes
    -----
    The points of one orbit are those of the map that the method makes of the system, as an orbit of it is. Of an
    orbit that touches the surface two near passings within one step are not seen; ``turned`` counts where that may
    have been. After M. Hénon, On the numerical computation of Poincaré maps, Physica D 5 (1982) 412–414,
    doi:10.1016/0167-2789(82)90034-3, which integrates to the surface in g in place of t; partial steps keep the
    method's own flow and its symmetry.

    Examples
    --------
    >>> import numpy as np
    >>> from canon import Splitting
    >>> from canon.flow import poincare_section
    >>> starts = np.array([[0.0, 0.0], [0.1, -0.2], [0.45, 0.4], [0.0, 0.1]])
    >>> found = poincare_section(
    ...     "henon-heiles", (0, 1000), starts, "x", points=50, method=Splitting("kahan-li-8"), step=0.2
    ... )
    >>> found.counts.tolist(), bool(abs(found["x"]).max() < 1e-12), bool(abs(found.energy_change).max() < 1e-9)
    ([50, 50], True, True)
    """
    if points is not None and points < 1:
        raise ValueError(f"points={points!r}: how many points of each orbit are wanted, 1 or more")
    request = Request(
        system, t_span, y0, method=method, step=step, tolerance=tolerance, precision=precision,
        parameters=parameters, samples=1,
    )  # fmt: skip
    task, moving = any_task(request)
    refuse_contacts(moving, "a section")
    g = surface if isinstance(surface, str) else given_expression(surface, "the surface of section")
    event = Event(_expression(task, g), direction)
    with reporting(progress) as report:
        found = _places(task, event, points, report)
    rows, orbits = task.system.rows, task.states[0].shape[1]
    if not len(found.t):
        a, b = (float(task.plan.instants[k]) for k in (0, -1))
        raise SectionNotMetError(
            f"no orbit passes {event.function} = 0 between t = {a:g} and t = {b:g}"
            f"{ {1: ' rising', -1: ' falling', 0: ''}[direction] }: take a longer span, another surface or direction=0"
        )
    return PoincareSection(
        event.function, direction, found.orbit, found.t, found.high[rows], orbits, found.turned, found.steps,
        task, found.high, found.low,
    )  # fmt: skip


def _expression(task: Task, surface: str | Expr) -> Expr:
    if not isinstance(surface, str):
        return surface
    named = {symbol.name: symbol for symbol in (*variables_of(task.system), task.system.t)}
    if surface not in named:
        node_along(task.system, surface)  # the error that names what there is
        raise KeyError(f"{surface} is no variable of the motion: give an expression in {', '.join(named)}")
    return named[surface]


def _places(
    task: Task,
    event: Event,
    points: int | None,
    report: Callable[[float], None],
) -> SectionPlaces:
    if task.method.engine is FIXED_STEPS and task.fictitious is None:
        prepared = prepared_events(task.system, [event])[0]
        orbits = task.states[0].shape[1]
        loop = compiled_loop(task.system, task.method, fixed_precision(task.precision), orbits)
        steps = steps_between(loop, task.method, task.plan)
        if reads_affinely(steps):
            return section_places(
                task.system, steps, task.states, int(task.plan.stops[-1]), (prepared.value, prepared.rate),
                direction=event.direction, wanted=points, progress=report,
            )  # fmt: skip
    return _by_events(replace(task, events=(event,)), points, report)


def _by_events(task: Task, points: int | None, report: Callable[[float], None]) -> SectionPlaces:
    """Return the places that are located as events, one orbit after the other."""
    made = integrate(task, report)
    each = made.each or (made,)
    met = [list(one.crossings)[:points] for one in each]
    orbit = np.repeat(np.arange(len(each)), [len(one) for one in met])
    crossings = [crossing for one in met for crossing in one]
    # Parameters that differ by orbit are as at the start; only work that is integrated along is not known there.
    high, low = (part[:, orbit] for part in task.states)
    low[task.system.rows] = 0.0
    if crossings:
        high[task.system.rows] = np.array([crossing.y for crossing in crossings]).T
    t = np.array([crossing.t for crossing in crossings])
    return SectionPlaces(orbit, t, high, low, 0, made.steps)


def _evaluated(task: Task, node: int, high: Array, low: Array, t: Any, numbers: Any) -> Any:
    kind = np.longdouble if numbers is LONGDOUBLE else np.float64
    values = dict(zip(task.system.inputs, (*(high.astype(kind) + low), kind(t)), strict=True))
    return task.system.graph.evaluate([node], values, numbers)[0]
