"""Numbers of Hairer, Lubich & Wanner, Geometric Numerical Integration: orders, growth of errors, modified energies."""

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, coordinates, propagate
from canon.flow import RK4, AccuracyWarning, Splitting, Taylor, flow_jacobian
from canon.kernel.schemes.order_conditions import order
from canon.kernel.schemes.splitting_schemes import SCHEMES

SYMPLECTIC_EULER = Splitting(a=[1], b=[1])


@pytest.mark.parametrize(
    ("scheme", "printed", "right"),
    [
        ("forest-ruth", "1.3512071919596578", True),
        ("forest-ruth", "1.3512071919596758", False),
        ("suzuki-4", "0.4144907717943757", True),
        ("suzuki-4", "0.4144907717943575", False),
    ],
)
def test_composition_constants_as_printed(scheme, printed, right):
    """§ II.4: 1/(2 − 2^{1/3}) of the triple jump and 1/(4 − 4^{1/3}) of Suzuki's fractal."""
    assert bool(abs(float(SCHEMES[scheme].b[0]) - float(printed)) < 1e-15) is right


@pytest.mark.parametrize(("power", "right"), [("1/3", True), ("1/2", False)])
def test_the_triple_jump_is_of_order_four(power, right):
    """§ II.4: with the exponent 1/(p + 1) of the order p = 2 of the basic method; with another it stays at 2."""
    outer = 1 / (2 - 2 ** sp.Rational(power))
    b = [outer, 1 - 2 * outer, outer]
    a = [b[0] / 2, (b[0] + b[1]) / 2, (b[1] + b[2]) / 2, b[2] / 2]
    assert bool(order([x.n(60) for x in a], [x.n(60) for x in b]) == 4) is right


def _kepler(e=0.6):
    (x, y), half = coordinates("x y"), sp.Rational(1, 2)
    u, v = x.momentum, y.momentum
    H = Hamiltonian(half * (u**2 + v**2) - 1 / sp.sqrt(x**2 + y**2), [x, y], [u, v])
    return H, np.array([1 - e, 0, 0, np.sqrt((1 + e) / (1 - e))])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "steps", "power", "right"),
    [
        (SYMPLECTIC_EULER, 20_000, 1, True),
        (Splitting("verlet"), 2000, 1, True),
        (Splitting("verlet"), 2000, 2, False),
        (RK4(), 400, 2, True),
        (RK4(), 400, 1, False),
    ],
    ids=str,
)
def test_errors_of_keplers_motion_grow_linearly_for_symplectic_methods(method, steps, power, right):
    """Table I.2.1: the global error is O(t) for symplectic and O(t²) for other methods."""
    H, start = _kepler()
    turns = 2 * np.pi * np.array([10, 20, 40, 80])
    errors = [
        np.linalg.norm(
            (propagate(H, (0, t), start, method=method, step=2 * np.pi / steps, samples=1).final - start)[:2]
        )
        for t in turns
    ]
    fitted = np.polyfit(np.log(turns), np.log(errors), 1)[0]
    assert bool(abs(fitted - power) < 0.15) is right


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "method", "power", "right"),
    [
        ("symplectic Euler", SYMPLECTIC_EULER, 1, True),
        ("symplectic Euler", SYMPLECTIC_EULER, 2, False),
        ("Störmer–Verlet", Splitting("verlet"), 2, True),
        ("Störmer–Verlet", Splitting("verlet"), 1, False),
    ],
)
def test_the_energy_error_of_keplers_motion_is_bounded_by_a_power_of_the_step(name, method, power, right):
    """Table I.2.1: in H it is O(h) for the symplectic Euler and O(h²) for the Störmer–Verlet method."""
    H, start = _kepler(e=0.2)
    steps = np.array([0.02, 0.01, 0.005])
    errors = []
    for h in steps:
        x, y, u, v = propagate(H, (0, 60), start, method=method, step=h, samples=3000).y
        energy = (u**2 + v**2) / 2 - 1 / np.hypot(x, y)
        errors.append(np.abs(energy - energy[0]).max())
    assert bool(abs(np.polyfit(np.log(steps), np.log(errors), 1)[0] - power) < 0.2) is right


