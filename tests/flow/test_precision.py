"""Every precision reaches its floor; many orbits together give the bits that each gives alone."""

import mpmath
import numpy as np
import pytest
import sympy as sp

from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor
from canon.flow.method.number_formats import ADAPTIVE, FIXED, unit_round_off
from canon.flow.propagation import propagate
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.kernel.schemes.splitting_schemes import SCHEMES
from tests.flow.systems import (
    DOUBLE_PENDULUM,
    DOUBLE_PENDULUM_START,
    DRIVEN,
    HENON_HEILES,
    HENON_HEILES_START,
    KEPLER,
    PENDULUM,
    System,
    kepler_start,
)
from tests.flow.test_geometry import exact_step

SS10 = Splitting("sofroniou-spaletta-10")
UNIT = {"single": 2.0**-24, "double": 2.0**-53, "compensated": 2.0**-53, "extended": 2.0**-64}


@pytest.mark.parametrize("precision", UNIT)
def test_the_unit_round_off_is_the_arithmetics_own(precision):
    assert unit_round_off(precision) == UNIT[precision]
    number = FIXED[precision].number
    assert unit_round_off(precision) == np.finfo(number.dtype).eps / 2


def test_the_unit_round_off_of_more_digits():
    assert unit_round_off("double-double") == unit_round_off("double") ** 2
    assert unit_round_off("quad") == 2.0**-113
    assert unit_round_off("34") == pytest.approx(5e-34)
    with pytest.raises(ValueError, match="'half'"):
        unit_round_off("half")


@pytest.mark.parametrize("precision", UNIT)
def test_fixed_step_precisions_end_at_their_own_round_off(precision):
    n = 2_000
    error = propagate(
        KEPLER, (0, 50), kepler_start(0.2), method=SS10, step=50 / n, precision=precision
    ).energy_error
    floor = UNIT[precision] * n**0.5
    bound = {"compensated": 0.3}.get(precision, 100)
    assert abs(error).max() < bound * floor
    if precision != "compensated":
        assert abs(error).max() > 0.1 * floor


@pytest.mark.parametrize("stages", [4, 6, 8])
@pytest.mark.parametrize("precision", UNIT)
def test_gauss_methods_end_at_the_round_off_of_each_precision(stages, precision):
    """The step is so small that nothing of the method's own error is left above the round-off."""
    n = 4_000
    motion = propagate(
        DOUBLE_PENDULUM,
        (0, 60),
        DOUBLE_PENDULUM_START,
        method=Gauss(stages),
        step=60 / n,
        precision=precision,
    )
    error, floor = abs(motion.energy_error).max(), UNIT[precision] * n**0.5
    assert error < {"compensated": 0.3}.get(precision, 10) * floor
    assert error > 1e-3 * floor
    # The iteration ends, and not because it was cut short.
    assert 2 < motion.evaluations / motion.steps / stages < 12


@pytest.mark.parametrize(("precision", "digits"), [("single", 6), ("double", 15), ("extended", 18)])
def test_a_gauss_step_is_the_double_double_one_rounded(precision, digits):
    arguments = {"method": Gauss(5), "step": 1 / 8, "samples": 1}
    found = propagate(DOUBLE_PENDULUM, (0, 1 / 8), DOUBLE_PENDULUM_START, precision=precision, **arguments)
    wide = propagate(
        DOUBLE_PENDULUM, (0, 1 / 8), DOUBLE_PENDULUM_START, precision="double-double", **arguments
    )
    difference = (found.y[:, -1] - wide.y[:, -1]) + (found.carried[:, -1] - wide.carried[:, -1])
    assert abs(difference).max() < 10.0**-digits


@pytest.mark.parametrize("precision", FIXED)
def test_a_gauss_iteration_that_does_not_converge_says_so_in_every_precision(precision):
    """A fall into the centre from rest."""
    with pytest.raises(NonFiniteStateError, match="do not converge") as caught:
        propagate(KEPLER, (0, 3), [1.0, 0.0, 0.0, 0.0], method=Gauss(4), step=0.02, precision=precision)
    assert 1.0 < caught.value.time < np.pi / 8**0.5


def test_double_double_steps_are_exact_to_31_digits():
    scheme = SCHEMES["kahan-li-8"]
    for system, start in ((KEPLER, kepler_start(0.6)), (HENON_HEILES, HENON_HEILES_START)):
        found = propagate(
            system,
            (0, 0.25),
            start,
            method=Splitting("kahan-li-8"),
            step=0.125,
            precision="double-double",
            samples=2,
        )
        with mpmath.workdps(60):
            state = [mpmath.mpf(x) for x in start]
            for _ in range(2):
                state = exact_step(system, scheme, state, mpmath.mpf(0.125))
            both = zip(found.y[:, -1].tolist(), found.carried[:, -1].tolist(), state, strict=True)
            assert max(abs(mpmath.mpf(a) + mpmath.mpf(b) - c) for a, b, c in both) < mpmath.mpf(10) ** -30


