"""How waiting grows with size: a table of processor seconds and the slope of their logarithms.

    python benchmarks/growth.py              # every row, some minutes
    python benchmarks/growth.py --quick      # without the largest size of each row
    python benchmarks/growth.py chain bodies # some rows

Each size is measured once, in a process of its own, its start and imports left out: a smaller one of its kind, half of
the smallest, goes before it. The slope is that between the two
largest sizes: 1 is linear. What is counted is the processor time of the process and its children.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

HERE = Path(__file__)
sys.path.insert(0, str(HERE.parents[1]))


class Row(NamedTuple):
    what: str
    sizes: tuple[int, ...]
    work: Callable[[int], Callable[[], object]]
    """From a size to the work that is timed; what it prepares is not."""


def used() -> float:
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def _sites(count: int) -> Any:
    """Return places, momenta and stretches of a chain between two walls."""
    import sympy as sp

    q, p = sp.symbols(f"q0:{count}", real=True), sp.symbols(f"p0:{count}", real=True)
    return q, p, [b - a for a, b in zip((sp.Integer(0), *q), (*q, sp.Integer(0)), strict=True)]


def _first_step(H: Any, q: Any, p: Any, places: Any) -> Callable[[], object]:
    """Return what goes from H to the state after the first step, from rest."""
    import numpy as np

    from canon import Hamiltonian, Splitting, propagate

    start, how = (
        np.concatenate([places, np.zeros(len(places))]),
        {"method": Splitting("verlet"), "samples": 1},
    )
    return lambda: propagate(Hamiltonian(H, q, p), (0, 0.001), start, step=0.001, **how)


def _scattered(number: int) -> Any:
    """Return the coordinates of so many bodies in space."""
    import numpy as np

    return 10 * np.random.default_rng(1).normal(size=3 * number)


def chain(sites: int) -> Callable[[], object]:
    """From H, a sum that SymPy has built, to the state after the first step."""
    import numpy as np
    import sympy as sp

    q, p, stretches = _sites(sites)
    H = sp.Add(*(x**2 / 2 for x in p), *(d**2 / 2 + d**4 / 40 for d in stretches))
    return _first_step(H, q, p, np.sin(np.arange(sites)))


def chain_kept(sites: int) -> Callable[[], object]:
    """The same of a chain whose bonds are kept as one term."""
    import numpy as np

    from canon.mechanics import chain_sum, row_sum

    q, p, _ = _sites(sites)
    bonds = chain_sum(lambda a, b: (b - a) ** 2 / 2 + (b - a) ** 4 / 40, [0, *q, 0])
    H = row_sum(lambda p: p**2 / 2, p) + bonds
    return _first_step(H, q, p, np.sin(np.arange(sites)))


def lattice(sites: int) -> Callable[[], object]:
    """The same of a square lattice of pendulums that neighbours couple."""
    import numpy as np
    import sympy as sp

    from canon.mechanics import lattice_sum, row_sum

    side = math.isqrt(sites)
    q, p, _ = _sites(side * side)
    bonds = lattice_sum(lambda a, b: (b - a) ** 2 / 2, np.array(q).reshape(side, side), periodic=True)
    H = row_sum(lambda p: p**2 / 2, p) + bonds + row_sum(lambda q: 1 - sp.cos(q), q)
    return _first_step(H, q, p, np.sin(np.arange(side * side)))


def stiff(sites: int) -> Callable[[], object]:
    """A thousand steps of a stiff chain by Newton's iteration, whose loop has been compiled."""
    import numpy as np
    import sympy as sp

    from canon import Gauss, Hamiltonian, propagate

    q, p, stretches = _sites(sites)
    H = Hamiltonian(sp.Add(*(x**2 / 2 for x in p), *(5000 * (d**2 + d**4) for d in stretches)), q, p)
    start = np.concatenate([np.sin(np.arange(sites)) / 100, np.zeros(sites)])
    how = {"method": Gauss(3, iteration="newton"), "step": 0.05, "samples": 1}
    propagate(H, (0, 0.05), start, **how)
    return lambda: propagate(H, (0, 50), start, **how)


def bodies(number: int) -> Callable[[], object]:
    """The same of bodies that attract each other, every pair a term."""
    import sympy as sp

    x = [sp.symbols(f"x{k} y{k} z{k}", real=True) for k in range(number)]
    p = sp.symbols(f"p0:{3 * number}", real=True)
    pairs = [
        -1 / sp.sqrt(sum((a - b) ** 2 for a, b in zip(x[i], x[k], strict=True)))
        for i in range(number)
        for k in range(i)
    ]
    H = sp.Add(*(each**2 / 2 for each in p), *pairs)
    return _first_step(H, [s for body in x for s in body], p, _scattered(number))


