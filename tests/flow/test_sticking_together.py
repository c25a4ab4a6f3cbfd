"""Several blocks that dry friction holds at once, each by the force that keeps it at rest."""

from itertools import pairwise

import numpy as np
import pytest
import sympy as sp
from sympy import Rational, sign

from canon import DOP853, Lagrangian, Taylor, coordinates, propagate
from canon.flow import NonFiniteStateError

x, y = coordinates("x y")
METHODS = [Taylor(), DOP853()]


def told(motion):
    return [(str(met.event), round(float(met.t), 9)) for met in motion.events]


@pytest.mark.parametrize("method", METHODS)
def test_two_oscillators_come_to_rest_one_after_the_other(method):
    """Each half of a swing takes 2 F/k off the way out; rest is where that is within F/k of the middle."""
    kinetic, springs = (x.dot**2 + y.dot**2) / 2, x**2 / 2 + 2 * y**2
    blocks = Lagrangian(kinetic - springs, [x, y], forces=[-sign(x.dot) / 10, -sign(y.dot) / 5])
    motion = propagate(blocks, (0, 40), [1.05, 2.03, 0, 0], method=method)
    at_rest = [("sticks at x_dot = 0", 5 * np.pi), ("sticks at y_dot = 0", 20 * np.pi / 2)]
    assert told(motion) == [(name, pytest.approx(t, rel=1e-9)) for name, t in at_rest]
    assert motion.final == pytest.approx([1.05 - 5 * 0.2 - 0.1, 2.03 - 20 * 0.1, 0, 0], abs=1e-10)
    assert abs(motion.energy_error).max() < 1e-10


@pytest.mark.parametrize("method", METHODS)
def test_two_that_stop_at_one_instant(method):
    springs = (x**2 + y**2) / 2
    blocks = Lagrangian(
        (x.dot**2 + y.dot**2) / 2 - springs, [x, y], forces=[-sign(x.dot) / 10, -sign(y.dot) / 10]
    )
    motion = propagate(blocks, (0, 40), [1.05, -1.05, 0, 0], method=method)
    assert motion.final == pytest.approx([-0.05, 0.05, 0, 0], abs=1e-10)
    assert motion.events[-1].t == pytest.approx(5 * np.pi, rel=1e-9)


def time_stepping(forces, friction, q, steps, h):
    """J. J. Moreau's scheme, of first order: friction takes off as much of each speed as it can."""
    v = np.zeros_like(q)
    for k in range(steps):
        free = v + h * forces(q, k * h)
        v = np.sign(free) * np.maximum(abs(free) - h * friction, 0)
        q = q + h * v
    return q


def pulled_chain(n, holds):
    """Burridge's and Knopoff's model of an earthquake: blocks between springs, the last of them pulled slowly."""
    t, blocks = sp.Symbol("t", real=True), coordinates(" ".join(f"x{k}" for k in range(n)))
    springs = sum((b - a) ** 2 for a, b in pairwise(blocks)) + (t / 20 - blocks[-1]) ** 2 / 2
    kinetic = sum(each.dot**2 for each in blocks) / 2
    forces = [-sign(each.dot) * hold for each, hold in zip(blocks, holds, strict=True)]
    return Lagrangian(kinetic - springs, list(blocks), t=t, forces=forces)


@pytest.mark.parametrize(("n", "method"), [(2, Taylor()), (2, DOP853()), (8, Taylor())])
def test_a_chain_that_is_pulled_sticks_and_slips(n, method):
    holds = [Rational(4 + k, 20) for k in range(n)]
    motion = propagate(pulled_chain(n, holds), (0, 40), np.zeros(2 * n), method=method)

    def forces(q, t):
        pull = 2 * np.diff(q)
        return np.append(pull, t / 20 - q[-1]) - np.insert(pull, 0, 0.0)

    h = 5e-4
    coarse, fine = (
        time_stepping(forces, np.array(holds, float), np.zeros(n), round(40 / step), step)
        for step in (2 * h, h)
    )
    assert motion.final[:n] == pytest.approx(2 * fine - coarse, abs=max(1e-5, 0.2 * abs(fine - coarse).max()))
    assert sum(name.startswith("slips") for name, _ in told(motion)) >= 2
    assert abs(motion.energy_error).max() < 1e-11


@pytest.mark.parametrize("method", METHODS)
def test_what_holds_one_block_depends_on_what_holds_the_other(method):
    """A block on a block: the lower one is pulled, and starts when its floor gives way, the upper one with it."""
    t, z = sp.Symbol("t", real=True), y.dot - x.dot
    stack = Lagrangian(
        (x.dot**2 + y.dot**2) / 2, [x, y], t=t, forces=[t - sign(x.dot) + sign(z) / 2, -sign(z) / 2]
    )
    motion = propagate(stack, (0, 3), [0, 0, 0, 0], method=method)
    # both: 2 ẍ = t − 1 from t = 1 until ẍ = 1/2 at t = 2; then ẍ = t − 3/2 and ÿ = 1/2
    assert told(motion)[:2] == [
        ("slips at x_dot = 0", pytest.approx(1, rel=1e-9)),
        ("slips at -x_dot + y_dot = 0", pytest.approx(2, rel=1e-9)),
    ]
    assert motion.final == pytest.approx(
        [1 / 12 + 1 / 4 + 5 / 12, 1 / 12 + 1 / 4 + 1 / 4, 5 / 4, 3 / 4], rel=1e-9
    )


def test_where_nothing_tells_which_force_holds_it_says_so():
    """Two friction forces on one block: only their sum is known."""
    twice = Lagrangian(
        (x.dot**2 + y.dot**2) / 2 - x**2,
        [x, y],
        forces=[-sign(x.dot) * sign(y.dot) - sign(x.dot) * 2, -sign(y.dot)],
    )
    with pytest.raises(NonFiniteStateError, match="several kinks hold the motion at once"):
        propagate(twice, (0, 20), [1.5, 0, 0.3, 1.0])
