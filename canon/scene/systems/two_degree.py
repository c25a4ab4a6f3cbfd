"""Systems of two degrees of freedom that textbooks solve: one by ignoring a coordinate, one by its integrals."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.scene import Integral, Parameter, Scene, Solution, Start

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array

__all__ = ["SCENES"]


def _routh(s: SimpleNamespace) -> Expr:
    return s.q1.dot**2 / (2 * (s.a + s.b * s.q2**2)) + s.q2.dot**2 / 2 - s.c - s.d * s.q2**2


def _routh_period(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi / math.sqrt(2.0 * value["d"] + value["b"])


def _oscillator_energy(s: SimpleNamespace) -> Expr:
    """Return the energy of q2 alone at constant p1, ½ p2² + ½ (2d + b p1²) q2²."""
    return s.q2.momentum**2 / 2 + (2 * s.d + s.b * s.q1.momentum**2) * s.q2**2 / 2


def _turned(value: Mapping[str, float], t: Array) -> tuple[Array, Array]:
    """Return q1 = ∫ p1 (a + b q2²) dt and q2 = A cos ωt, ω² = 2d + b p1², from p1 = 1, A = 0.7."""
    import numpy as np

    rate = math.sqrt(2.0 * value["d"] + value["b"])
    square = 0.7**2 * (t / 2.0 + np.sin(2.0 * rate * t) / (4.0 * rate))
    return value["a"] * t + value["b"] * square, 0.7 * np.cos(rate * t)


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
    solutions=(
        Solution("q2 = A cos ωt", "turning", lambda s: s.q2, lambda v, t: _turned(v, t)[1]),
        Solution("q1 by quadrature", "turning", lambda s: s.q1, lambda v, t: _turned(v, t)[0]),
    ),
    integrals=(
        Integral("momentum of the ignorable coordinate", lambda s: s.q1.momentum),
        Integral("energy of q2 alone", _oscillator_energy),
    ),
)


def _e_folding(_value: Mapping[str, float]) -> float:
    return 1.0


def _hyperbolic(s: SimpleNamespace) -> Expr:
    return s.q1 * s.q1.momentum - s.q2 * s.q2.momentum - s.a * s.q1**2 + s.b * s.q2**2


def _exponential(x: Array) -> Array:
    import numpy as np

    return np.exp(x)


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
    energy_bound=1e-12,
    energy_why="q1 p1 and a q1² grow as e^(2t), their difference does not",
    solutions=(
        Solution("q1 = A e^t", "saddle", lambda s: s.q1, lambda _v, t: 1e-3 * _exponential(t)),
        Solution("q2 = B e^−t", "saddle", lambda s: s.q2, lambda _v, t: _exponential(-t)),
    ),
    integrals=(
        Integral("q1 q2", lambda s: s.q1 * s.q2),
        Integral("(p2 − b q2)/q1", lambda s: (s.q2.momentum - s.b * s.q2) / s.q1),
    ),
)

SCENES = (ROUTH, HYPERBOLIC)
"""The systems of two degrees of freedom."""
