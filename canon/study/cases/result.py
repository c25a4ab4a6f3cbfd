"""Results in a study's file: of each case its inputs, its numbers or why there are none; found by what they have."""

from __future__ import annotations

import inspect
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from canon.flow.method.method_text import method_of
from canon.frozen_mapping import FrozenMapping
from canon.study.cases.case import Case, case_in, part_count
from canon.study.cases.store import Store, existing_store
from canon.study.energy_drift.drift_verdict import Growth
from canon.study.kept.chunk_file import Chunk, ChunkFolder
from canon.study.kept.kept_arrays import Kept
from canon.study.kept.kept_dataset import dataset_of_kept

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray

__all__ = [
    "Result", "Results", "State", "motion_in_words", "motions_and_settings", "results_of", "setting_in_words",
]  # fmt: skip


OF_RESULTS = ("key", "motion", "setting", "state", "failure", "seconds", "done")

OF_CASES = ("start", "method", "step", "tolerance", "precision", "span", "samples")


class State(Enum):
    """State of a case: finished, failed or pending."""

    FINISHED = "finished"
    FAILED = "failed"
    PENDING = "pending"


@dataclass(frozen=True)
class Result:
    """One case of a study and what became of it.

    Parameters
    ----------
    key
        Its key.
    case
        Its inputs: ``case.start`` is the start as it was given, a name or numbers, ``case.state`` its numbers.
    state
        Whether it finished, failed, or is pending.
    numbers
        The outcome by name, empty unless it finished; :class:`canon.study.energy_drift.drift.Drift` has the meanings.
    failure
        Why it failed, else empty.
    seconds
        Processor time; None while it is pending.
    done
        Fraction of the run that is done.
    versions
        Versions of canon and the libraries that computed it, or are to.
    kept
        What was kept beside the numbers, read when it is asked for.
    """

    key: str
    case: Case
    state: State
    numbers: Mapping[str, Any]
    failure: str = ""
    seconds: float | None = None
    done: float = 1.0
    versions: Mapping[str, str] = field(default_factory=lambda: FrozenMapping({}))
    kept: Kept = field(default_factory=lambda: Kept(ChunkFolder(Path()), None), compare=False)

    def __repr__(self) -> str:
        return f"<Result: {self.motion}; {self.setting}: {self.state.value}>"

    @property
    def motion(self) -> str:
        """System, parameters and start in words: what all methods are compared on."""
        return motion_in_words(self.case)

    @property
    def setting(self) -> str:
        """Method, step, tolerance and precision in words."""
        return setting_in_words(self.case)


def motion_in_words(case: Case, digits: int = 6) -> str:
    """Return system, parameters and start in words, numbers with so many digits."""
    start = case.start
    shown = ", ".join(f"{x:.{digits}g}" for x in start) if isinstance(start, tuple) else start
    values = ", ".join(f"{name} = {value:.{digits}g}" for name, value in case.parameters)
    return "; ".join(part for part in (case.system_name, values, shown and f"from {shown}") if part)


def setting_in_words(case: Case, digits: int = 4) -> str:
    """Return method, step, tolerance and precision in words, numbers with so many digits."""
    step = f"h = {case.step:.{digits}g}" if case.step is not None else ""
    tolerance = f"ε = {case.tolerance:.{max(0, digits - 5)}e}" if case.tolerance is not None else ""
    return ", ".join(part for part in (str(case.method), step, tolerance, case.precision) if part)


