"""Steps whose variations are not known, and numbers that are no lanes'."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from canon import Hamiltonian, coordinates, propagate
from canon.flow import Boris, LiePoissonSplitting
from canon.kernel.llvm.formulas import LaneFormulas
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.llvm.writer import Writer
from canon.kernel.program.variational import variational
from canon.mechanics import free_body


def test_the_parts_of_a_turning_body_have_no_variational_equations_as_their_sum() -> None:
    steps = {"method": LiePoissonSplitting(2), "step": 0.1, "samples": 1}
    system = propagate(free_body([1, 2, 3]), (0, 1), [0.1, 1.0, 0.1], **steps).record.task.system
    assert system.lie_poisson is not None
    with pytest.raises(
        ValueError, match="a Lie–Poisson splitting moves by: it has a tangent loop of its own"
    ):
        variational(system, 1)


def test_as_many_numbers_as_lanes() -> None:
    formulas = LaneFormulas(Writer(DOUBLE))
    with pytest.raises(ValueError, match="2 numbers for 1 lanes"):
        formulas.numbers([Fraction(1), Fraction(2)])


@pytest.mark.parametrize("precision", ["double", "compensated", "extended"])
def test_boris_turns_by_twice_the_arctangent_of_half_a_step(precision: str) -> None:
    """In a uniform field of strength 1 the velocity turns by 2 arctan(h/2) a step, with and without compensation."""
    x, y = coordinates("x y")
    p, q = x.momentum, y.momentum
    system = Hamiltonian(((p + y / 2) ** 2 + (q - x / 2) ** 2) / 2, [x, y], [p, q])
    motion = propagate(
        system, (0, 2), [0.0, 0.0, 1.0, 0.0], method=Boris(2), step=0.1, samples=20, precision=precision
    )
    speed = (motion["p_x"] + motion["y"] / 2) + 1j * (motion["p_y"] - motion["x"] / 2)
    turned = np.unwrap(np.angle(speed))
    assert abs(speed) == pytest.approx(np.ones(21), abs=1e-13)
    assert abs(np.diff(turned)) == pytest.approx(np.full(20, 2 * np.arctan(0.05)), abs=1e-12)
