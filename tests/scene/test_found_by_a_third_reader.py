"""Starts, parameters and formulas of scenes: what a careful reader found wrong, with its right neighbours."""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from sympy import Float

from canon import propagate
from canon.flow import prepare
from canon.scene import SCENES, SceneError, find
from canon.study.cases.study import Study
from canon.study.errors import StudyError
from canon.study.kept.keep_choice import chosen_functions

STEPS = {"method": "verlet", "step": 0.05, "samples": 4}


# momenta of a start by velocities ------------------------------------------------------------------


def test_a_named_start_has_the_momenta_of_the_parameters_that_are_given() -> None:
    heavy = propagate(find("simple-pendulum").with_parameters(m=3.0), (0, 2), "rotating", **STEPS)
    assert heavy.y[:, 0].tolist() == [0.0, 21.0]  # m l² θ̇
    by_name = propagate("simple-pendulum", (0, 2), "rotating", parameters={"m": 3.0}, **STEPS)
    made_ready = prepare("simple-pendulum", (0, 2), parameters={"m": 3.0}, **STEPS).propagate("rotating")
    assert np.array_equal(by_name.y, heavy.y)
    assert np.array_equal(made_ready.y, heavy.y)


def test_parameters_by_orbit_make_one_start_each() -> None:
    masses = np.array([1.0, 3.0])
    both = propagate("simple-pendulum", (0, 2), "rotating", parameters={"m": masses}, **STEPS)
    for k, m in enumerate(masses):
        alone = propagate("simple-pendulum", (0, 2), "rotating", parameters={"m": m}, **STEPS)
        assert both.y[1, 0, k] == 7.0 * m
        assert both.y[..., k] == pytest.approx(alone.y, rel=1e-12, abs=1e-12)


def test_parameters_by_orbit_of_different_lengths_are_refused() -> None:
    lengths = {"m": np.ones(2), "l": np.ones(3)}
    with pytest.raises(ValueError, match=r"shape \(orbits,\)"):
        find("simple-pendulum").state("rotating", lengths)


def test_starts_by_momenta_and_those_at_rest_stay_what_they_are() -> None:
    kepler = find("kepler")
    assert kepler.start().p is not None
    assert kepler.state(None, {"mu": 2.0}).tolist() == kepler.state().tolist()
    assert find("simple-pendulum").state("wide", {"m": np.ones(3)}).shape == (2,)


def test_a_parameter_called_self_is_unknown_like_any_other() -> None:
    with pytest.raises(SceneError, match="no parameter 'self'"):
        find("kepler").with_parameters(self=2.0)
    assert find("kepler").with_parameters(mu=2).values["mu"] == 2.0


# angles ---------------------------------------------------------------------------------------------


def _at(scene: Any, q: np.ndarray[Any, Any]) -> float:
    """Return H or L, the forces and the constraints, as one number, at places q and speeds of no special value."""
    s = SimpleNamespace(**vars(scene.symbols))
    builds = [scene.H_of or scene.L_of or (lambda s: scene.lagrangian.L)]
    found = [build(s) for build in builds]
    for many in (scene.forces_of, scene.holonomic_of, scene.nonholonomic_of):
        found += many(s) if many else []
    values = {getattr(s, name): Float(1.137 * x) for name, x in scene.values.items()}
    values |= {x: Float(place, 40) for x, place in zip(scene.q, q, strict=True)}
    values |= {x.dot: Float(0.7 + 0.1 * k) for k, x in enumerate(scene.q)}
    values |= {x.momentum: Float(0.3 + 0.2 * k) for k, x in enumerate(scene.q)} | {s.t: Float(0.4)}
    return sum(3**k * float(f.xreplace(values)) for k, f in enumerate(found))


@pytest.mark.parametrize("scene", [x for x in SCENES if x.angles], ids=lambda x: x.name)
def test_a_whole_turn_of_an_angle_changes_nothing_at_any_values_of_the_parameters(scene: Any) -> None:
    q = np.linspace(0.4, 1.1, len(scene.q))
    for name in scene.angles.split():
        turned = q + 2.0 * math.pi * np.array([x.name == name for x in scene.q])
        assert _at(scene, turned) == pytest.approx(_at(scene, q), rel=1e-9), name


def test_the_place_in_two_waves_is_no_angle() -> None:
    waves = find("two-waves")
    assert not waves.angles
    assert _at(waves, np.array([0.4 + 2.0 * math.pi])) != pytest.approx(_at(waves, np.array([0.4])), rel=1e-4)


# digests of kept functions ---------------------------------------------------------------------------


def _with_default(window: Any) -> Any:
    def first(motion: Any, window: Any = window) -> Any:
        return motion["x"][window]

    return first


def _enclosing(window: Any) -> Any:
    def first(motion: Any) -> Any:
        return motion["x"][window]

    return first


def _digest(function: Any) -> str:
    ((_, text),) = chosen_functions({"first": function})
    return text


PAIRS: list[tuple[Any, Any]] = [
    ((0, 10), (10, 20)),
    ([1], [2]),
    ([1], (1,)),
    ((None, 1), (None, 2)),
    ({"a": 1}, {"a": 2}),
    ({1, 2}, {1, 3}),
    (np.arange(3), np.arange(4)),
    (5, 6),
]


@pytest.mark.parametrize("make", [_with_default, _enclosing])
@pytest.mark.parametrize(("one", "other"), PAIRS)
def test_a_function_with_other_numbers_is_another_function(make: Any, one: Any, other: Any) -> None:
    assert _digest(make(one)) != _digest(make(other))
    assert _digest(make(one)) == _digest(make(one))


def test_defaults_that_cannot_be_told_apart_are_refused() -> None:
    for default in (object(), functools.partial(len), [object()]):
        with pytest.raises(TypeError, match="can't be told from another one"):
            _digest(_with_default(default))
    assert _digest(_with_default(np.mean)) != _digest(_with_default(np.std))
    assert _digest(_enclosing(object()))


# changed scenes in studies ---------------------------------------------------------------------------


def _no_gravity(s: SimpleNamespace) -> Any:
    return s.m * s.l**2 * s.theta.dot**2 / 2


def test_a_scene_of_ones_own_is_not_taken_for_the_one_of_its_name() -> None:
    pendulum, rest = find("simple-pendulum"), {"method": "rk4", "step": 0.1, "span": 10.0}
    far = replace(pendulum.starts[0], q=(2.5,))
    for name, changed in (
        ("L_of", replace(pendulum, L_of=_no_gravity, solutions=())),
        ("starts", replace(pendulum, starts=(far, *pendulum.starts[1:]))),
    ):
        with pytest.raises(StudyError, match=f"{name} differ.*system=scene.hamiltonian"):
            Study.of(system=changed, **rest)
    free = Study.of(
        system=replace(pendulum, L_of=_no_gravity).hamiltonian,
        start=[[1.0, 0.0]], parameters={"m": 1.0, "l": 1.0}, **rest,
    )  # fmt: skip
    assert len(free.cases) == 1


def test_the_scene_itself_is_one_of_a_study() -> None:
    rest = {"method": "rk4", "step": 0.1, "span": 10.0}
    by_name = Study.of(system="lagrange-top", **rest).cases
    top = find("lagrange-top")
    assert Study.of(system=top, **rest).cases == by_name
    there_and_back = top.with_parameters(m=0.11).with_parameters(m=top.values["m"])
    assert Study.of(system=there_and_back, **rest).cases == by_name
    with pytest.raises(StudyError, match="as parameters, not inside the scene"):
        Study.of(system=top.with_parameters(m=0.11), **rest)