@dataclass(frozen=True)
class Results(Sequence[Result]):
    """Results of a study, in the order their cases were added.

    Parameters
    ----------
    rows
        The results.
    """

    rows: tuple[Result, ...]

    def __repr__(self) -> str:
        return f"<Results: {len(self.rows)} cases of {len({r.case.what_moves for r in self.rows})} motions>"

    def __len__(self) -> int:
        return len(self.rows)

    @overload
    def __getitem__(self, index: int) -> Result: ...
    @overload
    def __getitem__(self, index: slice) -> Results: ...
    def __getitem__(self, index: int | slice) -> Result | Results:
        return Results(self.rows[index]) if isinstance(index, slice) else self.rows[index]

    def where(self, **wanted: Any) -> Results:
        """Return the results that have all that is asked for.

        Parameters
        ----------
        **wanted
            What is asked by name: ``system``, ``tag``, ``start``, ``method``, ``step``, ``tolerance``, ``precision``,
            ``span``, ``samples``, ``state`` (``"finished"``, ``"failed"``, ``"pending"``; the numbers of a start are
            ``start``), a parameter, a number of the outcome such as ``verdict`` (:class:`canon.study.Growth`, or its
            word, ``"bounded"``) or ``bound``, ``seconds``, and what else a :class:`canon.study.Result` has. A value is
            asked for as it is, a list, tuple, set, range or array means any of its values, a function tells of a value
            whether it is wanted,
            and a class of methods all its methods. A start is asked for as it was given, a name or its numbers, and a
            list of numbers is one start. Cases that have no such value are left out.

        Raises
        ------
        ValueError
            Nothing is called so, or no state or verdict is.

        Examples
        --------
        >>> import tempfile
        >>> from canon import Study, results_of, run_study
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     study = Study.of(system="henon-heiles", method=["verlet", "rk4"], step=[0.1, 0.2], span=100.0, tags="a")
        ...     _ = run_study(study, f"{folder}/study.sqlite")
        ...     results = results_of(f"{folder}/study.sqlite")
        >>> [result.setting for result in results.where(method="rk4", tag="a", step=lambda h: h < 0.15)]
        ['RK4, h = 0.1']
        >>> len(results.where(verdict="bounded")), len(results.where(step=[0.1, 0.3]))
        (2, 2)
        """
        for name in wanted:
            self._require(name)
        asked = {name: _asked(name, given) for name, given in wanted.items()}
        return Results(
            tuple(
                row
                for row in self.rows
                if all(any(_has(each, want) for each in _values(row, name)) for name, want in asked.items())
            )
        )

    def to_xarray(self, name: str) -> xarray.Dataset:
        """Return what was kept under a name as an :class:`xarray.Dataset` along ``case``.

        The numbers of a case are read when they are used; ``dataset.chunk(case=1)`` hands them to dask so. Where a case
        has fewer numbers than others, or was not finished, there is NaN.

        Parameters
        ----------
        name
            ``"motion"`` (along ``sample``), ``"section"`` (along ``passage``), ``"exponent"`` and ``"chaos"`` (along
            ``time``), or the name of a function.

        Raises
        ------
        ImportError
            Where xarray is not installed.
        KeyError
            Nothing of that name was kept of any case.
        DamagedChunk
            On reading: what was kept of a case is not there, or not what was written.

        Examples
        --------
        >>> import tempfile
        >>> from canon import Study, results_of, run_study
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     study = Study.of(
        ...         system="henon-heiles", method=["verlet", "rk4"], step=0.1, span=50.0, samples=500, keep="motion"
        ...     )
        ...     _ = run_study(study, f"{folder}/study.sqlite")
        ...     motions = results_of(f"{folder}/study.sqlite").to_xarray("motion")
        ...     dict(motions.sizes), float(abs(motions.x[0] - motions.x[1]).max()) < 0.1
        ({'case': 2, 'sample': 501}, True)
        """
        cases = [row.case for row in self.rows]
        inputs = {
            "key": [row.key for row in self.rows],
            "state": [row.state.value for row in self.rows],
            "system": [case.system_name for case in cases],
            "method": [str(case.method) for case in cases],
            "step": [math.nan if case.step is None else case.step for case in cases],
            "tolerance": [math.nan if case.tolerance is None else case.tolerance for case in cases],
            "tags": ["; ".join(case.tags) for case in cases],
        }
        changed = dict.fromkeys(name for case in cases for name, _ in case.parameters)
        values = {
            f"parameter_{name}": [case.values.get(name, math.nan) for case in cases] for name in changed
        }
        return dataset_of_kept([row.kept for row in self.rows], name, {**inputs, **values})

    def _require(self, name: str) -> None:
        """Raise ValueError where no result can have a value of that name."""
        fixed = ("system", "tag", *OF_CASES, *OF_RESULTS)
        if name in fixed or any(name in row.numbers or name in row.case.values for row in self.rows):
            return
        known = dict.fromkeys(
            (*fixed, *(each for row in self.rows for each in (*row.numbers, *row.case.values)))
        )
        close = get_close_matches(name, known, 1)
        meant = f"; did you mean {close[0]!r}?" if close else f"; there are {', '.join(known)}"
        raise ValueError(f"no result has anything called {name!r}{meant}")


