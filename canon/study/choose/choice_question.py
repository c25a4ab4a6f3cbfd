"""Question of a choice: which error to bound over which motion, and the settings that are tried."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.method.adaptive_methods import Taylor
from canon.flow.propagate import propagate
from canon.flow.run.observables_along import AccuracyWarning
from canon.kernel.llvm.number_types import EXTENDED

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Expr, Symbol

    from canon.array import Array
    from canon.flow.method.method import Method
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.flow.trajectory import Trajectory

__all__ = ["PLACES", "Question", "Setting"]

PLACES = 64
"""Times at which positions are compared with those of the reference."""

REFERENCE, FINE_REFERENCE = Taylor(1e-19), Taylor(1e-28)
"""Methods of the references for positions."""


@dataclass(frozen=True)
class Setting:
    """A method with its step or tolerance and its arithmetic, the way ``propagate`` takes them."""

    method: Method
    step: float | None = None
    tolerance: float | None = None
    precision: str = "compensated"

    @property
    def knob(self) -> float:
        """The step, or the tolerance of an adaptive method."""
        return self.step if self.step is not None else self.tolerance or 2.0**-52

    def turned(self, knob: float) -> Setting:
        """Return the setting with another step or tolerance."""
        if self.method.engine.takes_step:
            return replace(self, step=knob)
        return replace(self, tolerance=knob)


@dataclass(frozen=True)
class Question:
    """What is to be kept over which motion.

    Parameters
    ----------
    hamiltonian, y0, values, span
        The motion: Hamiltonian, state (q, p) of shape (2n,), values of the parameters, duration.
    observable
        ``"energy"``, ``"position"``, or the name of an integral.
    integral
        That integral as a function of (q, p); None for the first two.
    """

    hamiltonian: HamiltonianSystem
    y0: Array
    values: Mapping[Symbol | str, float]
    span: float
    observable: str = "energy"
    integral: Expr | None = None
    _known: dict[tuple[float, bool], tuple[Array, Array]] = field(
        default_factory=dict[tuple[float, bool], "tuple[Array, Array]"], repr=False, compare=False
    )

    def run(
        self,
        setting: Setting,
        duration: float,
        samples: int,
        cadence: int | None = None,
        times: Array | None = None,
    ) -> Trajectory:
        """Return a run of that duration from the start; its samples are even unless times are named."""
        with warnings.catch_warnings(), np.errstate(over="ignore", invalid="ignore"):
            warnings.simplefilter("ignore", AccuracyWarning)  # its energy error is looked at here
            return propagate(
                self.hamiltonian,
                (0.0, duration),
                self.y0,
                method=setting.method,
                step=setting.step,
                tolerance=setting.tolerance,
                precision=setting.precision,
                parameters=self.values,
                samples=samples if times is None else None,
                times=times,
                cadence=cadence,
                observables=None if self.integral is None else {self.observable: self.integral},
            )

    def positions(self, duration: float, precision: str) -> tuple[Array, Array]:
        """Return the reference's coordinates at PLACES + 1 even times as sums of doubles, each (n, times).

        The reference of runs in doubles has 64 bits, or 113 where the platform has no such numbers; that of
        runs in more digits has 113.
        """
        plain = precision in ("single", "double", "compensated")
        if (duration, plain) not in self._known:
            digits = "extended" if plain and EXTENDED.available() else "quad"
            reference = Setting(REFERENCE if plain else FINE_REFERENCE, precision=digits)
            found = self.run(reference, duration, PLACES)
            self._known[duration, plain] = found.q, found.carried[: len(found.q)]
        return self._known[duration, plain]
