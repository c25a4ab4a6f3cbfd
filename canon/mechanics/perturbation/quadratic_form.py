"""Quadratic Hamiltonians in Williamson's form: variables in which H₂ is a sum over pairs, each with its eigenvalue.

For ẋ = A x with A = J ∂²H₂ a row ℓ with ℓ A = λ ℓ makes a = ℓ·x move by ȧ = λ a. Rows come in pairs ±λ, and
{aⱼ, bⱼ} = cⱼ is all that is left of the bracket (J. Williamson, Am. J. Math. 58, 141 (1936), doi:10.2307/2371062).
Rows are never divided by roots, so coefficients stay in the field of the eigenvalues: an elliptic pair is z, z̄ with
{z, z̄} = −2iκ, κ > 0, and its part of H₂ is ω z z̄/(2κ).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, cast

import sympy as sp
from sympy import Expr

from canon.mechanics.perturbation.lie_transform import Brackets
from canon.proof.analytic import proved_sign
from canon.proof.domain.domain import EVERYWHERE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial, PolynomialRing

__all__ = ["DiagonalForm", "NoDiagonalFormError", "characteristic_exponents", "diagonal_form"]

Row = list["PhasePolynomial"]


class NoDiagonalFormError(ValueError):
    """Raised where the quadratic part of a Hamiltonian cannot be made diagonal."""


@dataclass(frozen=True)
class DiagonalForm:
    """Variables a₁ … aₙ, b₁ … bₙ with {aⱼ, bⱼ} = cⱼ, {aⱼ, H₂} = λⱼ aⱼ, {bⱼ, H₂} = −λⱼ bⱼ.

    Parameters
    ----------
    rows
        (a, b) as linear functions of (q, p): 2n polynomials of degree 1.
    columns
        (q, p) as linear functions of (a, b).
    brackets
        The bracket in (a, b).
    eigenvalues
        λ₁ … λₙ as polynomials of degree 0.
    exponents
        The same as SymPy numbers: iω with ω > 0 or < 0 where a pair is elliptic.
    """

    rows: tuple[PhasePolynomial, ...]
    columns: tuple[PhasePolynomial, ...]
    brackets: Brackets
    eigenvalues: tuple[PhasePolynomial, ...]
    exponents: tuple[Expr, ...]

    def is_elliptic(self, j: int) -> bool:
        """Tell whether the j-th pair oscillates: z, z̄ with {z, z̄} = −2iκ."""
        return not self.eigenvalues[j].re

    def frequency(self, j: int) -> Expr:
        """Return ω, or the rate λ of a hyperbolic pair."""
        return sp.expand(self.exponents[j] * sp.I) if self.is_elliptic(j) else self.exponents[j]

    def action(self, j: int) -> PhasePolynomial:
        """Return z z̄/(2κ) of an elliptic pair, a b/c of a hyperbolic one: H₂ = Σ ω I + Σ λ I."""
        n = len(self.eigenvalues)
        ring = self.eigenvalues[0].ring
        factor = self.brackets.constants[j].inverse()
        if self.is_elliptic(j):
            factor = factor * -ring.i
        return ring.variable(j) * ring.variable(n + j) * factor


def characteristic_exponents(hessian: sp.MatrixBase) -> list[tuple[Expr, int]]:
    """Return the eigenvalues λ of J ∂²H, one of each pair ±λ, with multiplicity.

    Of an elliptic pair it is −iω with ω > 0, of a hyperbolic one λ > 0, of four α ± iβ, −α ± iβ the two with α > 0.

    Raises
    ------
    NoDiagonalFormError
        Where one is zero, has a sign that depends on parameters, or has no closed form.
    """
    n = hessian.rows // 2
    square = sp.Dummy("lambda2")
    line = sp.Dummy("lambda")
    J = sp.Matrix(sp.BlockMatrix([[sp.zeros(n), sp.eye(n)], [-sp.eye(n), sp.zeros(n)]]))
    # SymPy's charpoly sorts factors, which it can't where their coefficients hold functions
    names = {f: sp.Dummy() for f in hessian.atoms(sp.Function)}
    named = sp.Matrix(hessian).xreplace(names)
    powers = (J * named).charpoly(line).all_coeffs()[::2]  # the odd ones are zero
    functions = {name: f for f, name in names.items()}
    even = sp.Poly([power.xreplace(functions) for power in powers], square)
    found = sp.roots(even, multiple=False)
    if sum(found.values()) < n:
        remedy = (
            "put numbers for the parameters" if hessian.free_symbols else "change to normal coordinates first"
        )
        raise NoDiagonalFormError(
            f"the squares of the exponents satisfy {even.as_expr()} = 0, which is not solved in radicals; {remedy}"
        )
    return [(_root(mu), times) for mu, times in found.items()]


def _root(mu: Expr) -> Expr:
    mu = cast("Expr", sp.factor(sp.radsimp(mu)) if mu.free_symbols else sp.radsimp(mu))
    if mu.is_zero:
        raise NoDiagonalFormError(
            "an exponent is zero: the equilibrium is not isolated, or the pair is parabolic; "
            "reduce an ignorable coordinate first"
        )
    if mu.is_negative:
        return -sp.I * sp.sqrtdenest(sp.sqrt(-mu))
    if mu.is_positive:
        return sp.sqrtdenest(sp.sqrt(mu))
    if mu.free_symbols:
        for square, unit in ((-mu, -sp.I), (mu, sp.S.One)):
            root = _root_of_square(square)  # of either sign: which pair is which is told by κ, or is free
            if root is not None:
                return unit * root
    x, y = mu.as_real_imag()
    if not mu.free_symbols and y != 0:
        modulus = sp.sqrtdenest(sp.sqrt(sp.expand(x**2 + y**2)))
        alpha, beta = sp.sqrtdenest(sp.sqrt((modulus + x) / 2)), sp.sqrtdenest(sp.sqrt((modulus - x) / 2))
        return alpha + sp.I * (beta if y.is_positive else -beta)
    raise NoDiagonalFormError(
        f"the sign of {mu}, the square of an exponent, depends on the parameters; "
        "declare them so that it is known, or put numbers for them"
    )


def _root_of_square(f: Expr) -> Expr | None:
    """Return the root of the square of a rational function with real coefficients; None of what is none.

    Examples
    --------
    >>> w = sp.Symbol("w", real=True)
    >>> _root_of_square(4 * (w - 1) ** 2 / w**4), _root_of_square(-((w - 1) ** 2))
    (2*(w - 1)/w**2, None)
    """
    factors = [factor.as_base_exp() for factor in sp.Mul.make_args(f)]
    numbers = sp.Mul(*(base**n for base, n in factors if base.is_number))
    powers = [(base, n) for base, n in factors if not base.is_number]
    if not numbers.is_positive or any(not n.is_Integer or n.is_odd or not base.is_real for base, n in powers):
        return None
    return sp.sqrt(numbers) * sp.Mul(*(base ** (n / 2) for base, n in powers))


def diagonal_form(
    hessian: Sequence[Sequence[PhasePolynomial]],
    exponents: Sequence[tuple[Expr, int]],
    ring: PolynomialRing,
) -> DiagonalForm:
    """Return Williamson's variables of ½ x·(hessian) x.

    Parameters
    ----------
    hessian
        ∂²H₂ in (q, p), of shape (2n, 2n), as constants of the ring.
    exponents
        What :func:`characteristic_exponents` returns.
    ring
        The ring, whose field holds real and imaginary parts of the exponents.

    Raises
    ------
    NoDiagonalFormError
        Where H₂ is not semisimple, or the sign of an action depends on parameters.
    """
    size = len(hessian)
    n = size // 2
    flow: list[Row] = [[*hessian[n + j]] for j in range(n)] + [[-h for h in hessian[j]] for j in range(n)]
    pairs = [pair for exponent, times in exponents for pair in _pairs_of(exponent, times, flow, ring)]
    rows = tuple(_linear(row, ring) for row in (*(x.a for x in pairs), *(x.b for x in pairs)))
    columns = tuple(_coordinate(k, pairs, ring) for k in range(size))
    brackets = Brackets(tuple(x.c for x in pairs))
    return DiagonalForm(
        rows, columns, brackets, tuple(x.eigenvalue for x in pairs), tuple(x.exponent for x in pairs)
    )


class _Pair(NamedTuple):
    """Rows a, b with {a, b} = c and {a, H₂} = λ a, {b, H₂} = −λ b; the exponent is λ as SymPy's number."""

    a: Row
    b: Row
    c: PhasePolynomial
    eigenvalue: PhasePolynomial
    exponent: Expr


