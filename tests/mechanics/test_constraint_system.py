"""Systems of constraints: which are decided one at a time, dependent rows, powers, and inequalities that move."""

import time as clock

import pytest

from canon.expression.symbols.symbol import coordinates, time
from canon.mechanics.lagrange.constraint_system import ConstraintSystem
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Undecided

x, y, z, u = coordinates("x y z u")


def system(q, positions=(), velocities=(), inequalities=()):
    until = clock.monotonic() + 10
    return ConstraintSystem(
        tuple(q), tuple(positions), tuple(velocities), tuple(inequalities), Domain(), until, time
    )


def test_a_curved_set_of_velocities_is_decided_alone():
    speed = x.dot**2 + y.dot**2 - 1
    assert system([x, y, z], velocities=[speed]).integrable.fails
    for others in ({"velocities": [speed, z.dot - y.dot]}, {"positions": [z], "velocities": [speed]}):
        with pytest.raises(Undecided, match="decided only one at a time; make a claim of each"):
            system([x, y, z], **others).integrable  # noqa: B018


def test_rows_that_become_dependent_where_a_position_holds_are_not_counted():
    """ẏ = ż and ẏ = (1 − x) ż are two rows off x = 0, and one on it."""
    rows = [y.dot - z.dot, y.dot - (1 - x) * z.dot]
    assert system([x, y, z], velocities=rows).freedom("velocities") == 1
    assert system([x, y, z], [x - 1], rows).freedom("velocities") == 0
    with pytest.raises(
        Undecided, match="become dependent where they hold; leave one out, or narrow the domain"
    ):
        system([x, y, z], [x], rows).freedom("velocities")


def test_a_moving_place_beside_a_velocity_is_told_to_move():
    rolling = [y.dot - z.dot]
    moving = system([x, y, z], [x - time], rolling).at_rest_in_time
    assert moving.fails
    assert moving.counterexample is not None
    assert system([x, y, z], [x - 1], rolling).at_rest_in_time.holds
    for positions, velocities in (([(x - time) ** 2], rolling), ([x - time], [(y.dot - z.dot) ** 3])):
        with pytest.raises(Undecided, match="write each without a power, as x − t = 0 instead of"):
            system([x, y, z], positions, velocities).at_rest_in_time  # noqa: B018


def test_an_inequality_moves_with_its_edge():
    assert system([x, y], inequalities=[x - time]).at_rest_in_time.fails
    assert system([x, y], inequalities=[x - 1]).at_rest_in_time.holds
    with pytest.raises(Undecided, match="whether the inequality depends on the time was not decided"):
        system([x, y], inequalities=[x * (1 + time**2)]).at_rest_in_time  # noqa: B018


def test_places_beside_what_is_not_integrable_are_to_be_eliminated():
    """ż = y ẋ restricts no place; beside u = 0 it is said to eliminate u, and without u all of x, y, z are reached."""
    sliding = [z.dot - y * x.dot]
    with pytest.raises(Undecided, match="eliminate positions with those that hold no velocities"):
        system([x, y, z, u], [u], sliding).freedom("positions")
    assert system([x, y, z], velocities=sliding).freedom("positions") == 3
    assert system([x, y, z, u], velocities=[*sliding, u.dot]).freedom("positions") == 3
