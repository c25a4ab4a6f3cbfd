"""Motion that is studied, as it is asked for: a scene and a start by name, or any system and numbers."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.symbols.input_in_words import described
from canon.flow.system.parameter_values import SpareParameters
from canon.flow.system.scene_as_system import is_scene, opened
from canon.flow.system.start_of_motion import read_by_labels, state_in_order
from canon.flow.system_request import is_hamiltonian
from canon.scene import find
from canon.scene.scene import Scene
from canon.study.errors import StudyError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from sympy import Symbol

    from canon.flow.system.recognised_system import MovableSystem

__all__ = ["Subject", "checked_duration", "subject_of", "variables_of"]


@dataclass(frozen=True)
class Subject:
    """Motion that a study is about: a system with numbers and a start.

    Parameters
    ----------
    system
        What was asked for, a scene with the values that were asked for.
    hamiltonian
        What moves: the Hamiltonian, or what :func:`canon.propagate` takes where none says all, a scene itself with its
        forces and constraints among it.
    state, values
        State at the start, shape (2n,), and values of all parameters.
    title
        What the motion is called.
    """

    system: Any
    hamiltonian: Any
    state: NDArray[np.float64]
    values: Mapping[Symbol | str, float]
    title: str

    @property
    def period(self) -> float | None:
        """The period of a scene."""
        return self.system.period if isinstance(self.system, Scene) else None

    @property
    def time_unit(self) -> str:
        """The unit of time of a scene."""
        return self.system.time_unit if isinstance(self.system, Scene) else ""

    @property
    def depends_on_time(self) -> bool:
        """Whether H depends on the time."""
        return is_hamiltonian(self.hamiltonian) and self.hamiltonian.t in self.hamiltonian.H.free_symbols


def subject_of(
    system: Scene | MovableSystem,
    y0: ArrayLike | Mapping[Any, Any] | str | None,
    parameters: Mapping[Symbol | str, float] | None = None,
) -> Subject:
    """Return the motion of a system from a start or state, with these values of its parameters.

    Parameters
    ----------
    system
        Whatever :func:`canon.propagate` takes: a Hamiltonian, a Lagrangian with forces and constraints, a vector field,
        a scene or its name.
    y0
        The state, or a number for each variable; of a scene also the name of a start, its first one where None.
    parameters
        Values of the parameters; those of a scene replace its own.

    Raises
    ------
    StudyError
        Where nothing says where it starts.

    Examples
    --------
    >>> from canon.scene import find
    >>> heavy = subject_of(find("simple-pendulum"), "wide", {"m": 3.0})
    >>> heavy.values["m"], heavy.depends_on_time
    (3.0, False)
    """
    given = {str(name): value for name, value in (parameters or {}).items()}
    asked: Any = find(system) if isinstance(system, str) else system
    if not isinstance(asked, Scene):
        return Subject(asked, asked, _state_of(asked, y0), {**given}, type(asked).__name__)
    scene: Any = asked.with_parameters(**given)
    moving: Any = scene.hamiltonian if scene.is_free else scene
    values = SpareParameters({**scene.values})
    if y0 is None or isinstance(y0, str):
        state = np.asarray(opened(scene, y0, {}).y0, dtype=np.float64)
        return Subject(scene, moving, state, values, f"{scene.title}; {scene.start(y0).about}")
    return Subject(scene, moving, _state_of(moving, y0), values, scene.title)


def checked_duration(span: Any, y0: Any, function: str) -> None:
    """Refuse as a duration what is no positive, finite number.

    Parameters
    ----------
    span, y0
        The duration and the start as they were given, perhaps in each other's places.
    function
        What they were given to.

    Raises
    ------
    StudyError
        The duration is something else; the sentence says what to write.

    Examples
    --------
    >>> checked_duration((0, 1000), [1, 0], "choose")
    Traceback (most recent call last):
        ...
    canon.study.errors.StudyError: span = (0, 1000): give a duration, one number, as a study begins at t = 0: choose...
    """
    shown, number = reprlib.repr(span), span
    if isinstance(span, tuple) and len(span) == 2:  # as propagate has it
        raise StudyError(
            f"span = {shown}: give a duration, one number, as a study begins at t = 0: {function}(system, span, y0)"
        )
    try:
        fits = math.isfinite(number) and number > 0.0
    except (TypeError, OverflowError):
        swapped = f", {function}(system, {y0}, {shown})" if isinstance(y0, int | float) else ""
        raise StudyError(
            f"span should be a duration, one number, not {described(span)}: it comes before the state y0{swapped}"
        ) from None
    if not fits:
        raise StudyError(f"a span of {span} makes no sense: give a positive, finite duration")


def variables_of(system: Any) -> tuple[tuple[Symbol, ...], Symbol]:
    """Return the variables of a system's state in their order, and its time.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> x = coordinates("x")
    >>> variables_of(Lagrangian(x.dot**2 / 2, [x]))
    ((x, x_dot), t)
    """
    if is_scene(system):
        system = opened(system, (), {}).system
    if is_hamiltonian(system):
        return (*system.q, *system.p), system.t
    from canon.flow.system.recognised_system import recognised  # only here: it loads what derives equations

    found = recognised(system)
    return found.state, found.t


def _state_of(system: Any, y0: ArrayLike | Mapping[Any, Any] | str | None) -> NDArray[np.float64]:
    """Return the state of numbers, or of a number for each variable, shape (2n,)."""
    if y0 is None or isinstance(y0, str):
        raise StudyError(
            "a system that is no scene has no starts of its own: give the initial state as numbers"
        )
    y0 = read_by_labels(y0)
    if isinstance(y0, Mapping):
        return np.asarray(state_in_order(y0, variables_of(system)[0]), dtype=np.float64)
    return np.asarray(y0, dtype=np.float64)