def _pairs_of(exponent: Expr, times: int, flow: Sequence[Row], ring: PolynomialRing) -> list[_Pair]:
    """Return the pairs of one exponent ±λ, an elliptic one turned so that κ > 0."""
    re, im = exponent.as_real_imag()
    value = ring.number(re) + ring.i * ring.number(im)
    right, left = (_left_null_rows(flow, v, ring) for v in (value, -value))
    if len(right) < times:
        raise NoDiagonalFormError(
            f"the exponent {exponent} occurs {times} times and has {len(right)} directions: the quadratic part "
            "is not semisimple, and its normal form has a nilpotent part, which is not computed here"
        )
    if value.re:
        return [_Pair(a, b, c, value, exponent) for a, b, c in _dual_pairs(right, left, ring)]
    return [
        _Pair(b, a, -c, -value, -exponent)
        if _is_negative(c * ring.i, ring)  # c = −2iκ
        else _Pair(a, b, c, value, exponent)
        for a, b, c in _elliptic_pairs(right, ring)
    ]


def _left_null_rows(flow: Sequence[Row], value: PhasePolynomial, ring: PolynomialRing) -> list[Row]:
    """Return a basis of the rows ℓ with ℓ A = λ ℓ, by elimination in Aᵀ − λ."""
    size = len(flow)
    transposed = [[flow[j][i] - value if i == j else flow[j][i] for j in range(size)] for i in range(size)]
    matrix, pivots = _reduced(transposed)
    basis: list[Row] = []
    for c in (c for c in range(size) if c not in pivots):
        row = [ring.zero] * size
        row[c] = ring.one
        for top, pivot in enumerate(pivots):
            row[pivot] = -matrix[top][c]
        first = next(x for x in row if x).inverse()  # q has the coefficient 1: z = q + i p, not p − i q
        basis.append([x * first for x in row])
    return basis