def bodies_kept(number: int) -> Callable[[], object]:
    """The same of bodies whose attraction is kept as one term."""
    import sympy as sp

    from canon.mechanics import pair_sum, row_sum

    x = [sp.symbols(f"x{k} y{k} z{k}", real=True) for k in range(number)]
    p = sp.symbols(f"p0:{3 * number}", real=True)
    attraction = pair_sum(lambda a, b: -1 / sp.sqrt(sum((u - v) ** 2 for u, v in zip(a, b, strict=True))), x)
    H = row_sum(lambda p: p**2 / 2, p) + attraction
    return _first_step(H, [s for body in x for s in body], p, _scattered(number))


def links(number: int) -> Callable[[], object]:
    """From the Lagrangian of a pendulum of many links to its accelerations as a function of numbers."""
    import sympy as sp

    from canon import Lagrangian, coordinates
    from canon.flow import right_hand_side

    angles = coordinates(" ".join(f"theta{k}" for k in range(number)))
    speeds, heights = [], []
    vx = vy = height = sp.Integer(0)
    for a in angles:
        vx, vy, height = vx + sp.cos(a) * a.dot, vy + sp.sin(a) * a.dot, height - sp.cos(a)
        speeds.append((vx**2 + vy**2) / 2)
        heights.append(height)
    L = Lagrangian(sp.Add(*speeds) - sp.Add(*heights), list(angles))
    start = [0.1] * number + [0.0] * number
    return lambda: right_hand_side(L, start)(0.0, start)


def claims(number: int) -> Callable[[], object]:
    """A sheet of so many different claims, judged in one process."""
    from canon.exercise.sheet.sheet import Claim
    from canon.exercise.sheet_check import judged

    def claim(k: int) -> Claim:
        keys = {
            "lhs": f"sin({k + 1}*x)**2 + cos({k + 1}*x)**2 + {k}",
            "rhs": str(k + 1),
            "parameters": {"x": "real"},
        }
        return Claim(f"c{k}", "equality-only", keys)

    sheet = [claim(k) for k in range(number)]
    return lambda: list(judged(sheet))


def cases(number: int) -> Callable[[], object]:
    """A study of so many short cases, from the first to its finished status."""
    from canon.study.cases.run_study import run_study

    study, store = _study(number)
    return lambda: run_study(study, store)


def _study(number: int) -> tuple[Any, Any]:
    """Return a study of so many cases and an empty store."""
    from canon import Splitting
    from canon.study.cases.store import Store
    from canon.study.cases.study import Study

    starts = [[0.0, 0.1 + 0.3 * k / number, 0.4, 0.1] for k in range(number)]
    study = Study.of(
        system="henon-heiles", start=starts, method=Splitting("verlet"), step=0.05, span=25.6, samples=256
    )
    return study, Store(Path(tempfile.mkdtemp()) / "grows.sqlite")


def _finished(number: int) -> tuple[Any, Any, Callable[[], None]]:
    """Return the same, and what writes all of its outcomes, which are that of the first case."""
    from dataclasses import replace

    from canon.study.cases.case import key_of
    from canon.study.cases.run_study import run_study
    from canon.study.cases.study import Study

    study, store = _study(number)
    run_study(Study(study.cases[:1]), store)
    (record,) = store.records().values()
    keyed = {key_of(case): case.to_text() for case in study.cases}

    def write() -> None:
        store.add_cases(keyed)
        for key in keyed:
            store.save(replace(record, key=key))

    return study, store, write


def stored(number: int) -> Callable[[], object]:
    """The inputs and outcomes of so many cases, written into the file one by one as they end."""
    return _finished(number)[2]


def told(number: int) -> Callable[[], object]:
    """The status of a study of so many finished cases, ten times, and one reading of what came of all."""
    from canon.study.cases.run_study import status_of

    _, store, write = _finished(number)
    write()
    return lambda: ([status_of(store) for _ in range(10)], store.records())


def resumed(number: int) -> Callable[[], object]:
    """A study of so many cases of which all but ten are finished, run again."""
    from canon.study.cases.run_study import run_study

    study, store, write = _finished(number)
    write()
    store.forget([*store.records()][-10:])
    return lambda: run_study(study, store)


