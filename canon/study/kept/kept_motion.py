"""Kept motion: the samples of a case's run, gathered part by part as exact text, and given to functions at its end."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.array import Array

__all__ = ["KeptMotion", "joined_rows", "rows_as_text"]


@dataclass(frozen=True)
class KeptMotion:
    """Motion of a case at the samples that its energy error is judged by.

    Parameters
    ----------
    system
        What the system is called.
    parameters
        The value of every parameter by name.
    variables
        Names of the variables of the state.
    t
        Times, shape (times,).
    y
        The state, shape (variables, times), in doubles.
    energy_change
        H − H(start), less the work done from outside, shape (times,).

    Examples
    --------
    >>> motion = KeptMotion("free", {"m": 1.0}, ("x", "p_x"), *map(np.array, ([0.0, 1.0], [[0, 2], [2, 2]], [0, 0])))
    >>> motion["x"].tolist(), motion["t"].tolist()
    ([0, 2], [0.0, 1.0])
    """

    system: str
    parameters: Mapping[str, float]
    variables: tuple[str, ...]
    t: Array
    y: Array
    energy_change: Array

    def __repr__(self) -> str:
        return f"<KeptMotion: {self.system}; {', '.join(self.variables)} at {len(self.t)} times>"

    def __getitem__(self, name: str) -> Array:
        """Return a variable of the state, ``"t"`` or ``"energy_change"``, shape (times,).

        Raises
        ------
        KeyError
            Nothing is called so.
        """
        try:
            return self.arrays[name]
        except KeyError:
            raise KeyError(f"the motion has no {name!r}; there are {', '.join(self.arrays)}") from None

    @property
    def arrays(self) -> dict[str, Array]:
        """All of it by name."""
        state = dict(zip(self.variables, self.y, strict=True))
        return {"t": self.t, **state, "energy_change": self.energy_change}


def rows_as_text(rows: Array) -> str:
    """Return numbers as text that has every bit of them.

    Examples
    --------
    >>> joined_rows([rows_as_text(np.array([[0.1], [2.0]])), rows_as_text(np.array([[0.3], [4.0]]))], 2).tolist()
    [[0.1, 0.3], [2.0, 4.0]]
    """
    return base64.b64encode(np.ascontiguousarray(rows, dtype="<f8").tobytes()).decode("ascii")


def joined_rows(texts: Sequence[str], count: int) -> Array:
    """Return so many rows of numbers, of which :func:`rows_as_text` made texts piece by piece."""
    pieces = [np.frombuffer(base64.b64decode(text), dtype="<f8").reshape(count, -1) for text in texts]
    return np.concatenate([np.empty((count, 0)), *pieces], axis=1)
