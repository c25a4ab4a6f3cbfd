"""A charged particle in given fields: crossed ones, a Penning trap, a Paul trap, the dipole of the Earth."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import Rational, cos, sin
from canon.scene.parts import Condition
from canon.scene.picture import Picture, ring
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array

__all__ = ["MATHIEU_LIMIT", "SCENES", "in_fields", "mathieu_exponent"]

_CHARGE = Parameter("e", 1.602176634e-19, "C", "charge", sign="real")
_CHARGED = Condition("without a charge it does not gyrate, so that e ≠ 0", lambda v: v["e"] != 0.0)
_ELECTRON = Parameter("m", 9.1093837e-31, "kg", "mass of the electron")


def in_fields(potentials: Callable[[SimpleNamespace], Sequence[Expr]]) -> Callable[[SimpleNamespace], Expr]:
    """Return L = m v²/2 + A ẋ + B ẏ + C ż − V as a function of a scene's symbols.

    Parameters
    ----------
    potentials
        A, B, C and V as functions of the symbols x, y, z and t; the charge is part of them.

    Examples
    --------
    The force that general A, B, C, V make along x:

    >>> from types import SimpleNamespace
    >>> from canon import Lagrangian, coordinates, parameters
    >>> from sympy import Function
    >>> q = coordinates("x y z")
    >>> m = parameters("m", positive=True)
    >>> s = SimpleNamespace(m=m, **{x.name: x for x in q})
    >>> L = in_fields(lambda s: [Function(name)(*q) for name in "ABCV"])(s)
    >>> Lagrangian(L, q).equations[0].coeff(q[1].dot)
    Derivative(A(x, y, z), y) - Derivative(B(x, y, z), x)
    """

    def lagrangian(s: SimpleNamespace) -> Expr:
        A, B, C, V = potentials(s)
        kinetic = s.m * (s.x.dot**2 + s.y.dot**2 + s.z.dot**2) / 2
        return kinetic + A * s.x.dot + B * s.y.dot + C * s.z.dot - V

    return lagrangian


def _gyration(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi * value["m"] / abs(value["e"] * value["B"])


def _cycloid(value: Mapping[str, float], t: Array) -> Array:
    """Return x = E m/(e B²) (1 − cos ωt), ω = e B/m, from rest."""
    import numpy as np

    rate = value["e"] * value["B"] / value["m"]
    return value["E"] / (value["B"] * rate) * (1.0 - np.cos(rate * t))


def _drift(value: Mapping[str, float], t: Array) -> Array:
    """Return y = −E/B (t − sin(ωt)/ω), from rest: a drift with E × B/B²."""
    import numpy as np

    rate = value["e"] * value["B"] / value["m"]
    return -value["E"] / value["B"] * (t - np.sin(rate * t) / rate)


CROSSED = Scene(
    name="crossed-fields",
    title="Charged particle in crossed fields, E along x and B along z: cycloids that drift with E × B/B²",
    coordinates="x y z",
    parameters=(
        _ELECTRON,
        Parameter("e", -1.602176634e-19, "C", "charge", sign="real"),
        Parameter("B", 0.01, "T", "magnetic field"),
        Parameter("E", 1000.0, "V/m", "electric field", sign="real"),
    ),
    starts=(
        Start("rest", "let go at rest", q=(0.0, 0.0, 0.0), v=(0.0, 0.0, 0.0)),
        Start("helix", "shot along the field and across it", q=(0.0, 0.0, 0.0), v=(1e6, 0.0, 2e5)),
    ),
    conditions=(_CHARGED,),
    time_scale=_gyration,
    time_unit="s",
    source="Jackson, Classical Electrodynamics (3rd ed.), § 12.3",
    L_of=in_fields(lambda s: [0 * s.e, s.e * s.B * s.x, 0 * s.e, -s.e * s.E * s.x]),
    integrals=(
        Integral("canonical momentum p_y", lambda s: s.y.momentum),
        Integral("momentum p_z", lambda s: s.z.momentum),
        Integral(
            "guiding centre, p_x − e B y − e E t",
            lambda s: s.x.momentum - s.e * s.B * s.y - s.e * s.E * s.t,
            1e-11,
            "it is the small difference of terms that grow with time",
        ),
    ),
    solutions=(
        Solution("x: cycloid", "rest", lambda s: s.x, _cycloid),
        Solution("y: cycloid and drift", "rest", lambda s: s.y, _drift),
    ),
    picture_of=lambda s: Picture(masses=((s.x, s.y, s.z),)),
    energy_bound=1e-10,
    energy_why="it drifts away, and what is rounded is its distance, not its speed",
)

_RADIUS = 6.3712e6


def _dipole(s: SimpleNamespace) -> Expr:
    """Return L in cylindrical coordinates with A_φ = −B₀ R³ ρ/r³: the Earth's magnetic north pole is in the south."""
    square = s.rho.dot**2 + s.rho**2 * s.phi.dot**2 + s.z.dot**2
    potential = -s.B * s.R**3 * s.rho**2 * s.phi.dot / (s.rho**2 + s.z**2) ** _three_halves()
    return s.m * square / 2 + s.e * potential