def _form(a: Row, b: Row, ring: PolynomialRing) -> PhasePolynomial:
    """Return the bracket {a·x, b·x} of two linear functions."""
    n = len(a) // 2
    up = ring.sum_of_products([(a[j], b[n + j]) for j in range(n)])
    return up - ring.sum_of_products([(a[n + j], b[j]) for j in range(n)])


def _bar(row: Row) -> Row:
    return [x.conjugate_coefficients() for x in row]


def _reduced(matrix: list[Row]) -> tuple[list[Row], list[int]]:
    """Return the reduced echelon form of a square matrix, and the columns of its pivots."""
    matrix, pivots = [*matrix], list[int]()
    for column in range(len(matrix)):
        top = len(pivots)
        row = next((r for r in range(top, len(matrix)) if matrix[r][column]), None)
        if row is None:
            continue
        matrix[top], matrix[row] = matrix[row], matrix[top]
        scale = matrix[top][column].inverse()
        pivot = matrix[top] = [entry * scale for entry in matrix[top]]
        matrix = [
            _less(line, pivot, line[column]) if r != top and line[column] else line
            for r, line in enumerate(matrix)
        ]
        pivots.append(column)
    return matrix, pivots


def _elliptic_pairs(rows: list[Row], ring: PolynomialRing) -> list[tuple[Row, Row, PhasePolynomial]]:
    """Return z, z̄ and {z, z̄}, the rows made orthogonal in the Hermitian form {ℓ, ℓ̄}."""
    rows, pairs = [*rows], []
    while rows:
        j = next((j for j, row in enumerate(rows) if _form(row, _bar(row), ring)), None)
        if j is None:
            j, rows[0] = 0, _not_isotropic(rows, ring)
        z = rows.pop(j)
        bar = _bar(z)
        c = _form(z, bar, ring)
        inverse = c.inverse()
        pairs.append((z, bar, c))
        rows = [_less(row, z, _form(row, bar, ring) * inverse) for row in rows]
    return pairs


