import sympy as sp

from .exercise.claim_verdict import judge as judge
from .exercise.expect import expect as expect
from .exercise.sheet.sheet import read_sheet as read_sheet
from .exercise.sheet_check import check as check
from .expression.symbols.symbol import coordinates as coordinates
from .expression.symbols.symbol import parameters as parameters
from .expression.symbols.symbol import time_derivative as time_derivative
from .flow.geometry.flow_jacobian import flow_jacobian as flow_jacobian
from .flow.loaded_motion import load_motion as load_motion
from .flow.method.adaptive_methods import DOP853 as DOP853
from .flow.method.adaptive_methods import Taylor as Taylor
from .flow.method.method import RK4 as RK4
from .flow.method.method import Gauss as Gauss
from .flow.method.method import Splitting as Splitting
from .flow.method.method import TimeTransformed as TimeTransformed
from .flow.method.solvable_splitting import SABA as SABA
from .flow.method.solvable_splitting import WisdomHolman as WisdomHolman
from .flow.propagation import propagate as propagate
from .flow.run.event import Event as Event
from .flow.run.observables_along import AccuracyWarning as AccuracyWarning
from .mechanics.canonical.find_generating_function import generating_function as generating_function
from .mechanics.canonical.from_generating_function import generated_transformation as generated_transformation
from .mechanics.canonical.generating_function import GeneratingFunction as GeneratingFunction
from .mechanics.canonical.inverse.inverse_transformation import (
    inverse_transformation as inverse_transformation,
)
from .mechanics.canonical.new_hamiltonian import new_hamiltonian as new_hamiltonian
from .mechanics.canonical.transformation import CanonicalTransformation as CanonicalTransformation
from .mechanics.canonical.transformation import point_transformation as point_transformation
from .mechanics.hamilton.bracket import lagrange_bracket as lagrange_bracket
from .mechanics.hamilton.bracket import lie_bracket as lie_bracket
from .mechanics.hamilton.bracket import poisson_bracket as poisson_bracket
from .mechanics.hamilton.hamiltonian import Hamiltonian as Hamiltonian
from .mechanics.hamilton.legendre_pair import hamiltonian as hamiltonian
from .mechanics.hamilton.legendre_pair import lagrangian as lagrangian
from .mechanics.hamilton.pfaffian_form import bilinear_covariant as bilinear_covariant
from .mechanics.hamilton.symmetry import is_constant_of_motion as is_constant_of_motion
from .mechanics.hamilton.symmetry import noether_charge as noether_charge
from .mechanics.hamilton.vector_field import VectorField as VectorField
from .mechanics.lagrange.appell import GibbsAppell as GibbsAppell
from .mechanics.lagrange.body import Particle as Particle
from .mechanics.lagrange.body import PlanarBody as PlanarBody
from .mechanics.lagrange.body import RigidBody as RigidBody
from .mechanics.lagrange.body import kinetic_energy as kinetic_energy
from .mechanics.lagrange.constraint import ConstrainedLagrangian as ConstrainedLagrangian
from .mechanics.lagrange.force import lagrangian_of_bodies as lagrangian_of_bodies
from .mechanics.lagrange.lagrangian import Lagrangian as Lagrangian
from .mechanics.lagrange.sympy_bridge import from_sympy_mechanics as from_sympy_mechanics
from .mechanics.perturbation.birkhoff import birkhoff_normal_form as birkhoff_normal_form
from .mechanics.reduction.routh import routhian as routhian
from .proof.domain.domain import Domain as Domain
from .proof.domain.verdict import Verdict as Verdict
from .proof.equivalence import equivalent_equations as equivalent_equations
from .proof.vanish import equal as equal
from .proof.vanish import vanishes as vanishes
from .study.cases.result import results_of as results_of
from .study.cases.run_study import run_study as run_study
from .study.cases.study import Study as Study
from .study.cases.study import read_study as read_study
from .study.energy_drift.drift import drift as drift
from .study.energy_drift.drift_study import drift_study as drift_study
from .study.method_choice.choose import choose as choose
from .study.method_choice.work_precision import work_precision as work_precision
from .version import __version__ as __version__

time: sp.Symbol
