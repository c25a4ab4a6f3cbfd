"""Studies: systems × starts × parameters × methods × steps, from Python or a TOML file."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.symbols.user_input import counted
from canon.flow.equations.listed_equations import is_heyoka_system
from canon.flow.method.engine import needs_hamiltonian
from canon.flow.method.method_text import method_from, method_of
from canon.flow.system.recognised_system import recognised
from canon.flow.system.start_of_motion import state_in_order
from canon.flow.system_request import is_hamiltonian
from canon.given_file import bytes_of, tables_of
from canon.mechanics.traced.rates_function import is_rates_function
from canon.scene import Scene, find
from canon.study.cases.case import Case, key_of
from canon.study.cases.case_observables import followed, observables_from
from canon.study.cases.kept_of_case import section_of
from canon.study.cases.tags import tags_from, unite
from canon.study.energy_drift.drift import FEWEST
from canon.study.energy_drift.sample_times import FEWEST_USUAL, usual_samples
from canon.study.errors import StudyError
from canon.study.kept.keep_choice import keep_from
from canon.study.motion.hamiltonian_text import Formula, formula_of, hamiltonian_of
from canon.study.motion.studied_motion import variables_of
from canon.study.motion.system_table import system_from
from canon.study.motion.system_text import SystemText, system_in, system_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence


__all__ = ["Study", "read_study"]

AXES = ("system", "start", "method", "step", "steps_per_period", "tolerance", "precision")

MOST_SAMPLES = 2**15
"""Samples of a run unless more are asked for."""

MOST_CASES = 100_000
"""Cases of one study."""

_TOO_MANY = f"more than {MOST_CASES} cases; split the study"

MAX_BYTES = 2_000_000
"""Bytes of a study file."""

LONGEST_REASON = 1_000
"""Characters of what is told against a study; only a stranger's name or number in it can make it longer."""

LENGTHS = ("periods", "span", "samples", "parts", "parameters", "observables", "keep", "tags")

_KEYS = ", ".join((*AXES, *LENGTHS))

_ELSEWHERE = {
    "methods": "method", "systems": "system", "steps": "step", "tolerances": "tolerance", "starts": "start",
    "y0": "start", "state": "start", "t_span": "span (a duration)", "tag": "tags",
}  # fmt: skip
"""What other functions of canon call these keys."""


@dataclass(frozen=True)
class Study:
    """Study: a list of different cases, each one system, start, method and step.

    Parameters
    ----------
    cases
        The cases, each of them once.

    Examples
    --------
    >>> from canon import RK4, Splitting
    >>> methods = [Splitting("verlet"), RK4()]
    >>> len(Study.of(system=["kepler", "henon-heiles"], method=methods, step=[0.01, 0.02], periods=100.0).cases)
    8
    """

    cases: tuple[Case, ...]

    def __repr__(self) -> str:
        systems = dict.fromkeys(case.system_name for case in self.cases)
        methods = dict.fromkeys(str(case.method) for case in self.cases)
        return f"<Study: {counted(len(self.cases), 'case')}; {', '.join(systems)}; {', '.join(methods)}>"

    @staticmethod
    def of(**axes: Any) -> Study:
        """Return the study of every combination.

        Parameters
        ----------
        **axes
            Each by the name it has in a study file, in the singular where the functions that take several at once,
            ``drift_study``, ``choose`` and ``work_precision``, say ``methods``, and a duration, ``span``, where
            ``propagate`` has both ends of one, ``t_span``:
            ``system`` (a scene or its name, a Hamiltonian, or whatever else :func:`canon.propagate` takes that a file
            can hold: no unilateral constraints and maps, a function f(t, y) of n variables as
            ``canon.mechanics.field_of_function(f, n)``; with a name and starts a
            :class:`canon.study.motion.hamiltonian_text.Formula` or
            :class:`canon.study.motion.system_text.SystemText`),
            ``start``, ``method``, ``step`` or ``steps_per_period``, ``tolerance``, ``precision``: one value or a list
            or an array of values (a state is a list in that list, ``start=[[1.0, 0.0]]``, or by name or symbol,
            ``start={x: 1.0, x.momentum: 0.0}``; steps are for methods of fixed step, tolerances for the others);
            ``parameters``: by name or symbol, a value or a list of values each; ``periods`` or ``span``,
            ``samples`` and ``parts`` hold for all cases, and so do the ``observables`` to judge beside the energy:
            ``"momenta"``, ``"integrals"``, a constant by name, ``{name: formula}``, or a list of these; ``keep`` says
            what is kept beside the numbers: ``"motion"``, ``"exponent"``, ``"chaos"``, ``{"section": formula}``, or a
            list of these;
            ``tags`` are words that results are found by. Where forces do work, the energy less that is judged; of
            systems without a known energy, such as vector fields, the first observable takes its place.

        Raises
        ------
        StudyError
            Where a key is unknown or missing, or a system, start or parameter does not exist.
        """
        found: dict[Case, Case] = {}
        unite(found, _cases(axes, "the study", {}))
        return Study(tuple(found.values()))

    def share(self, number: int, of: int) -> Study:
        """Return the cases number, number + of, number + 2 of, … (counted from 1): one job's share of several.

        Examples
        --------
        >>> whole = Study.of(system="kepler", method="rk4", step=[0.01, 0.02, 0.03], span=10.0)
        >>> [case.step for case in whole.share(1, 2).cases], [case.step for case in whole.share(2, 2).cases]
        ([0.01, 0.03], [0.02])
        """
        if not 1 <= number <= of:
            raise StudyError(f"there is no share {number} of {of}: shares are counted from 1")
        return Study(self.cases[number - 1 :: of])


