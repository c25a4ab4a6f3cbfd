"""The new Hamiltonian K of a canonical transformation as a function of the new variables."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Symbol

from canon.expression.symbols.user_input import given_kind, given_symbols
from canon.mechanics.algebra.branch_point import branch_points, far_from_principal
from canon.mechanics.algebra.solve_on_branch import Inversion, solve_system
from canon.mechanics.algebra.substitution import shortened, substitute
from canon.mechanics.canonical.inverse.inverse_branch import united_squares
from canon.mechanics.canonical.inverse.inverse_transformation import NoClosedInverseError, meaning_of
from canon.mechanics.canonical.inverse.point_inverse import point_branch
from canon.mechanics.canonical.inverse.polar_inverse import polar_branch
from canon.mechanics.canonical.new_hamiltonian import is_new_hamiltonian, new_hamiltonian
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.mechanics.hamilton.hamiltonian import Hamiltonian

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr


__all__ = ["transformed_hamiltonian"]


def transformed_hamiltonian(
    transformation: CanonicalTransformation,
    H: Expr | Hamiltonian,
    new_q: Sequence[Symbol],
    new_p: Sequence[Symbol],
    valence: Expr = sp.S.One,
) -> Hamiltonian:
    """Return K(Q, P, t), proved in the old variables on the whole domain, up to a function of t.

    The inverse on one branch suggests K; the proof, K(Q(z), P(z), t) = c H + R, needs no inverse. So K is found
    also where several points have the same image and no inverse exists.

    Parameters
    ----------
    transformation
        A canonical map (q, p) → (Q, P) of that valence.
    H
        The old Hamiltonian in the old variables, as an expression or as a Hamiltonian.
    new_q, new_p
        Symbols for the new variables.
    valence
        The c of M J Mᵀ = c J.

    Raises
    ------
    NoClosedInverseError
        Where no closed K was found or it could not be proved; the text says which.
    ValueError
        Where the map is certainly not canonical with that valence.

    Examples
    --------
    >>> from sympy import atan, symbols
    >>> q, p, Q, P = symbols("q p Q P", real=True)
    >>> m, w = symbols("m omega", positive=True)
    >>> T = CanonicalTransformation(q, p, atan(m*w*q/p), (p**2 + m**2*w**2*q**2)/(2*m*w))
    >>> transformed_hamiltonian(T, p**2/(2*m) + m*w**2*q**2/2, [Q], [P]).H
    P*omega

    Source: H. Goldstein, C. Poole, J. Safko, Classical Mechanics, 3rd ed., section 9.3, eq. (9.44).
    """
    T = given_kind(transformation, CanonicalTransformation, "the map")
    new_q, new_p = given_symbols(new_q, "new_q"), given_symbols(new_p, "new_p")
    meaning = meaning_of(T, new_q, new_p)
    here = new_hamiltonian(T, H, valence)
    if here is None:
        raise NoClosedInverseError(
            "K was not found in the old variables: the rates ∂Q/∂t, ∂P/∂t of the map could not be integrated"
        )
    before = H.H if isinstance(H, Hamiltonian) else H
    for values in _branches(T, meaning):
        K = shortened(united_squares(shortened(substitute(here, values))))
        if is_new_hamiltonian(T, before, K, [*new_q, *new_p], valence=valence).holds:
            return Hamiltonian(K, new_q, new_p, T.t)
    raise NoClosedInverseError(
        "K was found in the old variables only, see new_hamiltonian: the map could not be solved for these on any "
        "branch, or the K found so could not be proved"
    )


def _branches(T: CanonicalTransformation, meaning: Mapping[Symbol, Expr]) -> Iterator[Mapping[Symbol, Expr]]:
    symbols = set(T.variables).union(*(f.atoms(Symbol) for f in T.images))
    for witness in sorted(branch_points(symbols, meaning, T.domain, 12), key=far_from_principal)[:3]:
        point = point_branch(T.q, T.p, meaning, witness, math.inf)
        if point is not None:
            yield point.values
        polar = polar_branch(T.variables, meaning, witness)
        if polar is not None:
            yield polar.values
        peeled = solve_system([(f, s) for s, f in meaning.items()], T.variables, Inversion(witness))
        if peeled is not None:
            yield peeled