def _three_halves() -> Expr:
    return Rational(3, 2)


_START = 2.0 * _RADIUS
_SPEED = 4.38e7
"""Of a proton of 10 MeV (m/s)."""


def _gyration_at_start(value: Mapping[str, float]) -> float:
    field = value["B"] * (value["R"] / _START) ** 3
    return 2.0 * math.pi * value["m"] / abs(value["e"] * field)


def _dipole_picture(s: SimpleNamespace) -> Picture:
    R, origin = s.R, (0.0, 0.0, 0.0)
    place = (s.rho * cos(s.phi), s.rho * sin(s.phi), s.z)
    equator = ring(origin, (R, 0.0, 0.0), (0.0, R, 0.0))
    meridian = ring(origin, (R, 0.0, 0.0), (0.0, 0.0, R))
    other = ring(origin, (0.0, R, 0.0), (0.0, 0.0, R))
    return Picture(masses=(place,), ground=(equator, meridian, other))


STORMER = Scene(
    name="stormer",
    title="Störmer's problem: a proton of 10 MeV caught in the field of the Earth's dipole",
    coordinates="rho phi z",
    angles="phi",
    parameters=(
        Parameter("m", 1.67262192e-27, "kg", "mass of the proton"),
        _CHARGE,
        Parameter("B", 3.07e-5, "T", "field at the equator"),
        Parameter("R", _RADIUS, "m", "radius of the Earth"),
    ),
    starts=(
        Start(
            "bouncing",
            "at two radii, 45° to the field: it circles, bounces between north and south, and drifts",
            q=(_START, 0.0, 0.0),
            v=(_SPEED * math.sqrt(0.5), 0.0, _SPEED * math.sqrt(0.5)),
        ),
        Start(
            "equatorial",
            "across the field in the plane of the equator",
            q=(_START, 0.0, 0.0),
            v=(_SPEED, 0.0, 0.0),
        ),
    ),
    conditions=(_CHARGED,),
    time_scale=_gyration_at_start,
    time_unit="s",
    source="Störmer, The Polar Aurora (Oxford, 1955); Dragt, Rev. Geophys. 3, 255 (1965), doi:10.1029/RG003i002p00255; "
    "Newtonian mass",
    L_of=_dipole,
    integrals=(Integral("canonical angular momentum p_phi", lambda s: s.phi.momentum),),
    picture_of=_dipole_picture,
    shown=150.0,
)

_SIZE = {"m": 9.1093837e-31, "e": 1.602176634e-19, "B": 0.5, "U": 10.0, "d": 3.5e-3}


def _trap(s: SimpleNamespace) -> list[Expr]:
    """Return A, B, C of a uniform field along z, and V = e U (z² − (x² + y²)/2)/(2 d²)."""
    bowl = s.z**2 - (s.x**2 + s.y**2) / 2
    return [-s.e * s.B * s.y / 2, s.e * s.B * s.x / 2, 0 * s.e, s.e * s.U * bowl / (2 * s.d**2)]


