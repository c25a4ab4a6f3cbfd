"""Compiled loops against hand-written C: processor time of one trajectory, ratios of medians.

Run ``python benchmarks/kernels.py``; where there is no C compiler only canon's own times are printed.
"""

from __future__ import annotations

import argparse
import ctypes
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from canon.expression.symbols.symbol import coordinates
from canon.expression.symbols.symbol import time as t
from canon.flow.fixed_step.compiled_loop import compiled_loop
from canon.flow.method.method import Splitting
from canon.flow.method.number_formats import FIXED
from canon.kernel.program.hamilton_equations import equations
from canon.kernel.schemes.splitting_schemes import SCHEMES
from canon.mechanics.at_scale.sums_over_rows import chain_sum, pair_sum, row_sum

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.kernel.llvm.loop import Loop
    from canon.kernel.program.hamilton_equations import HamiltonEquations

REPEATS, PROCESSES = 7, 12
ORBITS = 10_000

FORCES = {
    "Kepler": """
        double r2 = q[0]*q[0] + q[1]*q[1], k = -1.0/(r2*sqrt(r2));
        f[0] = k*q[0]; f[1] = k*q[1];""",
    "Hénon–Heiles": """
        f[0] = -q[0] - 2.0*q[0]*q[1]; f[1] = -q[1] - q[0]*q[0] + q[1]*q[1];""",
    "FPUT": """
        double pull[N+1];
        pull[0] = q[0] + 0.25*q[0]*q[0];
        for (int i = 1; i < N; i++) { double d = q[i] - q[i-1]; pull[i] = d + 0.25*d*d; }
        pull[N] = -q[N-1] + 0.25*q[N-1]*q[N-1];
        for (int i = 0; i < N; i++) f[i] = pull[i+1] - pull[i];""",
    "N-body": """
        for (int i = 0; i < N; i++) f[i] = 0.0;
        for (int i = 0; i < B; i++) for (int j = 0; j < i; j++) {
            double x = q[3*i]-q[3*j], y = q[3*i+1]-q[3*j+1], z = q[3*i+2]-q[3*j+2];
            double r2 = x*x + y*y + z*z, k = m[i]*m[j]/(r2*sqrt(r2));
            f[3*i] -= k*x; f[3*i+1] -= k*y; f[3*i+2] -= k*z;
            f[3*j] += k*x; f[3*j+1] += k*y; f[3*j+2] += k*z;
        }""",
}

PROGRAM = """
#include <math.h>
#define N {n}
#define B {bodies}
static const double m[B] = {{ {masses} }};
static inline __attribute__((always_inline)) void force(const double *q, double *f) {{ {force} }}
void run(double *q, double *p, const double *a, const double *b, int stages, long steps) {{
    double f[N];
    for (long k = 0; k < steps; k++) {{
        for (int s = 0; s < stages; s++) {{
            for (int i = 0; i < N; i++) q[i] += a[s]*p[i]/m[i*B/N];
            force(q, f);
            for (int i = 0; i < N; i++) p[i] += b[s]*f[i];
        }}
        for (int i = 0; i < N; i++) q[i] += a[stages]*p[i]/m[i*B/N];
    }}
}}
"""


@dataclass(frozen=True)
class Case:
    """A Hamiltonian, its C force, a starting state, and a step."""

    name: str
    force: str
    H: sp.Expr
    q: tuple[sp.Symbol, ...]
    start: np.ndarray
    step: float
    masses: tuple[float, ...] = (1.0,)


def kepler() -> Case:
    x, y = q = coordinates("x y")
    H = (x.momentum**2 + y.momentum**2) / 2 - 1 / sp.sqrt(x**2 + y**2)
    return Case("Kepler", FORCES["Kepler"], H, q, np.array([0.4, 0.0, 0.0, 2.0]), 2 * np.pi / 1000)


