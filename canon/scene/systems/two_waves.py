"""A particle in two waves, whose resonances overlap or do not."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import cos
from canon.scene.scene import Parameter, Scene, Solution, Start
from canon.scene.systems.pendulum import quarter_of_swing

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

__all__ = ["SCENES"]

_SWING, _SECOND = 0.2, 0.002


def _two_waves(s: SimpleNamespace) -> Expr:
    return s.x.momentum**2 / 2 - s.M * cos(s.x) - s.P * cos(s.k * (s.x - s.t))


def _quarter(value: Mapping[str, float]) -> float:
    """Return the quarter of a period in the trough of the first wave alone, a pendulum with ω² = M."""
    return quarter_of_swing(_SWING, math.sqrt(value["M"]))


TWO_WAVES = Scene(
    name="two-waves",
    title="A particle in two waves: between their resonances at p = 0 and 1, of half-widths 2√M and 2√P, chaos begins",
    coordinates="x",  # no angle: a whole turn of x changes cos(k (x − t)), but for whole k
    parameters=(
        Parameter("M", 0.02, "", "amplitude of the wave at rest"),
        Parameter("P", _SECOND, "", "amplitude of the wave of speed 1", sign="nonnegative"),
        Parameter("k", 1.0, "", "wave number of the second wave, in those of the first"),
    ),
    starts=(
        Start(
            "trapped",
            "in a trough of the first wave, at rest but for what the second wave does",
            q=(_SWING,),
            p=(-_SECOND * math.cos(_SWING),),
            made_for="P k",
        ),
        Start("passing", "between both waves", q=(0.0,), p=(0.6,)),
    ),
    time_scale=lambda _value: 2.0 * math.pi,
    time_unit="",
    source="D. F. Escande & F. Doveil, J. Stat. Phys. 26, 257 (1981), doi:10.1007/BF01013171; B. V. Chirikov, "
    "Phys. Rep. 52, 263 (1979), doi:10.1016/0370-1573(79)90023-1: they overlap where 2√M + 2√P > 1",
    H_of=_two_waves,
    solutions=(
        Solution(
            "the trapped particle passes the bottom of the trough: quarter of the period of a pendulum",
            "trapped",
            lambda s: s.t,
            lambda v, _t: _quarter(v),
            event=lambda s: s.x,
            bound=0.02,
            periods=20.0,
            source="an average over the second wave",
        ),
    ),
    energy_bound=2e-12,
    energy_why="what the second wave does is summed",
    horizon=200.0,
    shown=40.0,
)

SCENES = (TWO_WAVES,)
"""The two waves."""
