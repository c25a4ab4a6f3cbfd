"""Case of a study: all that determines a run, its key, and the system and state it starts from."""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from canon.flow.method.engine import FICTITIOUS_TIME
from canon.flow.method.method_text import method_from
from canon.flow.method.setting import Setting
from canon.scene import find
from canon.study.errors import StudyError
from canon.study.motion.hamiltonian_text import Formula, hamiltonian_of
from canon.study.motion.studied_motion import subject_of, variables_of
from canon.study.motion.system_text import SystemText, system_in
from canon.version import __version__

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.flow.method.method import Method

__all__ = ["Case", "case_in", "key_of", "part_count", "versions"]

LIBRARIES = ("heyoka", "llvmlite", "numpy", "scipy", "sympy")
"""Libraries whose version may change a last digit."""

STEPS_A_PART = 2**20
"""Steps of fixed size in a part of a run: a fraction of a second for small systems, minutes for huge ones."""

SAMPLES_A_PART = 128
"""Samples in a part of a run with an adaptive method."""

MOST_STEPS = 10**12
"""Steps of fixed size that a case may take: ten billion a day are many."""

MOST_SAMPLES_KEPT = 2**22
"""Samples that a case may keep: a checkpoint of so many is some 200 MB."""

MOST_PARTS_ASKED = 10**5
"""Parts that a run may be asked to be made of: each costs some milliseconds."""

MOST_PARTS = 128
"""Parts of a run with an adaptive method: to begin one costs some milliseconds."""


