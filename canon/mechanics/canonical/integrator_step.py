"""Integrator step as a map (q, p) → (Q, P), to be asked whether it is canonical.

Splitting steps compose drifts q → q + a h ∂T/∂p and kicks p → p − b h ∂V/∂q; Runge–Kutta steps evaluate
Hamilton's vector field (E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, II.5 and VI).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.user_input import all_of, counted, given_symbols
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.canonical.implicit_transformation import ImplicitTransformation
from canon.mechanics.canonical.transformation import CanonicalTransformation

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.mechanics.hamilton.hamiltonian import Hamiltonian

__all__ = ["midpoint_step", "runge_kutta_step", "splitting_step"]


def splitting_step(
    hamiltonian: Hamiltonian, h: Expr, kicks: Sequence[Expr], drifts: Sequence[Expr]
) -> CanonicalTransformation:
    """Return the step that kicks by b₁ h, drifts by a₁ h, kicks by b₂ h, and so on.

    Parameters
    ----------
    hamiltonian
        H = T(p) + V(q), autonomous.
    h
        The step size.
    kicks, drifts
        The coefficients b and a; one kick more than drifts, or as many.

    Raises
    ------
    ValueError
        Where H is not a function of p plus a function of q, or the coefficients do not alternate.

    Examples
    --------
    >>> from canon import Hamiltonian
    >>> from sympy import Rational, symbols
    >>> q, p, h = symbols("q p h", real=True)
    >>> leapfrog = splitting_step(Hamiltonian(p**2/2 + q**4/4, q, p), h, [Rational(1, 2)]*2, [1])
    >>> leapfrog.is_canonical().status.name
    'HOLDS'
    """
    H = hamiltonian
    if any(H.H.diff(a).diff(b) != 0 for a in H.q for b in H.p) or H.H.has(H.t):
        raise ValueError(
            f"{H.H} is not T(p) + V(q), so it has no drifts and kicks; take runge_kutta_step or midpoint_step"
        )
    if len(kicks) - len(drifts) not in (0, 1):
        raise ValueError(
            f"{counted(len(kicks), 'kick')} and "
            f"{counted(len(drifts), 'drift')} do not alternate, a kick first"
        )
    q: list[Expr] = list(H.q)
    p: list[Expr] = list(H.p)
    for i, b in enumerate(kicks):
        at = dict(zip(H.q, q, strict=True))
        p = [old + b * h * substitute(force, at) for old, force in zip(p, H.p_dot, strict=True)]
        if i < len(drifts):
            there = dict(zip(H.p, p, strict=True))
            q = [old + drifts[i] * h * substitute(rate, there) for old, rate in zip(q, H.q_dot, strict=True)]
    return CanonicalTransformation(H.q, H.p, q, p, t=H.t)


def runge_kutta_step(
    hamiltonian: Hamiltonian, h: Expr, A: Sequence[Sequence[Expr]], b: Sequence[Expr]
) -> CanonicalTransformation:
    """Return the step of an explicit Runge–Kutta method; such a step is not canonical.

    Parameters
    ----------
    hamiltonian
        The Hamiltonian; a time in it is taken at t + c h, where c is the sum of the stage's row.
    h
        The step size.
    A, b
        The tableau: row i of A holds the i coefficients of the stages before, and as many zeros after them as you like.

    Raises
    ------
    ValueError
        Where a row is too short, or holds a coefficient of a stage that is not before it: the method is implicit then;
        where b has not one weight for each row.

    Examples
    --------
    >>> from canon import Hamiltonian
    >>> from sympy import symbols
    >>> q, p, h = symbols("q p h", real=True)
    >>> euler = runge_kutta_step(Hamiltonian(p**2/2 + q**2/2, q, p), h, [[]], [1])
    >>> euler.poisson_brackets[0, 1]
    h**2 + 1
    """
    H = hamiltonian
    z: tuple[Symbol, ...] = (*H.q, *H.p)
    stages: list[list[Expr]] = []
    for row in A:
        before = len(stages)
        if len(row) < before or any(row[before:]):
            raise ValueError(
                f"row {before + 1} of an explicit tableau needs {counted(before, 'coefficient')}, "
                f"and nothing but zeros after them; it is {list(row)}"
            )
        moved = _moved(z, h, row[:before], stages)
        there = {**dict(zip(z, moved, strict=True)), H.t: H.t + sp.Add(*row[:before]) * h}
        stages.append([substitute(f, there) for f in H.vector_field])
    new = _moved(z, h, all_of(b, len(stages), "b", "stages"), stages)
    n = len(H.q)
    return CanonicalTransformation(H.q, H.p, new[:n], new[n:], t=H.t)


def midpoint_step(
    hamiltonian: Hamiltonian, h: Expr, new_q: Sequence[Symbol], new_p: Sequence[Symbol]
) -> ImplicitTransformation:
    """Return the implicit midpoint rule Z = z + h f((z + Z)/2, t + h/2), canonical for every Hamiltonian.

    Raises
    ------
    ValueError
        Where there are not as many new coordinates and momenta as old ones.

    Examples
    --------
    >>> from canon import Hamiltonian
    >>> from sympy import sin, symbols
    >>> q, p, Q, P, h = symbols("q p Q P h", real=True)
    >>> midpoint_step(Hamiltonian(p**2*sin(q) + q, q, p), h, [Q], [P]).is_canonical().status.name
    'HOLDS'
    """
    H = hamiltonian
    new_q = all_of(given_symbols(new_q, "new_q"), len(H.q), "new_q", "coordinates")
    new_p = all_of(given_symbols(new_p, "new_p"), len(H.p), "new_p", "momenta")
    old, new = (*H.q, *H.p), (*new_q, *new_p)
    middle = {**{a: (a + b) / 2 for a, b in zip(old, new, strict=True)}, H.t: H.t + h / 2}
    equations = tuple(
        b - a - h * substitute(f, middle) for a, b, f in zip(old, new, H.vector_field, strict=True)
    )
    return ImplicitTransformation(H.q, H.p, tuple(new_q), tuple(new_p), equations, t=H.t)


def _moved(
    z: Sequence[Symbol], h: Expr, weights: Sequence[Expr], stages: Sequence[Sequence[Expr]]
) -> list[Expr]:
    return [
        sp.Add(s, *(h * weight * stage[i] for weight, stage in zip(weights, stages, strict=True)))
        for i, s in enumerate(z)
    ]
