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
from canon.scene.known_truths import check
from canon.scene.parts import Start
from canon.scene.scene_motion import first_zero, run
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


# values that scenes take -----------------------------------------------------------------------------


@pytest.mark.parametrize("value", [None, "abc", 10**400, math.nan])
def test_what_is_no_number_is_refused_by_the_name_of_its_parameter(value: Any) -> None:
    with pytest.raises(SceneError, match=r"mu = .* finite number"):
        find("kepler").with_parameters(mu=value)


@pytest.mark.parametrize(
    ("name", "wrong", "right"),
    [
        ("crossed-fields", {"e": 0.0}, {"e": 1.6e-19}),
        ("stormer", {"e": 0.0}, {"e": -1.6e-19}),
        ("outer-solar-system", {"m0": 0.4}, {"m0": 0.9}),
        ("outer-solar-system", {"G": 1e-4}, {"G": 3e-4}),
        ("foucault-pendulum", {"latitude": -3.0}, {"latitude": -1.5}),
        ("kovalevskaya-top", {"C": 0.8e-4}, {"C": 1e-4}),  # 2 m l² = 0.9e-4
        ("kovalevskaya-top", {"m": 0.2, "l": 0.03}, {"m": 0.2, "l": 0.02}),
        ("lagrange-top", {"A": 1.65e-4, "C": 3.2e-4}, {"A": 1.65e-4, "C": 0.09e-4}),  # A − m l² = 0.05e-4
    ],
)
def test_what_no_body_or_orbit_has_is_refused(
    name: str, wrong: dict[str, float], right: dict[str, float]
) -> None:
    with pytest.raises(SceneError, match="makes no sense"):
        find(name).with_parameters(**wrong)
    assert 0.0 < find(name).with_parameters(**right).period < math.inf


def test_the_top_of_kovalevskaya_is_a_body() -> None:
    value = find("kovalevskaya-top").values
    off = value["m"] * value["l"] ** 2  # about the centre of mass, which lies on the first axis
    A, B, C = 2.0 * value["C"], 2.0 * value["C"] - off, value["C"] - off
    assert A < B + C


@pytest.mark.parametrize(
    ("name", "unknown", "known"),
    [
        ("driven-oscillator", {"k": 9.0, "c": 0.0}, {"k": 9.0, "c": 0.1}),  # m W² = 9
        ("driven-oscillator", {"k": 9.0, "c": 0.0}, {"k": 9.1, "c": 0.0}),
        ("block-in-pipe", {"c": 20.0}, {"c": 0.1}),
        ("parametric-pendulum", {"a": 0.005}, {"a": 0.021}),
        ("parametric-pendulum", {"a": 0.0}, {"a": 0.021}),
    ],
)
def test_closed_forms_are_passed_over_where_they_are_none(
    name: str, unknown: dict[str, float], known: dict[str, float]
) -> None:
    def forms(values: dict[str, float]) -> list[Any]:
        scene = find(name).with_parameters(**values)
        return [s.value(scene.values, np.ones(1)) for s in scene.solutions if s.condition.met(scene.values)]

    assert forms(unknown) == []
    assert np.isfinite(forms(known)).all()


@pytest.mark.parametrize(
    ("scene", "start", "changed"),
    [
        ("outer-solar-system", "1994", {"m1": 0.002}),
        ("orbit-spherical", "ellipse", {"mu": 80.0}),
        ("restricted-three-body", "tadpole", {"mu": 0.3}),
    ],
)
def test_words_about_a_start_say_what_they_were_made_for(
    scene: str, start: str, changed: dict[str, float]
) -> None:
    (name,) = changed
    assert f"made for {name} = " in find(scene).with_parameters(**changed).start(start).about
    assert "made for" not in find(scene).start(start).about


def test_the_period_on_the_critical_wire_is_a_turn_of_it() -> None:
    wire = find("bead-parabola")
    critical = wire.with_parameters(w=math.sqrt(2.0 * wire.values["g"]))
    assert critical.period == pytest.approx(2.0 * math.pi / critical.values["w"])
    assert wire.period == pytest.approx(2.0 * math.pi / math.sqrt(2.0 * wire.values["g"] - 9.0))


def test_the_energy_of_the_sleigh_is_its_energy() -> None:
    sleigh = find("chaplygin-sleigh")
    (energy,) = sleigh.constants().values()
    at = {**sleigh.values_by_symbol(), sleigh.symbols.theta: 0.3}
    speed = {sleigh.symbols.x.dot: math.cos(0.3), sleigh.symbols.y.dot: math.sin(0.3)}
    slow = {sleigh.symbols.theta.dot: 0.0}
    straight = energy.xreplace({key: Float(value) for key, value in {**at, **speed, **slow}.items()})
    assert float(straight) == pytest.approx(sleigh.values["m"] / 2.0)


# runs -------------------------------------------------------------------------------------------------


def test_runs_of_no_length_and_without_states_are_refused() -> None:
    scene = find("harmonic-oscillator")
    for periods in (math.inf, 0.0, -1.0, math.nan):
        with pytest.raises(SceneError, match="positive, finite"):
            run(scene, periods=periods)
        with pytest.raises(SceneError, match="positive, finite"):
            first_zero(scene, None, scene.q[0], periods)
    for samples in (0, -3):
        with pytest.raises(SceneError, match="one state after the first"):
            run(scene, periods=1, samples=samples)
    with pytest.raises(SceneError, match="positive, finite"):
        check(scene, periods=0)
    assert run(scene, periods=1, samples=1).t.shape == (2,)
    assert all(each.passed for each in check(scene, periods=0.5))


@pytest.mark.parametrize("given", [{"p": (2.0,)}, {"v": (2.0,)}])
def test_a_start_with_another_number_of_coordinates_is_refused(given: dict[str, Any]) -> None:
    with pytest.raises(SceneError, match="one number for each of x y"):
        find("kepler").state(Start("short", "", q=(1.0,), **given))
    assert find("kepler").state(Start("whole", "", q=(1.0, 0.0), p=(0.0, 1.0))).shape == (4,)


@pytest.mark.parametrize("part", [1.0, 2.0**-60])
def test_constraints_are_held_in_slow_units_too(part: float) -> None:
    """With g so small the period is 2e9 s, and 12/period is no multiple of a millionth."""
    scene = find("pendulum-multiplier")
    motion = run(scene.with_parameters(g=part * scene.values["g"]), periods=300.0, samples=50)
    length = motion.values(motion.equation.residuals)[0]
    assert np.abs(length).max() < 1e-14
