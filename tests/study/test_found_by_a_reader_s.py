"""What a careful reader of studies found: rounding at the start, cases of one name, words for what can't be done."""

import json
import math
from dataclasses import asdict

import numpy as np
import pytest
import sympy as sp

from canon import (
    RK4,
    Hamiltonian,
    Lagrangian,
    Splitting,
    Study,
    Taylor,
    choose,
    coordinates,
    parameters,
    propagate,
    results_of,
    run_study,
    work_precision,
)
from canon.expression.symbols.symbol import time
from canon.plot.case_labels import error_symbol, labels_of
from canon.study import drift
from canon.study.cases.case import Case
from canon.study.cases.checkpointed_run import Checkpoint, advance
from canon.study.cases.export import dataset_of
from canon.study.errors import StudyError
from canon.study.motion.term_sizes import TermSizes

x, y = coordinates("x y")
px, py = x.momentum, y.momentum
m = parameters("m", positive=True)
DOUBLES = ("double", "compensated")
HORIZONTAL = [math.pi / 2, 0.0]
PENDULUM = Hamiltonian(px**2 / 2 - sp.cos(x), [x], [px])
OSCILLATOR = Hamiltonian(px**2 / 2 + x**2 / 2, [x], [px])
KEPLER = Hamiltonian((px**2 + py**2) / 2 - 1 / sp.sqrt(x**2 + y**2), [x, y], [px, py])
FROM_ZERO = Hamiltonian(px**2 / (2 * m) + m * (x**4 / 4 - sp.Rational(1, 4)), [x], [px])


def ran(tmp_path, **axes):
    run_study(Study.of(**axes), tmp_path / "study.sqlite")
    return results_of(tmp_path / "study.sqlite")


# --- what is rounding at the start ---------------------------------------------------------------------------------


def test_a_study_of_a_pendulum_released_from_the_horizontal(tmp_path):
    low, high = [1.5, 0.0], HORIZONTAL
    how = {"method": ["verlet", "taylor"], "step": 0.01, "periods": 20, "samples": 1000}
    found = ran(tmp_path, system="simple-pendulum", start=[low, high], **how)
    assert [r.numbers["verdict"] for r in found] == ["bounded", "round-off"] * 2
    assert [r.numbers["relative"] for r in found] == [True, True, False, False]


def test_a_study_of_a_parabola(tmp_path):
    how = {"method": "taylor", "span": 50.0, "samples": 1000}
    (found,) = ran(tmp_path, system=KEPLER, start=[[1.0, 0.0, 0.0, math.sqrt(2.0)]], **how)
    assert found.numbers["verdict"] == "round-off"
    assert not found.numbers["relative"]
    assert found.numbers["bound"] < 1e-13


def test_the_verdict_of_a_study_does_not_hang_on_the_unit(tmp_path):
    units = {"m": [1e-20, 1.0, 1e20]}
    how = {"step": 0.2, "span": 1000.0, "samples": 2000, "parameters": units}
    found = ran(tmp_path, system=FROM_ZERO, start=[[1.0, 0.0]], method=["rk4", "verlet"], **how)
    assert {r.numbers["verdict"] for r in found.where(method="rk4")} == {"secular"}
    assert {r.numbers["verdict"] for r in found.where(method="verlet")} == {"bounded"}


def test_nor_does_that_of_many_motions_with_parameters_of_their_own():
    starts, units = np.array([[1.0] * 3, [0.0] * 3]), {m: np.array([1e-20, 1.0, 1e20])}
    for method, verdict in ((RK4(), "secular"), (Splitting("verlet"), "bounded")):
        how = {"method": method, "step": 0.2, "samples": 2000, "parameters": units}
        motion = propagate(FROM_ZERO, (0, 1000), starts, **how)
        assert [drift(motion, orbit=k).verdict.value for k in range(3)] == [verdict] * 3


@pytest.mark.parametrize("unit", [sp.Integer(10) ** -18, 1, sp.Integer(10) ** 18])
@pytest.mark.parametrize(("method", "verdict"), [(RK4(), "secular"), (Splitting("verlet"), "bounded")])
def test_nor_does_that_of_an_observable_that_begins_at_zero(unit, method, verdict):
    own = {"e": (px**2 / 2 + x**2 / 2 - sp.Rational(1, 2)) * unit}
    how = {"method": method, "step": 0.2, "samples": 2048, "observables": own}
    motion = propagate(OSCILLATOR, (0, 300), [1.0, 0.0], **how)
    assert drift(motion, observable="e").verdict.value == verdict


def test_an_observable_that_is_rounding_at_the_start():
    how = {"method": Splitting("verlet"), "step": 0.05, "samples": 2000, "observables": {"E": PENDULUM.H}}
    motion = propagate(PENDULUM, (0, 300), HORIZONTAL, **how)
    named, plain = drift(motion, observable="E"), drift(motion)
    assert (named.verdict.value, named.bound) == (plain.verdict.value, plain.bound)
    assert named.verdict.value == "bounded"
    other = propagate(PENDULUM, (0, 300), [1.0, 0.0], **how)  # a value of its own: relative to it
    assert drift(other, observable="E").bound == pytest.approx(drift(other).bound)


