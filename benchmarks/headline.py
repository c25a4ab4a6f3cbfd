"""The outer solar system for 10⁶ years, Kepler's ellipse for 10⁷ periods: who keeps the energy, at what cost?

``python benchmarks/headline.py`` prints the stored table and draws docs/figures/headline.png from the stored runs;
``--run`` computes them anew (about a quarter of an hour of processor time), ``--run kepler`` or ``--run planets`` one
of the two, ``--case "canon: Gauss"`` the methods whose names begin so; ``--places`` only how far from its place each
method puts the body after 1000 turns of the ellipse (half a minute).
Methods too dear for the whole span stop earlier; what they would reach is extrapolated by the law their error
follows (t for a drift, √t for round-off, constant for an error that is bounded) and marked as such.
"""

from __future__ import annotations

import argparse
import itertools
import json
import platform
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from datetime import date
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from canon import DOP853, RK4, SABA, Gauss, Splitting, Taylor, TimeTransformed, WisdomHolman, propagate
from canon.scene import find

STORED = Path(__file__).parent / "results" / "headline.json"
FIGURE = Path(__file__).parent.parent / "docs" / "figures" / "headline.png"
INSTANTS = 240


@dataclass(frozen=True)
class Case:
    """A method, its steps a period (fixed steps), for how many periods, and its law.

    A whole number of steps a period is in resonance with the motion: the steps come to lie at the same places for
    thousands of periods, and errors that would average out add up.
    """

    name: str
    method: Any
    steps: float | None
    periods: float
    law: float
    """Exponent by which the error grows: what is extrapolated with."""


KEPLER = (
    Case("canon: Kepler flow, 2.3 steps a period", WisdomHolman(), 2.3, 1e7, 0.5),
    Case("canon: Verlet, logarithmic H, 20 steps", TimeTransformed(Splitting("verlet")), 20, 1e7, 0.5),
    Case("canon: Gauss 8, 40.3 steps", Gauss(8), 40.3, 1e7, 0.5),
    Case("canon: Gauss 8, exactly 40 steps: resonance", Gauss(8), 40, 1e7, 0.5),
    Case("canon: Sofroniou–Spaletta 10, 250.3 steps", Splitting("sofroniou-spaletta-10"), 250.3, 3e5, 0.5),
    Case("heyoka: Taylor", Taylor(), None, 1e7, 0.5),
    Case("Verlet, 250.3 steps", Splitting("verlet"), 250.3, 1e7, 0.0),
    Case("RK4, 250.3 steps", RK4(), 250.3, 1e7, 1.0),
    Case("SciPy: DOP853, 1e-12", DOP853(1e-12), None, 3e3, 1.0),
)
YEARS = 1e6
PLANETS = (
    Case("canon: SABA(10,6,4), 16.3 steps a period", SABA("10-6-4"), 16.3, YEARS, 0.5),
    Case("canon: Wisdom–Holman, corrector 17, 40.3 steps", WisdomHolman(corrector=17), 40.3, YEARS, 0.0),
    Case("canon: Kahan–Li 8, 100.3 steps", Splitting("kahan-li-8"), 100.3, YEARS, 0.5),
    Case("heyoka: Taylor", Taylor(), None, YEARS, 0.5),
    Case("Verlet, 100.3 steps", Splitting("verlet"), 100.3, YEARS, 0.0),
    Case("RK4, 100.3 steps", RK4(), 100.3, YEARS, 1.0),
    Case("SciPy: DOP853, 1e-12", DOP853(1e-12), None, YEARS / 50, 1.0),
)
DAYS_A_YEAR = 365.25
TURNS = 1000
"""After so many whole periods of the ellipse the body is exactly where it began."""


@dataclass(frozen=True)
class Problem:
    """A scene, its methods, and how times are told."""

    title: str
    scene: str
    cases: tuple[Case, ...]
    unit: str
    span: float

    def spans(self) -> tuple[float, float]:
        """Return the unit in the scene's time, and the period."""
        scene = find(self.scene)
        period = scene.time_scale(scene.values)
        return (DAYS_A_YEAR, period) if self.unit == "years" else (period, period)


PROBLEMS = {
    "kepler": Problem("Kepler’s ellipse, e = 0.6", "kepler", KEPLER, "periods", 1e7),
    "planets": Problem("Outer solar system", "outer-solar-system", PLANETS, "years", YEARS),
}


def run(problem: Problem, case: Case) -> dict[str, Any]:
    """Carry one case out."""
    unit, _ = problem.spans()
    end = case.periods * unit
    if isinstance(case.method, TimeTransformed):
        motion = motion_of(problem, case, end, samples=4000)
    else:
        motion = motion_of(problem, case, end, times=np.geomspace(unit, end, INSTANTS + 1)[:-1])
    t = motion.t[1:] / unit
    error = np.maximum.accumulate(abs(motion.energy_error[1:]))
    chosen = np.unique(np.searchsorted(t, np.geomspace(t[0], t[-1], 120)).clip(0, len(t) - 1))
    return {
        "name": case.name, "law": case.law, "steps": motion.steps, "cpu": motion.cpu_seconds, "span": case.periods,
        "t": [float(f"{x:.4g}") for x in t[chosen]], "error": [float(f"{x:.3g}") for x in error[chosen]],
    }  # fmt: skip


def motion_of(problem: Problem, case: Case, end: float, **sampled: Any) -> Any:
    """Return the motion by one method from the scene's start."""
    scene = find(problem.scene)
    _, period = problem.spans()
    if case.steps:
        # The step of a transformed time is that at the start, the pericentre, (1 − e) times the mean.
        first = 0.4 if isinstance(case.method, TimeTransformed) else 1.0
        sampled |= {"step": period / case.steps * first, "precision": "compensated"}
    return propagate(
        scene.hamiltonian,
        (0.0, end),
        scene.state(),
        method=case.method,
        parameters=scene.values,
        **sampled,
    )


