"""Bodies that roll on an incline, by multipliers (first kind) and with one coordinate (second kind)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import cos, sin
from canon.scene.parts import multiplier
from canon.scene.picture import Picture, wheel
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start
from canon.scene.systems.pendulum import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr


__all__ = ["SCENES"]

_SLOPE = Parameter("alpha", 0.3, "rad", "angle of the incline", most=math.pi / 2.0)
_ROLLER = (
    Parameter("m", 2.0, "kg", "mass"),
    Parameter("I", 0.01, "kg m²", "moment of inertia about the axis"),
    Parameter("R", 0.1, "m", "radius"),
    _SLOPE,
    GRAVITY,
)
_CYLINDER = (_ROLLER[0], _ROLLER[2], _SLOPE, GRAVITY)
_SPEED = 2.0


def _time(value: Mapping[str, float]) -> float:
    """Return the time in which it would roll up and back."""
    return 2.0 * _SPEED / (value["g"] * math.sin(value["alpha"]))


def _moment(s: SimpleNamespace) -> Expr:
    """Return the moment of inertia; m R² of a hollow cylinder."""
    return s.I if hasattr(s, "I") else s.m * s.R**2


def _deceleration(value: Mapping[str, float]) -> float:
    moment = value.get("I", value["m"] * value["R"] ** 2)
    return value["g"] * math.sin(value["alpha"]) / (1.0 + moment / (value["m"] * value["R"] ** 2))


def _friction(value: Mapping[str, float]) -> float:
    """Return λ of R θ − s: minus the friction, which points up the slope."""
    return -value["m"] * (value["g"] * math.sin(value["alpha"]) - _deceleration(value))


def _free(s: SimpleNamespace) -> Expr:
    rolling = s.m * s.s.dot**2 / 2 + _moment(s) * s.theta.dot**2 / 2
    return rolling - s.m * s.g * s.s * sin(s.alpha)


def _bound(s: SimpleNamespace) -> Expr:
    return (s.m + _moment(s) / s.R**2) * s.s.dot**2 / 2 - s.m * s.g * s.s * sin(s.alpha)


def _picture(s: SimpleNamespace) -> Picture:
    def place(along: Expr | float, above: Expr | float) -> tuple[Expr, Expr]:
        return (
            along * cos(s.alpha) - above * sin(s.alpha),
            along * sin(s.alpha) + above * cos(s.alpha),
        )

    centre = place(s.s, s.R)
    rim, spoke = wheel(centre, s.R, -s.s / s.R)
    return Picture(masses=(centre,), bars=(rim, spoke), ground=((place(-1.0, 0.0), place(1.5, 0.0)),))


def _scene(name: str, title: str, parameters: tuple[Parameter, ...], *, multipliers: bool) -> Scene:
    """Return a rolling body; with multipliers in s and θ, else in s alone."""
    rolled = Solution(
        "s = v₀ t − a t²/2, a = g sin α/(1 + I/(m R²))",
        "upwards",
        lambda s: s.s,
        lambda v, t: _SPEED * t - _deceleration(v) * t**2 / 2.0,
        periods=2.0,
    )
    friction = Solution(
        "friction −λ = m (g sin α − a)",
        "upwards",
        lambda _s: multiplier(),
        lambda v, _t: _friction(v),
        periods=2.0,
    )
    start = Start(
        "upwards",
        "rolled upwards with 2 m/s",
        q=(0.0, 0.0) if multipliers else (0.0,),
        v=(_SPEED, _SPEED / 0.1) if multipliers else (_SPEED,),
        made_for="R" if multipliers else "",
    )
    return Scene(
        name=name,
        title=title,
        coordinates="s theta" if multipliers else "s",
        parameters=parameters,
        starts=(start,),
        time_scale=_time,
        time_unit="s",
        source="Landau & Lifshitz, Mechanics (3rd ed.), § 38; uniformly accelerated",
        L_of=_free if multipliers else _bound,
        holonomic_of=(lambda s: [s.R * s.theta - s.s]) if multipliers else None,
        integrals=(
            (Integral("rolling: angular velocity less speed/R", lambda s: s.theta.dot - s.s.dot / s.R),)
            if multipliers
            else ()
        ),
        solutions=(rolled, friction) if multipliers else (rolled,),
        horizon=5.0,
        shown=1.0,
        picture_of=_picture,
        energy_bound=1e-12,
        energy_why="kinetic and potential energy grow with t², their sum does not",
    )


SCENES = (
    _scene(
        "roller",
        "Body rolling on an incline, s up the slope: friction as a multiplier",
        _ROLLER,
        multipliers=True,
    ),
    _scene(
        "roller-second-kind",
        "Body rolling on an incline, its constraint eliminated",
        _ROLLER,
        multipliers=False,
    ),
    _scene(
        "hollow-cylinder",
        "Hollow cylinder rolling on an incline: friction as a multiplier, half of m g sin α",
        _CYLINDER,
        multipliers=True,
    ),
    _scene(
        "hollow-cylinder-second-kind",
        "Hollow cylinder rolling on an incline, its constraint eliminated",
        _CYLINDER,
        multipliers=False,
    ),
)
"""The rolling bodies."""
