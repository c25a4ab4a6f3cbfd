"""RATTLE on the double pendulum in Cartesian coordinates, beside a C program: time of a step, errors over 10⁸ steps.

Run ``python benchmarks/constraints.py``; ``--long`` takes 10⁸ steps in place of 10⁶. Where there is no C compiler only
canon's own times are printed.
"""

from __future__ import annotations

import ctypes
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from canon import ConstrainedLagrangian, Lagrangian, coordinates, propagate
from canon.flow import Rattle

REPEATS, STEPS, STEP = 7, 400_000, 0.01
START = [1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]
UNIT = 2.0**-53

PROGRAM = """
#include <math.h>
/* two unit masses on unit rods, weight 1; the constraints x0² + y0² = 1 and (x1 − x0)² + (y1 − y0)² = 1 */
static inline void rows(const double *q, double *g, double G[2][4]) {
    double x = q[2] - q[0], y = q[3] - q[1];
    g[0] = q[0]*q[0] + q[1]*q[1] - 1.0; g[1] = x*x + y*y - 1.0;
    G[0][0] = 2*q[0]; G[0][1] = 2*q[1]; G[0][2] = 0; G[0][3] = 0;
    G[1][0] = -2*x; G[1][1] = -2*y; G[1][2] = 2*x; G[1][3] = 2*y;
}
static inline void solve(double A[2][2], const double *r, double *s) {
    double d = 1.0/(A[0][0]*A[1][1] - A[0][1]*A[1][0]);
    s[0] = d*(A[1][1]*r[0] - A[0][1]*r[1]); s[1] = d*(A[0][0]*r[1] - A[1][0]*r[0]);
}
static inline void metric(double G[2][4], double H[2][4], double A[2][2]) {
    for (int a = 0; a < 2; a++) for (int b = 0; b < 2; b++) {
        A[a][b] = 0; for (int i = 0; i < 4; i++) A[a][b] += G[a][i]*H[b][i];
    }
}
void run(double *q, double *v, double h, long steps) {
    double l[2] = {0, 0}, G0[2][4], G1[2][4], g[2], A[2][2], s[2], r[2], u[4], p[4];
    static const double f[4] = {0, -1, 0, -1};
    rows(q, g, G0);
    for (long n = 0; n < steps; n++) {
        double worst = 1;
        for (int k = 0; k < 50; k++) {
            for (int i = 0; i < 4; i++) {
                u[i] = v[i] + 0.5*h*(f[i] + G0[0][i]*l[0] + G0[1][i]*l[1]); p[i] = q[i] + h*u[i];
            }
            if (worst < 1e-9) break;
            rows(p, g, G1); metric(G1, G0, A); solve(A, g, s);
            for (int a = 0; a < 2; a++) l[a] -= s[a]/(0.5*h*h);
            worst = fmax(fabs(g[0]), fabs(g[1]));
        }
        rows(p, g, G1); metric(G1, G1, A);
        for (int i = 0; i < 4; i++) { q[i] = p[i]; u[i] += 0.5*h*f[i]; }
        for (int a = 0; a < 2; a++) { r[a] = 0; for (int i = 0; i < 4; i++) r[a] += G1[a][i]*u[i]; }
        solve(A, r, s);
        for (int i = 0; i < 4; i++) v[i] = u[i] - G1[0][i]*s[0] - G1[1][i]*s[1];
        for (int a = 0; a < 2; a++) { l[a] = -s[a]/(0.5*h); for (int i = 0; i < 4; i++) G0[a][i] = G1[a][i]; }
    }
}
"""


def double_pendulum() -> ConstrainedLagrangian:
    x, y, u, w = coordinates("x y u w")
    kinetic = sum(s.dot**2 for s in (x, y, u, w)) / 2
    return ConstrainedLagrangian(
        Lagrangian(kinetic - y - w, [x, y, u, w]),
        holonomic=[x**2 + y**2 - 1, (u - x) ** 2 + (w - y) ** 2 - 1],
    )


def c_program(folder: Path) -> ctypes.CDLL | None:
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    source, library = folder / "rattle.c", folder / "rattle.so"
    source.write_text(PROGRAM, encoding="utf-8")
    flags = ["-O3", "-march=native", "-shared", "-fPIC"]
    subprocess.run([compiler, *flags, str(source), "-o", str(library), "-lm"], check=True)
    return ctypes.CDLL(str(library))


def c_seconds(library: ctypes.CDLL) -> tuple[float, np.ndarray]:
    state = np.array(START)
    pointers = [ctypes.c_void_p(state[part:].ctypes.data) for part in (0, 4)]
    begun = time.thread_time()
    library.run(*pointers, ctypes.c_double(STEP), ctypes.c_long(STEPS))
    return time.thread_time() - begun, state


def canon_seconds(precision: str) -> tuple[float, np.ndarray]:
    motion = propagate(
        double_pendulum(),
        (0, STEPS * STEP),
        START,
        method=Rattle(2),
        step=STEP,
        samples=1,
        precision=precision,
    )
    return motion.cpu_seconds, motion.final


def beside_c() -> None:
    precisions = ("double", "compensated")
    with tempfile.TemporaryDirectory() as folder:
        library = c_program(Path(folder))
        times: dict[str, list[float]] = {name: [] for name in ("C", *precisions)}
        for _ in range(REPEATS):
            for name in precisions:
                times[name].append(canon_seconds(name)[0])
            if library is not None:
                times["C"].append(c_seconds(library)[0])
    print(
        f"double pendulum in Cartesian coordinates, RATTLE of order 2, {STEPS} steps of {STEP}, {REPEATS} runs"
    )
    for name in precisions:
        each = statistics.median(times[name])
        ratio = f"{each / statistics.median(times['C']):7.2f} × C" if library is not None else ""
        print(f"  canon, {name:12} {each / STEPS * 1e9:7.1f} ns a step {ratio}")
    if library is None:
        print("  no C compiler here: no comparison")
    else:
        print(f"  C, gcc -O3         {statistics.median(times['C']) / STEPS * 1e9:7.1f} ns a step")


def errors(steps: int) -> None:
    """Print residuals in parts of the sizes of the terms, and the energy error, early and late."""
    system = double_pendulum()
    for order, step in ((2, 0.01), (4, 0.02), (6, 0.05)):
        motion = propagate(system, (0, steps * step), START, method=Rattle(order), step=step, samples=2000)
        error = abs(motion.energy_error)
        positions, rates = relative_residuals(motion)
        print(
            f"  order {order}, {motion.steps:.0e} steps of {step}: constraints {positions:.1f} u, rates {rates:.1f} u, "
            f"|ΔE/E| {error[1:101].max():.1e} early, {error[-100:].max():.1e} late, {motion.cpu_seconds:.0f} s"
        )


def relative_residuals(motion: object) -> tuple[float, float]:
    """Return the largest residuals of g and of its rate in rounding units of the usual Σ |G q| and Σ |G v|."""
    q, v, found = motion.q, motion.v, motion.residuals
    x, y = q[2] - q[0], q[3] - q[1]
    rows = [[2 * q[0], 2 * q[1], 0 * x, 0 * x], [-2 * x, -2 * y, 2 * x, 2 * y]]
    sizes = [sum(abs(a * b) for a, b in zip(row, part, strict=True)) for part in (q, v) for row in rows]
    parts = [float(abs(r).max() / np.median(size) / UNIT) for r, size in zip(found, sizes, strict=True)]
    return max(parts[:2]), max(parts[2:])


def main() -> None:
    beside_c()
    errors(10**8 if "--long" in sys.argv else 10**6)


if __name__ == "__main__":
    main()
