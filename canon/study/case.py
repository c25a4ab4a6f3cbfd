"""One case of a study: everything that determines a run, its key, and what comes of it as text."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from fractions import Fraction
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.method import DOP853, RK4, Gauss, Splitting, Taylor
from canon.kernel.scheme import SCHEMES
from canon.scene import find
from canon.study.comparison import drift_row
from canon.version import __version__

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.flow.method import Method
    from canon.study.comparison import DriftRow

__all__ = ["Case", "key_of", "method_from", "method_to", "outcome_of", "run_case", "versions"]

LIBRARIES = ("heyoka", "llvmlite", "numpy", "scipy", "sympy")
"""Libraries whose version may change a last digit."""


@dataclass(frozen=True)
class Case:
    """A run of one scene from one state with one method.

    Parameters
    ----------
    scene
        Name of the scene.
    method
        The method.
    span
        Duration in units of time.
    samples
        Samples the energy error is judged by.
    start
        Name of a start of the scene, or a state (q, p).
    parameters
        Values that replace the scene's own.
    step, tolerance, precision
        As :func:`canon.flow.propagate.propagate` takes them.
    """

    scene: str
    method: Method
    span: float
    samples: int = 4096
    start: str | tuple[float, ...] | None = None
    parameters: tuple[tuple[str, float], ...] = ()
    step: float | None = None
    tolerance: float | None = None
    precision: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return what JSON can hold of this case; floats survive exactly."""
        fields = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return {**fields, "method": method_to(self.method), "parameters": dict(self.parameters)}

    @staticmethod
    def from_dict(fields: Mapping[str, Any]) -> Case:
        """Return the case that :meth:`to_dict` wrote."""
        given: dict[str, Any] = dict(fields)
        start = given.pop("start")
        return Case(
            method=method_from(given.pop("method")),
            parameters=tuple(given.pop("parameters").items()),
            start=tuple(start) if isinstance(start, list) else start,
            **given,
        )


def versions() -> dict[str, str]:
    """Return the versions that a result depends on."""
    return {"canon": __version__, **{name: version(name) for name in LIBRARIES}}


def key_of(case: Case) -> str:
    """Return the SHA-256 of everything that determines the result: inputs, the scene's defaults, versions.

    Examples
    --------
    >>> from canon import RK4
    >>> case = Case("kepler", RK4(), span=10.0, step=0.01)
    >>> key_of(case) == key_of(Case("kepler", RK4(), span=10.0, step=0.01))
    True
    >>> key_of(case) == key_of(Case("kepler", RK4(), span=10.0, step=0.02))
    False
    """
    scene = find(case.scene).with_parameters(**dict(case.parameters))
    start = None if isinstance(case.start, tuple) else asdict(scene.start(case.start))
    whole = {"case": case.to_dict(), "values": scene.values, "start": start, "versions": versions()}
    return hashlib.sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()


def run_case(case: Case) -> DriftRow:
    """Return the run of a case; it depends on the case alone."""
    scene = find(case.scene).with_parameters(**dict(case.parameters))
    state = np.array(case.start) if isinstance(case.start, tuple) else scene.state(case.start)
    return drift_row(
        scene.hamiltonian,
        state,
        case.span,
        case.method,
        step=case.step,
        tolerance=case.tolerance,
        precision=case.precision,
        parameters={**scene.values},
        samples=case.samples,
    )


def outcome_of(row: DriftRow) -> dict[str, Any]:
    """Return what is kept of a finished run: its numbers, exactly; not its samples, and not the time it took."""
    found = row.drift
    if found is None:
        return {}
    return {
        "verdict": found.verdict.value,
        "reason": found.reason,
        "bound": found.bound,
        "slope": found.slope,
        "slope_error": found.slope_error,
        "amplitude_slope": found.amplitude_slope,
        "amplitude_slope_error": found.amplitude_slope_error,
        "exponent": found.exponent,
        "exponent_interval": list(found.exponent_interval),
        "detection_limit": found.detection_limit,
        "walk": found.walk,
        "relative": row.relative,
        "step": row.step,
        "steps": row.steps,
        "evaluations": row.evaluations,
        "precision": row.precision,
        "final": row.final.tolist(),
        "means": {"t": found.blocks.t.tolist(), "mean": found.blocks.mean.tolist()},
    }


def method_to(method: Method) -> dict[str, Any]:
    """Return a method as what JSON and TOML can hold.

    Examples
    --------
    >>> method_to(Splitting("verlet")), method_to(Gauss(4)), method_to(Taylor(1e-10))
    ({'splitting': 'verlet'}, {'gauss': 4}, {'taylor': 1e-10})
    """
    match method:
        case Splitting(scheme=scheme):
            if scheme.name:
                return {"splitting": scheme.name}
            return {"splitting": {"a": [str(x) for x in scheme.a], "b": [str(x) for x in scheme.b]}}
        case Gauss(stages=stages):
            return {"gauss": stages}
        case RK4():
            return {"rk4": True}
        case Taylor(tolerance=tolerance):
            return {"taylor": tolerance if tolerance is not None else True}
        case DOP853(tolerance=tolerance):
            return {"dop853": tolerance}


def method_from(written: Mapping[str, Any] | str) -> Method:
    """Return the method of a table with one key, or of a name alone.

    Raises
    ------
    ValueError
        Where there is no such method.

    Examples
    --------
    >>> method_from("kahan-li-8"), method_from("rk4"), method_from({"gauss": 6})
    (Splitting('kahan-li-8'), RK4(), Gauss(stages=6))
    """
    if isinstance(written, str):
        name = written.lower()
        written = {"splitting": name} if name in SCHEMES else {name: True}
    if len(written) != 1:
        raise ValueError(f"a method is a name or a table with one key, not {dict(written)}")
    ((kind, value),) = written.items()
    match kind, value:
        case "splitting", str():
            return Splitting(value)
        case "splitting", {"a": a, "b": b}:
            return Splitting(a=[Fraction(x) for x in a], b=[Fraction(x) for x in b])
        case "gauss", int() if value is not True:
            return Gauss(value)
        case "rk4", True:
            return RK4()
        case "taylor", True:
            return Taylor()
        case "taylor", float():
            return Taylor(value)
        case "dop853", True:
            return DOP853()
        case "dop853", float():
            return DOP853(value)
        case _:
            raise ValueError(
                f"no method is written {kind} = {value!r}; there are {', '.join(SCHEMES)}, rk4, taylor, dop853, "
                "{ gauss = stages }, { taylor = tolerance }, { dop853 = tolerance }, { splitting = { a, b } }"
            )
