"""Functions f(t, y) as systems: what SciPy integrates moves by the same formulas, or the error says what to write."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from scipy import special
from scipy.integrate import solve_ivp

from canon import VectorField, choose, propagate
from canon.flow import flow_jacobian
from canon.mechanics import field_of_function

if TYPE_CHECKING:
    from collections.abc import Callable

A = np.array([[0.0, 1.0], [-1.0, -0.1]])


def driven_pendulum(t, y):
    return [y[1], -9.81 * np.sin(y[0]) - 0.3 * y[1] + np.cos(2 * t)]


def filled(t, y):
    rates = np.zeros_like(y)
    rates[0], rates[1] = y[1], -y[0] + np.exp(-t)
    return rates


def lorenz(t, y, a=10, b=28, c=8 / 3):
    u, v, w = y
    return a * (v - u), u * (b - w) - v, u * v - c * w


FUNCTIONS: dict[str, tuple[Callable[..., Any], list[float]]] = {
    "a list": (driven_pendulum, [0.5, 0.0]),
    "an array filled": (filled, [0.5, 0.0]),
    "a matrix": (lambda t, y: A @ y, [0.5, 0.1]),
    "unpacked, with parameters": (lorenz, [1.0, 1.0, 1.0]),
    "planes": (lambda t, y: np.concatenate([y[2:], -y[:2] / np.linalg.norm(y[:2]) ** 3]), [1.0, 0.0, 0.0, 1.1]),
    "all of NumPy's": (
        lambda t, y: [
            np.arctan2(y[1], 2.0 + y[0] ** 2) - np.log1p(y[0] ** 2) + np.tanh(t),
            np.hypot(y[0], 1.0) - np.abs(y[1]) ** 3 + np.float64(0.5) * np.sqrt(1 + y[1] ** 2) - 2 ** y[1],
        ],
        [0.3, 0.2],
    ),
    "one": (lambda t, y: -y + np.sinh(t) / 7, [0.1]),
}  # fmt: skip


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_moves_as_it_does_in_scipy(name: str) -> None:
    f, start = FUNCTIONS[name]
    motion = propagate(f, (0, 2), start, samples=4)
    reference = solve_ivp(f, (0, 2), start, method="DOP853", rtol=1e-12, atol=1e-13, t_eval=motion.t)
    np.testing.assert_allclose(motion.y, reference.y, rtol=1e-9, atol=1e-10)


def test_every_method_for_any_system_applies() -> None:
    f, start = FUNCTIONS["a list"]
    true = propagate(f, (0, 2), start, precision="quad", samples=1).final
    for method, step, bound in (("DOP853", None, 1e-11), ("RK4", 1 / 64, 1e-5), ("gauss-6", 1 / 16, 1e-9)):
        assert abs(propagate(f, (0, 2), start, method=method, step=step).final - true).max() < bound
    assert propagate(f, (0, 2), start).error_estimate().relative.max() < 1e-13
    many = propagate(f, (0, 2), np.array([start, [0.1, 0.2]]).T, samples=1)
    np.testing.assert_allclose(many.y[:, -1, 0], true, rtol=1e-13)
    assert [*motion_names(f, start)] == ["y_0", "y_1"]


def motion_names(f: Callable[..., Any], start: list[float]) -> list[str]:
    return propagate(f, (0, 1), start, samples=1).record.names


@given(
    st.lists(st.floats(-4, 4).filter(lambda x: x == 0 or abs(x) > 1e-3), min_size=4, max_size=4),
    st.integers(1, 4),
)
def test_numbers_are_those_that_were_written(numbers: list[float], power: int) -> None:
    a, b, c, d = numbers
    field = field_of_function(lambda t, y: [a * y[1] + b * y[0] ** power, c - y[0] * d * t], 2)
    (y0, y1), t = field.x, sp.Symbol("t", real=True)
    exact = [sp.Rational(x) for x in numbers]
    assert sp.expand(field.components[0] - exact[0] * y1 - exact[1] * y0**power) == 0
    assert sp.expand(field.components[1] - exact[2] + exact[3] * y0 * t) == 0


REFUSED: dict[str, tuple[Callable[..., Any], str]] = {
    "an index": (lambda t, y: [y[1], [1, 2][int(y[0])]], "asks for the number of something that moves"),
    "a long table": (lambda t, y: [y[1], np.interp(y[0], range(99), range(99))], "more than 60 places"),
    "Bessel's function": (lambda t, y: [y[1], special.jv(1, y[0])], "jv of something that moves"),
    "odeint's order": (lambda y, t: [y[1], -y[0]], "has the order of SciPy's odeint"),
    "further arguments": (lambda t, y, k: [y[1], -k * y[0]], "put values of k in"),
    "another for numbers": (
        lambda t, y: [y[1], -y[0] if isinstance(y[0], float) else y[0]],
        r"at the start f\(t, y\) returns",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_is_no_formula_is_refused_with_what_to_write(what: str) -> None:
    f, told = REFUSED[what]
    with pytest.raises(TypeError, match=told) as caught:
        propagate(f, (0, 1), [1.0, 0.0])
    remedy = "lambda t, y: f(" if what in ("odeint's order", "further arguments") else "VectorField"
    assert remedy in str(caught.value)


COMPLEX: dict[str, tuple[Callable[..., Any], Any, str]] = {
    "a complex start": (
        lambda t, y: -y,
        [1j, 2.0],
        r"the start .* is complex \(\[1j, 2.0\]\): give real and imaginary",
    ),
    "an array of complex numbers": (lambda t, y: -y, np.array([1 + 2j]), "the start .* is complex"),
    "a text": (lambda t, y: -y, ["one"], "the start .* should be real numbers"),
    "a complex factor": (
        lambda t, y: [1j * y[0]],
        [1.0],
        "its rates are complex; give real and imaginary parts",
    ),
    "complex for numbers": (
        lambda t, y: [y[0] + (0j if isinstance(y[0], float) else 0)],
        [1.0],
        r"what f\(t, y\) returns at the start is complex",
    ),
    "a root of less than nothing": (lambda t, y: [np.sqrt(y[0])], [-1.0], "not finite at y0"),
    "an arcsine beyond one": (lambda t, y: [np.arcsin(y[0])], [2.0], "not finite at y0"),
    "a logarithm of nothing": (lambda t, y: [np.log(y[0])], [0.0], "not finite at y0"),
    "a quotient by nothing": (lambda t, y: [1 / y[0]], [0.0], "not finite at y0"),
}


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # NumPy's own, of what the function does
@pytest.mark.parametrize("what", COMPLEX)
def test_what_is_not_real_is_told_in_a_sentence(what: str) -> None:
    """No imaginary part is dropped, and nothing of SymPy's or NumPy's own errors is shown."""
    f, start, told = COMPLEX[what]
    with pytest.raises((TypeError, ValueError), match=told):
        propagate(f, (0, 1), start)


def test_rates_are_as_many_as_variables() -> None:
    with pytest.raises(ValueError, match="returns 1 rate for 2 variables"):
        propagate(lambda t, y: [y[1]], (0, 1), [1.0, 0.0])
    with pytest.raises(ValueError, match="numbers in order"):
        propagate(lambda t, y: -y, (0, 1), {"y": 1.0})
    with pytest.raises(ValueError, match="the span of time comes before"):
        propagate(lambda t, y: -y, [1.0, 0.0], (0, 10))


def test_studies_take_the_field_of_a_function() -> None:
    with pytest.raises(TypeError, match="field_of_function"):
        choose(driven_pendulum, 20.0, {"y_0": 0.5}, accuracy=1e-7, observable="position")
    field = field_of_function(lambda t, y: [y[1], -np.sin(y[0])], 2)
    own, same = (
        flow_jacobian(each, (0, 1), [0.5, 0.0]).final for each in (lambda t, y: [y[1], -np.sin(y[0])], field)
    )
    assert (own == same).all()
    assert field == VectorField([field.x[1], -sp.sin(field.x[0])], field.x)
    assert choose(field, 20.0, [0.5, 0.0], accuracy=1e-7, observable="position", methods=["taylor"]).reached
