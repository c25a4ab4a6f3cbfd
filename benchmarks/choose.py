"""Whether `choose` keeps its promises: error kept, cost as predicted, and near the best of an exhaustive search.

``python -m benchmarks.choose`` prints the stored table; ``--run`` computes it anew (a quarter of an hour of processor
time), ``--run PART`` the scenes whose names hold a text.

Every case is a scene, a start, a span in periods, an observable and an accuracy. The chosen setting is run over the
whole span: its cost (least of three runs without samples) and its largest error (followed at every step). The
exhaustive search runs every method of the candidates in doubles and in compensated doubles over the whole span too, on
a grid of steps of ratio 2^(1/4) and of tolerances of ratio 4, beginning with the largest; it leaves out what can only
cost more than the best already found. Times are processor times, without compilation.
"""

from __future__ import annotations

import argparse
import math
import os
import platform
import sys
import time
from dataclasses import dataclass, replace
from datetime import date
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).parent.parent))

from canon.flow.method.method import Splitting, Stepped, TimeTransformed
from canon.flow.method.setting import Setting
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.scene import find
from canon.study.method_choice.candidate import candidate_methods
from canon.study.method_choice.choose import Choice, choose
from canon.study.method_choice.pilot_run import Pilot, natural_step, pilot
from canon.study.method_choice.step_search import widest_step

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.study.method_choice.choice_question import Question

STORED = Path(__file__).parent / "results" / "choose.txt"

CASES: tuple[tuple[str, str | None, str, float, tuple[float, ...]], ...] = (
    ("simple-pendulum", "small", "energy", 3e3, (1e-4, 1e-8, 1e-11)),
    ("simple-pendulum", "wide", "energy", 3e3, (1e-6, 1e-10)),
    ("spring-pendulum", None, "energy", 3e3, (1e-4, 1e-7, 1e-10)),
    ("spherical-pendulum", None, "energy", 2e3, (1e-6, 1e-10)),
    ("sliding-mass-pendulum", None, "energy", 2e3, (1e-5, 1e-9)),
    ("double-pendulum", None, "energy", 1e3, (1e-4, 1e-7, 1e-10)),
    ("double-pendulum-rods", None, "energy", 1e3, (1e-6, 1e-9)),
    ("harmonic-oscillator", None, "energy", 3e4, (1e-3, 1e-6, 1e-9)),
    ("isotropic-oscillator", None, "energy", 2e4, (1e-5,)),
    ("duffing-oscillator", None, "energy", 1e4, (1e-4, 1e-7, 1e-10)),
    ("kepler", "e=0.0167", "energy", 1e4, (1e-4, 1e-8, 1e-11)),
    ("kepler", "e=0.6", "energy", 5e3, (1e-3, 1e-6, 1e-9, 1e-12)),
    ("kepler", "e=0.6", "energy", 1e2, (1e-5, 1e-10)),
    ("kepler", "e=0.9", "energy", 2e3, (1e-4, 1e-8)),
    ("kepler", "e=0.6", "angular momentum", 3e3, (1e-9,)),
    ("kepler", "e=0.6", "Runge–Lenz vector, x", 1e3, (1e-4, 1e-7)),
    ("kepler", "e=0.6", "position", 3e2, (1e-3, 1e-6)),
    ("figure-eight", None, "energy", 3e3, (1e-4, 1e-8, 1e-11)),
    ("outer-solar-system", None, "energy", 3e3, (1e-4, 1e-7, 1e-10)),
    ("outer-solar-system", None, "position", 2e2, (1e-4, 1e-7)),
    ("henon-heiles", "regular", "energy", 1e4, (1e-3, 1e-6, 1e-9, 1e-12)),
    ("henon-heiles", "regular", "energy", 1e5, (1e-4, 1e-8)),
    ("henon-heiles", "chaotic", "energy", 1e4, (1e-4, 1e-8)),
    ("henon-heiles", "regular", "position", 1e3, (1e-4, 1e-8)),
    ("toda", "moderate", "energy", 1e4, (1e-4, 1e-7, 1e-10)),
    ("toda", "wild", "energy", 3e3, (1e-5, 1e-9)),
    ("toda", "moderate", "cubic integral", 3e3, (1e-4, 1e-8)),
    ("fput", None, "energy", 2e2, (1e-4, 1e-7, 1e-10)),
    ("routh-two-degree", None, "energy", 1e4, (1e-5, 1e-9)),
    ("harmonic-oscillator", None, "position", 1e4, (1e-3, 1e-6)),
    ("henon-heiles", "chaotic", "position", 1e4, (1e-6,)),
)
"""Scene, start, observable, periods, accuracies."""

