"""Numbers beyond doubles on the way are told, not computed with; wider numbers hold them."""

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, Splitting, Taylor, coordinates, propagate
from canon.flow.run.non_finite_state import NonFiniteStateError

x, y = coordinates("x y")
OSCILLATOR = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])


def kepler(length):
    """Circular motion with speed 1 at a radius."""
    mu = sp.Rational(10) ** length
    H = (x.momentum**2 + y.momentum**2) / 2 - mu / sp.sqrt(x**2 + y**2)
    return Hamiltonian(H, [x, y], [x.momentum, y.momentum]), [float(mu), 0.0, 0.0, 1.0]


@pytest.mark.parametrize("method", [Taylor(), Splitting("kahan-li-8")])
@pytest.mark.parametrize("length", [120, 150, 160, -110, -150])
def test_lengths_whose_cubes_doubles_do_not_hold(method, length):
    H, start = kepler(length)
    how = {} if method == Taylor() else {"step": 0.02 * start[0]}
    with pytest.raises(ValueError, match="beyond 1e±308"):
        propagate(H, (0, start[0]), start, method=method, samples=4, **how)


@pytest.mark.parametrize("length", [120, 150, -110, -150])
def test_wider_exponents_hold_them(length):
    H, start = kepler(length)
    motion = propagate(
        H,
        (0, start[0]),
        start,
        method=Splitting("kahan-li-8"),
        step=0.02 * start[0],
        precision="extended",
        samples=4,
    )
    angle = motion.t / start[0]
    assert np.allclose(motion.q / start[0], [np.cos(angle), np.sin(angle)], atol=1e-13)
    assert (
        abs(motion.p - [-np.sin(angle), np.cos(angle)]).max(axis=0) < motion.error_estimate().relative + 1e-15
    ).all()


def test_angles_whose_sines_double_double_does_not_have():
    pendulum = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])
    with pytest.raises(ValueError, match="double-double has sines up to"):
        propagate(
            pendulum, (0, 1), [1e16, 0], method=Splitting("verlet"), step=0.1, precision="double-double"
        )


def test_a_time_scale_whose_twentieth_power_is_no_double():
    H, start = kepler(60)
    with pytest.raises(ValueError, match="time scale of 1e\\+60"):
        propagate(H, (0, start[0]), start)
    motion = propagate(H, (0, start[0]), start, precision="extended", samples=2)
    assert abs(motion.final[0] / start[0] - np.cos(1)) < 1e-15


@pytest.mark.parametrize("size", [1e-300, 1e-310, 1e-318, 1e150])
def test_small_and_large_oscillations(size):
    motion = propagate(OSCILLATOR, (0, 10), [size, 0.0], method=Splitting("kahan-li-8"), step=0.1, samples=10)
    missed = np.maximum.accumulate(abs(motion.q[0] - size * np.cos(motion.t)))
    assert (missed <= motion.error_estimate().error[0] + np.spacing(size)).all()


@pytest.mark.parametrize("height", [1e-38, 1e-100, 1e-300])
def test_a_fall_from_a_small_height_is_quick_and_its_series_short(height):
    """Free fall over a floor that it bounces off as |x|: period 4 √(2 h); an oscillator so quick is refused."""
    well = Hamiltonian(x.momentum**2 / 2 + sp.Abs(x), [x], [x.momentum])
    period = 4 * np.sqrt(2 * height)
    motion = propagate(well, (0, 5.25 * period), [height, 0.0], samples=21)
    at = motion.t / period % 1
    quarter = np.minimum(at, 1 - at)
    true = height * np.where(quarter < 0.25, 1 - (4 * quarter) ** 2, (4 * (0.5 - quarter)) ** 2 - 1)
    assert abs(motion["x"] - true).max() < 1e-13 * height
    assert motion.error_estimate().relative[-1] < 1e-12
    stiff = Hamiltonian(x.momentum**2 / 2 + x**2 / (2 * sp.Rational(height)), [x], [x.momentum])
    with pytest.raises(ValueError, match="time scale of 1e-"):
        propagate(stiff, (0, period), [1.0, 0.0])


def test_rest_where_series_are_beyond_doubles_is_told():
    stiff = Hamiltonian(x.momentum**2 / 2 + x**2 * 10**40, [x], [x.momentum])
    with pytest.raises(ArithmeticError, match="can't be continued after t = 0"):
        propagate(stiff, (0, 1), [0.0, 0.0])


def test_a_rate_of_the_size_of_the_least_double_is_only_rounded():
    spring = Hamiltonian(x.momentum**2 / 2 + sp.Rational(3, 2) * x**2 / 2, [x], [x.momentum])
    motion = propagate(spring, (0, 1), [5e-324, 0.0], method=Splitting("verlet"), step=0.5)
    assert abs(motion.y).max() < 1e-322


def test_series_that_leave_the_doubles_tell_of_units():
    """Argon in SI units: r⁻¹³ is 1e124 there, and its twentieth derivative by the time a factor of 1e250 more."""
    m, well, size = 6.63e-26, 1.65e-21, 3.4e-10
    H = x.momentum**2 / (2 * m) + 4 * well * ((size / x) ** 12 - (size / x) ** 6)
    atoms = Hamiltonian(H, [x], [x.momentum])
    with pytest.raises(NonFiniteStateError, match="units of time and length"):
        propagate(atoms, (0, 1e-11), [4e-10, 0], samples=4)
    motion = propagate(atoms, (0, 1e-11), [4e-10, 0], method=Splitting("kahan-li-8"), step=1e-15, samples=4)
    assert abs(motion.energy_error).max() < 1e-12
