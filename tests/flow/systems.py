"""Small systems that the tests of motion share, each with a starting state."""

from dataclasses import dataclass

import sympy as sp

from canon.expression.symbols.symbol import coordinates, time

x, y, theta, phi = coordinates("x y theta phi")


@dataclass(frozen=True)
class System:
    """What propagate asks of a Hamiltonian, without the room that makes them."""

    H: sp.Expr
    q: tuple
    p: tuple
    t: sp.Symbol = time


def _kinetic(*q):
    return sum(s.momentum**2 for s in q) / 2


HENON_HEILES = System(
    _kinetic(x, y) + (x**2 + y**2) / 2 + x**2 * y - y**3 / 3, (x, y), (x.momentum, y.momentum)
)
HENON_HEILES_START = [0.1, 0.2, 0.3, 0.1]

KEPLER = System(_kinetic(x, y) - 1 / sp.sqrt(x**2 + y**2), (x, y), (x.momentum, y.momentum))

PENDULUM = System(_kinetic(theta) - sp.cos(theta), (theta,), (theta.momentum,))

DRIVEN = System(
    _kinetic(x) * (1 + sp.sin(time) / 5) - (1 + sp.Rational(3, 10) * sp.cos(time)) * sp.cos(x),
    (x,),
    (x.momentum,),
)
DRIVEN_START = [1.0, 0.5]

DOUBLE_PENDULUM = System(
    (theta.momentum**2 + 2 * phi.momentum**2 - 2 * theta.momentum * phi.momentum * sp.cos(theta - phi))
    / (2 * (1 + sp.sin(theta - phi) ** 2))
    - 2 * sp.cos(theta)
    - sp.cos(phi),
    (theta, phi),
    (theta.momentum, phi.momentum),
)
DOUBLE_PENDULUM_START = [1.0, 0.4, 0.1, -0.2]


RELATIVISTIC = System(sp.sqrt(1 + x.momentum**2) * (1 + x**2 / 2), (x,), (x.momentum,))
"""A particle whose speed stays below 1 in a well that scales its energy; one degree, so errors are smooth in h."""
RELATIVISTIC_START = [1.0, 0.5]


def kepler_start(eccentricity):
    """At the pericentre of an orbit with semi-major axis 1 and period 2π."""
    e = eccentricity
    return [1 - e, 0.0, 0.0, ((1 + e) / (1 - e)) ** 0.5]
