"""Non-finite states: the error raised where a motion leaves the finite numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from canon.array import Array

__all__ = ["NonFiniteStateError", "PiledUpError", "time_and_state"]


class NonFiniteStateError(ArithmeticError):
    """Raised where a motion leaves the finite numbers: a collision, the edge of a domain, or a step too large.

    Parameters
    ----------
    time
        The time of the last finite state.
    state
        That state (q, p), shape (2n,).
    """

    def __init__(self, message: str, time: float, state: Array) -> None:
        super().__init__(message)
        self.time = time
        self.state = state


class PiledUpError(NonFiniteStateError):
    """Raised where events that change the state come ever faster, so that the motion does not get beyond them."""


def time_and_state(t: float, state: Array) -> str:
    """Return a time and a state in words."""
    shown = ", ".join(f"{x:.6g}" for x in state[:8]) + (", …" if len(state) > 8 else "")
    return f"t = {t:.9g} where (q, p) = ({shown})"
