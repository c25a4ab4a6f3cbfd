"""Systems that are no Hamiltonians as text: for study files, keys and workers.

What is read is made of the classes and operations listed here, by their fields: no text is evaluated.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import TYPE_CHECKING, Any, cast

from sympy import Expr, ImmutableDenseMatrix, Symbol

from canon.expression.symbols.expression_data import (
    expression_data,
    expression_from,
    symbol_data,
    symbol_from,
)
from canon.expression.symbols.input_in_words import module_of
from canon.flow.equations.listed_equations import heyoka_field, is_heyoka_system
from canon.flow.system.recognised_system import recognised
from canon.mechanics.hamilton.poisson_system import PoissonSystem
from canon.mechanics.hamilton.vector_field import VectorField
from canon.mechanics.lagrange.appell import GibbsAppell
from canon.mechanics.lagrange.body import Particle, PlanarBody, RigidBody
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.lagrange.newton_euler import Load, NewtonEuler
from canon.mechanics.lagrange.quasi_velocity import Kinematics
from canon.mechanics.lagrange.sympy_bridge import QuasiMotion, from_sympy_mechanics
from canon.mechanics.reduction.routh import Routhian
from canon.study.errors import StudyError
from canon.study.motion.hamiltonian_text import check_declared

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["SystemText", "system_in", "system_text"]

_CLASSES: dict[str, Any] = {
    each.__name__: each
    for each in (
        Lagrangian, ConstrainedLagrangian, Routhian, GibbsAppell, Kinematics, Particle, PlanarBody, RigidBody,
        NewtonEuler, Load, VectorField, QuasiMotion, PoissonSystem,
    )
}  # fmt: skip

_WITHOUT_ENERGY = ("VectorField", "QuasiMotion")


@dataclass(frozen=True)
class SystemText:
    """A system that is no Hamiltonian, written as data; nothing in it is executed.

    Parameters
    ----------
    name
        What it is called.
    written
        The system as JSON, as :func:`system_text` writes it.
    variables
        Names of the variables of its state, in their order.
    parameters
        Names and values of the constants.
    starts
        Names and states; the first is the default.
    period
        Period of a typical motion, None where none is known.
    """

    name: str
    written: str
    variables: tuple[str, ...]
    parameters: tuple[tuple[str, float], ...] = ()
    starts: tuple[tuple[str, tuple[float, ...]], ...] = ()
    period: float | None = None

    def __post_init__(self) -> None:
        check_declared(self.name, self.variables, self.parameters, self.starts, self.period)
        for name, state in self.starts:
            self.check(state, f"the start {name!r}")

    def check(self, state: Sequence[float], what: str) -> None:
        """Raise StudyError where a state has not a finite number for each variable."""
        if len(state) != len(self.variables) or not all(map(math.isfinite, state)):
            raise StudyError(
                f"{self.name}: {what} needs {len(self.variables)} finite numbers ({', '.join(self.variables)}), "
                f"not {list(state)}"
            )

    @property
    def has_energy(self) -> bool:
        """Whether an energy is known of the system."""
        return type(system_in(self)).__name__ not in _WITHOUT_ENERGY

    @property
    def is_constrained(self) -> bool:
        """Whether constraints act on it."""
        system = system_in(self)
        return isinstance(system, ConstrainedLagrangian) and bool(system.holonomic or system.nonholonomic)

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold of this system."""
        return {
            "name": self.name,
            "written": json.loads(self.written),
            "variables": list(self.variables),
            "parameters": dict(self.parameters),
            "starts": {name: list(state) for name, state in self.starts},
            "period": self.period,
        }

    @staticmethod
    def from_dict(given: Mapping[str, Any]) -> SystemText:
        """Return the system that :meth:`to_dict` wrote."""
        return SystemText(
            name=given["name"],
            written=json.dumps(given["written"]),
            variables=tuple(given["variables"]),
            parameters=tuple(given["parameters"].items()),
            starts=tuple((name, tuple(state)) for name, state in given["starts"].items()),
            period=given["period"],
        )


