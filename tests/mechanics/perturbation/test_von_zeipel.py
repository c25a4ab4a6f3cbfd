"""Von Zeipel's function to higher orders: it solves his equation H(q, ∂F/∂q) = K(∂F/∂P, P), which uses no bracket."""

import pytest
import sympy as sp

from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.averaging import average
from canon.mechanics.perturbation.secular.von_zeipel import von_zeipel_function

theta, phi, I, J, x, y, eps = sp.symbols("theta phi I J x y epsilon", positive=True)
QUARTIC = Hamiltonian(I + eps * I**2 * sp.cos(theta) ** 4, theta, I)
DRIVEN = Hamiltonian(
    I + 3 * J + eps * (I * J * sp.cos(theta - phi) + J**2 * sp.cos(phi)) + eps**2 * I**2 * sp.cos(2 * theta),
    [theta, phi],
    [I, J],
)
SLOW = Hamiltonian(
    I + eps * (y**2 / 2 + x**2 * I * sp.cos(theta) + x * y * sp.sin(theta)), [theta, x], [I, y]
)


def defect(found, F):
    """Return what is left of H(q, ∂F/∂q) − K(∂F/∂P, P) to the order of the average."""
    old_p = {s: F.F.diff(s_q) for s, s_q in zip(F.p, F.q, strict=True)}
    new = dict(zip(F.q, (F.F.diff(P) for P in F.new_p), strict=True)) | dict(zip(F.p, F.new_p, strict=True))
    difference = found.source.H.subs(old_p, simultaneous=True) - found.K.subs(new, simultaneous=True)
    left = sp.Add(*(difference.diff(eps, n).subs(eps, 0) for n in range(found.order + 1)))
    return sp.expand(left.rewrite(sp.exp))


@pytest.mark.parametrize(
    ("H", "angles", "order"),
    [
        (QUARTIC, [theta], 2),
        pytest.param(DRIVEN, [theta, phi], 2, marks=pytest.mark.slow),
        pytest.param(SLOW, [theta], 2, marks=pytest.mark.slow),
        pytest.param(QUARTIC, [theta], 4, marks=pytest.mark.slow),
    ],
)
def test_von_zeipels_equation_holds_to_the_order(H, angles, order):
    found = average(H, angles, order, eps)
    assert defect(found, found.F2) == 0
    last = found.F2.F.coeff(eps, order)
    assert last != 0
    for wrong in (-2 * last, last.diff(theta)):  # the sign of the last term, and a term of the next torus
        twin = type(found.F2)(
            2, found.F2.F + eps**order * wrong, found.F2.q, found.F2.p, found.F2.new_q, found.F2.new_p
        )
        assert defect(found, twin) != 0


def test_a_flow_in_closed_form():
    q, p = sp.symbols("q p", real=True)
    F = von_zeipel_function(q**2 * p, [q], [p], 6, eps)
    Q = sum((-eps) ** k * q ** (k + 1) for k in range(7))  # dq/dε = q² leads from Q to q = Q/(1 − ε Q)
    assert sp.expand(F.new_p[0] * Q - F.F) == 0


def test_an_order_below_one_is_refused():
    q, p = sp.symbols("q p", real=True)
    with pytest.raises(ValueError, match="from 1, not 0"):
        von_zeipel_function(q * p, [q], [p], 0, eps)
    with pytest.raises(ValueError, match="no polynomial in epsilon"):
        von_zeipel_function(q * p / eps, [q], [p], 1, eps)
