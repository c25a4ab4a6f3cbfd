"""What ended in errors of NumPy's or Python's own is said in words: where it is wrong and what to do."""

import numpy as np
import pytest
import sympy as sp

from canon import ConstrainedLagrangian, Hamiltonian, Lagrangian, coordinates, propagate
from canon.flow import NonFiniteStateError

x, y = coordinates("x y")
p = x.momentum
SPRING = Hamiltonian(p**2 / 2 + x**2 / 2, [x], [p])


def test_masked_numbers_are_no_start():
    with pytest.raises(ValueError, match="masked"):
        propagate(SPRING, (0, 1), np.ma.array([1.0, 0.0], mask=[False, True]))
    plain = propagate(SPRING, (0, 1), np.ma.array([1.0, 0.0]), samples=1)
    assert (plain.final == propagate(SPRING, (0, 1), [1.0, 0.0], samples=1).final).all()


def test_so_many_digits_are_too_many():
    with pytest.raises(ValueError, match="300 decimal digits"):
        propagate(SPRING, (0, 1), [1.0, 0.0], precision=400, samples=1)


def test_a_constraint_without_a_gradient_is_named():
    falling = Lagrangian((x.dot**2 + y.dot**2) / 2 - y, [x, y])
    squared = ConstrainedLagrangian(falling, [(x**2 + y**2 - 1) ** 2])
    with pytest.raises(ValueError, match=r"\(x\*\*2 \+ y\*\*2 - 1\)\*\*2 = 0 restricts no velocity"):
        propagate(squared, (0, 1), [1.0, 0.0, 0.0, 0.0])


def test_a_force_that_is_infinite_at_a_kink_ends_the_motion():
    cusp = Hamiltonian(p**2 / 2 + sp.sqrt(sp.Abs(x)), [x], [p])
    with pytest.raises(NonFiniteStateError, match=r"after t = 1\.8856"):
        propagate(cusp, (0, 10), [1.0, 0.0])


@pytest.mark.parametrize("number", [0, -1, 1.5, slice(0, 2)])
def test_a_motion_is_asked_by_names(number):
    motion = propagate(SPRING, (0, 1), [1.0, 0.0], samples=2)
    with pytest.raises(TypeError, match=r"write motion\['x'\]"):
        motion[number]
    assert motion["x"][-1] == motion[x][-1] == motion.y[0, -1]
