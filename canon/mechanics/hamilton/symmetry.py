"""Symmetries and constants of motion: Noether's theorem, gauge terms, equivalent Lagrangians.

A point symmetry q → q + ε ξ(q, t), t → t + ε τ(q, t) that changes L dt by dK has the constant of motion
Σ p ξ − E τ − K, with p = ∂L/∂q̇ and E = Σ q̇ p − L (E. Noether 1918; sign conventions of
docs/conventions.md).
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.symbol import acceleration, momentum, time_derivative, velocity
from canon.expression.symbols.user_input import all_of, by_symbol, given_kind, listed
from canon.mechanics.algebra.all_vanish import all_vanish, having_values
from canon.mechanics.algebra.dynamicsymbols import coordinate, plain, plain_all
from canon.mechanics.algebra.potential import potential
from canon.mechanics.algebra.substitution import exchanged, refuse_unordered
from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.continuity.continuity import continuity
from canon.proof.continuity.smooth import PIECED
from canon.proof.continuity.turns_of_angles import continuity_but_for_turns
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import Verdict, all_hold
from canon.proof.equivalence import equivalent_equations

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = [
    "gauge_function",
    "have_same_equations",
    "is_constant_of_motion",
    "is_gauge_equivalent",
    "is_symmetry",
    "noether_charge",
    "poissons_theorem",
]


def is_constant_of_motion(
    I: Expr, system: Hamiltonian | Lagrangian, domain: Domain | None = None, budget: float = 10.0
) -> Verdict:
    """Tell whether dI/dt = 0 along every motion, ∂I/∂t included.

    Parameters
    ----------
    I
        A function of q, p, t for a Hamiltonian system, of q, q̇, t for a Lagrangian one, where a momentum
        ``x.momentum`` stands for ∂L/∂ẋ.
    system
        The system.
    domain
        Where the claim is meant.
    budget
        Seconds.

    Examples
    --------
    >>> from canon import Hamiltonian
    >>> from sympy import symbols
    >>> x, y, a, b = symbols("x y a b", real=True)
    >>> H = Hamiltonian((a**2 + b**2)/2 - 1/(x**2 + y**2), (x, y), (a, b))
    >>> is_constant_of_motion(x*b - y*a, H).status.name, is_constant_of_motion(x*b + y*a, H).status.name
    ('HOLDS', 'FAILS')
    """
    given_kind(system, (Hamiltonian, Lagrangian), "the system", "the function comes first, then the system")
    if isinstance(system, Hamiltonian):
        state = (*system.q, *system.p)
        function = plain(I, state, system.t)
        rate = system.rate(function)
    else:
        state = (*system.q, *map(velocity, system.q))
        momenta = dict(zip(map(momentum, system.q), system.momenta, strict=True))
        function = exchanged(plain(I, system.q, system.t), momenta)
        found = dict(zip(map(acceleration, system.q), system.accelerations, strict=True))
        rate = exchanged(time_derivative(function, system.q, system.t), found)
    everywhere, moving = as_domain(domain), (*state, system.t)
    verdict = all_vanish([("dI/dt = 0", rate)], f"{I} is a constant of motion", domain, budget)
    given = (system.H if isinstance(system, Hamiltonian) else system.L,)
    verdict = having_values(verdict, {str(I): function}, given, domain)
    if not verdict.holds:
        return verdict
    steady = continuity_but_for_turns(function, moving, everywhere, name=str(I), given=given)
    return all_hold([verdict, steady], verdict.question)


def _and_continuous(
    verdict: Verdict,
    f: Expr,
    variables: Sequence[Symbol],
    domain: Domain,
    name: str,
    given: Sequence[Expr],
) -> Verdict:
    """Return the verdict on a function that was tested by its derivatives, once it is seen that it does not jump."""
    if not verdict.holds:
        return verdict
    return all_hold([verdict, continuity(f, variables, domain, name=name, given=given)], verdict.question)


def poissons_theorem(
    I: Expr, K: Expr, hamiltonian: Hamiltonian, domain: Domain | None = None
) -> tuple[Expr, Verdict]:
    """Return {I, K} and whether it is a constant of motion, as it must be where I and K are.

    Examples
    --------
    >>> from canon import Hamiltonian
    >>> from sympy import symbols
    >>> x, y, a, b = symbols("x y a b", real=True)
    >>> free = Hamiltonian((a**2 + b**2)/2, (x, y), (a, b))
    >>> poissons_theorem(x*b - y*a, a, free)[0]
    b
    """
    bracket = poisson_bracket(I, K, hamiltonian.q, hamiltonian.p)
    return bracket, is_constant_of_motion(bracket, hamiltonian, domain)


def noether_charge(
    lagrangian: Lagrangian,
    xi: Sequence[Expr] | Mapping[Symbol, Expr],
    tau: Expr = sp.S.Zero,
    K: Expr = sp.S.Zero,
) -> Expr:
    """Return Σ p ξ − E τ − K, constant along the motion where ξ, τ, K make a symmetry.

    Parameters
    ----------
    lagrangian
        The system.
    xi
        Displacements of the coordinates ξ(q, t), in their order or by coordinate, ``{x: -y, y: x}``.
    tau
        Displacement of the time τ(q, t).
    K
        The function K(q, t) by whose total derivative L dt changes.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> x, y = coordinates("x y")
    >>> noether_charge(Lagrangian((x.dot**2 + y.dot**2)/2, [x, y]), [-y, x])
    x*y_dot - x_dot*y
    """
    given_kind(lagrangian, Lagrangian, "the system", "the Lagrangian comes first, then the displacements")
    moves, delay, gain = _displacements(lagrangian, xi, tau, K)
    terms = (p * a for p, a in zip(lagrangian.momenta, moves, strict=True))
    return sp.Add(*terms, -delay * lagrangian.jacobi_energy, -gain)


def is_symmetry(
    lagrangian: Lagrangian,
    xi: Sequence[Expr] | Mapping[Symbol, Expr],
    tau: Expr = sp.S.Zero,
    K: Expr = sp.S.Zero,
    domain: Domain | None = None,
) -> Verdict:
    """Tell whether ξ, τ change L dt by dK: ξ·L_q + (ξ̇ − q̇ τ̇)·L_v + τ L_t + τ̇ L = K̇ identically.

    ξ is given in the order of the coordinates, or by coordinate. What forces without a potential do along the
    displacements, Q·(ξ − q̇ τ), is added to the change of L.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, time as t
    >>> x = coordinates("x")
    >>> boost = is_symmetry(Lagrangian(x.dot**2/2, [x]), [t], K=x)
    >>> boost.status.name
    'HOLDS'
    """
    L, q, t = lagrangian.L, lagrangian.q, lagrangian.t
    moves, delay, gain = _displacements(lagrangian, xi, tau, K)
    delay_dot = time_derivative(delay, q, t)
    change = [delay * L.diff(t), delay_dot * L, -time_derivative(gain, q, t)]
    for s, a in zip(q, moves, strict=True):
        v = velocity(s)
        change += [a * L.diff(s), (time_derivative(a, q, t) - v * delay_dot) * L.diff(v)]
    for s, a, Q in zip(q, moves, lagrangian.forces, strict=False):  # none are given, or one each
        change.append(Q * (a - velocity(s) * delay))
    verdict = all_vanish(
        [("the change of L dt is dK", sp.Add(*change))], "this is a symmetry of the action", domain
    )
    return _and_continuous(verdict, gain, (*q, t), as_domain(domain), "K", (L,))


def is_gauge_equivalent(
    first: Lagrangian, second: Lagrangian, F: Expr | None = None, domain: Domain | None = None
) -> Verdict:
    """Tell whether L₂ − L₁ = dF/dt for the given F(q, t), or for some F.

    Without F: the difference is affine, A·q̇ + B, and A·dq + B dt is closed (on a simply connected domain that
    makes it exact).

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> x, y = coordinates("x y")
    >>> free = Lagrangian((x.dot**2 + y.dot**2)/2, [x, y])
    >>> is_gauge_equivalent(free, Lagrangian(free.L + x*y.dot + y*x.dot, [x, y])).status.name
    'HOLDS'
    >>> is_gauge_equivalent(free, Lagrangian(free.L + x*y.dot - y*x.dot, [x, y])).status.name
    'FAILS'
    """
    q, t = _same_coordinates(first, second)
    difference = second.L - first.L
    if F is not None:
        function = plain(F, q, t)
        gap = difference - time_derivative(function, q, t)
        verdict = all_vanish([("L2 − L1 = dF/dt", gap)], "the Lagrangians differ by dF/dt", domain)
        verdict = having_values(verdict, {"F": function, "L2": second.L}, [first.L], domain)
        return _and_continuous(verdict, function, (*q, t), as_domain(domain), "F", (first.L, second.L))
    v = [velocity(s) for s in q]
    A = [difference.diff(a) for a in v]
    curvature = [(f"∂²(L2 − L1)/∂{a}∂{b} = 0", A[i].diff(b)) for i, a in enumerate(v) for b in v[i:]]
    at_rest = dict.fromkeys(v, sp.S.Zero)
    coefficients = [*(exchanged(a, at_rest) for a in A), exchanged(difference, at_rest)]
    if any(part.has(*v) for part in difference.atoms(*PIECED)):  # slopes in pieces may be constant and differ
        affine = sp.Add(*(a * b for a, b in zip(coefficients, (*v, sp.S.One), strict=True)))
        curvature.insert(0, ("L2 − L1 is affine in the velocities", difference - affine))
    closed = [
        (f"∂A/∂{z} symmetric with ∂A/∂{y}", coefficients[i].diff(z) - coefficients[j].diff(y))
        for i, y in enumerate((*q, t))
        for j, z in enumerate((*q, t))
        if i < j
    ]
    return all_vanish([*curvature, *closed], "the Lagrangians differ by a total derivative", domain)


def gauge_function(first: Lagrangian, second: Lagrangian, domain: Domain | None = None) -> Expr | None:
    """Return F(q, t) with L₂ − L₁ = dF/dt, or None where none was found in closed form.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> x, y = coordinates("x y")
    >>> free = Lagrangian((x.dot**2 + y.dot**2)/2, [x, y])
    >>> gauge_function(free, Lagrangian(free.L + x*y.dot + y*x.dot, [x, y]))
    x*y
    >>> gauge_function(free, Lagrangian(free.L + (x*y.dot - y*x.dot)/(x**2 + y**2), [x, y]))
    atan2(y, x)
    """
    q, t = _same_coordinates(first, second)
    difference = second.L - first.L
    v = [velocity(s) for s in q]
    at_rest = dict.fromkeys(v, sp.S.Zero)
    form = [*(exchanged(difference.diff(a), at_rest) for a in v), exchanged(difference, at_rest)]
    angles = [sp.atan2(b, a) for a, b in combinations(q, 2)]
    hints = {} if all(e.is_polynomial(*q) for e in form) else {angle: angle for angle in angles}
    return potential(form, (*q, t), as_domain(domain), hints)


def have_same_equations(first: Lagrangian, second: Lagrangian, domain: Domain | None = None) -> Verdict:
    """Tell whether two Lagrangians have equivalent equations of motion.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> x = coordinates("x")
    >>> oscillator = Lagrangian(x.dot**2/2 - x**2/2, [x])
    >>> have_same_equations(oscillator, Lagrangian(x.dot**2 - x**2, [x])).status.name
    'HOLDS'
    >>> have_same_equations(oscillator, Lagrangian(x.dot**2 + x**2, [x])).status.name
    'FAILS'
    """
    q, _ = _same_coordinates(first, second)
    unknowns = [acceleration(s) for s in q]

    def verdicts() -> Iterator[Verdict]:
        yield equivalent_equations(list(first.equations), list(second.equations), unknowns, as_domain(domain))

    return all_hold(verdicts(), "both Lagrangians have the same equations of motion")


def _same_coordinates(first: Lagrangian, second: Lagrangian) -> tuple[tuple[Symbol, ...], Symbol]:
    for each in (first, second):
        given_kind(each, Lagrangian, "what is compared")
    if first.q != second.q or first.t != second.t:
        raise ValueError(
            f"the Lagrangians are about different coordinates, {first.q} and {second.q}; write both in the same"
        )
    return first.q, first.t


def _displacements(
    lagrangian: Lagrangian, xi: Sequence[Expr] | Mapping[Symbol, Expr], tau: Expr, K: Expr
) -> tuple[tuple[Expr, ...], Expr, Expr]:
    if isinstance(xi, Mapping):
        xi = _by_coordinate(xi, lagrangian.q)
    refuse_unordered(xi)
    all_of(xi, len(lagrangian.q), "xi", "coordinates")
    *moves, delay, gain = plain_all((*xi, tau, K), lagrangian.q, lagrangian.t)
    return tuple(moves), delay, gain


def _by_coordinate(xi: Mapping[Any, Expr], q: Sequence[Symbol]) -> list[Expr]:
    """Return displacements in the order of the coordinates."""
    given = {key if isinstance(key, str) else coordinate(key): move for key, move in xi.items()}
    named = by_symbol(given, q, "xi")
    if missing := [s for s in q if s not in named]:
        raise ValueError(
            f"xi has no entry for {listed(missing)}: give one for each coordinate, 0 where it stays"
        )
    return [named[s] for s in q]