def henon_heiles() -> Case:
    x, y = q = coordinates("x y")
    H = (x.momentum**2 + y.momentum**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3
    return Case("Hénon–Heiles", FORCES["Hénon–Heiles"], H, q, np.array([0.1, 0.2, 0.3, 0.1]), 0.05)


def fput(n: int) -> Case:
    """A chain with fixed ends, H = Σ p²/2 + Σ d²/2 + d³/12 of the neighbours' distances d."""
    q = coordinates(" ".join(f"x{i}" for i in range(n)) + ",")
    bonds = chain_sum(lambda left, right: (right - left) ** 2 / 2 + (right - left) ** 3 / 12, [0, *q, 0])
    H = row_sum(lambda p: p**2 / 2, [s.momentum for s in q]) + bonds
    start = np.concatenate([np.sin(np.pi * np.arange(1, n + 1) / (n + 1)), np.zeros(n)])
    return Case(f"FPUT {n}", FORCES["FPUT"], H, q, start, 0.05)


def bodies(count: int) -> Case:
    """Equal masses but one, on a helix, attracting each other by Newton's law."""
    masses = (1.0, *[1e-3] * (count - 1))
    q = coordinates(" ".join(f"{c}{i}" for i in range(count) for c in "xyz") + ",")
    exact = [sp.Rational(mass) for mass in masses]

    def potential(a: tuple[sp.Expr, ...], b: tuple[sp.Expr, ...]) -> sp.Expr:
        (*x, m), (*y, M) = a, b
        return -m * M / sp.sqrt(sum((u - v) ** 2 for u, v in zip(x, y, strict=True)))

    H = row_sum(lambda p, m: p**2 / (2 * m), [s.momentum for s in q], [m for m in exact for _ in range(3)])
    H += pair_sum(potential, [(*q[3 * k : 3 * k + 3], mass) for k, mass in enumerate(exact)])
    k = np.arange(count)
    radius, angle = np.where(k > 0, 1.0 + k, 0), 2.4 * k
    positions = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0.01 * k], axis=1)
    speed = np.where(k > 0, 1 / np.sqrt(np.maximum(radius, 1)), 0) * np.array(masses)
    momenta = np.stack([-speed * np.sin(angle), speed * np.cos(angle), 0 * k], axis=1)
    return Case(
        f"{count} bodies",
        FORCES["N-body"],
        H,
        q,
        np.concatenate([positions.ravel(), momenta.ravel()]),
        0.05,
        masses,
    )


def c_function(case: Case, folder: Path, *flags: str) -> ctypes._CFuncPtr | None:
    """Compile the hand-written loop, with further flags where given."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    n = len(case.q)
    source, library = folder / f"{case.name}.c", folder / f"{case.name}{''.join(flags)}.so"
    masses = ", ".join(map(repr, case.masses))
    source.write_text(PROGRAM.format(n=n, bodies=len(case.masses), masses=masses, force=case.force))
    subprocess.run(
        [
            compiler,
            "-O3",
            *flags,
            "-march=native",
            "-fno-math-errno",
            "-shared",
            "-fPIC",
            str(source),
            "-o",
            str(library),
            "-lm",
        ],
        check=True,
    )
    return ctypes.CDLL(str(library)).run


def enough_steps(call) -> int:
    """Steps that take about 30 ms."""
    steps = 64
    while True:
        begun = time.thread_time()
        call(steps)
        if time.thread_time() - begun > 0.03:
            return steps
        steps *= 2


def _aligned(values: np.ndarray) -> np.ndarray:
    """Copy to an address that SIMD registers like: C's time at N = 500 varies by a factor of three otherwise."""
    memory = np.empty(len(values) + 8)
    first = -memory.ctypes.data % 64 // 8
    memory[first : first + len(values)] = values
    return memory[first : first + len(values)]


