"""Maps from generating functions: the map, its inverse, the new Hamiltonian, and the other types.

The rules of a type give all 4n variables as functions of the 2n on which F depends; solving some of them for
others, on the branch of a witness point, gives the map either way and Legendre's relations among the types.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.user_input import given_kind
from canon.mechanics.algebra.branch_point import branch_points, far_from_principal
from canon.mechanics.algebra.solve_on_branch import Inversion, solve_system
from canon.mechanics.algebra.substitution import carried, shortened, substitute
from canon.mechanics.canonical.generating_function import GeneratingFunction, kinds_of
from canon.mechanics.canonical.implicit_transformation import ImplicitTransformation
from canon.mechanics.canonical.inverse.inverse_transformation import NoClosedInverseError
from canon.mechanics.canonical.new_hamiltonian import energy_in
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.proof.domain.domain import Domain, as_domain

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.proof.domain.verdict import Verdict


__all__ = [
    "generated_hamiltonian",
    "generated_inverse",
    "generated_transformation",
    "implicit_map",
    "of_kind",
]


def generated_transformation(F: GeneratingFunction, domain: Domain | None = None) -> CanonicalTransformation:
    """Return the map Q(q, p, t), P(q, p, t) that F generates, proved by the rules.

    Parameters
    ----------
    F
        A generating function with regular mixed Hessian.
    domain
        Conditions on any of the variables that choose the branch.

    Raises
    ------
    NoClosedInverseError
        Where the rules could not be solved in closed form, or what came of it was not proved.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p, Q, P, f = symbols("q p Q P f", real=True)
    >>> generated_transformation(GeneratingFunction(2, q*P + f*q**2/2, q, p, Q, P)).images
    (q, -f*q + p)
    """
    _is_generating(F)
    return _solved(F, (*F.q, *F.p), (*F.new_q, *F.new_p), as_domain(domain, F.domain))


def generated_inverse(F: GeneratingFunction, domain: Domain | None = None) -> CanonicalTransformation:
    """Return the inverse map q(Q, P, t), p(Q, P, t) of the one that F generates, proved by the rules.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p, Q, P, f = symbols("q p Q P f", real=True)
    >>> generated_inverse(GeneratingFunction(2, q*P + f*q**2/2, q, p, Q, P)).images
    (Q, P + Q*f)
    """
    _is_generating(F)
    return _solved(F, (*F.new_q, *F.new_p), (*F.q, *F.p), as_domain(domain, F.domain))


def _is_generating(F: GeneratingFunction) -> None:
    given_kind(F, GeneratingFunction, "F", "write GeneratingFunction(2, q*P, q, p, Q, P)")


def implicit_map(F: GeneratingFunction) -> ImplicitTransformation:
    """Return the map that F generates as its rules stand, to be tested and evaluated where it has no formula.

    Examples
    --------
    >>> from sympy import cos, symbols
    >>> q, p, Q, P, h = symbols("q p Q P h", real=True)
    >>> T = implicit_map(GeneratingFunction(2, q*P + h*(P**2/2 - cos(q)*cos(P)), q, p, Q, P))
    >>> T.is_canonical().status.name
    'HOLDS'
    """
    equations = tuple(rule.variable - rule.value for rule in F.rules)
    return ImplicitTransformation(F.q, F.p, F.new_q, F.new_p, equations, F.domain, F.t)


def generated_hamiltonian(
    F: GeneratingFunction, H: Expr | Hamiltonian, domain: Domain | None = None
) -> Hamiltonian:
    """Return K(Q, P, t) = H + ∂F/∂t in the new variables, with its Hamilton's equations.

    Parameters
    ----------
    F
        The generating function.
    H
        The old Hamiltonian H(q, p, t), as an expression or as a Hamiltonian in the old variables.
    domain
        Conditions that choose the branch.

    Raises
    ------
    NoClosedInverseError
        Where the rules could not be solved in closed form, or what came of it was not proved.
    ValueError
        Where H is about other variables, pairs or another time than F.

    Examples
    --------
    The oscillator becomes K = ω P:

    >>> from sympy import cot, symbols
    >>> q, p, Q = symbols("q p Q", real=True)
    >>> m, w, P = symbols("m omega P", positive=True)
    >>> F1 = GeneratingFunction(1, m*w*q**2*cot(Q)/2, q, p, Q, P)
    >>> K = generated_hamiltonian(F1, p**2/(2*m) + m*w**2*q**2/2, Domain((Q > 0, Q < sp.pi/2, q > 0)))
    >>> from canon import vanishes
    >>> vanishes(K.H - w*P, Domain((Q > 0, Q < sp.pi/2))).status.name
    'HOLDS'
    """
    _is_generating(F)
    energy = energy_in(H, F.q, F.p, "the generating function", F.t)
    back = generated_inverse(F, domain)
    old = dict(zip((*F.q, *F.p), back.images, strict=True))
    return Hamiltonian(substitute(energy + F.F.diff(F.t), old), F.new_q, F.new_p, F.t)


def of_kind(
    F: GeneratingFunction, kind: int | Sequence[int], domain: Domain | None = None
) -> GeneratingFunction:
    """Return the generating function of another type for the same map, by Legendre's relations.

    F₂ = F₁ + Σ QP, F₃ = F₁ − Σ qp, F₄ = F₁ + Σ QP − Σ qp. Its domain is the branch on which it was proved.

    Raises
    ------
    NoClosedInverseError
        Where the rules could not be solved for the variables of the new type, or what came of it was not proved.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p, Q, P = symbols("q p Q P", real=True)
    >>> a = symbols("a", positive=True)
    >>> of_kind(GeneratingFunction(1, -a*(q - Q)**2/2, q, p, Q, P), 2).F
    P**2/(2*a) + P*q
    """
    kinds = kinds_of(kind, len(F.q))
    total = F.F
    for i, (old, new) in enumerate(zip(F.kind, kinds, strict=True)):
        total += F.new_q[i] * F.new_p[i] * ((new in (2, 4)) - (old in (2, 4)))
        total -= F.q[i] * F.p[i] * ((new in (3, 4)) - (old in (3, 4)))
    empty = GeneratingFunction(kinds, sp.S.Zero, F.q, F.p, F.new_q, F.new_p, t=F.t)
    unproved = ""
    for solved, narrowed in _expressed(F, (*empty.old, *empty.new), domain or F.domain):
        there = Domain(carried(narrowed.conditions, solved), narrowed.box)
        value = shortened(substitute(total, solved))
        found = GeneratingFunction(kinds, value, F.q, F.p, F.new_q, F.new_p, there, F.t)
        verdict = found.holds_on(_graph(F), narrowed)
        if verdict.holds:
            return found
        unproved = f"F = {value}, which was not shown to generate the same map: {_why(verdict)}"
    raise _not_expressed((*empty.old, *empty.new), unproved)


def _not_expressed(wanted: tuple[Symbol, ...], unproved: str) -> NoClosedInverseError:
    """Tell apart that rules were not solved and that what came of it was not proved."""
    found = f"give {unproved}" if unproved else "could not be solved in closed form"
    return NoClosedInverseError(
        f"the rules for {', '.join(map(str, wanted))} {found}; give conditions that choose a branch"
    )


def _why(verdict: Verdict) -> str:
    return verdict.feedback or "; ".join(e.text for e in verdict.evidence) or verdict.status.value


def _graph(F: GeneratingFunction) -> dict[Symbol, Expr]:
    """All 4n variables as functions of those on which F depends."""
    graph: dict[Symbol, Expr] = {s: s for s in (*F.old, *F.new)}
    return {**graph, **{rule.variable: rule.value for rule in F.rules}}


def _solved(
    F: GeneratingFunction, start: tuple[Symbol, ...], target: tuple[Symbol, ...], domain: Domain
) -> CanonicalTransformation:
    n = len(F.q)
    unproved = ""
    for solved, narrowed in _expressed(F, start, domain):
        for conditions in (domain.conditions, narrowed.conditions):
            here = Domain(carried(conditions, solved), domain.box)
            verdict = F.holds_on(solved, here)
            if verdict.holds:
                images = [solved[s] for s in target]
                return CanonicalTransformation(start[:n], start[n:], images[:n], images[n:], here, F.t)
            told = ", ".join(f"{s} = {solved[s]}" for s in target)
            unproved = f"{told}, which was not shown to keep them: {_why(verdict)}"
    raise _not_expressed(target, unproved)


def _expressed(
    F: GeneratingFunction, wanted: tuple[Symbol, ...], domain: Domain
) -> Iterator[tuple[dict[Symbol, Expr], Domain]]:
    """Yield all 4n variables in terms of 2n wanted ones, and the conditions on F's own variables."""
    graph = _graph(F)
    own = (*F.old, *F.new)
    unknowns = [s for s in own if s not in wanted]
    given = [s for s in wanted if s not in own]
    meaning = {s: graph[s] for s in given}
    symbols = set(own).union(F.F.atoms(Symbol))
    domain = Domain(carried(domain.conditions, graph), domain.box)
    for witness in sorted(branch_points(symbols, meaning, domain, 12), key=far_from_principal)[:3]:
        inversion = Inversion(witness)
        found = solve_system([(graph[s], s) for s in given], unknowns, inversion)
        if found is None:
            continue
        everything = {s: substitute(f, found) for s, f in graph.items()}
        everything.update({s: s for s in wanted})
        yield everything, Domain((*domain.conditions, *inversion.conditions), domain.box)
