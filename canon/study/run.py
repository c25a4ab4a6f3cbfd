"""Studies: scenes × starts × methods × steps, run on any executor, resumed where they stopped."""

from __future__ import annotations

import json
import tomllib
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass, replace
from itertools import islice, product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from canon.flow.method import FixedStep
from canon.scene import SceneError, find
from canon.study.case import Case, key_of, method_from, outcome_of, run_case
from canon.study.comparison import StudyError
from canon.study.store import Record, Store

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

__all__ = ["Status", "Study", "finished_rows", "read_study", "resume", "run_study", "status_of"]

IN_FLIGHT = 256
"""Cases handed to an executor at a time, so that a large study does not fill its queue."""

AXES = ("scene", "start", "method", "step", "tolerance", "precision")

LENGTHS = ("periods", "until", "samples", "parameters")


@dataclass(frozen=True)
class Study:
    """A list of cases.

    Parameters
    ----------
    cases
        The cases, each of them once.

    Examples
    --------
    >>> from canon import RK4, Splitting
    >>> methods = [Splitting("verlet"), RK4()]
    >>> len(Study.of(scene=["kepler", "henon-heiles"], method=methods, step=[0.01, 0.02], periods=100.0).cases)
    8
    """

    cases: tuple[Case, ...]

    @staticmethod
    def of(**axes: Any) -> Study:
        """Return the study of every combination.

        Parameters
        ----------
        **axes
            ``scene``, ``start``, ``method``, ``step``, ``tolerance``, ``precision``: one value or a list
            of values (a state is a list in that list; steps are for methods of fixed step, tolerances for
            the others); ``periods`` or ``until``, ``samples`` and ``parameters`` hold for all cases.

        Raises
        ------
        StudyError
            Where a key is unknown or missing, or a scene, start or parameter does not exist.
        """
        return Study(tuple(dict.fromkeys(_cases(axes, "the study"))))


@dataclass(frozen=True)
class Status:
    """How far a study is."""

    finished: int
    failed: int
    pending: int

    def __str__(self) -> str:
        total = self.finished + self.failed + self.pending
        return f"{total} cases: {self.finished} finished, {self.failed} failed, {self.pending} pending"


def read_study(path: str | Path) -> Study:
    """Return the study that a TOML file describes.

    Every ``[[study]]`` table is a product of its lists; a study may have several.

    Raises
    ------
    StudyError
        With the file and the table, where something is wrong.
    """
    file = Path(path)
    try:
        written = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise StudyError(f"{file}: {error}") from error
    tables = written.pop("study", None)
    if written or not isinstance(tables, list) or not tables:
        raise StudyError(f"{file}: a study file holds [[study]] tables and nothing else")
    found = [case for n, table in enumerate(tables, 1) for case in _cases(table, f"{file}, study {n}")]
    return Study(tuple(dict.fromkeys(found)))


def run_study(
    study: Study,
    store: Store | str | Path,
    executor: Executor | None = None,
    progress: Callable[[Status], None] | None = None,
) -> Status:
    """Run the cases of a study that are not finished yet, and keep each one as soon as it is.

    Parameters
    ----------
    study
        The cases.
    store
        The file that keeps them.
    executor
        Where to run: a process pool, ``dask.distributed``'s ``Client.get_executor()``,
        ``mpi4py.futures``; this process if left out. Only this process writes to the file.
    progress
        Called with the status after each case.

    Returns
    -------
    Status
        How many cases of the whole file finished, failed, and are pending.

    Raises
    ------
    StudyError
        Where workers of the executor died; what was finished is kept, run again to go on.
    StoreError
        Where the file can't be written.
    """
    kept = store if isinstance(store, Store) else Store(Path(store))
    keyed = {key_of(case): case for case in study.cases}
    kept.add_cases({key: json.dumps(case.to_dict()) for key, case in keyed.items()})
    done = kept.records()
    _run({key: case for key, case in keyed.items() if key not in done}, kept, executor, progress)
    return status_of(kept)


def resume(
    store: Store | str | Path,
    executor: Executor | None = None,
    progress: Callable[[Status], None] | None = None,
) -> Status:
    """Run the pending cases of a file; see :func:`run_study`."""
    kept = store if isinstance(store, Store) else Store(Path(store))
    cases = kept.cases()
    written = {key: Case.from_dict(json.loads(cases[key])) for key in kept.pending()}
    for key, case in written.items():
        if key_of(case) != key:
            raise StudyError(
                f"{kept.path} was begun with other versions of canon or its libraries; resume with those, "
                "or run the study again to have all cases with the present ones"
            )
    _run(written, kept, executor, progress)
    return status_of(kept)


def status_of(store: Store) -> Status:
    """Return how many cases of a file finished, failed, and are pending."""
    records = store.records().values()
    failed = sum(bool(record.failure) for record in records)
    return Status(len(records) - failed, failed, len(store.pending()))


