"""Records of runs as plain data, for files: numbers exactly, values by the names of their classes, no code.

Only the classes listed here are written and made again. A graph keeps the numbers of its nodes, so that what is
compiled of it is the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from fractions import Fraction
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from sympy import Expr, Symbol

from canon.expression.graph.graph import Graph
from canon.expression.graph.graph_data import graph_data, graph_from
from canon.expression.symbols.expression_data import (
    expression_data,
    expression_from,
    symbol_data,
    symbol_from,
)
from canon.flow.equations.first_order_motion import Contact, Contacts, MovingSystem, Residual
from canon.flow.fixed_step.partial_step import LoopState
from canon.flow.method.adaptive_methods import DOP853, Taylor
from canon.flow.method.constrained_method import NonholonomicLeapfrog, Rattle
from canon.flow.method.energy_keeping_method import AverageVectorField
from canon.flow.method.lie_poisson_splitting import LiePoissonSplitting
from canon.flow.method.magnetic_methods import Boris, MagneticSplitting
from canon.flow.method.method import RK4, Gauss, Splitting, TimeTransformed
from canon.flow.method.nonseparable_splitting import ExtendedPhaseSpace, SemiexplicitSplitting
from canon.flow.method.solvable_splitting import SABA, SBAB, SolvableSplitting, WisdomHolman
from canon.flow.method.variational_method import GalerkinVariational
from canon.flow.run.event import Crossing, Event
from canon.flow.run.samples import Samples
from canon.flow.run.sampling_plan import Plan
from canon.flow.run_record import RunRecord
from canon.flow.task import Task
from canon.flow.transformed.extended_hamiltonian import ExtendedSystem
from canon.flow.transformed.transformed_motion import RunState
from canon.flow.transformed.transformed_orbit import StepEnd
from canon.frozen_mapping import FrozenMapping
from canon.kernel.heyoka_bridge import fraction_of, heyoka_number, is_heyoka_number
from canon.kernel.program.hamilton_equations import EquationNodes, HamiltonEquations
from canon.kernel.program.holonomic_system import HolonomicSystem
from canon.kernel.program.lagrangian.momenta_and_forces import MomentaAndForces
from canon.kernel.program.lie_poisson_parts import CommonTurn, LiePoissonParts, PlaneTurns, TurningBlock
from canon.kernel.program.nonholonomic_system import NonholonomicSystem
from canon.kernel.program.repeated.repeated_terms import KeptFunction, RepeatedTerms
from canon.kernel.schemes.splitting_schemes import Scheme

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

__all__ = ["record_data", "record_from"]

_CLASSES: dict[str, Any] = {
    each.__name__: each
    for each in (
        RunRecord, Task, Samples, Plan, HamiltonEquations, MovingSystem, Residual, Contact, Contacts, ExtendedSystem,
        RunState, StepEnd, LoopState, Event, Crossing, Splitting, Gauss, RK4, Taylor, DOP853, TimeTransformed,
        SolvableSplitting, WisdomHolman, SABA, SBAB, Scheme, ExtendedPhaseSpace, SemiexplicitSplitting, Rattle,
        HolonomicSystem, NonholonomicLeapfrog, NonholonomicSystem, LiePoissonSplitting, LiePoissonParts, PlaneTurns,
        CommonTurn, TurningBlock, Boris, MagneticSplitting, AverageVectorField,
        GalerkinVariational, MomentaAndForces, EquationNodes, KeptFunction, RepeatedTerms,
    )
}  # fmt: skip

_KEPT = ("float64", "float32", "int64", "bool")
"""Kinds of numbers whose arrays are kept as they are."""


def record_data(record: RunRecord) -> tuple[dict[str, Any], dict[str, npt.NDArray[Any]]]:
    """Return what JSON can hold of a record, and its arrays by name.

    Raises
    ------
    ValueError
        Something in it can't be kept exactly; the message says what, and what to do.
    """
    if record.samples.dense:
        raise ValueError(
            "the polynomials of a motion with dense=True can't be kept in a file: propagate(…, times=…) keeps the "
            "states at the times you need"
        )
    writer = _Writer()
    whole = writer.of(record)
    return {
        "record": whole,
        "symbols": [symbol_data(each) for each in writer.symbols],
        "objects": writer.objects,
        "precision": record.task.precision_name,
    }, writer.arrays


def record_from(data: Mapping[str, Any], arrays: Mapping[str, npt.NDArray[Any]]) -> RunRecord:
    """Return the record that :func:`record_data` wrote.

    Raises
    ------
    KeyError, ValueError, TypeError, IndexError
        The data are none that it writes.
    """
    reader = _Reader(data, arrays)
    found = reader.of(data["record"])
    if not isinstance(found, RunRecord):
        raise TypeError(f"the record of a run is a {type(found).__name__}")
    return found


class _Writer:
    """What was met on the way: symbols and values, each once, and arrays."""

    def __init__(self) -> None:
        self.symbols: dict[Symbol, int] = {}
        self.objects: list[Any] = []
        self.arrays: dict[str, npt.NDArray[Any]] = {}
        self._numbers: dict[int, int] = {}

    def symbol(self, symbol: Symbol) -> int:
        return self.symbols.setdefault(symbol, len(self.symbols))

    def of(self, value: Any) -> Any:
        """Return what JSON can hold of a value."""
        if value is None or isinstance(value, bool | str | int):
            return value
        if isinstance(value, float):
            return {"float": float(value).hex()}
        if isinstance(value, Fraction):
            return {"fraction": str(value)}
        if isinstance(value, np.ndarray):
            return self._array(cast("npt.NDArray[Any]", value))
        if type(value) is np.longdouble or is_heyoka_number(value):
            return {"number": str(fraction_of(value))}
        if isinstance(value, tuple | list):
            kind, items = type(value).__name__, cast("tuple[Any, ...]", value)
            return {kind: [self.of(each) for each in items]}
        if isinstance(value, Mapping):
            pairs = cast("Mapping[Any, Any]", value).items()
            return {"mapping": [[self.of(key), self.of(each)] for key, each in pairs]}
        if isinstance(value, Symbol):
            return {"symbol": self.symbol(value)}
        if isinstance(value, Expr):
            return {"expression": expression_data(value, self.symbol)}
        return {"object": self._object(value)}

    def _array(self, value: npt.NDArray[Any]) -> Any:
        name = f"array_{len(self.arrays)}"
        if value.dtype.name in _KEPT:
            self.arrays[name] = value.astype(value.dtype.newbyteorder("<"))
            return {"array": name}
        if value.dtype == np.longdouble:
            with np.errstate(over="ignore", invalid="ignore"):
                high = value.astype(np.float64)
                low = (value - high).astype(np.float64)
                together = high.astype(np.longdouble) + low
            if not np.array_equal(together, value):
                raise ValueError("numbers of 64 bits beyond the range of doubles can't be kept in a file")
            return {"sum": [self._array(high), self._array(low)]}
        numbers = value.tolist()
        if value.ndim != 1 or not all(map(is_heyoka_number, numbers)):
            raise ValueError(f"an array of {value.dtype} can't be kept in a file exactly")
        return {"numbers": [str(fraction_of(x)) for x in numbers]}

    def _object(self, value: Any) -> int:
        """Return the number of a graph or a value of one of the classes, met once however often it is used."""
        known = self._numbers.get(id(value))
        if known is not None:
            return known
        name = type(value).__name__
        if isinstance(value, Graph):
            data = graph_data(value, self.symbol)
        elif _CLASSES.get(name) is type(value):
            data = {each.name: self.of(getattr(value, each.name)) for each in fields(value)}
        else:
            raise ValueError(
                f"a {name} can't be kept in a file exactly: keep the states instead, motion.to_xarray() or numpy.savez"
            )
        self.objects.append([name, data])
        self._numbers[id(value)] = len(self.objects) - 1
        return len(self.objects) - 1


class _Reader:
    """Values made again of data, those that stand before first."""

    def __init__(self, data: Mapping[str, Any], arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        self.arrays, self.precision = arrays, data["precision"]
        self.symbols = [symbol_from(each) for each in data["symbols"]]
        self.objects: list[Any] = []
        for name, values in data["objects"]:
            self.objects.append(self._object(name, values))

    def of(self, data: Any) -> Any:
        """Return the value of which :meth:`_Writer.of` made the data."""
        if data is None or isinstance(data, bool | str | int):
            return data
        ((kind, inner),) = data.items()
        return _READ[kind](self, inner)

    def number(self, written: str) -> Any:
        """Return a number wider than doubles, as heyoka computes with it."""
        digits = self.precision if self.precision in ("double", "extended", "quad") else int(self.precision)
        return heyoka_number(digits)(Fraction(written))

    def _object(self, name: str, values: Any) -> Any:
        if name == "Graph":
            return graph_from(values, self.symbols)
        kind, former = _CLASSES[name], self._former(name, values)
        made = object.__new__(kind)
        for each in fields(kind):
            if each.name in former:
                object.__setattr__(made, each.name, former[each.name])
                continue
            # Files written before a field was there do not hold it.
            value = (
                self.of(values[each.name]) if each.name in values or each.default is MISSING else each.default
            )
            object.__setattr__(made, each.name, value)
        return made

    def _former(self, name: str, values: Any) -> dict[str, Any]:
        """Return fields that were others in files of canon before sums over rows."""
        if name == "HamiltonEquations" and "written" not in values:
            own = (self.of(values[each]) for each in ("graph", "hamiltonian", "velocity", "force"))
            return {"written": EquationNodes(*own)}
        if name == "Task" and "observed" not in values:
            _energy, *observed = self.of(values["nodes"])
            return {"observed": tuple(observed)}
        return {}


_READ: dict[str, Callable[[_Reader, Any], Any]] = {
    "float": lambda _, x: float.fromhex(x),
    "fraction": lambda _, x: Fraction(x),
    "array": lambda r, x: r.arrays[x],
    "number": lambda r, x: r.number(x),
    "numbers": lambda r, x: np.array([r.number(each) for each in x]),
    "sum": lambda r, x: np.add(r.of(x[0]).astype(np.longdouble), r.of(x[1])),
    "tuple": lambda r, x: tuple(r.of(each) for each in x),
    "list": lambda r, x: [r.of(each) for each in x],
    "mapping": lambda r, x: FrozenMapping({r.of(key): r.of(each) for key, each in x}),
    "symbol": lambda r, x: r.symbols[x],
    "expression": lambda r, x: expression_from(x, r.symbols),
    "object": lambda r, x: r.objects[x],
}
"""How the data of each kind become a value again."""
