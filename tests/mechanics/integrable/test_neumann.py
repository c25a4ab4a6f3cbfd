"""Neumann's problem on the sphere, H = |ẋ|²/2 + Σ a_k x_k²/2: Uhlenbeck's integrals, and its separation (Jacobi)."""

import pytest
import sympy as sp

from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

X = sp.symbols("x1:4", real=True)
P = sp.symbols("p1:4", real=True)
u, v, p_u, p_v = sp.symbols("u v p_u p_v", real=True)
SYMBOLS = sp.symbols("a1:4", positive=True)
STIFFNESS = (sp.Integer(1), sp.Integer(2), sp.Integer(4))
BETWEEN = Domain((u > 1, u < 2, v > 2, v < 4))


def uhlenbeck(k, squares, spins, a):
    """F_k = x_k² + Σ (x_k p_j − x_j p_k)²/(a_k − a_j) of squares x_k² and spins (x_k p_j − x_j p_k)²."""
    return squares[k] + sp.Add(*(spins[k, j] / (a[k] - a[j]) for j in range(3) if j != k))


def in_space(a):
    squares = [x**2 for x in X]
    spins = {(k, j): (X[k] * P[j] - X[j] * P[k]) ** 2 for k in range(3) for j in range(3)}
    H = (
        spins[0, 1] + spins[0, 2] + spins[1, 2] + sp.Add(*(b * s for b, s in zip(a, squares, strict=True)))
    ) / 2
    return H, [uhlenbeck(k, squares, spins, a) for k in range(3)]


def on_the_sphere():
    """The squares, the metric and the spins in sphero-conical coordinates, x_k² = Π_i (a_k − λ_i)/Π_j (a_k − a_j)."""
    a = STIFFNESS
    squares = [(b - u) * (b - v) / sp.prod(b - c for c in a if c != b) for b in a]
    metric = [sp.factor(sp.Add(*(s.diff(z) ** 2 / (4 * s) for s in squares))) for z in (u, v)]
    rates = [p_u / metric[0], p_v / metric[1]]
    turning = [
        sp.Add(*(s.diff(z) / (2 * s) * w for z, w in zip((u, v), rates, strict=True))) for s in squares
    ]
    spins = {
        (k, j): squares[k] * squares[j] * (turning[j] - turning[k]) ** 2 for k in range(3) for j in range(3)
    }
    force = sp.cancel(sp.Add(*(b * s for b, s in zip(a, squares, strict=True))))
    H = p_u**2 / (2 * metric[0]) + p_v**2 / (2 * metric[1]) + force / 2
    return squares, metric, spins, Hamiltonian(H, [u, v], [p_u, p_v])


def test_uhlenbecks_integrals_are_in_involution_and_make_up_the_energy():
    H, F = in_space(SYMBOLS)
    assert vanishes(sp.Add(*(a * f for a, f in zip(SYMBOLS, F, strict=True))) / 2 - H).holds
    assert vanishes(sp.Add(*F) - sp.Add(*(x**2 for x in X))).holds
    for f in F:
        assert vanishes(poisson_bracket(f, H, X, P)).holds
    for i, j in ((0, 1), (0, 2), (1, 2)):
        assert vanishes(poisson_bracket(F[i], F[j], X, P)).holds


@pytest.mark.parametrize("k", range(3))
def test_a_wrong_sign_in_uhlenbecks_integral_is_refused(k):
    H, F = in_space(SYMBOLS)
    assert vanishes(poisson_bracket(2 * X[k] ** 2 - F[k], H, X, P)).fails


def test_the_coordinates_are_orthogonal_and_on_the_sphere():
    squares, metric, _, _ = on_the_sphere()
    assert sp.cancel(sp.Add(*squares)) == 1
    assert sp.cancel(sp.Add(*(s.diff(u) * s.diff(v) / s for s in squares))) == 0
    cubic = sp.prod(u - a for a in STIFFNESS)
    assert sp.cancel(metric[0] + (u - v) / (4 * cubic)) == 0


def test_neumanns_problem_separates_and_its_constants_are_uhlenbecks():
    squares, _, spins, H = on_the_sphere()
    found = hamilton_jacobi(H, domain=BETWEEN)
    assert found.separable.holds
    assert found.is_complete_integral().holds
    F = [uhlenbeck(k, squares, spins, STIFFNESS) for k in range(3)]
    energy = sp.Add(*(a * f for a, f in zip(STIFFNESS, F, strict=True))) / 2
    assert vanishes(found.defined_as[found.energy] - energy, BETWEEN).holds
    # p² is Σ F_k Π_{j≠k} (λ − a_j) over −4 Π (λ − a_j) at both λ: Uhlenbeck's are the coefficients.
    for momentum, z in zip(found.momenta, (u, v), strict=True):
        due = -sp.Add(*(f / (z - a) for f, a in zip(F, STIFFNESS, strict=True))) / 4
        p = {u: p_u, v: p_v}[z]
        assert vanishes(p**2 - due, BETWEEN).holds
        assert vanishes(momentum.square.subs(found.defined_as) - due, BETWEEN).holds
        assert vanishes(p**2 - 2 * due, BETWEEN).fails
