"""Numbers of 113 bits give what 40 digits give, to their rounding; motions in double-double are measured by them."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, Splitting, coordinates, propagate
from canon.expression.graph.graph import Graph
from canon.expression.graph.number_systems import multiprecision
from canon.flow.run import observables_along
from canon.kernel.heyoka_bridge import fraction_of
from canon.kernel.quad_arithmetic import quad_arithmetic, quad_array, quad_for
from canon.scene import find

x, y = sp.symbols("x y", real=True)
QUAD = quad_arithmetic()
EXPRESSIONS = (
    x + y, x * y, x / y, x**2 - y**3, 1 / x**5, sp.sqrt(x), x ** sp.Rational(-3, 2), x ** sp.Rational(1, 3), x**y,
    sp.sin(x), sp.cos(y), sp.tan(x), sp.exp(-x), sp.log(y), sp.asin(x / 8), sp.acos(x / 8), sp.atan(x), sp.sinh(x),
    sp.cosh(x), sp.tanh(x), sp.asinh(y), sp.acosh(1 + x), sp.atanh(x / 8), sp.atan2(y, x), sp.Abs(-x), sp.sign(-x),
    sp.pi * x + sp.E, sp.Rational(1, 3) * x, x + sp.Rational(10**50 + 1, 10**49),
)  # fmt: skip

pytestmark = pytest.mark.skipif(QUAD is None, reason="heyoka was built without numbers of 113 bits")


@pytest.mark.parametrize("expression", EXPRESSIONS, ids=str)
def test_every_function_is_that_of_forty_digits(expression: sp.Expr) -> None:
    graph, digits = Graph(), multiprecision(45)
    node = graph.from_sympy(expression)
    highs = np.array([[0.7, 1.9, 3.25], [0.3, 2.5, 6.5]])
    state = quad_array(highs, highs * 2.0**-70)
    assert QUAD is not None
    assert quad_for(graph, [node]) is QUAD
    (found,) = graph.evaluate([node], dict(zip((x, y), state, strict=True)), QUAD)
    for k in range(3):
        point = {s: digits.number(fraction_of(state[row, k])) for row, s in enumerate((x, y))}
        (true,) = graph.evaluate([node], point, digits)
        one = np.broadcast_to(np.asarray(found, dtype=state.dtype), (3,))[k]
        wrong = abs(digits.number(fraction_of(one)) - true)
        assert wrong <= 2.0**-108 * max(abs(true), 2.0**-20)


def test_doubles_would_not_do() -> None:
    """The wrong twin: the bound is far below the rounding of doubles and long doubles."""
    assert QUAD is not None
    third = QUAD.number(Fraction(1, 3))
    assert abs(fraction_of(third) - Fraction(1, 3)) < Fraction(1, 2**113)
    assert abs(Fraction(1.0 / 3.0) - Fraction(1, 3)) > Fraction(1, 2**56)


def test_functions_that_it_has_not_are_left_to_more_digits() -> None:
    graph = Graph()
    assert quad_for(graph, [graph.from_sympy(sp.erf(x) + x)]) is None
    q = coordinates("q")
    H = Hamiltonian(q.momentum**2 / 2 + q**2 / 2 + sp.erf(q) / 10, [q], [q.momentum])
    motion = propagate(
        H, (0, 5), [0.4, 0.0], method=Splitting("kahan-li-8"), step=0.05, precision="double-double"
    )
    assert 1e-18 < abs(motion.energy_error).max() < 1e-11  # that of the method, of order 8


@pytest.mark.parametrize("name", ["kepler", "henon-heiles"])
def test_energies_in_double_double_are_those_of_forty_digits(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = find(name)
    period, start = scene.time_scale(scene.values), scene.state(scene.starts[0])

    def errors() -> tuple[float, np.ndarray[Any, Any]]:
        motion = propagate(
            scene.hamiltonian, (0, 3 * period), start, method=Splitting("kahan-li-8"), step=period / 400,
            precision="double-double", parameters=scene.values, samples=40,
        )  # fmt: skip
        return abs(float(motion.energy[0])), motion.energy_change

    size, found = errors()
    monkeypatch.setattr(observables_along, "quad_for", lambda *_: None)
    _, true = errors()
    wrong = abs(found - true) - 2.0**-52 * abs(true)  # they are told in doubles
    assert (wrong <= 2.0**-109 * 10 * size).all()
    assert (abs(true[1:]) > 2.0**-100 * size).any()  # there is something to measure


def test_an_energy_outside_its_domain_is_told() -> None:
    q = coordinates("q")
    H = Hamiltonian(q.momentum**2 / 2 - q, [q], [q.momentum])
    with pytest.raises(ArithmeticError, match="not finite at a sample"):
        propagate(
            H, (0, 3), [1.0, -1.0], method=Splitting("verlet"), step=0.5, precision="double-double",
            observables={"root": sp.sqrt(q - sp.Rational(9, 10))},
        )  # fmt: skip