def read_study(path: str | Path) -> Study:
    """Return the study that a TOML file describes.

    Every ``[[study]]`` table is a product of its lists; a study may have several. A ``[system.NAME]`` table
    is a Hamiltonian or Lagrangian of one's own, as :func:`canon.study.motion.system_table.system_from` reads it.

    Raises
    ------
    StudyError
        With the file and the table, where something is wrong.
    """
    file = Path(path)
    try:
        written = tables_of(bytes_of(file, MAX_BYTES, "split the study").decode("utf-8-sig"))
    except ValueError as error:  # UnicodeDecodeError and TOMLDecodeError among them
        raise StudyError(f"{file}: {error}") from error
    tables, systems = written.pop("study", None), written.pop("system", {})
    if written or not _tables(tables) or not _tables(systems):
        raise StudyError(
            f"{file}: a study file holds [[study]] tables, [system.NAME] tables and nothing else"
        )
    try:
        own = {name: system_from(name, table) for name, table in systems.items()}
    except StudyError as error:
        raise StudyError(f"{file}, {error}") from error
    found: dict[Case, Case] = {}
    for n, table in enumerate(tables, 1):
        unite(found, _cases(table, f"{file}, study {n}", own))
        if len(found) > MOST_CASES:
            raise StudyError(f"{file}: {_TOO_MANY}")
    return Study(tuple(found.values()))


def _cases(table: Mapping[str, Any], where: str, own: Mapping[str, Formula | SystemText]) -> Iterator[Case]:
    unknown = sorted(set(table) - {*AXES, *LENGTHS})
    if unknown:
        name = str(unknown[0])[:60]
        meant = f"is {_ELSEWHERE[name]} meant?" if name in _ELSEWHERE else f"there are {_KEYS}"
        raise StudyError(f"{where}: unknown key {name!r}; {meant}")
    for name in ("system", "method"):
        if name not in table:
            raise StudyError(
                f"{where}: {name!r} is missing; a study has at least system, method and a duration"
            )
    if ("periods" in table) == ("span" in table):
        raise StudyError(f"{where}: give the duration as periods or as span, and not as both")
    if "step" in table and "steps_per_period" in table:
        raise StudyError(f"{where}: give step or steps_per_period, and not both")
    parameters = table.get("parameters", {})
    if not isinstance(parameters, Mapping):
        raise StudyError(
            f"{where}: parameters is a table of names and values, not {reprlib.repr(parameters)}"
        )
    try:
        parameters = _by_name(parameters)
        axes = [_listed(table.get(name)) for name in AXES]
        listed = {**dict(zip(AXES, axes, strict=True)), **{k: _listed(v) for k, v in parameters.items()}}
        if empty := [name for name, values in listed.items() if not values]:
            raise ValueError(f"{empty[0]} has no values, which leaves no case: give one, or leave it out")
        if is_heyoka_system(table["system"]):  # itself a list
            axes[0] = [table["system"]]
        if math.prod(map(len, (*axes, *map(_listed, parameters.values())))) > MOST_CASES:
            raise ValueError(_TOO_MANY)
        systems = _told_apart([_system(each, own, parameters) for each in axes[0]])
        for system, values in product(systems, _settings(parameters)):
            for rest in product(*axes[1:]):
                yield _case(system, values, dict(zip(AXES[1:], rest, strict=True)), table)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise StudyError(f"{where}: {_shortened(str(error))}") from error


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST_REASON else f"{text[:LONGEST_REASON]}…"


