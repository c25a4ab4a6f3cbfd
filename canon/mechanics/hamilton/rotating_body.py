"""Rotating bodies as Poisson systems: Euler's equations on so(3)*, tops on se(3)*, attitude by Euler's parameters.

All along the body's principal axes: M = I ω is the angular momentum, Γ = Rᵀ e_z the vertical, and R = R(e) takes
components along the body's axes to those along fixed axes, e = (e₀, e₁, e₂, e₃) being Euler's parameters, a unit
quaternion. With {Mᵢ, Mⱼ} = −εᵢⱼₖ Mₖ, {Mᵢ, Γⱼ} = −εᵢⱼₖ Γₖ, {e, M} = ½ e × (i, j, k) as quaternions multiply:

Ṁ = M × ω + Γ × ∂V/∂Γ,   Γ̇ = Γ × ω,   ė = ½ e (0, ω),   ω = ∂H/∂M.

Casimir functions are |M|² of so(3)*, |Γ|² and M · Γ of se(3)*, |e|² with the attitude.

Sources: J. E. Marsden, T. S. Ratiu, Introduction to Mechanics and Symmetry (2nd ed., Springer 1999), §§ 1.4, 15.10,
doi:10.1007/978-0-387-21792-5; E. T. Whittaker, Analytical Dynamics (4th ed.), §§ 9, 69.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.user_input import all_of, given_expression
from canon.mechanics.hamilton.poisson_system import PoissonSystem

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "ANGULAR_MOMENTUM",
    "EULER_PARAMETERS",
    "VERTICAL",
    "attitude_matrix",
    "free_body",
    "heavy_top",
    "rotating_body",
]

ANGULAR_MOMENTUM: tuple[Symbol, ...] = sp.symbols("M_1:4", real=True)
"""M₁, M₂, M₃ along the body's principal axes."""

VERTICAL: tuple[Symbol, ...] = sp.symbols("Gamma_1:4", real=True)
"""Γ₁, Γ₂, Γ₃, the upward vertical along the body's axes."""

EULER_PARAMETERS: tuple[Symbol, ...] = sp.symbols("e_0:4", real=True)
"""e₀, e₁, e₂, e₃ = cos(χ/2), n sin(χ/2) of a turn by χ about n."""


def attitude_matrix(e: Sequence[Expr] = EULER_PARAMETERS) -> sp.ImmutableDenseMatrix:
    """Return R(e), which takes components along the body's axes to those along fixed axes, shape (3, 3).

    It is a rotation where e₀² + e₁² + e₂² + e₃² = 1.

    Examples
    --------
    >>> from sympy import sqrt
    >>> attitude_matrix([sqrt(2)/2, 0, 0, sqrt(2)/2])
    Matrix([
    [0, -1, 0],
    [1,  0, 0],
    [0,  0, 1]])
    """
    a, b, c, d = all_of(e, 4, "e", "Euler parameters")
    return sp.ImmutableDenseMatrix(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
        ]
    )


def free_body(inertia: Sequence[Expr]) -> PoissonSystem:
    """Return Euler's equations of a body that no moment acts on, for M alone.

    Parameters
    ----------
    inertia
        The principal moments of inertia A, B, C.

    Raises
    ------
    ValueError
        There are not three of them, or one is not positive.

    Examples
    --------
    >>> from canon import parameters
    >>> body = free_body(parameters("A B C", positive=True))
    >>> body.vector_field[2]
    M_1*M_2/B - M_1*M_2/A
    >>> M_1, M_2, M_3 = body.x
    >>> bool(body.is_casimir(M_1**2 + M_2**2 + M_3**2)), bool(body.is_constant_of_motion(body.H))
    (True, True)
    """
    return PoissonSystem(_kinetic(inertia), ANGULAR_MOMENTUM, _brackets())


