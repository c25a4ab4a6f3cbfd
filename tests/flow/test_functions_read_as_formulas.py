"""Functions f(t, y) of many kinds: their formulas have the values that they return, or the refusal says why."""

from __future__ import annotations

import cmath
import enum
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pytest
import sympy as sp
from numpy import linalg
from scipy.interpolate import CubicSpline

from canon import propagate
from canon.mechanics import field_of_function
from canon.mechanics.traced import decisions, traced_function
from canon.mechanics.traced.decisions import along_all_ways
from canon.mechanics.traced.steps_of_time import with_single_steps
from canon.mechanics.traced.traced_function import read_at_start
from canon.mechanics.traced.traced_number import TracedNumber, expression

if TYPE_CHECKING:
    from collections.abc import Callable


class Mode(enum.Enum):
    STIFF = 4.0
    SOFT = 1.0


class Law(NamedTuple):
    pull: Callable[[float], float]
    factor: float


class Compiled:
    """A function of machine code, which keeps that of Python it was made of as numba's do."""

    def __init__(self, function):
        self.py_func = function

    def __call__(self, u):
        return self.py_func(np.float64(u))  # takes numbers alone


class Damper:
    def __init__(self, c):
        self.c = c

    @property
    def law(self):
        return lambda v: -self.c * math.tanh(v)

    def __call__(self, t, y):
        return [y[1], -y[0] + self.law(y[1])]


LAWS = (math.sin, math.cos)
FACTORS = (1.0, 2.0)
LAW = Law(math.sin, 2.0)
JITTED = Compiled(lambda u: math.sin(u) * math.exp(-u))
STIFFNESS = CubicSpline([0, 1, 2], [0.0, 1.0, 4.0])
COUPLED = np.array([[2.0, 1.0], [1.0, 3.0]])


def vortices(t, y):
    a, b = complex(y[0], y[1]), complex(y[2], y[3])
    u, more = 1j / (a - b), (a - b) ** -2
    return [u.real, -u.imag, -2 * u.real + more.imag, u.imag + more.real]


def with_modes(t, y):
    return [y[1], -(Mode.STIFF.value if t < 1 else Mode.SOFT.value) * y[0]]


def with_tuples(t, y):
    return [y[1], -LAWS[0](y[0]) * FACTORS[1] + LAWS[1](t) - LAW.pull(LAW.factor * y[0])]


def by_arrays_of_numbers(t, y):
    a = np.zeros(2)
    a[0] = 2.0
    b = np.array(a)
    b[1] = 1.0
    c = np.array([1, 2], float) + np.array([1, 2], dtype=float) / 2
    return [y[1] * b[0] - a[1], -y[0] * c[1] + np.sin(a)[0]]


def by_functions_of_numbers(t, y):
    k = np.clip(np.array([0.5, 3.0]), 0, 1)
    pull = math.dist((0, 0), (3, 4)) + cmath.rect(2.0, 0.5).real + max([1, -3], key=abs)
    return [max(1.0, 2.0) * y[1] * k[1], -y[0] * min([3.0, 2.0]) * k[0] + pull]


def against_what_is_not_finite(t, y):
    k = 1.0 if y[0] < np.inf else 2.0
    k += 0.5 if y[0] > -np.inf else 0.0
    k += 0.25 if y[0] == np.nan else 0.0
    k += 7 if y[0] != np.nan else 0.0
    k += 0.125 if y[0] <= np.nan else 0.0
    return [k * y[1], -y[0]]


def by_logical_functions(t, y):
    both, either = np.logical_and(y[0] > 0, y[1] < 1), np.logical_or(y[0] > 1, y[1])
    return [np.where(y[0], y[1], 2.0), np.where(both, y[0], -y[1]) + np.where(either, 1.0, 0.0)]


def with_a_long_nought(t, y):
    nought = 0 * y[0]
    for _ in range(200):
        nought = nought + y[0] - y[0]
    return [y[1] + np.where(nought < 1, 1.0, 3.0), -y[0] + (1.0 if nought > 0 else 0.5)]


def in_windows(t, y):
    return [y[1], -y[0] + (1.0 if 1 < t < 2 else 0.0) + (1.0 if (t > 0.5) & (t < 0.7) else 0.0)]


