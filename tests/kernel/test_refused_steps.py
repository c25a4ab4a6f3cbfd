"""Steps whose variations are not known, and numbers that are no lanes'."""

from __future__ import annotations

from fractions import Fraction

import pytest

from canon import propagate
from canon.flow import LiePoissonSplitting
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