def test_a_square_root_has_no_slope_at_zero():
    how = {"method": Taylor(), "samples": 300, "observables": {"s": sp.sqrt(x**2 + px**2) + sp.sqrt(y**2)}}
    plane = Hamiltonian((px**2 + py**2 + x**2 + y**2) / 2, [x, y], [px, py])
    motion = propagate(plane, (0, 20), [1.0, 0.0, 0.0, 0.0], **how)
    assert drift(motion, observable="s").bound < 1e-13


def test_choose_is_not_relative_to_rounding():
    asked = {"accuracy": 1e-6, "methods": [Splitting("kahan-li-8")]}
    near, at = (choose("simple-pendulum", 100.0, [a, 0.0], **asked) for a in (1.5, math.pi / 2))
    assert at.precision in DOUBLES  # which of them is a matter of what the clock says
    assert at.step == pytest.approx(near.step, rel=0.3)


def test_choose_by_an_integral_that_is_rounding_at_the_start():
    asked = {
        "accuracy": 1e-6,
        "methods": [Splitting("kahan-li-8")],
        "observable": "E",
        "integral": PENDULUM.H,
    }
    found = choose(PENDULUM, 100.0, HORIZONTAL, **asked)
    assert found.precision in DOUBLES
    assert found.step > 0.1


def test_studies_know_the_rounding_of_an_energy_that_is_small_beside_its_terms(tmp_path):
    how = {"method": "taylor", "span": 1000.0, "samples": 1000}
    (found,) = ran(tmp_path, system=KEPLER, start=[[1.0, 0.0, 0.0, 1.4142]], **how)
    assert found.numbers["verdict"] == "round-off"
    wrong = KEPLER.H + sp.Rational(1, 10**8) * x  # no energy: its change is none of rounding
    how = {"observables": [{"wrong": str(wrong)}], "parts": 4, **how}
    (tmp_path / "wrong").mkdir()
    (found,) = ran(tmp_path / "wrong", system=KEPLER, start=[[1.0, 0.0, 0.0, 1.4142]], **how)
    assert found.numbers["observables"]["wrong"]["verdict"] != "round-off"


def test_sizes_of_terms_in_any_unit():
    found = TermSizes().with_part(np.array([3e200, 4e200])).with_part(np.array([0.0]))
    assert found.mean == pytest.approx(1.75e200)
    assert found.square == pytest.approx(math.sqrt(12.5 / 2) * 1e200)


def test_a_checkpoint_of_before_is_read_and_goes_on():
    case = Case("henon-heiles", RK4(), span=400.0, step=0.1, samples=600, parts=3)
    first = advance(case, seconds=0.0)
    old = {name: value for name, value in asdict(first).items() if name not in ("relative", "terms")}
    read = Checkpoint.from_text(json.dumps(old))
    assert read.is_relative
    assert not read.terms
    assert not Checkpoint.from_text(json.dumps({**old, "energy": 0.0})).is_relative
    assert Checkpoint.from_text(first.to_text()) == first
    assert advance(case, read).numbers["verdict"] == advance(case).numbers["verdict"] == "secular"


def test_work_precision_of_a_driven_hamiltonian():
    driven = Hamiltonian(px**2 / 2 + x**2 / 2 - x * sp.cos(2 * time), [x], [px])
    for system, known in (
        (driven, False),
        (OSCILLATOR, True),
        (Lagrangian(x.dot**2 / 2 + x * sp.cos(time), [x]), True),
    ):
        rows = work_precision(
            system, 10.0, [1.0, 0.0], methods=[RK4()], steps=[0.1, 0.05], repetitions=1
        ).rows
        assert [row.failure for row in rows] == ["", ""]
        assert rows[0].position_error < 1e-5
        assert math.isfinite(rows[0].energy_error) is known


# --- cases of one name ---------------------------------------------------------------------------------------------


def two_systems(tmp_path):
    quartic = Hamiltonian(px**2 / 2 + x**4 / 4, [x], [px])
    how = {"method": "verlet", "step": [0.1, 0.100001], "span": 100.0, "samples": 1000}
    return ran(tmp_path, system=[OSCILLATOR, quartic, OSCILLATOR], start=[[1.0, 0], [1.0000001, 0]], **how)


def test_every_case_has_a_cell_of_its_own(tmp_path):
    from canon.plot import plot_drift_by_step, plot_study_heatmap
    from canon.plot.study_page import study_report

    found = two_systems(tmp_path)
    assert len(found) == 8  # the same system given twice is one
    assert np.ma.count(plot_study_heatmap(found).images[0].get_array()) == 8
    assert len(found.where(system="Hamiltonian")) == len(found.where(system="Hamiltonian 2")) == 4
    assert len(plot_drift_by_step(found).lines) == 4
    assert len(plot_drift_by_step(found[:2]).lines) == 1
    assert study_report(found, "two").count("<h2>Hamiltonian") == 4


