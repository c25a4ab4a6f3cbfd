"""Cost against precision: errors against closed forms, orders from the rows, costs that add up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from canon import DOP853, RK4, Hamiltonian, Splitting, Taylor, coordinates, propagate
from canon.flow.method.method import TimeTransformed
from canon.flow.propagation import propagated
from canon.plot import plot_work_precision
from canon.scene import find
from canon.study.energy_drift.drift_study import StudyError
from canon.study.method_choice.work_precision import WorkRow, _marked, work_precision


@pytest.fixture(scope="module")
def galaxy():
    methods = [Splitting("verlet"), Splitting("kahan-li-8"), RK4(), Taylor(), Splitting("blanes-moan-4")]
    return work_precision(
        find("henon-heiles"),
        20.0,
        methods=methods,
        steps=(0.2, 0.1, 0.05),
        tolerances=[1e-6, 1e-12],
        repetitions=2,
    )


def rows_of(found, name):
    return [row for row in found.rows if str(row.method).startswith(name)]


@pytest.mark.parametrize(
    ("name", "order"), [("verlet", 2), ("blanes-moan-4", 4), ("RK4", 4), ("kahan-li-8", 8)]
)
def test_the_final_position_converges_with_the_order(galaxy, name, order):
    _, row, finer = rows_of(galaxy, name)
    measured = math.log2(row.position_error / finer.position_error) / math.log2(row.step / finer.step)
    assert measured == pytest.approx(order, abs=0.35 if order < 8 else 1.0)


def test_the_position_error_is_the_distance_from_the_closed_form():
    """x = cos(√(k/m) t) at the end of the run; the reference itself is far better."""
    scene = find("harmonic-oscillator")
    k, m = scene.values["k"], scene.values["m"]
    span, step = 7.3, 0.0073
    found = work_precision(scene, span, methods=[Splitting("verlet")], steps=[step], repetitions=1).rows[0]
    motion = propagate(
        scene.hamiltonian,
        (0.0, span),
        scene.state(),
        method=Splitting("verlet"),
        step=step,
        parameters=scene.values,
    )
    exact = 0.1 * math.cos(math.sqrt(k / m) * span)
    assert found.position_error == pytest.approx(abs(motion.q[0, -1] - exact) / abs(exact), rel=1e-6)


def test_rows_tell_what_they_cost(galaxy):
    for name, stages in (("verlet", 1), ("kahan-li-8", 17), ("RK4", 4)):
        for row in rows_of(galaxy, name):
            assert row.evaluations == stages * round(20.0 / row.step)
            assert row.cpu_seconds > 0.0
            assert row.tolerance is None
    coarse, fine = rows_of(galaxy, "Taylor")
    assert (coarse.tolerance, fine.tolerance) == (1e-6, 1e-12)
    assert fine.position_error < 1e-4 * coarse.position_error


def test_time_is_that_of_the_steps_and_not_of_samples(monkeypatch):
    """Errors come from a run with samples, times from runs without."""
    kept, seconds = [], []

    def watched(request, progress):
        found = propagated(request, progress)
        kept.append(request.samples)
        seconds.append(found.cpu_seconds)
        return found

    monkeypatch.setattr("canon.study.motion.quiet_run.propagated", watched)
    found = work_precision(
        find("henon-heiles"), 30.0, methods=[Splitting("verlet")], steps=[0.01], repetitions=3
    )
    assert kept == [1000, 1000, 1, 1, 1]
    assert found.rows[0].cpu_seconds == min(seconds[2:])


def test_a_run_that_fails_is_a_row_with_the_reason():
    found = work_precision(
        find("double-pendulum"), 3.0, methods=[Splitting("verlet"), RK4()], steps=[0.01], repetitions=1
    )
    verlet, runge_kutta = found.rows
    assert "does not split" in verlet.failure
    assert math.isnan(verlet.position_error)
    assert runge_kutta.position_error < 1e-3


def test_requests_that_make_no_sense():
    scene = find("henon-heiles")
    with pytest.raises(StudyError, match="RK4 takes steps of given sizes"):
        work_precision(scene, 10.0, methods=[RK4()], tolerances=[1e-6])
    with pytest.raises(StudyError, match="give tolerances"):
        work_precision(scene, 10.0, methods=[DOP853()], steps=[0.1])
    with pytest.raises(StudyError, match="at least once"):
        work_precision(scene, 10.0, methods=[RK4()], steps=[0.1], repetitions=0)
    x = coordinates("x")
    falling = Hamiltonian(x.momentum**2 / 2 - 1 / x, [x], [x.momentum])
    with pytest.raises(StudyError, match="the reference could not be run"):
        work_precision(falling, 10.0, [1.0, 0.0], methods=[RK4()], steps=[0.1])


def resonance(errors):
    rows = [
        WorkRow(RK4(), step, None, energy_error=error)
        for step, error in zip(
            np.geomspace(0.1, 0.1 / 2 ** (len(errors) - 1), len(errors)), errors, strict=True
        )
    ]
    return [row.resonant for row in _marked(rows)]


def test_a_step_that_stands_out_from_its_neighbours_is_resonant():
    smooth = [1e-4 * 2.0 ** (-4 * i) for i in range(5)]
    assert resonance(smooth) == [False] * 5
    peaked = [*smooth]
    peaked[2] *= 30.0
    assert resonance(peaked) == [False, False, True, False, False]
    peaked[2] /= 5.0
    assert resonance(peaked) == [False] * 5


def test_time_transformed_methods_have_their_order_of_the_step():
    method = TimeTransformed(Splitting("verlet"))
    found = work_precision(find("kepler"), 1.0, methods=[method], steps=[0.004, 0.002], repetitions=1)
    assert [row.tolerance for row in found.rows] == [None, None]
    errors = [row.position_error for row in found.rows]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.02)


def test_precisions_side_by_side():
    """Single precision stops at its round-off, doubles go on with the order of the method."""
    found = work_precision(
        find("henon-heiles"),
        20.0,
        methods=[Splitting("kahan-li-8"), Taylor()],
        steps=iter([0.4, 0.1]),
        tolerances=[1e-9],
        precision=["single", "double"],
        repetitions=1,
    )
    assert [row.precision for row in found.rows] == ["single", "single", "double", "double", "double"]
    single, double = found.rows[1], found.rows[3]
    assert single.position_error > 1e-7 > 1e-10 > double.position_error


def test_the_picture_holds_every_run(galaxy):
    axes = plot_work_precision(galaxy)
    lines = {line.get_label(): line for line in axes.lines if not line.get_label().startswith("_")}
    assert set(lines) == {"verlet", "kahan-li-8", "RK4", "Taylor", "blanes-moan-4"}
    np.testing.assert_array_equal(
        lines["RK4"].get_ydata(), [row.position_error for row in rows_of(galaxy, "RK4")]
    )
    energy = plot_work_precision(galaxy, cost="evaluations", error="energy")
    assert energy.get_xlabel() == "evaluations of the force"
    with pytest.raises(ValueError, match="there are cpu"):
        plot_work_precision(galaxy, cost="money")
