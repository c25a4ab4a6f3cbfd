"""What a motion costs beside its steps: a further call, machine code compiled and loaded, energies of double-double.

Processor milliseconds, medians of calls that take turns, the second of two in a row each.
``python benchmarks/preparation.py``
"""

from __future__ import annotations

import os
import statistics
import tempfile
import time
from typing import TYPE_CHECKING, Any
from unittest import mock

from canon import Splitting, Taylor, WisdomHolman, propagate
from canon.flow import prepare
from canon.flow.fixed_step import compiled_loop, kept_loops
from canon.flow.run import observables_along
from canon.kernel.llvm import kept_code, machine_code
from canon.scene import find

if TYPE_CHECKING:
    from collections.abc import Callable

TURNS = 15
CALLS = (
    ("Kepler, 1000 periods", "kepler", WisdomHolman(), 1, 1000),
    ("Kepler, 100 periods", "kepler", Splitting("kahan-li-8"), 50, 100),
    ("Kepler, 10 periods", "kepler", Taylor(1e-9), 0, 10),
    ("planets, 1000 periods", "outer-solar-system", WisdomHolman(), 6, 1000),
    ("planets, 10 periods", "outer-solar-system", Taylor(1e-9), 0, 10),
    ("FPUT, 100 periods", "fput", Splitting("srkn-6b"), 50, 100),
)
"""Systems, methods, steps a period where they are of one size, and periods."""


def run_of(
    scene: str,
    method: Any,
    steps: int,
    periods: int,
    precision: str = "double",
    samples: int = 1,
    *,
    prepared: bool = False,
) -> Callable[[], Any]:
    """Return what integrates a scene from its first start, prepared or not."""
    known = find(scene)
    period, start = known.time_scale(known.values), known.state(known.starts[0])
    given: dict[str, Any] = {"method": method, "parameters": known.values, "samples": samples}
    if steps:
        given |= {"step": period / steps * (1 + 1e-10), "precision": precision}
    span = (0.0, periods * period)
    if prepared:
        made = prepare(known.hamiltonian, span, **given)
        return lambda: made.propagate(start)
    return lambda: propagate(known.hamiltonian, span, start, **given)


def milliseconds(call: Callable[[], Any]) -> tuple[float, Any]:
    """Return how long a call takes, and what it returns."""
    begun = time.process_time()
    found = call()
    return 1e3 * (time.process_time() - begun), found


def further_calls() -> None:
    """Print what a further call takes beside its loop."""
    print(
        "a further call of propagate, then of a prepared motion, ms: the whole, its steps, what is beside them"
    )
    runs = [
        (f"prepared {name}" if prepared else name, method, run_of(scene, method, steps, n, prepared=prepared))
        for prepared in (False, True)
        for name, scene, method, steps, n in CALLS
    ]
    for _ in range(TURNS):
        for _, _, run in runs:
            run()
    taken: list[list[tuple[float, float]]] = [[] for _ in runs]
    for _ in range(TURNS):
        for (_, _, run), times in zip(runs, taken, strict=True):
            run()  # the first of two finds caches full of what the others did
            whole, motion = milliseconds(run)
            times.append((whole, 1e3 * motion.cpu_seconds))
    for (name, method, _), times in zip(runs, taken, strict=True):
        whole, steps = (statistics.median(part) for part in zip(*times, strict=True))
        print(f"{name:32}{method!s:16}{whole:9.3f}{steps:9.3f}{whole - steps:9.3f}")


def loops() -> None:
    """Print what it takes to compile a loop, and to load it again."""
    print("\nmachine code of a loop, ms: compiled, and loaded where an earlier process had compiled it")
    for name, scene, method, precision in (
        ("Kepler", "kepler", Splitting("kahan-li-8"), "compensated"),
        ("Kepler", "kepler", Splitting("kahan-li-8"), "double-double"),
        ("planets", "outer-solar-system", WisdomHolman(), "double"),
        ("FPUT", "fput", Splitting("srkn-6b"), "compensated"),
    ):
        run, compiled, loaded = run_of(scene, method, 50, 1, precision), [], []
        for _ in range(5):
            with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, XDG_CACHE_HOME=folder):
                kept_code.folder_of_code.cache_clear()
                compiled.append(made_anew(run))
                loaded.append(made_anew(run))
        kept_code.folder_of_code.cache_clear()
        print(f"{name:12}{method!s:16}{precision:16}{min(compiled):9.2f}{min(loaded):9.2f}")


def made_anew(run: Callable[[], Any]) -> float:
    """Return how long the machine code of a run takes that this process does not remember."""
    spent: list[float] = []
    compile_or_load = machine_code.compiled

    def timed(*given: Any) -> Any:
        more, found = milliseconds(lambda: compile_or_load(*given))
        spent.append(more)
        return found

    for kept in (*vars(compiled_loop).values(), *vars(kept_loops).values()):
        if hasattr(kept, "cache_clear"):
            kept.cache_clear()
    with mock.patch("canon.kernel.llvm.loop.compiled", timed):
        run()
    return sum(spent) / len(spent)


def energies() -> None:
    """Print what energies of a motion in double-double take, in 113 bits and in 40 digits."""
    print("\ntwenty periods in double-double, 1000 energies, ms: steps, the whole in 113 bits, in 40 digits")
    for name, scene in (("Kepler", "kepler"), ("planets", "outer-solar-system"), ("FPUT", "fput")):
        run = run_of(scene, Splitting("srkn-6b"), 50, 20, "double-double", 1000)
        motion = run()
        short = statistics.median(milliseconds(run)[0] for _ in range(5))
        with mock.patch.object(observables_along, "quad_for", return_value=None):
            long, _ = milliseconds(run)
        print(f"{name:12}{1e3 * motion.cpu_seconds:9.1f}{short:9.1f}{long:9.1f}")


def main() -> None:
    """Print the three tables."""
    further_calls()
    loops()
    energies()


if __name__ == "__main__":
    main()
