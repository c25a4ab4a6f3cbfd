"""Print what ``import canon`` costs beside ``import sympy``: medians over fresh processes, in turn."""

import statistics
import subprocess
import sys
import time

RUNS = 15


def seconds(statement: str) -> float:
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", statement], check=True)
    return time.perf_counter() - start


def main() -> None:
    statements = {
        "nothing": "pass",
        "import sympy": "import sympy",
        "import canon": "import canon",
        "import sympy, canon": "import sympy, canon",
        "import canon; canon.Lagrangian": "import canon; canon.Lagrangian",
    }
    times: dict[str, list[float]] = {name: [] for name in statements}
    for name in statements:
        seconds(statements[name])  # warm the file cache
    for _ in range(RUNS):
        for name, statement in statements.items():
            times[name].append(seconds(statement))
    base = statistics.median(times["import sympy"])
    for name, series in times.items():
        median = statistics.median(series)
        print(f"{name:34s} {median * 1e3:7.0f} ms   {median / base:5.2f} × import sympy")


if __name__ == "__main__":
    main()
