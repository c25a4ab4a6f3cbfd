"""Chains of masses and springs: Toda's integrable ring, and the chain of Fermi, Pasta, Ulam and Tsingou."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, cast

from canon.scene.formula_functions import Add, Integer, cos, exp, sin
from canon.scene.picture import Picture
from canon.scene.scene import Integral, Parameter, Scene, SceneError, Start

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

    from canon.expression.symbols.symbol import Coordinate

__all__ = ["SCENES", "toda"]


def _ring(s: SimpleNamespace, masses: int) -> list[tuple[Coordinate, Coordinate]]:
    """Return each mass with its right-hand neighbour."""
    places = [getattr(s, f"q{i}") for i in range(1, masses + 1)]
    return list(zip(places, [*places[1:], places[0]], strict=True))


def _springs(s: SimpleNamespace, masses: int) -> Expr:
    return Add(*(a.momentum**2 / 2 + exp(a - b) - 1 for a, b in _ring(s, masses)))


def _lax_trace(s: SimpleNamespace, masses: int, power: int) -> Expr:
    """Return tr Lᵏ/k of Flaschka's matrix: p on the diagonal, a = e^((qᵢ − qᵢ₊₁)/2) beside it and in the corners."""
    import sympy as sp

    ring = _ring(s, masses)
    a = sp.symbols(f"a1:{masses + 1}", positive=True)
    L = sp.zeros(masses, masses)
    for i, (q, _) in enumerate(ring):
        j = (i + 1) % masses
        L[i, i] += q.momentum
        L[i, j] += a[i]
        L[j, i] += a[i]
    half = L ** (power // 2)
    rest = half * L if power % 2 else half
    trace = sp.expand(sp.Add(*(half[i, j] * rest[j, i] for i in range(masses) for j in range(masses))))
    springs = {x: sp.exp((q - r) / 2) for x, (q, r) in zip(a, ring, strict=True)}
    return cast("Expr", trace.xreplace(springs)) / power


_DIGITS = "sums of large terms that cancel"


def toda(masses: int, starts: tuple[Start, ...], name: str = "") -> Scene:
    """Return Toda's ring of so many masses, with all its integrals: the traces of the powers of Flaschka's matrix.

    Parameters
    ----------
    masses
        At least 3.
    starts
        Initial states.
    name
        What to call it; ``toda-<masses>`` unless given.

    Examples
    --------
    >>> ring = toda(4, (Start("a", "", q=(0.1, 0.0, 0.0, 0.0), p=(0.0, 0.1, 0.0, -0.1)),))
    >>> [integral.name for integral in ring.integrals]
    ['total momentum', 'cubic integral', 'tr L^4/4']
    """
    if masses < 3:
        raise SceneError(f"three masses at least make a ring, not {masses}")
    powers = [k for k in range(1, masses + 1) if k != 2]  # tr L²/2 is the energy

    def integral(power: int) -> Integral:
        title = {1: "total momentum", 3: "cubic integral"}.get(power, f"tr L^{power}/{power}")
        return Integral(title, lambda s: _lax_trace(s, masses, power), 1e-11 if power > 2 else 1e-13, _DIGITS)

    return Scene(
        name=name or f"toda-{masses}",
        title=f"Toda's ring of {masses} masses with exponential springs: integrable",
        coordinates=" ".join(f"q{i}" for i in range(1, masses + 1)),
        parameters=(),
        starts=starts,
        time_scale=lambda _value: math.pi / math.sin(math.pi / masses),
        time_unit="",
        source="Hénon, Phys. Rev. B 9, 1921 (1974), doi:10.1103/PhysRevB.9.1921; Flaschka, ibid. 1924",
        H_of=lambda s: _springs(s, masses),
        integrals=tuple(map(integral, powers)),
        picture_of=lambda s: _on_a_circle(s, masses),
    )


def _on_a_circle(s: SimpleNamespace, masses: int) -> Picture:
    """Return the ring drawn as one: displacements along the circumference, one radius apart at rest."""
    from sympy import pi

    angles = [(2 * pi * i + q) / masses for i, (q, _) in enumerate(_ring(s, masses))]
    places = tuple((cos(angle), sin(angle)) for angle in angles)
    return Picture(masses=places, springs=tuple(zip(places, (*places[1:], places[0]), strict=True)))


TODA = toda(
    3,
    (
        Start("moderate", "energy about 1.3", q=(0.5, 0.0, -0.5), p=(0.4, -0.9, 0.5)),
        Start("wild", "energy about 7", q=(1.5, 0.0, -1.0), p=(2.0, -1.0, -1.0)),
    ),
    name="toda",
)

TODA_SIX = toda(
    6,
    (
        Start(
            "moderate",
            "all masses moving",
            q=(0.3, -0.1, 0.2, -0.3, 0.1, -0.2),
            p=(0.5, -0.4, 0.1, 0.3, -0.6, 0.1),
        ),
    ),
)

_MASSES = 31


def _stretches(s: SimpleNamespace) -> list[Expr]:
    """Return how far each of the springs between the masses and the two walls is stretched."""
    places = [Integer(0), *(getattr(s, f"q{i}") for i in range(1, _MASSES + 1)), Integer(0)]
    return [right - left for left, right in pairwise(places)]


def _fput(s: SimpleNamespace) -> Expr:
    masses = [getattr(s, f"q{i}") for i in range(1, _MASSES + 1)]
    springs = [d**2 / 2 + s.alpha * d**3 / 3 + s.beta * d**4 / 4 for d in _stretches(s)]
    return Add(*(q.momentum**2 / 2 for q in masses), *springs)


def _lowest_mode(_value: Mapping[str, float]) -> float:
    return math.pi / math.sin(math.pi / (2.0 * (_MASSES + 1)))


def _fput_picture(s: SimpleNamespace) -> Picture:
    """Return the chain with its displacements drawn upwards, ten times as large as the distances."""
    places = [
        (0.0, 0.0),
        *((float(i), 10 * getattr(s, f"q{i}")) for i in range(1, _MASSES + 1)),
        (_MASSES + 1.0, 0.0),
    ]
    return Picture(masses=tuple(places[1:-1]), bars=(tuple(places),))


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
    shown=1.0,
    picture_of=_fput_picture,
)

SCENES = (TODA, TODA_SIX, FPUT)
"""The chains."""
