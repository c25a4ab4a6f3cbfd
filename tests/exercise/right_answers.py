"""Right answers of every kind, each with the place where it stands and two variables to spoil it with.

Beside them questions with answers, written by hand, that say nothing, copy the question or contradict themselves.
"""

import json
from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

__all__ = ["EMPTY", "RIGHT", "Empty", "Right", "with_kappa"]

_DATA = Path(__file__).parents[1] / "data"


def with_kappa(keys: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a claim with one more parameter, which a student may write down."""
    return {**keys, "parameters": {"kappa": "real", **keys.get("parameters", {})}}


@dataclass(frozen=True)
class Right:
    """A claim that holds, and one answer in it.

    ``place`` says where the answer stands. ``u`` and ``v`` are variables that it may hold, in the plain language and in
    LaTeX; ``u`` takes values of both signs. ``role`` says what it is: a value, an equation, a constant of the motion, …
    ``frame`` is what stands around the part that is spoilt, where an answer must be linear in differentials.
    """

    kind: str
    keys: Mapping[str, Any]
    place: tuple[int | str, ...]
    latex: str
    u: tuple[str, str]
    v: tuple[str, str]
    role: str = "value"
    frame: tuple[str, str] = ("{}", "{}")

    @property
    def name(self) -> str:
        return f"{self.kind}:{'.'.join(map(str, self.place))}"

    @property
    def answer(self) -> str:
        found: Any = self.keys
        for step in self.place:
            found = found[step]
        before, after = self.frame[0].split("{}")
        return found.removeprefix(before).removesuffix(after)

    def with_answer(self, answer: str) -> dict[str, Any]:
        """Return the keys of the claim with this answer in place of the right one."""
        keys = deepcopy(with_kappa(self.keys))
        found: Any = keys
        for step in self.place[:-1]:
            found = found[step]
        found[self.place[-1]] = answer
        return keys


@dataclass(frozen=True)
class Empty:
    """A question, answers to it that are worth nothing, and answers near them that hold."""

    kind: str
    question: Mapping[str, Any]
    worthless: tuple[Mapping[str, Any], ...]
    right: tuple[Mapping[str, Any], ...]


def _read(name: str) -> list[dict[str, Any]]:
    return json.loads((_DATA / f"{name}.json").read_text("utf-8"))


RIGHT = tuple(
    Right(**{key: tuple(value) if isinstance(value, list) else value for key, value in row.items()})
    for row in _read("right_answers")
)
EMPTY = tuple(
    Empty(row["kind"], row["question"], tuple(row["worthless"]), tuple(row["right"]))
    for row in _read("empty_answers")
)
