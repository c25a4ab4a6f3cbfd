"""New Hamiltonian of a canonical transformation, K = c H + ∂F/∂t, without knowing F.

At fixed t let the explicit rates ∂Q/∂t, ∂P/∂t of the new variables be the vector field of a function R:
∂R/∂P = ∂Q/∂t, ∂R/∂Q = −∂P/∂t. Then K = c H + R. In the old variables
∂R/∂z = Σ (∂Q/∂t ∂P/∂z − ∂P/∂t ∂Q/∂z), a closed form where the map is canonical, so R follows by
integration, and a claimed K is judged by derivatives alone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.user_input import counted, given_expression, given_kind, given_symbols
from canon.mechanics.algebra.all_vanish import all_vanish, having_values
from canon.mechanics.algebra.dynamicsymbols import in_own_symbols
from canon.mechanics.algebra.potential import potential
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.canonical.canonicity_tests import given_valence
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.proof.continuity.continuity import continuity
from canon.proof.domain.domain import as_domain
from canon.proof.domain.verdict import Status, Verdict, all_hold

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.mechanics.canonical.transformation import CanonicalTransformation
    from canon.proof.domain.domain import Domain

__all__ = ["energy_in", "is_new_hamiltonian", "new_hamiltonian", "rate_form"]


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
        Where the map is certainly not canonical with that valence; or H is about other variables, pairs of them or
        another time.

    Examples
    --------
    >>> from canon import CanonicalTransformation, time as t
    >>> from sympy import symbols
    >>> q, p, v, m = symbols("q p v m", real=True)
    >>> new_hamiltonian(CanonicalTransformation(q, p, q - v*t, p - m*v), p**2/(2*m))
    -p*v + p**2/(2*m)
    """
    _is_map(transformation)
    energy = energy_in(H, transformation.q, transformation.p, "the map", transformation.t)
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


def energy_in(H: Expr | Hamiltonian, q: Sequence[Symbol], p: Sequence[Symbol], whose: str, t: Symbol) -> Expr:
    """Return a Hamiltonian, given as one or as an expression, as an expression in these pairs of variables.

    Raises
    ------
    ValueError
        Where it is about other variables, pairs or another time than what it is given to.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y, t = symbols("x y t", real=True)
    >>> energy_in(Hamiltonian(y**2/2, x, y), [x], [y], "the map", t)
    y**2/2
    """
    if not isinstance(H, Hamiltonian):
        return in_own_symbols([given_expression(H, "H")], (*q, *p), t)[0]
    if {*H.q, *H.p} != {*q, *p}:
        raise ValueError(
            f"H is a function of {(*H.q, *H.p)} and {whose} one of {(*q, *p)}; give both in the same variables"
        )
    pairs = {*zip(q, p, strict=True)}
    if other := [(x, y) for x, y in zip(H.q, H.p, strict=True) if (x, y) not in pairs]:
        raise ValueError(
            f"the momentum of {other[0][0]} is {other[0][1]} in H and another one in {whose}; pair coordinates and "
            "momenta alike in both"
        )
    if H.t != t and H.H.has(H.t, t):
        raise ValueError(f"the time of H is {H.t} and that of {whose} is {t}; give both the same")
    return H.H


def is_new_hamiltonian(
    transformation: CanonicalTransformation,
    before: Expr,
    after: Expr,
    images: Sequence[Symbol],
    domain: Domain | None = None,
    valence: Expr | None = sp.S.One,
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
        The c of M J Mᵀ = c J of the given map; None to find it.

    Raises
    ------
    ValueError
        Where the images are not as many as the variables, the valence is no constant other than 0, or a Hamiltonian
        holds another symbol of the name of a variable.

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
    T = replace(transformation, domain=as_domain(domain, transformation.domain))
    if len(images) != 2 * len(T.q):
        raise ValueError(
            f"{counted(len(images), 'symbol')} for the {2 * len(T.q)} new variables; give (*Q, *P)"
        )
    question = "the map is canonical and K is the new Hamiltonian"
    images = given_symbols(images, "images")
    c = T.valence if valence is None else given_valence(valence, (*T.variables, T.t))
    if c is None:
        return all_hold([T.is_canonical(valence=None)], question)
    (H,) = in_own_symbols([given_expression(before, "the Hamiltonian before the map")], T.variables, T.t)
    (K,) = in_own_symbols([given_expression(after, "the Hamiltonian after the map")], images, T.t)
    carried = substitute(K, dict(zip(images, T.images, strict=True)))
    gap = carried - c * H
    claims = [
        (f"∂(K − c H)/∂{z} = ∂R/∂{z}", gap.diff(z) - r)
        for z, r in zip(T.variables, rate_form(T), strict=True)
    ]

    def verdicts() -> Iterator[Verdict]:
        yield T.is_canonical(valence=c)
        yield all_vanish(claims, "the new Hamiltonian is right", T.domain)
        verdict = having_values(Verdict(Status.HOLDS), {"K": carried}, [H], T.domain)
        yield verdict
        if verdict.holds:
            yield continuity(gap, T.variables, T.domain, name="K", given=T.images)

    return all_hold(verdicts(), question)
