"""Numeric polynomials: values and derivatives against those that SymPy finds."""

import numpy as np
import pytest
import sympy as sp

from canon.mechanics.perturbation.resonant.numeric_polynomial import NumericPolynomial

VARIABLES = sp.symbols("a b c")
TERMS = {(3, 0, 1): 2 - 1j, (0, 2, 2): 0.5 + 0j, (1, 1, 1): -3j, (0, 0, 1): 1.5 + 0j, (0, 0, 0): 4 + 1j}
POINT = np.array([0.7 - 0.2j, -1.1 + 0.4j, 0.3 + 0.9j])


def test_gradient_and_second_derivatives_are_those_of_sympy():
    f = NumericPolynomial(np.array([*TERMS]), np.array([*TERMS.values()]))
    expected = sum(
        sp.sympify(c) * sp.Mul(*(z**k for z, k in zip(VARIABLES, powers, strict=True)))
        for powers, c in TERMS.items()
    )

    def at_point(expression):
        return complex(expression.subs(dict(zip(VARIABLES, map(sp.sympify, POINT.tolist()), strict=True))))

    assert f.value(POINT) == pytest.approx(at_point(expected))
    assert f.gradient(POINT) == pytest.approx([at_point(expected.diff(z)) for z in VARIABLES])
    slopes = np.array([[at_point(expected.diff(z, w)) for w in VARIABLES] for z in VARIABLES])
    assert f.hessian(POINT) == pytest.approx(slopes)
    assert NumericPolynomial(np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=complex)).value(POINT) == 0