def _not_isotropic(rows: list[Row], ring: PolynomialRing) -> Row:
    """Return a row that is not isotropic, of rows that all are: ℓ + i c m with c = {ℓ, m̄}, whose form is −2i |c|²."""
    first = rows[0]
    other = next(row for row in rows[1:] if _form(first, _bar(row), ring))
    pairing = _form(first, _bar(other), ring)
    turned = [x * pairing for x in other]
    return [x + y * ring.i for x, y in zip(first, turned, strict=True)]


def _dual_pairs(
    right: list[Row], left: list[Row], ring: PolynomialRing
) -> list[tuple[Row, Row, PhasePolynomial]]:
    """Return a, b and {a, b} = 1 from the rows of λ and those of −λ, which are dual to each other."""
    right, left, pairs = [*right], [*left], []
    while right:
        a = right.pop(0)
        j = next(j for j, row in enumerate(left) if _form(a, row, ring))
        b = left.pop(j)
        inverse = _form(a, b, ring).inverse()
        b = [x * inverse for x in b]
        pairs.append((a, b, ring.one))
        right = [_less(row, a, _form(row, b, ring)) for row in right]
        left = [_less(row, b, _form(a, row, ring)) for row in left]
    return pairs


def _less(row: Row, other: Row, factor: PhasePolynomial) -> Row:
    return [x - factor * y for x, y in zip(row, other, strict=True)]


def _is_negative(minus_c_over_i: PhasePolynomial, ring: PolynomialRing) -> bool:
    """Tell whether κ < 0, for i c = 2κ.

    Raises
    ------
    NoDiagonalFormError
        Where that depends on parameters: an action would be negative for some of them.
    """
    kappa = ring.expression(minus_c_over_i, [sp.S.Zero] * ring.size)
    if not kappa.free_symbols:
        return bool(kappa.evalf(50) < 0)
    if kappa.is_negative is not None:
        return bool(kappa.is_negative)
    sign = proved_sign(kappa, EVERYWHERE)
    if not sign:
        raise NoDiagonalFormError(
            f"the sign of {kappa}, by which an action is told from its negative, depends on the parameters; "
            "declare them so that it is known, or put numbers for them"
        )
    return sign == "-"


def _linear(row: Row, ring: PolynomialRing) -> PhasePolynomial:
    return ring.sum_of_products([(x, ring.variable(j)) for j, x in enumerate(row)])


def _coordinate(k: int, pairs: Sequence[_Pair], ring: PolynomialRing) -> PhasePolynomial:
    """Return x_k = Σ ({x_k, b} a − {x_k, a} b)/c."""
    n = len(pairs)
    unit = [ring.one if j == k else ring.zero for j in range(2 * n)]
    total = ring.zero
    for j, (a, b, c, *_) in enumerate(pairs):
        inverse = c.inverse()
        total = total + ring.variable(j) * _form(unit, b, ring) * inverse
        total = total - ring.variable(n + j) * _form(unit, a, ring) * inverse
    return total