def heavy_top(inertia: Sequence[Expr], V: Expr) -> PoissonSystem:
    """Return the equations of a body about a fixed point in gravity, for (M, Γ).

    Parameters
    ----------
    inertia
        The principal moments of inertia A, B, C about the fixed point.
    V
        The potential, a function of Γ₁, Γ₂, Γ₃ (:data:`VERTICAL`): m g l Γ₃ where the centre of mass is at l on the
        third axis.

    Examples
    --------
    Lagrange's top; the wrong sign of one term is no integral:

    >>> from canon import parameters
    >>> A, C, w = parameters("A C w", positive=True)
    >>> (M_1, M_2, M_3), (x, y, z) = ANGULAR_MOMENTUM, VERTICAL
    >>> top = heavy_top([A, A, C], w * z)
    >>> top.vector_field[0]
    Gamma_2*w + M_2*M_3/C - M_2*M_3/A
    >>> bool(top.is_casimir(M_1*x + M_2*y + M_3*z)), bool(top.is_casimir(M_1*x + M_2*y - M_3*z))
    (True, False)
    >>> bool(top.is_constant_of_motion(M_3))
    True
    """
    moves = _turning(VERTICAL)
    return PoissonSystem(
        _kinetic(inertia) + given_expression(V, "V"), (*ANGULAR_MOMENTUM, *VERTICAL), _brackets(moves)
    )


def rotating_body(inertia: Sequence[Expr], V: Expr = sp.S.Zero) -> PoissonSystem:
    """Return the equations of a body about its centre of mass or a fixed point with its attitude, for (M, e).

    Parameters
    ----------
    inertia
        The principal moments of inertia A, B, C.
    V
        The potential, a function of e₀, e₁, e₂, e₃ (:data:`EULER_PARAMETERS`), by :func:`attitude_matrix` where it is
        known as one of directions; none where not given. It may have any value off e₀² + e₁² + e₂² + e₃² = 1.

    Examples
    --------
    >>> from canon import parameters
    >>> A, B, C, w = parameters("A B C w", positive=True)
    >>> R = attitude_matrix()
    >>> top = rotating_body([A, B, C], w * R[2, 2])
    >>> bool(top.is_casimir(sum(e**2 for e in EULER_PARAMETERS)))
    True
    >>> vertical = sum(M * R[2, i] for i, M in enumerate(ANGULAR_MOMENTUM))
    >>> bool(top.is_constant_of_motion(vertical))
    True
    """
    a, b, c, d = EULER_PARAMETERS
    half = sp.Rational(1, 2)
    moves = sp.Matrix([[-b, -c, -d], [a, -d, c], [d, a, -b], [-c, b, a]]) * half
    H = _kinetic(inertia) + given_expression(V, "V")
    return PoissonSystem(H, (*ANGULAR_MOMENTUM, *EULER_PARAMETERS), _brackets(moves))


def _kinetic(inertia: Sequence[Expr]) -> Expr:
    moments = [
        given_expression(I, "a moment of inertia") for I in all_of(inertia, 3, "inertia", "principal axes")
    ]
    if any(I.is_positive is False for I in moments):
        raise ValueError(f"inertia = {[str(I) for I in moments]}: principal moments of inertia are positive")
    return sp.Add(*(M**2 / (2 * I) for M, I in zip(ANGULAR_MOMENTUM, moments, strict=True)))


def _turning(u: Sequence[Expr]) -> sp.Matrix:
    """Return {uᵢ, Mⱼ} = −εᵢⱼₖ uₖ of a fixed vector along the body's axes, so that u̇ = u × ω."""
    a, b, c = u
    return sp.Matrix([[0, -c, b], [c, 0, -a], [-b, a, 0]])


def _brackets(moves: sp.Matrix | None = None) -> sp.Matrix:
    """Return the brackets of M and of what turns with the body, whose brackets with M are given."""
    own = _turning(ANGULAR_MOMENTUM)
    if moves is None:
        return own
    still = sp.zeros(moves.rows, moves.rows)
    return sp.Matrix(sp.BlockMatrix([[own, -moves.T], [moves, still]]))
