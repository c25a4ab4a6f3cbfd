"""Running a study on any executor: finished cases are kept, interrupted ones resumed."""

from __future__ import annotations

import json
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.symbols.user_input import counted
from canon.study.cases.case import Case, case_in, key_of, part_count, versions
from canon.study.cases.checkpointed_run import Checkpoint, FailedRun, Outcome, advance
from canon.study.cases.kept_of_case import FailedFunction, kept_arrays
from canon.study.cases.store import Record, Store, existing_store
from canon.study.errors import StudyError
from canon.study.kept.chunk_file import Chunk, ChunkFolder
from canon.study.kept.keep_choice import chosen_functions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from canon.study.cases.study import Study

    Function = Callable[..., Any]
    GoOn = Callable[[str, Case, Checkpoint | None, float], "Checkpoint | Finished"]

__all__ = ["StudyStatus", "resume", "run_study", "status_of"]

IN_FLIGHT = 256
"""Cases handed to an executor at a time where it is not known how many it can run."""

CHECKPOINT_SECONDS = 30.0
"""How long a case runs before its state is kept: what a kill may cost at most, one part of the run aside."""


@dataclass(frozen=True)
class StudyStatus:
    """How far a study is; ``begun`` of the pending cases have a checkpoint, ``partly`` cases' worth is done of them.

    ``partly`` is known while a study runs, to whoever runs it.
    """

    finished: int
    failed: int
    pending: int
    begun: int = 0
    partly: float = 0.0

    @property
    def total(self) -> int:
        """All cases."""
        return self.finished + self.failed + self.pending

    def __str__(self) -> str:
        begun = f" ({self.begun} begun)" if self.begun else ""
        return f"{self.total} cases: {self.finished} finished, {self.failed} failed, {self.pending} pending{begun}"


