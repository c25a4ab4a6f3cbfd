"""canon tells whether a piece of mechanics is right, whether its simulation stays right, and what that costs.

Every public name is imported from its room when it is first used; ``import canon`` itself loads nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from canon.exercise.judge import check, judge
    from canon.exercise.sheet import Claim, Sheet, read_sheet
    from canon.expression.language import parse_expression
    from canon.expression.symbol import Coordinate, coordinates, parameters, time, time_derivative
    from canon.flow.method import DOP853, RK4, Splitting, Taylor
    from canon.flow.propagate import Trajectory, propagate
    from canon.mechanics.bracket import poisson_bracket
    from canon.mechanics.generating import GeneratingFunction, generating_function
    from canon.mechanics.hamiltonian import Hamiltonian
    from canon.mechanics.lagrangian import Lagrangian
    from canon.mechanics.transformation import CanonicalTransformation
    from canon.proof.domain import Domain
    from canon.proof.vanish import equal, equivalent_equations, vanishes
    from canon.proof.verdict import Counterexample, Evidence, Status, Undecided, Verdict
    from canon.study.drift import Drift, drift

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
