"""Results in a study's file: of each case its inputs, and its numbers or why there are none."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from canon.frozen_mapping import FrozenMapping
from canon.study.cases.case import Case, case_in, part_count
from canon.study.cases.result_query import Results
from canon.study.cases.store import Store
from canon.study.kept.chunk_file import Chunk, ChunkFolder
from canon.study.kept.kept_arrays import Kept

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["Result", "State", "motions_and_settings", "results_of"]


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
        Its inputs.
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
        start = self.case.start
        shown = ", ".join(f"{x:g}" for x in start) if isinstance(start, tuple) else start
        values = ", ".join(f"{name} = {value:g}" for name, value in self.case.parameters)
        return "; ".join(part for part in (self.case.system_name, values, shown and f"from {shown}") if part)

    @property
    def setting(self) -> str:
        """Method, step, tolerance and precision in words."""
        case = self.case
        step = f"h = {case.step:.4g}" if case.step is not None else ""
        tolerance = f"ε = {case.tolerance:.0e}" if case.tolerance is not None else ""
        return ", ".join(part for part in (str(case.method), step, tolerance, case.precision) if part)


def results_of(store: Store | str | Path) -> Results:
    """Return every case of a file and what became of it, in the order they were added.

    Raises
    ------
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
    store = store if isinstance(store, Store) else Store(Path(store))
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
