"""canon tells whether a piece of mechanics is right, whether its simulation stays right, and what that costs.

Every public name is imported from its room when it is first used; ``import canon`` itself loads nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from canon.exercise.judge import check as check, judge as judge
    from canon.exercise.sheet import Claim as Claim, Sheet as Sheet, read_sheet as read_sheet
    from canon.expression.language import parse_expression as parse_expression
    from canon.expression.symbol import Coordinate as Coordinate, coordinates as coordinates, parameters as parameters, time as time, time_derivative as time_derivative
    from canon.flow.method import DOP853 as DOP853, RK4 as RK4, Splitting as Splitting, Taylor as Taylor
    from canon.flow.propagate import Trajectory as Trajectory, propagate as propagate
    from canon.mechanics.bracket import poisson_bracket as poisson_bracket
    from canon.mechanics.generating import GeneratingFunction as GeneratingFunction, generating_function as generating_function
    from canon.mechanics.hamiltonian import Hamiltonian as Hamiltonian
    from canon.mechanics.lagrangian import Lagrangian as Lagrangian
    from canon.mechanics.transformation import CanonicalTransformation as CanonicalTransformation
    from canon.proof.domain import Domain as Domain
    from canon.proof.vanish import equal as equal, equivalent_equations as equivalent_equations, vanishes as vanishes
    from canon.proof.verdict import Counterexample as Counterexample, Evidence as Evidence, Status as Status, Undecided as Undecided, Verdict as Verdict
    from canon.study.drift import Drift as Drift, drift as drift

__version__ = "0.1.0"

_ROOMS = {
    "canon.exercise.judge": ("check", "judge"),
    "canon.exercise.sheet": ("Claim", "Sheet", "read_sheet"),
    "canon.expression.language": ("parse_expression",),
    "canon.expression.symbol": ("Coordinate", "coordinates", "parameters", "time", "time_derivative"),
    "canon.flow.method": ("DOP853", "RK4", "Splitting", "Taylor"),
    "canon.flow.propagate": ("Trajectory", "propagate"),
    "canon.mechanics.bracket": ("poisson_bracket",),
    "canon.mechanics.generating": ("GeneratingFunction", "generating_function"),
    "canon.mechanics.hamiltonian": ("Hamiltonian",),
    "canon.mechanics.lagrangian": ("Lagrangian",),
    "canon.mechanics.transformation": ("CanonicalTransformation",),
    "canon.proof.domain": ("Domain",),
    "canon.proof.vanish": ("equal", "equivalent_equations", "vanishes"),
    "canon.proof.verdict": ("Counterexample", "Evidence", "Status", "Undecided", "Verdict"),
    "canon.study.drift": ("Drift", "drift"),
}
_HOME = {name: room for room, names in _ROOMS.items() for name in names}

__all__ = [  # noqa: PLE0604, RUF022  (kept by room above; a test holds both lists together)
    *sorted(_HOME),
    "__version__",
]


def __getattr__(name: str) -> Any:
    room = _HOME.get(name)
    if room is None:
        raise AttributeError(f"canon has no public name {name!r}")
    return getattr(importlib.import_module(room), name)


def __dir__() -> list[str]:
    return sorted(__all__)
