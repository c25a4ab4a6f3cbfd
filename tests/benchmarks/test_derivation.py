"""The peers of benchmarks/derivation.py derive the same links as canon: else its ratios would compare nothing."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from derivation import accelerations_of, by_kane, by_lagrange, planar_pendulum

from canon.mechanics.at_scale.numeric_functions import acceleration_function
from canon.mechanics.at_scale.second_order import derivation


@pytest.mark.parametrize("by", [by_lagrange, by_kane])
@pytest.mark.parametrize("n", [1, 2, 3])
def test_sympy_derives_the_same_accelerations(by, n):
    derive, places, speeds = by(n)
    theirs = accelerations_of(*derive(), places, speeds, n)
    bodies, q, field = planar_pendulum(n)
    equations = derivation(bodies, q, field=field)
    ours = acceleration_function(equations, dict.fromkeys(equations.parameters, 0.1))(
        [0.1] * n, [0.1] * n, 0.0
    )
    assert theirs == pytest.approx(np.asarray(ours).ravel(), rel=1e-12, abs=1e-14)
    assert np.abs(theirs).max() > 0.05
