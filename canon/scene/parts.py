"""Parts of a scene: parameters, starts, known integrals, and motions known beforehand."""

from __future__ import annotations

import math
from dataclasses import dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from types import SimpleNamespace

    import numpy as np
    from numpy.typing import NDArray
    from sympy import Expr, Symbol

    Build = Callable[[SimpleNamespace], Expr]

__all__ = ["Condition", "Integral", "Parameter", "SceneError", "Solution", "Start", "multiplier", "near"]


class SceneError(ValueError):
    """Raised for a scene, parameter or start that does not exist, or a value that makes no sense."""


@dataclass(frozen=True)
class Parameter:
    """A constant of a scene.

    Parameters
    ----------
    name, value, unit, meaning
        As one would write them under a figure; ``unit`` is empty for a pure number.
    sign
        ``positive``, ``nonnegative`` or ``real``: what it may be.
    least, most
        The smallest and the largest value that make sense.
    """

    name: str
    value: float
    unit: str
    meaning: str
    sign: str = "positive"
    most: float = math.inf
    least: float = -math.inf

    def __post_init__(self) -> None:
        if not math.isfinite(self.value):
            raise SceneError(f"{self.name} = {self.value} is not a finite number")
        wrong = {"positive": self.value <= 0.0, "nonnegative": self.value < 0.0, "real": False}[self.sign]
        if wrong:
            raise SceneError(
                f"{self.name} = {self.value:g} makes no sense: {self.meaning} must be {self.sign}"
            )
        if self.value < self.least:
            raise SceneError(
                f"{self.name} = {self.value:g} makes no sense: {self.meaning} is at least {self.least:g}"
            )
        if self.value > self.most:
            raise SceneError(
                f"{self.name} = {self.value:g} makes no sense: {self.meaning} is at most {self.most:g}"
            )


@dataclass(frozen=True)
class Condition:
    """What several parameters must satisfy together.

    Parameters
    ----------
    about
        In words, what and why.
    met
        Tells whether values of the parameters, by name, satisfy it.
    """

    about: str
    met: Callable[[Mapping[str, float]], bool]


@dataclass(frozen=True)
class Start:
    """An initial state with a name.

    Parameters
    ----------
    name, about
        Its name, and in words what it shows.
    q
        Coordinates.
    v, p
        Either the velocities or the momenta.
    made_for
        Parameters, separated by spaces, whose given values it was made for: where one is changed, motions known
        from this start are known no more.
    """

    name: str
    about: str
    q: tuple[float, ...]
    v: tuple[float, ...] | None = None
    p: tuple[float, ...] | None = None
    made_for: str = ""

    def __post_init__(self) -> None:
        if (self.v is None) == (self.p is None):
            raise SceneError(f"the start {self.name!r} needs velocities or momenta, and not both")
        given = (*self.q, *(self.v or self.p or ()))
        if len(given) != 2 * len(self.q) or not all(map(math.isfinite, given)):
            raise SceneError(f"the start {self.name!r} needs {2 * len(self.q)} finite numbers, not {given}")


@dataclass(frozen=True)
class Integral:
    """A known constant of the motion.

    Parameters
    ----------
    name
        What it is called.
    build
        The integral as a function of the symbols: q, p = ∂L/∂q̇ (``s.x.momentum``), in scenes with a
        Lagrangian also q̇ (``s.x.dot``), and t.
    bound
        What its relative change along a run up to the scene's horizon stays below.
    why
        Why the bound is larger than 1e-13, where it is.
    """

    name: str
    build: Build
    bound: float = 1e-13
    why: str = ""


@dataclass(frozen=True)
class Solution:
    """A motion known beforehand, in closed form or as published: one quantity as a function of time.

    Parameters
    ----------
    name
        What is known.
    start
        The start it belongs to.
    quantity
        The quantity as a function of the symbols, as for :class:`Integral`.
    value
        What it should be: a function of the values of the parameters by name and of an array of times.
    bound
        How far it may be from that, relative to the quantity's largest value.
    periods
        For how many periods it is followed.
    samples
        At how many evenly spaced instants it is looked at; with 1 only at the end.
    source
        Where it is from, if not from the scene's source.
    event
        Instead of evenly spaced instants: the first instant after the start at which this function of the
        symbols vanishes.
    condition
        What the parameters must satisfy, where it is not known for all of them.
    """

    name: str
    start: str
    quantity: Build
    value: Callable[[Mapping[str, float], NDArray[np.float64]], NDArray[np.float64] | float]
    bound: float = 1e-12
    periods: float = 10.0
    samples: int = 200
    source: str = ""
    event: Build | None = None
    condition: Condition | None = None


def multiplier(number: int = 1) -> Symbol:
    """Return the symbol of a constraint's multiplier, for quantities and events; holonomic constraints come first.

    Examples
    --------
    >>> multiplier(2)
    lambda2
    """
    from canon.expression.symbols.symbol import parameters

    return parameters(f"lambda{number}")


def near(name: str, known: Iterable[str]) -> str:
    """Return the end of an error message that names what may have been meant."""
    choices = list(known)
    close = get_close_matches(name, choices, n=3, cutoff=0.4)
    if close:
        return f"; did you mean {' or '.join(close)}?"
    return f"; there is {', '.join(choices)}" if choices else "; it has none"
