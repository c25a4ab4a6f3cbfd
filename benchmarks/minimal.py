"""Only what a scene requires: what each question loads and builds, and full models beside reduced ones.

    python benchmarks/minimal.py

Import times are medians of fresh processes. Operations are those of the straight-line program of one right-hand side,
shared ones counted once. Processor times are ratios within one process.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from dataclasses import replace
from typing import TYPE_CHECKING

from canon.kernel.program.program import program
from canon.scene import find
from canon.scene.equations_of_motion import scene_equations
from canon.scene.reduced import reduced
from canon.scene.scene_motion import run

if TYPE_CHECKING:
    from canon.scene.scene import Scene

HEAVY = ("sympy", "flint", "numpy", "scipy", "heyoka", "llvmlite", "matplotlib")
QUESTIONS = {
    "which scenes are there": "names()",
    "the parameters of one": "find('spherical-pendulum').values",
    "its Lagrange's equations": "find('spherical-pendulum').lagrangian.equations",
    "its Hamiltonian": "find('spherical-pendulum').hamiltonian.H",
    "is p_phi conserved": (
        "from canon.scene.known_truths import conserved; s = find('spherical-pendulum'); conserved(s, s.integrals[0])"
    ),
    "its motion": "from canon.scene.scene_motion import run; run(find('spherical-pendulum'), periods=10)",
}
RUNS = 5


def main() -> None:
    loaded()
    print()
    built()
    print()
    ignored()
    print()
    eliminated()
    print()
    observed()


def loaded() -> None:
    """What is imported for a question, and how long the process takes beside an empty one."""
    print(f"{'question':26s} {'process':>9s}  loaded")
    print(f"{'(nothing)':26s} {1e3 * seconds('pass'):6.0f} ms")
    for title, question in QUESTIONS.items():
        code = f"import sys; from canon.scene import find, names; {question}"
        names = [name for name in HEAVY if name in modules(code)]
        print(f"{title:26s} {1e3 * seconds(code):6.0f} ms  {', '.join(names) or '–'}")


def modules(code: str) -> set[str]:
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\nprint(*sys.modules)"], capture_output=True, text=True, check=True
    )
    return {name.split(".")[0] for name in done.stdout.split()}


def seconds(code: str) -> float:
    times: list[float] = []
    for _ in range(RUNS):
        begun = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)
        times.append(time.perf_counter() - begun)
    return statistics.median(times)


def built() -> None:
    """What hangs on a scene after a question: its cached properties, by name."""
    print("built by a question: scene | lagrangian | hamiltonian")
    asked = {
        "values": lambda scene: scene.values,
        "lagrangian.L": lambda scene: scene.lagrangian.L,
        "lagrangian.equations": lambda scene: scene.lagrangian.equations,
        "hamiltonian.H": lambda scene: scene.hamiltonian.H,
        "hamiltonian.q_dot": lambda scene: scene.hamiltonian.q_dot,
        "run, 1 period": lambda scene: run(scene, periods=1.0, samples=2),
    }
    fields = {"q", "p", "symbols", "lagrangian", "hamiltonian", "constrained"}
    for title, question in asked.items():
        scene = replace(find("spherical-pendulum"))
        question(scene)
        on_scene = sorted(fields & set(vars(scene)))
        parts = [", ".join(on_scene) or "nothing"]
        for name in ("lagrangian", "hamiltonian"):
            said = {"L", "q", "t", "forces", "H", "p"}
            parts.append(
                ", ".join(sorted(set(vars(vars(scene).get(name, object))) - said))
                if name in vars(scene)
                else "–"
            )
        print(f"  {title:22s} {' | '.join(part or 'what was said' for part in parts)}")


def ignored() -> None:
    """Full models beside those without their ignorable coordinates."""
    heading("Routh: scene")
    for name, start in (
        ("spherical-pendulum", "precessing"),
        ("lagrange-top", "loops"),
        ("kovalevskaya-top", "tumbling"),
        ("stormer", "bouncing"),
        ("routh-two-degree", "turning"),
    ):
        full = find(name)
        compare(f"{name}", full, start, reduced(full, start))


def eliminated() -> None:
    """Constraints with multipliers beside coordinates that satisfy them."""
    heading("multipliers: scene")
    pairs = {
        "pendulum-multiplier": "simple-pendulum",
        "roller": "roller-second-kind",
        "piston-engine-joints": "piston-engine",
    }
    for full, less in pairs.items():
        compare(full, find(full), find(full).starts[0].name, find(less))


def heading(first: str) -> None:
    print(
        f"{first:26s} {'variables':>12s} {'operations':>14s} {'processor time':>15s} {'drift of energy':>22s}"
    )


def compare(title: str, full: Scene, start: str, less: Scene) -> None:
    before, after = figures(full, start), figures(less, None)
    columns = [
        f"{before[0]:4d} → {after[0]:d}",
        f"{before[1]:5d} → {after[1]:d}",
        f"{after[2] / before[2]:.2f} ×",
        f"{before[3]:.1e} → {after[3]:.1e}",
    ]
    print(f"{title:26s} {columns[0]:>12s} {columns[1]:>14s} {columns[2]:>15s} {columns[3]:>22s}")


def figures(scene: Scene, start: str | None) -> tuple[int, int, float, float]:
    """Return variables, operations of a right-hand side, processor time and drift over 1000 periods."""
    from canon.scene.known_truths import integrals_along

    equation = scene_equations(scene)
    field = equation.field
    made = program(field.graph, field.rates, (*field.x, field.t))
    operations = sum(each.operation not in ("input", "constant") for each in made.instructions)
    run(scene, start, 1.0, 1)
    begun = time.process_time()
    motion = run(scene, start, min(1000.0, scene.horizon), 1009)
    spent = time.process_time() - begun
    return len(field.x), operations, spent, integrals_along(motion)[0].error


def observed() -> None:
    """Observables that are not asked for cost nothing: operations of the rates alone, and with what is known."""
    print(f"{'observables: scene':26s} {'rates':>8s} {'with energy and integrals':>27s}")
    for name in ("kepler", "kovalevskaya-top", "toda-6", "outer-solar-system", "rolling-disc"):
        scene = find(name)
        equation = scene_equations(scene)
        field = equation.field
        extra = [equation.energy, *(equation.node(f, title) for title, f in scene.constants().items())]
        counts = [
            sum(
                each.operation not in ("input", "constant")
                for each in program(field.graph, nodes, (*field.x, field.t)).instructions
            )
            for nodes in (field.rates, (*field.rates, *extra))
        ]
        print(f"{name:26s} {counts[0]:8d} {counts[1]:27d}")


if __name__ == "__main__":
    main()
