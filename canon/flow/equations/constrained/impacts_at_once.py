"""Impacts at one instant that push at one another: Newton's restitution does not say what follows, and the motion ends.

Of two balls that strike a third from both sides at once, each changes the speed at which the other strikes. What
follows depends on which comes first, but where an impact leaves the rate of the other contact as it is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array
    from canon.flow.equations.first_order_motion import Contact, MovingSystem
    from canon.flow.run.event import Crossing
    from canon.flow.run.samples import Samples

__all__ = ["check_impacts_at_once"]

_TOUCHED = 2.0**-40
"""In parts of the size of its terms: a function that is smaller where another contact is met vanishes there too."""

_MOVING = 1e-9
"""In parts of the size of its terms: a rate that is smaller, or changes by less, is round-off."""


def check_impacts_at_once(moving: MovingSystem, samples: Samples) -> None:
    """Make sure that contacts that are met at one instant do not push at one another.

    Raises
    ------
    NonFiniteStateError
        They do: the motion is not determined beyond that instant.
    """
    assert moving.contacts is not None
    contacts, forward = moving.contacts.each, 1 if samples.t[-1] > samples.t[0] else -1
    for which, contact in enumerate(contacts):
        met = [c for c in samples.crossings if c.event.function == contact.lands.function]
        met = [c for c in met if c.after is not None]
        for other in contacts[:which] + contacts[which + 1 :]:
            for k in _pushed_while_closing(moving, other, met, forward):
                raise _undetermined((contact, other), met[k], moving)


def _pushed_while_closing(
    moving: MovingSystem, other: Contact, met: Sequence[Crossing], forward: int
) -> Sequence[int]:
    """Return at which impacts another contact is about to close too, and is pushed at."""
    if not met:
        return ()
    after = [c.after for c in met if c.after is not None]
    t = np.array([c.t for c in met])
    before, then = (_value_and_rate(moving, other, np.array(y).T, t) for y in ([c.y for c in met], after))
    (f, rate, f_size, rate_size), (_, new_rate, _, new_size) = before, then
    closes = (np.abs(f) <= _TOUCHED * f_size) & (forward * rate < -_MOVING * rate_size)
    pushed = np.abs(new_rate - rate) > _MOVING * np.maximum(rate_size, new_size)
    return [int(k) for k in np.flatnonzero(closes & pushed)]


def _value_and_rate(
    moving: MovingSystem, contact: Contact, y: Array, t: Array
) -> tuple[Array, Array, Array, Array]:
    """Return f, ḟ and the sizes of their terms at states of shape (variables, times)."""
    graph, values = moving.equations.graph, dict(zip(moving.state, y, strict=True))
    time = moving.equations.t
    slopes = [*graph.gradient(contact.value, moving.q), graph.derivative(contact.value, time)]
    found = graph.evaluate([contact.value, *slopes, *moving.velocities], {**values, time: t})
    f, *rest = (np.broadcast_to(np.asarray(x, dtype=np.float64), t.shape) for x in found)
    n = len(moving.q)
    terms = np.array([*(a * v for a, v in zip(rest, rest[n + 1 :], strict=False)), rest[n]])
    size = np.abs(f) + sum(np.abs(a * values[s]) for a, s in zip(rest, moving.q, strict=False))
    return f, terms.sum(axis=0), size, np.abs(terms).sum(axis=0)


def _undetermined(both: tuple[Contact, Contact], met: Crossing, moving: MovingSystem) -> NonFiniteStateError:
    first, second = sorted(both, key=lambda contact: contact.words)
    where = time_and_state(met.t, met.y, [s.name for s in moving.state])
    return NonFiniteStateError(
        f"the contacts at {first.words} and at {second.words} are met at one instant, {where}. Each impact changes the "
        "speed of the other, and what follows depends on which comes first, which neither the system nor Newton's "
        "restitution says. End the span before, or start a little beside so that one comes first; or leave out one of "
        "the two contacts",
        met.t,
        met.y,
    )
