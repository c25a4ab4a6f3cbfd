"""What a stranger met who typed as people do: each with the twin that must not pass."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon import CanonicalTransformation, Lagrangian, coordinates, propagate
from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from
from canon.mechanics import VectorField

x, y = coordinates("x y")


def judged(**keys: object):
    claim = claim_from({"id": "a", **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


@pytest.mark.parametrize(
    ("value", "unit", "right", "wrong"),
    [
        ("1", "Hz", "60 rpm", "61 rpm"),
        ("1", "Hz", "1 rev/s", "6.283 rev/s"),
        ("1", "Hz", "1 s^-1", "2 s^-1"),
        ("60", "rpm", "1 Hz", "6.283 Hz"),
        ("2*pi", "rad/s", "60 rpm", "1 rpm"),
        ("2*pi", "rad/s", "360 deg/s", "57.3 deg/s"),
        ("1", "kHz", "60000 rpm", "60 rpm"),
    ],
)
def test_a_hertz_is_a_turn_a_second(value: str, unit: str, right: str, wrong: str) -> None:
    asked = {"kind": "number", "value": value, "unit": unit}
    assert judged(**asked, claim=right).status == "holds"
    assert judged(**asked, claim=wrong).status == "fails"


@pytest.mark.parametrize(
    ("value", "unit", "claim"),
    [("1", "Hz", "1 rad/s"), ("1", "Hz", "360 deg/s"), ("2*pi", "rad/s", "6.283 Hz")],
)
def test_hertz_and_angles_by_the_second_are_asked_about(value: str, unit: str, claim: str) -> None:
    found = judged(kind="number", value=value, unit=unit, claim=claim)
    assert found.status == "invalid"
    assert f"write it in {unit}" in found.known


@pytest.mark.parametrize("lhs", [r"$\sin x y$", r"$\ln x y$", r"$\arctan x y$", r"$\sin\frac{x}{2}y$"])
def test_a_factor_after_a_function_is_asked_about(lhs: str) -> None:
    found = judged(kind="equality-only", lhs=lhs, rhs="x", parameters={"x": "positive", "y": "positive"})
    assert found.status == "invalid"
    assert "does this factor still belong to the argument" in found.known


@pytest.mark.parametrize(
    ("lhs", "rhs", "wrong"),
    [
        (r"$\sin k x$", "sin(k*x)", "sin(k)*x"),
        (r"$\cos\omega t$", "cos(omega*t)", "cos(omega)*t"),
        (r"$\sin xy$", "sin(x*y)", "sin(x)*y"),
    ],
)
def test_arguments_that_begin_with_what_counts_waves_go_on(lhs: str, rhs: str, wrong: str) -> None:
    names = {"parameters": dict.fromkeys(("x", "y", "k", "omega"), "positive")}
    assert judged(kind="equality-only", lhs=lhs, rhs=rhs, **names).status == "holds"
    assert judged(kind="equality-only", lhs=lhs, rhs=wrong, **names).status == "fails"


def test_a_rotation_by_a_is_not_taken_for_a_wave() -> None:
    found = judged(
        kind="canonicity", q=["q"], p=["p"], parameters={"a": "real"},
        Q=[r"$\cos a q - \sin a p$"], P=[r"$\sin a q + \cos a p$"],
    )  # fmt: skip
    assert found.status == "invalid"


def test_forces_by_coordinate_are_those_of_these_coordinates() -> None:
    g = sp.Symbol("g", positive=True)
    by_name = Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y], forces={y: -g, x: -x.dot})
    in_order = Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y], forces=[-x.dot, -g])
    assert by_name == in_order
    assert Lagrangian(x.dot**2 / 2 + y.dot**2 / 2, [x, y], forces={y: -g}).forces == (0, -g)
    with pytest.raises(ValueError, match="forces are given for y; the coordinates are x"):
        Lagrangian(x.dot**2 / 2, [x], forces={y: 1})


def test_what_has_no_order_is_no_list() -> None:
    with pytest.raises(TypeError, match="members of a set have no order"):
        Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y], forces={-x.dot, -2 * y.dot})
    with pytest.raises(TypeError, match="keys of a dictionary have no order"):
        VectorField({x: y, y: -x}, [x, y])
    with pytest.raises(TypeError, match="keys of a dictionary have no order"):
        CanonicalTransformation([x], [x.momentum], {y: x}, {y.momentum: x.momentum})


@pytest.mark.parametrize("mass", [np.int64(2), np.int32(2), np.array(2), np.array(2.0), np.float32(2)])
def test_numbers_of_numpy_are_numbers(mass: object) -> None:
    m = sp.Symbol("m", positive=True)
    L = Lagrangian(m * x.dot**2 / 2 - x**2, [x])
    found = propagate(L, np.array([0, 3]), [1, 0], parameters={m: mass}, samples=3)
    assert abs(found["x"][-1] - np.cos(3.0)) < 1e-13
    with pytest.raises(ValueError, match="is no finite real number"):
        propagate(L, (0, 3), [1, 0], parameters={m: np.bool_(1)})


def test_starts_and_parameters_of_the_wrong_kind_are_told() -> None:
    with pytest.raises(ValueError, match=r"give the start as a list, y0 = \[1\]"):
        propagate(lambda t, z: -z, (0, 1), 1)
    L = Lagrangian(x.dot**2 / 2 - x**2, [x])
    for system in (L, lambda t, z: -z):
        with pytest.raises(TypeError, match="give numbers by name"):
            propagate(system, (0, 1), [1, 0], parameters=[1, 1])
    with pytest.raises(TypeError, match="those of a function go into it"):
        propagate(lambda t, z: -z, (0, 1), [1], args=(0.3,))
