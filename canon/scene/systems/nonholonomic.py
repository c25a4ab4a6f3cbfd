"""Bodies that cannot slip: Chaplygin's sleigh, the rolling disc and the unicycle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import cos, sin
from canon.scene.parts import multiplier
from canon.scene.picture import Picture, ring
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start
from canon.scene.systems.pendulum import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array
    from canon.mechanics.lagrange.body import Body

__all__ = ["SCENES"]


def _sleigh_body(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import PlanarBody

    centre = (s.x + s.a * cos(s.theta), s.y + s.a * sin(s.theta))
    return [PlanarBody(s.m, centre, s.I, s.theta)]


def _sleigh(s: SimpleNamespace) -> Expr:
    across = s.y.dot * cos(s.theta) - s.x.dot * sin(s.theta)
    square = s.x.dot**2 + s.y.dot**2 + s.a**2 * s.theta.dot**2 + 2 * s.a * s.theta.dot * across
    return s.m * square / 2 + s.I * s.theta.dot**2 / 2


def _across(s: SimpleNamespace) -> Sequence[Expr]:
    return [s.y.dot * cos(s.theta) - s.x.dot * sin(s.theta)]


def _forwards(s: SimpleNamespace) -> Expr:
    return s.x.dot * cos(s.theta) + s.y.dot * sin(s.theta)


def _gyration(value: Mapping[str, float]) -> float:
    """Return k = √(I/m + a²), the radius of gyration about the blade."""
    return math.sqrt(value["I"] / value["m"] + value["a"] ** 2)


_TURNING = 2.0


def _sleigh_rate(value: Mapping[str, float]) -> float:
    return value["a"] * _TURNING / _gyration(value)


def _sleigh_picture(s: SimpleNamespace) -> Picture:
    along, across = (cos(s.theta), sin(s.theta)), (-sin(s.theta), cos(s.theta))

    def place(forwards: Expr, aside: Expr) -> tuple[Expr, Expr]:
        return (
            s.x + forwards * along[0] + aside * across[0],
            s.y + forwards * along[1] + aside * across[1],
        )

    a = s.a
    hull = tuple(
        place(*corner) for corner in ((-a, -a), (2 * a, -a), (3 * a, 0 * a), (2 * a, a), (-a, a), (-a, -a))
    )
    return Picture(masses=(place(a, 0 * a),), bars=(hull, (place(-a / 2, 0 * a), place(a / 2, 0 * a))))


SLEIGH = Scene(
    name="chaplygin-sleigh",
    title="Chaplygin's sleigh: a body on a blade that does not slip sideways",
    coordinates="x y theta",
    angles="theta",
    parameters=(
        Parameter("m", 20.0, "kg", "mass"),
        Parameter("I", 1.5, "kg m²", "moment of inertia about the centre of mass"),
        Parameter("a", 0.3, "m", "distance of the centre of mass ahead of the blade"),
    ),
    starts=(
        Start("spun", "turned on the spot, and let go", q=(0.0, 0.0, 0.0), v=(0.0, 0.0, _TURNING)),
        Start("backwards", "pushed backwards, hardly turning", q=(0.0, 0.0, 0.0), v=(-1.0, 0.0, 0.05)),
    ),
    time_scale=lambda value: 2.0 * math.pi / _sleigh_rate(value),
    time_unit="s",
    source="Chaplygin, Mat. Sb. 28, 303 (1911); Neimark & Fufaev, Dynamics of Nonholonomic Systems",
    L_of=_sleigh,
    bodies_of=_sleigh_body,
    nonholonomic_of=_across,
    integrals=(
        Integral(
            "energy m (u² + k² ω²)/2",
            lambda s: (s.m * _forwards(s) ** 2 + (s.I + s.m * s.a**2) * s.theta.dot**2) / 2,
        ),
    ),
    solutions=(
        Solution(
            "forward speed: k ω₀ tanh(a ω₀ t/k)",
            "spun",
            _forwards,
            lambda v, t: _gyration(v) * _TURNING * _tanh(_sleigh_rate(v) * t),
            periods=3.0,
        ),
        Solution(
            "angular velocity: ω₀ / cosh(a ω₀ t/k)",
            "spun",
            lambda s: s.theta.dot,
            lambda v, t: _TURNING / _cosh(_sleigh_rate(v) * t),
            periods=3.0,
        ),
    ),
    picture_of=_sleigh_picture,
)


def _tanh(x: Array) -> Array:
    import numpy as np

    return np.tanh(x)


def _cosh(x: Array) -> Array:
    import numpy as np

    return np.cosh(x)


def _disc_body(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import RigidBody, euler_rotation

    place = (s.x, s.y, s.R * sin(s.theta))
    across = s.m * s.R**2 / 4
    return [RigidBody(s.m, place, (across, across, 2 * across), euler_rotation(s.phi, s.theta, s.psi))]


def _spin(s: SimpleNamespace) -> Expr:
    return s.psi.dot + s.phi.dot * cos(s.theta)


def _disc(s: SimpleNamespace) -> Expr:
    theta = s.theta
    centre = s.x.dot**2 + s.y.dot**2 + s.R**2 * cos(theta) ** 2 * theta.dot**2
    turning = (theta.dot**2 + s.phi.dot**2 * sin(theta) ** 2) / 8 + _spin(s) ** 2 / 4
    return s.m * centre / 2 + s.m * s.R**2 * turning - _disc_height(s)


def _disc_height(s: SimpleNamespace) -> Expr:
    return s.m * s.g * s.R * sin(s.theta)


def _rolling(s: SimpleNamespace) -> Sequence[Expr]:
    """Return v − ω × r = 0 at the lowest point of the rim, r from there to the centre."""
    rise = s.theta.dot * sin(s.theta)
    return [
        s.x.dot - s.R * (rise * sin(s.phi) - _spin(s) * cos(s.phi)),
        s.y.dot + s.R * (rise * cos(s.phi) + _spin(s) * sin(s.phi)),
    ]


def _steady_spin(value: Mapping[str, float], tilt: float, turning: float) -> float:
    """Return ω₃ = (Ω² sin θ cos θ/4 − (g/R) cos θ)/(3 Ω sin θ/2) of a disc on a circle (A = m R²/4, C = 2 A)."""
    c, s = math.cos(tilt), math.sin(tilt)
    return (turning**2 * s * c / 4.0 - value["g"] / value["R"] * c) / (1.5 * turning * s)


_TILT, _CIRCLING, _DISC = 1.2, 3.0, {"R": 0.1, "g": GRAVITY.value}
_OMEGA3 = _steady_spin(_DISC, _TILT, _CIRCLING)


def _rolled(name: str, about: str, tilt: float, turning: float, spin: float) -> Start:
    """Return the start with ω₃ = spin, heading φ = 0, that rolls."""
    return Start(
        name, about, q=(0.0, 0.0, tilt, 0.0, 0.0),
        v=(-_DISC["R"] * spin, 0.0, 0.0, turning, spin - turning * math.cos(tilt)), made_for="R g",
    )  # fmt: skip


def _disc_picture(s: SimpleNamespace) -> Picture:
    from canon.mechanics.algebra.substitution import entry
    from canon.mechanics.lagrange.body import euler_rotation

    R = euler_rotation(s.phi, s.theta, s.psi)
    centre = (s.x, s.y, s.R * sin(s.theta))
    first, second = ([s.R * entry(R, i, j) for i in range(3)] for j in range(2))
    spoke = (centre, tuple(c + a for c, a in zip(centre, first, strict=True)))
    return Picture(masses=(centre,), bars=(ring(centre, first, second), spoke))


DISC = Scene(
    name="rolling-disc",
    title="Rolling disc: a thin disc on a horizontal plane, tilted by π/2 − θ, without slipping",
    coordinates="x y theta phi psi",
    angles="theta phi psi",
    parameters=(
        Parameter("m", 0.2, "kg", "mass"),
        Parameter("R", _DISC["R"], "m", "radius"),
        GRAVITY,
    ),
    starts=(
        _rolled("circle", "steadily on a circle, leaning inwards", _TILT, _CIRCLING, _OMEGA3),
        _rolled("straight", "upright, faster than √(g R/3), so that it stays up", math.pi / 2.0, 0.0, -12.0),
        _rolled("wobbling", "leaning, and too fast for its circle", 1.3, 1.0, -14.0),
    ),
    time_scale=lambda value: 2.0 * math.pi * math.sqrt(value["R"] / value["g"]),
    time_unit="s",
    source="Neimark & Fufaev, Dynamics of Nonholonomic Systems; circle: Euler's equations with θ and φ̇ constant",
    L_of=_disc,
    bodies_of=_disc_body,
    V_of=_disc_height,
    nonholonomic_of=_rolling,
    solutions=(
        Solution("tilt on the circle stays", "circle", lambda s: s.theta, lambda _v, _t: _TILT),
        Solution("rate of circling", "circle", lambda s: s.phi, lambda _v, t: _CIRCLING * t),
        Solution("upright and straight: x", "straight", lambda s: s.x, lambda v, t: 12.0 * v["R"] * t),
    ),
    picture_of=_disc_picture,
)

_CIRCLE, _TURN = 1.5, 0.5


def _unicycle_place(value: Mapping[str, float], t: Array) -> tuple[Array, Array]:
    """Return x = (u/ω) sin ωt, y = (u/ω)(1 − cos ωt): constant speed u, constant turning ω."""
    import numpy as np

    del value
    return _CIRCLE / _TURN * np.sin(_TURN * t), _CIRCLE / _TURN * (1.0 - np.cos(_TURN * t))


def _unicycle_picture(s: SimpleNamespace) -> Picture:
    along = (cos(s.theta) / 4, sin(s.theta) / 4)
    return Picture(
        masses=((s.x, s.y),), bars=(((s.x - along[0], s.y - along[1]), (s.x + along[0], s.y + along[1])),)
    )


UNICYCLE = Scene(
    name="unicycle",
    title="Unicycle: it rolls where it is headed, ẏ cos θ = ẋ sin θ, and reaches every place",
    coordinates="x y theta",
    angles="theta",
    parameters=(
        Parameter("m", 80.0, "kg", "mass with its rider"),
        Parameter("I", 2.0, "kg m²", "moment of inertia about the vertical"),
    ),
    starts=(Start("circle", "rolling and turning, no torque", q=(0.0, 0.0, 0.0), v=(_CIRCLE, 0.0, _TURN)),),
    time_scale=lambda _value: 2.0 * math.pi / _TURN,
    time_unit="s",
    source="Neimark & Fufaev, Dynamics of Nonholonomic Systems; not integrable: 3 coordinates, 2 velocities",
    L_of=lambda s: s.m * (s.x.dot**2 + s.y.dot**2) / 2 + s.I * s.theta.dot**2 / 2,
    nonholonomic_of=_across,
    integrals=(
        Integral("angular momentum about the vertical", lambda s: s.I * s.theta.dot),
        Integral("speed", _forwards),
    ),
    solutions=(
        Solution("x on the circle", "circle", lambda s: s.x, lambda v, t: _unicycle_place(v, t)[0]),
        Solution("y on the circle", "circle", lambda s: s.y, lambda v, t: _unicycle_place(v, t)[1]),
        Solution(
            "multiplier: the centripetal force m u ω",
            "circle",
            lambda _s: multiplier(),
            lambda v, _t: v["m"] * _CIRCLE * _TURN,
        ),
    ),
    picture_of=_unicycle_picture,
)

SCENES = (SLEIGH, DISC, UNICYCLE)
"""The nonholonomic bodies."""