FUNCTIONS: dict[str, tuple[Callable[..., Any], int]] = {
    "vortices": (vortices, 4),
    "compiled": (lambda t, y: [y[1], -JITTED(y[0])], 2),
    "an enumeration": (with_modes, 2),
    "tuples of functions and numbers": (with_tuples, 2),
    "a property": (Damper(0.3), 2),
    "linear equations of numbers": (lambda t, y: linalg.solve(COUPLED, np.array([y[1], -y[0]])), 2),
    "arrays of numbers": (by_arrays_of_numbers, 2),
    "functions of numbers": (by_functions_of_numbers, 2),
    "logarithms": (lambda t, y: [math.log(2 + y[0] ** 2), math.log(3 + y[1] ** 2, 2) + float(np.array(y[0]))], 2),
    "numbers of SymPy": (lambda t, y: [y[1] * sp.pi, -y[0] * True * sp.sqrt(2) + 1.5 * (y[0] != "a")], 2),
    "logical functions": (by_logical_functions, 2),
    "not finite": (against_what_is_not_finite, 2),
    "times an array": (lambda t, y: y[0] * np.array([1.0, 2.0]) - np.array([3.0, 4.0]) / (2 + y[1] ** 2), 2),
    "against an array": (lambda t, y: np.where(y[0] < np.array([0.5, -0.5]), y, -y), 2),
    "an array of one number": (lambda t, y: [y[1], -STIFFNESS(0.5) * y[0] * np.array(2.0)], 2),
    "windows of the time": (in_windows, 2),
    "whole parts": (lambda t, y: [y[1], -np.floor(y[0]) + math.floor(y[1] + t)], 2),
    "a long nought": (with_a_long_nought, 2),
    "norms": (lambda t, y: [np.linalg.norm(np.outer(y, y), "fro"), np.linalg.norm(y, 2)], 2),
}  # fmt: skip


def values(field, t, y):
    point = dict(zip((*field.x, sp.Symbol("t", real=True)), map(sp.Float, (*y, t)), strict=True))
    return [float(rate.xreplace(point).evalf()) for rate in field.components]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_formulas_have_the_values_of_the_function(name: str) -> None:
    f, n = FUNCTIONS[name]
    field = field_of_function(f, n)
    drawn = np.random.default_rng(1)
    for y in (*drawn.uniform(-2, 2, (8, n)), np.arange(n) - 0.5):
        t = float(drawn.uniform(0, 2))
        due = np.asarray(f(t, y), dtype=float)
        np.testing.assert_allclose(values(field, t, y), due, rtol=1e-12, atol=1e-12)
        assert not np.allclose(values(field, t, y * 1.02), due, rtol=1e-6, atol=1e-6)


def test_a_function_that_counts_its_calls_is_read_where_its_rates_do_not_ask_for_the_count() -> None:
    def counting(*, asked):
        calls = 0

        def f(t, y):
            nonlocal calls
            calls += 1
            return [y[1], -y[0] if not asked or calls < 100 else y[0]]

        return f

    assert (
        field_of_function(counting(asked=False), 2).components
        == field_of_function(lambda t, y: [y[1], -y[0]], 2).components
    )
    with pytest.raises(TypeError, match="it asks for calls, which it changes itself when it is called"):
        field_of_function(counting(asked=True), 2)


def test_what_sympy_has_decided_is_not_asked() -> None:
    x = sp.Symbol("x", positive=True)
    asked = []

    def call(of_call):
        asked.append(of_call.decide(x > 0))
        return [x if of_call.decide(sp.S.One < 2) else -x]

    assert along_all_ways(call) == [x]
    assert asked == [True]


def test_a_condition_without_a_call_has_no_truth() -> None:
    u = TracedNumber(sp.Symbol("u", real=True))
    with pytest.raises(TypeError, match="asks for the truth of something that moves"):
        bool(u > 0)
    assert bool(u - u > -1)


def test_arrays_of_one_number_are_that_number() -> None:
    assert expression(np.array(0.375)) == sp.Rational(3, 8)
    assert expression(np.True_) == 1
    assert expression(np.array(TracedNumber(sp.Symbol("u")), dtype=object)) == sp.Symbol("u")


LONG = CubicSpline(np.linspace(0, 1, 70), np.sin(np.linspace(0, 1, 70)))
NUMBERS = np.arange(81).reshape(9, 9) % 7 + np.eye(9)


def counting_up(t, y):
    n = 0
    while y[0] > n:
        n += 1
    return [y[1], -n]


def until_small(t, y):
    """Kepler's equation by repeated substitution."""
    E = t
    while abs(E - 0.3 * np.sin(E) - t) > 1e-3:
        E = t + 0.3 * np.sin(E)
    return [y[1], -y[0] + E]


def eight_times(t, y):
    E = t
    for _ in range(8):
        E = t + 0.3 * np.sin(E)
    return [y[1], -y[0] + E]


def importing_inside(t, y):
    import math as inside

    return [y[1], -inside.sin(y[0])]


def contradicting_itself(t, y):
    assert y[0] > 0
    assert y[0] <= 0
    return [y[1], -y[0]]


