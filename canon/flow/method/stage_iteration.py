"""Iterations by which implicit methods find their stages, by name."""

from __future__ import annotations

__all__ = ["ITERATIONS", "check_iteration"]

ITERATIONS = "fixed-point", "newton"
"""The usual one first."""


def check_iteration(name: str) -> None:
    """Refuse what is none of them.

    Raises
    ------
    ValueError
        Where it is not.
    """
    if name not in ITERATIONS:
        raise ValueError(f"iteration={name!r}: there are {' and '.join(map(repr, ITERATIONS))}")
