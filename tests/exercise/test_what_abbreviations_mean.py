"""What a name abbreviates is there before anything is done with it: ∂V/∂x is that of V's value, and u/u has none for 0.

Found by a lecturer's 3,762 claims: derivatives, integrals, moduli and quotients were worked out with the bare name.
"""

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from

SPRING = {
    "kind": "euler-lagrange",
    "q": ["x"],
    "L": "m*x_dot**2/2 - k*x**2/2",
    "parameters": {"m": "positive", "k": "positive"},
}
MOVING = {
    "kind": "hamilton-equations",
    "q": ["x"],
    "p": ["p"],
    "H": "p**2/(2*m) + k*x**2/2",
    "parameters": SPRING["parameters"],
    "q_dot": ["p/m"],
}
TURNING = {
    "kind": "constant-of-motion",
    "q": ["x"],
    "p": ["p"],
    "H": "p**2/2 + w**2*x**2/2",
    "parameters": {"w": "positive"},
}


def status(keys, **answer):
    return [judgement.status for judgement, _ in judgements(claim_from({"id": "a", **keys, **answer}))][-1]


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("m x'' = -∂V/∂x with V = k x^2/2", "m x'' = -k x - ∂V/∂x, V = k x^3/2"),
        ("m x'' = -diff(V,x), V = k x**2/2", "m x'' + k x = diff(V,x), V = x**3"),
        ("m x'' = -Derivative(V,x), V = k x**2/2", "m x'' + k x = Derivative(U,x), U = x**3"),
        ("m x'' = -∂/∂x V, V = k x^2/2", "m x'' + k x = ∂/∂x(V), V = x^3"),
        ("m x'' = -x ∂²U/∂x², U = k x^2/2", "m x'' + k x = ∂²U/∂x², U = x^5"),
        ("d/dt(∂T/∂x') = -k x, T = m x'^2/2", "m x'' + k x = ∂U/∂x', U = x'^5"),
        ("m x'' = -∂/∂x(k x u/2), u = x", "m x'' = -∂/∂x(k x u), u = x"),
        ("m x'' + k u = 1 - ∂u/∂x, u = x", "m x'' + k u = ∂u/∂x, u = x"),
        ("x' = v, v' = a, a = -∂U/∂x, U = k x^2/(2m)", "x' = v, v' = a, a = -∂U/∂x, U = k x^2/m"),
        ("u'' = -k u/m, u = x", "u'' = -2 k u/m, u = x"),
        ("m x'' + k x = Integral(u,(u,0,1)) - 1/2, u = x", "m x'' + k x = Integral(u,(u,0,1)), u = x"),
    ],
)
def test_equations_of_motion(right: str, wrong: str) -> None:
    assert status(SPRING, claim=[right]) == "holds"
    assert status(SPRING, claim=[wrong]) == "fails"


def test_an_integral_over_what_the_name_stands_for_is_asked_about() -> None:
    assert status(SPRING, claim=["m x'' + k x = Integral(u,(x,0,1)) - x, u = x"]) == "invalid"


def test_hamiltons_equations_and_expressions() -> None:
    assert status(MOVING, p_dot=["-∂V/∂x where V = k x^2/2"]) == "holds"
    assert status(MOVING, p_dot=["-k x + diff(W,x) where W = x^2"]) == "fails"
    square = {"kind": "equality-only", "lhs": "x**2", "parameters": {"x": "real"}}
    assert status(square, rhs="∂W/∂x, W = x^3/3") == "holds"
    assert status(square, rhs="y^2 + ∂y/∂x, y = x") == "fails"


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("|z|^2, z = p + i w x", "|z|^2, z = p + 2 i w x"),
        ("|z|^4, z = p + i w x", "z^2, z = p + i w x"),
        ("p^2 + w^2 x^2 + ∂W/∂x, W = 3x", "p^2 + w^2 x^2 + ∂W/∂x, W = x^2"),
    ],
)
def test_complex_values_are_complex_from_the_beginning(right: str, wrong: str) -> None:
    assert status(TURNING, I=right) == "holds"
    assert status(TURNING, I=wrong) == "fails"


@pytest.mark.parametrize(
    ("lhs", "right", "wrong"),
    [
        ("sqrt(-x**2)", "sqrt(u^2), u = I*x", "sqrt(u^2), u = x"),
        ("I*x", "u, u = I*x", "log(exp(u)), u = I*x"),
        ("x", "x u/u, u = x^2 + 1", "x u/u, u = sin(x)^2 + cos(x)^2 - 1"),
        ("x", "x (u - v)/(u - v), u = 2, v = 1", "x (u - v)/(u - v), u = sin(x)^2, v = 1 - cos(x)^2"),
        ("x", "x + u - u, u = log(x^2 + 1)", "x + u - u, u = log(sin(x)^2 + cos(x)^2 - 1)"),
    ],
)
def test_nothing_is_cancelled_before_its_value_is_known(lhs: str, right: str, wrong: str) -> None:
    keys = {"kind": "equality-only", "lhs": lhs, "parameters": {"x": "real"}}
    assert status(keys, rhs=right) == "holds"
    assert status(keys, rhs=wrong) == "fails"


@pytest.mark.parametrize("nothing", ["0", "x - x"])
def test_a_division_by_what_is_zero_is_told(nothing: str) -> None:
    keys = {"kind": "equality-only", "lhs": "x", "parameters": {"x": "real"}}
    assert status(keys, rhs=f"x u/u, u = {nothing}") == "invalid"
