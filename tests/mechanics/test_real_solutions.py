"""Equations solved for one symbol: all real solutions and no other, as signs on a fine grid show them."""

import numpy as np
import pytest
import sympy as sp

from canon.mechanics.algebra.single_equation import generator_values
from canon.mechanics.algebra.solve_for_symbol import real_solutions
from canon.proof.domain.domain import Domain

x, y = sp.symbols("x y", real=True)
r, Y = sp.symbols("r Y", positive=True)
TURN = Domain((x > -7, x < 7))

EQUATIONS = {
    "cosine": 3 * sp.cos(x) - 2,
    "half angle": sp.sin(x) + 2 * sp.cos(x) - 1,
    "tangent": sp.tan(x / 4) - sp.Rational(1, 2),
    "arctangent": sp.atan(x) - 1,
    "arcsine": sp.asin(x / 2) + 1,
    "arccosine": sp.acos(x / 2) - 1,
    "exponential": sp.exp(x) - 3,
    "power of a number": 2**x - 3,
    "modulus": sp.Abs(x - 1) - 2,
    "three logarithms": sp.log(sp.log(sp.log(x + 20))),
}
HALF_TURN = 1 + sp.cos(x) + sp.sin(x) * (sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1)
"""Zero at half a turn only, where the tangent of the half angle is infinite."""


def numbers(equation, domain=TURN):
    """Return the solutions that are real and within the bounds, each number of turns put in."""
    found = []
    for root in real_solutions(equation, x, domain):
        turns = sorted(root.value.atoms(sp.Dummy), key=str)
        for n in range(-4, 5) if turns else (0,):
            value = complex(root.value.subs(dict.fromkeys(turns, n)))
            conditions = [complex(c.subs(dict.fromkeys(turns, n))) for c in root.conditions]
            if abs(value.imag) < 1e-12 and all(c.real >= 0 for c in conditions) and abs(value.real) < 7:
                found.append(value.real)
    return np.unique(np.round(found, 9))


@pytest.mark.parametrize("name", EQUATIONS)
def test_all_real_solutions_are_found(name):
    f = sp.lambdify(x, EQUATIONS[name], "numpy")
    with np.errstate(invalid="ignore"):
        values = f(np.linspace(-6.9999, 6.9999, 20001))
    changes = (values[1:] * values[:-1] < 0) & (np.abs(np.diff(values)) < 1)
    found = numbers(EQUATIONS[name])
    assert np.allclose(f(found), 0, atol=1e-8)
    assert len(found) == np.count_nonzero(changes) > 0


def test_half_a_turn_is_looked_at_for_itself():
    assert numbers(HALF_TURN) == pytest.approx([-np.pi, np.pi])
    assert numbers(HALF_TURN + 1).size == 0


@pytest.mark.parametrize(
    "equation", [sp.atan(x) - 2, sp.atan(x) - sp.pi / 2, sp.asin(x) + 2, sp.cos(x) - 2, 2**x + 1]
)
def test_a_value_that_a_function_does_not_take_is_no_solution(equation):
    assert numbers(equation).size == 0


def test_a_factor_that_may_vanish_leaves_every_value():
    assert real_solutions(y * (sp.cos(x) - 1), x, Domain()) is None
    assert real_solutions((y**2 + 1) * (sp.cos(x) - 1), x, Domain()) is not None


def test_many_turns_are_not_told_apart():
    """Of cos 100 x = ½ there are 319 solutions between 0 and 10, of cos x = ½ three."""
    bounded = Domain((x > 0, x < 10))
    few = real_solutions(sp.cos(x) - sp.Rational(1, 2), x, bounded)
    assert sorted(root.value for root in few) == [sp.pi / 3, 5 * sp.pi / 3, 7 * sp.pi / 3]
    many = real_solutions(sp.cos(100 * x) - sp.Rational(1, 2), x, bounded)
    turns = [root.value.atoms(sp.Dummy).pop() for root in many]
    starts = [root.value.subs(n, 0) for root, n in zip(many, turns, strict=True)]
    assert starts == [sp.pi / 300, -sp.pi / 300]
    assert all(root.value.diff(n) == sp.pi / 50 for root, n in zip(many, turns, strict=True))


NESTED = x + sp.exp(x)


@pytest.mark.parametrize(
    "equation",
    [
        sp.log(sp.log(sp.log(sp.log(x)))) - 1,
        sp.sinh(x) - 1,
        (-2) ** x - 3,
        sp.sin(sp.sqrt(x)) + 2 * sp.cos(sp.sqrt(x)) - 1,
        sp.sin(x) * sp.cos(x) + sp.sin(x) + sp.Rational(1, 3),
        2 * sp.sin(NESTED) + sp.cos(NESTED) - 1,
        HALF_TURN.subs(x, NESTED),
    ],
    ids=[
        "too deep",
        "sinh",
        "a negative base",
        "an angle that may be complex",
        "quartic",
        "no angle",
        "half a turn",
    ],
)
def test_what_has_no_closed_form_here_is_none(equation):
    assert real_solutions(equation, x, Domain()) is None


@pytest.mark.parametrize(
    ("equation", "places"),
    [
        (sp.tan(x) + sp.cot(x), (0.3, 1.2)),
        (2 * sp.cot(x) - 3 * sp.tan(x), (0.3, 1.2)),
        (sp.sec(x) + sp.cos(x), (0.3, 1.2)),
        (sp.csc(x) + 2 * sp.sin(x), (0.3, 1.2)),
        (sp.sec(x) + sp.tan(x), (0.3, 1.2)),
        (sp.csc(x) - sp.cot(x), (0.3, 1.2)),
    ],
    ids=str,
)
def test_circular_functions_beside_each_other_are_values_of_one(equation, places):
    for place in places:
        due = float(equation.subs(x, place))
        found = list(generator_values(equation - Y, x))
        gaps = [abs(complex((kernel.subs(x, place) - value).subs(Y, due))) for kernel, value, _ in found]
        assert min(gaps) < 1e-12
        assert not any(value.has(x) for _, value, _ in found)
        wrong = [abs(complex((kernel.subs(x, place) + value).subs(Y, due))) for kernel, value, _ in found]
        assert min(wrong) > 1e-3
