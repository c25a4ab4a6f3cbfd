"""Motion that is studied, as it is asked for: a scene and a start by name, or a Hamiltonian and numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.system_request import is_hamiltonian
from canon.scene.scene import Scene
from canon.study.errors import StudyError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray
    from sympy import Symbol

    from canon.flow.run.hamiltonian_system import HamiltonianSystem

__all__ = ["Subject", "motion_hamiltonian", "subject_of"]


@dataclass(frozen=True)
class Subject:
    """Motion that a study is about: a system with numbers and a start.

    Parameters
    ----------
    system, hamiltonian
        The scene with the values that were asked for, or the Hamiltonian; and the Hamiltonian itself.
    state, values
        State (q, p) at the start, shape (2n,), and values of all parameters.
    title
        What the motion is called.
    """

    system: Scene | HamiltonianSystem
    hamiltonian: HamiltonianSystem
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
    system: Scene | HamiltonianSystem,
    y0: ArrayLike | str | None,
    parameters: Mapping[Symbol | str, float] | None = None,
) -> Subject:
    """Return the motion of a scene or Hamiltonian from a start or state, with these values of its parameters.

    Raises
    ------
    StudyError
        Where no Hamiltonian alone describes the motion, or nothing says where it starts.

    Examples
    --------
    >>> from canon.scene import find
    >>> heavy = subject_of(find("simple-pendulum"), "wide", {"m": 3.0})
    >>> heavy.values["m"], heavy.depends_on_time
    (3.0, False)
    """
    given = {str(name): value for name, value in (parameters or {}).items()}
    if isinstance(system, Scene):
        scene = system.with_parameters(**given)
        hamiltonian = motion_hamiltonian(scene)
        return Subject(scene, hamiltonian, _state_of(scene, y0), {**scene.values}, _title_of(scene, y0))
    return Subject(system, system, _state_of(system, y0), {**given}, type(system).__name__)


def motion_hamiltonian(system: Scene | HamiltonianSystem) -> HamiltonianSystem:
    """Return the Hamiltonian of a scene, or the Hamiltonian itself.

    Raises
    ------
    StudyError
        Where constraints or forces without potential act on the scene.
    """
    if not isinstance(system, Scene):
        return system
    if not system.is_free:
        what = "constraints" if system.is_constrained else "forces without potential"
        raise StudyError(
            f"{system.name} has {what}, and methods are compared on motions that a Hamiltonian alone describes; "
            f"'canon scene {system.name} --run' runs it and checks what is known of it, "
            "'canon drift list' names the scenes to take"
        )
    return system.hamiltonian


def _state_of(system: Scene | HamiltonianSystem, y0: ArrayLike | str | None) -> NDArray[np.float64]:
    """Return the state (q, p) of a start or of numbers, shape (2n,)."""
    if isinstance(system, Scene) and (y0 is None or isinstance(y0, str)):
        return system.state(y0)
    if y0 is None or isinstance(y0, str):
        raise StudyError("a Hamiltonian has no starts of its own: give the initial state (q, p) as numbers")
    return np.asarray(y0, dtype=np.float64)


def _title_of(scene: Scene, y0: ArrayLike | str | None) -> str:
    if y0 is not None and not isinstance(y0, str):
        return scene.title
    return f"{scene.title}; {scene.start(y0).about}"
