"""Steps of Taylor's method whose last two coefficients vanish in mid-motion, beside zeros of high powers."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import sympy as sp
from heyoka import taylor_outcome

from canon import Event, Hamiltonian, Lagrangian, coordinates, propagate
from canon import time as t
from canon.expression.graph.graph import Graph
from canon.flow import NonFiniteStateError
from canon.flow.adaptive import taylor_orbit, tested_steps
from canon.flow.adaptive.tested_steps import good_steps
from canon.flow.checked_request import hamilton_equations_of
from canon.kernel.heyoka_bridge import taylor_integrator
from canon.kernel.program.series_gaps import may_have_gaps
from canon.mechanics.hamilton.vector_field import VectorField

x, y = coordinates("x y")
START = (1.5708, 0.0)


def well(power: int, *more: sp.Expr) -> Hamiltonian:
    return Hamiltonian(x.momentum**2 / 2 + x**power / 8 + sum(more), [x], [x.momentum])


def missed(motion: Any, y0: Any, H: Hamiltonian) -> np.ndarray:
    """Return the true errors by more digits, whose own error the energy tells: it is another function of all digits."""
    t_span = (float(motion.t[0]), float(motion.t[-1]))
    exact = propagate(
        H, t_span, y0, times=motion.t[1:], precision=40 if motion.precision == "quad" else "quad"
    )
    if H.t not in H.H.free_symbols:
        assert abs(exact.energy_error).max() < 1e-20
    return abs((motion.y - exact.y) + (np.longdouble(1) * motion.carried - exact.carried)).astype(float)


def test_a_flat_well_is_crossed_in_steps_that_are_short_enough() -> None:
    H = well(16)
    motion = propagate(H, (0, 2), START, samples=10)
    estimate = motion.error_estimate()
    assert (missed(motion, START, H) <= estimate.error).all()
    assert estimate.relative[-1] < 1e-11


def test_untested_steps_go_to_infinity_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """The wrong twin: the well has no way out."""
    monkeypatch.setattr(taylor_orbit, "_is_tested", lambda *_: False)
    with pytest.raises(NonFiniteStateError):
        propagate(well(16), (0, 3), START, samples=5)


def test_a_step_too_long_is_found_and_no_other() -> None:
    system = hamilton_equations_of(well(16), {})
    made = taylor_integrator(system, [Fraction(1, 4), Fraction(10)], Fraction(0), None)
    *_, piece, _ = made.propagate_until(0.02, c_output=True)
    assert good_steps(piece, made) == (len(piece.times) - 1, 0.0)
    made.state[:], made.time = [0.01, 10.0], 0.0
    *_, piece, _ = made.propagate_until(0.5, c_output=True, max_steps=1)
    good, missed = good_steps(piece, made)
    assert good == 0
    assert missed > 1e6


@pytest.mark.parametrize("most", [200, 10_000])
def test_good_steps_go_on_to_the_end_or_as_many_as_are_wanted(most: int) -> None:
    spring = Hamiltonian((x.momentum**2 + x**2) / 2, [x], [x.momentum])
    made = taylor_integrator(hamilton_equations_of(spring, {}), [Fraction(1), Fraction(0)], Fraction(0), None)
    tested = tested_steps.TestedSteps(made, lambda: made, [], None)
    ended = tested.towards(2000.0, most)
    assert ended == (taylor_outcome.step_limit if most == 200 else taylor_outcome.time_limit)
    assert (tested.steps == most) == (most == 200)
    np.testing.assert_allclose(made.state, [np.cos(made.time), -np.sin(made.time)], atol=1e-12)


@pytest.mark.parametrize(("start", "is_good"), [(1000.0, True), (100.0, False), (-1000.0, True)])
def test_what_a_step_has_missed_counts_in_parts_of_its_larger_end(start: float, is_good: bool) -> None:
    """A step of 10 to the origin, along x = s − s t/10 + c t², whose end moves by 2 · 10 c too fast."""
    c = 1e-13
    made = SimpleNamespace(state=np.zeros(1), dtime=0.0, time=0.0, tol=1e-16, step=lambda **_: None)
    made.tc = np.array([[100 * c, -start / 10, 0.0]])
    piece = SimpleNamespace(tcs=np.array([[[start, -start / 10, c]]]), times=np.array([0.0, 10.0]))
    good, missed = good_steps(piece, made)
    assert good == is_good
    assert missed == (0.0 if is_good else pytest.approx(10 * 20 * c / (1e-16 * abs(start)), rel=1e-2))


@pytest.mark.parametrize(("made", "halvings"), [(31, 1), (32, 0)])
def test_halvings_no_longer_count_after_many_good_steps(made: int, halvings: int) -> None:
    trial = tested_steps._Trial()
    trial.failed(1e6)
    trial.succeeded(made)
    assert trial.halvings == halvings


def test_late_times_do_not_look_like_steps_too_long() -> None:
    """The lengths of steps are differences of rounded times; here they are right to seven digits."""
    H = well(16, x**2 / 2)
    early, late = (propagate(H, (at, at + 2), START, samples=4) for at in (0, 2**29))
    assert late.steps < 1.5 * early.steps
    assert abs(late.y - early.y).max() < 1e-5


@pytest.mark.parametrize(("precision", "limit"), [("extended", 1e-15), ("quad", 1e-15)])
def test_in_wider_numbers_too(precision: str, limit: float) -> None:
    H = well(16)
    motion = propagate(H, (0, 1), START, samples=10, precision=precision)
    assert missed(motion, START, H).max() < limit * 20
    assert abs(motion.energy_error).max() < limit


def test_events_are_met_once_each() -> None:
    """The motion is even about turning points, odd about the middle, which it passes at 1/4, 3/4, … of a period."""
    found = propagate(well(16), (0, 2.5), START, events=[Event(x)], samples=7).events
    times = np.array([crossing.t for crossing in found])
    assert len(times) > 10
    np.testing.assert_allclose(times, times[0] * (2 * np.arange(len(times)) + 1), rtol=1e-11)
    stopped = propagate(well(16), (0, 2.5), START, events=[Event(x, -1, "stop")], samples=7)
    assert stopped.t[-1] == pytest.approx(times[0], rel=1e-13)


def test_dense_backward_and_many_at_once() -> None:
    H = well(16)
    dense = propagate(H, (0, 2), START, samples=4, dense=True)
    often = propagate(H, (0, 2), START, samples=64)
    np.testing.assert_allclose(dense(often.t), often.y, atol=1e-9)
    back = propagate(H, (2, 0), dense.y[:, -1], samples=4)
    np.testing.assert_allclose(back.y[:, -1], START, atol=1e-10)
    several = propagate(H, (0, 2), np.array([START, (0.0, 10.0)]).T, samples=4)
    np.testing.assert_allclose(several.y[:, :, 0], dense.y, atol=1e-10)


def test_a_vector_field_and_a_driven_lagrangian() -> None:
    v = x.dot
    exact = propagate(well(16), (0, 2), START, samples=8)
    field = VectorField((v, -2 * x**15), (x, v))
    by_field = propagate(field, (0, 2), START, samples=8)
    np.testing.assert_allclose(by_field.y, exact.y, atol=1e-10)
    pushed = Lagrangian(v**2 / 2 - x**16 / 8 + x * sp.cos(t), [x])
    H = well(16, -x * sp.cos(t))
    motion = propagate(H, (0, 2), START, samples=8)
    assert (missed(motion, START, H) <= motion.error_estimate().error).all()
    np.testing.assert_allclose(propagate(pushed, (0, 2), START, samples=8).y, motion.y, atol=1e-10)


def test_motion_into_a_singularity_ends_there() -> None:
    """ẋ = x⁹: x = (1 − 8t)^(−1/8) is without bound at t = 1/8."""
    with pytest.raises(NonFiniteStateError) as lost:
        propagate(VectorField((x**9,), (x,)), (0, 1), [1.0])
    assert lost.value.time == pytest.approx(0.125, rel=1e-6)


def test_ordinary_systems_are_not_tested() -> None:
    r = sp.sqrt(x**2 + y**2)
    for V in (-1 / r, x**2 * y - y**3 / 3, -sp.cos(x), (x - y) ** 4, x**6, r**-12 - r**-6, sp.exp(-x) * y**2):
        system = hamilton_equations_of(
            Hamiltonian((x.momentum**2 + y.momentum**2) / 2 + V, [x, y], [x.momentum, y.momentum]), {}
        )
        assert not may_have_gaps(system.graph, system.rates, 20), V


def test_gaps_are_where_no_coefficient_of_the_last_two_is_filled() -> None:
    """By counting: x″ = x^d has the coefficients kD + 1 of x and kD of its rate, D = d + 1, and k of any size.

    Where kD = order + 1 the gap fills in proportion to the distance from the zero, which does no harm.
    """
    for order in range(3, 26):
        for degree in range(1, 32):
            graph = Graph()
            filled = [{k * period for k in range(40)} for period in range(2, degree + 2)]
            gap = any(multiples.isdisjoint(range(order - 2, order + 2)) for multiples in filled)
            assert may_have_gaps(graph, [graph.from_sympy(x**degree)], order) == gap, (order, degree)


POWERS = (4, 6, 7, 8, 9, 10, 11, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30)
STARTS = ((1.5708, 0.0), (1.1, -0.3), (0.0, 2.0), (0.31, 1.5), (-0.07, -3.0), (0.9, 0.0))
WAYS: dict[str, dict[str, Any]] = {
    "double": {},
    "extended": {"precision": "extended"},
    "quad": {"precision": "quad"},
    "tolerance": {"tolerance": 1e-9},
}


SHAPES = {
    "alone": lambda n: well(n + n % 2),
    "over a spring": lambda n: well(n + n % 2, x**2 / 50),
    "aside": lambda n: Hamiltonian(x.momentum**2 / 2 + (x**2 - sp.Rational(1, 4)) ** (n // 2), [x], [x.momentum]),
    "driven": lambda n: well(n + n % 2, -x * sp.cos(3 * t) / 10),
}  # fmt: skip


FEWER = (4, 7, 10, 14, 18, 24, 30)
"""Powers of the ways in which each of them needs machine code of its own, by far the most of the time."""
OF_WAYS = {"double": POWERS[::2], "quad": (7, 16, 30), "extended": FEWER, "tolerance": FEWER}


def end(power: int, start: tuple[float, float]) -> float:
    """Return 2, or a time of seventeen periods for the fastest, which take ten thousand steps to 2."""
    return 0.25 if power >= 24 and start == STARTS[0] else 2.0


def scan_wells(name: str, shape: str) -> None:
    for power, start in itertools.product(
        OF_WAYS.get(name, POWERS), STARTS[:3] if name == "quad" else STARTS
    ):
        H = SHAPES[shape](power)
        motion = propagate(H, (0, end(power, start)), start, samples=4, **WAYS[name])
        estimate = motion.error_estimate()
        where = f"{shape}, x^{power} from {start}: {estimate}"
        assert (missed(motion, start, H) <= estimate.error).all(), where
        assert estimate.relative[-1] < (1e-3 if name == "tolerance" else 1e-8), where


def scan_fields_and_ensembles(first: int, step: int) -> None:
    starts = np.array(STARTS).T
    for power in POWERS[first::step]:
        even = power + power % 2
        H = well(even)
        t_span = (0, end(power, STARTS[0]))
        together = propagate(H, t_span, starts, samples=4)
        stated = together.error_estimate().error
        field = VectorField((y, -sp.Rational(even, 8) * x ** (even - 1)), (x, y))
        for k, start in enumerate(STARTS):
            by_quad = propagate(H, t_span, start, samples=4, precision="quad")
            true, exact = missed(by_quad, start, H), by_quad.y
            assert true.max() < 1e-14
            own = propagate(field, t_span, start, samples=4)
            assert (abs(own.y - exact) <= own.error_estimate().error + true).all()
            assert (abs(together.y[:, :, k] - exact) <= stated[:, :, k] + true).all()


def in_a_child(call: str) -> None:
    """Run a scan in a process of its own: arrays of many digits are not given back while a process lives."""
    script = f"from {__name__} import *; {call}"
    path = os.pathsep.join(entry or str(Path.cwd()) for entry in sys.path)
    done = subprocess.run(
        [sys.executable, "-c", script], env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("name", WAYS)
def test_none_of_many_wells_is_silently_wrong(name: str, shape: str) -> None:
    in_a_child(f"scan_wells({name!r}, {shape!r})")


@pytest.mark.slow
@pytest.mark.parametrize("first", range(4))
def test_nor_are_fields_and_ensembles(first: int) -> None:
    in_a_child(f"scan_fields_and_ensembles({first}, 8)")


def test_a_trial_step_beyond_doubles_is_gone_back_from_in_silence():
    """Quad holds what doubles do not; no warning of NumPy's comes out (they are errors in tests)."""
    x, y = coordinates("x y")
    turning = sp.Rational(17, 16) * (x.momentum * y - y.momentum * x)
    kinetic = x.momentum**2 / 2 + sp.sqrt(1 + y.momentum**2)
    steep = Hamiltonian(kinetic + turning + x**2 / 8 + y**16 / 8, [x, y], [x.momentum, y.momentum])
    with pytest.raises(NonFiniteStateError, match=r"can't be continued after t = 2\.74418365"):
        propagate(steep, (0, 3), [np.pi / 2, 0, 0, 0], precision="quad", samples=4)