@dataclass(frozen=True)
class Case:
    """A run of one system from one state with one method.

    Parameters
    ----------
    system
        Name of a scene, or a Hamiltonian or another system as text.
    method
        The method.
    span
        Duration in units of time.
    samples
        Samples the energy error is judged by.
    start
        Name of a start of the system, or a state, (q, p) of a Hamiltonian; the system's first start where None.
    parameters
        Values that replace the system's own.
    step, tolerance, precision
        As :func:`canon.flow.propagation.propagate` takes them.
    parts
        Parts the run is made of, None for the usual number (:func:`part_count`). Each begins anew from the exact
        state the last one ended with, be the run interrupted there or not.
    observables
        What is judged beside the energy: names of constants, and names with formulas
        (:func:`canon.study.cases.case_observables.observables_from`).
    keep
        What is kept beside the numbers, by name (:func:`canon.study.kept.keep_choice.keep_from`).
    tags
        Words it is found by; they are no part of what it is.
    """

    system: str | Formula | SystemText
    method: Method
    span: float
    samples: int = 4096
    start: str | tuple[float, ...] | None = None
    parameters: tuple[tuple[str, float], ...] = ()
    step: float | None = None
    tolerance: float | None = None
    precision: str | None = None
    parts: int | None = None
    observables: tuple[tuple[str, str], ...] = ()
    keep: tuple[tuple[str, str], ...] = ()
    tags: tuple[str, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        for name in ("span", "step", "tolerance"):  # 10 and 10.0 are one case, and should have one key
            if isinstance(number := getattr(self, name), int):
                object.__setattr__(self, name, float(number))
        if not 0.0 < self.span < math.inf:
            raise ValueError(
                f"a run over a time of {self.span} makes no sense: give a positive, finite duration"
            )
        if self.step is not None and not 0.0 < self.step < math.inf:
            raise ValueError(f"a step of {self.step} makes no sense: give a positive, finite one")
        if self.step is not None and self.span / self.step > MOST_STEPS:
            raise ValueError(
                f"{self.span / self.step:.1g} steps, and a case may take {MOST_STEPS:.0e}: "
                "give a shorter duration or a larger step"
            )
        if not 0 < self.samples <= MOST_SAMPLES_KEPT:
            raise ValueError(f"samples = {self.samples}: give a whole number from 1 to {MOST_SAMPLES_KEPT}")
        if self.parts is not None and not 1 <= self.parts <= MOST_PARTS_ASKED:
            raise ValueError(f"parts = {self.parts}: give a whole number from 1 to {MOST_PARTS_ASKED}")
        if isinstance(self.start, tuple) and not all(map(math.isfinite, self.start)):
            raise ValueError(f"a start has finite numbers (q, p), not {list(self.start)}")

    @property
    def setting(self) -> Setting:
        """Method, step or tolerance, and precision."""
        return Setting(self.method, self.step, self.tolerance, self.precision)

    @property
    def what_moves(self) -> tuple[Any, ...]:
        """System, start and parameters: what all methods are compared on."""
        return self.system, self.start, self.parameters

    @property
    def system_name(self) -> str:
        """What the system is called."""
        return self.system if isinstance(self.system, str) else self.system.name

    @property
    def hamiltonian(self) -> Any:
        """What moves, made once in a process: the Hamiltonian, or another system where none says all."""
        if isinstance(self.system, Formula):
            return hamiltonian_of(self.system)
        if isinstance(self.system, SystemText):
            return system_in(self.system)
        scene = find(self.system)
        return scene.hamiltonian if scene.is_free else scene

    @property
    def variables(self) -> tuple[str, ...]:
        """The names of the variables of the state."""
        return tuple(s.name for s in variables_of(self.hamiltonian)[0])

    @property
    def is_constrained(self) -> bool:
        """Whether constraints act on the system."""
        if isinstance(self.system, str):
            return find(self.system).is_constrained
        return isinstance(self.system, SystemText) and self.system.is_constrained

    @property
    def values(self) -> dict[str, float]:
        """The value of every parameter by name."""
        if not isinstance(self.system, str):
            return {**dict(self.system.parameters), **dict(self.parameters)}
        return find(self.system).with_parameters(**dict(self.parameters)).values

    @property
    def period(self) -> float | None:
        """The period of a typical motion, None where none is known."""
        if not isinstance(self.system, str):
            return self.system.period
        return find(self.system).with_parameters(**dict(self.parameters)).period

    @property
    def state(self) -> tuple[float, ...]:
        """The state at the start."""
        if isinstance(self.start, tuple):
            return self.start
        if not isinstance(self.system, str):
            return _start_of(self.system, self.start)
        return _scene_state(self.system, self.start, self.parameters)

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold of this case; floats survive exactly."""
        fields = {name: getattr(self, name) for name in self.__dataclass_fields__}
        fields.pop("tags")
        more = {name: dict(found) for name in ("observables", "keep") if (found := fields.pop(name))}
        system = self.system if isinstance(self.system, str) else self.system.to_dict()
        return {
            **fields,
            "system": system,
            "method": self.method.written,
            "parameters": dict(self.parameters),
            **more,
        }

    def to_text(self) -> str:
        """Return the case as JSON, with the present versions of what computes it."""
        return json.dumps({**self.to_dict(), "versions": versions()}, ensure_ascii=False)

    @staticmethod
    def from_dict(fields: Mapping[str, Any]) -> Case:
        """Return the case that :meth:`to_dict` wrote."""
        given: dict[str, Any] = {name: value for name, value in fields.items() if name != "versions"}
        start, system = given.pop("start"), given.pop("system")
        return Case(
            system=_system_from(system),
            method=method_from(given.pop("method")),
            parameters=tuple(given.pop("parameters").items()),
            start=tuple(start) if isinstance(start, list) else start,
            observables=tuple(given.pop("observables", {}).items()),
            keep=tuple(given.pop("keep", {}).items()),
            **given,
        )


def case_in(inputs: str) -> Case:
    """Return the case that a results file holds as text.

    Raises
    ------
    StudyError
        Where canon did not write it.
    """
    try:
        return Case.from_dict(json.loads(inputs))
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        shown = " ".join(inputs.split())[:80]
        raise StudyError(f"these are not the inputs of a case: {shown} ({error})") from error


@lru_cache(maxsize=1)
def versions() -> dict[str, str]:
    """Return the versions that a result depends on."""
    return {"canon": __version__, **{name: version(name) for name in LIBRARIES}}


def key_of(case: Case) -> str:
    """Return the SHA-256 of everything that determines the result: inputs, the system's defaults, versions.

    Examples
    --------
    >>> from canon import RK4
    >>> case = Case("kepler", RK4(), span=10.0, step=0.01)
    >>> key_of(case) == key_of(Case("kepler", RK4(), span=10.0, step=0.01))
    True
    >>> key_of(case) == key_of(Case("kepler", RK4(), span=10.0, step=0.02))
    False
    """
    start = None
    if isinstance(case.system, str) and not isinstance(case.start, tuple):
        start = asdict(find(case.system).start(case.start))
    whole = {"case": case.to_dict(), "values": case.values, "start": start, "versions": versions()}
    return hashlib.sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()


def part_count(case: Case) -> int:
    """Return the number of parts a case is run in; it follows from the case alone.

    A part has at most a million steps of fixed size, or 128 samples of an adaptive method unless that made over 128
    parts, each of which costs some milliseconds to begin. A time-transformed method's run is one part, and
    so is that of a system with constraints.

    Examples
    --------
    >>> from canon import RK4, Taylor
    >>> part_count(Case("kepler", RK4(), span=1e6, step=0.01)), part_count(Case("kepler", Taylor(), span=1e6))
    (96, 32)
    """
    if case.method.engine is FICTITIOUS_TIME:
        return 1  # the size of its steps follows from the state at the start of the whole run
    if case.is_constrained:
        return 1  # what a method has drifted off the constraints is no start on them
    if case.parts is not None:
        return case.parts
    if case.method.engine.takes_step and case.step is not None:
        return max(1, math.ceil(case.span / case.step / STEPS_A_PART))
    return min(MOST_PARTS, max(1, case.samples // SAMPLES_A_PART))


def _system_from(written: Any) -> str | Formula | SystemText:
    if isinstance(written, str):
        return written
    return SystemText.from_dict(written) if "written" in written else Formula.from_dict(written)


def _start_of(system: Formula | SystemText, name: str | None) -> tuple[float, ...]:
    """Return the state of that name, or the first one."""
    for known, state in system.starts:
        if name in (None, known):
            return state
    named = ", ".join(known for known, _ in system.starts)
    what = "a start; it has none" if name is None else f"no start {name!r}; there are: {named or 'none'}"
    raise ValueError(
        f"{system.name} {'needs' if name is None else 'has'} {what}; a state in numbers will do as well"
    )


@lru_cache(maxsize=4096)
def _scene_state(
    scene: str, start: str | None, parameters: tuple[tuple[str, float], ...]
) -> tuple[float, ...]:
    return tuple(subject_of(find(scene), start, dict(parameters)).state.tolist())
