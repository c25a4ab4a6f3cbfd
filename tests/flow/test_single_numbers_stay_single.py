"""Loops that LLVM's search for parallel scalars compiled wrongly: of these systems the first step was off by 0.2."""

import pytest

from canon import Hamiltonian, coordinates, parameters, propagate
from canon.flow import ExtendedPhaseSpace, SemiexplicitSplitting

x, y = coordinates("x y")
m, k = parameters("m k", positive=True)
p, q = x.momentum, y.momentum
STRETCHED = Hamiltonian(p**2 / (2 * m) * (1 + y**2 / 4) + q**2 / 2 + k * (x**2 + y**2) / 2, [x, y], [p, q])


@pytest.mark.parametrize("precision", ["double", "compensated", "extended"])
@pytest.mark.parametrize(
    "method", [SemiexplicitSplitting(4), SemiexplicitSplitting(6), ExtendedPhaseSpace(4, omega=20)]
)
@pytest.mark.parametrize("mass", [0.75, 1.0, 1.5])
def test_one_step_is_that_of_another_method(method, mass, precision):
    how = {"parameters": {m: mass, k: 1.25}, "samples": 1}
    start = [0.1, 0.2, 0.3, 0.1]
    found = propagate(STRETCHED, (0, 0.05), start, method=method, step=0.05, precision=precision, **how)
    assert found.final == pytest.approx(propagate(STRETCHED, (0, 0.05), start, **how).final, abs=1e-8)
