"""Generating functions that hold a named integral: maps by arbitrary functions, and what no table holds."""

import pytest
import sympy as sp

from canon import CanonicalTransformation, GeneratingFunction, generating_function

F, G, V = (sp.Function(name) for name in "FGV")
REAL = sp.symbols("q p", real=True)
TIME = sp.Symbol("t", real=True)
PLANE = (sp.symbols("x y", real=True), sp.symbols("a b", real=True))
R = sp.sqrt(PLANE[0][0] ** 2 + PLANE[0][1] ** 2)


def kicked(gradient):
    """Return the map p → p + f(q) with a closed form f dq."""
    q, p = PLANE if len(gradient) == 2 else tuple((z,) for z in REAL)
    return CanonicalTransformation(q, p, q, [b + f for b, f in zip(p, gradient, strict=True)], t=TIME)


KICKS = {
    "any force": [F(REAL[0])],
    "any force in time": [F(REAL[0], TIME) * 2],
    "no table holds it": [sp.exp(-(REAL[0] ** 2)) * sp.sin(REAL[0] ** 2) * sp.log(REAL[0] ** 2 + 1)],
    "any and known": [F(PLANE[0][0]) + PLANE[0][1], G(PLANE[0][1]) + PLANE[0][0]],
    "of the sum": [3 * F(sum(PLANE[0])), 3 * F(sum(PLANE[0]))],
    "central": [F(R) * z / R for z in PLANE[0]],
    "a potential": [V(*PLANE[0]).diff(z) for z in PLANE[0]],
    "by parts": [REAL[0] ** 3 * F(REAL[0]).diff(REAL[0])],
}


@pytest.mark.parametrize("name", KICKS)
@pytest.mark.parametrize("kind", [2, 3])
def test_kicks_by_arbitrary_functions_have_generating_functions_with_a_named_integral(name, kind):
    T = kicked(KICKS[name])
    found = generating_function(T, kind)
    assert isinstance(found, GeneratingFunction)
    assert found.generates(T).holds
    assert not found.F.has(sp.Subs)
    wrong = kicked([2 * f for f in KICKS[name]])
    assert found.generates(wrong).fails


def test_a_named_integral_is_the_number_it_says():
    q, p = REAL
    F2 = generating_function(CanonicalTransformation(q, p, q, p + F(q) * sp.sin(q)), 2).F
    known = F2.replace(F, sp.cos).doit()
    at = dict.fromkeys(known.free_symbols, 0.7)
    assert float(known.subs(at)) == pytest.approx(0.49 - float(sp.sin(0.7)) ** 2 / 2, rel=1e-12)


def test_no_integral_is_named_across_a_singularity():
    q, p = REAL
    r = sp.Symbol("r", positive=True)
    assert generating_function(CanonicalTransformation(q, p, q, p + F(q) / q), 2).F is None
    assert generating_function(CanonicalTransformation(r, p, r, p + F(r) / r), 2).F.has(sp.Integral)
    assert generating_function(CanonicalTransformation(r, p, r, p + F(r) / (r - 2)), 2).F is None
