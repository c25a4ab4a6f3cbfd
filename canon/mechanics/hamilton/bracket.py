"""Poisson, Lagrange and Lie brackets.

{f, g} = Σ (∂f/∂q ∂g/∂p − ∂f/∂p ∂g/∂q), so {q, p} = +1;  [u, v] = Σ (∂q/∂u ∂p/∂v − ∂q/∂v ∂p/∂u);
[X, Y]ⁱ = Xʲ ∂ⱼYⁱ − Yʲ ∂ⱼXⁱ.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.user_input import given_expression, given_symbols
from canon.mechanics.algebra.substitution import as_tuple

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

__all__ = [
    "antisymmetric",
    "lagrange_bracket",
    "lagrange_matrix",
    "lie_bracket",
    "poisson_bracket",
    "poisson_matrix",
    "symplectic_unit",
]


def poisson_bracket(f: Expr, g: Expr, q: Sequence[Symbol], p: Sequence[Symbol]) -> Expr:
    """Return Poisson's bracket {f, g} = Σ (∂f/∂q ∂g/∂p − ∂f/∂p ∂g/∂q).

    Parameters
    ----------
    f, g
        Functions of q, p and whatever else is held fixed (time, parameters).
    q, p
        Coordinates and momenta in the same order.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y, px, py = symbols("x y px py")
    >>> poisson_bracket(x*py - y*px, x, [x, y], [px, py])
    y
    """
    q, p = given_symbols(q, "q"), given_symbols(p, "p")
    _same_length(q, p, "coordinates", "momenta")
    f, g = given_expression(f, "f"), given_expression(g, "g")
    return sp.Add(*(f.diff(a) * g.diff(b) - f.diff(b) * g.diff(a) for a, b in zip(q, p, strict=True)))


def lagrange_bracket(u: Symbol, v: Symbol, q: Sequence[Expr], p: Sequence[Expr]) -> Expr:
    """Return Lagrange's bracket [u, v] = Σ (∂q/∂u ∂p/∂v − ∂q/∂v ∂p/∂u).

    Parameters
    ----------
    u, v
        Two of the variables on which q and p depend.
    q, p
        Coordinates and momenta as functions of those variables, in the same order.

    Examples
    --------
    >>> from sympy import symbols, sin, cos, sqrt
    >>> Q = symbols("Q"); P = symbols("P", positive=True)
    >>> lagrange_bracket(Q, P, [sqrt(2*P)*sin(Q)], [sqrt(2*P)*cos(Q)])
    sin(Q)**2 + cos(Q)**2
    """
    (u,), (v,) = given_symbols(u, "u"), given_symbols(v, "v")
    q, p = as_tuple(q), as_tuple(p)
    _same_length(q, p, "coordinates", "momenta")
    return sp.Add(*(a.diff(u) * b.diff(v) - a.diff(v) * b.diff(u) for a, b in zip(q, p, strict=True)))


def lie_bracket(X: Sequence[Expr], Y: Sequence[Expr], x: Sequence[Symbol]) -> tuple[Expr, ...]:
    """Return the Lie bracket [X, Y]ⁱ = Xʲ ∂ⱼYⁱ − Yʲ ∂ⱼXⁱ of two vector fields.

    Parameters
    ----------
    X, Y
        Components of the fields.
    x
        The coordinates, as many as there are components.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y = symbols("x y")
    >>> lie_bracket([y, 0], [0, x], [x, y])
    (-x, y)
    """
    for field in (X, Y):
        if hasattr(field, "components"):
            raise TypeError("lie_bracket takes lists of components; of vector fields write X.bracket(Y)")
    first, second, x = as_tuple(X), as_tuple(Y), given_symbols(x, "x")
    _same_length(first, x, "components", "coordinates")
    _same_length(second, x, "components", "coordinates")
    return tuple(
        sp.Add(
            *(a * second[i].diff(s) - b * first[i].diff(s) for a, b, s in zip(first, second, x, strict=True))
        )
        for i in range(len(x))
    )


def poisson_matrix(functions: Sequence[Expr], q: Sequence[Symbol], p: Sequence[Symbol]) -> sp.Matrix:
    """Return the antisymmetric matrix of the brackets {fᵢ, fⱼ}.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p = symbols("q p")
    >>> poisson_matrix([q, p], [q], [p])
    Matrix([
    [ 0, 1],
    [-1, 0]])
    """
    return antisymmetric(len(functions), lambda i, j: poisson_bracket(functions[i], functions[j], q, p))


def lagrange_matrix(variables: Sequence[Symbol], q: Sequence[Expr], p: Sequence[Expr]) -> sp.Matrix:
    """Return the antisymmetric matrix of the brackets [uᵢ, uⱼ] of the variables on which q and p depend.

    Examples
    --------
    >>> from sympy import symbols
    >>> u, v = symbols("u v")
    >>> lagrange_matrix([u, v], [2*u], [v])
    Matrix([
    [ 0, 2],
    [-2, 0]])
    """
    return antisymmetric(len(variables), lambda i, j: lagrange_bracket(variables[i], variables[j], q, p))


def symplectic_unit(n: int) -> sp.ImmutableDenseMatrix:
    """Return J = ((0, 1), (−1, 0)) of shape (2n, 2n).

    Examples
    --------
    >>> symplectic_unit(1)
    Matrix([
    [ 0, 1],
    [-1, 0]])
    """
    rows = [[(j == i + n) - (i == j + n) for j in range(2 * n)] for i in range(2 * n)]
    return sp.ImmutableDenseMatrix(rows)


def antisymmetric(size: int, entry: Callable[[int, int], Expr]) -> sp.Matrix:
    """Return the antisymmetric matrix of which a function gives the entries above the diagonal."""
    matrix = sp.zeros(size, size)
    for i in range(size):
        for j in range(i + 1, size):
            matrix[i, j] = entry(i, j)
            matrix[j, i] = -matrix[i, j]
    return matrix


def _same_length(a: Sequence[object], b: Sequence[object], first: str, second: str) -> None:
    if len(a) != len(b):
        raise ValueError(f"{len(a)} {first} and {len(b)} {second}; give as many of each")
