"""Print how long a person waits at a cold shell: whole commands in fresh processes, beside their imports.

    python benchmarks/waiting.py

By the clock, the median of runs that take turns, and the processor time of a run beside it. What comes before canon
begins is what Python and the libraries take to load that the command needs: SymPy, NumPy and heyoka. Machine code that
an earlier process has compiled is loaded again, as it is at the second call of a command; what the first call took,
which found none, stands behind.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

RUNS = 5
COMMANDS = {
    "canon drift simple-pendulum --periods 10000": ["drift", "simple-pendulum", "--periods", "10000"],
    "canon choose kepler": ["choose", "kepler"],
}
LIBRARIES = {
    "python -c pass": "pass",
    "import canon": "import canon",
    "import sympy, numpy, heyoka": "import sympy, numpy, heyoka",
}


def waited(arguments: list[str], cache: str) -> tuple[float, float]:
    """Return the seconds of a process, by the clock and of the processor."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    begun = time.perf_counter()
    subprocess.run(
        [sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        env=os.environ | {"XDG_CACHE_HOME": cache},
    )  # fmt: skip
    clock, after = time.perf_counter() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    return clock, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Print the table."""
    calls = {name: ["-c", statement] for name, statement in LIBRARIES.items()}
    calls |= {name: ["-m", "canon.cli", *arguments] for name, arguments in COMMANDS.items()}
    print(f"seconds of a fresh process: by the clock, of the processor; medians of {RUNS}")
    with tempfile.TemporaryDirectory() as cache:
        first = {name: waited(arguments, cache) for name, arguments in calls.items()}
        times = [{name: waited(arguments, cache) for name, arguments in calls.items()} for _ in range(RUNS)]
    for name in calls:
        clock, processor = (statistics.median(each[name][k] for each in times) for k in (0, 1))
        cold = f"   {first[name][0]:.2f} where nothing was compiled before" if name in COMMANDS else ""
        print(f"{name:46}{clock:8.2f}{processor:8.2f}{cold}")


if __name__ == "__main__":
    main()
