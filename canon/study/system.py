"""What a motion is asked for by: a scene and a start by name, or a Hamiltonian and numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from canon.scene.scene import Scene
from canon.study.errors import StudyError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray
    from sympy import Symbol

    from canon.flow.propagate import HamiltonianSystem

__all__ = ["motion_hamiltonian", "parameters_of", "period_of", "state_of", "time_unit_of", "title_of"]


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


def period_of(system: Scene | HamiltonianSystem) -> float | None:
    """Return the period of a scene."""
    return system.period if isinstance(system, Scene) else None


def state_of(system: Scene | HamiltonianSystem, y0: ArrayLike | str | None) -> NDArray[np.float64]:
    """Return the state (q, p) of a start or of numbers, shape (2n,)."""
    if isinstance(system, Scene) and (y0 is None or isinstance(y0, str)):
        return system.state(y0)
    if y0 is None or isinstance(y0, str):
        raise StudyError("a Hamiltonian has no starts of its own: give the initial state (q, p) as numbers")
    return np.asarray(y0, dtype=np.float64)


def parameters_of(
    system: Scene | HamiltonianSystem, parameters: Mapping[Symbol | str, float] | None
) -> Mapping[Symbol | str, float]:
    """Return the values of all parameters."""
    given = {str(name): value for name, value in (parameters or {}).items()}
    if isinstance(system, Scene):
        return {**system.with_parameters(**given).values}
    return {**given}


def title_of(system: Scene | HamiltonianSystem, y0: ArrayLike | str | None) -> str:
    """Return what a motion is called."""
    if not isinstance(system, Scene):
        return "Hamiltonian"
    if y0 is not None and not isinstance(y0, str):
        return system.title
    return f"{system.title}; {system.start(y0).about}"


def time_unit_of(system: Scene | HamiltonianSystem) -> str:
    """Return the unit of time of a scene."""
    return system.time_unit if isinstance(system, Scene) else ""