def measure(case: Case, scheme: str, folder: Path) -> str:
    """One row of the table: the loops and C take turns."""
    c_call = c_caller(case, scheme, folder)
    begun = time.perf_counter()
    system = equations(case.H, case.q, tuple(s.momentum for s in case.q), t, {})
    derived = time.perf_counter() - begun
    coefficients, compiled, calls = coefficients_of(case, scheme), 0.0, {}
    for precision in ("double", "compensated"):
        loop = compiled_loop(system, Splitting(scheme), FIXED[precision])
        compiled = loop.code.seconds

        def call(steps: int, loop: Loop = loop) -> np.ndarray:
            y, e = case.start.copy(), np.zeros(loop.carry)
            loop.code.call(y.ctypes.data, e.ctypes.data, coefficients.ctypes.data, 0, steps, 1)
            return y

        calls[precision] = call
    if c_call is not None:
        calls["C"] = c_call
    steps = {name: enough_steps(call) for name, call in calls.items()}
    times: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(REPEATS):
        for name, call in calls.items():
            begun = time.thread_time()
            call(steps[name])
            times[name].append((time.thread_time() - begun) / steps[name])
    median = {name: statistics.median(found) for name, found in times.items()}
    row = f"{case.name:14} {scheme:12} derived {derived:6.3f} s, compiled {compiled:6.3f} s "
    if c_call is None:
        return row + " ".join(f"{name} {1e9 * value:9.1f} ns" for name, value in median.items())
    ratios = " ".join(f"{name} {median[name] / median['C']:5.2f} × C" for name in ("double", "compensated"))
    agree = abs(c_call(100) - calls["double"](100)).max()
    return row + f"C {1e9 * median['C']:10.1f} ns a step; {ratios}; difference after 100 steps {agree:.1e}"


