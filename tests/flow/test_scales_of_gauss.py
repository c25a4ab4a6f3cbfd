"""Gauss methods under changes of the unit of mass: the same motion, whatever p is beside q."""

from __future__ import annotations

import pytest
import sympy as sp

from canon import Gauss, Hamiltonian, coordinates, propagate

x = coordinates("x")


def pendulum(mass: sp.Rational) -> Hamiltonian:
    return Hamiltonian(x.momentum**2 / (2 * mass) - mass * sp.cos(x), [x], [x.momentum])


@pytest.mark.parametrize("exponent", [-30, -10, 10, 15])
@pytest.mark.parametrize("step", [0.1, 0.5])
@pytest.mark.parametrize("stages", [2, 6])
def test_no_digits_are_lost_to_a_unit(exponent, step, stages):
    mass = sp.Rational(10) ** exponent
    settings = {"y0": [2, 0], "t_span": (0, 50), "method": Gauss(stages), "step": step, "samples": 10}
    one, other = (propagate(pendulum(m), **settings) for m in (sp.Integer(1), mass))
    assert abs(other.y[0] - one.y[0]).max() < 3e-14
    assert abs(other.y[1] / float(mass) - one.y[1]).max() < 3e-14


def test_beside_an_equilibrium_the_iteration_comes_to_an_end():
    """The momentum there is all rounding, in parts of which nothing converges."""
    tilted = Hamiltonian(x.momentum**2 / 2 - sp.cos(x) - x / 2, [x], [x.momentum])
    settings = {"t_span": (0, 50), "method": Gauss(6), "step": 0.1, "samples": 10}
    for beside in (1e-16, 1e-15, 1e-13):
        motion = propagate(tilted, y0=[float(sp.asin(0.5)) + beside, 0], **settings)
        assert motion.evaluations < 30 * motion.steps * 6
        assert abs(motion.y[1]).max() < 2 * beside