def _rates(value: Mapping[str, float]) -> tuple[float, float, float]:
    """Return ω_z, ω₊ and ω₋: ω_z² = e U/(m d²), ω± = ω_c/2 ± √(ω_c²/4 − ω_z²/2)."""
    axial = math.sqrt(value["e"] * value["U"] / (value["m"] * value["d"] ** 2))
    half = value["e"] * value["B"] / (2.0 * value["m"])
    split = math.sqrt(half**2 - axial**2 / 2.0)
    return axial, half + split, half - split


_AXIAL, _RADIAL = 1e-4, 2e-4


def _axial(value: Mapping[str, float], t: Array) -> Array:
    import numpy as np

    return _AXIAL * np.cos(_rates(value)[0] * t)


def _radial(value: Mapping[str, float], t: Array) -> Array:
    """Return x of x + iy = a (ω₊ e^(−iω₋t) − ω₋ e^(−iω₊t))/(ω₊ − ω₋), from rest at x = a."""
    import numpy as np

    _, fast, slow = _rates(value)
    return _RADIAL * (fast * np.cos(slow * t) - slow * np.cos(fast * t)) / (fast - slow)


PENNING = Scene(
    name="penning-trap",
    title="Penning trap: a charge held by a uniform magnetic field and an electric quadrupole",
    coordinates="x y z",
    parameters=(
        Parameter("m", _SIZE["m"], "kg", "mass of the electron"),
        Parameter("e", _SIZE["e"], "C", "charge, positive: a positron"),
        Parameter("B", _SIZE["B"], "T", "magnetic field along z"),
        Parameter("U", _SIZE["U"], "V", "voltage of the trap"),
        Parameter("d", _SIZE["d"], "m", "size of the trap"),
    ),
    conditions=(
        Condition(
            "the magnetic field holds the charge only where (e B/m)² > 2 e U/(m d²)",
            lambda v: v["e"] * v["B"] ** 2 / v["m"] > 2.0 * v["U"] / v["d"] ** 2,
        ),
    ),
    starts=(Start("rest", "let go at rest, aside and above", q=(_RADIAL, 0.0, _AXIAL), v=(0.0, 0.0, 0.0)),),
    time_scale=lambda value: 2.0 * math.pi / _rates(value)[0],
    time_unit="s",
    source="Brown & Gabrielse, Rev. Mod. Phys. 58, 233 (1986), doi:10.1103/RevModPhys.58.233",
    L_of=in_fields(_trap),
    integrals=(
        Integral("canonical angular momentum", lambda s: s.x * s.y.momentum - s.y * s.x.momentum),
        Integral(
            "energy of the axial oscillation",
            lambda s: s.z.momentum**2 / (2 * s.m) + s.e * s.U * s.z**2 / (2 * s.d**2),
        ),
    ),
    solutions=(
        Solution("z: axial oscillation", "rest", lambda s: s.z, _axial),
        Solution("x: magnetron and cyclotron motion", "rest", lambda s: s.x, _radial, bound=1e-10),
    ),
    energy_bound=1e-8,
    energy_why="m v is the small difference of p and e A, its energy a ten-thousandth of their terms",
    shown=240.0,
    picture_of=lambda s: Picture(masses=((s.x, s.y, s.z),)),
)

MATHIEU_LIMIT = 0.9080463
"""Where the first region of stability of Mathieu's equation with a = 0 ends."""
_FOURIER = 12


def _mathieu(value: Mapping[str, float]) -> float:
    """Return q = 2 e V/(m r₀² W²) of Mathieu's equation x'' + 2 q cos(2 τ) x = 0, τ = W t/2."""
    return 2.0 * value["e"] * value["V"] / (value["m"] * value["d"] ** 2 * value["W"] ** 2)


