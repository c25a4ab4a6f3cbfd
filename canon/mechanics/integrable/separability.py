"""Separability of the Hamilton–Jacobi equation in given coordinates, by Levi-Civita's conditions."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING

from canon.expression.symbols.user_input import given_kind
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.proof.domain.verdict import Status, Verdict

if TYPE_CHECKING:
    from sympy import Expr

    from canon.proof.domain.domain import Domain

__all__ = ["is_separable", "levi_civita_condition"]


def levi_civita_condition(H: Hamiltonian, i: int, j: int) -> Expr:
    """Return the expression that vanishes identically in (q, p) where q_i and q_j separate.

    It is H^i H^j H_ij − H^i H_j H_i^j − H_i H^j H^i_j + H_i H_j H^ij, where lower indices are derivatives by q and
    upper ones by p: the condition that p_i(q_i, α) and p_j(q_j, α) with dp_i/dq_i = −H_i/H^i exist (T. Levi-Civita,
    Math. Ann. 59 (1904) 383, doi:10.1007/BF01445149).

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y, px, py = symbols("x y p_x p_y", real=True)
    >>> levi_civita_condition(Hamiltonian(px**2/2 + py**2/2 + x*y, [x, y], [px, py]), 0, 1)
    p_x*p_y
    """
    f, q_i, q_j, p_i, p_j = H.H, H.q[i], H.q[j], H.p[i], H.p[j]
    by_q_i, by_q_j, by_p_i, by_p_j = f.diff(q_i), f.diff(q_j), f.diff(p_i), f.diff(p_j)
    return (
        by_p_i * by_p_j * by_q_i.diff(q_j)
        - by_p_i * by_q_j * by_q_i.diff(p_j)
        - by_q_i * by_p_j * by_p_i.diff(q_j)
        + by_q_i * by_q_j * by_p_i.diff(p_j)
    )


def is_separable(H: Hamiltonian, domain: Domain | None = None, budget: float = 10.0) -> Verdict:
    """Tell whether the Hamilton–Jacobi equation of H separates in the coordinates in which H is written.

    Parameters
    ----------
    H
        A Hamiltonian without the time in it.
    domain
        Where the coordinates are meant.
    budget
        Seconds for all pairs of coordinates.

    Returns
    -------
    Verdict
        HOLDS where Levi-Civita's conditions do for each pair; FAILS names the pair that does not separate.

    Raises
    ------
    ValueError
        Where H depends on the time.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y, px, py = symbols("x y p_x p_y", real=True)
    >>> henon_heiles = (px**2 + py**2 + x**2 + y**2)/2 + x**2*y - y**3/3
    >>> is_separable(Hamiltonian(henon_heiles, [x, y], [px, py])).feedback
    "x and y do not separate: Levi-Civita's condition for the pair (x, y) fails"
    """
    given_kind(H, Hamiltonian, "what is_separable() looks at", "give Hamiltonian(H, q, p)")
    if H.H.has(H.t):
        raise ValueError(
            f"H depends on the time {H.t}; take it as a coordinate: H + p_t with {H.t} among the coordinates"
        )
    pairs = list(combinations(range(len(H.q)), 2))
    words = {f"Levi-Civita's condition for the pair ({H.q[i]}, {H.q[j]})": (i, j) for i, j in pairs}
    question = f"the Hamilton–Jacobi equation separates in {', '.join(map(str, H.q))}"
    verdict = all_vanish(
        ((name, levi_civita_condition(H, *pair)) for name, pair in words.items()), question, domain, budget
    )
    if verdict.status is not Status.FAILS:
        return verdict
    condition = verdict.feedback.removeprefix("not so: ")
    if condition not in words:
        return verdict
    first, second = (H.q[k] for k in words[condition])
    return replace(verdict, feedback=f"{first} and {second} do not separate: {condition} fails")
