"""Chains of masses and springs: Toda's integrable ring, and the chain of Fermi, Pasta, Ulam and Tsingou."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

from canon.scene.scene import Integral, Parameter, Scene, Start

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

    from canon.expression.symbol import Coordinate

__all__ = ["SCENES"]


def _ring(s: SimpleNamespace) -> list[tuple[Coordinate, Coordinate]]:
    """Return each mass with its right-hand neighbour."""
    return [(s.q1, s.q2), (s.q2, s.q3), (s.q3, s.q1)]


def _toda(s: SimpleNamespace) -> Expr:
    from sympy import Add, exp

    return Add(*(a.momentum**2 / 2 + exp(a - b) - 1 for a, b in _ring(s)))


def _toda_momentum(s: SimpleNamespace) -> Expr:
    from sympy import Add

    return Add(*(a.momentum for a, _ in _ring(s)))


def _toda_cubic(s: SimpleNamespace) -> Expr:
    """Return Σ p³/3 + (pᵢ + pᵢ₊₁) e^(qᵢ − qᵢ₊₁), a third of the trace of the cube of Lax's matrix."""
    from sympy import Add, exp

    return Add(*(a.momentum**3 / 3 + (a.momentum + b.momentum) * exp(a - b) for a, b in _ring(s)))


def _toda_period(_value: Mapping[str, float]) -> float:
    return 2.0 * math.pi / math.sqrt(3.0)


TODA = Scene(
    name="toda",
    title="Toda's ring of three masses with exponential springs: integrable",
    coordinates="q1 q2 q3",
    parameters=(),
    starts=(
        Start("moderate", "energy about 1.3", q=(0.5, 0.0, -0.5), p=(0.4, -0.9, 0.5)),
        Start("wild", "energy about 7", q=(1.5, 0.0, -1.0), p=(2.0, -1.0, -1.0)),
    ),
    time_scale=_toda_period,
    time_unit="",
    source="Hénon, Phys. Rev. B 9, 1921 (1974), doi:10.1103/PhysRevB.9.1921; Flaschka, ibid. 1924",
    H_of=_toda,
    integrals=(
        Integral("total momentum", _toda_momentum),
        Integral("cubic integral", _toda_cubic, 1e-12, "its terms are several times its value"),
    ),
)

_MASSES = 31


def _stretches(s: SimpleNamespace) -> list[Expr]:
    """Return how far each of the springs between the masses and the two walls is stretched."""
    from sympy import Integer

    places = [Integer(0), *(getattr(s, f"q{i}") for i in range(1, _MASSES + 1)), Integer(0)]
    return [right - left for left, right in pairwise(places)]


def _fput(s: SimpleNamespace) -> Expr:
    from sympy import Add

    masses = [getattr(s, f"q{i}") for i in range(1, _MASSES + 1)]
    springs = [d**2 / 2 + s.alpha * d**3 / 3 + s.beta * d**4 / 4 for d in _stretches(s)]
    return Add(*(q.momentum**2 / 2 for q in masses), *springs)


def _lowest_mode(_value: Mapping[str, float]) -> float:
    return math.pi / math.sin(math.pi / (2.0 * (_MASSES + 1)))


def _mode(number: int) -> tuple[float, ...]:
    return tuple(math.sin(math.pi * number * i / (_MASSES + 1)) for i in range(1, _MASSES + 1))


FPUT = Scene(
    name="fput",
    title="The chain of Fermi, Pasta, Ulam and Tsingou: 31 masses between walls, springs not quite linear",
    coordinates=" ".join(f"q{i}" for i in range(1, _MASSES + 1)),
    parameters=(
        Parameter("alpha", 0.25, "", "quadratic part of the springs' force", sign="real"),
        Parameter("beta", 0.0, "", "cubic part of the springs' force", sign="real"),
    ),
    starts=(Start("lowest mode", "released from rest in the lowest mode", q=_mode(1), p=(0.0,) * _MASSES),),
    time_scale=_lowest_mode,
    time_unit="",
    source="Fermi, Pasta, Ulam & Tsingou, Studies of nonlinear problems I, Los Alamos LA-1940 (1955), fig. 1",
    H_of=_fput,
)

SCENES = (TODA, FPUT)
"""The chains."""
