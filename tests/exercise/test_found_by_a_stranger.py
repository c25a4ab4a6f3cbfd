"""What a stranger met who typed as people do: each with the twin that must not pass."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon import CanonicalTransformation, Hamiltonian, Lagrangian, coordinates, propagate
from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from
from canon.mechanics import ConstrainedLagrangian, VectorField

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
    with pytest.raises(TypeError, match=r"y0 is 1: .* a state of one variable is a list of one number"):
        propagate(lambda t, z: -z, (0, 1), 1)
    L = Lagrangian(x.dot**2 / 2 - x**2, [x])
    for system in (L, lambda t, z: -z):
        with pytest.raises(TypeError, match="give numbers by name"):
            propagate(system, (0, 1), [1, 0], parameters=[1, 1])
    with pytest.raises(TypeError, match="those of a function go into it"):
        propagate(lambda t, z: -z, (0, 1), [1], args=(0.3,))


def test_functions_in_another_order_are_told() -> None:
    def odeint(z: object, t: object) -> object:
        return [z[1], -z[0]]

    with pytest.raises(TypeError, match=r"f\(z, t\) has the order of SciPy's odeint"):
        propagate(odeint, (0, 1), [1, 0])
    with pytest.raises(TypeError, match="put values of k in"):
        propagate(lambda t, z, k: -k * z, (0, 1), [1])
    assert abs(propagate(lambda t, z, k=2: -k * z, (0, 1), [1], samples=2).y[0, -1] - np.exp(-2.0)) < 1e-14
    assert abs(propagate(lambda time, t: -t, (0, 1), [1], samples=2).y[0, -1] - np.exp(-1.0)) < 1e-14


@pytest.mark.parametrize("pairs", [[(x, y), (y, -x)], {x: y, y: -x}])
def test_pairs_of_sympy_are_told_where_they_go(pairs: object) -> None:
    with pytest.raises(TypeError, match=r"write canon.VectorField\(rates, variables\)"):
        propagate(pairs, (0, 1), [1, 0])


ROUTH = {
    "kind": "routhian", "q": ["r", "phi"], "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 - k*r**2/2", "cyclic": ["phi"],
    "momenta": ["l"], "convention": "pq-L", "parameters": {"m": "positive", "k": "positive"},
}  # fmt: skip
NEW_H = {
    "kind": "transformed-hamiltonian-K", "q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "H": "p**2/2",
}  # fmt: skip
FREE = {
    "kind": "constant-of-motion", "q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2", "parameters": {"m": "positive"},
}  # fmt: skip


@pytest.mark.parametrize(
    ("asked", "key", "right", "wrong"),
    [
        (ROUTH, "R", "R = lφ̇ - L = l²/(2mr²) + k r²/2 - m ṙ²/2", "R = -L = l²/(2mr²) + k r²/2 - m ṙ²/2"),
        (ROUTH, "R", "lφ̇ - L = l²/(2mr²) + k r²/2 - m ṙ²/2", "L - lφ̇ = l²/(2mr²) + k r²/2 - m ṙ²/2"),
        ({**NEW_H, "map": {"Q": ["p"], "P": ["-q"]}}, "K", "K = H = Q²/2", "K = -H = Q²/2"),
        ({**NEW_H, "inverse_map": {"q": ["-P"], "p": ["Q"]}}, "K", "K = H = Q²/2", "K = 2H = Q²/2"),
        (FREE, "I", "E = L = m(ẋ² + ẏ²)/2", "E = 2L = m(ẋ² + ẏ²)/2"),
        (FREE, "I", "L_z = m(x ẏ - y ẋ)", "L_z = m(x ẏ + y ẋ)"),
        (FREE, "I", "I = L_z = m(xẏ - yẋ) = const.", "I = L_z = mxẏ = const."),
        (FREE, "I", r"$m\dot x = \text{const}$", r"$mx = \text{const}$"),
    ],
)  # fmt: skip
def test_functions_in_chains_are_worked_out(
    asked: dict[str, object], key: str, right: str, wrong: str
) -> None:
    assert judged(**asked, **{key: right}).status == "holds"
    assert judged(**asked, **{key: wrong}).status == "fails"


@pytest.mark.parametrize("said", ["x = m*x_dot", "L_z' = m*x_dot", "dE/dt = 0"])
def test_a_constant_has_a_name_that_is_free(said: str) -> None:
    assert "I is asked for here" in judged(**FREE, I=said).known


@pytest.mark.parametrize(
    ("value", "unit", "right", "wrong"),
    [
        ("9.81", "m/s^2", "9.81 ms⁻²", "9.81 ms²"),
        ("9.81", "m/s^2", r"$\SI{9.81}{\metre\per\second\squared}$", r"$\SI{9.81}{\metre\per\second}$"),
        ("9.81", "m/s^2", r"$\qty{9.81}{m.s^{-2}}$", r"$\qty{9.81}{m.s^{2}}$"),
        ("3", "kHz", "3 ms⁻¹", "3 ms"),
        ("3", "m/s", "3 ms⁻¹", "3 ms"),
        ("3", "J", "3 Nm", "3 nm"),
        ("3", "J", "3 kgm²/s²", "3 kgm/s²"),
        ("3600", "kJ", "1 kWh", "1 kW"),
        ("2", "s", "2 seconds", "2 minutes"),
        ("2", "s", r"$2\,\rm{s}$", r"$2\,\rm{h}$"),
        ("2", "s", r"$T = 2~s$", r"$T = 2~ms$"),
        ("2", "s", r"$\SI{2000}{\milli\second}$", r"$\SI{2}{\milli\second}$"),
        ("pi", "rad", "180 degrees", "90 degrees"),
        ("pi", "rad", "1/2 turn", "2 turns"),
    ],
)
def test_units_as_they_are_typed(value: str, unit: str, right: str, wrong: str) -> None:
    asked = {"kind": "number", "value": value, "unit": unit}
    assert judged(**asked, claim=right).status == "holds"
    assert judged(**asked, claim=wrong).status == "fails"


@pytest.mark.parametrize("word", ["Non-holonomic", "non holonomic", "anholonomic"])
def test_classes_by_other_spellings(word: str) -> None:
    asked = {"kind": "constraint-class", "q": ["x", "y", "z"]}
    assert (
        judged(**asked, constraints=["x_dot - z*y_dot"], **{"class": [word, "scleronomous"]}).status
        == "holds"
    )
    assert judged(**asked, constraints=["x_dot - y*y_dot"], **{"class": [word]}).status == "fails"


def test_a_part_of_lagranges_equation_is_no_equation_of_motion() -> None:
    found = judged(kind="euler-lagrange", q=["x"], L="x_dot**2/2 - x**2/2", claim=["∂L/∂x = -x"])
    assert "no equation of motion" in found.known


@pytest.mark.parametrize("constraint", ["0", "x - x", "a", "a - 1"])
def test_what_constrains_nothing_is_refused(constraint: str) -> None:
    found = judged(
        kind="multiplier-holonomic", q=["x", "y"], L="x_dot**2/2 + y_dot**2/2", constraints=[constraint, "x - y"],
        multipliers=["lam", "mu"], claim=["x_ddot"], parameters={"a": "real"},
    )  # fmt: skip
    assert found.status == "invalid"
    assert "constrains no coordinate" in found.known


def test_numbers_are_no_constraints() -> None:
    free = Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y])
    with pytest.raises(ValueError, match="the constraint 0 = 0 is true anyway"):
        ConstrainedLagrangian(free, [x - x])
    with pytest.raises(ValueError, match="the constraint -2 = 0 is never true"):
        ConstrainedLagrangian(free, [sp.Integer(-2)])
    with pytest.raises(ValueError, match="the constraint 2 = 0 is never true"):
        ConstrainedLagrangian(free, [], [sp.Integer(2)])
    assert ConstrainedLagrangian(free, [x - y], [x.dot]).nonholonomic == (x.dot,)


def test_a_hamiltonian_holds_no_velocities() -> None:
    with pytest.raises(ValueError, match=r"H holds x_dot, .* write it in p_x"):
        Hamiltonian(x.dot**2 / 2, [x], [x.momentum])
    assert Hamiltonian(x.momentum**2 / 2, [x], [x.momentum]).q_dot == (x.momentum,)
