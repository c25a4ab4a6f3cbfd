"""New Hamiltonian of a canonical transformation, K = c H + ∂F/∂t, without knowing F.

At fixed t let the explicit rates ∂Q/∂t, ∂P/∂t of the new variables be the vector field of a function R:
∂R/∂P = ∂Q/∂t, ∂R/∂Q = −∂P/∂t. Then K = c H + R. In the old variables
∂R/∂z = Σ (∂Q/∂t ∂P/∂z − ∂P/∂t ∂Q/∂z), a closed form where the map is canonical, so R follows by
integration, and a claimed K is judged by derivatives alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.user_input import counted, given_expression, given_kind
from canon.mechanics.algebra.all_vanish import all_vanish, having_values
from canon.mechanics.algebra.potential import potential
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.proof.continuity.continuity import continuity
from canon.proof.domain.domain import as_domain
from canon.proof.domain.verdict import Status, Verdict, all_hold

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.mechanics.canonical.transformation import CanonicalTransformation
    from canon.proof.domain.domain import Domain

__all__ = ["is_new_hamiltonian", "new_hamiltonian", "rate_form"]


def rate_form(transformation: CanonicalTransformation) -> tuple[Expr, ...]:
    """Return ∂R/∂z for the old variables z = (q, p), where K = c H + R.

    Examples
    --------
    >>> from canon import CanonicalTransformation, time as t
    >>> from sympy import symbols
    >>> q, p, v, m = symbols("q p v m", real=True)
    >>> rate_form(CanonicalTransformation(q, p, q - v*t, p - m*v))
    (0, -v)
    """
    T = transformation
    return tuple(
        sp.Add(
            *(
                Q.diff(T.t) * P.diff(z) - P.diff(T.t) * Q.diff(z)
                for Q, P in zip(T.new_q, T.new_p, strict=True)
            )
        )
        for z in T.variables
    )


def new_hamiltonian(
    transformation: CanonicalTransformation, H: Expr | Hamiltonian, valence: Expr = sp.S.One
) -> Expr | None:
    """Return the new Hamiltonian K of a canonical map in the old variables, up to a function of t; None if not found.

    Parameters
    ----------
    transformation
        A canonical map of that valence.
    H
        The old Hamiltonian in the old variables, as an expression or as a Hamiltonian.
    valence
        The c of M J Mᵀ = c J.

    Raises
    ------
    ValueError
        Where the map is certainly not canonical with that valence.

    Examples
    --------
    >>> from canon import CanonicalTransformation, time as t
    >>> from sympy import symbols
    >>> q, p, v, m = symbols("q p v m", real=True)
    >>> new_hamiltonian(CanonicalTransformation(q, p, q - v*t, p - m*v), p**2/(2*m))
    -p*v + p**2/(2*m)
    """
    _is_map(transformation)
    energy = _energy(H, transformation)
    canonical = transformation.is_canonical(valence=given_expression(valence, "valence"))
    if canonical.fails:
        raise ValueError(f"the map is not canonical, so it has no new Hamiltonian; {canonical.feedback}")
    R = potential(rate_form(transformation), transformation.variables, transformation.domain)
    return None if R is None else given_expression(valence, "valence") * energy + R


def _is_map(transformation: CanonicalTransformation) -> None:
    from canon.mechanics.canonical.transformation import CanonicalTransformation

    given_kind(
        transformation, CanonicalTransformation, "the map", "the map comes first, then the Hamiltonian"
    )


def _energy(H: Expr | Hamiltonian, transformation: CanonicalTransformation) -> Expr:
    """Return the old Hamiltonian as an expression in the old variables of the map."""
    if not isinstance(H, Hamiltonian):
        return given_expression(H, "H")
    if {*H.q, *H.p} != {*transformation.variables}:
        raise ValueError(
            f"H is a function of {(*H.q, *H.p)} and the map one of {transformation.variables}; "
            "give both in the same variables"
        )
    return H.H


def is_new_hamiltonian(
    transformation: CanonicalTransformation,
    before: Expr,
    after: Expr,
    images: Sequence[Symbol],
    domain: Domain | None = None,
    valence: Expr = sp.S.One,
) -> Verdict:
    """Tell whether the map is canonical and takes one Hamiltonian to the other, up to a function of t alone.

    Parameters
    ----------
    transformation
        The map (q, p) → (Q, P); or the inverse map, then ``before`` is K(Q, P, t), ``after`` H(q, p, t).
    before
        The Hamiltonian in the variables from which the map starts.
    after
        The Hamiltonian in the variables to which it leads.
    images
        The symbols that stand in ``after`` for the variables to which the map leads, of length 2n.
    domain
        Where the claim is meant; the transformation's unless given.
    valence
        The c of M J Mᵀ = c J of the given map.

    Examples
    --------
    >>> from canon import CanonicalTransformation
    >>> from sympy import symbols
    >>> q, p, Q, P, w = symbols("q p Q P w", real=True)
    >>> exchange = CanonicalTransformation(q, p, p, -q)
    >>> is_new_hamiltonian(exchange, p**2 + w*q, Q**2 - w*P, [Q, P]).status.name
    'HOLDS'
    >>> is_new_hamiltonian(exchange, p**2 + w*q, Q**2 + w*P, [Q, P]).status.name
    'FAILS'
    """
    _is_map(transformation)
    T = transformation
    domain = as_domain(domain, T.domain)
    if len(images) != 2 * len(T.q):
        raise ValueError(
            f"{counted(len(images), 'symbol')} for the {2 * len(T.q)} new variables; give (*Q, *P)"
        )
    carried = substitute(
        given_expression(after, "the Hamiltonian after the map"), dict(zip(images, T.images, strict=True))
    )
    gap = carried - valence * given_expression(before, "the Hamiltonian before the map")
    claims = [
        (f"∂(K − c H)/∂{z} = ∂R/∂{z}", gap.diff(z) - r)
        for z, r in zip(T.variables, rate_form(T), strict=True)
    ]

    def verdicts() -> Iterator[Verdict]:
        yield T.is_canonical(valence=valence)
        yield all_vanish(claims, "the new Hamiltonian is right", domain)
        verdict = having_values(Verdict(Status.HOLDS), {"K": carried}, [given_expression(before)], domain)
        yield verdict
        if verdict.holds:
            yield continuity(gap, T.variables, domain, name="K", given=T.images)

    return all_hold(verdicts(), "the map is canonical and K is the new Hamiltonian")
