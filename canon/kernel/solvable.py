"""Compiled loops of splittings by exactly solvable parts: flows of H₀ and kicks by H₁ in turn.

A call runs three tables of (kick, flow) pairs: once what leads into the loop, the steps, and once what leads out of it.
So neighbouring flows of two steps are one, and a symplectic corrector is applied where a state is asked for
only. The state that the steps work on is kept in ``e`` from call to call, so that the motion does not depend on
where it was looked at; ``y`` and ``e`` get what leads out of a copy of it. It is used where y, the round-off in e and
h are what the last call left, and made anew from y where an event, say, has changed them.

``c`` holds t0, h, then for every pair the times of kick and flow, then what flows need beyond their times.
"""

from __future__ import annotations

import functools
from fractions import Fraction
from typing import TYPE_CHECKING, Protocol

from canon.kernel.bodies import CentresInLanes, PlanetsInLanes
from canon.kernel.linear import LinearMotion, flow_matrices
from canon.kernel.loop import METHOD, PARAMETERS, SIGNATURE, Loop, compiled_function
from canon.kernel.machine import DOUBLE
from canon.kernel.planets import Centres, Planets
from canon.kernel.writer import Writer

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.kernel.perturbed import Corrector
    from canon.kernel.planets import Part
    from canon.kernel.scheme import Scheme

__all__ = ["solvable_loop"]

Pairs = list[tuple[Fraction, Fraction]]


class Motion(Protocol):
    """What the loop asks of a solvable part: its working state, and how the two flows move it."""

    words: int
    """Numbers of the working state."""

    def enter(self, y: str, e: str) -> None:
        """Write the working state from a state y + e."""
        ...

    def leave(self, y: str, e: str) -> None:
        """Write y + e from the working state."""
        ...

    def kick(self, time: str) -> None:
        """Write the flow of H₁."""
        ...

    def flow(self, time: str, pair: str) -> None:
        """Write the flow of H₀; ``pair`` is the number of the pair in the tables."""
        ...

    def count(self, steps: str) -> None:
        """Write down that so many steps were done."""
        ...


def solvable_loop(
    part: Part, degrees: int, scheme: Scheme, corrector: Corrector | None, *, compensated: bool
) -> Loop:
    """Compile a splitting H = H₀ + H₁ by the flows of a solvable part and of the rest.

    Parameters
    ----------
    part
        The solvable part.
    degrees
        Degrees of freedom n.
    scheme
        Its a are the times of H₀'s flow, its b those of the kicks by H₁.
    corrector
        A symplectic corrector, or none.
    compensated
        Whether round-off is carried along.
    """
    tables = _tables(scheme, corrector)
    size, w = 2 * degrees, Writer(DOUBLE)
    pairs = sum(map(len, tables))
    motion, extra = _motion(w, part, pairs, compensated=compensated)
    carry = size + 2 + 2 * size + motion.words
    with w.loop(0, "%blocks") as block:
        y = w.at("%y", w.let(f"mul i64 {block}, {size}"))
        e = w.at("%e", w.let(f"mul i64 {block}, {carry}"))
        record, kept = w.at(e, size), w.at(e, 3 * size + 2)
        fresh = _differs(w, record, (y, e), size)
        with w.loop(0, fresh):
            motion.enter(y, e)
        with w.loop(fresh, 1):
            w.copy(kept, motion.state, motion.words)
        with w.loop(0, 3) as phase:
            leading_in, leading_out = (w.let(f"icmp eq i64 {phase}, {number}") for number in (0, 2))
            with w.loop(0, w.let(f"zext i1 {leading_out} to i64")):
                motion.count("%steps")
                w.copy(motion.state, kept, motion.words)
            once = w.let(f"select i1 {leading_in}, i64 {fresh}, i64 1")
            looped = w.let(f"icmp eq i64 {phase}, 1")
            times = w.let(f"select i1 {looped}, i64 %steps, i64 {once}")
            first = w.entry((0, len(tables[0]), len(tables[0]) + len(tables[1])), phase)
            last = w.let(f"add i64 {first}, {w.entry([len(table) for table in tables], phase)}")
            with w.loop(0, times), w.loop(first, last) as pair:
                place = w.at("%c", w.let(f"add i64 {w.let(f'shl i64 {pair}, 1')}, {METHOD}"))
                for which, flow in ((0, motion.kick), (1, functools.partial(motion.flow, pair=pair))):
                    time = w.load(place, which)
                    moving = w.let(f"fcmp une double {time}, {w.constant(Fraction(0))}")
                    with w.loop(0, w.let(f"zext i1 {moving} to i64")):
                        flow(time)
        motion.leave(y, e)
        w.store(w.constant(Fraction(1)), record, 0)
        w.store(w.load("%c", 1), record, 1)
        w.copy(y, w.at(record, 2), size)
        w.copy(e, w.at(record, 2 + size), size)
    code = compiled_function(w, "advance", PARAMETERS, SIGNATURE)

    def coefficients(h: Fraction) -> list[Fraction]:
        times = [(b * h, a * h) for table in tables for b, a in table]
        return [*(time for pair in times for time in pair), *extra([a for _, a in times])]

    return Loop(code, degrees, compensated, DOUBLE, carry, coefficients=coefficients)


def _differs(w: Writer, record: str, state: tuple[str, str], size: int) -> str:
    """Return 1 where y, e or h is not what the last call left, or there was none, and 0 otherwise."""
    same = w.array(1)
    w.store(w.load(record, 0), same, 0)

    def compare(a: str, b: str) -> None:
        w.store(w.select(w.equal(a, b), w.load(same, 0), w.constant(Fraction(0))), same, 0)

    compare(w.load(record, 1), w.load("%c", 1))
    for part, array in enumerate(state):
        with w.loop(0, size) as i:
            compare(w.load(array, i), w.load(w.at(record, 2 + part * size), i))
    return w.let(f"zext i1 {w.equal(w.load(same, 0), w.constant(Fraction(0)))} to i64")


def _motion(
    w: Writer, part: Part, pairs: int, *, compensated: bool
) -> tuple[PlanetsInLanes | CentresInLanes | LinearMotion, Callable[[Sequence[Fraction]], list[Fraction]]]:
    """Return a part's motion, and what it reads beyond the times of its flows."""
    if isinstance(part, Planets):
        return PlanetsInLanes(w, part, compensated=compensated), _nothing
    if isinstance(part, Centres):
        return CentresInLanes(w, part, compensated=compensated), _nothing
    matrices = METHOD + 2 * pairs
    return LinearMotion(w, part, matrices, compensated=compensated), functools.partial(flow_matrices, part)


def _nothing(_times: Sequence[Fraction]) -> list[Fraction]:
    return []


def _tables(scheme: Scheme, corrector: Corrector | None) -> tuple[Pairs, Pairs, Pairs]:
    """Return the (kick, flow) pairs that lead into the loop, of a step inside it, and that lead out.

    A step that starts and ends with a flow (kick) is begun by doing its first (undoing its last) outside.
    """
    a, b = scheme.a, scheme.b
    forth = corrector.pairs(inverse=False) if corrector else []
    back = corrector.pairs(inverse=True) if corrector else []
    if scheme.kick_first:
        step = [(b[0] + b[-1], a[1]), *zip(b[1:-1], a[2:-1], strict=True)]
        return [*forth, (-b[-1], Fraction(0))], step, [(b[-1], Fraction(0)), *back]
    step = [*zip(b[:-1], a[1:-1], strict=True), (b[-1], a[-1] + a[0])]
    return [*forth, (Fraction(0), a[0])], step, [(Fraction(0), -a[0]), *back]
