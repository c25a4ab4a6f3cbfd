"""Laws of the brackets (bilinearity, Leibniz, Jacobi, invariance) as questions about the user's own functions.

Poisson's bracket makes the functions of (q, p) a Lie algebra of derivations (V. I. Arnold, Mathematical
Methods of Classical Mechanics, § 40); each law returns a Verdict whose residual is what failed to cancel.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.symbol import time
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.substitution import entry, substitute
from canon.mechanics.hamilton.bracket import (
    lagrange_matrix,
    lie_bracket,
    poisson_bracket,
    poisson_matrix,
    symplectic_unit,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.mechanics.canonical.transformation import CanonicalTransformation
    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = [
    "antisymmetry",
    "bilinearity",
    "fundamental_brackets",
    "invariance",
    "jacobi_identity",
    "lagrange_inverts_poisson",
    "leibniz_rule",
    "lie_jacobi_identity",
    "time_rule",
]


def antisymmetry(
    f: Expr, g: Expr, q: Sequence[Symbol], p: Sequence[Symbol], domain: Domain | None = None
) -> Verdict:
    """Tell whether {f, g} = −{g, f}."""
    residual = poisson_bracket(f, g, q, p) + poisson_bracket(g, f, q, p)
    return all_vanish([("{f, g} + {g, f} = 0", residual)], "the bracket is antisymmetric", domain)


def bilinearity(
    functions: Sequence[Expr],
    coefficients: Sequence[Expr],
    g: Expr,
    q: Sequence[Symbol],
    p: Sequence[Symbol],
    domain: Domain | None = None,
) -> Verdict:
    """Tell whether {Σ aᵢ fᵢ, g} = Σ aᵢ {fᵢ, g} for these coefficients, which should not depend on q, p.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p, a = symbols("q p a", real=True)
    >>> bilinearity([q**2, p], [a, 3], q*p, [q], [p]).status.name
    'HOLDS'
    >>> bilinearity([q**2], [p], q, [q], [p]).status.name
    'FAILS'
    """
    terms = list(zip(coefficients, functions, strict=True))
    whole = poisson_bracket(sp.Add(*(a * f for a, f in terms)), g, q, p)
    parts = sp.Add(*(a * poisson_bracket(f, g, q, p) for a, f in terms))
    return all_vanish([("{Σ a f, g} = Σ a {f, g}", whole - parts)], "the bracket is bilinear", domain)


def leibniz_rule(
    f: Expr, g: Expr, h: Expr, q: Sequence[Symbol], p: Sequence[Symbol], domain: Domain | None = None
) -> Verdict:
    """Tell whether {f g, h} = f {g, h} + {f, h} g."""
    residual = (
        poisson_bracket(f * g, h, q, p) - f * poisson_bracket(g, h, q, p) - g * poisson_bracket(f, h, q, p)
    )
    return all_vanish([("{f g, h} = f {g, h} + g {f, h}", residual)], "the bracket is a derivation", domain)


def jacobi_identity(
    f: Expr, g: Expr, h: Expr, q: Sequence[Symbol], p: Sequence[Symbol], domain: Domain | None = None
) -> Verdict:
    """Tell whether {f, {g, h}} + {g, {h, f}} + {h, {f, g}} = 0.

    Examples
    --------
    >>> from sympy import symbols, sin
    >>> q, p = symbols("q p", real=True)
    >>> jacobi_identity(q**2*p, sin(p), q*p, [q], [p]).status.name
    'HOLDS'
    """

    def nested(a: Expr, b: Expr, c: Expr) -> Expr:
        return poisson_bracket(a, poisson_bracket(b, c, q, p), q, p)

    residual = nested(f, g, h) + nested(g, h, f) + nested(h, f, g)
    return all_vanish([("{f, {g, h}} + cyclic = 0", residual)], "Jacobi's identity", domain)


def time_rule(
    f: Expr,
    g: Expr,
    q: Sequence[Symbol],
    p: Sequence[Symbol],
    domain: Domain | None = None,
    t: Symbol = time,
) -> Verdict:
    """Tell whether ∂{f, g}/∂t = {∂f/∂t, g} + {f, ∂g/∂t}."""
    residual = (
        poisson_bracket(f, g, q, p).diff(t)
        - poisson_bracket(f.diff(t), g, q, p)
        - poisson_bracket(f, g.diff(t), q, p)
    )
    return all_vanish([("∂{f, g}/∂t = {∂f/∂t, g} + {f, ∂g/∂t}", residual)], "the rule for ∂/∂t", domain)


def fundamental_brackets(
    new_q: Sequence[Expr],
    new_p: Sequence[Expr],
    q: Sequence[Symbol],
    p: Sequence[Symbol],
    domain: Domain | None = None,
) -> Verdict:
    """Tell whether {Qᵢ, Qⱼ} = {Pᵢ, Pⱼ} = 0 and {Qᵢ, Pⱼ} = δᵢⱼ.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p = symbols("q p", real=True)
    >>> fundamental_brackets([q], [p], [q], [p]).status.name
    'HOLDS'
    >>> fundamental_brackets([p], [q], [q], [p]).status.name
    'FAILS'
    """
    difference = poisson_matrix([*new_q, *new_p], q, p) - symplectic_unit(len(q))
    names = [*(f"Q{i + 1}" for i in range(len(q))), *(f"P{i + 1}" for i in range(len(p)))]
    claims = [
        (f"{{{names[i]}, {names[j]}}} = {int(j == i + len(q))}", entry(difference, i, j))
        for i in range(len(names))
        for j in range(i + 1, len(names))
    ]
    return all_vanish(claims, "the fundamental brackets", domain)


def lagrange_inverts_poisson(
    transformation: CanonicalTransformation, inverse: CanonicalTransformation, domain: Domain | None = None
) -> Verdict:
    """Tell whether Σₗ [uₗ, uᵢ] {uₗ, uⱼ} = δᵢⱼ for the 2n functions u(q, p) of a map.

    Parameters
    ----------
    transformation
        The functions u as the images of a map, canonical or not.
    inverse
        The inverse map, on which Lagrange's brackets are formed.
    domain
        Where it is asked; the map's domain unless given.
    """
    here = dict(zip(inverse.variables, transformation.images, strict=True))
    lagrange = lagrange_matrix(inverse.variables, inverse.new_q, inverse.new_p)
    poisson = transformation.poisson_brackets
    size = poisson.rows
    claims = [
        (
            f"Σ [u, u{i + 1}] {{u, u{j + 1}}} = {int(i == j)}",
            sp.Add(
                *(substitute(entry(lagrange, k, i), here) * entry(poisson, k, j) for k in range(size)),
                -int(i == j),
            ),
        )
        for i in range(size)
        for j in range(size)
    ]
    return all_vanish(claims, "Lagrange's brackets invert Poisson's", domain or transformation.domain)


def invariance(
    f: Expr,
    g: Expr,
    transformation: CanonicalTransformation,
    new_q: Sequence[Symbol],
    new_p: Sequence[Symbol],
    domain: Domain | None = None,
) -> Verdict:
    """Tell whether {f, g} formed in (Q, P) equals the bracket formed in (q, p).

    Parameters
    ----------
    f, g
        Functions of the new variables.
    transformation
        The map; its brackets are kept for all f and g only where it is canonical.
    new_q, new_p
        The new variables in f and g.
    domain
        Where it is asked; the map's domain unless given.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon import CanonicalTransformation
    >>> q, p, Q, P = symbols("q p Q P", real=True)
    >>> invariance(Q*P, P**2, CanonicalTransformation(q, p, p, -q), [Q], [P]).status.name
    'HOLDS'
    >>> invariance(Q*P, P**2, CanonicalTransformation(q, p, p, q), [Q], [P]).status.name
    'FAILS'
    """
    T = transformation
    there = dict(zip((*new_q, *new_p), T.images, strict=True))
    in_new = substitute(poisson_bracket(f, g, new_q, new_p), there)
    in_old = poisson_bracket(substitute(f, there), substitute(g, there), T.q, T.p)
    return all_vanish(
        [("{f, g} in (Q, P) = {f, g} in (q, p)", in_new - in_old)],
        "Poisson's bracket is invariant",
        domain or T.domain,
    )


def lie_jacobi_identity(
    X: Sequence[Expr], Y: Sequence[Expr], Z: Sequence[Expr], x: Sequence[Symbol], domain: Domain | None = None
) -> Verdict:
    """Tell whether [X, [Y, Z]] + [Y, [Z, X]] + [Z, [X, Y]] = 0 for three vector fields."""
    cyclic = [lie_bracket(a, lie_bracket(b, c, x), x) for a, b, c in ((X, Y, Z), (Y, Z, X), (Z, X, Y))]
    claims = [
        (f"component {i + 1} of [X, [Y, Z]] + cyclic = 0", sp.Add(*parts))
        for i, parts in enumerate(zip(*cyclic, strict=True))
    ]
    return all_vanish(claims, "Jacobi's identity of the Lie bracket", domain)
