"""Contact forces by two routes: embedding and Routh's function in mechanics, the constraint manifold in the judge."""

from dataclasses import dataclass

import pytest
import sympy as sp
from sympy import cos, sin

from canon import Lagrangian, coordinates, parameters
from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.reduction.contact import multiplier_along

m, g, a, v, w = parameters("m g a v w", positive=True)
r, theta, phi, x, y = coordinates("r theta phi x y")
PLANE = m * (r.dot**2 + r**2 * theta.dot**2) / 2 - m * g * r * cos(theta)
SPACE = PLANE + m * r**2 * sin(theta) ** 2 * phi.dot**2 / 2
FALL = m * (x.dot**2 + y.dot**2) / 2 - m * g * y


@dataclass(frozen=True)
class Slide:
    """A start in contact: L, f ≥ 0, the place in contact, the coordinate that is left, where and how fast."""

    L: sp.Expr
    f: sp.Expr
    place: dict[sp.Symbol, sp.Expr]
    s: sp.Symbol
    start: sp.Expr
    speed: sp.Expr
    integrals: tuple[sp.Expr, ...]
    others: dict[sp.Symbol, sp.Expr]

    @property
    def q(self):
        return tuple(sorted({self.s, *self.place, *self.others}, key=str))

    def multiplier(self):
        system = ConstrainedLagrangian(Lagrangian(self.L, self.q), holonomic=[self.f])
        return multiplier_along(system, self.place, self.s, self.start, self.speed, others=self.others)

    def verdict(self, value):
        keys = {
            "q": [str(s) for s in self.q],
            "parameters": dict.fromkeys("mgavw", "positive"),
            "L": str(self.L),
            "constraints": [str(self.f)],
            "multipliers": ["N"],
            "integrals": [str(f) for f in self.integrals],
            "values": {"N": str(value)},
        }
        return judge(Claim("a", "reaction", keys))


TURNING = m * a**2 * theta.dot**2 / 2 + m * g * a * cos(theta)
SPIN = m * a**2 * sin(theta) ** 2 * phi.dot
FALLING = m * x.dot**2 * (1 + 4 * x**2 / a**2) / 2 - m * g * x**2 / a
"""Integrals of the motion in contact: energies, and the momentum about the vertical."""

SLIDES = {
    "off a sphere, from rest at the top": Slide(
        PLANE, r - a, {r: a}, theta, sp.S(0), sp.S(0), (TURNING - m * g * a,), {}
    ),
    "off a sphere, pushed": Slide(
        PLANE, r - a, {r: a}, theta, sp.S(0), v / a, (TURNING - m * g * a - m * v**2 / 2,), {}
    ),
    "inside a circle, thrown from its side": Slide(
        PLANE, a - r, {r: a}, theta, sp.pi / 2, v / a, (TURNING - m * v**2 / 2,), {}
    ),
    "over a hill y = −x²/a": Slide(
        FALL, y + x**2 / a, {y: -(x**2) / a}, x, sp.S(0), v, (FALLING - m * v**2 / 2,), {}
    ),
    "in a bowl, turning about its axis": Slide(
        SPACE, a - r, {r: a}, theta, sp.pi / 2, sp.S(0),
        (SPIN - m * a**2 * w, TURNING + SPIN * phi.dot / 2 - m * a**2 * w**2 / 2), {phi: w},
    ),
}  # fmt: skip


@pytest.mark.parametrize("slide", SLIDES.values(), ids=SLIDES)
def test_the_force_of_contact_is_the_judges_and_its_twins_are_wrong(slide):
    force = slide.multiplier()
    assert slide.verdict(force).holds
    for twin in (-force, force.subs(g, 2 * g)):
        assert slide.verdict(twin).fails
