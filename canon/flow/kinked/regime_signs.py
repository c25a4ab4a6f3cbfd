"""Signs of switching functions, which tell the regimes of equations with kinks apart."""

from __future__ import annotations

__all__ = ["HELD", "Signs", "flipped", "held_in", "put"]

Signs = tuple[int, ...]
"""1 or −1 for each switching function; :data:`HELD` for one that stays zero."""

HELD = 0
"""In place of a sign: the motion stays on the zero, as a block that sticks."""


def held_in(signs: Signs) -> list[int]:
    """Return the switching functions that stay zero."""
    return [k for k, sign in enumerate(signs) if sign == HELD]


def put(signs: Signs, k: int, sign: int) -> Signs:
    """Return the signs with one of them given.

    Examples
    --------
    >>> put((1, -1, 1), 1, HELD)
    (1, 0, 1)
    """
    return (*signs[:k], sign, *signs[k + 1 :])


def flipped(signs: Signs, k: int) -> Signs:
    """Return the signs with one of them changed."""
    return put(signs, k, -signs[k])