def _system(
    given: Any, own: Mapping[str, Formula | SystemText], parameters: Mapping[str, Any]
) -> str | Formula | SystemText:
    """Return a scene's name or a text, whatever a system is given as; its parameters get values."""
    if isinstance(given, Formula | SystemText):
        return given
    if isinstance(given, str):
        return own[given] if given in own else find(given).name
    if isinstance(given, Scene):
        return _known_scene(given)
    used = {str(symbol) for symbol in _symbols(given)}
    first = {name: _number(name, _listed(value)[0]) for name, value in parameters.items() if name in used}
    if is_hamiltonian(given):
        return formula_of(given, parameters=first)
    if missing := sorted(used - {*first}):
        raise ValueError(
            f"the system holds {', '.join(missing)}: give each a value, parameters={{name: value}}"
        )
    return system_text(given, parameters=first)


def _known_scene(given: Scene) -> str:
    """Return the name of a scene, by which alone a file holds it: it must move as the one that the name finds."""
    stock = find(given.name)
    changed = {k: v for k, v in given.values.items() if v != stock.values.get(k)}
    own = [name for name in _OF_THE_MOTION if getattr(given, name) != getattr(stock, name)]
    own += ["starts"] if _places(given) != _places(stock) else []
    if own:
        form = "hamiltonian" if given.is_free else "constrained" if given.is_constrained else "lagrangian"
        raise ValueError(
            f"this scene is not the {given.name} that its name finds: {', '.join(own)} differ. A study holds scenes by "
            f"name: give system=scene.{form}, with start= and parameters="
        )
    if changed:
        raise ValueError(
            f"give changed values of {given.name} as parameters, not inside the scene: {changed}"
        )
    return given.name


_OF_THE_MOTION = (
    "coordinates", "time_scale", "L_of", "H_of", "bodies_of", "V_of", "forces_of", "holonomic_of", "nonholonomic_of",
    "integrals",
)  # fmt: skip
"""What a study takes from a scene, beside its starts and the values of its parameters."""


def _places(scene: Scene) -> list[Any]:
    """Return the starts by name, without the words about them, which other values change."""
    return [(start.name, start.q, start.v, start.p) for start in scene.starts]


def _told_apart(systems: Sequence[str | Formula | SystemText]) -> list[str | Formula | SystemText]:
    """Return systems, of different ones with one name, as all that have none, the second as ``NAME 2`` and so on."""
    named: dict[str, list[str | Formula | SystemText]] = {}
    found: list[str | Formula | SystemText] = []
    for system in systems:
        name = system if isinstance(system, str) else system.name
        others = named.setdefault(name, [])
        if system not in others:
            others.append(system)
        number = others.index(system) + 1
        if not isinstance(system, str) and number > 1:
            system = replace(system, name=f"{name} {number}")
        found.append(system)
    return found


def _symbols(given: Any) -> Iterable[Any]:
    """Return the symbols of a system that need a number, its variables perhaps among them."""
    if is_hamiltonian(given):
        return given.H.free_symbols
    try:
        return recognised(given).parameters
    except TypeError:
        if is_rates_function(given):
            raise  # the message says how it becomes a vector field
        raise TypeError(
            f"system = {reprlib.repr(given)}: give the name of a scene or of a [system.NAME] table, a Hamiltonian, or "
            "another system that propagate takes, but no map"
        ) from None


def _settings(parameters: Any) -> list[tuple[tuple[str, float], ...]]:
    """Return every combination of the parameters' values."""
    names = sorted(parameters)
    values = [[_number(name, x) for x in _listed(parameters[name])] for name in names]
    return [tuple(zip(names, chosen, strict=True)) for chosen in product(*values)]


def _case(
    system: str | Formula | SystemText,
    parameters: tuple[tuple[str, float], ...],
    chosen: Mapping[str, Any],
    table: Mapping[str, Any],
) -> Case:
    given = chosen["method"]
    method = method_from(given) if isinstance(given, dict) else method_of(given)
    stepped = method.engine.takes_step
    period = _period(system, parameters)
    step = chosen["step"]
    if chosen["steps_per_period"] is not None:
        step = _known(period, "steps_per_period") / _number("steps_per_period", chosen["steps_per_period"])
    if stepped and step is None:
        raise ValueError(f"{method} needs a size of steps: give step or steps_per_period")
    span = table.get("span")
    if span is not None:
        span = _number("span", span)
    else:
        span = _number("periods", table["periods"]) * _known(period, "periods")
    start, tolerance = chosen["start"], chosen["tolerance"]
    usual = usual_samples(span, period, MOST_SAMPLES, unknown=FEWEST_USUAL)
    case = Case(
        system=system,
        method=method,
        span=span,
        samples=_whole("samples", table.get("samples", usual)),
        start=_start(start, system),
        parameters=parameters,
        step=_number("step", step) if stepped else None,
        tolerance=None if stepped or tolerance is None else _number("tolerance", tolerance),
        precision=method.engine.understood(_text("precision", chosen["precision"])),
        parts=_whole("parts", table["parts"]) if "parts" in table else None,
        observables=observables_from(table.get("observables", ())),
        keep=keep_from(table.get("keep", ())),
        tags=tags_from(table.get("tags", ())),
    )
    _check(case)
    return case