REFUSED: dict[str, tuple[Callable[..., Any], int, str]] = {
    "a root in the plane": (lambda t, y: [np.sqrt(y[0] + 1j * y[1]).real, 0], 2, "is taken of a complex number"),
    "questions without end": (counting_up, 2, "it asks more than 100 times for the sign of something that moves"),
    "a loop until something is small": (
        until_small, 2, "nested more than 60 deep, as a loop does that runs until something that moves is small",
    ),
    "math, imported inside": (
        importing_inside, 2, "the number of something that moves, as an index does, or math imported inside it",
    ),
    "assertions": (contradicting_itself, 2, "its own assertions rule out all ways through it"),
    "where": (lambda t, y: [np.where(y > 0)[0].size, y[0]], 2, "with one argument asks where something that moves"),
    "a long spline": (lambda t, y: [LONG(y[0]), y[0]], 2, "a spline of more than 60 pieces"),
    "nine equations": (lambda t, y: linalg.solve(NUMBERS + np.diag(y), y), 9, "9 linear equations; give the L"),
    "long equations": (
        lambda t, y: linalg.solve(np.sin(np.outer(y, y)) + np.exp(np.add.outer(y, y)), y), 6,
        "formulas for the solution of 6 linear equations are very long",
    ),
    "a singular matrix": (lambda t, y: linalg.solve(np.array([[y[0], y[0]], [y[0], y[0]]]), y), 2, "Singular matrix"),
    "a large determinant": (lambda t, y: [linalg.det(np.diag(y))] * 5, 5, "the determinant of 5 rows of something"),
    "a sum of moduli": (lambda t, y: [linalg.norm(y, 1), y[0]], 2, "a norm of order 1 of something that moves"),
    "a norm of a matrix": (lambda t, y: [linalg.norm(np.outer(y, y), 2), y[0]], 2, "a norm of order 2 of something"),
    "no number": (lambda t, y: [y[0] * math.nan, y[0]], 2, "nan is no formula and no finite number"),
    "a text": (lambda t, y: [y[0] + "two", y[0]], 2, "'two' is no formula and no finite number"),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_has_no_formulas_is_refused_with_the_reason_and_what_to_write(what: str) -> None:
    f, n, told = REFUSED[what]
    with pytest.raises(TypeError, match=told) as caught:
        field_of_function(f, n)
    assert "can't be read as formulas" in str(caught.value)
    assert "write such equations as canon.VectorField" in str(caught.value)


def test_what_is_told_instead_of_a_loop_until_something_is_small_can_be_read() -> None:
    field = field_of_function(eight_times, 2)
    assert values(field, 0.7, [0.2, 0.1]) == pytest.approx(eight_times(0.7, [0.2, 0.1]), rel=1e-15)


def test_whole_parts_of_the_time_are_written_out_up_to_a_number_of_steps() -> None:
    def staircase(rate):
        return lambda t, y: [math.floor(rate * t) - y[0]]

    field = read_at_start(staircase(3), (0.0, 1.0), [0.0])
    for t in (0.1, 0.4, 0.9):
        assert values(field, t, [0.25]) == [staircase(3)(t, [0.25])[0]] != [staircase(4)(t, [0.25])[0] + 1]
    told = (
        r"floor\(500\*t\) has 500 steps from t = 0 to 1, of which 300 .*; take a shorter span, and go on from"
    )
    with pytest.raises(TypeError, match=told):
        propagate(staircase(500), (0, 1), [0.0], samples=1)
    short = read_at_start(staircase(500), (0.5, 0.6), [0.0])
    assert [values(short, t, [0.0]) for t in (0.5013, 0.5513, 0.5993)] == [[250], [275], [299]]


def test_whole_parts_of_other_variables_stay() -> None:
    u, t = sp.Symbol("u", real=True), sp.Symbol("t", real=True)
    for stays in (sp.floor(u + t), sp.floor(sp.sqrt(2) * t), sp.floor(sp.sin(t))):
        assert with_single_steps(stays + sp.floor(t), 0.5, 2.5) == stays + sp.Heaviside(t - 1) + sp.Heaviside(
            t - 2
        )


def test_windows_of_the_time_are_looked_at_within_the_span() -> None:
    def at_noon(t, y):
        return [y[1] if t == 0.5 or (t > 0.7) & (t < 0.9) else -y[1], y[0] if t > 2 else -y[0]]

    field = read_at_start(at_noon, (0.0, 1.0), [1.0, 2.0])
    assert field.components[1] == -field.x[0]
    for t in (0.2, 0.5, 0.8, 0.95):
        assert values(field, t, [1.0, 2.0]) == at_noon(t, [1.0, 2.0])


def test_ways_are_followed_up_to_a_number_of_them(monkeypatch) -> None:
    def signs(t, y):
        return [1 if u > 0 else -1 for u in y]

    field = field_of_function(signs, 4)
    assert values(field, 0.0, [1, -1, -1, 1]) == [1, -1, -1, 1]
    monkeypatch.setattr(decisions, "MOST_WAYS", 15)
    with pytest.raises(TypeError, match="more than 15 ways through it, by signs of what moves"):
        field_of_function(signs, 4)


def test_other_rates_for_numbers_are_noticed_away_from_the_start(monkeypatch) -> None:
    def other(t, y):
        return [-2 * y[0] if y.dtype == np.float64 and y[0] > 1.05 else -y[0]]

    with pytest.raises(TypeError, match=r"read as formulas \[-1\.18.*\]; does it remember earlier calls\?"):
        read_at_start(other, (0.0, 1.0), [1.0])
    twin = read_at_start(lambda t, y: [-2 * y[0] if y[0] > 1.05 else -y[0]], (0.0, 1.0), [1.0])
    assert [values(twin, 0.0, [u]) for u in (1.0, 2.0)] == [[-1.0], [-4.0]]
    monkeypatch.setattr(traced_function, "_SMALL", 0)
    assert read_at_start(other, (0.0, 1.0), [1.0]).components == (-twin.x[0],)
