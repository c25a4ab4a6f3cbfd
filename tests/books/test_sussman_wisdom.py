"""Numbers of Sussman & Wisdom, Structure and Interpretation of Classical Mechanics: actions, Hénon and Heiles."""

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, Lagrangian, coordinates
from canon.expression.symbols.symbol import velocity
from canon.flow import Splitting, largest_lyapunov_exponent

t = sp.Symbol("t", real=True)


@pytest.mark.parametrize(
    ("variation", "printed", "right"),
    [
        (0, 435.0, True),
        (0, 436.0, False),
        pytest.param("0.001", 436.2912142857153, True, marks=pytest.mark.slow),
        pytest.param("0.001", 435.0, False, marks=pytest.mark.slow),
    ],
)
def test_the_action_of_a_path(variation, printed, right):
    """§ 1.4: mass 3, path (4t + 7, 3t + 5, 2t + 1) for ten seconds, and with ε t(t − 10)(sin t, cos t, t²) added."""
    q = coordinates("x y z")
    L = Lagrangian(sp.Rational(3, 2) * sum(velocity(x) ** 2 for x in q), q)
    bump = sp.Rational(variation) * t * (t - 10)
    path = [4 * t + 7 + bump * sp.sin(t), 3 * t + 5 + bump * sp.cos(t), 2 * t + 1 + bump * t**2]
    along = L.L.subs({velocity(x): f.diff(t) for x, f in zip(q, path, strict=True)})
    assert bool(abs(float(sp.integrate(sp.expand(along), (t, 0, 10))) - printed) < 1e-8) is right


@pytest.mark.slow
@pytest.mark.parametrize(
    ("energy", "y", "chaotic"),
    [(1 / 12, 0.1, False), (1 / 8, -0.15, True), (1 / 8, 0.3, False), (1 / 6, -0.15, True)],
)
def test_henon_and_heiles_divide_their_phase_space(energy, y, chaotic):
    """§ 3.6.3: at 1/12 curves, at 1/8 islands in a chaotic zone, at 1/6 mostly chaos; starts on x = 0, p_y = 0."""
    q = coordinates("x y")
    p = [x.momentum for x in q]
    H = Hamiltonian((sum(x**2 for x in (*q, *p))) / 2 + q[0] ** 2 * q[1] - q[1] ** 3 / 3, q, p)
    speed = np.sqrt(2 * energy - y**2 + 2 * y**3 / 3)
    found = largest_lyapunov_exponent(
        H, (0, 4000), [0, y, speed, 0], method=Splitting("kahan-li-8"), step=0.2
    )
    assert bool(found.verdict.value == "chaotic") is chaotic
    assert bool(found.verdict.value == "regular") is not chaotic