def lost_place(case: Case) -> float:
    """Return how far from the exact place, in semi-major axes, the body is after whole turns of the ellipse.

    A method may keep the energy, and so the ellipse, and yet be late along it; two semi-major axes are the most that
    can be lost on the ellipse itself.
    """
    problem = PROBLEMS["kepler"]
    _, period = problem.spans()
    motion = motion_of(problem, case, TURNS * period, times=[TURNS * period])
    start = np.array(find(problem.scene).state())
    return float(np.linalg.norm((motion.y[:, -1] - start)[: len(start) // 2]))


def table(problem: Problem, rows: list[dict[str, Any]]) -> list[str]:
    """Say what each method reached, and what the whole span costs or would cost."""
    lines = [
        f"{problem.title}, {problem.span:.0e} {problem.unit}",
        f"    {'':46} {'run':>8} {'max |dE/E|':>10} {'CPU s':>7}   whole span: {'error':>8} {'CPU s':>8}"
        + (f"   place after {TURNS} turns" if any("place" in row for row in rows) else ""),
    ]
    for row in rows:
        part = problem.span / row["span"]
        reached = row["error"][-1]
        whole = f"{reached * part ** row['law']:8.0e} {row['cpu'] * part:8.0f}"
        place = f"{row['place']:13.1e}" if "place" in row else ""
        mark = "  extrapolated" if part > 1 else ""
        run = f"    {row['name']:46} {row['span']:8.0e} {reached:10.1e} {row['cpu']:7.1f}"
        lines.append(f"{run} {'':13} {whole} {place}{mark}".rstrip())
    return lines


def draw(stored: dict[str, Any]) -> None:
    """Draw the figure: solid what was run, dashed what is extrapolated."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(12, 5.2), sharey=True, layout="constrained")
    for ax, (name, problem) in zip(axes, PROBLEMS.items(), strict=True):
        rows = stored.get(name, [])
        for row, colour in zip(rows, plt.get_cmap("tab10").colors, strict=False):
            t, error = np.array(row["t"]), np.maximum(row["error"], 1e-17)
            whole_cpu = row["cpu"] * problem.span / row["span"]
            ax.loglog(t, error, color=colour, label=f"{row['name']} ({_seconds(whole_cpu)})", lw=1.8)
            if row["span"] < problem.span:
                end = error[-1] * (problem.span / t[-1]) ** row["law"]
                ax.loglog([t[-1], problem.span], [error[-1], end], color=colour, ls=":", lw=1.4)
        guide = np.array([1e2, problem.span])
        ax.loglog(guide, 6e-18 * np.sqrt(guide), color="0.6", lw=1)
        ax.annotate("√t", (guide[1], 6e-18 * np.sqrt(guide[1])), color="0.4", ha="right", va="top")
        ax.set(title=problem.title, xlabel=f"time, {problem.unit}", ylim=(3e-17, 1e9))
        ax.grid(visible=True, which="major", alpha=0.3)
        ax.legend(
            fontsize=7.5, loc="upper left", title="method (CPU time of the whole span)", title_fontsize=7.5
        )
    axes[0].set_ylabel("largest |ΔE/E| so far")
    figure.savefig(FIGURE, dpi=130)


def _seconds(seconds: float) -> str:
    if seconds < 600:
        return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"
    return f"{seconds / 3600:.2g} h"


def main() -> None:
    """Print the table and draw the figure."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--run", action="store_true")
    parser.add_argument("--places", action="store_true")
    parser.add_argument(
        "--case", default="", help="only methods whose names begin so; the others stay as they are"
    )
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("problems", nargs="*", help=f"of {', '.join(PROBLEMS)}")
    given = parser.parse_args()
    if given.run:
        for name in given.problems or PROBLEMS:
            problem = PROBLEMS[name]
            stored = json.loads(STORED.read_text(encoding="utf-8")) if STORED.exists() else {}
            found = {row["name"]: row for row in stored.get(name, []) if given.case}
            asked = [case for case in problem.cases if case.name.startswith(given.case)]
            with ProcessPoolExecutor(given.processes) as pool:
                for row in pool.map(run, itertools.repeat(problem), asked):
                    found[row["name"]] = row
                    print(table(problem, [row])[-1], flush=True)
            rows = [found[case.name] for case in problem.cases if case.name in found]
            tools = ", ".join(f"{tool} {version(tool)}" for tool in ("numpy", "scipy", "llvmlite", "heyoka"))
            where = f"{date.today()}, {platform.machine()}, Python {platform.python_version()}, {tools}"
            whole = stored.get(f"{name} run", "")
            stored |= {
                name: rows,
                f"{name} run": f"{whole}; {given.case}: {where}" if given.case else where,
            }
            STORED.parent.mkdir(exist_ok=True)
            STORED.write_text(json.dumps(stored, ensure_ascii=False, indent=1), encoding="utf-8")
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    if given.places or (given.run and "kepler" in (given.problems or PROBLEMS)):
        cases = {case.name: case for case in KEPLER}
        stored["kepler"] = [row | {"place": lost_place(cases[row["name"]])} for row in stored["kepler"]]
        STORED.write_text(json.dumps(stored, ensure_ascii=False, indent=1), encoding="utf-8")
    lines = list[str]()
    for name, problem in PROBLEMS.items():
        if name in stored:
            lines += [stored[f"{name} run"], *table(problem, stored[name])]
    print(*lines, sep="\n")
    STORED.with_suffix(".txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    draw(stored)


if __name__ == "__main__":
    main()
