"""Hamiltonians that depend on time, in every method and precision."""

import numpy as np
import pytest

from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor
from canon.flow.propagation import propagate
from canon.kernel.schemes.splitting_schemes import SCHEMES
from tests.flow.systems import DRIVEN, DRIVEN_START

SPAN = (0.5, 8.0)
# An oscillation of frequency 1 (that of small swings, averaged over the drive) shifts in phase by h²/24 a unit of time
# with Verlet's method and by h²/12 with the midpoint rule; x and p stay below 1.3.
PHASE = 1.3 * (SPAN[1] - SPAN[0]) * 0.1**2
METHODS = [
    *(
        (Splitting(name), PHASE / 24 if SCHEMES[name].order == 2 else 1e-5)
        for name in SCHEMES
        if not SCHEMES[name].nystrom
    ),
    *((Gauss(s), {1: PHASE / 12, 2: 1e-6}.get(s, 1e-8)) for s in range(1, 9)),
    (RK4(), 1e-5),
]


@pytest.fixture(scope="module")
def true():
    return propagate(DRIVEN, SPAN, DRIVEN_START, samples=15).y


@pytest.mark.parametrize(("method", "bound"), METHODS, ids=str)
def test_fixed_steps_follow_the_clock(true, method, bound):
    coarse, fine = (
        abs(propagate(DRIVEN, SPAN, DRIVEN_START, method=method, step=step, samples=15).y - true).max()
        for step in (0.1, 0.05)
    )
    assert coarse < bound
    assert fine < max(1.5 * 2.0**-method.order * coarse, 3e-14)


@pytest.mark.parametrize("precision", ["single", "double", "compensated", "extended", "double-double"])
@pytest.mark.parametrize("method", [Splitting("sofroniou-spaletta-10"), Gauss(6)], ids=str)
def test_in_every_precision(true, method, precision):
    motion = propagate(DRIVEN, SPAN, DRIVEN_START, method=method, step=0.05, precision=precision, samples=15)
    np.testing.assert_allclose(motion.y, true, atol=1e-5 if precision == "single" else 2e-13)


@pytest.mark.parametrize("method", [Taylor(), DOP853()], ids=str)
def test_adaptive_methods_agree_both_ways(true, method):
    np.testing.assert_allclose(
        propagate(DRIVEN, SPAN, DRIVEN_START, method=method, samples=15).y, true, atol=1e-9
    )
    back = propagate(DRIVEN, SPAN[::-1], true[:, -1], method=method, samples=15)
    np.testing.assert_allclose(back.y[:, ::-1], true, atol=1e-9)