def test_double_double_lanes_know_the_time():
    """Orbits side by side in a system that depends on the time have the bits of each alone."""
    arguments = {"method": SS10, "step": 0.125, "precision": "double-double", "samples": 4}
    starts = np.array([[0.3, 0.5, 0.7], [1.0, 0.0, -1.0]])
    together = propagate(DRIVEN, (0, 2), starts, **arguments)
    for k, start in enumerate(starts.T):
        alone = propagate(DRIVEN, (0, 2), start, **arguments)
        assert (together.y[:, :, k] == alone.y).all()
        assert (together.carried[:, :, k] == alone.carried).all()


def test_double_double_energy_error_is_the_methods_own():
    arguments = {"method": SS10, "samples": 20}
    errors = [
        abs(
            propagate(
                KEPLER, (0, 10), kepler_start(0.2), step=step, precision="double-double", **arguments
            ).energy_error
        ).max()
        for step in (1 / 16, 1 / 32)
    ]
    # Order 10 goes on below what doubles can show.
    assert errors[1] < 1e-21
    assert errors[0] / errors[1] == pytest.approx(2**10, rel=0.3)


@pytest.mark.parametrize(("stages", "floor"), [(3, 0.0), (6, 0.0), (8, 5e-31)])
def test_gauss_methods_in_double_double_keep_their_order_far_below_doubles(stages, floor):
    arguments = {"method": Gauss(stages), "precision": "double-double", "samples": 4}
    errors = [
        abs(
            propagate(DOUBLE_PENDULUM, (0, 2), DOUBLE_PENDULUM_START, step=step, **arguments).energy_error
        ).max()
        for step in (1 / 16, 1 / 32)
    ]
    assert errors[0] / errors[1] == pytest.approx(2 ** (2 * stages), rel=0.2)
    assert floor < errors[1] < {3: 1e-11, 6: 1e-22, 8: 2e-30}[stages]
    doubles = propagate(
        DOUBLE_PENDULUM, (0, 2), DOUBLE_PENDULUM_START, method=Gauss(stages), step=1 / 32, samples=4
    )
    wide = propagate(DOUBLE_PENDULUM, (0, 2), DOUBLE_PENDULUM_START, step=1 / 32, **arguments)
    np.testing.assert_allclose(doubles.y, wide.y, atol=2e-15)


def test_gauss_methods_in_double_double_keep_quadratic_integrals():
    x, y, px, py = *KEPLER.q, *KEPLER.p
    motion = propagate(
        KEPLER, (0, 20), kepler_start(0.5), method=Gauss(2), step=0.05, precision="double-double",
        observables={"L": x * py - y * px},
    )  # fmt: skip
    assert abs(motion.energy_error).max() > 1e-6
    assert abs(motion.changes["L"]).max() < 1e-30


def test_a_start_beyond_doubles_is_kept():
    exact = ["1/3", "0.1", "0", "1.1"]
    motion = propagate(KEPLER, (0, 1), exact, method=SS10, step=0.01, precision="double-double", samples=1)
    assert motion.y[0, 0] == 1 / 3
    assert motion.carried[0, 0] == pytest.approx(1 / 3 * 2**-54, rel=1e-9)
    rounded = propagate(
        KEPLER, (0, 1), [1 / 3, 0.1, 0.0, 1.1], method=SS10, step=0.01, precision="double-double", samples=1
    )
    difference = (motion.y - rounded.y) + (motion.carried - rounded.carried)
    assert 1e-18 < abs(difference[:, -1]).max() < 1e-14


@pytest.mark.parametrize("precision", [*ADAPTIVE[1:], 30])
def test_heyokas_precisions_go_below_doubles(precision):
    motion = propagate(PENDULUM, (0, 20), [1.0, 0.0], precision=precision, samples=10)
    double = propagate(PENDULUM, (0, 20), [1.0, 0.0], samples=10)
    np.testing.assert_allclose(motion.y, double.y, atol=1e-13)
    floor = {"extended": 1e-18, "quad": 1e-31, 30: 1e-28}[precision]
    assert 0 < abs(motion.energy_error).max() < floor
    assert abs(double.energy_error).max() > 1e-17


@pytest.mark.parametrize(
    ("method", "precision", "message"),
    [
        (SS10, "quadruple", "double-double"),
        (SS10, 40, "double-double"),
        (Gauss(2), "quad", "double-double"),
        (DOP853(), "quad", "double precision"),
        (Taylor(), "compensated", "'quad'"),
        (Taylor(), 5, "16 … 1000"),
    ],
)
def test_precisions_that_a_method_does_not_have(method, precision, message):
    fixed = {"step": 0.1} if method in (SS10, Gauss(2)) else {}
    with pytest.raises(ValueError, match=message):
        propagate(KEPLER, (0, 1), kepler_start(0.2), method=method, precision=precision, **fixed)


