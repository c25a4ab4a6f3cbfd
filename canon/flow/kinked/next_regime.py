"""Next regime of equations with kinks: which signs a motion takes where switching functions are zero.

A regime goes on from a zero where every switching function that vanishes there leaves it, along the regime's own
motion, to the side whose sign the regime has. Where one does so the motion crosses. Where none does, both sides lead to
the zero and the motion stays on it, as a block does that dry friction holds. Where several do, it is not determined.

A Hamiltonian that jumps by ΔH at a wall g(q, t) = 0 refracts the momentum along the wall's normal, or reflects it:
p → p + λ ∇g with H(p + λ ∇g) + λ ∂g/∂t as before, which is λ² a/2 + λ ġ + ΔH = 0 with a = ∇g·M⁻¹∇g.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.kinked.regime_signs import HELD, flipped, held_in, put
from canon.flow.kinked.rest import is_kept, nothing_moves
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.array import Array
    from canon.flow.kinked.place import Place
    from canon.flow.kinked.regime_signs import Signs
    from canon.flow.kinked.regimes import Kinks, Regime
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["Passage", "passage", "settled", "signs_at_start", "vanishing"]

_ROUNDING = 2.0**-44
"""What part of the sizes of its terms rounding may leave of a zero."""

_TOUCH = 2.0**-50
"""What turns round within this part of the sizes of its terms touches a zero and does not pass it."""

_JUMP = 2.0**-40
"""A change of H by a larger part of the size of its terms is a jump."""

_DERIVATIVES = 4
"""So many time derivatives of a switching function are asked for the side to which it leaves its zero."""

_MOST_TOGETHER = 6
"""So many switching functions at most may vanish at one instant."""


@dataclass(frozen=True, eq=False)
class Passage:
    """What follows from a zero: the signs of the next regime, new momenta where H jumps, and what to call it.

    ``rests`` is the component of the state that is 0 from here on, as what was left of it has no time to pass.
    """

    signs: Signs
    y: Array | None = None
    words: str = ""
    rests: int | None = None


def vanishing(kinks: Kinks, signs: Signs, at: Place) -> list[int]:
    """Return the switching functions of a regime that are zero but for rounding."""
    regime = kinks.regime(signs)
    numbers = [*regime.functions]
    values = at.values(regime.system, [regime.functions[k] for k in numbers])
    return [
        k
        for k, value in zip(numbers, values, strict=True)
        if abs(value) <= _ROUNDING * at.size(regime.system, regime.functions[k])
    ]


def signs_at_start(kinks: Kinks, at: Place, forward: int) -> Signs:
    """Return the regime that a motion begins in.

    Raises
    ------
    NonFiniteStateError
        The motion is not determined by its start.
    """
    count = len(kinks.functions)
    signs = settled(kinks, (1,) * count, set(), at)
    zero = vanishing(kinks, signs, at)
    if not zero:
        return signs
    found = _goes_on(kinks, signs, zero, at, forward)
    for k in zero:
        if _is_wall(kinks, signs, k, at):
            raise _lost(
                kinks,
                [k],
                at,
                "H jumps where the motion begins: begin a little beside, on the side that is meant",
            )
    return found


def _is_wall(kinks: Kinks, signs: Signs, k: int, at: Place) -> bool:
    """Tell whether H jumps in space, not in time, where a switching function vanishes."""
    system = kinks.regime(signs).system
    slopes = system.graph.gradient(kinks.folded(signs, [kinks.functions[k]])[0], system.q)
    beyond = settled(kinks, flipped(signs, k), {*kinks.mattering(signs)} - {*kinks.nested} | {k}, at)
    return any(at.values(system, slopes)) and bool(_jump(kinks, signs, beyond, at))


def passage(kinks: Kinks, signs: Signs, k: int, at: Place, forward: int) -> Passage:
    """Return what follows where a motion meets a zero of switching function k from a regime.

    Raises
    ------
    NonFiniteStateError
        The motion is not determined there.
    """
    if HELD in signs:
        return _from_held(kinks, signs, k, at, forward)
    fresh = {j for j in kinks.mattering(signs) if j not in kinks.nested}
    beyond = settled(kinks, flipped(signs, k), fresh | {k}, at)
    jump = _jump(kinks, signs, beyond, at)
    if jump:
        return _refracted(kinks, signs, beyond, k, jump, at)
    zero = sorted({k, *vanishing(kinks, signs, at), *vanishing(kinks, beyond, at)})
    following = _goes_on(kinks, beyond, zero, at, forward)
    held = held_in(following)
    if not held:
        return Passage(following)
    rests = len(held) == 1 and kinks.rate_at_rest(following, held[0]) is not None
    return Passage(following, words="sticks", rests=kinks.row(held[0]) if rests else None)


def _from_held(kinks: Kinks, signs: Signs, k: int, at: Place, forward: int) -> Passage:
    """Return what follows where a function leaves its zero, or another meets its own meanwhile."""
    held = held_in(signs)
    beside = tuple(sign or 1 for sign in signs)
    if k in held:
        following = _goes_on(kinks, beside, held, at, forward, leaves=k)
        return Passage(following, words="slips")
    if len(held) == 1 and nothing_moves(kinks, beside, held[0], at):
        return _beside_rest(kinks, beside, k, held[0], at, forward)
    following = _goes_on(kinks, flipped(beside, k), sorted({k, *held}), at, forward)
    more = len(held_in(following)) - len(held)
    return Passage(following, words="sticks" if more > 0 else "slips" if more < 0 else "")


def _beside_rest(kinks: Kinks, signs: Signs, k: int, held: int, at: Place, forward: int) -> Passage:
    """Return what follows from a zero while a variable rests for ever; ``signs`` have a side for it."""
    following = _goes_on(kinks, flipped(signs, k), [k], at, forward)
    if HELD in following:
        raise _lost(kinks, [k, held], at, "several kinks hold the motion at once")
    return Passage(put(following, held, HELD))


def settled(kinks: Kinks, signs: Signs, known: set[int], at: Place) -> Signs:
    """Return the signs of all functions that matter, given those of some; the others count as positive."""
    known = set(known)
    while unknown := [k for k in kinks.mattering(signs) if k not in known]:
        inner = [k for k in unknown if k not in kinks.nested] or unknown[:1]
        nodes = kinks.folded(signs, [kinks.functions[k] for k in inner])
        for k, value in zip(inner, at.values(kinks.system, nodes), strict=True):
            signs = (*signs[:k], -1 if value < 0 else 1, *signs[k + 1 :])
        known |= set(inner)
    mattering = kinks.mattering(signs)
    return tuple(sign if k in mattering else 1 for k, sign in enumerate(signs))


def _goes_on(
    kinks: Kinks, signs: Signs, zero: Sequence[int], at: Place, forward: int, leaves: int | None = None
) -> Signs:
    """Return the regime that goes on from where some functions vanish, one of which may be known to leave its zero.

    Others take the signs they have.
    """
    if len(zero) > _MOST_TOGETHER:
        together = _held_together(kinks, signs, zero, at, forward, leaves)
        if together is None:
            raise _lost(kinks, zero, at, f"{len(zero)} kinks are met at one instant")
        return together
    if len(zero) == 1 and HELD not in signs and nothing_moves(kinks, signs, zero[0], at):
        if not is_kept(kinks, zero[0], at, forward):
            raise _lost(kinks, zero, at, "the motion is not determined: it may rest, or leave at any time")
        return put(signs, zero[0], HELD)
    found = {
        each for each in _candidates(kinks, signs, zero, at) if _consistent(kinks, each, zero, at, forward)
    }
    if len(found) == 1:
        return found.pop()
    if len(found) > 1:
        first, *others = sorted(found, key=lambda each: _distance(each, signs))
        rates = [_rates(kinks, each, at) for each in (first, *others)]
        if all(np.allclose(rates[0], other, rtol=_JUMP, atol=0.0) for other in rates[1:]):
            return first
        raise _lost(kinks, zero, at, "the motion is not determined: it may leave the kink to either side")
    if len(zero) == 1:
        return put(signs, zero[0], HELD)
    together = _held_together(kinks, signs, zero, at, forward, leaves)
    if together is None:
        raise _lost(kinks, zero, at, "several kinks hold the motion at once, and nothing tells which and how")
    return together


def _held_together(
    kinks: Kinks, signs: Signs, zero: Sequence[int], at: Place, forward: int, leaves: int | None
) -> Signs | None:
    """Return the regime in which some of several vanishing functions stay zero, and the others leave it.

    All are held at first, but for the one that leaves. Of those whose shares are beyond ±1 the farthest goes first.
    """
    held = [k for k in zero if k != leaves]
    sides = (1,) if leaves is None else (1, -1)
    for side in sides:
        each = signs if leaves is None else put(signs, leaves, side)
        for k in held:
            each = put(each, k, HELD)
        found = _relaxed(kinks, each, at)
        if found is not None and _consistent(
            kinks, found, [k for k in zero if found[k] != HELD], at, forward
        ):
            return found
    return None


def _relaxed(kinks: Kinks, signs: Signs, at: Place) -> Signs | None:
    """Return signs of which no held function has a share beyond ±1."""
    while held_in(signs):
        shares = kinks.shares(signs)
        if shares is None:
            return None
        values = at.values(kinks.system, [*shares.values()])
        k, share = max(zip(shares, values, strict=True), key=lambda pair: abs(pair[1]))
        if not math.isfinite(share):
            return None
        if abs(share) <= 1 + _ROUNDING:
            return signs
        signs = put(signs, k, 1 if share > 0 else -1)
    return signs


def _candidates(kinks: Kinks, signs: Signs, zero: Sequence[int], at: Place) -> Iterator[Signs]:
    """Return the signs around a zero; what mattered before keeps its sign, unless a function in it changes."""
    before = {k for k in kinks.mattering(signs) if k not in kinks.nested}
    for sides in itertools.product((1, -1), repeat=len(zero)):
        put = dict(zip(zero, sides, strict=True))
        each = tuple(put.get(k, sign) for k, sign in enumerate(signs))
        yield settled(kinks, each, before | {*zero}, at)


def _consistent(kinks: Kinks, signs: Signs, zero: Sequence[int], at: Place, forward: int) -> bool:
    """Return whether a regime's motion leaves every zero to the regime's own side, or stays on it."""
    regime = kinks.regime(signs)
    for k in zero:
        node = zero_node = kinks.folded(signs, [kinks.functions[k]])[0]
        for order in range(1, _DERIVATIVES + 1):
            node = regime.rate(node)
            value = at.value(regime.system, node)
            if order == 1 and not math.isfinite(
                value
            ):  # rounding is beyond a zero of |v|^(3/2): there both sides have one
                value = at.value(kinks.system, _rate_on_both_sides(kinks, k))
            if order == 1 and _only_touches(regime, zero_node, node, value, at):
                continue
            if not math.isfinite(value) or abs(value) <= _ROUNDING * at.size(regime.system, node):
                continue
            if (value > 0) != (signs[k] * forward**order > 0):
                return False
            break
    return True


def _rate_on_both_sides(kinks: Kinks, k: int) -> int:
    system, graph = kinks.system, kinks.system.graph
    slopes = graph.gradient(kinks.functions[k], system.inputs)
    rates = (*system.velocity, *system.force, graph.one)
    return graph.add([graph.mul(pair) for pair in zip(slopes, rates, strict=True)])


def _only_touches(regime: Regime, g: int, rate: int, speed: float, at: Place) -> bool:
    """Tell whether a motion turns round within rounding of a zero: g goes to ġ²/(2 |g̈|) beyond it."""
    turn = at.value(regime.system, regime.rate(rate))
    return math.isfinite(turn) and speed**2 <= 2 * abs(turn) * _TOUCH * at.size(regime.system, g)


def _rates(kinks: Kinks, signs: Signs, at: Place) -> list[float]:
    system = kinks.regime(signs).system
    return at.values(system, [*system.velocity, *system.force])


def _distance(a: Signs, b: Signs) -> int:
    return sum(x != y for x, y in zip(a, b, strict=True))


def _jump(kinks: Kinks, signs: Signs, beyond: Signs, at: Place) -> float:
    """Return by how much the energy would change, 0 where that is rounding or where no energy is known."""
    before, after = kinks.regime(signs).system, kinks.regime(beyond).system
    values = at.values(before, [before.hamiltonian, after.hamiltonian])
    change = values[1] - values[0]
    size = abs(values[0]) + abs(values[1]) + at.size(before, before.hamiltonian)
    return change if abs(change) > _JUMP * size else 0.0


def _refracted(kinks: Kinks, signs: Signs, beyond: Signs, k: int, jump: float, at: Place) -> Passage:
    before, after = kinks.regime(signs), kinks.regime(beyond)
    graph, q, p = before.system.graph, before.system.q, before.system.p
    wall = before.functions[k]
    normal_nodes = graph.gradient(wall, q)
    if not before.system.canonical and any(
        node != graph.zero for node in graph.gradient(wall, before.system.inputs[:-1])
    ):
        raise _lost(kinks, [k], at, "the potential jumps: give the system as a Hamiltonian, hamiltonian(L), which "
            "refracts and reflects there"
        )  # fmt: skip
    if any(node != graph.zero for node in graph.gradient(wall, p)):
        raise _lost(kinks, [k], at, "H jumps where a function of the momenta is zero, and no motion follows")
    normal = np.array(at.values(before.system, normal_nodes))
    if not normal.any():  # a switch in time
        return Passage(beyond)

    def across(system: HamiltonEquations) -> float:
        """Return ∇g·M⁻¹∇g, which differs on the two sides where the masses do."""
        inverse_mass = [at.values(system, graph.gradient(v, p)) for v in system.velocity]
        return float(normal @ np.array(inverse_mass) @ normal)

    speed, own = (at.value(r.system, r.rate(wall)) for r in (after, before))
    through = speed**2 - 2 * across(after.system) * jump
    if through > 0:
        along = (math.copysign(math.sqrt(through), own) - speed) / across(after.system)
        words, following = "is refracted", beyond
    else:
        along, words, following = -2 * own / across(before.system), "is reflected", signs
    n = len(q)
    y = at.y + at.carried
    y[n:] += along * normal
    return Passage(following, y, words)


def _lost(kinks: Kinks, zero: Sequence[int], at: Place, why: str) -> NonFiniteStateError:
    graph, y = kinks.system.graph, at.y[kinks.system.rows]
    where = ", ".join(f"{graph.to_sympy(kinks.functions[k])} = 0" for k in zero)
    return NonFiniteStateError(f"at {time_and_state(at.t, y)}, where {where}: {why}", at.t, y)