@pytest.mark.slow
@pytest.mark.parametrize(
    ("weight", "power", "right"),
    [(0, 2, True), (1, 4, True), (1, 2, False), (-1, 4, False), (sp.Rational(1, 2), 4, False)],
)
def test_verlet_keeps_its_modified_energy(weight, power, right):
    """§ IX.3: H + h²(p²U″/12 − U′²/24) of the pendulum, kicks first, is kept to O(h⁴); weights are of the h² terms."""
    q = coordinates("q")
    pendulum = Hamiltonian(q.momentum**2 / 2 - sp.cos(q), [q], [q.momentum])
    kick_first = Splitting(a=[0, 1], b=["1/2", "1/2"])
    steps, errors = np.array([0.2, 0.1, 0.05]), []
    for h in steps:
        motion = propagate(
            pendulum, (0, 20), [1, 0.5], method=kick_first, step=h, times=np.arange(0, 20.01, 0.2)
        )
        x, p = motion.y
        more = p**2 * np.cos(x) / 12 - np.sin(x) ** 2 / 24
        energy = p**2 / 2 - np.cos(x) + float(weight) * h**2 * more
        errors.append(np.ptp(energy))
    assert bool(abs(np.polyfit(np.log(steps), np.log(errors), 1)[0] - power) < 0.2) is right


@pytest.mark.slow
@pytest.mark.parametrize(("step", "stable"), [(1.99, True), (2.01, False)])
def test_verlet_is_stable_for_steps_below_two_over_the_frequency(step, stable):
    """§ I.5, § XIII.1: |hω| < 2: the trace of a step's matrix, 2 − h²ω², lies between −2 and 2."""
    q = coordinates("q")
    oscillator = Hamiltonian(q.momentum**2 / 2 + q**2 / 2, [q], [q.momentum])
    with pytest.warns(AccuracyWarning, match="far too large"):  # that is what is looked at
        M = flow_jacobian(oscillator, (0, step), [1, 0], method=Splitting("verlet"), step=step).M[..., -1]
    assert bool(abs(np.trace(M)) < 2) is stable
    assert np.trace(M) == pytest.approx(2 - step**2, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(("springs", "right"), [((0, 1, 2), True), ((0,), False)])
def test_the_energy_of_all_stiff_springs_is_nearly_kept(springs, right):
    """§ I.5.1, figure 5.2: ω = 50; stiff springs exchange their energies, whose sum stays within O(1/ω)."""
    omega, q = 50, coordinates("q1 q2 q3 q4 q5 q6")
    p = [x.momentum for x in q]
    ends = [0, *q, 0]
    stiff = sum((q[2 * i + 1] - q[2 * i]) ** 2 for i in range(3)) * sp.Rational(omega**2, 4)
    soft = sum((ends[2 * i + 1] - ends[2 * i]) ** 4 for i in range(4))
    chain = Hamiltonian(sum(x**2 for x in p) / 2 + stiff + soft, q, p)
    start = np.zeros(12)
    start[:2] = np.array([1 - 1 / omega, 1 + 1 / omega]) / np.sqrt(2)
    start[7] = np.sqrt(2)
    y = propagate(chain, (0, 200), start, method=Splitting("kahan-li-6"), step=0.002, samples=2000).y
    energies = [
        (y[7 + 2 * i] - y[6 + 2 * i]) ** 2 / 4 + omega**2 * (y[1 + 2 * i] - y[2 * i]) ** 2 / 4
        for i in range(3)
    ]
    assert bool(np.ptp(sum(energies[i] for i in springs)) < 0.13) is right


@pytest.mark.slow
def test_the_referee_returns_to_keplers_start():
    """§ I.2.2: the exact motion has the period 2π whatever its eccentricity."""
    H, start = _kepler()
    assert abs(propagate(H, (0, 2 * np.pi), start, method=Taylor()).final - start).max() < 1e-13
    assert abs(propagate(H, (0, 2 * np.pi - 0.01), start, method=Taylor()).final - start).max() > 1e-3