def samples(number: int) -> Callable[[], object]:
    """One orbit of as many steps, each kept, and its energy error."""
    return _pendulum(lambda H, how: how(H, (0, number / 10), [1.0, 0.0], step=0.1, samples=number))


def orbits(number: int) -> Callable[[], object]:
    """So many orbits side by side for 100 steps."""
    import numpy as np

    starts = np.array([np.linspace(0.1, 2.0, number), np.zeros(number)])
    return _pendulum(lambda H, how: how(H, (0, 10), starts, step=0.1, samples=1))


def _pendulum(go: Callable[..., object]) -> Callable[[], object]:
    from functools import partial

    import sympy as sp

    from canon import Hamiltonian, Splitting, propagate

    q, p = sp.symbols("q p", real=True)
    H = Hamiltonian(p**2 / 2 - sp.cos(q), [q], [p])
    how = partial(propagate, method=Splitting("verlet"))
    how(H, (0, 1), [1.0, 0.0], step=0.1, samples=1)
    return lambda: go(H, how)


ROWS = {
    "chain": Row("sites of a chain written out, H to first step", (100, 300, 1_000, 3_000, 10_000), chain),
    "chain_kept": Row(
        "sites of a chain, chain_sum, H to first step",
        (100, 1_000, 3_000, 10_000, 30_000, 100_000),
        chain_kept,
    ),
    "lattice": Row(
        "sites of a square lattice, lattice_sum, H to first step", (100, 900, 10_000, 90_000), lattice
    ),
    "stiff": Row("sites of a stiff chain, 1,000 steps by Newton's stages", (8, 16, 32, 64, 128), stiff),
    "bodies": Row("bodies that attract, written out, H to first step", (10, 20, 50, 100, 200), bodies),
    "bodies_kept": Row(
        "bodies that attract, pair_sum, H to first step", (10, 30, 100, 200, 1_000, 3_000), bodies_kept
    ),
    "links": Row("links of a pendulum, L to first accelerations", (5, 10, 20, 40, 80), links),
    "claims": Row("claims of a sheet", (10, 100, 1_000, 10_000), claims),
    "cases": Row("cases of a study", (10, 100, 1_000, 10_000), cases),
    "stored": Row("cases written to a study's file", (10, 100, 1_000, 10_000, 100_000), stored),
    "told": Row("cases whose status is asked for", (10, 100, 1_000, 10_000, 100_000), told),
    "resumed": Row("cases of a study that is resumed", (10, 100, 1_000, 10_000, 100_000), resumed),
    "samples": Row("samples of an orbit", (10**3, 10**4, 10**5, 10**6, 10**7), samples),
    "orbits": Row("orbits side by side, 100 steps", (1, 10, 10**2, 10**3, 10**4, 10**5, 10**6), orbits),
}


def alone(name: str, size: int) -> float:
    """Return the seconds of one size, measured in a process of its own."""
    done = subprocess.run(
        [sys.executable, str(HERE), "--one", name, str(size)], capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"{name} {size}: {done.stderr.strip().splitlines()[-1]}")
    return float(json.loads(done.stdout))


def one(name: str, size: int) -> float:
    row = ROWS[name]
    row.work(
        row.sizes[0] // 2 or 1
    )()  # a smaller one of its kind, so that modules are loaded before it is timed
    work = row.work(size)
    begun = used()
    work()
    return used() - begun


def table(names: list[str], quick: bool) -> None:
    for name in names:
        row = ROWS[name]
        sizes = row.sizes[:-1] if quick else row.sizes
        found = [alone(name, size) for size in sizes]
        slope = math.log(found[-1] / found[-2]) / math.log(sizes[-1] / sizes[-2])
        print(row.what)
        print("  size     " + "".join(f"{size:>11,}" for size in sizes))
        print(
            "  seconds  " + "".join(f"{seconds:>11.3f}" for seconds in found) + f"   slope {slope:.2f}",
            flush=True,
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("rows", nargs="*", choices=[*ROWS, []], help="rows of the table, all where not given")
    parser.add_argument("--quick", action="store_true", help="without the largest size of each row")
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        print(json.dumps(one(given.one[0], int(given.one[1]))))
    else:
        os.environ.setdefault("PYTHONHASHSEED", "0")
        table(given.rows or list(ROWS), given.quick)


if __name__ == "__main__":
    main()
