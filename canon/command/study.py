"""``canon study``: run, watch, resume, export and report studies of many cases."""

from __future__ import annotations

import argparse
import sys
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from canon.command.argument_types import seconds, whole_number
from canon.command.exit_status import INTERRUPTED
from canon.printable import in_one_line, printable

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable, Generator, Sequence
    from concurrent.futures import Executor

    from canon.study.cases.chunk_damage import DamagedFile
    from canon.study.cases.result import Result, Results
    from canon.study.cases.row_checksum import DamagedRow
    from canon.study.cases.run_study import StudyStatus
    from canon.study.cases.store import Store

__all__ = ["DESCRIPTION", "EXAMPLES", "add_arguments", "run"]

LAST_WAIT = 5.0
"""Seconds that an interrupted study waits for its pool of processes to end."""

DESCRIPTION = """\
Run every combination of systems, starts, parameters, methods and steps of a study and keep what comes of it in one
SQLite file. What is finished is never run again; what was interrupted, killed or cut off goes on from its last
checkpoint, to the same bits.
"""
EXAMPLES = """\
a study (TOML):

  [system.quartic]                       a Hamiltonian of one's own, in canon's expression language
  H = "p**2/(2*m) + k*q**4/4"
  q = "q"
  p = "p"
  parameters = { m = 1.0, k = 2.0 }
  starts = { near = [0.5, 0.0], far = [2.0, 0.0] }

  [[study]]                              every combination of what is listed
  system = ["quartic", "simple-pendulum"]
  method = ["verlet", "kahan-li-8", { gauss = 4 }, "taylor"]
  step = [0.05, 0.1, 0.2]
  span = 10000.0

examples:
  canon study run drifts.toml --jobs 4              keeps its results in drifts.sqlite
  canon study status drifts.sqlite --plot now.png   how far it is; every case a cell
  canon study resume drifts.sqlite
  canon study export drifts.sqlite drifts.csv       or .parquet, .nc
  canon study report drifts.sqlite drifts.html      one page, figures inside
  canon study run drifts.toml --share 3/16 --store part3.sqlite    one of sixteen jobs of a queue
  canon study merge drifts.sqlite part*.sqlite
  canon study mend drifts.sqlite                    after bits of the file were damaged; then resume

exit status: 0 every case finished, 1 some failed, 3 some are pending, 2 bad usage or a file that can't be used
"""