def run_study(
    study: Study,
    store: Store | str | Path,
    executor: Executor | None = None,
    progress: Callable[[StudyStatus], None] | None = None,
    checkpoint_seconds: float = CHECKPOINT_SECONDS,
    in_flight: int | None = None,
    keep: Mapping[str, Function] | None = None,
) -> StudyStatus:
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
        Called with the status after each case and checkpoint.
    checkpoint_seconds
        Time between checkpoints of a case. Results do not depend on it.
    in_flight
        How many cases are handed to the executor at a time. They take turns from checkpoint to checkpoint, so give
        little more than it has workers; a pool of this machine tells, for others it is 256 if left out.
    keep
        Functions by name, whose results are kept of each case beside what the study says: each gets a
        :class:`canon.study.KeptMotion` and returns a number, an array, or a mapping of these by name. Workers need
        to be able to import them; a function whose code has changed is run anew, with its case. Where one raises, its
        case has failed, with what it raised and where; the other cases go on.

    Returns
    -------
    StudyStatus
        How many cases of the whole file finished, failed, and are pending.

    Raises
    ------
    StudyError
        Where cases were lost, as workers of the executor died; what was finished is kept, run again to go on.
    StoreError
        Where the file can't be written, or rows of it are damaged.
    """
    kept = store if isinstance(store, Store) else Store(Path(store))
    kept.require_intact()
    more, functions = chosen_functions(keep or {}), keep or {}
    keyed = {key_of(case): case for case in (replace(each, keep=each.keep + more) for each in study.cases)}
    kept.add_cases({key: case.to_text() for key, case in keyed.items()})
    kept.add_tags({key: case.tags for key, case in keyed.items()})
    _run(keyed, kept, executor, progress, checkpoint_seconds, in_flight, functions)
    return status_of(kept)


def resume(
    store: Store | str | Path,
    executor: Executor | None = None,
    progress: Callable[[StudyStatus], None] | None = None,
    checkpoint_seconds: float = CHECKPOINT_SECONDS,
    in_flight: int | None = None,
    keep: Mapping[str, Function] | None = None,
) -> StudyStatus:
    """Run the pending cases of a file, which must be there; see :func:`run_study`."""
    kept = store if isinstance(store, Store) else existing_store(store)
    kept.require_intact()
    cases = kept.cases()
    written = {key: case_in(cases[key]) for key in kept.pending()}
    for key, case in written.items():
        if key_of(case) != key:
            then = json.loads(cases[key]).get("versions", {})
            other = ", ".join(
                f"{name} {number}" for name, number in then.items() if number != versions().get(name)
            )
            raise StudyError(
                f"{kept.path} was begun with other versions ({other or 'not known'}); resume with those, "
                "or run the study again to have all cases with the present ones"
            )
    functions = keep or {}
    given = {*chosen_functions(functions)}
    for case in written.values():
        for name, text in case.keep:
            if text.startswith("function ") and (name, text) not in given:
                raise StudyError(
                    f"{kept.path} keeps the results of a function {name!r} of the motions, which is not given or not "
                    f"the same: resume from Python, with keep={{{name!r}: the function}}"
                )
    _run(written, kept, executor, progress, checkpoint_seconds, in_flight, functions)
    return status_of(kept)


def status_of(store: Store) -> StudyStatus:
    """Return how many cases of a file finished, failed, and are pending."""
    return StudyStatus(*store.counts())


@dataclass(frozen=True)
class Finished:
    """A record, and the chunk it names with its content, where something was kept of the case."""

    record: Record
    chunk: Chunk | None = None
    content: bytes = b""


def continue_case(
    functions: Mapping[str, Function], key: str, case: Case, reached: Checkpoint | None, seconds: float
) -> Checkpoint | Finished:
    """Run a case on and return its next checkpoint or its record; this is what workers do."""
    try:
        found = advance(case, reached, seconds)
    except FailedRun as failed:
        return Finished(Record(key, "", str(failed), failed.seconds))
    return _finished(key, case, found, functions) if isinstance(found, Outcome) else found


def _finished(key: str, case: Case, found: Outcome, functions: Mapping[str, Function]) -> Finished:
    if not case.keep:
        return Finished(Record(key, json.dumps(found.numbers), "", found.seconds))
    end = found.end
    try:
        arrays = kept_arrays(case, end.kept, np.array(end.t), np.array(end.change), functions)
    except (FailedFunction, ArithmeticError, LookupError, ValueError, RuntimeError) as error:
        return Finished(Record(key, "", f"what is to be kept of it: {error}", found.seconds))
    chunk, content = Chunk.of(key, arrays)
    outcome = json.dumps({**found.numbers, "kept": chunk.to_dict()})
    return Finished(Record(key, outcome, "", found.seconds), chunk, content)


def _run(
    cases: Mapping[str, Case],
    store: Store,
    executor: Executor | None,
    progress: Callable[[StudyStatus], None] | None,
    seconds: float,
    in_flight: int | None,
    functions: Mapping[str, Function],
) -> None:
    if in_flight is not None and in_flight < 1:
        raise StudyError(f"in_flight = {in_flight}: hand at least one case to the executor")
    if not seconds >= 0.0:
        raise StudyError(f"checkpoint_seconds = {seconds}: give a time, 0 or more")
    pending = _not_finished(cases, store)
    done: dict[str, float] = {}
    go_on = partial(continue_case, functions)
    if executor is None:
        coming = _here(pending, seconds, go_on)
    else:
        coming = _on(executor, pending, seconds, in_flight or _room(executor), go_on)
    chunks = ChunkFolder(store.path)
    for key, found in coming:
        if isinstance(found, Finished):
            store.save(found.record, partial(_keep, chunks, found))
            done.pop(key, None)
        else:
            store.save_checkpoint(key, found.part, found.to_text())
            done[key] = found.part / part_count(cases[key])
        if progress is not None:
            progress(replace(status_of(store), partly=sum(done.values())))


def _keep(chunks: ChunkFolder, found: Finished) -> None:
    """Write what a record names; in the record's transaction, so that nobody sets it aside before it is named."""
    if found.chunk is not None:
        chunks.write(found.chunk, found.content)


