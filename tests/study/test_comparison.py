"""Methods side by side on real motions, and the table that says what they did."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from canon import DOP853, RK4, Gauss, Hamiltonian, Splitting, Taylor, coordinates, propagate
from canon.flow.method.method import TimeTransformed
from canon.scene import find
from canon.study.energy_drift.drift import Growth
from canon.study.energy_drift.drift_study import StudyError, drift_study
from canon.study.energy_drift.drift_table import drift_table, with_error

x = coordinates("x")
METHODS = (Splitting("kahan-li-8"), Splitting("verlet"), RK4(), Taylor())


@pytest.fixture(scope="module")
def galaxy():
    return drift_study(find("henon-heiles"), methods=METHODS, periods=1000.0)


def test_symplectic_methods_stay_bounded_and_runge_kutta_drifts(galaxy):
    kahan_li, verlet, runge_kutta, taylor = (row.drift for row in galaxy.rows)
    assert kahan_li.verdict in (Growth.BOUNDED, Growth.ROUND_OFF)
    assert kahan_li.walk < 2.0**-53 * galaxy.rows[0].steps ** 0.5
    assert abs(kahan_li.slope) < 3 * kahan_li.slope_error < 1e-17
    assert verdict_and_size(verlet) == (Growth.BOUNDED, -2)
    assert runge_kutta.verdict is Growth.SECULAR
    assert taylor.verdict in (Growth.ROUND_OFF, Growth.BOUNDED)
    assert kahan_li.bound < 1e-11
    assert taylor.bound < 1e-13


def test_compensation_keeps_round_off_below_its_usual_size(galaxy):
    """A random walk of 0.05 to 0.2 u√n with compensation, of several u√n without."""
    naive = drift_study(find("henon-heiles"), methods=METHODS[:1], periods=1000.0, precision="double").rows[0]
    unit = 2.0**-53 * math.sqrt(naive.steps)
    assert galaxy.rows[0].drift.walk < 0.4 * unit
    assert naive.drift.verdict is Growth.ROUND_OFF
    assert unit < naive.drift.walk < 10.0 * unit


def verdict_and_size(found):
    return found.verdict, round(math.log10(found.bound))


def test_the_secular_slope_is_that_of_the_whole_run(galaxy):
    row = galaxy.rows[2]
    assert row.drift.slope == pytest.approx(row.error[-1] / galaxy.span, rel=0.02)
    assert row.drift.exponent == pytest.approx(1.0, abs=0.02)


def test_drift_falls_with_the_fifth_power_of_the_step():
    """RK4 loses energy at a rate of order h⁵ (the fourth-order term of its modified energy does no work)."""
    slopes = [
        drift_study(find("henon-heiles"), methods=[RK4()], periods=300.0, step=h).rows[0].drift.slope
        for h in (0.12, 0.06)
    ]
    assert math.log2(slopes[0] / slopes[1]) == pytest.approx(5.0, abs=0.3)


def test_rows_tell_their_cost(galaxy):
    for row, stages in zip(galaxy.rows[:3], (17, 1, 4), strict=True):
        assert row.steps == math.ceil(galaxy.span / (galaxy.period / (48.0 + (1.0 + 5.0**0.5) / 2.0)))
        assert row.evaluations == stages * row.steps
        assert row.cpu_seconds > 0.0
    assert galaxy.rows[3].step is None


def test_a_study_is_what_propagate_and_drift_say():
    scene = find("simple-pendulum")
    study = drift_study(scene, "small", methods=[RK4()], span=400.0, step=0.1, samples=2000)
    motion = propagate(
        scene.hamiltonian,
        (0.0, 400.0),
        scene.state("small"),
        method=RK4(),
        step=0.1,
        parameters=scene.values,
        samples=2000,
    )
    np.testing.assert_array_equal(study.rows[0].error, motion.energy_error)
    assert study.rows[0].drift.bound == np.abs(motion.energy_error).max()


def test_parameters_replace_those_of_the_scene():
    scene = find("harmonic-oscillator")
    soft = drift_study(scene, methods=[RK4()], span=100.0, step=0.01, parameters={"k": 0.1})
    stiff = drift_study(scene, methods=[RK4()], span=100.0, step=0.01, parameters={"k": 100.0})
    assert soft.rows[0].drift.bound < 1e-3 * stiff.rows[0].drift.bound


def test_a_method_that_does_not_fit_is_a_row_with_the_reason():
    study = drift_study(find("double-pendulum"), methods=[Splitting("verlet"), Taylor()], periods=60.0)
    verlet, taylor = study.rows
    assert verlet.drift is None
    assert verlet.error.size == 0
    assert "does not split into drifts and kicks" in verlet.failure
    assert taylor.drift is not None
    table = drift_table(study)
    assert "verlet failed: H is not separable" in table


def test_time_transformed_methods_take_the_step_of_a_study():
    method = TimeTransformed(Splitting("verlet"))
    study = drift_study(find("kepler"), methods=[method, Splitting("verlet")], periods=50, tolerance=1e-6)
    transformed, plain = study.rows
    assert not transformed.failure
    assert transformed.step == pytest.approx(plain.step, rel=1e-3)
    # On Kepler's problem it errs in time only: Mikkola & Tanikawa 1999.
    assert transformed.drift.bound < 1e-13 < 1e-3 < plain.drift.bound


def test_a_collision_is_a_row_with_the_reason():
    scene = find("kepler")
    y = scene.state()
    y[3] = 0.0
    with pytest.raises(StudyError, match=r"every run failed: Taylor: .*collision"):
        drift_study(scene, y, methods=[Taylor()], periods=10.0)


def test_a_hamiltonian_of_ones_own():
    quartic = Hamiltonian(x.momentum**2 / 2 + x**4 / 4, [x], [x.momentum])
    study = drift_study(quartic, [1.0, 0.0], methods=[Splitting("verlet")], span=2000.0, step=0.05)
    assert study.rows[0].drift.verdict is Growth.BOUNDED
    assert study.period is None
    assert "drift per unit of time" in drift_table(study)


def test_requests_that_make_no_sense():
    free = Hamiltonian(x.momentum**2 / 2, [x], [x.momentum])
    with pytest.raises(StudyError, match="does not tell its period"):
        drift_study(free, [0.0, 1.0], methods=[RK4()])
    with pytest.raises(StudyError, match="give step="):
        drift_study(free, [0.0, 1.0], methods=[RK4()], span=10.0)
    with pytest.raises(StudyError, match="no starts of its own"):
        drift_study(free, methods=[Taylor()], span=10.0)
    with pytest.raises(StudyError, match="no method"):
        drift_study(find("kepler"), methods=[])
    with pytest.raises(StudyError, match="positive, finite duration"):
        drift_study(find("kepler"), periods=-3.0)
    with pytest.raises(StudyError, match="at least 256"):
        drift_study(find("kepler"), samples=10)


def test_progress_is_reported_by_method():
    seen = []
    drift_study(
        find("henon-heiles"),
        methods=[RK4(), DOP853(1e-8)],
        periods=60.0,
        progress=lambda name, done: seen.append((name, done)),
    )
    assert {name for name, _ in seen} == {"RK4", "DOP853(1e-08)"}
    assert all(0.0 <= done <= 1.0 for _, done in seen)
    assert seen[-1][1] == 1.0


def test_the_table_is_aligned_and_says_what_it_means(galaxy):
    lines = drift_table(galaxy).splitlines()
    assert lines[0].startswith("Hénon–Heiles")
    assert lines[1] == "t = 0 … 6283.19, 1000 periods of 6.283"
    head, body = lines[3], lines[5:9]
    assert head.split()[:3] == ["method", "order", "step"]
    for name in ("max |ΔE/E|", "drift per period", "verdict"):
        assert name in head
    start = head.index("verdict")
    assert [line[start:].split()[0] for line in body] == [row.drift.verdict.value for row in galaxy.rows]
    assert {len(line) for line in (head, *body)} == {len(lines[4])}
    assert "bounded (drift < " in body[1]
    assert any(line.startswith("secular: grows steadily") for line in lines[10:])


@given(
    st.floats(-1e3, 1e3).filter(lambda x: x == 0.0 or abs(x) > 1e-200),
    st.floats(1e-30, 1e3),
)
def test_a_value_with_error_reads_back_to_within_its_error(value, error):
    text = with_error(value, error)
    digits, power = text.strip("(").split(")")
    mean, spread = (float(part) * 10.0 ** int(power[1:]) for part in digits.split(" ± "))
    assert abs(mean - value) <= max(0.051 * error, 0.51e-6 * abs(value))
    assert abs(spread - error) <= max(0.051 * error, 0.51e-6 * abs(value))


def test_a_start_given_by_velocities_keeps_them_whatever_the_mass():
    """Its momenta follow from the mass that was asked for, not from the scene's own."""
    scene = find("simple-pendulum")
    asked = {"methods": [Gauss(3)], "span": 20.0, "step": 0.02, "samples": 512}
    start = next(s.name for s in scene.starts if any(s.v or ()))
    by_value, changed = (
        drift_study(scene, start, parameters={"m": 3.0}, **asked),
        drift_study(scene.with_parameters(m=3.0), start, **asked),
    )
    np.testing.assert_array_equal(by_value.rows[0].final, changed.rows[0].final)
    own = drift_study(scene, start, **asked)
    np.testing.assert_allclose(by_value.rows[0].final, own.rows[0].final * [1.0, 3.0], rtol=1e-9)


@pytest.mark.parametrize("factor", [1, 1 + x**2], ids=["T + V", "does not split"])
def test_the_usual_methods_are_of_order_eight_and_two_beside_runge_kutta_and_taylor(factor):
    oscillator = Hamiltonian((factor * x.momentum**2 + x**2) / 2, [x], [x.momentum])
    eighth, second, *others = drift_study(oscillator, [1, 0], span=20, period=6, samples=300).rows
    assert [(row.method.order, row.method.is_symplectic) for row in (eighth, second)] == [
        (8, True),
        (2, True),
    ]
    assert [row.method for row in others] == [RK4(), Taylor()]