def _ratios(q: float, beta: float) -> list[float]:
    """Return C₁/C₀, C₂/C₁, … of (2 n + β)² C_n = q (C_{n−1} + C_{n+1}), by its continued fraction."""
    found = [0.0]
    for n in range(_FOURIER, 0, -1):
        found.insert(0, q / ((2.0 * n + beta) ** 2 - q * found[0]))
    return found[:-1]


def mathieu_exponent(q: float) -> float:
    """Return β with x = Σ C_n cos((2 n + β) τ) for x'' + 2 q cos(2 τ) x = 0, in the first region of stability.

    Examples
    --------
    >>> round(mathieu_exponent(0.4), 9), round(0.4 / math.sqrt(2.0), 9)
    (0.292566211, 0.282842712)

    Source: N. W. McLachlan, Theory and Application of Mathieu Functions (1947), section 5.10.
    """
    low, high = 0.0, 1.0
    while (middle := (low + high) / 2.0) not in (low, high):
        gap = middle**2 - q * (_ratios(q, middle)[0] + _ratios(q, -middle)[0])
        low, high = (middle, high) if gap < 0.0 else (low, middle)
    return middle


_ASIDE = 10.0


def _caught(value: Mapping[str, float], t: Array, sign: float) -> Array:
    """Return the even solution of Mathieu's equation from rest at 10 µm."""
    import numpy as np

    q = sign * _mathieu(value)
    beta = mathieu_exponent(q)
    above, below = (np.cumprod(_ratios(q, each)) for each in (beta, -beta))
    coefficients = np.concatenate([below[::-1], [1.0], above])
    rates = 2.0 * np.arange(-_FOURIER, _FOURIER + 1) + beta
    swings = np.cos(np.multiply.outer(value["W"] * t / 2.0, rates))
    return np.asarray(_ASIDE * swings @ coefficients / coefficients.sum())


PAUL = Scene(
    name="paul-trap",
    title="Paul trap: a calcium ion held in a plane by an electric quadrupole that oscillates; stable for q < 0.908",
    coordinates="x y",
    parameters=(
        Parameter("m", 39.9620, "u", "mass of the ion, 40Ca+"),
        Parameter("e", 9.648533212e7, "u um^2/(us^2 V)", "charge"),
        Parameter("V", 100.0, "V", "amplitude of the voltage"),
        Parameter("d", 500.0, "um", "distance of the electrodes from the axis"),
        Parameter("W", 2.0 * math.pi * 12.0, "rad/us", "angular frequency of the voltage"),
    ),
    conditions=(
        Condition(
            "the ion is held where |q| = 2 e V/(m d² W²) is below 0.908",
            lambda v: abs(_mathieu(v)) < MATHIEU_LIMIT,
        ),
    ),
    starts=(Start("rest", "let go at rest, 10 µm aside", q=(_ASIDE, _ASIDE), v=(0.0, 0.0)),),
    time_scale=lambda value: 2.0 * math.pi / value["W"],
    time_unit="us",
    source="W. Paul, Rev. Mod. Phys. 62, 531 (1990), doi:10.1103/RevModPhys.62.531",
    L_of=lambda s: (
        s.m * (s.x.dot**2 + s.y.dot**2) / 2 - s.e * s.V * cos(s.W * s.t) * (s.x**2 - s.y**2) / (2 * s.d**2)
    ),
    solutions=(
        Solution(
            "x: Mathieu's equation, by its Fourier series",
            "rest",
            lambda s: s.x,
            lambda v, t: _caught(v, t, 1.0),
            periods=50.0,
            bound=1e-12,
        ),
        Solution(
            "y: the same with −q",
            "rest",
            lambda s: s.y,
            lambda v, t: _caught(v, t, -1.0),
            periods=50.0,
            bound=1e-12,
        ),
    ),
    energy_bound=1e-10,
    energy_why="the work goes to and fro with every oscillation, and is summed",
    picture_of=lambda s: Picture(masses=((s.x, s.y),)),
    shown=40.0,
)

SCENES = (CROSSED, PENNING, PAUL, STORMER)
"""The charged particles."""
