"""Regimes of a motion with contacts: which were closed from when to when, and whether the motion keeps to them."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from sympy import Dummy

from canon.flow.equations.constrained.impacts_at_once import check_impacts_at_once
from canon.flow.run.non_finite_state import PiledUpError, time_and_state
from canon.flow.run.observables_along import AccuracyWarning, frames_of_canon

if TYPE_CHECKING:
    from canon.flow.equations.first_order_motion import Contact, Contacts, MovingSystem
    from canon.flow.run.samples import Samples

__all__ = ["ContactRegime", "check_contacts", "impacts_pile_up", "regimes_of", "seen_by_people"]

_FEWEST, _FASTER = 8, 1e-3
"""So many impacts, the last two nearer to one another by this factor than the first two, come to an end."""

_VIOLATED = 1e-6
"""In parts of the largest on the way: a force that pulls, or a way into a wall, by more is no rounding."""


@dataclass(frozen=True)
class ContactRegime:
    """One regime of a motion with unilateral constraints.

    Parameters
    ----------
    begin, end
        From when to when.
    closed
        The numbers of the contacts that are closed, counted from 1 in the order in which they are given.
    """

    begin: float
    end: float
    closed: tuple[int, ...]


def regimes_of(moving: MovingSystem, samples: Samples) -> tuple[ContactRegime, ...]:
    """Return which contacts were closed when; impacts after which none closes end no regime."""
    contacts = moving.contacts
    assert contacts is not None
    closed = {i for i, contact in enumerate(contacts.each, 1) if contact.closed}
    begin, made = float(samples.t[0]), list[ContactRegime]()
    for k, met in enumerate(samples.crossings):
        before = set(closed)
        for i, contact in enumerate(contacts.each, 1):
            if met.event.function == contact.opens.function:
                closed.discard(i)
            elif met.event.function == contact.lands.function and _closes(moving, contact, samples, k):
                closed.add(i)
        if closed != before:
            made.append(ContactRegime(begin, met.t, tuple(sorted(before))))
            begin = met.t
    return (*made, ContactRegime(begin, float(samples.t[-1]), tuple(sorted(closed))))


def _closes(moving: MovingSystem, contact: Contact, samples: Samples, k: int) -> bool:
    """Tell whether a contact is closed after its impact, by what comes next, or by the motion's last state."""
    action = samples.crossings[k].event.action
    if not isinstance(action, Mapping) or contact.switch not in action:
        return False
    for later in samples.crossings[k + 1 :]:
        if later.event.function == contact.opens.function:
            return True
        if later.event.function in (contact.parts.function, contact.lands.function):
            return False
    return bool(samples.y[moving.equations.q.index(contact.switch), -1, 0] > 0)


def seen_by_people(found: Samples) -> tuple[Any, ...]:
    """Return the events met, a tuple for each of many orbits, without those that only keep account of a contact."""
    if found.each:
        return tuple(map(seen_by_people, found.each))
    return tuple(
        met for met in found.crossings if met.event.name or not isinstance(met.event.function, Dummy)
    )


def check_contacts(moving: MovingSystem, samples: Samples) -> None:
    """Make sure that no contact pulls and none is passed, and tell of an impact that has ended the motion.

    Raises
    ------
    ArithmeticError
        One does: events were missed, as steps are too large.
    NonFiniteStateError
        Contacts are met at one instant and push at one another.

    Warns
    -----
    AccuracyWarning
        The motion has ended before its last time.
    """
    contacts = moving.contacts
    if contacts is None:
        return
    check_impacts_at_once(moving, samples)
    equations = moving.equations
    values = dict(zip(equations.inputs, (*samples.y[:, :, 0], samples.t), strict=True))
    graph, known = equations.graph, moving.state
    sizes = {s: np.abs(values[s]) for s in known}
    for s, v in zip(moving.q, moving.second, strict=True):
        # The places of all samples may be those of impacts, where only the way between them has a size.
        sizes[s] = sizes[s] + _VIOLATED * np.ptp(samples.t) * sizes[v]
    for contact in contacts.each:
        for node, words in (
            (contact.value, "passes a wall"),
            (contact.multiplier, "is held by a contact that pulls"),
        ):
            along, *slopes = (
                np.broadcast_to(np.asarray(x, dtype=np.float64), samples.t.shape)
                for x in graph.evaluate([node, *graph.gradient(node, known)], values)
            )
            size = sum((np.abs(a) * sizes[s] for a, s in zip(slopes, known, strict=True)), np.abs(along))
            wrong = along < -_VIOLATED * size.max()
            if wrong.any():
                first = float(samples.t[int(np.argmax(wrong))])
                _refuse_pile(contact, samples, first)
                raise ArithmeticError(
                    f"the motion {words}, {contact.words}, at t = {first:.9g}: an event was "
                    "missed or came together with another. Take smaller steps, or Taylor(), or start elsewhere"
                )
    _tell_of_end(contacts, samples)


def _refuse_pile(contact: Contact, samples: Samples, until: float) -> None:
    """Raise the error of impacts that pile up where those of a contact came ever faster before a time."""
    forward = 1 if samples.t[-1] > samples.t[0] else -1
    function = contact.lands.function
    met = [c for c in samples.crossings if c.event.function == function and (until - c.t) * forward > 0]
    if len(met) < _FEWEST or abs(met[-1].t - met[-2].t) > _FASTER * abs(met[1].t - met[0].t):
        return
    last = met[-1]
    raise impacts_pile_up(
        PiledUpError(
            f"{last.event} is met ever faster up to {time_and_state(last.t, last.y)}", last.t, last.y
        )
    )


def _tell_of_end(contacts: Contacts, samples: Samples) -> None:
    met = samples.crossings[-1] if samples.crossings else None
    if met is None or met.event.action != "stop" or not isinstance(met.event.function, Dummy):
        return
    if any(met.event.function == contact.lands.function for contact in contacts.each):
        advice = "UnilateralLagrangian(…, restitution=e), 0 where it stays in contact, goes on"
    else:
        advice = "go on from motion.final with the velocities after the impact"
    state = ", ".join(f"{x:.6g}" for x in met.y)
    warnings.warn(
        f"the motion ends at t = {met.t:.9g}, state ({state}): {met.event.name}; {advice}",
        AccuracyWarning,
        stacklevel=frames_of_canon(),
    )


def impacts_pile_up(lost: PiledUpError) -> PiledUpError:
    """Return the error of events that pile up with what to do about impacts."""
    return PiledUpError(
        f"{lost}. Impacts that lose energy come to an end in a finite time: end the span before, and go on from there "
        "with restitution=0",
        lost.time,
        lost.state,
    )
