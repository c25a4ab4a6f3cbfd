"""Two degrees of freedom that textbooks solve: one by ignoring a coordinate, one by its integrals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.scene import Integral, Parameter, Scene, Start

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

__all__ = ["SCENES"]


def _routh(s: SimpleNamespace) -> Expr:
    return s.q1.dot**2 / (2 * (s.a + s.b * s.q2**2)) + s.q2.dot**2 / 2 - s.c - s.d * s.q2**2


def _routh_period(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi / math.sqrt(2.0 * value["d"] + value["b"])


def _oscillator_energy(s: SimpleNamespace) -> Expr:
    """Return the energy of q2 alone at constant p1, ½ p2² + ½ (2d + b p1²) q2²."""
    return s.q2.momentum**2 / 2 + (2 * s.d + s.b * s.q1.momentum**2) * s.q2**2 / 2


ROUTH = Scene(
    name="routh-two-degree",
    title="Two degrees of freedom, q1 ignorable: q2 = A cos(√(2d + b p1²) t + B)",
    coordinates="q1 q2",
    parameters=(
        Parameter("a", 2.0, "", "constant part of the inverse inertia of q1"),
        Parameter("b", 0.5, "", "growth of that inverse inertia with q2²"),
        Parameter("c", 0.3, "", "constant potential", sign="real"),
        Parameter("d", 1.5, "", "half the stiffness of q2"),
    ),
    starts=(Start("turning", "p1 = 1, q2 drawn to 0.7", q=(0.0, 0.7), p=(1.0, 0.0)),),
    time_scale=_routh_period,
    time_unit="",
    source="Whittaker, Analytical Dynamics (4th ed.), § 38, example",
    L_of=_routh,
    integrals=(
        Integral("momentum of the ignorable coordinate", lambda s: s.q1.momentum),
        Integral("energy of q2 alone", _oscillator_energy),
    ),
)


def _e_folding(_value: Mapping[str, float]) -> float:
    return 1.0


def _hyperbolic(s: SimpleNamespace) -> Expr:
    return s.q1 * s.q1.momentum - s.q2 * s.q2.momentum - s.a * s.q1**2 + s.b * s.q2**2


HYPERBOLIC = Scene(
    name="hyperbolic",
    title="H = q1 p1 − q2 p2 − a q1² + b q2²: q1 grows and q2 shrinks as e^t, their product stays",
    coordinates="q1 q2",
    parameters=(
        Parameter("a", 0.7, "", "coefficient of q1²", sign="real"),
        Parameter("b", 0.4, "", "coefficient of q2²", sign="real"),
    ),
    starts=(Start("saddle", "from near the saddle point", q=(1e-3, 1.0), p=(0.2, 0.1)),),
    time_scale=_e_folding,
    horizon=10.0,
    time_unit="",
    source="textbook exercise; both integrals follow from {f, H} = 0",
    H_of=_hyperbolic,
    integrals=(
        Integral("q1 q2", lambda s: s.q1 * s.q2),
        Integral("(p2 − b q2)/q1", lambda s: (s.q2.momentum - s.b * s.q2) / s.q1),
    ),
)

SCENES = (ROUTH, HYPERBOLIC)
"""The systems of two degrees of freedom."""
