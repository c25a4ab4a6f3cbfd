"""Quiet runs: motions whose energy error is judged by whoever runs them, so that no warning tells of it."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.propagation import propagated
from canon.flow.run.observables_along import AccuracyWarning

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.flow.request import Request
    from canon.flow.trajectory import Trajectory

__all__ = ["run_quietly"]


def run_quietly(request: Request, progress: Callable[[float], None] | None = None) -> Trajectory:
    """Return a motion without a warning of its energy error, nor of numbers that overflow on the way."""
    with warnings.catch_warnings(), np.errstate(over="ignore", invalid="ignore"):
        warnings.simplefilter("ignore", AccuracyWarning)
        return propagated(request, progress)
