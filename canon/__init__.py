"""canon tells whether a piece of mechanics is right, whether its simulation stays right, and what that costs.

Every public name is imported from its room when it is first used; ``import canon`` itself loads nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from canon.version import __version__

if TYPE_CHECKING:
    from canon.exercise.checking import check as check
    from canon.exercise.expect import expect as expect
    from canon.exercise.judge import judge as judge
    from canon.exercise.reading import InvalidClaim as InvalidClaim
    from canon.exercise.report import Judgement as Judgement
    from canon.exercise.report import Report as Report
    from canon.exercise.sheet import Claim as Claim
    from canon.exercise.sheet import Sheet as Sheet
    from canon.exercise.sheet import SheetError as SheetError
    from canon.exercise.sheet import read_sheet as read_sheet
    from canon.expression.language import parse_expression as parse_expression
    from canon.expression.symbol import Coordinate as Coordinate
    from canon.expression.symbol import coordinates as coordinates
    from canon.expression.symbol import parameters as parameters
    from canon.expression.symbol import time as time
    from canon.expression.symbol import time_derivative as time_derivative
    from canon.flow.event import Event as Event
    from canon.flow.geometry import flow_jacobian as flow_jacobian
    from canon.flow.geometry import reversal_error as reversal_error
    from canon.flow.geometry import symplecticity_defect as symplecticity_defect
    from canon.flow.measure import AccuracyWarning as AccuracyWarning
    from canon.flow.method import DOP853 as DOP853
    from canon.flow.method import RK4 as RK4
    from canon.flow.method import Gauss as Gauss
    from canon.flow.method import Splitting as Splitting
    from canon.flow.method import Taylor as Taylor
    from canon.flow.method import TimeTransformed as TimeTransformed
    from canon.flow.propagate import Interrupted as Interrupted
    from canon.flow.propagate import NonFiniteStateError as NonFiniteStateError
    from canon.flow.propagate import Trajectory as Trajectory
    from canon.flow.propagate import propagate as propagate
    from canon.flow.solvable import SABA as SABA
    from canon.flow.solvable import SBAB as SBAB
    from canon.flow.solvable import WisdomHolman as WisdomHolman
    from canon.flow.witness import brackets_at_points as brackets_at_points
    from canon.flow.witness import integral_drift as integral_drift
    from canon.flow.witness import symplectic_flow as symplectic_flow
    from canon.mechanics.appell import GibbsAppell as GibbsAppell
    from canon.mechanics.bilinear import bilinear_covariant as bilinear_covariant
    from canon.mechanics.body import Particle as Particle
    from canon.mechanics.body import PlanarBody as PlanarBody
    from canon.mechanics.body import RigidBody as RigidBody
    from canon.mechanics.body import kinetic_energy as kinetic_energy
    from canon.mechanics.bracket import lagrange_bracket as lagrange_bracket
    from canon.mechanics.bracket import lie_bracket as lie_bracket
    from canon.mechanics.bracket import poisson_bracket as poisson_bracket
    from canon.mechanics.constraint import ConstrainedLagrangian as ConstrainedLagrangian
    from canon.mechanics.force import lagrangian_of as lagrangian_of
    from canon.mechanics.generated import generated_transformation as generated_transformation
    from canon.mechanics.generating import GeneratingFunction as GeneratingFunction
    from canon.mechanics.hamiltonian import Hamiltonian as Hamiltonian
    from canon.mechanics.hamiltonian import legendre as legendre
    from canon.mechanics.implicit import ImplicitTransformation as ImplicitTransformation
    from canon.mechanics.inverse import inverse_transformation as inverse_transformation
    from canon.mechanics.lagrangian import Lagrangian as Lagrangian
    from canon.mechanics.new_hamiltonian import new_hamiltonian as new_hamiltonian
    from canon.mechanics.recovery import generating_function as generating_function
    from canon.mechanics.routh import routhian as routhian
    from canon.mechanics.symmetry import is_constant_of_motion as is_constant_of_motion
    from canon.mechanics.symmetry import is_gauge_equivalent as is_gauge_equivalent
    from canon.mechanics.symmetry import noether_charge as noether_charge
    from canon.mechanics.sympy_bridge import from_sympy_mechanics as from_sympy_mechanics
    from canon.mechanics.transformation import CanonicalTransformation as CanonicalTransformation
    from canon.mechanics.transformation import point_transformation as point_transformation
    from canon.mechanics.vector_field import VectorField as VectorField
    from canon.proof.domain import Domain as Domain
    from canon.proof.equations import equivalent_equations as equivalent_equations
    from canon.proof.vanish import equal as equal
    from canon.proof.vanish import vanishes as vanishes
    from canon.proof.verdict import Counterexample as Counterexample
    from canon.proof.verdict import Evidence as Evidence
    from canon.proof.verdict import Status as Status
    from canon.proof.verdict import Undecided as Undecided
    from canon.proof.verdict import Verdict as Verdict
    from canon.study.choose import Choice as Choice
    from canon.study.choose import choose as choose
    from canon.study.comparison import drift_study as drift_study
    from canon.study.definition import Study as Study
    from canon.study.definition import read_study as read_study
    from canon.study.drift import Drift as Drift
    from canon.study.drift import drift as drift
    from canon.study.precision import work_precision as work_precision
    from canon.study.result import results_of as results_of
    from canon.study.run import run_study as run_study

__all__ = [
    "DOP853",
    "RK4",
    "SABA",
    "SBAB",
    "AccuracyWarning",
    "CanonicalTransformation",
    "Choice",
    "Claim",
    "ConstrainedLagrangian",
    "Coordinate",
    "Counterexample",
    "Domain",
    "Drift",
    "Event",
    "Evidence",
    "Gauss",
    "GeneratingFunction",
    "GibbsAppell",
    "Hamiltonian",
    "ImplicitTransformation",
    "Interrupted",
    "InvalidClaim",
    "Judgement",
    "Lagrangian",
    "NonFiniteStateError",
    "Particle",
    "PlanarBody",
    "Report",
    "RigidBody",
    "Sheet",
    "SheetError",
    "Splitting",
    "Status",
    "Study",
    "Taylor",
    "TimeTransformed",
    "Trajectory",
    "Undecided",
    "VectorField",
    "Verdict",
    "WisdomHolman",
    "__version__",
    "bilinear_covariant",
    "brackets_at_points",
    "check",
    "choose",
    "coordinates",
    "drift",
    "drift_study",
    "equal",
    "equivalent_equations",
    "expect",
    "flow_jacobian",
    "from_sympy_mechanics",
    "generated_transformation",
    "generating_function",
    "integral_drift",
    "inverse_transformation",
    "is_constant_of_motion",
    "is_gauge_equivalent",
    "judge",
    "kinetic_energy",
    "lagrange_bracket",
    "lagrangian_of",
    "legendre",
    "lie_bracket",
    "new_hamiltonian",
    "noether_charge",
    "parameters",
    "parse_expression",
    "point_transformation",
    "poisson_bracket",
    "propagate",
    "read_sheet",
    "read_study",
    "results_of",
    "reversal_error",
    "routhian",
    "run_study",
    "symplectic_flow",
    "symplecticity_defect",
    "time",
    "time_derivative",
    "vanishes",
    "work_precision",
]

_ROOMS = {
    "canon.exercise.checking": ("check",),
    "canon.exercise.expect": ("expect",),
    "canon.exercise.judge": ("judge",),
    "canon.exercise.reading": ("InvalidClaim",),
    "canon.exercise.report": ("Judgement", "Report"),
    "canon.exercise.sheet": ("Claim", "Sheet", "SheetError", "read_sheet"),
    "canon.expression.language": ("parse_expression",),
    "canon.expression.symbol": ("Coordinate", "coordinates", "parameters", "time", "time_derivative"),
    "canon.flow.event": ("Event",),
    "canon.flow.geometry": ("flow_jacobian", "reversal_error", "symplecticity_defect"),
    "canon.flow.measure": ("AccuracyWarning",),
    "canon.flow.method": ("DOP853", "Gauss", "RK4", "Splitting", "Taylor", "TimeTransformed"),
    "canon.flow.propagate": ("Interrupted", "NonFiniteStateError", "Trajectory", "propagate"),
    "canon.flow.solvable": ("SABA", "SBAB", "WisdomHolman"),
    "canon.flow.witness": ("brackets_at_points", "integral_drift", "symplectic_flow"),
    "canon.mechanics.appell": ("GibbsAppell",),
    "canon.mechanics.bilinear": ("bilinear_covariant",),
    "canon.mechanics.body": ("Particle", "PlanarBody", "RigidBody", "kinetic_energy"),
    "canon.mechanics.bracket": ("lagrange_bracket", "lie_bracket", "poisson_bracket"),
    "canon.mechanics.constraint": ("ConstrainedLagrangian",),
    "canon.mechanics.force": ("lagrangian_of",),
    "canon.mechanics.generated": ("generated_transformation",),
    "canon.mechanics.generating": ("GeneratingFunction",),
    "canon.mechanics.recovery": ("generating_function",),
    "canon.mechanics.hamiltonian": ("Hamiltonian", "legendre"),
    "canon.mechanics.implicit": ("ImplicitTransformation",),
    "canon.mechanics.inverse": ("inverse_transformation",),
    "canon.mechanics.lagrangian": ("Lagrangian",),
    "canon.mechanics.new_hamiltonian": ("new_hamiltonian",),
    "canon.mechanics.routh": ("routhian",),
    "canon.mechanics.symmetry": ("is_constant_of_motion", "is_gauge_equivalent", "noether_charge"),
    "canon.mechanics.sympy_bridge": ("from_sympy_mechanics",),
    "canon.mechanics.transformation": ("CanonicalTransformation", "point_transformation"),
    "canon.mechanics.vector_field": ("VectorField",),
    "canon.proof.domain": ("Domain",),
    "canon.proof.equations": ("equivalent_equations",),
    "canon.proof.vanish": ("equal", "vanishes"),
    "canon.proof.verdict": ("Counterexample", "Evidence", "Status", "Undecided", "Verdict"),
    "canon.study.choose": ("Choice", "choose"),
    "canon.study.comparison": ("drift_study",),
    "canon.study.definition": ("Study", "read_study"),
    "canon.study.drift": ("Drift", "drift"),
    "canon.study.precision": ("work_precision",),
    "canon.study.result": ("results_of",),
    "canon.study.run": ("run_study",),
}
_SUBJECTS = ("exercise", "expression", "flow", "kernel", "mechanics", "plot", "proof", "scene", "study")
_HOME = {name: room for room, names in _ROOMS.items() for name in names}


def __getattr__(name: str) -> Any:
    room = _HOME.get(name)
    if room is None and name in _SUBJECTS:
        return importlib.import_module(f"canon.{name}")
    if room is None:
        import difflib

        close = difflib.get_close_matches(name, __all__, n=1)
        raise AttributeError(
            f"canon has no public name {name!r}" + (f", did you mean {close[0]}?" if close else "")
        )
    return getattr(importlib.import_module(room), name)


def __dir__() -> list[str]:
    return sorted(__all__)
