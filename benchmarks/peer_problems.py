"""What the benchmarks beside other libraries share: problems, contenders, clocks."""

from __future__ import annotations

import argparse
import importlib.util
import platform
import statistics
import time
import warnings
from dataclasses import dataclass, field
from datetime import date
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon.scene import find

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path

PERIODS, INSTANTS, TURNS = 1000, 3137, 5
TOLERANCES = [10.0**-k for k in range(3, 17)]
DEAR, DEAR_PERIODS = ("scipy", "diffrax", "pyhamsys", "desolver"), 50
"""These run for fewer periods; the error of those that are not symplectic is taken to grow in proportion to time."""

PATIENCE = 8.0
"""Seconds of processor time after which dearer settings of a contender are not tried any more."""

Array = np.ndarray
Run = tuple[float, Array]
"""Processor seconds, and states (2n, times) or energies (times,)."""


def _is_thirds(x: Any) -> bool:
    """Tell whether a number is a quotient that doubles do not have: heyoka takes none."""
    return x.is_Rational and x.q & (x.q - 1) != 0


class Problem:
    """A scene from one of its starts, with numbers for its parameters, in plain SymPy symbols q0, …, p0, …"""

    def __init__(self, name: str, scene: str, start: int, fewest: int, periods: int = PERIODS) -> None:
        self.name, self.scene, self.fewest, self.periods = name, scene, fewest, periods
        known = find(scene)
        self.hamiltonian, self.values = known.hamiltonian, known.values
        whole = known.hamiltonian
        self.y0 = known.state(known.starts[start])
        self.span = periods * known.time_scale(known.values)
        self.q, self.p = (list(sp.symbols(f"{letter}:{len(whole.q)}", real=True)) for letter in "qp")
        numbers = {
            s: sp.Float(self.values[str(s)], 17) for s in whole.H.free_symbols if str(s) in self.values
        }
        plain = dict(zip((*whole.q, *whole.p), (*self.q, *self.p), strict=True))
        self.H = whole.H.xreplace({**numbers, **plain}).replace(_is_thirds, lambda x: sp.Float(x, 17))
        self.rates = [*(self.H.diff(x) for x in self.p), *(-self.H.diff(x) for x in self.q)]
        self.energy = sp.lambdify([*self.q, *self.p], self.H, "numpy", cse=True)

    def error(self, found: Array) -> float:
        """Return max |ΔE/E| of states or energies."""
        wide = np.asarray(found, dtype=np.longdouble)
        energy = wide if wide.ndim == 1 else self.energy(*wide)
        error = float(abs(energy / energy[0] - 1).max())
        return error if np.isfinite(error) else np.inf


@dataclass
class Contender:
    """A method of a library on a problem: settings from cheap to dear, and what runs one."""

    name: str
    settings: Iterable[Any]
    run: Callable[[Any, int], Run]
    grows: bool = False
    """Whether its error grows with time, where it runs for fewer periods."""

    chosen: dict[float, Any] = field(default_factory=dict)
    costs: dict[float, list[float]] = field(default_factory=dict)
    calls: dict[float, list[float]] = field(default_factory=dict)

    @property
    def library(self) -> str:
        """Whose it is."""
        return self.name.split()[0]

    def cost(self, accuracy: float) -> float:
        """Return microseconds a period of the loop alone."""
        return self._a_period(self.costs[accuracy])

    def call(self, accuracy: float) -> float:
        """Return microseconds a period of the whole call."""
        return self._a_period(self.calls[accuracy])

    def _a_period(self, seconds: list[float]) -> float:
        periods = DEAR_PERIODS if self.library in DEAR else PERIODS
        return statistics.median(seconds[-TURNS:]) / periods * 1e6


def timed(call: Callable[[], Any]) -> tuple[float, Any]:
    begun = time.process_time()
    found = call()
    return time.process_time() - begun, found


def steps(problem: Problem, factor: float = 1.15) -> list[int]:
    """Return numbers of steps a period, from few to many."""
    return sorted({round(problem.fewest * factor**k) for k in range(round(np.log(150) / np.log(factor)))})


PROBLEMS = {
    "kepler": ("Kepler, e = 0.6", "kepler", 0, 10),
    "henon-heiles": ("Hénon–Heiles", "henon-heiles", 0, 4),
    "planets": ("outer solar system", "outer-solar-system", 0, 4),
    "double-pendulum": ("double pendulum", "double-pendulum", 0, 4),
    "fput": ("FPUT chain, 31 masses", "fput", 0, 40),
}


# what is printed -----------------------------------------------------------------------------------


def parser_of(text: str | None, problems: Iterable[str]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", action="store_true")
    parser.add_argument("--store", action="store_true", help="run, and keep what is printed")
    parser.add_argument("problems", nargs="*", help=f"of {', '.join(problems)}")
    return parser


def installed(libraries: Iterable[str]) -> Iterator[str]:
    """Tell what runs where, and what is left out."""
    named = [*libraries]
    there = [name for name in named if importlib.util.find_spec(name)]
    here = f"{date.today()}, {platform.machine()}, Python {platform.python_version()}"
    yield ", ".join([here, *(f"{name} {version(name)}" for name in there)])
    absent = [name for name in named if name not in there]
    if absent:
        yield f"not installed, left out: {', '.join(absent)}"
    if "rebound" in there and not getattr(importlib.import_module("rebound"), "avx512_available", False):
        yield "no AVX-512 here: REBOUND's WHFast512 is left out"


def tell(given: argparse.Namespace, stored: Path, lines: Callable[[], Iterator[str]]) -> None:
    """Print lines as they come and keep them where that is wanted; else what is stored."""
    if not (given.run or given.store):
        print(stored.read_text(encoding="utf-8"), end="")
        return
    warnings.simplefilter("ignore")
    told = list[str]()
    for line in lines():
        told.append(line)
        print(line, flush=True)
    if given.store:
        stored.parent.mkdir(exist_ok=True)
        before = stored.read_text(encoding="utf-8").splitlines() if given.problems and stored.exists() else []
        stored.write_text("\n".join(exchanged(before, told)) + "\n", encoding="utf-8")


def exchanged(before: Sequence[str], told: Sequence[str]) -> list[str]:
    """Return what was stored with what was measured anew in its place, problem by problem.

    A problem is a line and those below it that are indented; a line with none below it says where all was measured, or
    those problems that it names.
    """
    if not before:
        return [*told]
    old, new = blocks(before), blocks(told)
    anew = ", ".join(title for title, rows in new.items() if rows)
    where = [line for line, rows in old.items() if not rows and not line.endswith(f": {anew}")]
    where += [f"{line}: {anew}" for line, rows in new.items() if not rows]
    kept = {**{title: rows for title, rows in old.items() if rows}, **{t: r for t, r in new.items() if r}}
    named = [line for line in where if ": " in line]
    if all(any(title in line.partition(": ")[2] for line in named) for title in kept):
        where = named  # nothing is left of what was measured first
    return [*where, *(line for title, rows in kept.items() for line in (title, *rows))]


def blocks(lines: Sequence[str]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for line in lines:
        if line.startswith(" ") and found:
            found[[*found][-1]].append(line)
        else:
            found[line] = []
    return found
