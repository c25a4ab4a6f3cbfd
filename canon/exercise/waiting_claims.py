"""Claims that wait for a process: each goes, if it may, to one that has judged its question before.

Such a process keeps what it derived and what it said of the same wrong answer of another person, so that a class costs
little more with several processes than with one.
"""

from __future__ import annotations

import json
import threading
from itertools import islice
from typing import TYPE_CHECKING

from canon.exercise.sheet.kinds import KINDS

if TYPE_CHECKING:
    from collections.abc import Hashable, Mapping

    from canon.exercise.sheet.sheet import Claim

__all__ = ["OWN_KEYS", "WaitingClaims", "question_of"]

OWN_KEYS = frozenset(("id", "title", "source", "expect"))
"""Keys that say nothing about mechanics."""
AHEAD = 100
"""Claims among which one is chosen, so that the first of a long list is not judged last."""


class WaitingClaims:
    """Claims in their order, from which any thread takes the next one.

    Parameters
    ----------
    claims
        The claims that wait, each under a key.

    Examples
    --------
    >>> from canon.exercise.sheet.sheet import Claim
    >>> texts = {"a": ("sin(2*x)", "1"), "b": ("cos(2*x)", "2"), "c": ("sin(2*x)", "3"), "d": ("cos(2*x)", "4")}
    >>> waiting = WaitingClaims(
    ...     {id: Claim(id, "equality-only", {"lhs": lhs, "rhs": rhs}) for id, (lhs, rhs) in texts.items()}
    ... )
    >>> [waiting.next_for(worker)[0] for worker in ("first", "second", "second", "first")]
    ['a', 'b', 'd', 'c']
    """

    def __init__(self, claims: Mapping[str, Claim]) -> None:
        self._waiting = {key: (claim, question_of(claim)) for key, claim in claims.items()}
        self._asked: dict[str, Hashable] = {}
        self._lock = threading.Lock()

    def next_for(self, worker: Hashable) -> tuple[str, Claim]:
        """Return the next claim that a worker should judge, with its key.

        It is the first whose question was asked of no other worker, or else the first of all; the question is this
        worker's from then on, so that none is without work.
        """
        with self._lock:
            near = list(islice(self._waiting.items(), AHEAD))
            key = next(
                (key for key, (_, question) in near if self._asked.get(question, worker) is worker),
                near[0][0],
            )
            claim, question = self._waiting.pop(key)
            self._asked[question] = worker
            return key, claim


def question_of(claim: Claim) -> str:
    """Return everything in a claim but its answer, as text.

    Examples
    --------
    >>> from canon.exercise.sheet.sheet import Claim
    >>> question_of(Claim("a", "equality-only", {"lhs": "sin(2*x)", "rhs": "2*sin(x)"}))
    '["equality-only", {"lhs": "sin(2*x)"}]'
    """
    kind = KINDS.get(claim.kind)
    passed = OWN_KEYS if kind is None else OWN_KEYS.union(kind.answer)
    keys = {key: value for key, value in claim.keys.items() if key not in passed}
    return json.dumps([claim.kind, keys], sort_keys=True, default=str)