def finished_rows(store: Store) -> list[dict[str, Any]]:
    """Return one flat row a case for export: inputs, outcome or failure, seconds."""
    records = store.records()
    rows: list[dict[str, Any]] = []
    for key, inputs in store.cases().items():
        record = records.get(key)
        state = "pending" if record is None else "failed" if record.failure else "finished"
        outcome = json.loads(record.outcome) if record is not None and record.outcome else {}
        seconds = None if record is None else record.seconds
        failure = "" if record is None else record.failure
        rows.append(
            {
                "key": key,
                "state": state,
                **json.loads(inputs),
                **outcome,
                "seconds": seconds,
                "failure": failure,
            }
        )
    return rows


def record_of(key: str, case: Case) -> Record:
    """Return the record of a case, run here and now; this is what workers do."""
    row = run_case(case)
    outcome = json.dumps(outcome_of(row)) if row.drift is not None else ""
    return Record(key, outcome, row.failure, row.cpu_seconds)


def _run(
    cases: Mapping[str, Case],
    store: Store,
    executor: Executor | None,
    progress: Callable[[Status], None] | None,
) -> None:
    status = status_of(store) if progress is not None else None
    records = _here(cases) if executor is None else _on(executor, cases)
    for record in records:
        store.save(record)
        if progress is not None and status is not None:
            failed = bool(record.failure)
            status = replace(
                status,
                finished=status.finished + (not failed),
                failed=status.failed + failed,
                pending=status.pending - 1,
            )
            progress(status)


def _here(cases: Mapping[str, Case]) -> Iterator[Record]:
    return (record_of(key, case) for key, case in cases.items())


def _on(executor: Executor, cases: Mapping[str, Case]) -> Iterator[Record]:
    """Yield records as they are finished; where workers die, first those that others finished."""
    left = iter(cases.items())
    flying: set[Future[Record]] = set()
    lost: list[str] = []
    try:
        while True:
            if not lost:
                flying |= {
                    executor.submit(record_of, key, case)
                    for key, case in islice(left, IN_FLIGHT - len(flying))
                }
            if not flying:
                break
            done, flying = wait(flying, return_when=FIRST_COMPLETED)
            for future in done:
                error = future.exception()
                if error is None:
                    yield future.result()
                else:
                    lost.append(f"{type(error).__name__}: {error}")
    except BrokenExecutor as error:
        lost.append(f"{type(error).__name__}: {error}")
    finally:
        for future in flying:
            future.cancel()
    if lost:
        raise StudyError(
            f"workers died while they ran cases ({lost[0]}); what was finished is kept, run again to go on"
        )


def _cases(table: Mapping[str, Any], where: str) -> Iterator[Case]:
    unknown = sorted(set(table) - {*AXES, *LENGTHS})
    if unknown:
        raise StudyError(f"{where}: unknown key {unknown[0]!r}; there are {', '.join((*AXES, *LENGTHS))}")
    for name in ("scene", "method"):
        if name not in table:
            raise StudyError(f"{where}: {name!r} is missing")
    if ("periods" in table) == ("until" in table):
        raise StudyError(f"{where}: give the duration as periods or as until, and not as both")
    parameters = dict(table.get("parameters", {}))
    try:
        for values in product(*(_listed(table.get(name)) for name in AXES)):
            yield _case(dict(zip(AXES, values, strict=True)), parameters, table)
    except (SceneError, ValueError, TypeError) as error:
        raise StudyError(f"{where}: {error}") from error


def _case(chosen: Mapping[str, Any], parameters: Mapping[str, float], table: Mapping[str, Any]) -> Case:
    scene = find(chosen["scene"]).with_parameters(**parameters)
    if chosen["start"] is None or isinstance(chosen["start"], str):
        scene.start(chosen["start"])
    method = method_from(chosen["method"]) if isinstance(chosen["method"], str | dict) else chosen["method"]
    span = float(table["until"]) if "until" in table else float(table["periods"]) * scene.period
    start = tuple(chosen["start"]) if isinstance(chosen["start"], list) else chosen["start"]
    fixed = isinstance(method, FixedStep)
    if fixed and chosen["step"] is None:
        raise ValueError(f"{method} takes fixed steps: give step")
    return Case(
        scene=scene.name,
        method=method,
        span=span,
        samples=int(table.get("samples", 4096)),
        start=start,
        parameters=tuple(sorted((name, float(value)) for name, value in parameters.items())),
        step=chosen["step"] if fixed else None,
        tolerance=None if fixed else chosen["tolerance"],
        precision=chosen["precision"] if fixed else None,
    )


def _listed(value: Any) -> Iterable[Any]:
    return value if isinstance(value, list | tuple) else [value]
