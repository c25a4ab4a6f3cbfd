"""Pictures of studies, steps, ensembles and sections: what is drawn is what was found, and nothing is hidden."""

from __future__ import annotations

import base64
import json
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.patches import Rectangle

import canon
from canon import RK4, Gauss, Splitting, Taylor, propagate
from canon.flow import megno, poincare_section, starts_of_energy
from canon.flow.run.event import Event
from canon.plot import (
    COLOURS,
    plot_block_means,
    plot_chaos_map,
    plot_drift_by_step,
    plot_energy_error,
    plot_ensemble_fan,
    plot_poincare_section,
    plot_section,
    plot_study_heatmap,
    plot_work_precision,
    study_page,
)
from canon.plot.study_page import study_report
from canon.scene import find
from canon.study.cases.case import Case, key_of
from canon.study.cases.result import State, results_of
from canon.study.cases.run_study import run_study
from canon.study.cases.store import Store
from canon.study.cases.study import Study
from canon.study.energy_drift.drift_study import drift_study
from canon.study.method_choice.candidate import Candidate
from canon.study.method_choice.choose import Choice, choose
from canon.study.method_choice.resonance import resonant_steps
from canon.study.method_choice.slow_times import Outlook
from canon.study.method_choice.work_precision import WorkPrecision, WorkRow, work_precision


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Six finished cases of one motion, two that failed, one pending of which a half is done."""
    store = Store(tmp_path_factory.mktemp("study") / "study.sqlite")
    methods = [Splitting("verlet"), RK4()]
    common = {"step": [0.05, 0.1, 0.2], "span": 400.0, "samples": 512}
    run_study(Study.of(system="henon-heiles", method=methods, **common), store)
    run_study(Study.of(system="double-pendulum", method="verlet", step=[0.1, 0.2], span=50.0), store)
    later = Case("kepler", RK4(), span=50.0, step=0.05, parts=4)
    store.add_cases({key_of(later): json.dumps(later.to_dict())})
    store.save_checkpoint(key_of(later), 2, "…")
    return results_of(store)


def test_the_heatmap_has_every_case_and_shows_what_is_missing(results):
    axes = plot_study_heatmap(results)
    (image,) = axes.images
    values = np.ma.filled(image.get_array(), np.nan)
    rows = [label.get_text() for label in axes.get_yticklabels()]
    columns = [label.get_text() for label in axes.get_xticklabels()]
    for result in results:
        value = values[rows.index(result.motion), columns.index(result.setting)]
        if result.state is State.FINISHED:
            assert value == result.numbers["bound"]
        else:
            assert np.isnan(value)
    assert np.isfinite(values).sum() == 6
    boxes = [patch for patch in axes.patches if isinstance(patch, Rectangle)]
    assert sum(bool(box.get_hatch()) for box in boxes) == 2
    assert sorted(text.get_text() for text in axes.texts) == ["50 %", "✕", "✕"]
    assert axes.get_title(loc="left") == "9 cases: 6 finished, 2 failed, 1 pending"


def test_the_heatmap_of_other_numbers_and_of_nothing(results):
    for what, label in (("slope", "drift"), ("seconds", "processor time")):
        axes = plot_study_heatmap(results, what=what)
        assert label in axes.figure.axes[1].get_ylabel()
    pending = [result for result in results if result.state is not State.FINISHED]
    assert not plot_study_heatmap(pending).images
    with pytest.raises(ValueError, match="no case"):
        plot_study_heatmap([])
    with pytest.raises(ValueError, match="there are bound, slope, seconds"):
        plot_study_heatmap(results, what="colour")


def test_errors_and_means_of_a_study_are_those_of_its_cases(results):
    axes = plot_energy_error(results)
    drawn = [line for line in axes.lines if line.get_color() in COLOURS]
    assert len(drawn) == 6
    for line, result in zip(drawn, results, strict=False):
        assert line.get_ydata().tolist() == result.numbers["curve"]["largest"]
    means = plot_block_means(results[3])
    assert len(means.lines[1].get_xdata()) == len(results[3].numbers["means"]["t"])
    with pytest.raises(ValueError, match="is failed: there are no means"):
        plot_block_means(results[6])


def test_drift_by_step_tells_drifts_from_limits(results):
    axes = plot_drift_by_step(results, what="slope")
    lines = {line.get_label(): line for line in axes.lines if not line.get_label().startswith("_")}
    assert set(lines) == {"verlet", "RK4"}
    assert lines["RK4"].get_xdata().tolist() == [0.05, 0.1, 0.2]
    by_method = {name: [r.numbers for r in results[:6] if str(r.case.method) == name] for name in lines}
    slopes = [abs(numbers["slope"]) for numbers in by_method["RK4"]]
    assert lines["RK4"].get_ydata().tolist() == slopes
    limits = [numbers["detection_limit"] for numbers in by_method["verlet"]]
    (below,) = (line for line in axes.lines if line.get_marker() == "v")
    assert below.get_ydata().tolist() == limits
    assert "no drift found" in axes.get_title(loc="left")
    rising = plot_drift_by_step(results).lines[0]
    order = np.polyfit(np.log(rising.get_xdata()), np.log(rising.get_ydata()), 1)[0]
    assert order == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize(("times", "resonant"), [(9.0, False), (11.0, True), (1 / 11.0, False)])
def test_a_resonant_step_errs_ten_times_as_much_as_its_neighbours_let_expect(times, resonant):
    h = np.array([0.1, 0.2, 0.4])
    assert resonant_steps(h, h**4 * [1.0, times, 1.0]).tolist() == [False, resonant, False]


def test_resonant_steps_are_ringed():
    h = np.geomspace(0.05, 0.4, 9)
    error = 1e-3 * h**4
    error[4] *= 50.0
    assert resonant_steps(h, error).tolist() == [k == 4 for k in range(9)]
    assert not resonant_steps(h, 1e-3 * h**4).any()
    assert resonant_steps(h[::-1], error[::-1])[4]
    error[5] = 0.0
    assert not resonant_steps(h, error).any()
    rows = tuple(
        WorkRow(RK4(), x, None, energy_error=1e-3 * x**4 * (50.0 if k == 4 else 1.0)) for k, x in enumerate(h)
    )
    axes = plot_drift_by_step(WorkPrecision("", 1.0, rows))
    (ring,) = (line for line in axes.lines if line.get_markerfacecolor() == "none")
    assert ring.get_xdata().tolist() == [h[4]]
    with pytest.raises(ValueError, match="there are bound and, of drift studies, slope"):
        plot_drift_by_step(WorkPrecision("", 1.0, rows), what="slope")


def test_rows_of_drift_studies_are_drawn_by_step():
    scene = find("henon-heiles")
    rows = [
        drift_study(scene, methods=[RK4()], step=step, span=300.0, samples=400).rows[0] for step in (0.1, 0.2)
    ]
    (line,) = plot_drift_by_step(rows).lines
    assert line.get_ydata().tolist() == [row.drift.bound for row in rows]


def test_the_chosen_point_lies_where_it_was_predicted():
    scene = find("henon-heiles")
    found = work_precision(
        scene, 30.0, methods=[Splitting("kahan-li-8"), Gauss(4)], steps=[0.4, 0.2, 0.1], repetitions=1
    )
    chosen = choose(scene, 60.0, accuracy=1e-8)
    axes = plot_work_precision(found, error="energy", chosen=chosen)
    (star,) = (line for line in axes.lines if line.get_marker() == "*")
    assert star.get_ydata().tolist() == [chosen.predicted_error]
    assert star.get_xdata()[0] == pytest.approx(chosen.predicted_cost / 2.0)
    assert star.get_label().startswith(f"chosen: {chosen.method}")
    with pytest.raises(ValueError, match="keeps the error of the energy"):
        plot_work_precision(found, error="position", chosen=chosen)


@pytest.mark.parametrize(
    ("method", "step", "told"),
    [(RK4(), 0.05, f"chosen: {RK4()}, h = 0.05"), (Taylor(), None, f"chosen: {Taylor()}")],
)
def test_the_star_tells_the_step_that_was_chosen(method: RK4 | Taylor, step: float | None, told: str) -> None:
    best = Candidate(method, step, None, "double", 1e-9, 0.5, 400.0, keeps=True, seen=10.0)
    chosen = Choice("", 10.0, 1e-8, "energy", best, (best,), None, Outlook(10.0))
    axes = plot_work_precision(WorkPrecision("", 10.0, ()), error="energy", chosen=chosen)
    (star,) = (line for line in axes.lines if line.get_marker() == "*")
    assert star.get_label() == told


def test_the_fan_holds_the_orbits():
    scene = find("henon-heiles")
    orbits = np.tile(scene.state("regular")[:, None], (1, 16))
    orbits[1] += 0.01 * np.arange(16)
    motion = propagate(
        scene.hamiltonian, (0, 100.0), orbits, method=Splitting("verlet"), step=0.1, samples=500
    )
    axes = plot_ensemble_fan(motion)
    largest = np.abs(motion.energy_error).max()
    assert axes.collections[0].get_datalim(axes.transData).y1 == pytest.approx(largest)
    (median,) = axes.lines
    assert median.get_xdata()[-1] == pytest.approx(100.0)
    last = np.abs(motion.energy_error[motion.t > median.get_xdata()[-2]]).max(axis=0)
    assert median.get_ydata()[-1] == pytest.approx(np.median(last))
    one = propagate(scene.hamiltonian, (0, 10.0), orbits[:, 0], method=RK4(), step=0.1)
    with pytest.raises(ValueError, match="propagate four or more"):
        plot_ensemble_fan(one)


def test_a_section_is_drawn_over_its_reference():
    scene = find("henon-heiles")

    def met(method, step=None):
        crossing = Event(scene.q[0], 1)
        motion = propagate(
            scene.hamiltonian, (0, 200.0), scene.state("regular"), method=method, step=step, events=[crossing]
        )
        return motion.events

    crossings, reference = met(RK4(), 0.2), met(Taylor())
    axes = plot_poincare_section({"RK4": crossings}, reference=reference)
    below, above = axes.lines
    assert (below.get_label(), above.get_label()) == ("reference", "RK4")
    assert below.get_zorder() < above.get_zorder()
    assert above.get_xdata().tolist() == [each.y[1] for each in crossings]
    assert above.get_ydata().tolist() == [each.y[3] for each in crossings]
    states = np.array([each.y for each in crossings]).T
    same = plot_poincare_section({"RK4": states}).lines[0]
    assert same.get_xdata().tolist() == above.get_xdata().tolist()
    with pytest.raises(ValueError, match="RK4: no crossings to draw"):
        plot_poincare_section({"RK4": []})
    with pytest.raises(ValueError, match="0 … 1, not 2"):
        plot_poincare_section({"RK4": states}, degree=2)


def test_sections_and_maps_of_chaos_show_each_orbit_as_what_it_is():
    y = np.linspace(-0.3, 0.5, 6)
    across, up = (part.ravel() for part in np.meshgrid(y, [0.0, 0.1]))
    zero = np.zeros_like(across)
    starts = starts_of_energy(
        "henon-heiles", 0.125, np.array([zero, across, zero, up]), "p_x", inside_only=True
    )
    how = {"method": "kahan-li-8", "step": 0.2}
    section = poincare_section("henon-heiles", (0, 200), starts, "x", points=20, **how)
    found = megno("henon-heiles", (0, 3000), starts, **how)
    axes = plot_section(section, "y", "p_y", verdicts=found.verdict)
    shown = {each.get_label(): len(each.get_offsets()) for each in axes.collections}
    assert shown == {kind: 20 * sum(v.value == kind for v in found.verdict) for kind in shown}
    assert len(shown) == 2
    assert len(plot_section(section, "y", "p_y").collections[0].get_offsets()) == len(section.t)
    picture = plot_chaos_map(found, starts[1], starts[3]).collections[0]
    values = picture.get_array()
    for k, value in enumerate(found.value):
        place = (
            int(np.argmin(abs(np.array([0.0, 0.1]) - starts[3, k]))),
            int(np.argmin(abs(y - starts[1, k]))),
        )
        assert values[place] == value
    assert values.mask.sum() == 12 - starts.shape[1]
    with pytest.raises(ValueError, match=r"verdicts of shape \(2,\): one for each of"):
        plot_section(section, "y", "p_y", verdicts=found.verdict[:2])
    with pytest.raises(ValueError, match="places of shape"):
        plot_chaos_map(found, starts[1, :3], starts[3])


def test_the_report_holds_everything_and_needs_nothing(results):
    page = study_report(results, "a <study> & more")
    assert "<h1>a &lt;study&gt; &amp; more</h1>" in page
    assert page.count("<tr class=") == len(results)
    assert "does not split into drifts and kicks" in page
    assert "50 % done" in page
    assert f"8 cases computed with canon {canon.__version__}, heyoka" in page
    images = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', page)
    assert len(images) == page.count("<img") == 6
    for image in images:
        assert ElementTree.fromstring(base64.b64decode(image)).tag.endswith("svg")
    assert "http" not in re.sub(r'src="[^"]+"', "", page.replace("http-equiv", ""))
    assert "<script" not in page


def test_a_figure_of_the_report_has_as_many_lines_as_are_told_apart(results, monkeypatch):
    drawn = []

    def noted(some):
        drawn.append([result.case for result in some])
        return plot_energy_error(some)

    monkeypatch.setattr(study_page, "LINES", ("-", "--", "-.", ":"))
    monkeypatch.setattr(study_page, "plot_energy_error", noted)
    monkeypatch.setattr(study_page, "_figure", lambda axes, about: about)
    finished = [result for result in results if result.state is State.FINISHED]
    assert len(list(study_page._figures(finished, "a motion"))) >= 2
    assert [len(cases) for cases in drawn] == [4, 2]
    assert [case for cases in drawn for case in cases] == [result.case for result in finished]


def test_a_row_says_how_far_a_case_is_or_why_it_failed(results):
    told = [study_page._cells(result)[0] for result in results if result.state is not State.FINISHED]
    assert told.count("pending: 50 % done") == 1
    failed = [words for words in told if words.startswith("failed: ")]
    assert len(failed) == len(told) - 1 == 2
    assert all("does not split into drifts and kicks" in words for words in failed)


def test_what_a_stranger_called_his_system_is_text_in_the_report(tmp_path):
    from canon.study.motion.hamiltonian_text import Formula

    evil = Formula(
        "<img src=x onerror=alert(1)>", "p**2/2 + q**2/2", ("q",), ("p",), starts=(("s", (1.0, 0.0)),)
    )
    store = Store(tmp_path / "evil.sqlite")
    run_study(Study.of(system=evil, method="verlet", step=0.1, span=50.0), store)
    page = study_report(results_of(store), "</title><script>")
    assert "<script" not in page
    assert "<img src=x" not in page
