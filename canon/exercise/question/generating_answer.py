"""Generating function, the right one, of a map that a claim gives."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from canon.exercise.question.deadline import PROOF_SECONDS, unless_spent
from canon.mechanics.canonical.find_generating_function import SOLVING_SHARE, generating_function
from canon.mechanics.canonical.generating_function import GeneratingFunction
from canon.mechanics.canonical.transformation import CanonicalTransformation

if TYPE_CHECKING:
    from sympy import Expr

    from canon.exercise.sheet.reading import Reading

__all__ = ["generating_function_of"]

_BUDGET = PROOF_SECONDS / SOLVING_SHARE
"""Seconds of which the last safety of one proof is for solving the map."""
_OF_INVERSE = {1: 1, 2: 3, 3: 2, 4: 4}
"""Type of the generating function −F of the inverse map, where old and new variables change places."""


def generating_function_of(reading: Reading, kind: int) -> Expr | None:
    """Return F of a type for the claimed map; whoever tells it proves it first.

    Raises
    ------
    ValueError
        Where the map has no generating function of this type.
    BudgetSpent
        Where the seconds ended the search for its closed form.
    """
    start = time.monotonic()
    q, p, Q, P = (reading.symbols(key) for key in ("q", "p", "new_q", "new_p"))
    if reading.has("map"):
        new_q, new_p = reading.lists("map", {"Q": "new_q", "P": "new_p"})
        map_ = CanonicalTransformation(q, p, new_q, new_p, reading.domain, reading.time)
        found, sign = generating_function(map_, kind, Q, P, budget=_BUDGET), 1
    else:
        old_q, old_p = reading.lists("inverse_map", {"q": "q", "p": "p"})
        map_ = CanonicalTransformation(Q, P, old_q, old_p, reading.domain, reading.time)
        found, sign = generating_function(map_, _OF_INVERSE[kind], q, p, budget=_BUDGET), -1
    F = sign * found.F if isinstance(found, GeneratingFunction) else None
    return unless_spent(F, start, PROOF_SECONDS)
