"""Compiled loops: many steps of one method in one call, for one Hamiltonian.

Every loop has the signature ``advance(y, e, c, first, steps, blocks)``: ``y`` holds q then p, ``e`` what
compensation carries (y + e is the state), ``c`` the numbers t0, h and then the method's coefficients times h,
``first`` the number of the first step, so that time is t0 + n·h and never accumulates. A block is as many
orbits as the number type has lanes; ``y`` and ``e`` hold one block after the other.

Compensation (W. Kahan, Comm. ACM 8 (1965) 40): d ← c·f + e by ``fma``, rounded once; s ← y + d; e ← d − (s − y);
y ← s. Where |y| ≥ |d| that e is the error of y + d exactly (T. J. Dekker, Numer. Math. 18 (1971) 224–242). Where a
component passes zero, |y| < |d|, the difference s − y = d + δ with |δ| ≤ 2u|d| is rounded by at most u|d|(1 + 2u), and
what d lacks of it is exact: e errs by little more than d has been rounded by already, in these steps only and to either
side. Knuth's sum, which errs nowhere, takes six additions instead of three.
"""

from __future__ import annotations

import contextlib
import ctypes
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.machine_code import MachineCode, compiled
from canon.kernel.llvm.number_types import DOUBLE, MachineType
from canon.kernel.llvm.writer import HEAP, LIBRARY, Writer

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.program import Program

__all__ = [
    "METHOD",
    "PARAMETERS",
    "SIGNATURE",
    "Loop",
    "field_function",
    "runge_kutta_loop",
]

_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64
SIGNATURE = (_POINTER, _POINTER, _POINTER, _INTEGER, _INTEGER, _INTEGER)
PARAMETERS = "ptr noalias %y, ptr noalias %e, ptr noalias %c, i64 %first, i64 %steps, i64 %blocks"
METHOD = 2
"""Where the method's own coefficients start in c."""


@dataclass(frozen=True, eq=False)
class Loop:
    """A compiled loop and what one step of it costs.

    Parameters
    ----------
    code
        The machine code.
    dimension
        Degrees of freedom n.
    compensated
        Whether it carries round-off along.
    number
        The type it computes in.
    carry
        Numbers in ``e``: compensation, and what else a method keeps between calls.
    implicit
        Whether after the compensation ``e`` holds the number of iterations and the last change of one that
        did not converge (0 where all did).
    coefficients
        What the loop reads of c after t0 and h, a function of h, where the method alone does not say.
    iterated, remedy
        In words, what an implicit method's iteration finds, and what to do where it does not converge.
    """

    code: MachineCode
    dimension: int
    compensated: bool
    number: MachineType
    carry: int
    implicit: bool = False
    coefficients: Callable[[Fraction], list[Fraction]] | None = None
    iterated: str = "the stages"
    remedy: str = "the step is too large for the iteration; take a smaller one, or Taylor()"


def runge_kutta_loop(system: HamiltonEquations, *, compensated: bool, number: MachineType = DOUBLE) -> Loop:
    """Compile the classical fourth-order Runge–Kutta method; its coefficients are h/2, h/6, h/3."""
    n = len(system.q)
    w = Writer(number)
    y, e = w.array(2 * n), w.array(2 * n) if compensated else ""
    stage, rate, total = w.array(2 * n), w.array(2 * n), w.array(2 * n)
    field = system.program(system.rates)
    full, half, sixth, third = (w.load("%c", i) for i in range(1, 5))

    def evaluate(at: str, clock: str) -> None:
        arguments = [*(w.load(at, i) for i in range(2 * n)), clock]
        for i, value in enumerate(w.program(field, arguments)):
            w.store(value, rate, i)

    with blocks_of(w, y, e, 2 * n, 2 * n), steps_of(w, system) as time:
        midway, end = w.algebra("add", time, half), w.algebra("add", time, full)
        evaluate(y, time)
        with w.loop(0, 2 * n) as i:
            w.store(w.algebra("mul", sixth, w.load(rate, i)), total, i)
        for weight, reach, clock in ((third, half, midway), (third, half, midway), (sixth, full, end)):
            with w.loop(0, 2 * n) as i:
                w.store(w.multiply_add(reach, w.load(rate, i), w.load(y, i)), stage, i)
            evaluate(stage, clock)
            with w.loop(0, 2 * n) as i:
                w.store(w.multiply_add(weight, w.load(rate, i), w.load(total, i)), total, i)
        with w.loop(0, 2 * n) as i:
            increase(w, y, e, i, w.constant(Fraction(1)), w.load(total, i))
    return compile_loop(w, n, compensated=compensated)