def _not_finished(cases: Mapping[str, Case], store: Store) -> Iterator[tuple[str, Case, Checkpoint | None]]:
    """Yield each case with its checkpoint when its turn comes, unless another process finished it meanwhile."""
    for key, case in cases.items():
        if not store.is_finished(key):
            point = store.checkpoint(key)
            yield key, case, None if point is None else Checkpoint.from_text(point)


def _here(
    pending: Iterator[tuple[str, Case, Checkpoint | None]], seconds: float, go_on: GoOn
) -> Iterator[tuple[str, Checkpoint | Finished]]:
    for key, case, reached in pending:
        found: Checkpoint | Finished | None = reached
        while not isinstance(found, Finished):
            try:
                found = go_on(key, case, found, seconds)
            except MemoryError as error:
                raise _too_large([f"{_called(key, case)}: MemoryError: {error}"]) from error
            yield key, found


def _room(executor: Executor) -> int:
    """Return how many cases keep an executor busy: one more than the workers of a pool, if it tells their number."""
    workers = getattr(executor, "_max_workers", None)
    return workers + 1 if isinstance(workers, int) else IN_FLIGHT


def _on(
    executor: Executor,
    pending: Iterator[tuple[str, Case, Checkpoint | None]],
    seconds: float,
    in_flight: int,
    go_on: GoOn,
) -> Iterator[tuple[str, Checkpoint | Finished]]:
    """Yield what comes back, sending cases on from their checkpoints; where workers die, first what others did."""
    flying: dict[Future[Checkpoint | Finished], tuple[str, Case]] = {}
    lost: list[str] = []
    too_large: list[str] = []

    def send(key: str, case: Case, reached: Checkpoint | None) -> None:
        try:
            flying[executor.submit(go_on, key, case, reached, seconds)] = key, case
        except RuntimeError as error:  # BrokenExecutor among them: it takes no more work
            lost.append(f"{type(error).__name__}: {error}")

    def fill() -> None:
        while not lost and len(flying) < in_flight and (following := next(pending, None)) is not None:
            send(*following)

    try:
        fill()
        while flying:
            done, _ = wait(flying, return_when=FIRST_COMPLETED)
            for future in done:
                key, case = flying.pop(future)
                if (why := _why_lost(future)) is not None:
                    (too_large if _kills_its_workers(future) else lost).append(f"{_called(key, case)}: {why}")
                    continue
                found = future.result()
                if isinstance(found, Checkpoint) and not lost:
                    send(key, case, found)
                yield key, found
            fill()
    finally:
        for future in flying:
            future.cancel()
    if lost:
        raise StudyError(
            f"workers died while they ran cases ({lost[0]}); what was finished is kept, run again to go on"
        )
    if too_large:
        raise _too_large(too_large)


def _too_large(cases: Sequence[str]) -> StudyError:
    return StudyError(
        f"{counted(len(cases), 'case')} took more memory than workers have, or killed them ({cases[0]}); what was "
        "finished is kept: give workers more memory, or keep fewer samples, and run again"
    )


def _called(key: str, case: Case) -> str:
    return f"case {key[:12]}, {case.system_name} with {case.method}"


def _kills_its_workers(future: Future[Checkpoint | Finished]) -> bool:
    """Tell whether a case itself is why it brings no result: dask gave it to several workers, and each died."""
    error = None if future.cancelled() else future.exception()
    return isinstance(error, MemoryError) or type(error).__name__ == "KilledWorker"


def _why_lost(future: Future[Checkpoint | Finished]) -> str | None:
    """Return why a case that was sent to a worker brings no result, None where it brings one."""
    if future.cancelled():
        return "the executor gave a case back"
    error = future.exception()
    return None if error is None else f"{type(error).__name__}: {error}"
