"""Non-finite states: the error raised where a motion leaves the finite numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array

__all__ = ["NonFiniteStateError", "PiledUpError", "named", "time_and_state"]


class NonFiniteStateError(ArithmeticError):
    """Raised where a motion leaves the finite numbers: a collision, the edge of a domain, or a step too large.

    Parameters
    ----------
    time
        The time of the last finite state.
    state
        That state, shape (2n,): (q, p) of a Hamiltonian, of other systems their variables in order.
    """

    def __init__(self, message: str, time: float, state: Array) -> None:
        super().__init__(message)
        self.time = time
        self.state = state

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes this error again, in another process too."""
        return type(self), (str(self), self.time, self.state)


class PiledUpError(NonFiniteStateError):
    """Raised where events that change the state come ever faster, so that the motion does not get beyond them."""


_SHOWN = 8
"""Numbers of a state that are told."""


def time_and_state(t: float, state: Array, variables: Sequence[str] = ("q", "p")) -> str:
    """Return a time and a state in words; ``variables`` are what to call the state."""
    more = ", …" if len(state) > _SHOWN else ""
    shown = ", ".join(f"{x:.6g}" for x in state[:_SHOWN]) + more
    called = ", ".join(variables[:_SHOWN]) + (more if len(variables) > _SHOWN else "")
    return f"t = {t:.9g} where ({called}) = ({shown})"


def named(lost: NonFiniteStateError, variables: Sequence[str]) -> NonFiniteStateError:
    """Return the same error, which calls the state by its own variables instead of (q, p).

    Examples
    --------
    >>> import numpy as np
    >>> y = np.array([1.0, -2.0])
    >>> named(NonFiniteStateError(f"lost at {time_and_state(3.0, y)}", 3.0, y), ["x", "x_dot"])
    NonFiniteStateError('lost at t = 3 where (x, x_dot) = (1, -2)')
    """
    said = str(lost).replace(
        time_and_state(lost.time, lost.state), time_and_state(lost.time, lost.state, variables)
    )
    return type(lost)(said, lost.time, lost.state)