def _period(system: str | Formula | SystemText, parameters: tuple[tuple[str, float], ...]) -> float | None:
    if not isinstance(system, str):
        missing = [name for name, _ in parameters if name not in dict(system.parameters)]
        if missing:
            raise ValueError(f"{system.name} has no parameter {missing[0]!r}")
        return system.period
    return find(system).with_parameters(**dict(parameters)).period


def _known(period: float | None, what: str) -> float:
    if period is None:
        raise ValueError(
            f"{what} needs the system's period: write period = … in its table, or use span and step"
        )
    return period


def _check(case: Case) -> None:
    """Raise ValueError where a case makes no sense, before anything is run."""
    if case.samples < FEWEST:
        raise ValueError(f"{case.samples} samples are too few to judge growth: keep at least {FEWEST}")
    if not isinstance(case.system, str):
        case.system.check(case.state, "a start")
    elif isinstance(case.start, tuple) and len(case.start) != len(case.variables):
        variables = ", ".join(case.variables)
        raise ValueError(
            f"{case.system}: a start needs {len(case.variables)} numbers ({variables}), not {list(case.start)}"
        )
    if not is_hamiltonian(case.hamiltonian) and needs_hamiltonian(case.method.family):
        raise ValueError(
            f"{case.method} is made for Hamiltonians, which {case.system_name} is not; "
            "Taylor, DOP853, RK4 and Gauss apply"
        )
    if isinstance(case.system, SystemText) and not case.system.has_energy and not case.observables:
        raise ValueError(
            f"no energy is known of {case.system_name}: name what should stay constant, observables={{name: formula}}"
        )
    key_of(case)  # names of starts are looked up
    followed(case)
    section_of(case, None)


def _number(name: str, value: Any) -> float:
    try:
        return float(value)
    except (OverflowError, TypeError, ValueError):
        raise ValueError(f"{name} = {reprlib.repr(value)}: give a number") from None


def _whole(name: str, value: Any) -> int:
    number = _number(name, value)
    if not (math.isfinite(number) and number.is_integer()):
        raise ValueError(f"{name} = {reprlib.repr(value)}: give a whole number")
    return int(number)


def _text(name: str, value: Any) -> str | None:
    if value is not None and not isinstance(value, str):
        raise TypeError(f"{name} = {reprlib.repr(value)}: give its name")
    return value


def _start(given: Any, system: str | Formula | SystemText) -> str | tuple[float, ...] | None:
    if isinstance(given, Mapping):
        given = _in_order(given, system)
    if isinstance(given, np.ndarray):
        given = given.tolist()
    if isinstance(given, list | tuple):
        return tuple(_number("a start's number", x) for x in given)
    if isinstance(given, int | float):
        raise TypeError(f"start = {given}: a start is a name or a list of numbers in a list, [[1.0, 0.0]]")
    return _text("start", given)


def _in_order(start: Mapping[Any, Any], system: str | Formula | SystemText) -> list[Any]:
    """Return a start that is given by symbol or name, as :func:`canon.propagate` takes it, in the variables' order."""
    if isinstance(system, str):
        scene = find(system)
        variables = variables_of(scene.hamiltonian if scene.is_free else scene)[0]
    else:
        variables = variables_of(
            hamiltonian_of(system) if isinstance(system, Formula) else system_in(system)
        )[0]
    try:
        return list(state_in_order(start, variables))
    except KeyError as wrong:
        raise ValueError(f"start: {wrong.args[0]}") from None


def _by_name(parameters: Mapping[Any, Any]) -> dict[str, Any]:
    """Return values of parameters, which may be given by symbol, by name."""
    named = {str(key): value for key, value in parameters.items()}
    if len(named) < len(parameters):
        raise ValueError(f"parameters names one twice: {', '.join(sorted(map(str, parameters)))}")
    return named


def _listed(value: Any) -> list[Any]:
    if isinstance(value, np.ndarray):
        return np.atleast_1d(value).tolist()
    return list(value) if isinstance(value, list | tuple) else [value]


def _tables(value: Any) -> bool:
    """Tell whether a value is a list or a table of tables, as ``[[study]]`` and ``[system.NAME]`` make it."""
    if isinstance(value, dict):
        return all(isinstance(table, dict) for table in value.values())
    return isinstance(value, list) and bool(value) and all(isinstance(table, dict) for table in value)
