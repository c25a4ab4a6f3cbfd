"""Other claims of the same formulas that may have been meant: another type, variables exchanged, the inverse map."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.reading import Reading
from canon.mechanics.algebra.substitution import exchanged

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

__all__ = [
    "exchanged_equations",
    "exchanged_map",
    "inverse_map",
    "other_convention",
    "other_type",
    "read_anew",
    "same_equations_of_motion",
]

Trial: TypeAlias = "tuple[Reading, Change]"
"""Another claim, and what is wrong with the one that was made where it holds."""


def read_anew(reading: Reading, keys: Mapping[str, Any], kind: str = "") -> Reading:
    """Return a claim with other keys, or of another kind."""
    kind = kind or reading.claim.kind
    return Reading(replace(reading.claim, kind=kind, keys=MappingProxyType(dict(keys))))


def inverse_map(reading: Reading) -> Iterator[Trial]:
    """Yield the claim with its map read as giving the old variables by the new ones."""
    if not reading.has("map"):
        return
    keys = {key: value for key, value in reading.claim.keys.items() if key != "map"}
    symbols = [reading.symbols(key) for key in ("q", "p", "new_q", "new_p")]
    swap = dict(zip((*symbols[0], *symbols[1]), (*symbols[2], *symbols[3]), strict=True))
    inverted = read_anew(reading, {**keys, "inverse_map": {k: ["0"] * len(symbols[0]) for k in "qp"}})
    for part, name in (("Q", "q"), ("P", "p")):
        for i, f in enumerate(reading.inside(f"map.{part}", reading.claim.keys["map"][part])):
            inverted = inverted.with_instead(f"inverse_map.{name}[{i}]", exchanged(f, swap))
    yield inverted, Change.of(Mistake.INVERSE_MAP)


def exchanged_map(reading: Reading) -> Iterator[Trial]:
    """Yield the claim with Q and P exchanged in the map."""
    if reading.has("map"):
        given = reading.claim.keys["map"]
        exchanged = {"Q": given.get("P"), "P": given.get("Q")}
        trial = read_anew(reading, {**reading.claim.keys, "map": exchanged})
        yield trial, Change.of(Mistake.MAP_EXCHANGED)


def other_type(reading: Reading) -> Iterator[Trial]:
    """Yield the claim with F as a generating function of each other type."""
    own = reading.kind.implied["type"]
    for name, kind in KINDS.items():
        number = kind.implied.get("type", own)
        if number != own:
            yield read_anew(reading, reading.claim.keys, name), Change.of(Mistake.OTHER_TYPE, number, own)


def exchanged_equations(reading: Reading) -> Iterator[Trial]:
    """Yield the claim with the rates of the coordinates and of the momenta exchanged."""
    keys = reading.claim.keys
    if reading.has("q_dot"):
        exchanged = {"q_dot": keys["p_dot"], "p_dot": keys["q_dot"]}
        yield read_anew(reading, {**keys, **exchanged}), Change.of(Mistake.EQUATIONS_EXCHANGED)


def same_equations_of_motion(reading: Reading) -> Iterator[Trial]:
    """Yield the claim that two Lagrangians have the same equations, where they are said to differ by dF/dt."""
    if reading.word("relation") == "gauge" and not reading.has("F"):
        trial = read_anew(reading, {**reading.claim.keys, "relation": "equations"})
        yield trial, Change.of(Mistake.ONLY_EQUATIONS)


def other_convention(reading: Reading) -> Iterator[Trial]:
    """Yield the claim with the Routhian of the other sign."""
    other = {"L-pq": "pq-L", "pq-L": "L-pq"}[reading.word("convention")]
    trial = read_anew(reading, {**reading.claim.keys, "convention": other})
    yield trial, Change.of(Mistake.OTHER_ROUTHIAN, other)
