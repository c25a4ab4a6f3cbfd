"""Compiled loops of splittings H = H₀ + H₁: the exact flow of a solvable H₀ and kicks by H₁ in turn.

A call runs three tables of (kick, flow) pairs: once what leads into the loop, the steps, and once what leads out of it.
So neighbouring flows of two steps are one, and a symplectic corrector is applied where a state is asked for
only. The state that the steps work on is kept in ``e`` from call to call, so that the motion does not depend on
where it was looked at; ``y`` and ``e`` get what leads out of a copy of it. It is used where y, the round-off in e and
h are what the last call left, and made anew from y where an event, say, has changed them.

``c`` holds t0, h, then for every pair the times of kick and flow and the weight 2γτ³ of a commutator in the kick, then
what flows need beyond their times.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Protocol

from canon.kernel.llvm.loop import METHOD, PARAMETERS, SIGNATURE, Loop, compiled_function
from canon.kernel.llvm.number_types import DOUBLE, MachineType
from canon.kernel.llvm.writer import Writer
from canon.kernel.solvable.kepler_centres import CentresInLanes
from canon.kernel.solvable.lanes import BodyLanes, StepLengths
from canon.kernel.solvable.linear_motion import LinearMotion, flow_matrices
from canon.kernel.solvable.planets_about_star import HeliocentricPlanets, JacobiPlanets
from canon.kernel.solvable.solvable_deviations import BodyDeviations, LinearDeviations
from canon.kernel.solvable.solvable_parts import Centres, Planets

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.kernel.schemes.perturbed_schemes import Corrector
    from canon.kernel.schemes.splitting_schemes import Scheme
    from canon.kernel.solvable.solvable_parts import Part

__all__ = ["solvable_loop"]


@dataclass(frozen=True)
class _Pair:
    """A kick and the flow after it, in steps; γ in steps³."""

    kick: Fraction
    flow: Fraction
    commutator: Fraction = Fraction(0)


_STEPS = 4
"""Step sizes of a loop whose numbers are kept for the next motion."""

_NUMBERS = 3
"""Numbers of a pair in c."""


class SolvableMotion(Protocol):
    """What the loop asks of a solvable part: its working state, and how the two flows move it."""

    state: str
    words: int
    """The working state, an array of so many numbers."""

    def enter(self, y: str, e: str) -> None:
        """Write the working state from a state y + e."""
        ...

    def leave(self, y: str, e: str) -> None:
        """Write y + e from the working state."""
        ...

    def move(self, times: StepLengths, pair: str) -> None:
        """Write the flow of H₁ and then that of H₀; ``pair`` is the number of the two in the tables."""
        ...

    def count(self, steps: str) -> None:
        """Write down that so many steps were done."""
        ...


class SolvableTangents(Protocol):
    """What the loop asks of deviations beside a motion."""

    words: int
    """Numbers that they take as they are moved, beside those of (q, p)."""

    def enter(self, outer: str, inner: str) -> None:
        """Write them as they are moved from those of (q, p)."""
        ...

    def leave(self, outer: str, steps: str) -> None:
        """Write those of (q, p) after so many steps."""
        ...

    def move(self, times: StepLengths, pair: str) -> None:
        """Write the flow of H₁ and then that of H₀, of the orbit and of its deviations."""
        ...


def solvable_loop(
    part: Part,
    degrees: int,
    scheme: Scheme,
    corrector: Corrector | None,
    *,
    compensated: bool,
    number: MachineType = DOUBLE,
    democratic: bool = False,
    vectors: int = 0,
    units: Sequence[Fraction] = (),
) -> Loop:
    """Compile a splitting H = H₀ + H₁ by the flows of a solvable part and of the rest.

    Parameters
    ----------
    part
        The solvable part.
    degrees
        Degrees of freedom n.
    scheme
        Its a are the times of H₀'s flow, its b those of the kicks by H₁, its commutators the weights γ in these.
    corrector
        A symplectic corrector, or none.
    compensated, number
        The arithmetic.
    democratic
        Whether planets move in democratic heliocentric coordinates rather than Jacobi's.
    vectors
        How many deviations, of 2n numbers each, are moved beside the orbit; they are the last numbers in ``e``.
    units
        What each component of a deviation of (q, p) is multiplied with there, powers of 2.
    """
    tables = _tables(scheme, corrector)
    size, w = 2 * degrees, Writer(number)
    pairs = sum(map(len, tables))
    motion, extra = _motion(w, part, pairs, compensated=compensated, democratic=democratic)
    beside = _deviations(motion, size, vectors) if vectors else None
    before = size + 2 + 2 * size + motion.words + (beside.words if beside else 0)
    carry = before + vectors * size
    with w.loop(0, "%blocks") as block:
        y = w.at("%y", w.let(f"mul i64 {block}, {size}"))
        e = w.at("%e", w.let(f"mul i64 {block}, {carry}"))
        record, kept = w.at(e, size), w.at(e, 3 * size + 2)
        fresh = _differs(w, record, (y, e), size)
        # Deviations are led in along the orbit that is led in with them.
        with w.loop(0, "1" if beside else fresh):
            motion.enter(y, e)
        if beside:
            _multiply(w, w.at(e, before), vectors, [1 / unit for unit in units])
            beside.enter(w.at(e, before), w.at(e, before - beside.words))
        with w.loop(0, 3) as phase:
            leading_in, looped, leading_out = (w.let(f"icmp eq i64 {phase}, {which}") for which in range(3))
            known = w.let(f"select i1 {looped}, i64 {fresh}, i64 1")
            with w.loop(known, 1):
                w.copy(kept, motion.state, motion.words)
            with w.loop(0, w.let(f"zext i1 {leading_out} to i64")):
                motion.count("%steps")
                w.copy(motion.state, kept, motion.words)
            first_time = "1" if beside else fresh
            once = w.let(f"select i1 {leading_in}, i64 {first_time}, i64 1")
            times = w.let(f"select i1 {looped}, i64 %steps, i64 {once}")
            first = w.entry((0, len(tables[0]), len(tables[0]) + len(tables[1])), phase)
            last = w.let(f"add i64 {first}, {w.entry([len(table) for table in tables], phase)}")
            with w.loop(0, times), w.loop(first, last) as pair:
                _write_pair(w, beside or motion, pair, commutators=bool(scheme.commutators))
        motion.leave(y, e)
        if beside:
            beside.leave(w.at(e, before), "%steps")
            _multiply(w, w.at(e, before), vectors, units)
        w.store(w.constant(Fraction(1)), record, 0)
        w.store(w.load("%c", 1), record, 1)
        w.copy(y, w.at(record, 2), size)
        w.copy(e, w.at(record, 2 + size), size)
    code = compiled_function(w, "advance", PARAMETERS, SIGNATURE)

    @functools.lru_cache(maxsize=_STEPS)
    def coefficients(h: Fraction) -> list[Fraction]:
        flat = [pair for table in tables for pair in table]
        numbers = ((pair.kick * h, pair.flow * h, 2 * pair.commutator * h**3) for pair in flat)
        return [*(time for three in numbers for time in three), *extra([pair.flow * h for pair in flat])]

    return Loop(code, degrees, compensated, number, carry, coefficients=coefficients)


def _write_pair(
    w: Writer, motion: SolvableMotion | SolvableTangents, pair: str, *, commutators: bool
) -> None:
    """Write a kick and a flow, without branches between: what both read of the state is computed once."""
    place = w.at("%c", w.let(f"add i64 {w.let(f'mul i64 {pair}, {_NUMBERS}')}, {METHOD}"))
    kick, flow, commutator = (w.load(place, which) for which in range(_NUMBERS))
    if not commutators:
        motion.move(StepLengths(kick, flow), pair)
        return
    weight = w.as_double(commutator)
    with_it = w.let(f"zext i1 {w.let(f'fcmp une double {weight}, 0.0')} to i64")
    with w.loop(0, with_it):
        motion.move(StepLengths(kick, flow, commutator), pair)
    with w.loop(with_it, 1):
        motion.move(StepLengths(kick, flow), pair)


def _multiply(w: Writer, array: str, vectors: int, factors: Sequence[Fraction]) -> None:
    """Multiply the components of vectors, which lie one after the other, with factors, none for 1."""
    if all(factor == 1 for factor in factors):
        return
    factor = w.number_table(factors)
    with w.loop(0, vectors) as g, w.loop(0, len(factors)) as i:
        place = w.let(f"add i64 {w.let(f'mul i64 {g}, {len(factors)}')}, {i}")
        w.store(w.algebra("mul", w.load(array, place), factor(i)), array, place)


def _differs(w: Writer, record: str, state: tuple[str, str], size: int) -> str:
    """Return 1 where y, e or h is not what the last call left, or there was none, and 0 otherwise."""
    b, parts = (w.in_numbers(DOUBLE), 2) if w.number.pair else (w, 1)
    same = b.array(1)
    b.store(b.load(record, 0), same, 0)

    def compare(a: str, b_array: str, count: int) -> None:
        with b.loop(0, count * parts) as i:
            equal = b.equal(b.load(a, i), b.load(b_array, i))
            b.store(b.select(equal, b.load(same, 0), b.constant(Fraction(0))), same, 0)

    compare(w.at(record, 1), w.at("%c", 1), 1)
    for which, array in enumerate(state):
        compare(array, w.at(record, 2 + which * size), size)
    return w.let(f"zext i1 {b.equal(b.load(same, 0), b.constant(Fraction(0)))} to i64")


def _deviations(motion: SolvableMotion, size: int, vectors: int) -> SolvableTangents:
    if isinstance(motion, LinearMotion):
        return LinearDeviations(motion, vectors)
    assert isinstance(motion, BodyLanes)
    return BodyDeviations(motion, size, vectors)


def _motion(
    w: Writer, part: Part, pairs: int, *, compensated: bool, democratic: bool
) -> tuple[SolvableMotion, Callable[[Sequence[Fraction]], list[Fraction]]]:
    """Return a part's motion, and what it reads beyond the times of its flows."""
    if isinstance(part, Planets):
        kind = HeliocentricPlanets if democratic else JacobiPlanets
        return kind(w, part, compensated=compensated), _nothing
    if isinstance(part, Centres):
        return CentresInLanes(w, part, compensated=compensated), _nothing
    matrices = METHOD + _NUMBERS * pairs
    motion = LinearMotion(w, part, matrices, compensated=compensated)
    return motion, functools.partial(flow_matrices, part, w.number)