FORMATS = {".csv": "CSV", ".parquet": "Parquet", ".nc": "NetCDF"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the command reads."""
    actions = parser.add_subparsers(metavar="action", dest="action", required=True)
    run_ = _action(actions, "run", "run the cases of a study file that are not finished")
    run_.add_argument("study", metavar="STUDY.toml", type=Path, help="the study")
    run_.add_argument("--store", metavar="FILE", type=Path, help="keep the results here (STUDY.sqlite)")
    run_.add_argument("--share", metavar="K/N", type=_share, help="only the K-th of N shares of the cases")
    resume = _action(actions, "resume", "run the pending cases of a results file")
    status = _action(actions, "status", "tell how far a study is, and why cases failed")
    export = _action(actions, "export", "write all cases as a table: .csv, .parquet or .nc (NetCDF)")
    report = _action(actions, "report", "write one HTML page with the figures inside")
    merge = _action(actions, "merge", "add the cases and results of other files to one")
    mend = _action(actions, "mend", "set the damaged rows of a results file aside, to be computed again")
    for action in (resume, status, export, report, merge, mend):
        action.add_argument("store", metavar="FILE", type=Path, help="the results file")
    for action in (run_, resume):
        action.add_argument("--retry", action="store_true", help="run failed cases again")
        action.add_argument(
            "--jobs", metavar="N", type=whole_number(1024), default=1, help="worker processes (1)"
        )
        action.add_argument("--dask", metavar="ADDRESS", help="run on the dask cluster with this scheduler")
        action.add_argument(
            "--checkpoint",
            metavar="S",
            type=seconds(none=True),
            default=30.0,
            help="seconds between checkpoints (30)",
        )
    for action in (run_, resume, status):
        action.add_argument("--plot", metavar="IMAGE", type=Path, help="draw the study, every case a cell")
    export.add_argument("--kept", metavar="NAME", help="not the numbers but what is kept: motion, section, …")
    report.add_argument(
        "--follow",
        metavar="S",
        type=seconds(86400.0),
        help="write it anew every S seconds, until no case is pending",
    )
    for action in (export, report):
        action.add_argument("--tag", metavar="WORD", help="only the cases with this tag")
        action.add_argument("output", metavar="OUTPUT", type=Path, help="where to write it")
    merge.add_argument("others", metavar="OTHER", type=Path, nargs="+", help="files to add")


def _action(actions: Any, name: str, line: str) -> argparse.ArgumentParser:
    return actions.add_parser(name, help=line, description=line)


def run(arguments: argparse.Namespace) -> int:
    """Do what is asked, print how far the study is, return the exit status."""
    from canon.plot import PlotError
    from canon.study.cases.export import ExportError
    from canon.study.errors import StudyError

    actions = {"run": _run, "resume": _resume, "status": _status, "export": _export, "report": _report}
    try:
        return {**actions, "merge": _merge, "mend": _mend}[arguments.action](arguments)
    except BrokenPipeError:
        raise  # the reader of the output went away, which is no error of the study
    except (StudyError, PlotError, ExportError, OSError) as error:
        print(printable(f"canon study: {error}"), file=sys.stderr)
        return 2


def _run(arguments: argparse.Namespace) -> int:
    from canon.study.cases.run_study import run_study
    from canon.study.cases.store import Store
    from canon.study.cases.study import read_study

    study = read_study(arguments.study)
    if arguments.share is not None:
        study = study.share(*arguments.share)
    store = Store(arguments.store or arguments.study.with_suffix(".sqlite"))
    _forget_failed(store, arguments)
    with _executor(arguments) as (executor, room), _progress() as progress:
        run_study(study, store, executor, progress, arguments.checkpoint, room)
    return _told(store, arguments.plot)


def _resume(arguments: argparse.Namespace) -> int:
    from canon.study.cases.run_study import resume

    store = _existing(arguments.store)
    _forget_failed(store, arguments)
    with _executor(arguments) as (executor, room), _progress() as progress:
        resume(store, executor, progress, arguments.checkpoint, room)
    return _told(store, arguments.plot)


def _status(arguments: argparse.Namespace) -> int:
    from canon.study.cases.chunk_damage import damaged_chunks
    from canon.study.cases.store import DamagedRows
    from canon.study.kept.chunk_file import DamagedChunk

    store = _existing(arguments.store)
    if damaged := store.damaged():
        _print_damaged(damaged, store)
        raise DamagedRows(store.path, damaged)
    if chunks := damaged_chunks(store):
        _print_damaged(chunks, store)
        raise DamagedChunk(
            f"{store.path}: what was kept of {len(chunks)} of its cases is damaged; "
            f"'canon study mend {store.path}' sets it aside, so that they are computed again"
        )
    return _told(store, arguments.plot)


def _export(arguments: argparse.Namespace) -> int:
    from canon.study.cases.export import csv_of, write_kept, write_netcdf, write_parquet
    from canon.study.errors import StudyError

    kind, results = FORMATS.get(arguments.output.suffix.lower()), _asked_for(arguments)
    _not_over_the_store(arguments)
    if kind is None:
        known = ", ".join(f"{ending} ({name})" for ending, name in FORMATS.items())
        raise StudyError(f"{arguments.output}: the ending of its name says the format; there are {known}")
    if arguments.kept is not None:
        if kind != "NetCDF":
            raise StudyError(f"{arguments.output}: what is kept is written as NetCDF, to a file NAME.nc")
        write_kept(results, arguments.kept, arguments.output)
    elif kind == "CSV":
        arguments.output.write_text(csv_of(results), encoding="utf-8")
    else:
        {"Parquet": write_parquet, "NetCDF": write_netcdf}[kind](results, arguments.output)
    print(f"{kind}: {arguments.output}")
    return 0


def _report(arguments: argparse.Namespace) -> int:
    from canon.command.followed_report import follow
    from canon.plot.study_page import study_report

    _not_over_the_store(arguments)
    if arguments.follow is None:
        page = study_report(_asked_for(arguments), arguments.store.stem)
        arguments.output.write_text(page, encoding="utf-8")
    else:
        store, told = _existing(arguments.store), partial(print, flush=True)
        follow(store, partial(_asked_for, arguments), arguments.output, arguments.follow, told)
    print(f"report: {arguments.output}")
    return 0


def _not_over_the_store(arguments: argparse.Namespace) -> None:
    from canon.study.errors import StudyError

    if arguments.output.resolve() == arguments.store.resolve():
        raise StudyError(f"{arguments.output} holds the results themselves; give another file to write to")


def _asked_for(arguments: argparse.Namespace) -> Results:
    """Return the results of a file, of the cases with one tag where that is asked for."""
    from canon.study.cases.result import results_of
    from canon.study.errors import StudyError

    results = results_of(_existing(arguments.store))
    if arguments.tag is None:
        return results
    if not (found := results.where(tag=arguments.tag)):
        known = ", ".join(dict.fromkeys(tag for result in results for tag in result.case.tags))
        raise StudyError(
            f"{arguments.store}: no case has the tag {arguments.tag!r}; there are {known or 'none'}"
        )
    return found


def _merge(arguments: argparse.Namespace) -> int:
    from canon.study.cases.store import Store

    others = [_existing(other) for other in arguments.others]
    store = Store(arguments.store)
    for other in others:
        store.add_from(other)
    return _told(store, None)


def _mend(arguments: argparse.Namespace) -> int:
    from canon.study.cases.mend import mend
    from canon.study.kept.chunk_file import ChunkFolder

    _require_file(arguments.store)
    mended = mend(arguments.store)
    if mended.aside is not None:
        print(f"{arguments.store} was damaged and is kept as {mended.aside}; not taken over from it:")
        _print_damaged(mended.lost, mended.store)
        if any(row.table == "cases" for row in mended.lost):
            print("  run the study file again to have the cases whose inputs are lost")
    if mended.chunks:
        print(f"set aside in {ChunkFolder(arguments.store).path}:")
        _print_damaged(mended.chunks, mended.store)
    return _told(mended.store, None)


def _print_damaged(rows: Sequence[DamagedRow | DamagedFile], store: Store) -> None:
    """Print which rows are damaged, each by its case in words where the inputs can be read."""
    from canon.study.cases.result import motions_and_settings

    called = motions_and_settings(store)
    for row in rows:
        print(in_one_line(f"  damaged: {row.what} of {called.get(row.key, f'case {row.key[:12]}')}"))


def _existing(path: Path) -> Store:
    """Return the store in a file; reading should not make an empty one where a name is mistyped."""
    from canon.study.cases.store import existing_store

    _require_file(path)
    return existing_store(path)


def _require_file(path: Path) -> None:
    from canon.study.cases.store import StoreError

    if not path.exists():
        raise StoreError(f"there is no file {path}; 'canon study run STUDY.toml' makes one")


def _forget_failed(store: Store, arguments: argparse.Namespace) -> None:
    if arguments.retry:
        store.forget([key for key, record in store.records().items() if record.failure])


def _told(store: Store, plot: Path | None) -> int:
    """Print how far a study is and why cases failed; draw it where that is asked for."""
    from canon.study.cases.result import State, results_of
    from canon.study.cases.run_study import status_of

    status, results = status_of(store), results_of(store)
    print(f"{store.path}: {status}")
    for result in results:
        if result.state is State.FAILED:
            print(in_one_line(f"  failed: {result.motion}, {result.setting}: {result.failure}"))
        elif result.done and result.state is State.PENDING:
            print(in_one_line(f"  begun: {result.motion}, {result.setting}: {100 * result.done:.0f} % done"))
    if plot is not None and results:
        _draw(results, plot)
    return 1 if status.failed else 3 if status.pending else 0


def _draw(results: Sequence[Result], plot: Path) -> None:
    from canon.plot import plot_study_heatmap

    figure = plot_study_heatmap(results).get_figure(root=True)
    if figure is not None:
        figure.savefig(plot, dpi=150, bbox_inches="tight")
    print(f"figure: {plot}")


@contextmanager
def _executor(arguments: argparse.Namespace) -> Generator[tuple[Executor | None, int | None]]:
    """Start what the cases are run on (worker processes, a cluster's client, or nothing); tell how many it takes."""
    if arguments.dask:
        from canon.study.errors import StudyError

        try:
            from distributed import Client
        except ImportError as missing:
            raise StudyError("a dask cluster needs: pip install canon-mechanics[cluster]") from missing
        with Client(arguments.dask) as client:
            threads: Any = client.nthreads()
            yield client.get_executor(), 1 + sum(threads.values())
    elif arguments.jobs > 1:
        import multiprocessing
        from concurrent.futures import ProcessPoolExecutor

        from canon.process import end_with_parent
        from canon.trusted_folders import safe_path

        spawned = multiprocessing.get_context("spawn")
        with (
            safe_path(),
            ExitStack() as last,
            ProcessPoolExecutor(arguments.jobs, spawned, end_with_parent) as pool,
        ):
            try:
                yield pool, arguments.jobs + 1
            except BaseException as ended:  # nobody waits for what they compute any more
                if isinstance(ended, KeyboardInterrupt):
                    last.callback(_end_anyway().cancel)
                for worker in multiprocessing.active_children():
                    worker.kill()
                raise
    else:
        yield None, None


def _end_anyway() -> threading.Timer:
    """End this process soon unless cancelled: Python's pool waits for ever for what a killed worker began to send."""
    import os
    import threading

    def end() -> None:
        print("canon: interrupted", file=sys.stderr, flush=True)
        os._exit(INTERRUPTED)

    timer = threading.Timer(LAST_WAIT, end)
    timer.daemon = True
    timer.start()
    return timer


@contextmanager
def _progress() -> Generator[Callable[[StudyStatus], None]]:
    """Show how much of the cases is done, and the time that is left."""
    from canon.progress import ProgressBar

    with ProgressBar() as bar:

        def show(status: StudyStatus) -> None:
            done = status.finished + status.failed + status.partly
            failed = f", {status.failed} failed" if status.failed else ""
            bar("study", done, status.total, f"{done:.2f} of {status.total} cases{failed}")

        yield show


def _share(text: str) -> tuple[int, int]:
    number, slash, of = text.partition("/")
    if not (slash and number.isdecimal() and of.isdecimal() and 1 <= int(number) <= int(of)):
        raise argparse.ArgumentTypeError(f"{text!r} should be K/N, such as 3/16")
    return int(number), int(of)
