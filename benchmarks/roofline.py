"""How near the compiled loops come to what the processor can do.

What it can do is measured by loops that canon's own compiler makes: chains of one kind of instruction, side by side, so
that none waits for another, in each width of SIMD register. What a loop asks of it is counted, not estimated: its
optimized code is run once with a counter in every basic block. An instruction on more numbers than a register holds
counts as several. The bound is the longest time that one kind of unit is busy, and a loop's share of the limit is the
bound over its time: 100 % would be a loop that keeps that unit busy without a pause.

- *arithmetic*: products and fused multiply-adds on their units, sums on theirs, or both where that takes longer;
- *quotients*: divisions and square roots, which share one slow unit;
- *memory*: loads and stores. Constants and what spills from the registers are not in the count.
- *functions*: calls of the C library, one after the other, each taken for a sine.

A single orbit is a chain of operations that wait for each other, and no unit is busy most of the time: its share says
how much room side by side orbits have, not how good its code is. ``python benchmarks/roofline.py``
"""

from __future__ import annotations

import contextlib
import ctypes
import operator
import re
import statistics
import time
import warnings
from collections import Counter
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any
from unittest import mock

import llvmlite.binding as llvm
import numpy as np
from kernels import bodies, fput, henon_heiles, kepler

from canon import Gauss, Hamiltonian, Splitting, WisdomHolman, propagate
from canon.flow.fixed_step import compiled_loop
from canon.kernel.llvm import machine_code
from canon.kernel.llvm.machine_code import compiled, simd_bytes
from canon.kernel.llvm.writer import LIBRARY
from canon.scene import find

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kernels import Case

REPEATS, ORBITS, FEW, CHAINS, ROUNDS = 5, 10_000, 400, 14, 8
PRODUCTS = 8
"""Of these chains, where products and sums are mixed: a product takes a cycle more than a sum, or none."""

WIDTHS = tuple(width for width in (1, 2, 4, 8) if 8 * width <= simd_bytes())
KINDS = ("fma", "add", "both", "div", "sqrt", "load", "store")
SINE = ("sin", 1)
MEMORY = 512
"""Doubles that loads and stores go over: they stay in the first cache."""

APART = ";" + " " * 200_000
"""A comment: of a module that is so long canon's compiler makes no vectors of single numbers."""


# what the processor can do ---------------------------------------------------------------------------


def peaks() -> dict[tuple[str, int], float]:
    """Return instructions a nanosecond of each kind, by the doubles in a register."""
    return {(kind, width): _rate(kind, width) for kind, width in (*product(KINDS, WIDTHS), SINE)}


