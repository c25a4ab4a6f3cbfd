"""canon tells whether a piece of mechanics is right, whether its simulation stays right, and what that costs.

Every public name is imported from its room when it is first used; ``import canon`` itself loads nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from canon.version import __version__

if TYPE_CHECKING:
    from canon.exercise.check import check as check
    from canon.exercise.expect import expect as expect
    from canon.exercise.judge import judge as judge
    from canon.exercise.report.report import Judgement as Judgement
    from canon.exercise.report.report import Report as Report
    from canon.exercise.sheet.reading import InvalidClaim as InvalidClaim
    from canon.exercise.sheet.sheet import Claim as Claim
    from canon.exercise.sheet.sheet import Sheet as Sheet
    from canon.exercise.sheet.sheet import SheetError as SheetError
    from canon.exercise.sheet.sheet import read_sheet as read_sheet
    from canon.expression.parse import parse_expression as parse_expression
    from canon.expression.symbols.symbol import Coordinate as Coordinate
    from canon.expression.symbols.symbol import coordinates as coordinates
    from canon.expression.symbols.symbol import parameters as parameters
    from canon.expression.symbols.symbol import time as time
    from canon.expression.symbols.symbol import time_derivative as time_derivative
    from canon.flow.geometry.flow_jacobian import flow_jacobian as flow_jacobian
    from canon.flow.geometry.flow_jacobian import reversal_error as reversal_error
    from canon.flow.geometry.flow_jacobian import symplecticity_defect as symplecticity_defect
    from canon.flow.geometry.numeric_evidence import brackets_at_points as brackets_at_points
    from canon.flow.geometry.numeric_evidence import integral_drift as integral_drift
    from canon.flow.geometry.numeric_evidence import symplectic_flow as symplectic_flow
    from canon.flow.method.method import DOP853 as DOP853
    from canon.flow.method.method import RK4 as RK4
    from canon.flow.method.method import Gauss as Gauss
    from canon.flow.method.method import Splitting as Splitting
    from canon.flow.method.method import Taylor as Taylor
    from canon.flow.method.method import TimeTransformed as TimeTransformed
    from canon.flow.method.solvable_splitting import SABA as SABA
    from canon.flow.method.solvable_splitting import SBAB as SBAB
    from canon.flow.method.solvable_splitting import WisdomHolman as WisdomHolman
    from canon.flow.propagate import Interrupted as Interrupted
    from canon.flow.propagate import Trajectory as Trajectory
    from canon.flow.propagate import propagate as propagate
    from canon.flow.run.event import Event as Event
    from canon.flow.run.non_finite_state import NonFiniteStateError as NonFiniteStateError
    from canon.flow.run.observables_along import AccuracyWarning as AccuracyWarning
    from canon.mechanics.canonical.find_generating_function import generating_function as generating_function
    from canon.mechanics.canonical.from_generating_function import (
        generated_transformation as generated_transformation,
    )
    from canon.mechanics.canonical.generating_function import GeneratingFunction as GeneratingFunction
    from canon.mechanics.canonical.implicit_transformation import (
        ImplicitTransformation as ImplicitTransformation,
    )
    from canon.mechanics.canonical.inverse_transformation import (
        inverse_transformation as inverse_transformation,
    )
    from canon.mechanics.canonical.new_hamiltonian import new_hamiltonian as new_hamiltonian
    from canon.mechanics.canonical.transformation import CanonicalTransformation as CanonicalTransformation
    from canon.mechanics.canonical.transformation import point_transformation as point_transformation
    from canon.mechanics.hamilton.bracket import lagrange_bracket as lagrange_bracket
    from canon.mechanics.hamilton.bracket import lie_bracket as lie_bracket
    from canon.mechanics.hamilton.bracket import poisson_bracket as poisson_bracket
    from canon.mechanics.hamilton.hamiltonian import Hamiltonian as Hamiltonian
    from canon.mechanics.hamilton.hamiltonian import legendre as legendre
    from canon.mechanics.hamilton.pfaffian_form import bilinear_covariant as bilinear_covariant
    from canon.mechanics.hamilton.symmetry import is_constant_of_motion as is_constant_of_motion
    from canon.mechanics.hamilton.symmetry import is_gauge_equivalent as is_gauge_equivalent
    from canon.mechanics.hamilton.symmetry import noether_charge as noether_charge
    from canon.mechanics.hamilton.vector_field import VectorField as VectorField
    from canon.mechanics.lagrange.appell import GibbsAppell as GibbsAppell
    from canon.mechanics.lagrange.body import Particle as Particle
    from canon.mechanics.lagrange.body import PlanarBody as PlanarBody
    from canon.mechanics.lagrange.body import RigidBody as RigidBody
    from canon.mechanics.lagrange.body import kinetic_energy as kinetic_energy
    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian as ConstrainedLagrangian
    from canon.mechanics.lagrange.force import lagrangian_of as lagrangian_of
    from canon.mechanics.lagrange.lagrangian import Lagrangian as Lagrangian
    from canon.mechanics.lagrange.sympy_bridge import from_sympy_mechanics as from_sympy_mechanics
    from canon.mechanics.reduction.routh import routhian as routhian
    from canon.proof.domain.domain import Domain as Domain
    from canon.proof.domain.verdict import Counterexample as Counterexample
    from canon.proof.domain.verdict import Evidence as Evidence
    from canon.proof.domain.verdict import Status as Status
    from canon.proof.domain.verdict import Undecided as Undecided
    from canon.proof.domain.verdict import Verdict as Verdict
    from canon.proof.equivalent_equations import equivalent_equations as equivalent_equations
    from canon.proof.vanish import equal as equal
    from canon.proof.vanish import vanishes as vanishes
    from canon.study.cases.result import results_of as results_of
    from canon.study.cases.run_study import run_study as run_study
    from canon.study.cases.study import Study as Study
    from canon.study.cases.study import read_study as read_study
    from canon.study.choose.choose import Choice as Choice
    from canon.study.choose.choose import choose as choose
    from canon.study.choose.work_precision import work_precision as work_precision
    from canon.study.drift.drift import Drift as Drift
    from canon.study.drift.drift import drift as drift
    from canon.study.drift.drift_study import drift_study as drift_study

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
    "canon.exercise.check": ("check",),
    "canon.exercise.expect": ("expect",),
    "canon.exercise.judge": ("judge",),
    "canon.exercise.sheet.reading": ("InvalidClaim",),
    "canon.exercise.report.report": ("Judgement", "Report"),
    "canon.exercise.sheet.sheet": ("Claim", "Sheet", "SheetError", "read_sheet"),
    "canon.expression.parse": ("parse_expression",),
    "canon.expression.symbols.symbol": ("Coordinate", "coordinates", "parameters", "time", "time_derivative"),
    "canon.flow.run.event": ("Event",),
    "canon.flow.geometry.flow_jacobian": ("flow_jacobian", "reversal_error", "symplecticity_defect"),
    "canon.flow.run.observables_along": ("AccuracyWarning",),
    "canon.flow.method.method": ("DOP853", "Gauss", "RK4", "Splitting", "Taylor", "TimeTransformed"),
    "canon.flow.propagate": ("Interrupted", "NonFiniteStateError", "Trajectory", "propagate"),
    "canon.flow.method.solvable_splitting": ("SABA", "SBAB", "WisdomHolman"),
    "canon.flow.geometry.numeric_evidence": ("brackets_at_points", "integral_drift", "symplectic_flow"),
    "canon.mechanics.lagrange.appell": ("GibbsAppell",),
    "canon.mechanics.hamilton.pfaffian_form": ("bilinear_covariant",),
    "canon.mechanics.lagrange.body": ("Particle", "PlanarBody", "RigidBody", "kinetic_energy"),
    "canon.mechanics.hamilton.bracket": ("lagrange_bracket", "lie_bracket", "poisson_bracket"),
    "canon.mechanics.lagrange.constraint": ("ConstrainedLagrangian",),
    "canon.mechanics.lagrange.force": ("lagrangian_of",),
    "canon.mechanics.canonical.from_generating_function": ("generated_transformation",),
    "canon.mechanics.canonical.generating_function": ("GeneratingFunction",),
    "canon.mechanics.canonical.find_generating_function": ("generating_function",),
    "canon.mechanics.hamilton.hamiltonian": ("Hamiltonian", "legendre"),
    "canon.mechanics.canonical.implicit_transformation": ("ImplicitTransformation",),
    "canon.mechanics.canonical.inverse_transformation": ("inverse_transformation",),
    "canon.mechanics.lagrange.lagrangian": ("Lagrangian",),
    "canon.mechanics.canonical.new_hamiltonian": ("new_hamiltonian",),
    "canon.mechanics.reduction.routh": ("routhian",),
    "canon.mechanics.hamilton.symmetry": ("is_constant_of_motion", "is_gauge_equivalent", "noether_charge"),
    "canon.mechanics.lagrange.sympy_bridge": ("from_sympy_mechanics",),
    "canon.mechanics.canonical.transformation": ("CanonicalTransformation", "point_transformation"),
    "canon.mechanics.hamilton.vector_field": ("VectorField",),
    "canon.proof.domain.domain": ("Domain",),
    "canon.proof.equivalent_equations": ("equivalent_equations",),
    "canon.proof.vanish": ("equal", "vanishes"),
    "canon.proof.domain.verdict": ("Counterexample", "Evidence", "Status", "Undecided", "Verdict"),
    "canon.study.choose.choose": ("Choice", "choose"),
    "canon.study.drift.drift_study": ("drift_study",),
    "canon.study.cases.study": ("Study", "read_study"),
    "canon.study.drift.drift": ("Drift", "drift"),
    "canon.study.choose.work_precision": ("work_precision",),
    "canon.study.cases.result": ("results_of",),
    "canon.study.cases.run_study": ("run_study",),
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