def test_labels_have_no_more_digits_than_they_need(tmp_path):
    motions, settings = labels_of(two_systems(tmp_path))
    assert set(settings) == {"verlet, h = 0.1", "verlet, h = 0.100001"}
    assert motions[0] == "Hamiltonian; from 1, 0"
    assert motions[2] == "Hamiltonian; from 1.0000001, 0"
    how = {"method": "verlet", "step": 0.1, "samples": 1000, "start": [[1.0, 0]], "system": OSCILLATOR}
    longer = ran(tmp_path, span=200.0, **how)
    assert len(set(zip(*labels_of(longer), strict=True))) == 9
    assert labels_of(longer)[1][-1] == "verlet, h = 0.1 (2)"


def test_two_lagrangians_have_two_names():
    springs = [Lagrangian(x.dot**2 / 2 - k * x**2 / 2, [x]) for k in (1, 2)]
    study = Study.of(system=springs, start=[[1.0, 0.0]], method="taylor", span=100.0)
    assert [case.system_name for case in study.cases] == ["Lagrangian", "Lagrangian 2"]


def test_errors_that_are_absolute_are_not_called_relative(tmp_path):
    from canon.plot import plot_study_heatmap
    from canon.plot.study_page import study_report

    how = {"method": "verlet", "step": 0.1, "span": 100.0, "samples": 1000}
    found = ran(tmp_path, system=OSCILLATOR, start=[[1.0, 0.0]], **how)
    assert error_symbol(found) == "ΔE/E"
    (tmp_path / "zero").mkdir()
    from_zero = ran(tmp_path / "zero", system=FROM_ZERO, parameters={"m": 1.0}, start=[[1.0, 0.0]], **how)
    assert error_symbol(from_zero) == "ΔE"
    axes = plot_study_heatmap(from_zero)
    assert axes.figure.axes[-1].get_ylabel() == "largest |ΔE|"
    assert "max |ΔE|" in study_report(from_zero, "zero")


def test_columns_of_like_names_are_all_in_a_dataset(tmp_path):
    how = {"method": "verlet", "step": 0.05, "span": 100.0, "samples": 1000}
    named = [{"L-z": "x*p_y - y*p_x", "L z": "p_x**2"}]
    found = ran(tmp_path, system=KEPLER, start=[[1.0, 0, 0, 1.0]], observables=named, **how)
    of, data = found[0].numbers["observables"], dataset_of(found)
    assert float(data["L_z_bound"][0]) == of["L-z"]["bound"]
    assert float(data["L_z_bound_2"][0]) == of["L z"]["bound"]
    assert "bound_2" not in data


# --- names and numbers that can't be -------------------------------------------------------------------------------


def test_systems_with_greek_names(tmp_path):
    theta, mu = coordinates("θ"), parameters("μ")
    swing = Hamiltonian(theta.momentum**2 / 2 - mu * sp.cos(theta), [theta], [theta.momentum])
    how = {"method": "verlet", "step": 0.1, "span": 100.0, "samples": 1000, "keep": {"section": "θ"}}
    same = [{"e": "p_θ**2/2 - μ*cos(θ)", "spelled": "p_theta**2/2 - mu*cos(theta)"}]
    (found,) = ran(tmp_path, system=swing, start=[[1.0, 0.0]], parameters={"μ": 2.0}, observables=same, **how)
    assert found.numbers["verdict"] == "bounded"
    of = found.numbers["observables"]
    assert of["e"]["bound"] == of["spelled"]["bound"] == pytest.approx(found.numbers["bound"])
    with pytest.raises(StudyError, match="nu is not declared"):
        Study.of(system=swing, start=[[1.0, 0.0]], parameters={"μ": 2.0}, observables=[{"e": "ν"}], **how)


def test_an_orbit_that_the_motion_has_not():
    how = {"method": Splitting("verlet"), "step": 0.1, "samples": 300}
    many = propagate(OSCILLATOR, (0, 50), np.array([[1.0, 1.1], [0.0, 0.0]]), **how)
    one = propagate(OSCILLATOR, (0, 50), [1.1, 0.0], **how)
    for motion, orbit in ((many, 5), (many, -1), (one, 5)):
        with pytest.raises(ValueError, match=f"orbit={orbit}: the motion has .* orbit"):
            drift(motion, orbit=orbit)
    assert drift(many, orbit=1).bound == drift(one, orbit=0).bound == drift(one).bound
    for motion, orbits in ((many, [7]), (many, []), (one, [1])):
        with pytest.raises(ValueError, match=r"orbits=\[.*\]: the motion has"):
            motion.error_estimate(orbits=orbits)
    assert many.error_estimate(orbits=[1]).relative[-1, 0] == one.error_estimate().relative[-1]
