"""What the pictures show: the data, the guides, names that can be read; and nothing is loaded before its time."""

from __future__ import annotations

import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from canon import RK4, Splitting, Taylor, propagate
from canon.plot import (
    COLOURS,
    PlotError,
    plot_block_means,
    plot_energy_error,
    plot_integral_drift,
    plot_phase_portrait,
)
from canon.scene import find
from canon.study.energy_drift.drift import drift
from canon.study.energy_drift.drift_study import drift_study
from canon.study.energy_drift.integral_drift import IntegralDrift


@pytest.fixture(scope="module")
def study():
    methods = [Splitting("kahan-li-8"), Splitting("verlet"), RK4(), Taylor()]
    return drift_study(find("henon-heiles"), methods=methods, periods=300.0)


def curves(axes):
    return [line for line in axes.lines if to_hex(line.get_color()).upper() in COLOURS]


def test_one_line_a_method_with_its_largest_error(study):
    axes = plot_energy_error(study)
    drawn = curves(axes)
    assert len(drawn) == len(study.rows)
    for line, row in zip(drawn, study.rows, strict=True):
        late = row.t >= study.period
        assert line.get_ydata().max() == np.abs(row.error[late]).max()
        assert line.get_xdata()[-1] == pytest.approx(300.0)
    assert len({(line.get_color(), line.get_linestyle()) for line in drawn}) == len(drawn)
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert axes.get_xlabel() == "time (periods)"
    assert axes.get_ylabel() == "largest relative energy error |ΔE/E|"


def test_guides_rise_as_their_powers(study):
    axes = plot_energy_error(study)
    guides = [line for line in axes.lines if line not in curves(axes)]
    slopes = []
    for line in guides:
        (x0, x1), (y0, y1) = line.get_xdata(), line.get_ydata()
        slopes.append(np.log(y1 / y0) / np.log(x1 / x0))
    assert slopes == pytest.approx([0.0, 0.5, 1.0], abs=1e-12)
    assert len(plot_energy_error(study, guides=False).lines) == len(study.rows)


def test_guides_leave_the_right_half_of_a_picture_to_the_names(study):
    axes = plot_energy_error(study)
    left, right = np.log(axes.get_xlim())
    for line in (line for line in axes.lines if line not in curves(axes)):
        start, end = (np.log(line.get_xdata()) - left) / (right - left)
        assert 0.0 < start < end < 0.5


def test_names_at_the_line_ends_keep_apart(study):
    axes = plot_energy_error(study)
    axes.figure.canvas.draw()
    named = [text for text in axes.texts if ":" in text.get_text()]
    assert sorted(text.get_text().split(":")[0] for text in named) == sorted(
        str(r.method) for r in study.rows
    )
    boxes = sorted((text.get_window_extent() for text in named), key=lambda box: box.y0)
    for lower, upper in pairwise(boxes):
        assert lower.y1 <= upper.y0 + 1.0


def test_it_draws_where_it_is_told(study, tmp_path):
    figure = Figure()
    mine = figure.add_subplot()
    assert plot_energy_error(study, mine) is mine
    plot_energy_error(study).figure.savefig(tmp_path / "error.png")
    assert (tmp_path / "error.png").stat().st_size > 10_000


def test_trajectories_are_drawn_as_well():
    scene = find("henon-heiles")
    motions = [
        propagate(scene.hamiltonian, (0.0, 300.0), scene.state(), method=method, step=0.1)
        for method in (RK4(), Splitting("verlet"))
    ]
    assert len(curves(plot_energy_error(motions))) == 2
    assert len(curves(plot_energy_error(motions[0]))) == 1
    portrait = plot_phase_portrait(motions[0], degree=1)
    np.testing.assert_array_equal(portrait.lines[0].get_xdata(), motions[0].y[1])
    np.testing.assert_array_equal(portrait.lines[0].get_ydata(), motions[0].y[3])
    with pytest.raises(ValueError, match="0 … 1, not 2"):
        plot_phase_portrait(motions[0], degree=2)


def test_an_error_that_is_exactly_zero_is_no_line():
    scene = find("harmonic-oscillator")
    motion = propagate(
        scene.hamiltonian, (0.0, 300.0), [0.0, 0.0], method=RK4(), step=0.1, parameters=scene.values
    )
    assert curves(plot_energy_error(motion)) == []


def test_window_means_and_the_fitted_line():
    t = np.linspace(0.0, 1000.0, 4001)
    found = drift(t, 1e-8 * t / 1000.0 + 1e-9 * np.sin(7.7 * t))
    axes = plot_block_means(found, unit="s")
    line, means = axes.lines
    power = float(axes.get_ylabel().split("of ")[1])
    np.testing.assert_allclose(means.get_ydata() * power, found.blocks.mean)
    rise = (line.get_ydata()[-1] - line.get_ydata()[0]) / (line.get_xdata()[-1] - line.get_xdata()[0])
    assert rise * power == pytest.approx(found.slope)
    (band,) = axes.collections
    assert to_hex(band.get_facecolor()[0]) == to_hex(line.get_color()) != to_hex(means.get_color())
    assert axes.get_xlabel() == "time (s)"
    assert axes.get_title(loc="left").startswith("secular")


def test_a_missing_matplotlib_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    monkeypatch.delitem(sys.modules, "canon.plot.notebook", raising=False)
    with pytest.raises(PlotError, match=r"pip install canon-mechanics\[plot\]"):
        plot_phase_portrait([])


def test_matplotlib_is_not_loaded_before_a_picture_is_asked_for():
    code = "import sys, canon.plot; assert not any(name.startswith('matplotlib') for name in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_integral_drifts_have_a_line_of_their_power():
    radii, order = (0.02, 0.04, 0.08), 4
    seen = IntegralDrift(radii, tuple(r**order for r in radii), order, 4.0, (True, True, True))
    lost = IntegralDrift(radii, (1e-17, 1e-16, 2e-16), 5, None, (False, False, True))
    axes = plot_integral_drift(seen, lost)
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [
        "order 3: slope 4.00",
        "order 4: drift below rounding",
    ]
    points, line, _, beside = axes.lines
    assert points.get_color() == line.get_color() != beside.get_color()
    np.testing.assert_allclose(line.get_ydata(), points.get_ydata(), rtol=1e-12)
    assert beside.get_ydata()[0] == pytest.approx(2e-16 * (0.02 / 0.08) ** 5)
