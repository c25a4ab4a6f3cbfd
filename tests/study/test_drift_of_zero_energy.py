"""Drift of an energy that begins at zero: what is large and what is rounding is told by the size of its terms."""

import pytest
from sympy import Rational

from canon import RK4, Hamiltonian, Lagrangian, Splitting, coordinates, parameters, propagate
from canon.study import drift

x = coordinates("x")
s = parameters("s", positive=True)
QUARTIC = Hamiltonian(s * (x.momentum**2 / 2 + x**4 / 4 - Rational(1, 4)), [x], [x.momentum])


@pytest.mark.parametrize("scale", [1.0, 1e-20, 1e10])
@pytest.mark.parametrize(
    ("method", "step", "verdict"), [(RK4(), 0.25, "secular"), (Splitting("verlet"), 0.05, "bounded")]
)
def test_the_verdict_does_not_hang_on_the_unit_of_energy(scale, method, step, verdict):
    motion = propagate(
        QUARTIC,
        (0, 2000 / scale),
        [1.0, 0.0],
        parameters={s: scale},
        method=method,
        step=step / scale,
        samples=4096,
    )
    assert drift(motion).verdict.value == verdict


def test_a_lagrangian_whose_energy_at_the_start_is_rounding():
    from math import pi

    from sympy import cos

    swinging = Lagrangian(x.dot**2 / 2 + cos(x), [x])
    motion = propagate(swinging, (0, 100), [pi / 2, 0.0])
    assert not motion.relative
    assert abs(motion.energy_error).max() < 1e-14
