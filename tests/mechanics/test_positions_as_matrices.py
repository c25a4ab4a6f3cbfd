"""Places as SymPy's column vectors, and what is printed of a status: one value, its word."""

import pytest
import sympy as sp

from canon import Particle, coordinates, lagrangian_of_bodies, parameters
from canon.exercise import Outcome
from canon.plot import plot_scene
from canon.proof.domain.verdict import Status
from canon.study import Growth

theta = coordinates("theta")
m, l = parameters("m l", positive=True)
PLACE = sp.Matrix([l * sp.sin(theta), -l * sp.cos(theta)])


def test_a_column_and_a_row_are_lists_of_components():
    by_list = lagrangian_of_bodies([Particle(m, list(PLACE))], [theta])
    for place in (PLACE, PLACE.T, sp.ImmutableMatrix(PLACE)):
        assert lagrangian_of_bodies([Particle(m, place)], [theta]) == by_list
    with pytest.raises(TypeError, match="an expression is needed"):
        Particle(m, [PLACE, PLACE])
    with pytest.raises(TypeError, match=r"an expression is needed, not Matrix.*entries one by one"):
        Particle(m, sp.ImmutableMatrix([[l, 0], [0, l]]))


def test_a_status_is_printed_as_its_word():
    assert [str(status) for status in Status] == ["holds", "fails", "undecided"]
    assert f"{Growth.ROUND_OFF:>10} {Outcome.RIGHT}" == " round-off right"


def test_a_motion_that_does_not_know_its_looks_is_refused():
    with pytest.raises(TypeError, match=r"the motion should be a SceneMotion, not .*scene_motion\.run"):
        plot_scene("kepler")
