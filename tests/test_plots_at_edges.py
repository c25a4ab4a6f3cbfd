"""Pictures at their edges: nothing to draw, no figure to draw in, no writer; scenes without a picture of their own."""

from __future__ import annotations

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

from canon import RK4, Hamiltonian, Splitting, Study, Taylor, coordinates, propagate, results_of, run_study
from canon.flow import megno
from canon.plot import (
    PlotError,
    plot_chaos_map,
    plot_drift_by_step,
    plot_ensemble_fan,
    plot_phase_portrait,
    plot_study_heatmap,
    plot_work_precision,
    study_page,
)
from canon.plot.scene import animate_scene, plot_scene
from canon.plot.study_page import study_report
from canon.scene import find
from canon.scene.scene_motion import run
from canon.study.energy_drift.drift_rows import DriftRow
from canon.study.method_choice.work_precision import WorkPrecision, WorkRow
from canon.study.motion.hamiltonian_text import formula_of

x, y = coordinates("x y")
QUARTIC = Hamiltonian(x.momentum**2 / 2 + x**4 / 4, [x], [x.momentum])
OTHER = Hamiltonian(y.momentum**2 / 2 + y**4 / 4, [y], [y.momentum])
VERLET = {"method": Splitting("verlet"), "step": 0.1, "samples": 250}


@pytest.fixture(autouse=True)
def closed():
    """Close what a test has drawn."""
    yield
    plt.close("all")


def test_a_phase_portrait_of_two_motions_has_the_names_of_both_or_neither():
    one, other = (propagate(H, (0, 6), [1.0, 0.0], **VERLET) for H in (QUARTIC, OTHER))
    alike, different = plot_phase_portrait([one, one]), plot_phase_portrait([one, other])
    assert (alike.get_xlabel(), alike.get_ylabel()) == ("x", "p_x")
    assert len(different.lines) == 2
    assert "x" not in (different.get_xlabel(), different.get_ylabel())
    assert different.get_xlabel()


def test_a_fan_of_errors_that_are_zero_is_refused():
    rest, moving = np.zeros((2, 5)), np.array([[1.0, 1.1, 1.2, 1.3, 1.4], [0.0] * 5])
    with pytest.raises(ValueError, match="the error is zero throughout: there is nothing to draw"):
        plot_ensemble_fan(propagate(QUARTIC, (0, 20), rest, **VERLET))
    assert plot_ensemble_fan(propagate(QUARTIC, (0, 20), moving, **VERLET)).lines


def test_orbits_that_are_on_no_grid_make_no_map():
    starts = np.array([np.linspace(0.1, 2.0, 30), np.zeros(30)])
    found = megno(QUARTIC, (0, 20), starts, method=Splitting("verlet"), step=0.1)
    with pytest.raises(
        ValueError, match="30 orbits at 30 values across and 30 up are no grid: take the starts"
    ):
        plot_chaos_map(found, range(30), range(30))
    number = np.arange(30)
    assert plot_chaos_map(found, number % 6, number // 6).collections


def test_a_scene_without_a_picture_is_drawn_in_its_coordinates():
    plain, planet = find("henon-heiles"), find("kepler")
    assert plain.picture_of is None
    axes = plot_scene(motion := run(plain, "regular", 1.0))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x", "y")
    np.testing.assert_allclose(axes.lines[0].get_xdata(), motion.q[0])
    ground = [line for line in plot_scene(run(planet, "e=0.6", 1.0)).lines if len(line.get_xdata()) > 10]
    assert len(ground) == 2
    assert not plot_scene(run(planet, "e=0.6", 1.0)).axison


def test_a_film_needs_what_writes_it(tmp_path):
    motion = run(find("simple-pendulum"), "small", 0.1)
    with (
        mpl.rc_context({"animation.ffmpeg_path": str(tmp_path / "none")}),
        pytest.raises(
            PlotError, match=r"ffmpeg is not installed, which writes .mp4; install it, or write .gif"
        ),
    ):
        animate_scene(motion, tmp_path / "film.mp4")
    with pytest.raises(ValueError, match=r"film.avi: animations are written as .gif or .mp4"):
        animate_scene(motion, tmp_path / "film.avi")
    animate_scene(motion, tmp_path / "film.gif", seconds=0.1)
    assert (tmp_path / "film.gif").read_bytes().startswith(b"GIF8")


@pytest.fixture(scope="module")
def at_rest(tmp_path_factory):
    """Two cases of two motions, one of which is at rest."""
    path = tmp_path_factory.mktemp("rest") / "study.sqlite"
    common = {"method": "verlet", "step": 0.1, "span": 40.0, "samples": 300}
    for start in ([0.0, 0.0], [1.0, 0.0]):
        run_study(Study.of(system=formula_of(QUARTIC, "own"), start=[start], **common), path)
    return results_of(path)


def test_a_case_without_any_error_is_a_zero_on_the_map(at_rest):
    axes = plot_study_heatmap(at_rest)
    assert [text.get_text() for text in axes.texts] == ["0"]
    values = axes.images[0].get_array()
    assert np.isnan(np.ma.filled(values, np.nan)).sum() == 1


def test_axes_that_belong_to_no_figure_are_refused(at_rest):
    _, axes = plt.subplots()
    axes.remove()
    with pytest.raises(PlotError, match=r"the Axes belong to no figure; make them with plt.subplots"):
        plot_study_heatmap(at_rest, axes)


def test_a_page_shows_figures_of_some_motions_and_a_table_of_all(at_rest, monkeypatch):
    monkeypatch.setattr(study_page, "MOTIONS", 1)
    part = study_report(at_rest, "Rest")
    assert "Figures are shown of the first 1 of 2 motions; the table has all." in part
    assert part.count("<tr class=") == 2
    assert part.count("<h2>") == 2
    monkeypatch.setattr(study_page, "MOTIONS", 2)
    assert "Figures are shown" not in "".join(study_page._motions(at_rest))


def test_runs_that_failed_have_no_line():
    good = [WorkRow(RK4(), h, None, 0.1 / h, 10, 1e-3 * h**4, h**4) for h in (0.1, 0.2)]
    lost = WorkRow(Splitting("verlet"), 0.5, None, failure="it left")
    axes = plot_work_precision(WorkPrecision("both", 1.0, (*good, lost)))
    assert [line.get_label() for line in axes.lines] == ["RK4"]
    none = plot_work_precision(WorkPrecision("none", 1.0, (lost,)))
    assert not none.lines
    assert none.get_legend() is None
    empty = np.empty(0)
    rows = [DriftRow(Taylor(), 0.1, empty, empty, failure="it left")]
    assert plot_drift_by_step(rows).get_legend() is None
