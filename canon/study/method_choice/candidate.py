"""Candidates of a choice: the methods that apply, and what is expected of each over the whole span."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from sympy import Pow

from canon.flow.checked_request import hamilton_equations_of
from canon.flow.method.constrained_method import (
    NonholonomicLeapfrog,
    NotForLeapfrogError,
    NotForRattleError,
    Rattle,
)
from canon.flow.method.engine import FICTITIOUS_TIME
from canon.flow.method.lie_poisson_splitting import LiePoissonSplitting, NoLiePoissonPartsError
from canon.flow.method.magnetic_methods import Boris, MagneticSplitting
from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor, TimeTransformed
from canon.flow.method.nonseparable_splitting import ExtendedPhaseSpace, SemiexplicitSplitting
from canon.flow.method.setting import Setting
from canon.flow.method.solvable_splitting import SABA, WisdomHolman
from canon.flow.propagation import is_separable
from canon.flow.request import Request
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.system_request import any_task, is_hamiltonian
from canon.kernel.schemes.splitting_schemes import SCHEMES
from canon.kernel.solvable.solvable_parts import Planets, Quadratic, UnsolvableError, solvable_part
from canon.study.method_choice.error_law import expected_error, order_of
from canon.study.method_choice.pilot_run import Pilot, pilot, seconds_per_time
from canon.study.method_choice.resolution import least_error

if TYPE_CHECKING:
    from canon.flow.method.method import Method
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.study.method_choice.choice_question import Question

__all__ = [
    "HOPELESS",
    "MARGIN",
    "PILOTS",
    "Candidate",
    "TriedSetting",
    "by_order",
    "candidate_methods",
    "candidate_of",
    "nothing",
    "tried_with",
]

MARGIN = 0.85
"""Share of the accuracy that is aimed at; what is above this and below one is taken as it is."""

PILOTS = 9
"""Pilot runs a method gets at most."""

HOPELESS = 4.0
"""How many times dearer than the best so far a method may be expected to be before its search ends."""

IN_FICTITIOUS_TIME = ("verlet", "blanes-moan-6", "kahan-li-8")
"""Splittings that are considered with steps that vary along the orbit: Verlet's puts Kepler's motion on its ellipse."""

HELD_BY = 2.0
"""How many times the fastest rate of the motion at its start holds two copies of the phase space together."""

DENSEST = 8
"""How many times the operations of the force a drift by a matrix may take: about what its larger steps can gain."""


@dataclass(frozen=True)
class Candidate:
    """A method at the step or tolerance it needs, or why it does not reach the accuracy.

    Parameters
    ----------
    method, step, tolerance, precision
        As :func:`canon.flow.propagation.propagate` takes them; a step or tolerance is None where the method
        has the other.
    predicted_error
        Largest error expected over the span.
    predicted_cost
        Processor seconds expected of the steps.
    evaluations
        Evaluations of the force expected (Taylor: of the series).
    keeps
        Whether the accuracy is expected to be kept.
    resonant
        Whether a neighbouring step was resonant and had to be avoided.
    note
        What else there is to say.
    seen
        Duration of the longest pilot run behind this; the whole span where the error was seen and not extrapolated, 0
        where the setting itself was not tried.
    """

    method: Method
    step: float | None
    tolerance: float | None
    precision: str
    predicted_error: float
    predicted_cost: float
    evaluations: float
    keeps: bool
    resonant: bool = False
    note: str = ""
    seen: float = 0.0

    def __repr__(self) -> str:
        step = f", step {self.step:.4g}" if self.step is not None else ""
        tolerance = f", tol {self.tolerance:.2g}" if self.tolerance is not None else ""
        kept = "kept" if self.keeps else "not kept"
        error = f"error {self.predicted_error:.1e}"
        return f"<Candidate: {self.method}{step}{tolerance}, {self.precision}: {kept}, {error}>"

    @property
    def setting(self) -> Setting:
        """The method with its step or tolerance and its precision, as one value."""
        return Setting(self.method, self.step, self.tolerance, self.precision)


def candidate_methods(question: Question) -> tuple[Method, ...]:
    """Return the methods that apply, those first that are usually the cheapest.

    Splittings where H = T(p) + V(q), in a fictitious time too where V has a singularity, else Gauss's methods and
    splittings of two copies of the phase space, with Boris's push and magnetic splittings where H = (p − A)²/2m + φ;
    Wisdom & Holman's and its kin where H is a disturbed motion known in closed form; Taylor's, and two ordinary ones
    for comparison. Where there are no canonical variables, the last three alone, with RATTLE for holonomic
    constraints and the leapfrog for those on velocities, Lie–Poisson splittings and Gauss's methods for Poisson
    systems.
    """
    if not is_hamiltonian(question.hamiltonian):
        return Taylor(), *_of_constraints(question), *_of_rotations(question), DOP853(), RK4()
    others = *_of_disturbed(question), RK4(), DOP853()
    if not is_separable(question.hamiltonian, question.values):
        charges = _of_charges(question)
        return Taylor(), *charges, *(Gauss(s) for s in (4, 3, 2, 6, 8, 1)), *_of_two_copies(question), *others
    names = sorted(SCHEMES, key=lambda name: -SCHEMES[name].order)
    return Taylor(), *(Splitting(name) for name in names), *_of_close_encounters(question), *others


def _of_charges(question: Question) -> tuple[Method, ...]:
    """Return methods for H = Σ (p − A)²/2m + φ, charges and rotating frames, where H is that."""
    from canon.flow.fixed_step.gauge_integrals import gauge_shifts
    from canon.kernel.magnetic.magnetic_form import NotMagneticError, magnetic_form

    system = hamilton_equations_of(question.hamiltonian, question.values)
    try:
        magnetic_form(system)
    except NotMagneticError:
        return ()
    pushes = tuple(Boris(order) for order in (4, 2, 6))
    try:
        gauge_shifts(system)
    except NotMagneticError:
        return pushes
    return *(MagneticSplitting(order) for order in (6, 4, 8, 2)), *pushes


def _of_constraints(question: Question) -> tuple[Method, ...]:
    """Return methods that keep constraints themselves, where they apply."""
    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian

    system: Any = question.hamiltonian
    if not isinstance(system, ConstrainedLagrangian):
        return ()
    if system.nonholonomic:
        applies = _applies(question, NonholonomicLeapfrog(), NotForLeapfrogError)
        return tuple(NonholonomicLeapfrog(order) for order in (4, 6, 2)) if applies else ()
    return (Rattle(4), Rattle(6)) if _applies(question, Rattle(), NotForRattleError) else ()


def _of_rotations(question: Question) -> tuple[Method, ...]:
    """Return splittings on Poisson manifolds, where the parts of H have flows that are known, and Gauss's methods.

    Those are no Poisson maps, but keep Casimir functions that are quadratic.
    """
    from canon.mechanics.hamilton.poisson_system import PoissonSystem

    system: Any = question.hamiltonian
    if not isinstance(system, PoissonSystem):
        return ()
    implicit = Gauss(4), Gauss(6), Gauss(2)
    if not _applies(question, LiePoissonSplitting(), NoLiePoissonPartsError):
        return implicit
    return *(LiePoissonSplitting(order) for order in (4, 6, 2, 8)), *implicit


def _applies(question: Question, method: Method, refusal: type[ValueError]) -> bool:
    """Tell whether a method takes the system of a question."""
    system: Any = question.hamiltonian
    span = (question.since, question.since + question.span)
    request = Request(
        system, span, question.y0, method=method, step=question.span, parameters=question.values
    )
    try:
        any_task(request)
    except refusal:
        return False
    return True


def _of_two_copies(question: Question) -> tuple[Method, ...]:
    """Return splittings of the doubled phase space; the copies are held by twice the fastest rate at the start."""
    projected = tuple(SemiexplicitSplitting(order) for order in (6, 4, 8, 2))
    system = hamilton_equations_of(question.hamiltonian, question.values)
    state = (*system.q, *system.p)
    point = dict(zip((*state, system.t), (*map(float, question.y0), question.since), strict=True))
    slopes = [system.graph.gradient(rate, state) for rate in (*system.velocity, *system.force)]
    linear = np.array([[float(x) for x in system.graph.evaluate(row, point)] for row in slopes])
    fastest = float(abs(np.linalg.eigvals(linear)).max()) if np.isfinite(linear).all() else 0.0
    if not fastest > 0.0:
        return projected
    omega = float(f"{HELD_BY * fastest:.1e}")
    return *projected, *(ExtendedPhaseSpace(order, omega=omega) for order in (6, 4, 2))


def _of_disturbed(question: Question) -> tuple[Method, ...]:
    """Return the splittings by solvable parts where H is a solvable part and something else.

    Where nothing else is there, the motion is known and no method need be chosen; where the solvable part is T(p)
    alone, they are ordinary splittings.
    """
    try:
        part = solvable_part(hamilton_equations_of(question.hamiltonian, question.values))
    except UnsolvableError:
        return ()
    if not isinstance(part, Planets) and all(force == part.rest.graph.zero for force in part.rest.force):
        return ()
    n = len(question.y0) // 2
    if isinstance(part, Quadratic) and not any(any(row[:n]) for row in part.field):
        return ()
    if isinstance(part, Quadratic) and len(part.field) ** 2 > DENSEST * _operations(part.rest):
        return ()
    return WisdomHolman(), WisdomHolman(corrector=7), SABA(4), SABA("8-6-4"), SABA("10-6-4")


def _operations(system: HamiltonEquations) -> int:
    """Return how many distinct quantities an evaluation of the force goes through."""
    return len(system.graph.reachable(system.force))


def _of_close_encounters(question: Question) -> tuple[Method, ...]:
    """Return methods whose steps shrink near a singularity, where V < 0 has one and falls to it.

    The sign is that at the start; where it changes on the way their pilots say so.
    """
    system = hamilton_equations_of(question.hamiltonian, question.values)
    coordinates = set(system.q)
    below = {power.base for power in question.hamiltonian.H.atoms(Pow) if power.exp.is_negative}
    if not system.autonomous or not any(base.free_symbols & coordinates for base in below):
        return ()
    n = len(question.y0) // 2
    at_rest = np.concatenate([question.y0[:n], np.zeros(n)])
    point = dict(zip((*system.q, *system.p), map(float, at_rest), strict=True))
    (potential,) = system.graph.evaluate([system.hamiltonian], point)
    return tuple(TimeTransformed(Splitting(name)) for name in IN_FICTITIOUS_TIME) if potential < 0.0 else ()


@dataclass(frozen=True)
class TriedSetting:
    """A pilot run and what is expected of its setting over the whole span."""

    pilot: Pilot
    error: float
    cost: float

    @property
    def knob(self) -> float:
        """The step, or the tolerance of an adaptive method."""
        return self.pilot.setting.knob


def tried_with(
    question: Question, setting: Setting, span: float, like: TriedSetting | None = None
) -> TriedSetting:
    """Return a setting after a pilot run of that span.

    A step costs what it did in ``like``, a pilot run of the same method with another step, where there is one, in
    proportion to its evaluations: only the first step of a method is timed.
    """
    found = pilot(question, setting, span)
    if found.lost:
        return TriedSetting(found, math.inf, question.span / span * found.steps)
    error = expected_error(found, question.span, question.observable)
    if found.span < question.span:
        for since, y0 in question.elsewhere:
            later = pilot(question.moved(since, y0), setting, min(span, question.span - since))
            error = max(error, expected_error(later, question.span, question.observable))
    error = max(error, least_error(setting.arithmetic))
    if like is not None and math.isfinite(like.error) and setting.method.engine.takes_step:
        return TriedSetting(found, error, like.cost * _work(found) / _work(like.pilot))
    try:
        rate = seconds_per_time(question, found)
    except NonFiniteStateError:  # with a step a little smaller, to divide another span
        return TriedSetting(found, math.inf, math.inf)
    return TriedSetting(found, error, rate * question.span)


def _work(run: Pilot) -> float:
    """Return what the time of a run is in proportion to, per unit of time of the motion."""
    counted = run.steps if run.setting.method.engine is FICTITIOUS_TIME else run.evaluations
    return counted / run.span


def by_order(question: Question, tried: TriedSetting, accuracy: float) -> Candidate:
    """Return the candidate at the step that its order lets expect, which was not tried."""
    if math.isinf(tried.error):
        return nothing(tried.pilot.setting, tried.pilot.failure or "its error grows too fast")
    knob = tried.knob * (MARGIN * accuracy / tried.error) ** (1.0 / order_of(tried.pilot))
    setting = tried.pilot.setting
    if setting.step is None and knob < 2.0**-52:
        return candidate_of(question, tried, accuracy, note="its tolerance is as small as it can be")
    share = tried.knob / knob if setting.step is not None else 1.0
    found = candidate_of(question, tried, accuracy)
    return replace(
        found,
        step=None if setting.step is None else knob,
        tolerance=None if setting.tolerance is None else knob,
        predicted_error=max(MARGIN * accuracy, least_error(setting.arithmetic)),
        predicted_cost=found.predicted_cost * share,
        evaluations=found.evaluations * share,
        keeps=True,
        note="by its order, not tried",
        seen=0.0,
    )


def candidate_of(question: Question, tried: TriedSetting, accuracy: float, note: str = "") -> Candidate:
    """Return a setting that was tried as a candidate."""
    setting, found = tried.pilot.setting, tried.pilot
    return Candidate(
        method=setting.method,
        step=setting.step,
        tolerance=setting.tolerance,
        precision=setting.arithmetic,
        predicted_error=tried.error,
        predicted_cost=tried.cost,
        evaluations=found.evaluations * question.span / found.span,
        keeps=tried.error <= accuracy,
        note=note,
        seen=found.span,
    )


def nothing(setting: Setting, reason: str) -> Candidate:
    """Return a setting that can't follow the motion, and why."""
    return Candidate(
        setting.method,
        None,
        None,
        setting.arithmetic,
        predicted_error=math.inf,
        predicted_cost=math.inf,
        evaluations=math.inf,
        keeps=False,
        note=reason,
    )
