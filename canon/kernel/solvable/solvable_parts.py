"""Solvable parts of a Hamiltonian, found in it: Kepler problems, quadratic parts, planets about a star.

What is found is read off the sum that H is: kinetic energies p²/2m, attractions −k/r of pairs and of centres.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.expression.graph.number_systems import multiprecision
from canon.kernel.program.hamilton_equations import HamiltonEquations, equations
from canon.kernel.solvable.kepler_terms import Terms, UnsolvableError, flat, number, terms_of

if TYPE_CHECKING:
    from sympy import Expr

__all__ = ["Centres", "Planets", "Quadratic", "UnsolvableError", "named_part", "solvable_part"]

_DIGITS = 40

Matrix = tuple[tuple[Fraction, ...], ...]


@dataclass(frozen=True)
class Centres:
    """H₀ = Σ |p_i|²/2m_i − k_i/|q_i|: bodies attracted to the origin of their own coordinates.

    Parameters
    ----------
    bodies
        Indices of each body's coordinates.
    masses, attractions
        m_i and k_i.
    rest
        The equations of motion of H₁ = H − H₀, which is a function of q alone.
    """

    bodies: tuple[tuple[int, ...], ...]
    masses: tuple[Fraction, ...]
    attractions: tuple[Fraction, ...]
    rest: HamiltonEquations


@dataclass(frozen=True)
class Planets:
    """H = Σ |p_i|²/2m_i − Σ k_ij/|q_i − q_j|; the first body is the heaviest, the star.

    Parameters
    ----------
    bodies
        Indices of each body's coordinates, in the order of Jacobi's coordinates.
    masses
        m_i.
    attractions
        k_ij, symmetric, zero on the diagonal.
    """

    bodies: tuple[tuple[int, ...], ...]
    masses: tuple[Fraction, ...]
    attractions: Matrix


@dataclass(frozen=True)
class Quadratic:
    """H₀ quadratic in (q, p): its flow is linear.

    Parameters
    ----------
    field
        The matrix L of ẏ = Ly, y = (q, p).
    rest
        The equations of motion of H₁ = H − H₀, which is a function of q alone.
    """

    field: Matrix
    rest: HamiltonEquations


Part = Centres | Planets | Quadratic


def solvable_part(system: HamiltonEquations) -> Part:
    """Find a solvable part: planets about a star, else motion about centres, else what is quadratic in (q, p).

    Raises
    ------
    UnsolvableError
        There is none that leaves a function of q alone; the message says what is in the way.
    """
    read = terms_of(system, system.graph.to_sympy(system.hamiltonian))
    if read.pairs:
        return _planets(read)
    if read.centres:
        return _centres(system, sp.Add(*read.kinetic, *(centre.term for centre in read.centres)))
    quadratic = _quadratic_terms(system)
    if not quadratic:
        raise UnsolvableError(
            "H has no part that canon solves in closed form (Kepler's motion, planets about a star, or terms "
            "quadratic in q and p); use Splitting('kahan-li-8'), Gauss(6) or Taylor()"
        )
    return _quadratic(system, sp.Add(*quadratic))


def named_part(system: HamiltonEquations, h0: Expr, h1: Expr) -> Part:
    """Return the part that the user named, H = H₀ + H₁.

    Raises
    ------
    UnsolvableError
        H₀ + H₁ is not H; H₀ is neither quadratic nor motion about centres; or H₁ depends on p.
    """
    zero = system.node(sp.sympify(h0, strict=True), "H₀")
    one = system.node(sp.sympify(h1, strict=True), "H₁")
    _check_sum(system, zero, one)
    known: Any = system.graph.to_sympy(zero)
    if known.is_polynomial(*system.q, *system.p):
        return _quadratic(system, sp.expand(known))
    return _centres(system, known)


def _check_sum(system: HamiltonEquations, zero: int, one: int) -> None:
    """Compare H₀ + H₁ with H at three points, to nearly all digits computed."""
    digits = multiprecision(_DIGITS)
    for shift in range(1, 4):
        point = {
            s: digits.number(Fraction(7 * i + 11 * shift, 13 + i * shift))
            for i, s in enumerate(system.inputs, 1)
        }
        whole, a, b = system.graph.evaluate([system.hamiltonian, zero, one], point, digits)
        miss = abs(whole - a - b)
        if not miss <= (abs(whole) + abs(a) + abs(b)) * 10.0 ** (10 - _DIGITS):
            raise UnsolvableError(
                f"parts: H₀ + H₁ is not H (at {_shown(point)} they differ by {float(miss):.3g}); give two parts that "
                "add up to it"
            )


def _shown(point: dict[Any, Any]) -> str:
    return ", ".join(f"{s} = {float(x):.3g}" for s, x in point.items())


def _remainder(system: HamiltonEquations, part: Expr) -> HamiltonEquations:
    """Return the equations of H − H₀, which must be a function of q alone, from terms that do not cancel."""
    whole: Any = system.graph.to_sympy(system.hamiltonian)
    # Polynomials are multiplied out so that what H₀ holds goes away exactly.
    rest = sp.Add(*(flat(term, system) for term in sp.Add.make_args(whole))) - part
    rest = sp.Add(*(flat(term, system) for term in sp.Add.make_args(rest)))
    if rest.has(*system.p):
        raise UnsolvableError(
            f"what H₀ leaves of H is to be a function of q alone, a kick, but it depends on "
            f"{', '.join(sorted(str(p) for p in rest.free_symbols & set(system.p)))}; name other parts"
        )
    if rest.has(system.t):
        raise UnsolvableError(
            "H depends on t: splittings by solvable parts are for H(q, p); use Splitting('kahan-li-8')"
        )
    return equations(rest, system.q, system.p, system.t, {})


# quadratic parts -----------------------------------------------------------------------------------


def _quadratic_terms(system: HamiltonEquations) -> list[Any]:
    """Return the terms of second degree in (q, p), with H multiplied out as far as it is a polynomial."""
    whole: Any = system.graph.to_sympy(system.hamiltonian)
    spread = sp.Add(*(flat(term, system) for term in sp.Add.make_args(whole)))
    variables = (*system.q, *system.p)
    return [
        term
        for term in sp.Add.make_args(spread)
        if term.is_polynomial(*variables) and sp.Poly(term, *variables).total_degree() == 2
    ]


def _quadratic(system: HamiltonEquations, part: Any) -> Quadratic:
    variables = (*system.q, *system.p)
    polynomial = sp.Poly(part, *variables)
    if any(sum(powers) != 2 for powers in polynomial.monoms()) or not all(
        c.is_number for c in polynomial.coeffs()
    ):
        raise UnsolvableError(
            f"H₀ = {part} is a polynomial, but not of second degree in (q, p) with constant coefficients; "
            "name other parts"
        )
    n, size = len(system.q), len(variables)
    hessian = [[Fraction(0)] * size for _ in range(size)]
    for powers, coefficient in polynomial.terms():
        first, *others = (i for i, power in enumerate(powers) for _ in range(power))
        second = others[0]
        value = number(coefficient)
        hessian[first][second] += value
        hessian[second][first] += value
    field = (*hessian[n:], *([-x for x in row] for row in hessian[:n]))
    return Quadratic(tuple(map(tuple, field)), _remainder(system, part))


# Kepler's motion ------------------------------------------------------------------------------------


def _centres(system: HamiltonEquations, part: Any) -> Centres:
    read = terms_of(system, part)
    if read.pairs or read.others or not read.centres:
        raise UnsolvableError(
            f"H₀ = {part} is not Σ |p|²/2m − k/|q|, motion about centres at the origin, nor quadratic in (q, p); "
            "name other parts"
        )
    bodies, attractions = [], []
    for centre in read.centres:
        if centre.strength <= 0:
            raise UnsolvableError(
                f"the centre at {centre.axes} repels (−k/r with k = {float(centre.strength):g}): k is to be positive; "
                "name other parts"
            )
        bodies.append(tuple(system.q.index(x) for x in centre.axes))
        attractions.append(centre.strength)
    covered = [i for body in bodies for i in body]
    if sorted(covered) != list(range(len(system.q))):
        raise UnsolvableError(
            "H₀ has to move every coordinate about one centre: some q are without, or in two of them; "
            "name other parts"
        )
    masses = [read.mass_of(body) for body in bodies]
    return Centres(tuple(bodies), tuple(masses), tuple(attractions), _remainder(system, part))


def _planets(read: Terms) -> Planets:
    if read.others or read.centres:
        stray = [*read.others, *(centre.term for centre in read.centres)][0]
        raise UnsolvableError(
            f"beside kinetic energies and attractions of pairs H holds {stray}; name two parts, parts=(H0, H1)"
        )
    bodies = sorted({body for pair in read.pairs for body in (pair.first, pair.second)})
    if sorted(i for body in bodies for i in body) != list(range(len(read.system.q))):
        raise UnsolvableError(
            "the attractions of pairs do not group the coordinates into bodies; name two parts, parts=(H0, H1)"
        )
    star = max(bodies, key=read.mass_of)  # the first of equals
    places = [star, *(body for body in bodies if body != star)]
    strength = dict[frozenset[tuple[int, ...]], Fraction]()
    for pair in read.pairs:  # a pair may stand twice, as |q₁ − q₂| and |q₂ − q₁|
        both = frozenset((pair.first, pair.second))
        strength[both] = strength.get(both, Fraction(0)) + pair.strength
    table = tuple(tuple(strength.get(frozenset((a, b)), Fraction(0)) for b in places) for a in places)
    for i, row in enumerate(table[1:], start=1):
        if sum(row[:i]) <= 0:
            raise UnsolvableError(
                f"body {i} is not attracted by the star and the bodies before it: no Kepler motion; "
                "name two parts, parts=(H0, H1)"
            )
    return Planets(tuple(places), tuple(map(read.mass_of, places)), table)
