"""Run the benchmarks and write what they print into docs/measured.md.

python benchmarks/record.py              # every benchmark below
python benchmarks/record.py zero_test    # this one anew, the others as they stand
python benchmarks/record.py --page       # nothing is run: what was recorded is laid out anew

Under each section stands the day on which it was measured. Results that a script keeps and prints name their own.
"""

from __future__ import annotations

import platform
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

from days import days_in, today
from measured_page import section_of

HERE = Path(__file__).parent
PAGE = HERE.parent / "docs" / "measured.md"
BENCHMARKS = {
    "import_cost": "What `import canon` costs",
    "zero_test": "The zero test on its corpus of identities",
    "canonical": "Canonical maps and generating functions",
    "normal_forms": "Normal forms, and the centre manifold between Earth and Moon",
    "derivation": "Equations of motion, beside SymPy's LagrangesMethod and KanesMethod",
    "operations": "Operations of a pendulum's equations, by four designs",
    "minimal": "Only what is asked for",
    "classroom": "A class of two hundred",
    "feedback": "Wrong answers whose slip is known",
    "growth": "How the time grows: sites, bodies, links, claims, cases, samples, orbits",
    "sections": "Poincaré sections of ensembles",
    "kernels": "Compiled loops, beside a C program",
    "roofline": "Compiled loops, beside what the processor can do",
    "waiting": "How long one waits at a cold shell",
    "preparation": "What a motion costs beside its steps",
    "constraints": "Constraints kept by RATTLE, beside a C program",
    "nonholonomic": "Constraints on velocities kept by the nonholonomic leapfrog",
    "rotations": "Rotating bodies and charges, by methods of their own",
    "brouwer": "Energy error over 10⁹ steps: Brouwer's law",
    "headline": "A million years of planets, ten million periods of Kepler's ellipse",
    "peers": "Work at a wanted accuracy, beside other libraries",
    "peers_ensembles": "Ten thousand orbits, beside other libraries",
    "peers_losing": "Stiff, large and with close encounters, beside other libraries",
    "planets": "The planets, by methods for small perturbations",
    "scale_out": "Studies on two processes, orbits on two cores",
    "drift_calibration": "The drift statistics on series of known growth",
    "robustness": "Attacks, counted",
    "mutation": "Mutants of canon that its tests kill",
    "tested_lines": "Lines and branches that the tests run",
    "chaos": "What deviations cost, a map of MEGNO, and verdicts on orbits that are known",
    "choose": "What `choose` foretells, beside what came of it",
}
ARGUMENTS = {
    "kernels": ["--large"],
    "normal_forms": ["--large"],
    "operations": ["--peer", "20"],
    "drift_calibration": ["200"],
    "mutation": ["--count", "520", "--seed", "1"],
    "tested_lines": ["--kept"],
}
HEAD = """\
# What was measured

Written by `benchmarks/record.py`, which runs the scripts named below and reads tables and plots from what they print.
Times on shared machines wander; ratios within one run are what counts.
"""
RECORDED = re.compile(
    r"^(`python benchmarks/[^\n]*(?:\n[^\n`#|<]+)?)\n\n.*?```text\n(.*?)\n```", re.MULTILINE | re.DOTALL
)
"""What ran and what it printed, in a section of the page."""


def section(name: str) -> str:
    done = subprocess.run(
        [sys.executable, str(HERE / f"{name}.py"), *ARGUMENTS.get(name, [])],
        capture_output=True,
        text=True,
        cwd=HERE.parent,
        check=False,
    )
    printed = done.stdout.rstrip()
    if done.returncode:
        sys.exit(f"benchmarks/{name}.py ended with status {done.returncode}:\n{done.stderr}")
    command = " ".join([f"{name}.py", *ARGUMENTS.get(name, [])])
    ran = f"`python benchmarks/{command}` ({stamp(printed)})"
    return section_of(name).page(BENCHMARKS[name], ran, printed, name)


def stamp(printed: str) -> str:
    """Return when and with what a benchmark ran; of a stored result, the days that its output names."""
    stored = days_in(printed)
    if stored:
        return f"measured on {stored}"
    tools = ", ".join(f"{name} {version(name)}" for name in ("sympy", "python-flint", "llvmlite", "heyoka"))
    return f"{today()}, {platform.machine()}, Python {platform.python_version()}, {tools}"


def laid_out_anew(found: dict[str, str]) -> None:
    for name, title in BENCHMARKS.items():
        block = found.get(f"## {title}")
        recorded = RECORDED.search(block) if block else None
        if recorded:
            found[f"## {title}"] = section_of(name).page(title, recorded[1], recorded[2], name)


def main(names: list[str]) -> None:
    unknown = set(names) - set(BENCHMARKS) - {"--page"}
    if unknown:
        sys.exit(f"no benchmark is called {', '.join(sorted(unknown))}; there are {', '.join(BENCHMARKS)}")
    page = PAGE.read_text(encoding="utf-8") if PAGE.exists() else HEAD
    found = {block.splitlines()[0]: block for block in re.split(r"^(?=## )", page, flags=re.MULTILINE)[1:]}
    if "--page" in names:
        laid_out_anew(found)
        write(found)
        return
    for name in names or BENCHMARKS:
        block = section(name)
        found[block.splitlines()[0]] = block
        write(found)


def write(found: dict[str, str]) -> None:
    kept = [found[title] for title in (f"## {t}" for t in BENCHMARKS.values()) if title in found]
    PAGE.write_text("\n".join([HEAD, *(block.rstrip() + "\n" for block in kept)]), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
