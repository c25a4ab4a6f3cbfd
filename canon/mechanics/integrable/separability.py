"""Separability of the Hamilton–Jacobi equation in given coordinates, by Levi-Civita's conditions."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.expression.symbols.user_input import given_kind
from canon.mechanics.algebra.all_vanish import all_vanish, having_values
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.proof.analytic import proved_sign
from canon.proof.continuity.jumps import continued
from canon.proof.continuity.one_sided import cuts_of
from canon.proof.domain.domain import as_domain
from canon.proof.domain.verdict import Evidence, Status, Verdict
from canon.proof.kinks import vanishes_off_kinks
from canon.proof.trees.sympy_types import free_symbols

if TYPE_CHECKING:
    from sympy import Expr

    from canon.proof.domain.domain import Domain

__all__ = ["is_separable", "levi_civita_condition"]


def levi_civita_condition(H: Hamiltonian, i: int, j: int) -> Expr:
    """Return the expression that vanishes identically in (q, p) where q_i and q_j separate.

    It is H^i H^j H_ij − H^i H_j H_i^j − H_i H^j H^i_j + H_i H_j H^ij, where lower indices are derivatives by q and
    upper ones by p: the condition that p_i(q_i, α) and p_j(q_j, α) with dp_i/dq_i = −H_i/H^i exist (T. Levi-Civita,
    Math. Ann. 59 (1904) 383, doi:10.1007/BF01445149).

    Raises
    ------
    ValueError
        Where i and j are not two of the places 0 … n − 1.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y, px, py = symbols("x y p_x p_y", real=True)
    >>> levi_civita_condition(Hamiltonian(px**2/2 + py**2/2 + x*y, [x, y], [px, py]), 0, 1)
    p_x*p_y
    """
    n = len(H.q)
    if i == j or not {i, j} <= {*range(n)}:
        raise ValueError(
            f"the places of two coordinates are needed, from 0 to {n - 1}, not {i} and {j}"
            if n > 1
            else f"one coordinate has no condition: H has {H.q[0]} alone"
        )
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
        HOLDS where Levi-Civita's conditions do for each pair; FAILS names the pair that does not separate, a coordinate
        that stands in H without its momentum, or says that H has a value nowhere.

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
    question = f"the Hamilton–Jacobi equation separates in {', '.join(map(str, H.q))}"
    for i in range(len(H.q)):
        without_momentum = _without_momentum(H, i, as_domain(domain), budget / (4 * len(H.q)))
        if without_momentum is not None:
            return replace(without_momentum, question=question)
    pairs = list(combinations(range(len(H.q)), 2))
    words = {f"Levi-Civita's condition for the pair ({H.q[i]}, {H.q[j]})": (i, j) for i, j in pairs}
    verdict = all_vanish(
        ((name, levi_civita_condition(H, *pair)) for name, pair in words.items()), question, domain, budget
    )
    if verdict.holds and (bend := _bend_across_pairs(H, as_domain(domain))) is not None:
        why = f"H has a kink where {bend} = 0, across several coordinates, which Levi-Civita's conditions do not show"
        return Verdict(Status.UNDECIDED, question, evidence=(Evidence("open", why),), feedback=why)
    if verdict.status is not Status.FAILS:
        return having_values(verdict, {"H": H.H}, H.q, domain)
    condition = verdict.feedback.removeprefix("not so: ")
    if condition not in words:
        return verdict
    first, second = (H.q[k] for k in words[condition])
    return replace(verdict, feedback=f"{first} and {second} do not separate: {condition} fails")


def _bend_across_pairs(H: Hamiltonian, domain: Domain) -> Expr | None:
    """Return what vanishes at a kink or a step of H that several coordinates take part in, as in |x + y| or x sign(y).

    H may separate on both sides of it all the same: V = |x + y| does, whose mixed differences across it do not vanish.
    """
    state = (*H.q, *H.p)
    pairs = [{q, p} for q, p in zip(H.q, H.p, strict=True)]
    for arc in H.H.atoms(sp.asin, sp.acos):  # which may turn back and forth, as asin(sin u) does
        if sum(bool(pair & free_symbols(arc)) for pair in pairs) > 1:
            return sp.cos(arc)
    for cut in cuts_of(H.H, state):
        if isinstance(cut.part, sp.Pow) or proved_sign(cut.gap, domain) in ("+", "-"):
            continue
        sides = [continued(H.H, cut.gap, state, up=up) for up in (True, False)]
        step = cast("Expr", sp.expand(sp.Add(sides[0], -sides[1])))
        for factor in sp.Mul.make_args(sp.factor(cut.gap)):
            of_both = free_symbols(factor) | free_symbols(step)
            if step != 0 and factor.has(*state) and sum(bool(pair & of_both) for pair in pairs) > 1:
                return factor
    return None


def _without_momentum(H: Hamiltonian, i: int, domain: Domain, budget: float) -> Verdict | None:
    """Tell of a coordinate that stands in H without its momentum; None where H holds both, or neither.

    Levi-Civita's conditions say nothing then: ∂H/∂p_i = 0 is a factor of each of their terms or of both that hold
    q_i. The other momenta would depend on q_i, which alone no p_j(q_j, α) does.
    """
    q, p, of_p, of_q = H.q[i], H.p[i], H.H.diff(H.p[i]), H.H.diff(H.q[i])
    by_p = vanishes_off_kinks(of_p, domain, budget)
    if by_p.fails:
        return None
    by_q = vanishes_off_kinks(of_q, domain, budget)
    if by_q.holds and by_p.holds:
        return None
    if by_p.holds and by_q.fails:
        return replace(by_q, feedback=f"{q} does not separate: H depends on {q}, and not on its momentum {p}")
    why = f"whether H depends on {p if by_p.undecided else q} was not decided"
    return Verdict(Status.UNDECIDED, "", evidence=(Evidence("open", why),), feedback=why)