def test_a_pendulum_in_double_double_is_heyokas_in_quadruple():
    motion = propagate(
        PENDULUM, (0, 3), [1.0, 0.0], method=SS10, step=1 / 64, precision="double-double", samples=3
    )
    assert 0 < abs(motion.energy_error).max() < 1e-24
    finer = propagate(
        PENDULUM, (0, 3), [1.0, 0.0], method=SS10, step=1 / 128, precision="double-double", samples=3
    )
    # Of order 10 far below what doubles show: the sines are right there too.
    ratio = abs(motion.energy_error).max() / abs(finer.energy_error).max()
    assert ratio == pytest.approx(2**10, rel=0.2)


def test_double_double_says_what_it_has_not():
    hyperbolic = System(PENDULUM.H + sp.asinh(PENDULUM.q[0]), PENDULUM.q, PENDULUM.p)
    with pytest.raises(ValueError, match=r"no asinh in double-double.*'quad'"):
        propagate(
            hyperbolic,
            (0, 1),
            [1.0, 0.0],
            method=Splitting("verlet"),
            step=0.1,
            precision="double-double",
            cadence=1,
        )


def starts(base, orbits):
    return np.array(base)[:, np.newaxis] * (1 + 0.2 * np.random.default_rng(3).random(orbits))


@pytest.mark.parametrize("precision", FIXED)
@pytest.mark.parametrize("method", [Splitting("verlet"), Splitting("kahan-li-8"), RK4(), Gauss(3)], ids=str)
def test_orbits_together_give_the_bits_of_each_alone(method, precision):
    many = starts(kepler_start(0.3), 37)
    arguments = {"method": method, "step": 0.05, "precision": precision, "samples": 3}
    together = propagate(KEPLER, (0, 3), many, **arguments)
    assert together.y.shape == (4, 4, 37)
    assert together.energy_error.shape == (4, 37)
    for orbit in (0, 5, 36):
        alone = propagate(KEPLER, (0, 3), many[:, orbit], **arguments)
        np.testing.assert_array_equal(together.y[:, :, orbit], alone.y)
        np.testing.assert_array_equal(together.carried[:, :, orbit], alone.carried)
        np.testing.assert_array_equal(together.energy_error[:, orbit], alone.energy_error)


@pytest.mark.parametrize("precision", ["single", "double", "compensated"])
def test_a_thousand_orbits_give_the_bits_of_each_alone(precision):
    """So many are stepped in more registers."""
    many = starts(kepler_start(0.3), 1003)
    arguments = {"method": Splitting("kahan-li-8"), "step": 0.05, "precision": precision, "samples": 1}
    together = propagate(KEPLER, (0, 2), many, **arguments)
    few = propagate(KEPLER, (0, 2), many[:, :7], **arguments)
    np.testing.assert_array_equal(together.y[:, :, :7], few.y)
    for orbit in (0, 500, 1002):
        alone = propagate(KEPLER, (0, 2), many[:, orbit], **arguments)
        np.testing.assert_array_equal(together.y[:, :, orbit], alone.y)
        np.testing.assert_array_equal(together.carried[:, :, orbit], alone.carried)


@pytest.mark.parametrize("method", [Splitting("kahan-li-6"), RK4(), Gauss(3), Taylor(), DOP853()], ids=str)
def test_ensembles_of_every_method_and_of_transcendental_hamiltonians(method):
    fixed = {"step": 0.05} if isinstance(method, Splitting | RK4 | Gauss) else {}
    system, base = (
        (DRIVEN, [1.0, 0.5]) if isinstance(method, Splitting) else (DOUBLE_PENDULUM, DOUBLE_PENDULUM_START)
    )
    many = starts(base, 3)
    together = propagate(system, (0, 2), many, method=method, samples=4, **fixed)
    for orbit in range(3):
        alone = propagate(system, (0, 2), many[:, orbit], method=method, samples=4, **fixed)
        np.testing.assert_array_equal(together.y[:, :, orbit], alone.y)


def test_an_orbit_that_is_lost_is_named():
    # The first half drift takes orbit 2 into the centre.
    many = np.array([[1.0, 1.0, 1.0, 1.0], [0.0] * 4, [0.0, 0.0, -2.0, 0.0], [1.0, 1.0, 0.0, 1.0]])
    with pytest.raises(NonFiniteStateError, match="of orbit 2") as caught:
        propagate(KEPLER, (0, 4), many, method=Splitting("verlet"), step=1.0)
    np.testing.assert_array_equal(caught.value.state, many[:, 2])
    with pytest.raises(ValueError, match="y0 has shape"):
        propagate(KEPLER, (0, 4), many[:3], method=RK4(), step=0.1)


def test_progress_of_ensembles_reaches_one_and_interruptions_stop_every_thread():
    many = starts(HENON_HEILES_START, 300)
    seen = []
    propagate(
        HENON_HEILES, (0, 20), many, method=Splitting("verlet"), step=0.01, samples=5, progress=seen.append
    )
    assert seen[-1] == 1

    def impatient(fraction):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        propagate(
            HENON_HEILES, (0, 1e9), many, method=Splitting("verlet"), step=0.01, samples=2, progress=impatient
        )
