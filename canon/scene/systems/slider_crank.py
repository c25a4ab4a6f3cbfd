"""The slider-crank mechanism of an engine: its parameters, transmission ratios, inertia and looks.

Crank radius r, rod length l, the piston's line at the distance e from the crank's axis; θ from the line of the piston,
s = r cos θ + l cos φ, r sin θ = e + l sin φ. The rod's centre of mass is a from the crank pin and b from the piston,
a + b = l. A resistance M acts against the crank, the gas pressure P against the piston's rise.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import TYPE_CHECKING

from canon.scene.formula_functions import Integer, cos, sin, sqrt
from canon.scene.parts import Condition
from canon.scene.picture import Picture, ring
from canon.scene.scene import Parameter, Solution

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Expr


__all__ = [
    "PARAMETERS", "REACHED", "SPEED", "TURNS", "VALUES", "drawn", "inertia", "quarter_turn", "ratios", "rod_cosine",
    "rod_sine", "speed_at_a_quarter", "square_at_a_quarter", "turn",
]  # fmt: skip

VALUES = {
    "m1": 1.2, "J1": 2.0e-3, "c": 0.01, "m2": 0.5, "J2": 1.4e-3, "a": 0.05, "b": 0.10, "m3": 0.35, "r": 0.04,
    "e": 0.004,
}  # fmt: skip
PARAMETERS = (
    Parameter("m1", VALUES["m1"], "kg", "mass of the crank"),
    Parameter("J1", VALUES["J1"], "kg m²", "central moment of inertia of the crank"),
    Parameter("c", VALUES["c"], "m", "from the axis to the crank's centre of mass"),
    Parameter("m2", VALUES["m2"], "kg", "mass of the rod"),
    Parameter("J2", VALUES["J2"], "kg m²", "central moment of inertia of the rod"),
    Parameter("a", VALUES["a"], "m", "from the crank pin to the rod's centre of mass"),
    Parameter("b", VALUES["b"], "m", "from the rod's centre of mass to the piston"),
    Parameter("m3", VALUES["m3"], "kg", "mass of the piston"),
    Parameter("r", VALUES["r"], "m", "radius of the crank"),
    Parameter("e", VALUES["e"], "m", "offset of the piston's line", sign="real"),
    Parameter("P", 0.0, "N", "force of the gas on the piston, towards the crank", sign="real"),
    Parameter("M", 0.0, "N m", "resistance to the crank", sign="real"),
)
TURNS = Condition(
    "the crank turns all the way round only where r + |e| is less than the rod",
    lambda v: v["r"] + abs(v.get("e", 0.0)) < v["a"] + v["b"],
)
SPEED = 100.0


def turn(_value: Mapping[str, float]) -> float:
    """Return the time of a turn of the crank."""
    return 2.0 * math.pi / SPEED


def rod_sine(s: SimpleNamespace) -> Expr:
    """Return sin φ = (r sin θ − e)/l."""
    return (s.r * sin(s.theta) - s.e) / (s.a + s.b)


def rod_cosine(s: SimpleNamespace) -> Expr:
    """Return cos φ, which is positive: the rod is longer than the crank."""
    return sqrt(1 - rod_sine(s) ** 2)


def ratios(s: SimpleNamespace) -> tuple[Expr, Expr]:
    """Return k_φ = φ̇/θ̇ and k_s = ṡ/θ̇."""
    k_phi = s.r * cos(s.theta) / ((s.a + s.b) * rod_cosine(s))
    return k_phi, -s.r * sin(s.theta) - (s.a + s.b) * rod_sine(s) * k_phi


def inertia(s: SimpleNamespace) -> Expr:
    """Return I(θ) = J₀ + m_A r² + (m₃ + m_B) k_s² + J_AB k_φ², the rod as two masses and J_AB = J₂ − m₂ a b."""
    length = s.a + s.b
    k_phi, k_s = ratios(s)
    at_pin, at_piston = s.m2 * s.b / length, s.m2 * s.a / length
    rest = s.J1 + s.m1 * s.c**2 + at_pin * s.r**2
    return rest + (s.m3 + at_piston) * k_s**2 + (s.J2 - s.m2 * s.a * s.b) * k_phi**2


def drawn(pin: tuple[Expr, Expr], piston: tuple[Expr, Expr], s: SimpleNamespace) -> Picture:
    """Return the picture of crank, rod and piston, and of the circle that the pin moves on."""
    w, h = s.r / 2, s.r * 2 / 5
    corners = ((-w, -h), (w, -h), (w, h), (-w, h), (-w, -h))
    box = tuple((piston[0] + x, piston[1] + y) for x, y in corners)
    zero = Integer(0)
    circle = ring((zero, zero), (s.r, zero), (zero, s.r))
    return Picture(masses=(pin, piston), bars=(((zero, zero), pin, piston), box), ground=(circle,))


def speed_at_a_quarter(bound: float) -> Solution:
    """Return the known angular velocity of the crank at θ = π/2: what is left of the energy of I(0) ω²/2."""
    return Solution(
        "θ̇ at θ = π/2 by I(θ) θ̇² = I(0) ω² less the work of P and M",
        "running",
        lambda s: s.theta.dot,
        lambda value, _t: math.sqrt(square_at_a_quarter(value)),
        event=quarter_turn,
        periods=1.0,
        bound=bound,
        condition=REACHED,
    )


def square_at_a_quarter(value: Mapping[str, float]) -> float:
    """Return θ̇² at θ = π/2 by I(θ) θ̇²/2 = I(0) ω²/2 − P (s(π/2) − s(0)) − M π/2; negative where it isn't reached."""
    top, quarter = _at(value, 0.0), _at(value, math.pi / 2.0)
    work = -value.get("P", 0.0) * (_piston(quarter) - _piston(top)) - value.get("M", 0.0) * math.pi / 2.0
    return float((inertia(top) * SPEED**2 + 2.0 * work) / inertia(quarter))


REACHED = Condition("the crank reaches θ = π/2 against P and M", lambda v: square_at_a_quarter(v) > 0.0)


def quarter_turn(s: SimpleNamespace) -> Expr:
    """Return θ − π/2."""
    from sympy import pi

    return s.theta - pi / 2


def _at(value: Mapping[str, float], angle: float) -> SimpleNamespace:
    from sympy import Float

    return SimpleNamespace(**{name: Float(x, 30) for name, x in value.items()}, theta=Float(angle, 30))


def _piston(s: SimpleNamespace) -> Expr:
    """Return s = r cos θ + l cos φ."""
    return s.r * cos(s.theta) + (s.a + s.b) * rod_cosine(s)