WINDOWS = 8
"""Windows in which the error is followed over the whole span."""

RATIO = 2.0**0.25
"""Ratio of neighbouring steps of the exhaustive search."""


@dataclass(frozen=True)
class Outcome:
    """What a choice promised, what it did, and the least cost at which the accuracy can be kept."""

    scene: str
    accuracy: float
    choice: Choice
    error: float
    cost: float
    best_cost: float
    best: str
    seconds: float

    @property
    def kept(self) -> bool:
        return self.error <= self.accuracy if self.choice.reached else math.isinf(self.best_cost)


def measured_cost(question: Question, setting: Setting, repeats: int = 3) -> float:
    """Return the least processor time of runs over the whole span without samples; infinity where one fails."""
    try:
        return min(question.run(setting, question.span, 1).cpu_seconds for _ in range(repeats))
    except (NonFiniteStateError, ArithmeticError, ValueError):
        return math.inf


def dear(question: Question, setting: Setting, limit: float) -> bool:
    """Tell whether a hundredth of the span alone shows that a setting costs over twice the limit."""
    try:
        return question.run(setting, question.span / 100.0, 1).cpu_seconds > 0.02 * limit
    except (NonFiniteStateError, ArithmeticError, ValueError):
        return False


def unresolved(run: Pilot, natural: float) -> bool:
    """Tell whether a method in a fictitious time takes steps too long to show the motion, whatever its energy does."""
    method = run.setting.method
    return isinstance(method, TimeTransformed) and run.steps * widest_step(method, natural) < run.span


def settings(method: object, natural: float) -> Iterator[Setting]:
    """Yield settings of a method, dearer and dearer."""
    if isinstance(method, Stepped):
        step = 6.0 * natural if isinstance(method, Splitting) else 12.0 * natural
        for k in range(80):
            yield Setting(method, step=step / RATIO**k, precision="double")
    else:
        for k in range(26):
            yield Setting(method, tolerance=4.0**-k * 1e-2, precision="double")


def exhaustive(
    question: Question, natural: float, seeds: dict[float, tuple[float, str]]
) -> dict[float, tuple[float, str]]:
    """Return the least cost at which each accuracy is kept, and how; ``seeds`` are settings known to keep it."""
    best = dict(seeds)
    for method in candidate_methods(question):
        wanted = set(best)
        for setting in settings(method, natural):
            dearest = max((best[each][0] for each in wanted), default=0.0)
            if dear(question, setting, dearest):
                break
            kept: set[float] = set()
            for precision in ("double", "compensated") if setting.step is not None else ("double",):
                tried = replace(setting, precision=precision)
                cost = measured_cost(question, tried, 2)
                if cost > dearest:
                    continue
                run = pilot(question, tried, question.span, WINDOWS)
                error = math.inf if unresolved(run, natural) else run.bound
                for each in (each for each in wanted - kept if error <= each):
                    kept.add(each)
                    if cost < best[each][0]:
                        best[each] = cost, f"{method} {setting.knob:.3g} {precision}"
            wanted -= kept
            if not wanted:
                break
    return best