def system_text(
    system: Any,
    name: str | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    starts: Mapping[str, Sequence[float]] | None = None,
    period: float | None = None,
) -> SystemText:
    """Return a system as text that reads back as the same expressions.

    Parameters
    ----------
    system
        What :func:`canon.propagate` takes and is no Hamiltonian: a Lagrangian with forces and constraints, bodies, a
        vector field, SymPy's or heyoka's model.
    name, parameters, starts, period
        As :class:`SystemText` takes them; the name is that of the system's class where not given.

    Raises
    ------
    StudyError
        Where it holds something that files do not know.
    TypeError
        Where it is no system that moves.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, parameters
    >>> x, c = coordinates("x"), parameters("c", positive=True)
    >>> damped = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-c * x.dot])
    >>> text = system_text(damped, "damped", parameters={"c": 0.1})
    >>> text.variables, system_in(text) == damped
    (('x', 'x_dot'), True)
    """
    called = name or type(system).__name__
    if module_of(type(system)).startswith("sympy.physics.mechanics"):
        system = from_sympy_mechanics(system)
    if is_heyoka_system(system):
        called, system = name or "equations", heyoka_field(system)
    found = recognised(system)
    writer = _Writer()
    try:
        whole = writer.of(system)
        symbols = [symbol_data(each) for each in writer.symbols]
    except ValueError as error:
        raise StudyError(f"{called} can't be kept in a study's file: {error}") from error
    return SystemText(
        called,
        json.dumps({"system": whole, "symbols": symbols}),
        tuple(s.name for s in found.state),
        tuple((str(key), float(value)) for key, value in (parameters or {}).items()),
        tuple((key, tuple(map(float, state))) for key, state in (starts or {}).items()),
        period,
    )


@lru_cache(maxsize=64)
def system_in(text: SystemText) -> Any:
    """Return the system that was written as text.

    Raises
    ------
    StudyError
        Where :func:`system_text` did not write it.
    """
    try:
        data = json.loads(text.written)
        return _read(data["system"], [symbol_from(each) for each in data["symbols"]])
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise StudyError(f"{text.name}: its equations are not such as canon writes ({error})") from error


class _Writer:
    """Data of a system, its symbols numbered in the order in which they are met."""

    def __init__(self) -> None:
        self.symbols: dict[Symbol, int] = {}

    def of(self, value: Any) -> Any:
        if value is None or isinstance(value, str | int):
            return value
        if isinstance(value, Symbol):
            return {"symbol": self._number(value)}
        if isinstance(value, ImmutableDenseMatrix):  # which is an Expr too
            return {"matrix": [[self.of(each) for each in row] for row in cast("Any", value).tolist()]}
        if isinstance(value, Expr):
            return {"expression": expression_data(value, self._number)}
        if isinstance(value, tuple):
            return {"tuple": [self.of(each) for each in cast("tuple[Any, ...]", value)]}
        name = type(value).__name__
        if _CLASSES.get(name) is not type(value):
            raise ValueError(f"a {name} is nothing that files know")
        return {name: {each.name: self.of(getattr(value, each.name)) for each in fields(value)}}

    def _number(self, symbol: Symbol) -> int:
        return self.symbols.setdefault(symbol, len(self.symbols))


def _read(data: Any, symbols: list[Symbol]) -> Any:
    if data is None or isinstance(data, str | int):
        return data
    ((kind, inner),) = data.items()
    if kind == "symbol":
        return symbols[inner]
    if kind == "expression":
        return expression_from(inner, symbols)
    if kind == "matrix":
        return ImmutableDenseMatrix([[_read(each, symbols) for each in row] for row in inner])
    if kind == "tuple":
        return tuple(_read(each, symbols) for each in inner)
    made = object.__new__(_CLASSES[kind])
    for each in fields(made):
        object.__setattr__(made, each.name, _read(inner[each.name], symbols))
    return made
