"""Choice of the cheapest method, step and precision for a wanted accuracy over a wanted time."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from canon.display import preformatted
from canon.flow.method.energy_keeping_method import AverageVectorField
from canon.flow.method.engine import FICTITIOUS_TIME, needs_hamiltonian
from canon.flow.method.method_text import method_of
from canon.flow.propagation import propagate
from canon.flow.run.observables_along import AccuracyWarning
from canon.flow.system_request import is_hamiltonian
from canon.scene.scene import Scene, near
from canon.study.errors import StudyError
from canon.study.method_choice.candidate import Candidate, candidate_methods
from canon.study.method_choice.choice_question import Question
from canon.study.method_choice.choice_table import answer, choice_table
from canon.study.method_choice.confirm import confirmed, double_instead
from canon.study.method_choice.pilot_run import error_seen, natural_step, require_energy
from canon.study.method_choice.resolution import least_error
from canon.study.method_choice.slow_times import Outlook, with_outlook
from canon.study.method_choice.step_search import searched
from canon.study.motion.extended_phase_space import driven
from canon.study.motion.studied_motion import Subject, checked_duration, subject_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import ArrayLike
    from sympy import Expr, Symbol

    from canon.flow.method.method import Method
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.system.recognised_system import MovableSystem
    from canon.flow.trajectory import Trajectory

__all__ = ["Candidate", "Choice", "choose"]

PILOT_STEPS = 4000.0
"""Length of a pilot run in steps of Taylor's method: some 100 periods."""

RIVAL = 1.8
"""How many times dearer than the cheapest a method may be to be tried in plain doubles too."""


@dataclass(frozen=True)
class Choice:
    """The cheapest setting that is expected to keep an accuracy, and the candidates it was chosen from.

    Parameters
    ----------
    title
        What is to be run.
    span, accuracy, observable
        What was asked for.
    chosen
        The choice; where nothing keeps the accuracy, the candidate with the least error.
    candidates
        All that were considered, those that keep the accuracy first, the cheapest first.
    question
        The same in the form that pilot runs take.
    outlook
        What was seen of the motion ahead of the pilots (:mod:`canon.study.method_choice.slow_times`).
    """

    title: str
    span: float
    accuracy: float
    observable: str
    chosen: Candidate
    candidates: tuple[Candidate, ...]
    question: Question = field(repr=False, compare=False)
    outlook: Outlook = field(repr=False, compare=False)

    @property
    def reached(self) -> bool:
        """Whether the accuracy is expected to be kept: the choice keeps it, and nothing slow is left unseen."""
        return self.chosen.keeps and not self.unknown

    @property
    def unknown(self) -> str:
        """Why it is not known whether the accuracy is kept: what changes too slowly to be seen; else empty.

        A choice that was run over the whole span before it was made has seen all.
        """
        return "" if self.chosen.seen >= self.span else self.outlook.unsettled

    @property
    def method(self) -> Method:
        """The method chosen."""
        return self.chosen.method

    @property
    def step(self) -> float | None:
        """Its step; None where it chooses its own."""
        return self.chosen.step

    @property
    def tolerance(self) -> float | None:
        """Its tolerance; None where it takes fixed steps."""
        return self.chosen.tolerance

    @property
    def precision(self) -> str:
        """The arithmetic."""
        return self.chosen.precision

    @property
    def predicted_cost(self) -> float:
        """Processor seconds expected of the steps."""
        return self.chosen.predicted_cost

    @property
    def predicted_error(self) -> float:
        """Largest error expected over the span."""
        return self.chosen.predicted_error

    def run(self, *, samples: int = 1000, progress: Callable[[float], None] | None = None) -> Trajectory:
        """Return the motion over the whole span with the method chosen, and warn where its error is not what was asked.

        Where H depends on t and the energy was asked for, the motion has the time as its last coordinate, and the work
        done from outside with its sign reversed as its last momentum: its energy is H less that work.

        Raises
        ------
        StudyError
            Where no method is expected to keep the accuracy. Where that is not known the choice runs, and the warning
            says what came.

        Warns
        -----
        AccuracyWarning
            The error that the samples show is larger than was asked.
        """
        if not self.chosen.keeps:
            raise StudyError(
                f"nothing keeps {self.accuracy:.1g}; the least error is {self.predicted_error:.1g}"
            )
        asked = self.question
        motion = propagate(
            asked.hamiltonian,
            (0.0, self.span),
            asked.y0,
            method=self.method,
            step=self.step,
            tolerance=self.tolerance,
            precision=self.precision,
            parameters=asked.values,
            samples=samples,
            observables=None if asked.integral is None else {asked.observable: asked.integral},
            progress=progress,
        )
        came = error_seen(motion, asked)
        if came is not None and not came <= self.accuracy:
            warnings.warn(
                f"{self.observable} to {self.accuracy:.2g} was asked and {self.predicted_error:.1e} expected, but the "
                f"motion shows {came:.1e}: take a smaller step or tolerance than {_knob_of(self.chosen)}",
                AccuracyWarning,
                stacklevel=2,
            )
        return motion

    def __repr__(self) -> str:
        return f"<Choice: {answer(self)}>"

    def _repr_html_(self) -> str:
        return preformatted(str(self))

    def __str__(self) -> str:
        return choice_table(self)


