"""Functions of events that are not finite, and numbers no double holds: told, not skipped."""

import pytest
import sympy as sp

from canon import Event, Hamiltonian, Splitting, Taylor, coordinates, parameters, propagate
from canon.flow import NonFiniteStateError

x = coordinates("x")
k = parameters("k", positive=True)
SPRING = Hamiltonian(x.momentum**2 / 2 + k * x**2 / 2, [x], [x.momentum])
METHODS = [{"method": Taylor()}, {"method": Splitting("verlet"), "step": 0.1}]


@pytest.mark.parametrize("how", METHODS)
@pytest.mark.parametrize("g", [1 / (x - 1), sp.log(x)])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_an_event_outside_its_own_domain(g, how):
    with pytest.raises(NonFiniteStateError, match=r"not finite at t|can't be continued after t"):
        propagate(SPRING, (0, 5), [1.0, 0.0], parameters={k: 1}, events=[Event(g)], **how)


@pytest.mark.parametrize("how", METHODS)
def test_a_parameter_beyond_doubles(how):
    with pytest.raises(ValueError, match="beyond 1e308"):
        propagate(SPRING, (0, 5), [1.0, 0.0], parameters={k: sp.Integer(10) ** 400}, **how)
