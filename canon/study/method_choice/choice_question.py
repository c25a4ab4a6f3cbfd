"""Question of a choice: which error to bound over which motion, and the settings that are tried."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from canon.flow.method.adaptive_methods import Taylor
from canon.flow.method.setting import Setting
from canon.flow.request import Request
from canon.kernel.llvm.number_types import EXTENDED
from canon.study.motion.quiet_run import run_quietly

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Expr, Symbol

    from canon.array import Array
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.flow.trajectory import Trajectory

__all__ = ["FINER", "PLACES", "Question"]

PLACES, FINER = 64, 8
"""Times at which positions are compared with those of the reference, and in how many parts of their distance too, where
steps allow: errors have peaks at close passes."""

REFERENCE, FINE_REFERENCE = Taylor(1e-19), Taylor(1e-28)
"""Methods of the references for positions."""


@dataclass(frozen=True)
class Question:
    """What is to be kept over which motion.

    Parameters
    ----------
    hamiltonian, y0, values, span
        The motion: Hamiltonian or other system, state of shape (2n,), values of the parameters, span.
    observable
        ``"energy"``, ``"position"``, or the name of an integral.
    integral
        That integral as a function of (q, p); None for the first two.
    since
        Time of the state y0.
    unit
        What errors are relative to, where y0 is not the start; else the quantity's size there.
    elsewhere
        Times and states that the motion reaches later, at which pilots run too
        (:mod:`canon.study.method_choice.slow_times`).
    """

    hamiltonian: HamiltonianSystem
    y0: Array
    values: Mapping[Symbol | str, float]
    span: float
    observable: str = "energy"
    integral: Expr | None = None
    since: float = 0.0
    unit: float | None = None
    elsewhere: tuple[tuple[float, Array], ...] = ()
    _known: dict[tuple[float, bool], tuple[Array, Array]] = field(
        default_factory=dict[tuple[float, bool], "tuple[Array, Array]"], repr=False, compare=False
    )

    def moved(self, since: float, y0: Array) -> Question:
        """Return the same question of the motion from a later time and state on."""
        return replace(self, since=since, y0=y0, elsewhere=(), _known={})

    def run(
        self,
        setting: Setting,
        span: float,
        samples: int,
        cadence: int | None = None,
        times: Array | None = None,
    ) -> Trajectory:
        """Return a run of that span from the start; its samples are even unless times are named."""
        motion = Request(
            self.hamiltonian,
            (self.since, self.since + span),
            self.y0,
            parameters=self.values,
            samples=samples if times is None else None,
            times=times,
            observables=None if self.integral is None else {self.observable: self.integral},
            cadence=cadence,
        )
        return run_quietly(motion.by(setting))

    def positions(self, span: float, precision: str) -> tuple[Array, Array]:
        """Return the reference's coordinates at PLACES · FINER + 1 even times as sums of doubles, each (n, times).

        The reference of runs in doubles has 64 bits, or 113 where the platform has no such numbers; that of
        runs in more digits has 113.
        """
        plain = precision in ("single", "double", "compensated")
        if (span, plain) not in self._known:
            digits = "extended" if plain and EXTENDED.available() else "quad"
            reference = Setting(REFERENCE if plain else FINE_REFERENCE, precision=digits)
            found = self.run(reference, span, PLACES * FINER)
            self._known[span, plain] = found.q, found.carried[: len(found.q)]
        return self._known[span, plain]