def choose(
    system: Scene | MovableSystem,
    span: float,
    y0: ArrayLike | Mapping[Any, Any] | str | None = None,
    *,
    accuracy: float,
    observable: str = "energy",
    integral: Expr | None = None,
    parameters: Mapping[Symbol | str, float] | None = None,
    methods: Sequence[MethodGiven] | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> Choice:
    """Return the cheapest method, step and precision expected to keep an accuracy over a span of time.

    Every candidate runs a few times for a short while. Its error is extrapolated in time by its law (bounded
    for symplectic methods, ∝ t for others, ∝ √t for round-off; positions: one half to one power more) and in
    the step by its order. The motion is followed ahead of them, so that they run too where it is fastest later; the
    cheapest one is looked at once more, over the whole span where that is cheap. What changes too slowly to be seen
    is said (:attr:`Choice.unknown`).

    Parameters
    ----------
    system
        Whatever :func:`canon.flow.propagation.propagate` takes: a Hamiltonian, a scene or its name, a Lagrangian with
        forces and constraints, whose energy is then that less the work of the forces; a vector field and SymPy's
        ``KanesMethod``, of which no energy is known, with ``observable="position"`` or an ``integral``.
    span
        Duration, in units of time (:func:`canon.propagate` takes both ends, ``t_span``).
    y0
        The starting state, or a number for each variable; of a scene also the name of a start, its default one where
        not given.
    accuracy
        Largest error allowed at any time, relative to the value at the start (absolute where that is zero).
    observable
        ``"energy"``, where H depends on t less the work done from outside, ∫ ∂H/∂t dt; ``"position"``, the distance
        of the coordinates from the true ones over the largest length of the latter; or a constant of the scene by
        name.
    integral
        Another function of (q, p) that should stay constant, with ``observable`` its name.
    parameters
        Values of parameters; those of a scene are its own unless replaced.
    methods
        The methods to consider, as values or by name; all that apply if left out.
    progress
        Called with a method's name and the fraction of the candidates that is done.

    Raises
    ------
    StudyError
        Where the request makes no sense, or the motion can't be followed at all; where by the energy methods are to be
        considered that keep it at every step.

    Examples
    --------
    >>> from canon.scene import find
    >>> choice = choose(find("henon-heiles"), span=1e5, accuracy=1e-4)
    >>> choice.reached, choice.predicted_error < 1e-4, choice.predicted_cost < 1.0
    (True, True, True)
    """
    checked_duration(span, y0, "choose")
    if not 0.0 < accuracy < 0.1:
        raise StudyError(
            f"an accuracy of {accuracy} makes no sense: give a number between 0 and 0.1, such as 1e-8"
        )
    subject = subject_of(system, y0, parameters)
    question = _question(subject, span, observable, integral)
    considered = tuple(map(method_of, methods)) if methods is not None else candidate_methods(question)
    if not considered:
        raise StudyError("no method to choose from: name at least one")
    if not is_hamiltonian(question.hamiltonian) and all(
        needs_hamiltonian(method.family) for method in considered
    ):
        raise StudyError(
            f"{', '.join(map(str, considered))}: made for Hamiltonians, which {subject.title} is not; "
            "Taylor, DOP853, RK4 and Gauss apply"
        )
    if integral is None and observable == "energy":
        _check_energy_tells(considered)
    natural = natural_step(question)
    require_energy(question)
    pilot_span = min(span, PILOT_STEPS * natural)
    question, outlook = with_outlook(question, pilot_span, natural)
    found: list[Candidate] = []
    for number, method in enumerate(considered):
        cheapest = min((each.predicted_cost for each in found if each.keeps), default=math.inf)
        precision = method.engine.usual_precision
        found.append(searched(question, method, precision, pilot_span, natural, accuracy, cheapest))
        if progress is not None:
            progress(str(method), (number + 1) / (len(considered) + 1))
    if not any(each.keeps for each in found):
        found.extend(_in_higher_precision(question, considered, pilot_span, natural, accuracy))
    found, chosen = _settled(question, found, pilot_span, accuracy)
    if progress is not None:
        progress(str(chosen.method), 1.0)
    ordered = sorted(found, key=lambda each: (not each.keeps, each.predicted_cost))
    title = subject.system.title if isinstance(subject.system, Scene) else subject.title
    return Choice(title, span, accuracy, observable, chosen, tuple(ordered), question, outlook)


def _check_energy_tells(considered: tuple[Method, ...]) -> None:
    """Refuse to choose by the energy among methods that keep it whatever they do else."""
    keeping = [str(method) for method in considered if isinstance(method, AverageVectorField)]
    if keeping:
        raise StudyError(
            f"{', '.join(keeping)}: the energy is kept at every step, so that its error says nothing of the motion; "
            "choose by observable='position', or by another integral"
        )


def _knob_of(chosen: Candidate) -> str:
    return f"{chosen.step:.4g}" if chosen.step is not None else f"{chosen.tolerance:.2g}"


def _settled(
    question: Question, found: list[Candidate], pilot_span: float, accuracy: float
) -> tuple[list[Candidate], Candidate]:
    """Look at the cheapest candidate once more, until the cheapest one has been looked at."""
    waiting = [*found, *_in_plain_doubles(question, found, pilot_span, accuracy)]
    looked: list[Candidate] = []
    while able := [each for each in (*waiting, *looked) if each.keeps]:
        best = min(able, key=lambda each: each.predicted_cost)
        if best in looked:
            return [*waiting, *looked], best
        waiting.remove(best)
        looked.append(confirmed(question, best, pilot_span, accuracy))
    return [*waiting, *looked], min((*waiting, *looked), key=lambda each: each.predicted_error)


def _in_plain_doubles(
    question: Question, found: Sequence[Candidate], pilot_span: float, accuracy: float
) -> list[Candidate]:
    """Return what plain doubles make cheaper, of candidates that may become the cheapest by them."""
    made: list[Candidate] = []
    able = sorted((each for each in found if each.keeps), key=lambda each: each.predicted_cost)
    cheapest = able[0].predicted_cost if able else math.inf
    for each in able:
        if each.predicted_cost >= RIVAL * cheapest:
            break
        plain = double_instead(question, each, pilot_span, accuracy)
        if plain is not None:
            made.append(plain)
            cheapest = min(cheapest, plain.predicted_cost)
    return made


def _in_higher_precision(
    question: Question, considered: Sequence[Method], pilot_span: float, natural: float, accuracy: float
) -> list[Candidate]:
    """Return what more digits reach, where the usual ones do not suffice."""
    found: list[Candidate] = []
    for method in considered:
        ladder = method.engine.wider
        if method.engine is FICTITIOUS_TIME or (method.engine.takes_step and method.order < 8):
            continue
        if question.observable == "position":  # beyond these no reference is better
            ladder = ladder[:1]
        cheapest = min((each.predicted_cost for each in found if each.keeps), default=math.inf)
        for precision in ladder:
            if accuracy < least_error(precision) and (method.engine.takes_step or precision != ladder[-1]):
                continue
            each = searched(question, method, precision, pilot_span / 8.0, natural, accuracy, cheapest)
            found.append(each)
            if each.keeps:
                break
    return found


def _question(subject: Subject, span: float, observable: str, integral: Expr | None) -> Question:
    """Return the question; of the energy where H depends on t with the time as a coordinate, so that it is constant."""
    scene = subject.system
    if integral is None and observable not in ("energy", "position"):
        if not isinstance(scene, Scene):
            raise StudyError(f"observable={observable!r}: give the function of the state as integral=")
        constants = scene.constants()
        if observable not in constants:
            raise StudyError(
                f"{scene.name} has no constant {observable!r}{near(observable, ('energy', 'position', *constants))}"
            )
        integral = constants[observable]
    if observable == "energy" and subject.depends_on_time:
        timed = driven(subject.hamiltonian)
        return Question(
            timed.hamiltonian, timed.state(subject.state), subject.values, span, observable, integral
        )
    return Question(subject.hamiltonian, subject.state, subject.values, span, observable, integral)
