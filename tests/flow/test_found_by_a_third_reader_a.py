"""What a third reading of fixed steps, events and time transformations found, each beside what must go on working."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon import (
    Event,
    Gauss,
    Hamiltonian,
    Lagrangian,
    TimeTransformed,
    coordinates,
    parameters,
    propagate,
    time,
)
from canon.flow import GalerkinVariational, NonFiniteStateError, poincare_section

x, y = coordinates("x y")
p, px, py = x.momentum, x.momentum, y.momentum
m, g, mu, a = parameters("m g mu a", positive=True)
r = sp.sqrt(x**2 + y**2)
falling = Hamiltonian(p**2 / 2 + x, [x], [p])
kepler = Hamiltonian((px**2 + py**2) / 2 - mu / r, [x, y], [px, py])
VERLET = {"method": "verlet", "step": 0.01}


def test_between_its_samples_a_galerkin_method_has_the_mass_of_that_time():
    drive = {"L": Lagrangian(x.dot**2 / 2 * (1 + sp.sin(time) / 3) - x**2 / 2, [x]), "t0": 1}
    still = {"L": Lagrangian(x.dot**2 / 2 - x**2 / 2, [x]), "t0": 0}
    for each in (drive, still):
        span = (each["t0"], each["t0"] + 2)
        few, every = (
            propagate(each["L"], span, [1, 0], samples=n, method=GalerkinVariational(3), step=0.05)
            for n in (2, 40)
        )
        assert abs(few(every.t) - every.y).max() < 1e-14


@pytest.mark.parametrize("precision", ["double", "extended"])
@pytest.mark.parametrize("falls", [0, 22, 150, 199])
def test_the_orbit_that_is_lost_is_named(precision, falls):
    start = np.array([[1.0] * 200, [0.0] * 200, [0.0] * 200, [1.0] * 200])
    start[2, falls], start[3, falls] = -2.0, 0.0
    how = {"method": "verlet", "step": 1.0, "samples": 2, "precision": precision, "parameters": {mu: 1}}
    with pytest.raises(
        NonFiniteStateError, match=f"of orbit {falls}, after t = 0 where .* = \\(1, 0, -2, 0\\)"
    ):
        propagate(kepler, (0, 4), start, **how)
    with pytest.raises(NonFiniteStateError, match="in step 1, after t = 0"):  # one orbit has no number
        propagate(kepler, (0, 4), start[:, falls], **how)


def test_after_an_impact_the_other_events_of_that_step_are_met():
    events = [Event(x, -1, {p: -p / 2}, "floor"), Event(p, -1, "record", "top")]
    met = [
        propagate(falling, (0, 4.2), [1, 0], method="verlet", step=h, events=events).events
        for h in (0.1, 0.01)
    ]
    assert [str(each.event) for each in met[0]] == ["floor", "top"] * 6 + ["floor"]
    assert np.allclose([each.t for each in met[0]], [each.t for each in met[1]], rtol=0, atol=1e-12)


def test_an_impact_itself_is_no_crossing_of_the_momentum():
    events = [Event(x, -1, "bounce"), Event(p, 1, "record", "rises"), Event(p, -1, "record", "top")]
    met = propagate(falling, (0, 6), [0.5, 0], events=events, **VERLET).events
    assert [str(each.event) for each in met] == ["x = 0", "top"] * 2 + ["x = 0"] + ["top"] * (len(met) - 5)
    assert np.allclose([each.t for each in met[:5]], [1, 2, 3, 4, 5])


def test_bodies_whose_masses_differ_by_orbit_bounce():
    heavy = Hamiltonian(p**2 / (2 * m) + m * g * x, [x], [p])
    wall = [Event(x, -1, "bounce")]
    met = propagate(heavy, (0, 3), [1, 0], parameters={m: [1, 2], g: 10}, events=wall, **VERLET).events
    for each in met:
        assert np.allclose([hit.t for hit in each], np.sqrt(0.2) * np.array([1, 3, 5]))
    quartic = Hamiltonian(p**4 / m + m * x, [x], [p])
    with pytest.raises(ValueError, match="H is not quadratic"):
        propagate(quartic, (0, 3), [1, 0], parameters={m: [1, 2]}, events=wall, **VERLET)


def test_walls_may_stand_elsewhere_for_each_orbit():
    placed = Hamiltonian(p**2 / 2 + x + a, [x], [p])
    run = propagate(
        placed, (0, 3), [1, 0], parameters={a: [0.25, 0.5]}, events=[Event(x - a, -1, "bounce")], **VERLET
    )
    assert np.allclose([each[0].t for each in run.events], np.sqrt([1.5, 1.0]))
    assert abs(run.energy_error).max() < 1e-14
    with pytest.raises(ValueError, match="is no wall"):
        propagate(
            placed,
            (0, 3),
            [1, 0],
            parameters={a: [0.2, 0.5]},
            events=[Event(a - time, 0, "bounce")],
            **VERLET,
        )


def test_a_time_transformation_may_hold_parameters_of_its_own():
    def final(clock, **values):
        method = TimeTransformed(Gauss(4), g=clock)
        return propagate(kepler, (0, 5), [1, 0, 0, 1.1], method=method, step=0.01, parameters=values).final

    plain = final(r, mu=1)
    assert np.allclose(final(sp.sqrt(r**2 + a**2), mu=1, a=0.1), plain, rtol=0, atol=1e-11)
    assert np.allclose(final(r * (2 + sp.sin(sp.Symbol("t"))), mu=1), plain, rtol=0, atol=1e-11)
    with pytest.raises(KeyError, match="no parameter a"):
        final(r, mu=1, a=0.1)
    with pytest.raises(KeyError, match="holds a"):
        final(sp.sqrt(r**2 + a**2), mu=1)


@pytest.mark.parametrize("wrong", ["r", [1]])
def test_g_of_a_time_transformation_is_an_expression(wrong):
    with pytest.raises(TypeError, match="g of TimeTransformed should be an expression"):
        TimeTransformed(Gauss(4), g=wrong)


def test_an_orbit_that_has_its_points_may_be_lost_after():
    escaping = Hamiltonian(p**2 / 2 - x**4, [x], [p])
    starts = np.array([[0.5, 0.01], [1.0, 0.01]])
    how = {"method": "verlet", "step": 0.01}
    both = poincare_section(escaping, (0, 60), starts, x - 1, points=1, **how)
    for k in range(2):
        alone = poincare_section(escaping, (0, 60), starts[:, k], x - 1, points=1, **how)
        assert both.t[both.orbit == k] == alone.t
    with pytest.raises(NonFiniteStateError, match="of orbit 1"):
        poincare_section(escaping, (0, 3), starts[:, ::-1], x - 1, points=2, **how)