def field_function(field: Program) -> MachineCode:
    """Compile a program as ``f(x, out)`` in doubles: x holds its inputs, out gets its outputs."""
    w = Writer(DOUBLE)
    arguments = [w.load("%x", i) for i in range(len(field.inputs))]
    for i, value in enumerate(w.program(field, arguments)):
        w.store(value, "%out", i)
    return compiled_function(w, "evaluate", "ptr noalias %x, ptr noalias %out", (_POINTER, _POINTER))


# pieces of loops -------------------------------------------------------------------------------------


@contextlib.contextmanager
def blocks_of(w: Writer, y: str, e: str, size: int, carry: int, gap: int = 0) -> Generator[str]:
    """Repeat what is written inside for every block, on local copies y and e, and yield the block's outer e.

    The copies may have a gap in the middle, between q and p.
    """

    def halves(outer: str, own: str) -> list[tuple[str, str, int]]:
        if not gap:
            return [(outer, own, size)]
        half = size // 2
        return [(outer, own, half), (w.at(outer, half), w.at(own, half + gap), half)]

    with w.loop(0, "%blocks") as block:
        outer_y = w.at("%y", w.let(f"mul i64 {block}, {size}"))
        outer_e = w.at("%e", w.let(f"mul i64 {block}, {carry}"))
        pieces = [*halves(outer_y, y), *(halves(outer_e, e) if e else ())]
        for outer, own, length in pieces:
            w.copy(outer, own, length)
        yield outer_e
        for outer, own, length in pieces:
            w.copy(own, outer, length)


@contextlib.contextmanager
def steps_of(w: Writer, system: HamiltonEquations) -> Generator[str]:
    """Repeat what is written inside for every step and yield the time at which the step starts."""
    start, h = w.load("%c", 0), w.load("%c", 1)
    last = w.let("add i64 %first, %steps")
    with w.loop("%first", last) as step:
        yield start if system.autonomous else w.multiply_add(w.whole(step), h, start)


def increase(w: Writer, y: str, e: str, i: str, coefficient: str, rate: str) -> None:
    """Write y_i ← y_i + coefficient · rate, compensated where there is an e."""
    old = w.load(y, i)
    if not e:
        w.store(w.multiply_add(coefficient, rate, old), y, i)
        return
    increment = w.multiply_add(coefficient, rate, w.load(e, i))
    new = w.algebra("add", old, increment)
    w.store(w.algebra("sub", increment, w.algebra("sub", new, old)), e, i)
    w.store(new, y, i)


def compile_loop(w: Writer, n: int, *, compensated: bool, carry: int = 0) -> Loop:
    """Compile what was written."""
    return Loop(
        compiled_function(w, "advance", PARAMETERS, SIGNATURE),
        n,
        compensated,
        w.number,
        carry or 2 * n,
        bool(carry),
    )


def compiled_function(w: Writer, name: str, parameters: str, signature: Sequence[object]) -> MachineCode:
    """Compile what was written as one function."""
    body = w.body()  # first, as it may declare what it calls
    ir = "\n".join([*sorted(w.declarations), f"define void @{name}({parameters}) {{", body, "}"])
    called = [*(f"{function}{suffix}" for function in LIBRARY for suffix in ("", "f", "l")), *HEAP]
    return compiled(ir, name, signature, [function for function in called if f"@{function}(" in ir])
