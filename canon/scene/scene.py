"""A scene: a ready mechanical system as plain data, its symbols and functions built when asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    import numpy as np
    from numpy.typing import NDArray
    from sympy import Expr, Symbol

    from canon.expression.symbol import Coordinate
    from canon.mechanics.hamiltonian import Hamiltonian
    from canon.mechanics.lagrangian import Lagrangian

__all__ = ["Integral", "Parameter", "Scene", "SceneError", "Start", "near"]


class SceneError(ValueError):
    """A scene, parameter or start that does not exist, or a value that makes no sense."""


@dataclass(frozen=True)
class Parameter:
    """A constant of a scene.

    Parameters
    ----------
    name, value, unit, meaning
        As one would write them under a figure; ``unit`` is empty for a pure number.
    sign
        ``positive``, ``nonnegative`` or ``real``: what it may be.
    """

    name: str
    value: float
    unit: str
    meaning: str
    sign: str = "positive"

    def __post_init__(self) -> None:
        if not math.isfinite(self.value):
            raise SceneError(f"{self.name} = {self.value} is not a finite number")
        wrong = {"positive": self.value <= 0.0, "nonnegative": self.value < 0.0, "real": False}[self.sign]
        if wrong:
            raise SceneError(
                f"{self.name} = {self.value:g} makes no sense: {self.meaning} must be {self.sign}"
            )


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
    """

    name: str
    about: str
    q: tuple[float, ...]
    v: tuple[float, ...] | None = None
    p: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if (self.v is None) == (self.p is None):
            raise SceneError(f"the start {self.name!r} needs velocities or momenta, and not both")
        given = (*self.q, *(self.v or self.p or ()))
        if len(given) != 2 * len(self.q) or not all(map(math.isfinite, given)):
            raise SceneError(f"the start {self.name!r} needs {2 * len(self.q)} finite numbers, not {given}")


@dataclass(frozen=True)
class Integral:
    """A known constant of the motion as a function of q and p."""

    name: str
    build: Callable[[SimpleNamespace], Expr]


@dataclass(frozen=True)
class Scene:
    """A mechanical system that is ready to be derived, judged, run and looked at.

    A scene is plain data: no symbol is made and nothing is derived before it is asked for.

    Parameters
    ----------
    name, title
        The name one calls it by, and one line that says what it is.
    coordinates
        Names of the generalized coordinates, separated by spaces.
    parameters
        Its constants with default values.
    starts
        Initial states; the first one is the default.
    time_scale
        Period of a typical motion as a function of the values of the parameters by name.
    time_unit
        Unit of time, empty in dimensionless scenes.
    source
        Where the system and its numbers come from.
    L_of, H_of
        The Lagrangian or the Hamiltonian as a function of the symbols by name; one of them suffices.
    integrals
        Known constants of the motion beside the energy.

    Examples
    --------
    >>> from canon.scene import find
    >>> pendulum = find("simple-pendulum")
    >>> pendulum.hamiltonian.q_dot
    (p_theta/(l**2*m),)
    >>> pendulum.with_parameters(l=2.0).values["l"]
    2.0
    """

    name: str
    title: str
    coordinates: str
    parameters: tuple[Parameter, ...]
    starts: tuple[Start, ...]
    time_scale: Callable[[Mapping[str, float]], float]
    time_unit: str
    source: str
    L_of: Callable[[SimpleNamespace], Expr] | None = None
    H_of: Callable[[SimpleNamespace], Expr] | None = None
    integrals: tuple[Integral, ...] = ()

    @cached_property
    def q(self) -> tuple[Coordinate, ...]:
        """The coordinates as symbols."""
        from canon.expression.symbol import coordinates

        return coordinates(self.coordinates)

    @cached_property
    def p(self) -> tuple[Symbol, ...]:
        """The momenta as symbols."""
        return tuple(q.momentum for q in self.q)

    @cached_property
    def symbols(self) -> SimpleNamespace:
        """Coordinates and parameters as symbols, by name."""
        from canon.expression.symbol import parameters

        constants = [parameters(c.name, **{c.sign: True})[0] for c in self.parameters]
        return SimpleNamespace(**{s.name: s for s in (*self.q, *constants)})

    @cached_property
    def lagrangian(self) -> Lagrangian:
        """The Lagrangian."""
        if self.L_of is None:
            return self.hamiltonian.lagrangian()
        from canon.mechanics.lagrangian import Lagrangian

        return Lagrangian(self.L_of(self.symbols), self.q)

    @cached_property
    def hamiltonian(self) -> Hamiltonian:
        """The Hamiltonian."""
        if self.H_of is None:
            return self.lagrangian.hamiltonian(self.p)
        from canon.mechanics.hamiltonian import Hamiltonian

        return Hamiltonian(self.H_of(self.symbols), self.q, self.p)

    @property
    def values(self) -> dict[str, float]:
        """The values of the parameters by name."""
        return {c.name: c.value for c in self.parameters}

    @property
    def period(self) -> float:
        """Period of a typical motion, with the present values of the parameters."""
        return self.time_scale(self.values)

    def values_by_symbol(self) -> dict[Symbol, float]:
        """Return the values of the parameters by symbol, the way ``propagate`` takes them."""
        return {getattr(self.symbols, c.name): c.value for c in self.parameters}

    def constants(self) -> dict[str, Expr]:
        """Return the known constants of the motion beside the energy, as functions of q and p."""
        return {integral.name: integral.build(self.symbols) for integral in self.integrals}

    def with_parameters(self, **values: float) -> Scene:
        """Return the scene with other values of some parameters.

        Raises
        ------
        SceneError
            Where a parameter does not exist or a value makes no sense.
        """
        known = [c.name for c in self.parameters]
        for name in values:
            if name not in known:
                raise SceneError(f"{self.name} has no parameter {name!r}{near(name, known)}")
        changed = tuple(
            replace(c, value=float(values[c.name])) if c.name in values else c for c in self.parameters
        )
        return replace(self, parameters=changed)

    def start(self, name: str | None = None) -> Start:
        """Return the start of that name, or the default one."""
        if name is None:
            return self.starts[0]
        for start in self.starts:
            if start.name == name:
                return start
        raise SceneError(f"{self.name} has no start {name!r}{near(name, [s.name for s in self.starts])}")

    def state(self, start: str | Start | None = None) -> NDArray[np.float64]:
        """Return an initial state (q, p), shape (2n,); velocities become momenta by p = ∂L/∂q̇."""
        import numpy as np

        chosen = start if isinstance(start, Start) else self.start(start)
        if chosen.p is not None:
            return np.array([*chosen.q, *chosen.p])
        from sympy import Float

        from canon.mechanics.substitution import exchanged

        lagrangian = self.lagrangian
        known = {
            **self.values_by_symbol(),
            **dict(zip(self.q, chosen.q, strict=True)),
            **dict(zip(lagrangian.velocities, chosen.v or (), strict=True)),
        }
        at = {symbol: Float(value) for symbol, value in known.items()}
        return np.array([*chosen.q, *(float(exchanged(p, at)) for p in lagrangian.momenta)])


def near(name: str, known: Iterable[str]) -> str:
    """Return the end of an error message that names what may have been meant."""
    choices = list(known)
    close = get_close_matches(name, choices, n=3, cutoff=0.4)
    if close:
        return f"; did you mean {' or '.join(close)}?"
    return f"; there is {', '.join(choices)}" if choices else "; it has none"
