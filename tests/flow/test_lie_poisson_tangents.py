"""Tangent maps of Lie–Poisson splittings: derivatives of the compiled steps, M Π Mᵀ = Π', and exponents of tops."""

import numpy as np
import pytest
import sympy as sp

from canon import flow_jacobian, propagate
from canon.flow import LiePoissonSplitting, Regularity, Taylor, lyapunov_spectrum, megno
from canon.mechanics import heavy_top
from tests.flow.test_lie_poisson import (
    BODY,
    BODY_START,
    CASES,
    FREE,
    START,
    TOP,
    TOP_START,
    Gamma,
    brackets_at,
    cases,
)
from tests.flow.test_moving_bodies import PAIR
from tests.flow.test_moving_bodies import START as PAIR_START

U = 2.0**-53


def differences(system, start, span, width, **how):
    """Central differences of the motion's end, once extrapolated, by an ensemble."""
    start = np.array(start, dtype=float)[:, np.newaxis]

    def central(d):
        units = d * np.eye(len(start))
        ends = propagate(system, span, np.hstack([start + units, start - units]), samples=1, **how).final
        there, back = np.hsplit(ends, 2)
        return (there - back) / (2 * d)

    return (4 * central(width) - central(2 * width)) / 3


def check(system, start, order):
    how = {"method": LiePoissonSplitting(order), "step": 0.25}
    found = flow_jacobian(system, (0, 10), start, samples=4, **how)
    rough, size = differences(system, start, (0, 10), 2e-6, **how), abs(found.final).max()
    np.testing.assert_allclose(found.final, rough, atol=1e-8 * size)
    motion = propagate(system, (0, 10), start, samples=4, **how)
    np.testing.assert_array_equal(found.y, motion.y)
    M, before, after = found.final, brackets_at(system, found.y[:, 0]), brackets_at(system, found.y[:, -1])
    defect = abs(M @ before.astype(float) @ M.T - after.astype(float)).max()
    assert defect < 300 * U * size**2
    # Of another step it is another, and one that is no Poisson map between these states.
    other = flow_jacobian(system, (0, 10), start, method=LiePoissonSplitting(order), step=0.5).final
    assert abs(other - rough).max() > 1e-6 * size
    scaled = 1.000001 * M
    assert abs(scaled @ before.astype(float) @ scaled.T - after.astype(float)).max() > 1e-7


def test_the_top_s_steps_carry_their_derivative_which_is_a_poisson_map():
    check(TOP, TOP_START, 2)


@pytest.mark.slow
@cases
@pytest.mark.parametrize("order", [2, 4])
def test_all_bodies_do(system, start, order):
    check(system, start, order)


@pytest.mark.slow
def test_two_bodies_that_fall_and_turn_do():
    how = {"method": LiePoissonSplitting(2), "step": 0.1}
    found = flow_jacobian(PAIR, (0, 2), PAIR_START, **how).final
    rough = differences(PAIR, PAIR_START, (0, 2), 1e-5, **how)
    np.testing.assert_allclose(found, rough, atol=1e-7 * abs(rough).max())


@pytest.mark.slow
@pytest.mark.parametrize(("precision", "bits"), [("extended", 62), ("double-double", 100)])
def test_they_are_known_in_wider_numbers_too(precision, bits):
    how = {"method": LiePoissonSplitting(4), "step": 0.25}
    found = flow_jacobian(BODY, (0, 10), BODY_START, precision=precision, **how)
    narrow = flow_jacobian(BODY, (0, 10), BODY_START, **how)
    size = abs(found.final).max()
    assert abs(narrow.final - found.final).max() < 1e-13 * size
    wide = found.M[:, :, -1].astype(np.longdouble) + found.low[:, :, -1]
    # |e| is a Casimir function, whose gradient M carries to itself.
    end = found.y[3:, -1]
    gradient = np.array([*[0.0] * 3, *BODY_START[3:]])
    carried = np.array([*[0.0] * 3, *end]) @ wide
    assert abs(carried - gradient).max() < 100 * U * size
    assert np.isfinite(found.low).all()
    assert abs(found.low).max() > 2.0 ** (-bits - 20)


def test_a_free_body_shears_and_its_casimir_s_gradient_is_carried_to_itself():
    how = {"method": LiePoissonSplitting(2), "step": 0.1}
    found = flow_jacobian(FREE, (0, 50), START, **how)
    np.testing.assert_allclose(found.y[:, -1] @ found.final, found.y[:, 0], atol=1e-12)
    both = np.array([START, [0.3, 0.9, 0.4]]).T
    judged = megno(FREE, (0, 5000), both, samples=100, **how)
    assert list(judged.verdict) == [Regularity.REGULAR] * 2
    assert judged.value[0] == pytest.approx(2, abs=0.1)


@pytest.mark.slow
def test_exponents_of_a_top_are_heyoka_s():
    """Orbits stick to islands for a while: the mean over many of them is what can be compared."""
    near = 1e-6 * np.random.default_rng(3).normal(size=(6, 32))
    starts = np.array(TOP_START)[:, np.newaxis] + near
    how = {"method": LiePoissonSplitting(4), "step": 0.1}
    found = lyapunov_spectrum(TOP, (0, 8000), starts, vectors=1, samples=200, **how).largest
    known = lyapunov_spectrum(TOP, (0, 20_000), TOP_START, method=Taylor(), vectors=1, samples=300)
    error = found.std() / np.sqrt(len(found))
    assert known.verdict is Regularity.CHAOTIC
    assert abs(found.mean() - known.largest) < 2 * np.hypot(error, known.errors[0])
    assert found.mean() > 20 * error


@pytest.mark.slow
def test_exponents_come_in_pairs_between_those_that_casimirs_make_vanish():
    found = lyapunov_spectrum(TOP, (0, 10_000), TOP_START, method=LiePoissonSplitting(6), step=0.1)
    # Two Casimir functions, the energy and the time: four that vanish.
    assert abs(found.exponents[1:5]).max() < 0.01 * found.largest
    assert abs(found.exponents[0] + found.exponents[5]) < 0.01 * found.largest


@pytest.mark.slow
def test_lagrange_s_top_is_regular():
    lagrange = heavy_top([1, 1, sp.Rational(1, 2)], Gamma[2])
    how = {"method": LiePoissonSplitting(4), "step": 0.1}
    assert megno(lagrange, (0, 5000), CASES["top"][1], **how).verdict is Regularity.REGULAR
