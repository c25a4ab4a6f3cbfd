"""Requests at the edges: exact end times, other numbers, refusals in words, and refusals that would be false."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

from canon import (
    ConstrainedLagrangian,
    Hamiltonian,
    Lagrangian,
    Splitting,
    TimeTransformed,
    coordinates,
    propagate,
)

x, y = coordinates("x y")
OSCILLATOR = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])


def rotating(mu: sp.Rational) -> Hamiltonian:
    """The restricted problem of three bodies."""
    near, far = sp.sqrt((x - 1 + mu) ** 2 + y**2), sp.sqrt((x + mu) ** 2 + y**2)
    p, q = x.momentum, y.momentum
    return Hamiltonian(
        (p**2 + q**2) / 2 + y * p - x * q - (1 - mu) / far - mu / near, [x, y], [x.momentum, y.momentum]
    )


def test_times_that_doubles_hardly_tell_apart_are_kept_once():
    late = propagate(OSCILLATOR, (10**15, 10**15 + 1), [1, 0])
    np.testing.assert_array_equal(late.t, 10**15 + np.arange(9) / 8)
    np.testing.assert_allclose(late.final, [np.cos(1), -np.sin(1)], atol=1e-15)
    for how in ({}, {"method": "verlet", "step": 0.1}):
        with pytest.raises(ValueError, match="as far as doubles tell"):
            propagate(OSCILLATOR, (10**20, 10**20 + 1), [1, 0], **how)


@pytest.mark.parametrize("halves", [1, 2])
@pytest.mark.parametrize("number", [Fraction, mpmath.mpf])
def test_the_end_is_reached_exactly_in_quadruple_precision(number, halves):
    """Arenstorf's orbit (Hairer, Nørsett, Wanner, Solving ODEs I, II.0) closes to the digits of its data."""
    with mpmath.workdps(40):
        period = number("17.0652165601579625588917206249")
        start = [number("0.994"), 0, 0, number("0.994") - number("2.00158510637908252240537862224")]
        span = (0, period) if halves == 1 else (0, period / 2)
        orbit = rotating(sp.Rational("0.012277471"))
        motion = propagate(orbit, y0=start, t_span=span, precision="quad", samples=2)
        motion = motion if halves == 1 else motion.resume(period)
        end = [mpmath.mpf(a) + b for a, b in zip(motion.final, motion.carried[:, -1], strict=True)]
        begun = [mpmath.mpf(b.numerator) / b.denominator if isinstance(b, Fraction) else b for b in start]
        away = [abs(a - b) for a, b in zip(end, begun, strict=True)]
        assert max(away) < 1e-26


@pytest.mark.parametrize("precision", [50, 60])
def test_every_number_of_digits_has_an_estimate(precision):
    motion = propagate(OSCILLATOR, y0=[1, 0], t_span=(0, 3), precision=precision, samples=3)
    estimate = motion.error_estimate()
    assert estimate.relative[-1] < 1e-15
    assert f"{precision + 16} digits" in estimate.companion


def test_the_step_of_a_run_back_in_time_can_be_given_back():
    settings = {"y0": [1, 0], "t_span": (1, 0), "method": Splitting("verlet")}
    first = propagate(OSCILLATOR, step=0.25, **settings)
    again = propagate(OSCILLATOR, step=first.step, **settings)
    assert first.step == again.step == -0.25
    assert (first.y == again.y).all()
    with pytest.raises(ValueError, match=r"step=-0\.25: give a positive number"):
        propagate(OSCILLATOR, y0=[1, 0], t_span=(0, 1), method=Splitting("verlet"), step=-0.25)


def test_rates_of_round_off_size_are_no_time_scale():
    mu = sp.Rational(1, 100)
    corner = np.array([0.49, math.sqrt(3) / 2, -math.sqrt(3) / 2, 0.49])
    motion = propagate(rotating(mu), y0=corner, t_span=(0, 100), samples=10)
    assert abs(motion.y - corner[:, np.newaxis]).max() < 1e-12
    bump = Hamiltonian(x.momentum**2 / 2 + 1 / (10 * sp.cosh(x) ** 2), [x], [x.momentum])
    assert propagate(bump, y0=[-20, 1], t_span=(0, 40), samples=10).final[1] == pytest.approx(1, rel=1e-13)
    assert propagate(OSCILLATOR, y0=[1, 1e-17], t_span=(0, 1), samples=1).final[0] == pytest.approx(
        math.cos(1)
    )


@pytest.mark.parametrize("start", [[1e60, 0, 0, 1], [1e60, 0, 0, 0]])
def test_a_true_time_scale_beyond_doubles_is_still_refused(start):
    wide = Hamiltonian(
        (x.momentum**2 + y.momentum**2) / 2 - 10**60 / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
    )
    with pytest.raises(ValueError, match=r"a time scale of 1e\+60"):
        propagate(wide, y0=start, t_span=(0, 2e61), samples=2)


def test_an_observable_may_be_a_number():
    motion = propagate(OSCILLATOR, y0=[1, 0], t_span=(0, 1), samples=2, observables={"a": 3})
    assert motion.observables["a"].tolist() == [3, 3, 3]


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"t_span": (0, 1e308)}, "t_span reaches beyond 1e300"),
        ({"t_span": (0, 10**400)}, "t_span reaches beyond 1e300"),
        ({"y0": [mpmath.mpf("-inf"), 0]}, "no finite real number"),
        ({"y0": [10**400, 0]}, "about 1e400 is beyond 1e308"),
        ({"step": 1e-300, "method": "verlet"}, "more than 2⁶² such steps"),
        ({"step": 0, "method": "verlet"}, "step=0: give a positive number"),
        ({"step": math.nan, "method": "verlet"}, "step=nan: give a positive number"),
        ({"samples": math.inf}, "samples=inf: keep at least one"),
        ({"samples": None, "times": [10**400]}, "times: give a list of finite numbers"),
        (
            {"y0": [0, 1], "step": 0.1, "method": TimeTransformed(Splitting("verlet"))},
            "has no value at the start",
        ),
    ],
)
def test_what_cannot_be_is_refused_in_words(wrong, words):
    with pytest.raises(ValueError, match=words):
        propagate(OSCILLATOR, **({"y0": [1, 0], "t_span": (0, 1), "samples": 2} | wrong))


def test_a_lagrangian_without_constraints_is_a_constrained_one():
    free = ConstrainedLagrangian(Lagrangian(x.dot**2 / 2 + y.dot**2 - x**2 / 2 - y, [x, y]), [])
    assert free.accelerations == (-x, -sp.Rational(1, 2))
    assert free.multipliers == ()
    assert free.reactions == (0, 0)


@pytest.mark.parametrize("how", [{}, {"method": "DOP853"}, {"precision": "quad"}])
@pytest.mark.parametrize("span", [(0, 10), (10, 0)])
def test_no_step_is_longer_than_it_may_be(how, span):
    free, held = (
        propagate(OSCILLATOR, y0=[1, 0], t_span=span, samples=4, **how, **more)
        for more in ({}, {"max_step": 0.1})
    )
    assert free.steps < 100 <= held.steps <= 102
    assert abs(free.y - held.y).max() < 1e-10


def test_a_longest_step_is_positive_and_for_methods_that_choose_theirs():
    with pytest.raises(ValueError, match="max_step=-1: give a positive number"):
        propagate(OSCILLATOR, y0=[1, 0], t_span=(0, 1), max_step=-1)
    with pytest.raises(ValueError, match="verlet takes steps of the size that is given"):
        propagate(OSCILLATOR, y0=[1, 0], t_span=(0, 1), max_step=1, method="verlet", step=0.1)