_WORDS: Mapping[str, type[Enum]] = FrozenMapping({"state": State, "verdict": Growth})
"""What has one of few values, in words."""


def _asked(name: str, given: Any) -> tuple[Any, ...]:
    """Return what is asked for as alternatives."""
    if name == "start":
        return _starts(given)
    if isinstance(given, np.ndarray):
        given = np.ravel(given).tolist()
    alternatives = isinstance(given, list | tuple | set | frozenset | range)
    each: tuple[Any, ...] = tuple(given) if alternatives else (given,)
    if name in _WORDS:
        known = [word.value for word in _WORDS[name]]
        if unknown := [one for one in each if isinstance(one, str) and one not in known]:
            raise ValueError(f"no {name} is called {unknown[0]!r}; there are {', '.join(known)}")
    if name == "method":
        return tuple(method_of(one) if isinstance(one, str) else one for one in each)
    if name == "system":
        return tuple(getattr(one, "name", one) for one in each)
    return each


def _starts(given: Any) -> tuple[Any, ...]:
    """Return the starts that are asked for: names, or numbers as cases have them; a list of numbers is one start."""
    if isinstance(given, np.ndarray):
        given = given.tolist()
    if isinstance(given, list | set | frozenset) and not all(isinstance(x, int | float) for x in given):
        return tuple(tuple(x) if isinstance(x, list | np.ndarray) else x for x in given)
    return (tuple(given) if isinstance(given, list) else given,)


def _values(row: Result, name: str) -> tuple[Any, ...]:
    """Return what a result has of a name: nothing, one value, or its tags."""
    case = row.case
    if name == "tag":
        return case.tags
    if name == "system":
        return (case.system_name,)
    if name == "state":
        return (row.state.value,)
    if name in OF_CASES or name in OF_RESULTS:
        value = getattr(case if name in OF_CASES else row, name)
    else:
        value = row.numbers.get(name, case.values.get(name))
    return () if value is None else (value,)


def _has(value: Any, wanted: tuple[Any, ...]) -> bool:
    return any(_is(value, each) for each in wanted)


def _is(value: Any, wanted: Any) -> bool:
    if inspect.isclass(wanted):
        return isinstance(value, wanted)
    if callable(wanted):
        return bool(wanted(value))
    return bool(value == getattr(wanted, "value", wanted))


def results_of(store: Store | str | Path) -> Results:
    """Return every case of a file and what became of it, in the order they were added.

    Raises
    ------
    FileNotFoundError
        There is no such file, or nothing in it.
    StoreError
        Where the file can't be read, or rows of it are damaged.

    Examples
    --------
    >>> import tempfile
    >>> from canon import Study, run_study
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = f"{folder}/study.sqlite"
    ...     _ = run_study(Study.of(system="henon-heiles", method="verlet", step=0.1, span=200.0), file)
    ...     [(result.state.value, result.setting, result.numbers["verdict"]) for result in results_of(file)]
    [('finished', 'verlet, h = 0.1', 'bounded')]
    """
    store = store if isinstance(store, Store) else existing_store(store)
    records, parts, tags = store.records(), store.parts_done(), store.tags()
    found: list[Result] = []
    for key, inputs in store.cases().items():
        case, record = replace(case_in(inputs), tags=tags.get(key, ())), records.get(key)
        by = FrozenMapping(json.loads(inputs).get("versions", {}))
        if record is None:
            done = parts.get(key, 0) / part_count(case)
            found.append(Result(key, case, State.PENDING, {}, done=done, versions=by))
        elif record.failure:
            found.append(Result(key, case, State.FAILED, {}, record.failure, record.seconds, versions=by))
        else:
            numbers = json.loads(record.outcome)
            numbers.pop("kept", None)
            kept = Kept(ChunkFolder(store.path), Chunk.named_by(key, record.outcome))
            found.append(
                Result(key, case, State.FINISHED, numbers, "", record.seconds, versions=by, kept=kept)
            )
    return Results(tuple(found))


def motions_and_settings(store: Store) -> dict[str, str]:
    """Return by key each case in words, as far as its inputs can be read."""
    found: dict[str, str] = {}
    for key, inputs in store.intact_cases().items():
        result = Result(key, case_in(inputs), State.PENDING, {})
        found[key] = f"{result.motion}; {result.setting}"
    return found