def ensemble(case: Case, scheme: str, folder: Path) -> str:
    """Time a step of each of 10⁴ orbits side by side on one processor, beside C's step of one orbit.

    And beside that of C without SIMD instructions, a scalar trajectory: along a chain C uses them itself.
    """
    c_call, scalar = c_caller(case, scheme, folder), c_caller(case, scheme, folder, "-fno-tree-vectorize")
    if c_call is None or scalar is None:
        return f"{case.name:14} {scheme:12} no C compiler"
    system = equations(case.H, case.q, tuple(s.momentum for s in case.q), t, {})
    begun = time.process_time()
    calls = {name: _many(system, case, scheme, name) for name in ("double", "compensated", "double-double")}
    spent = time.process_time() - begun
    times: dict[str, list[float]] = {name: [] for name in ("C", "scalar C", *calls)}
    steps = enough_steps(c_call)
    many = max(1, steps // ORBITS + 1)
    for _ in range(REPEATS):
        for name, one in (("C", c_call), ("scalar C", scalar)):
            begun = time.thread_time()
            one(steps)
            times[name].append((time.thread_time() - begun) / steps)
        for name, call in calls.items():
            times[name].append(call(many) / many / ORBITS)
    median = {name: statistics.median(found) for name, found in times.items()}
    ratios = " ".join(
        f"{name} {median[name] / median['C']:6.3f} ({median[name] / median['scalar C']:5.3f})"
        for name in calls
    )
    times_of_c = f"C {1e9 * median['C']:7.1f} (scalar {1e9 * median['scalar C']:7.1f}) ns a step"
    return f"{case.name:14} {scheme:12} {times_of_c}; {ratios} × C (scalar C); compiled in {spent:.2f} s"


def _many(system: HamiltonEquations, case: Case, scheme: str, precision: str) -> Callable[[int], float]:
    """Return what takes steps of 10⁴ equal orbits and tells the processor time."""
    loop = compiled_loop(system, Splitting(scheme), FIXED[precision], ORBITS)
    lanes, pair = loop.number.lanes, 1 + loop.number.pair
    blocks = -(-ORBITS // lanes)
    start = np.zeros((blocks, len(case.start), pair, lanes))
    start[:, :, 0] = case.start[:, np.newaxis]
    exact = coefficients_of(case, scheme)
    coefficients = np.zeros((len(exact), pair, lanes))
    coefficients[:, 0] = exact[:, np.newaxis]

    def call(steps: int) -> float:
        y, e = start.copy(), np.zeros(blocks * loop.carry * pair * lanes)
        begun = time.thread_time()
        loop.code.call(y.ctypes.data, e.ctypes.data, coefficients.ctypes.data, 0, steps, blocks)
        return time.thread_time() - begun

    return call


def coefficients_of(case: Case, scheme: str) -> np.ndarray:
    """Return what the loops read: t0, h, and the drifts and kicks in turn."""
    a, b = ([float(x) * case.step for x in half] for half in (SCHEMES[scheme].a, SCHEMES[scheme].b))
    return np.array([0.0, case.step, *(x for pair in zip(a, b, strict=False) for x in pair), a[-1]])


def c_caller(case: Case, scheme: str, folder: Path, *flags: str) -> Callable[[int], np.ndarray] | None:
    """Return what runs the hand-written loop and returns the state it ends in."""
    c_run, n = c_function(case, folder, *flags), len(case.q)
    if c_run is None:
        return None
    a, b = (np.array([float(x) * case.step for x in half]) for half in (SCHEMES[scheme].a, SCHEMES[scheme].b))

    def call(steps: int) -> np.ndarray:
        q, p = _aligned(case.start[:n]), _aligned(case.start[n:])
        pointers = (ctypes.c_void_p(x.ctypes.data) for x in (q, p, a, b))
        c_run(*pointers, ctypes.c_int(len(b)), ctypes.c_long(steps))
        return np.concatenate([q, p])

    return call


COLD = """
import time
import sympy as sp
import llvmlite.binding, numpy
import canon.flow.task
from canon import Hamiltonian, Splitting, coordinates, propagate
begun = time.process_time()
x, y = coordinates("x y")
H = Hamiltonian((x.momentum**2 + y.momentum**2) / 2 - 1 / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum])
propagate(H, (0, 0.01), [0.4, 0, 0, 2], method=Splitting("kahan-li-8"), step=0.01, samples=1)
print(time.process_time() - begun)
"""


def cold_start() -> float:
    """Return the processor time from a Hamiltonian to its first step in a fresh process, after imports."""
    here = Path(__file__).parent.parent
    done = subprocess.run([sys.executable, "-c", COLD], capture_output=True, text=True, check=True, cwd=here)
    return float(done.stdout)


def over_processes() -> str:
    """Return how a long chain's step differs from process to process: memory lies elsewhere in each."""
    given = [sys.executable, __file__, "--chain"]
    rows = [
        subprocess.run(given, capture_output=True, text=True, check=True).stdout for _ in range(PROCESSES)
    ]
    rows = [row for row in rows if "× C" in row]
    if not rows:
        return "no C compiler"
    c = [float(re.search(r"C +([\d.]+) ns", row)[1]) for row in rows]
    ratios = {
        loop: [float(re.search(rf"{loop} +([\d.]+) × C", row)[1]) for row in rows]
        for loop in ("double", "compensated")
    }
    took = {"C": c} | {
        loop: [mine * one for mine, one in zip(found, c, strict=True)] for loop, found in ratios.items()
    }
    return "\n".join(
        f"FPUT 512, verlet, in {len(rows)} processes: {loop} {min(found):.0f} to {max(found):.0f} ns a step, "
        f"median {statistics.median(found):.0f} ns, {statistics.median(found) / statistics.median(c):.2f} × C"
        for loop, found in took.items()
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--chain", action="store_true", help="FPUT 512 alone")
    parser.add_argument("--large", action="store_true", help="also FPUT 128 … 10,000 and 20 … 1,000 bodies")
    given = parser.parse_args()
    large = given.large
    if given.chain:
        with tempfile.TemporaryDirectory() as folder:
            print(measure(fput(512), "verlet", Path(folder)))
        return
    cases = [kepler(), henon_heiles(), bodies(6), fput(32)]
    if large:
        cases += [fput(128), fput(512), fput(10_000), bodies(20), bodies(50), bodies(1000)]
    with tempfile.TemporaryDirectory() as folder:
        for case in cases:
            for scheme in ("verlet", "kahan-li-8"):
                print(measure(case, scheme, Path(folder)), flush=True)
        print(f"\nper orbit of {ORBITS} side by side on one processor:")
        for case in (kepler(), henon_heiles(), fput(32)):
            for scheme in ("verlet", "kahan-li-8"):
                print(ensemble(case, scheme, Path(folder)), flush=True)
    if large:
        print(f"\n{over_processes()}", flush=True)
    print(f"\nfrom H to the first step in a fresh process, after imports: {cold_start():.3f} s")


if __name__ == "__main__":
    main()