def outcomes(
    scene_name: str, start: str | None, observable: str, periods: float, accuracies: tuple[float, ...]
):
    scene = find(scene_name)
    span = periods * scene.period
    chosen: list[tuple[float, Choice, float, float, float]] = []
    for accuracy in accuracies:
        before = time.process_time()
        choice = choose(scene, span, start, accuracy=accuracy, observable=observable)
        took = time.process_time() - before
        error = cost = math.inf
        if choice.reached:
            cost = measured_cost(choice.question, choice.chosen.setting)
            error = pilot(choice.question, choice.chosen.setting, span).bound
        chosen.append((accuracy, choice, error, cost, took))
    question = chosen[0][1].question
    seeds = {
        accuracy: (cost, "as chosen") if error <= accuracy else (math.inf, "nothing")
        for accuracy, _, error, cost, _ in chosen
    }
    if observable == "position" and not any(choice.reached for _, choice, *_ in chosen):
        best = seeds  # no reference either: neighbouring motions part
    else:
        best = exhaustive(question, natural_step(question), seeds)
    for accuracy, choice, error, cost, took in chosen:
        yield Outcome(scene_name, accuracy, choice, error, cost, *best[accuracy], took)


def line(found: Outcome, periods: float) -> str:
    choice = found.choice
    name = f"{found.scene} {periods:.0e} {choice.observable[:14]}"
    if not choice.reached:
        best = f"{choice.predicted_error:.0e}"
        return f"{name:46s} {found.accuracy:.0e}  nothing keeps it; best {best}  (search: {found.best})"
    method = str(choice.method).partition("(")[0] if choice.tolerance else str(choice.method)
    marks = [
        "" if found.kept else "LOST",
        "" if within(found, 2.0) else "COST",
        "" if near(found) else "DEAR",
    ]
    cells = [
        f"{name:46s} {found.accuracy:.0e}",
        f"{method} {choice.chosen.setting.knob:.3g}".ljust(29),
        choice.precision[:4],
        f"{choice.predicted_error:7.1e} {found.error:7.1e}",
        f"{1e3 * choice.predicted_cost:8.2f} {1e3 * found.cost:8.2f}",
        f"{found.cost / found.best_cost:5.2f}",
        f"{found.best:30s} {found.seconds:4.1f}",
    ]
    return "  ".join([*cells, *filter(None, marks)])


def within(found: Outcome, factor: float) -> bool:
    return not found.choice.reached or 1.0 / factor <= found.choice.predicted_cost / found.cost <= factor


def near(found: Outcome) -> bool:
    return not found.choice.reached or not found.kept or found.cost <= 1.5 * found.best_cost


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--run", nargs="?", const="", metavar="PART")
    part = parser.parse_args().run
    if part is None:
        print(STORED.read_text(encoding="utf-8"), end="")
        return
    started = time.process_time()
    tools = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "sympy", "llvmlite", "heyoka"))
    here = f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}"
    print(f"{date.today()}, {here}, {tools}\n")
    print(
        "error and cost: predicted, measured; cost in ms; measured over the best of the search; s it took to choose"
    )
    found: list[Outcome] = []
    for scene, start, observable, periods, accuracies in CASES:
        if part in scene:
            for each in outcomes(scene, start, observable, periods, accuracies):
                found.append(each)
                print(line(each, periods), flush=True)
    reached = [each for each in found if each.choice.reached]
    ratios = sorted(each.choice.predicted_cost / each.cost for each in reached)
    over = sorted(each.cost / each.best_cost for each in reached if each.kept)
    print(f"\n{len(found)} cases, {len(reached)} of them with a choice")
    print(
        f"accuracy kept (or rightly called out of reach): {sum(each.kept for each in found)} of {len(found)}"
    )
    print(
        f"cost within a factor of 2 of what was predicted: {sum(within(each, 2.0) for each in reached)} "
        f"of {len(reached)}; "
        f"predicted / measured from {ratios[0]:.2f} to {ratios[-1]:.2f}, median {ratios[len(ratios) // 2]:.2f}"
    )
    print(
        f"cost within 1.5 times the best of the search: {sum(near(each) for each in reached)} of {len(reached)}; "
        f"median {over[len(over) // 2]:.2f}, 95 % below {over[int(0.95 * len(over))]:.2f}, largest {over[-1]:.2f}"
    )
    choosing = sum(each.seconds for each in found)
    print(f"processor time: {time.process_time() - started:.0f} s, of which choosing {choosing:.0f} s")


if __name__ == "__main__":
    main()
