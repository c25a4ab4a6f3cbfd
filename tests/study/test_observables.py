"""Observables: constants by name, symplecticity by variations, residuals; against closed forms and nearby orbits."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon import RK4, Gauss, Hamiltonian, Splitting, Taylor, coordinates, propagate
from canon.scene import find
from canon.study.energy_drift.drift import Growth
from canon.study.energy_drift.drift_study import drift_study
from canon.study.energy_drift.drift_table import drift_table
from canon.study.errors import StudyError
from canon.study.motion.observables import observables_of, tangent_of


def test_known_constants_have_names():
    kepler = find("kepler")
    study = drift_study(
        kepler, methods=[Splitting("verlet"), RK4()], observables=["energy", "integrals"], periods=50.0
    )
    assert study.observables == ("energy", "angular momentum", "Runge–Lenz vector, x", "Runge–Lenz vector, y")
    verlet, runge_kutta = (row.drift for row in study.only("angular momentum").rows)
    assert verlet.bound < 1e-14
    assert runge_kutta.bound > 1e-3
    energy = drift_study(kepler, methods=[Splitting("verlet")], periods=50.0).rows[0]
    np.testing.assert_array_equal(study.rows[0].error, energy.error)


def test_momenta_of_ignorable_coordinates_are_found():
    scene = find("spherical-pendulum")
    found = observables_of(scene, scene.hamiltonian, ["momenta"], scene.state(), scene.values)
    assert [each.name for each in found] == ["p_phi"]
    henon = find("henon-heiles")
    with pytest.raises(StudyError, match="no momentum is constant"):
        observables_of(henon, henon.hamiltonian, ["momenta"], henon.state(), henon.values)


def test_what_is_no_constant_is_seen_to_drift_or_swing():
    kepler = find("kepler")
    x, y = kepler.q
    wrong = {"wrong": x * y.momentum - y * x.momentum + x * y / 100}
    row = drift_study(kepler, methods=[Taylor()], observables=wrong, periods=50.0).rows[0]
    assert row.drift.bound > 1e-4


def test_an_error_is_relative_to_the_terms_where_the_quantity_vanishes():
    """The total momentum of the figure eight is zero but for rounding; its terms are of size one."""
    eight = find("figure-eight")
    for each in observables_of(eight, eight.hamiltonian, ["integrals"], eight.state(), eight.values):
        assert 0.5 < each.unit < 5.0


def test_the_residual_of_a_constraint_is_an_observable():
    """A bead kept on a circle by a stiff spring leaves it by the spring's stretch, ∝ 1/k."""
    x, y = coordinates("x y")
    (k,) = sp.symbols("k,", positive=True)
    residual = sp.sqrt(x**2 + y**2) - 1
    H = (x.momentum**2 + y.momentum**2) / 2 + k * residual**2 / 2
    bead = Hamiltonian(H, [x, y], [x.momentum, y.momentum])
    stretch = [
        drift_study(
            bead,
            [1.0, 0.0, 0.0, 1.0],
            methods=[Taylor()],
            span=200.0,
            samples=4096,
            parameters={"k": stiffness},
            observables={"residual": residual},
        ).rows[0]
        for stiffness in (1e3, 4e3)
    ]
    assert stretch[0].drift.bound / stretch[1].drift.bound == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize(
    ("name", "method"), [("henon-heiles", Splitting("verlet")), ("double-pendulum", Gauss(2))]
)
def test_symplectic_methods_keep_the_bilinear_covariant_and_runge_kutta_does_not(name, method):
    study = drift_study(find(name), methods=[method, RK4()], observables=["symplecticity"], periods=100.0)
    symplectic, runge_kutta = (row.drift for row in study.rows)
    assert symplectic.bound < 1e-10
    assert runge_kutta.bound > 1e-6


def test_the_variation_is_the_difference_of_nearby_orbits():
    """A second route: two orbits 2e-6 apart, by the same method with the same steps."""
    scene, span, size = find("henon-heiles"), 20.0, 1e-6
    tangent = tangent_of(scene.hamiltonian, scene.state())
    how = {"method": Splitting("kahan-li-6"), "step": 0.1, "samples": 1}
    varied = propagate(tangent.hamiltonian, (0.0, span), tangent.y0, **how).final
    n = 2
    aside = np.array([size] * n + [0.0] * n)
    ends = [
        propagate(scene.hamiltonian, (0.0, span), scene.state() + s * aside, **how).final for s in (-1.0, 1.0)
    ]
    difference = (ends[1] - ends[0]) / (2.0 * size)
    np.testing.assert_allclose(varied[n : 2 * n], difference[:n], rtol=1e-6)
    np.testing.assert_allclose(varied[4 * n : 5 * n], difference[n:], rtol=1e-6)


def test_orbits_are_judged_one_by_one():
    scene = find("henon-heiles")
    study = drift_study(scene, methods=[Splitting("kahan-li-8"), RK4()], periods=200.0, orbits=6)
    for row in study.rows:
        assert len(row.orbits) == 6
        assert row.drift in row.orbits
    assert all(each.verdict is Growth.SECULAR for each in study.rows[1].orbits)
    assert "orbits: 6 secular" in drift_table(study)
    alone = drift_study(scene, methods=[RK4()], periods=200.0).rows[0].drift
    assert study.rows[1].orbits[0].slope == pytest.approx(alone.slope, rel=1e-6)


def test_long_runs_are_followed_inside_the_loop(monkeypatch):
    """The verdict and the slope are those of samples; the bound misses nothing between them."""
    scene, method = find("henon-heiles"), RK4()
    sampled = drift_study(scene, methods=[method], periods=1000.0).rows[0].drift
    monkeypatch.setattr("canon.study.energy_drift.drift_study.MOST_SAMPLES", 8192)
    followed = drift_study(scene, methods=[method], periods=1000.0).rows[0].drift
    assert followed.verdict is sampled.verdict is Growth.SECULAR
    assert followed.slope == pytest.approx(sampled.slope, rel=1e-3)
    assert followed.bound == pytest.approx(sampled.bound, rel=0.02)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"observables": ["enregy"]}, "did you mean energy"),
        ({"observables": []}, "name at least one"),
        ({"observables": {"f": sp.Symbol("unknown")}}, "'f' holds unknown"),
        ({"orbits": 0}, "run at least one"),
        ({"orbits": 2, "scatter": 0.0}, "scatter of 0.0 makes no sense"),
    ],
)
def test_requests_that_make_no_sense(options, told):
    with pytest.raises(StudyError, match=told):
        drift_study(find("kepler"), methods=[RK4()], periods=10.0, **options)