def _rate(kind: str, width: int) -> float:
    code = compiled(_chains(kind, width), "chains", (ctypes.c_void_p, ctypes.c_int64), ["sin"])
    whole = np.ones(MEMORY + 8)
    data = whole[-whole.ctypes.data % 64 // 8 :]

    def call(rounds: int) -> float:
        begun = time.thread_time()
        code.call(data.ctypes.data, rounds)
        return time.thread_time() - begun

    rounds = 1000
    while call(rounds) < 0.01:
        rounds *= 2
    best = min(call(rounds) for _ in range(REPEATS))
    return CHAINS * ROUNDS * rounds / best / 1e9


def _chains(kind: str, width: int) -> str:
    """Return a module with so many independent chains of one kind of instruction."""
    of = "double" if width == 1 else f"<{width} x double>"
    suffix = "f64" if width == 1 else f"v{width}f64"
    address = "getelementptr i8, ptr %x, i64 {}"
    one = _chain_of(kind, of, suffix)
    lines = [
        APART,
        f"declare {of} @llvm.fma.{suffix}({of}, {of}, {of})",
        f"declare {of} @llvm.sqrt.{suffix}({of})",
        "declare double @sin(double)",
        "define void @chains(ptr %x, i64 %rounds) {",
        "entry:",
        f"  %a = load volatile {of}, ptr %x, align 8",
        "  br label %loop",
        "loop:",
        "  %n = phi i64 [ 0, %entry ], [ %next, %loop ]",
        *(f"  %s0.{c} = phi {of} [ %a, %entry ], [ %s{ROUNDS}.{c}, %loop ]" for c in range(CHAINS)),
    ]
    for k in range(ROUNDS):
        for c in range(CHAINS):
            place = 8 * width * ((k * CHAINS + c) % (MEMORY // width // 2))
            lines.append(f"  %p{k}.{c} = {address.format(place)}")
            lines += [line.format(before=f"%s{k}.{c}", after=f"%s{k + 1}.{c}", place=f"%p{k}.{c}")
                      for line in one[c >= PRODUCTS and kind == "both"]]  # fmt: skip
    lines += ["  %next = add i64 %n, 1", "  %more = icmp ult i64 %next, %rounds"]
    lines += ["  br i1 %more, label %loop, label %done", "done:"]
    lines += [f"  store volatile {of} %s{ROUNDS}.{c}, ptr %x, align 8" for c in range(CHAINS)]
    return "\n".join([*lines, "  ret void", "}"])


def _chain_of(kind: str, of: str, suffix: str) -> list[list[str]]:
    """Return what one step of a chain is; where kinds are mixed, of the first chains and of the others."""
    same = f"{{after}} = select i1 true, {of} {{before}}, {of} {{before}}"
    product = f"{{after}} = call {of} @llvm.fma.{suffix}({of} {{before}}, {of} %a, {of} %a)"
    total = f"{{after}} = fadd {of} {{before}}, %a"
    return {
        "fma": [[product]],
        "add": [[total]],
        "both": [[product], [total]],
        "div": [[f"{{after}} = fdiv {of} %a, {{before}}"]],
        "sqrt": [[f"{{after}} = call {of} @llvm.sqrt.{suffix}({of} {{before}})"]],
        "sin": [["{after} = call double @sin(double {before})"]],
        "load": [[f"{{after}} = load volatile {of}, ptr {{place}}, align 8"]],
        "store": [[f"store volatile {of} %a, ptr {{place}}, align 8", same]],
    }[kind]


# what a loop asks of it ------------------------------------------------------------------------------

_TYPE = re.compile(r"(?:<(\d+) x )?double\b")
_DONE = {"fmul": "fma", "fadd": "add", "fsub": "add", "fdiv": "div"}
_CALLED = {"fma": "fma", "fmuladd": "fma", "sqrt": "sqrt"}


def kind_of(line: str) -> tuple[str, int, int] | None:
    """Return kind, doubles a register and how many such instructions a line of LLVM's text is."""
    found = re.match(r"\s+(?:%[-\w.$]+ = )?(?:tail )?(load|store|fmul|fadd|fsub|fdiv|call)\b(.*)", line)
    if found is None:
        return None
    what, rest = found.groups()
    numbers = _TYPE.search(rest)
    if numbers is None or rest.lstrip().startswith("["):
        return None
    if what == "call":
        called = re.search(r"@(llvm\.)?(\w+)", rest)
        if called is not None and called[1] is None and called[2] in LIBRARY:
            return *SINE, 1
        if called is None or called[2] not in _CALLED:
            return None
        what = _CALLED[called[2]]
    whole = int(numbers[1] or 1)
    held = max(width for width in WIDTHS if width <= whole)
    return _DONE.get(what, what), held, -(-whole // held)


def with_counters(text: str) -> tuple[str, list[Counter[tuple[str, int]]]]:
    """Return a module that counts how often each basic block is run, and what each block holds."""
    lines: list[str] = []
    blocks: list[Counter[tuple[str, int]]] = []
    waiting = False
    for line in text.splitlines():
        starts = line.startswith("define ") or bool(re.match(r"[\w.$\"-]+:", line))
        if waiting and not starts and not re.match(r"\s+%[-\w.$]+ = phi ", line):
            lines.append(_counter(len(blocks)))
            blocks.append(Counter())
            waiting = False
        lines.append(line)
        if starts:
            # The label of the entry block follows its definition: it is counted once.
            waiting = True
        elif not waiting and (found := kind_of(line)) is not None:
            kind, width, times = found
            blocks[-1][kind, width] += times
    lines.append(f"@canon.counts = global [{len(blocks)} x i64] zeroinitializer")
    return "\n".join(lines), blocks


def _counter(block: int) -> str:
    place = f"getelementptr (i8, ptr @canon.counts, i64 {8 * block})"
    before, after = (f"%canon.{word}.{block}" for word in ("before", "after"))
    read, added = f"  {before} = load i64, ptr {place}", f"  {after} = add i64 {before}, 1"
    return "\n".join([read, added, f"  store i64 {after}, ptr {place}"])


class Counting:
    """The compiled functions of a run, each with its counters."""

    def __init__(self) -> None:
        self.blocks: list[list[Counter[tuple[str, int]]]] = []
        self.engines: list[Any] = []

    def total(self) -> Counter[tuple[str, int]]:
        """Return how many instructions of each kind and width were run."""
        total: Counter[tuple[str, int]] = Counter()
        for engine, blocks in zip(self.engines, self.blocks, strict=True):
            address = engine.get_global_value_address("canon.counts")
            runs = (ctypes.c_int64 * len(blocks)).from_address(address)
            for times, held in zip(runs, blocks, strict=True):
                for what, number in held.items():
                    total[what] += times * number
        return total


@contextlib.contextmanager
def counting() -> Iterator[Counting]:
    """Have every function that is compiled inside count its instructions, and none be kept beyond."""
    made, start_engine = Counting(), llvm.create_mcjit_compiler
    kept = [value for value in vars(compiled_loop).values() if hasattr(value, "cache_clear")]

    def with_code(ir: str, machine: Any) -> bytes:
        text, blocks = with_counters(str(machine_code.optimized(ir, machine)))
        made.blocks.append(blocks)
        return machine.emit_object(llvm.parse_assembly(text))

    def started(module: Any, machine: Any) -> Any:
        made.engines.append(start_engine(module, machine))
        return made.engines[-1]

    def forget() -> None:
        for loops in kept:
            loops.cache_clear()

    forget()
    # One thread counts: the counters are plain numbers.
    with (
        mock.patch.object(machine_code, "object_code", with_code),
        mock.patch.object(machine_code, "kept_or_made", lambda _made_of, make: make()),
        mock.patch.object(llvm, "create_mcjit_compiler", started),
        mock.patch("os.cpu_count", return_value=1),
    ):
        yield made
    forget()


# shares ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Bound:
    """Nanoseconds a step that each kind of unit is busy at the least."""

    arithmetic: float
    quotients: float
    memory: float
    functions: float

    @property
    def longest(self) -> tuple[str, float]:
        """What takes longest, and how long."""
        return max(vars(self).items(), key=operator.itemgetter(1))


def bound(counts: Counter[tuple[str, int]], peak: dict[tuple[str, int], float]) -> Bound:
    """Return how long each kind of unit is busy, in nanoseconds."""

    def busy(*kinds: str, at: str = "") -> float:
        return sum(n / peak[at or kind, width] for (kind, width), n in counts.items() if kind in kinds)

    arithmetic = max(busy("fma"), busy("add"), busy("fma", "add", at="both"))
    return Bound(arithmetic, busy("div", "sqrt"), max(busy("load"), busy("store")), busy("sin"))


@dataclass(frozen=True)
class Row:
    """A system, a method, an arithmetic, and how many orbits side by side."""

    name: str
    system: Callable[[], tuple[Hamiltonian, np.ndarray, float]]
    method: Any
    precision: str
    orbits: int
    steps: int

    def run(self, steps: int) -> Any:
        """Return what takes so many steps and keeps the last state only."""
        system, start, step = self.system()
        y0 = np.tile(start[:, np.newaxis], self.orbits) if self.orbits > 1 else start
        return lambda: propagate(
            system,
            (0.0, steps * step),
            y0,
            method=self.method,
            step=step,
            precision=self.precision,
            samples=1,
        )

    def counts(self) -> Counter[tuple[str, int]]:
        """Return the instructions of a step: those of a longer run without those of a shorter one."""
        few, many = 16, 48
        with counting() as made:
            run = self.run(few)
            run()
            first = made.total()
            longer = self.run(many)
            longer()
        whole = made.total()
        return Counter({what: (whole[what] - 2 * first[what]) / (many - few) for what in whole})

    def nanoseconds(self) -> float:
        """Return the processor time of a step: that of a longer run without that of a shorter one."""
        shorter, longer = self.run(self.steps), self.run(5 * self.steps)
        spent: list[list[float]] = [[], []]
        for _ in range(1 + REPEATS):
            for times, call in zip(spent, (shorter, longer), strict=True):
                times.append(call().cpu_seconds)
        few, many = (statistics.median(times[1:]) for times in spent)
        return (many - few) / (4 * self.steps) * 1e9


def _of_case(case: Case) -> Callable[[], tuple[Hamiltonian, np.ndarray, float]]:
    def made() -> tuple[Hamiltonian, np.ndarray, float]:
        return Hamiltonian(case.H, case.q, [s.momentum for s in case.q]), case.start, case.step

    return made


def _of_scene(name: str, steps: int) -> Callable[[], tuple[Hamiltonian, np.ndarray, float]]:
    def made() -> tuple[Hamiltonian, np.ndarray, float]:
        scene = find(name)
        numbers = {
            s: scene.values[str(s)] for s in scene.hamiltonian.H.free_symbols if str(s) in scene.values
        }
        system = Hamiltonian(scene.hamiltonian.H.xreplace(numbers), scene.hamiltonian.q, scene.hamiltonian.p)
        return system, scene.state(scene.starts[0]), scene.time_scale(scene.values) / steps

    return made


def rows() -> Iterator[Row]:
    """Yield what is measured."""
    for case, steps in ((henon_heiles(), 400), (kepler(), 200), (fput(32), 40)):
        for scheme in ("verlet", "kahan-li-8"):
            for precision in ("double", "compensated", "double-double"):
                cheaper = 10 if scheme == "kahan-li-8" else 1
                often = max(4, steps // cheaper // (10 if precision == "double-double" else 1))
                many = ORBITS if precision != "double-double" else FEW
                yield Row(
                    case.name, _of_case(case), Splitting(scheme), precision, many, often * ORBITS // many
                )
    for case, often in ((bodies(6), 100_000), (bodies(50), 2_000), (fput(128), 100_000), (fput(512), 30_000)):
        yield Row(case.name, _of_case(case), Splitting("verlet"), "double", 1, often)
    for case, often in ((henon_heiles(), 10**6), (kepler(), 10**6)):
        yield Row(case.name, _of_case(case), Splitting("kahan-li-8"), "compensated", 1, often // 10)
    yield Row("Kepler", _of_case(kepler()), WisdomHolman(), "double", 1, 300_000)
    yield Row("planets", _of_scene("outer-solar-system", 40), WisdomHolman(), "double", 1, 100_000)
    yield Row("double pendulum", _of_scene("double-pendulum", 40), Gauss(4), "double", 1, 20_000)


def main() -> None:
    """Print the peaks, and each loop's share."""
    warnings.simplefilter("ignore")  # the times count here, not where bodies meet
    peak = peaks()
    print("instructions a nanosecond, by the doubles in a register:")
    for width in WIDTHS:
        print(f"  {width} wide  " + "  ".join(f"{kind} {peak[kind, width]:6.3f}" for kind in KINDS))
    print(f"  a sine of the C library  {peak[SINE]:6.3f}")
    print(
        "\nbusy in a step, ns: arithmetic, quotients, memory, functions; the longest as a share of the loop's time"
    )
    for row in rows():
        found, spent = bound(row.counts(), peak), row.nanoseconds()
        what, least = found.longest
        many = f"{row.orbits} orbits" if row.orbits > 1 else "1 orbit"
        per = row.orbits
        busy = " ".join(f"{part / per:8.2f}" for part in vars(found).values())
        print(
            f"{row.name:16} {row.method!s:15} {row.precision:14} {many:13} {spent / per:10.2f} ns  {busy}  "
            f"{100 * least / spent:3.0f} % of the bound by {what}",
            flush=True,
        )


if __name__ == "__main__":
    main()
