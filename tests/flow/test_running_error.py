"""By how much rounding puts forces wrong: a bound that holds in single precision, and is not far too large."""

import numpy as np
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import Hamiltonian, coordinates, propagate
from canon.expression.graph.number_systems import _numpy
from canon.flow.checked_request import hamilton_equations_of
from canon.flow.run.running_error import rounding_of_rates

x, y = coordinates("x y")
px, py = x.momentum, y.momentum
UNIT = 2.0**-24
SINGLE = _numpy(np.float32)

POTENTIALS = (
    sp.exp(x) + sp.exp(-x) + y**2,
    (x - y) ** 4 + sp.cos(x * y),
    sp.sqrt(1 + x**2) + sp.log(2 + y**2) * x,
    sp.atan(x) / 3 + x**7 * y / 11 - sp.sin(x) * sp.cosh(y),
    1 / (x**2 + y**2 + 1) + (2 + y) ** sp.Rational(4, 3),
)


@settings(max_examples=60)
@given(st.sampled_from(POTENTIALS), st.lists(st.floats(-2, 2, width=32), min_size=4, max_size=4))
def test_rates_in_single_precision_are_within_it(V, state):
    system = hamilton_equations_of(Hamiltonian((px**2 + py**2) / 2 + V, [x, y], [px, py]), {})
    t, point = np.zeros(1), np.array(state)[:, np.newaxis, np.newaxis]
    bound = rounding_of_rates(system, t, point)[:, 0, 0]
    exact = system.graph.evaluate(
        (*system.velocity, *system.force),
        dict(zip(system.inputs, [*map(np.float64, state), 0.0], strict=True)),
    )
    narrow = system.graph.evaluate(
        (*system.velocity, *system.force),
        dict(zip(system.inputs, [*map(np.float32, state), np.float32(0)], strict=True)),
        SINGLE,
    )
    for a, b, allowed in zip(exact, narrow, bound, strict=True):
        assert abs(float(a) - float(b)) <= 4 * UNIT * float(allowed) + 1e-37


def test_terms_that_cancel_are_counted():
    system = hamilton_equations_of(Hamiltonian(px**2 / 2 + sp.exp(x) + sp.exp(-x), [x], [px]), {})
    near = np.array([[[1e-18]], [[0.0]]])
    velocity, force = rounding_of_rates(system, np.zeros(1), near)[:, 0, 0]
    assert velocity == 0
    assert 2 <= force <= 8


def test_an_estimate_beside_an_equilibrium_knows_what_its_companion_can():
    """The force there is rounding; the motion is x = 1e-18 cosh(…) to all digits that matter."""
    H = Hamiltonian(px**2 / 2 - sp.exp(x) - sp.exp(-x), [x], [px])
    start = [1e-18, 0.0]
    motion = propagate(H, (0, 3), start, samples=6)
    true = 1e-18 * np.cosh(np.sqrt(2.0) * motion.t)
    assert (abs(motion["x"] - true) <= motion.error_estimate().error[0] + 1e-15 * true).all()
