"""canon tells whether a piece of mechanics is right, whether its simulation stays right, and what that costs.

Every public name is imported from its room when it is first used; ``import canon`` itself loads nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from canon.version import __version__

if TYPE_CHECKING:
    from canon.exercise.judge import judge as judge
    from canon.exercise.sheet import Claim as Claim
    from canon.exercise.sheet import Sheet as Sheet
    from canon.exercise.sheet import read_sheet as read_sheet
    from canon.expression.language import parse_expression as parse_expression
    from canon.expression.symbol import Coordinate as Coordinate
    from canon.expression.symbol import coordinates as coordinates
    from canon.expression.symbol import parameters as parameters
    from canon.expression.symbol import time as time
    from canon.expression.symbol import time_derivative as time_derivative
    from canon.flow.method import DOP853 as DOP853
    from canon.flow.method import RK4 as RK4
    from canon.flow.method import Gauss as Gauss
    from canon.flow.method import Splitting as Splitting
    from canon.flow.method import Taylor as Taylor
    from canon.flow.propagate import Trajectory as Trajectory
    from canon.flow.propagate import propagate as propagate
    from canon.mechanics.bracket import lagrange_bracket as lagrange_bracket
    from canon.mechanics.bracket import lie_bracket as lie_bracket
    from canon.mechanics.bracket import poisson_bracket as poisson_bracket
    from canon.mechanics.generating import GeneratingFunction as GeneratingFunction
    from canon.mechanics.generating import generating_function as generating_function
    from canon.mechanics.hamiltonian import Hamiltonian as Hamiltonian
    from canon.mechanics.lagrangian import Lagrangian as Lagrangian
    from canon.mechanics.transformation import CanonicalTransformation as CanonicalTransformation
    from canon.proof.domain import Domain as Domain
    from canon.proof.equations import equivalent_equations as equivalent_equations
    from canon.proof.vanish import equal as equal
    from canon.proof.vanish import vanishes as vanishes
    from canon.proof.verdict import Counterexample as Counterexample
    from canon.proof.verdict import Evidence as Evidence
    from canon.proof.verdict import Status as Status
    from canon.proof.verdict import Undecided as Undecided
    from canon.proof.verdict import Verdict as Verdict
    from canon.study.comparison import drift_study as drift_study
    from canon.study.drift import Drift as Drift
    from canon.study.drift import drift as drift


__all__ = [
    "DOP853",
    "RK4",
    "CanonicalTransformation",
    "Claim",
    "Coordinate",
    "Counterexample",
    "Domain",
    "Drift",
    "Evidence",
    "Gauss",
    "GeneratingFunction",
    "Hamiltonian",
    "Lagrangian",
    "Sheet",
    "Splitting",
    "Status",
    "Taylor",
    "Trajectory",
    "Undecided",
    "Verdict",
    "__version__",
    "coordinates",
    "drift",
    "drift_study",
    "equal",
    "equivalent_equations",
    "generating_function",
    "judge",
    "lagrange_bracket",
    "lie_bracket",
    "parameters",
    "parse_expression",
    "poisson_bracket",
    "propagate",
    "read_sheet",
    "time",
    "time_derivative",
    "vanishes",
]

_ROOMS = {
    "canon.exercise.judge": ("judge",),
    "canon.exercise.sheet": ("Claim", "Sheet", "read_sheet"),
    "canon.expression.language": ("parse_expression",),
    "canon.expression.symbol": ("Coordinate", "coordinates", "parameters", "time", "time_derivative"),
    "canon.flow.method": ("DOP853", "RK4", "Gauss", "Splitting", "Taylor"),
    "canon.flow.propagate": ("Trajectory", "propagate"),
    "canon.mechanics.bracket": ("lagrange_bracket", "lie_bracket", "poisson_bracket"),
    "canon.mechanics.generating": ("GeneratingFunction", "generating_function"),
    "canon.mechanics.hamiltonian": ("Hamiltonian",),
    "canon.mechanics.lagrangian": ("Lagrangian",),
    "canon.mechanics.transformation": ("CanonicalTransformation",),
    "canon.proof.domain": ("Domain",),
    "canon.proof.equations": ("equivalent_equations",),
    "canon.proof.vanish": ("equal", "vanishes"),
    "canon.proof.verdict": ("Counterexample", "Evidence", "Status", "Undecided", "Verdict"),
    "canon.study.comparison": ("drift_study",),
    "canon.study.drift": ("Drift", "drift"),
}
_HOME = {name: room for room, names in _ROOMS.items() for name in names}


def __getattr__(name: str) -> Any:
    room = _HOME.get(name)
    if room is None:
        raise AttributeError(f"canon has no public name {name!r}")
    return getattr(importlib.import_module(room), name)


def __dir__() -> list[str]:
    return sorted(__all__)
