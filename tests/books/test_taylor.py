"""Numbers of Taylor, Classical Mechanics: the damped pendulum under a drive doubles its period again and again."""

import numpy as np
import pytest
import sympy as sp

from canon import Lagrangian, coordinates, propagate
from canon.expression.symbols.symbol import velocity
from canon.flow import Taylor

pytestmark = pytest.mark.slow
phi, gamma, t = coordinates("phi"), sp.Symbol("gamma", positive=True), sp.Symbol("t", real=True)
W0 = 3 * sp.pi
FORCE = -W0 / 2 * velocity(phi) + gamma * W0**2 * sp.cos(2 * sp.pi * t)
PENDULUM = Lagrangian(velocity(phi) ** 2 / 2 + W0**2 * sp.cos(phi), [phi], forces=[FORCE], t=t)


@pytest.mark.parametrize(
    ("strength", "period", "right"),
    [
        (1.065, 1, True),
        (1.068, 2, True),
        (1.068, 1, False),
        (1.078, 2, True),
        (1.080, 4, True),
        (1.080, 2, False),
        (1.0815, 4, True),
        (1.0824, 8, True),
        (1.0824, 4, False),
    ],
)
def test_periods_of_the_driven_pendulum(strength, period, right):
    """§ 12.5: ω = 2π, ω₀ = 1.5ω, β = ω₀/4, from φ = −π/2: thresholds at γ = 1.0663, 1.0793, 1.0821."""
    times = np.arange(1400, 1465.0)
    motion = propagate(
        PENDULUM, (0, 1464), [-np.pi / 2, 0], parameters={gamma: strength}, method=Taylor(), times=times
    )
    angle = np.asarray(motion.y)[0, -len(times) :]
    repeats = [n for n in (1, 2, 4, 8) if np.abs(angle[n:] - angle[:-n]).max() < 1e-3]
    assert bool(repeats[:1] == [period]) is right