def _nothing(_times: Sequence[Fraction]) -> list[Fraction]:
    return []


def _tables(scheme: Scheme, corrector: Corrector | None) -> tuple[list[_Pair], list[_Pair], list[_Pair]]:
    """Return the pairs that lead into the loop, of a step inside it, and that lead out.

    A step that starts and ends with a flow (kick) is begun by doing its first (undoing its last) outside.
    """
    a, b = scheme.a, scheme.b
    c = scheme.commutators or (Fraction(0),) * len(b)
    none = Fraction(0)
    forth = [_Pair(*each) for each in corrector.pairs(inverse=False)] if corrector else []
    back = [_Pair(*each) for each in corrector.pairs(inverse=True)] if corrector else []
    if scheme.kick_first:
        inner = [_Pair(*each) for each in zip(b[1:-1], a[2:-1], c[1:-1], strict=True)]
        step = [_Pair(b[0] + b[-1], a[1], c[0] + c[-1]), *inner]
        return [*forth, _Pair(-b[-1], none, -c[-1])], step, [_Pair(b[-1], none, c[-1]), *back]
    inner = [_Pair(*each) for each in zip(b[:-1], a[1:-1], c[:-1], strict=True)]
    step = [*inner, _Pair(b[-1], a[-1] + a[0], c[-1])]
    return [*forth, _Pair(none, a[0])], step, [_Pair(none, -a[0]), *back]
