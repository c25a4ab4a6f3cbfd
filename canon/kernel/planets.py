"""Parts of a Hamiltonian whose motion is known: Kepler's, quadratic ones, and planets about a star.

What is found is read off the sum that H is: kinetic energies p²/2m, attractions −k/r of pairs and of centres.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.kernel.structure import Equations, equations

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

__all__ = ["Centres", "Planets", "Quadratic", "UnsolvableError", "named_part", "solvable_part"]

Matrix = tuple[tuple[Fraction, ...], ...]


class UnsolvableError(ValueError):
    """H has no part whose motion canon knows in closed form, or not the part that was named."""


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
    rest: Equations


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
    rest: Equations


Part = Centres | Planets | Quadratic


def solvable_part(system: Equations) -> Part:
    """Find a solvable part: planets about a star, else motion about centres, else what is quadratic in (q, p).

    Raises
    ------
    UnsolvableError
        There is none that leaves a function of q alone; the message says what is in the way.
    """
    read = _Terms(system)
    if read.pairs:
        return read.planets()
    if read.centres:
        kept = [*read.kinetic, *(term for term, _, _ in read.centres)]
        return _centres(system, sp.Add(*kept))
    quadratic = _quadratic_terms(system)
    if not quadratic:
        raise UnsolvableError(
            "H has no part that canon solves in closed form (Kepler's motion, planets about a star, or terms "
            "quadratic in q and p); use Splitting('kahan-li-8'), Gauss(6) or Taylor()"
        )
    return _quadratic(system, sp.Add(*quadratic))


def named_part(system: Equations, h0: Expr, h1: Expr) -> Part:
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


def _check_sum(system: Equations, zero: int, one: int) -> None:
    from canon.expression.arithmetic import multiprecision

    digits = multiprecision(40)
    for shift in range(1, 4):
        point = {
            s: digits.number(Fraction(7 * i + 11 * shift, 13 + i * shift))
            for i, s in enumerate(system.inputs, 1)
        }
        whole, a, b = system.graph.evaluate([system.hamiltonian, zero, one], point, digits)
        if not abs(whole - a - b) <= abs(whole) * 1e-30 + (abs(a) + abs(b)) * 1e-30:
            raise UnsolvableError(
                f"parts: H₀ + H₁ is not H (at {_shown(point)} they differ by {float(whole - a - b):.3g}); give two "
                "parts that add up to it"
            )


def _shown(point: dict[Any, Any]) -> str:
    return ", ".join(f"{s} = {float(x):.3g}" for s, x in point.items())


def _remainder(system: Equations, part: Expr) -> Equations:
    """Return the equations of H − H₀, which must be a function of q alone, from terms that do not cancel."""
    whole: Any = system.graph.to_sympy(system.hamiltonian)
    # Polynomials are multiplied out so that what H₀ holds goes away exactly.
    rest = sp.Add(*(_flat(term, system) for term in sp.Add.make_args(whole))) - part
    rest = sp.Add(*(_flat(term, system) for term in sp.Add.make_args(rest)))
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


def _flat(term: Any, system: Equations) -> Any:
    return sp.expand(term) if term.is_polynomial(*system.q, *system.p) else term


# quadratic parts -----------------------------------------------------------------------------------


def _quadratic_terms(system: Equations) -> list[Any]:
    """Return the terms of second degree in (q, p), with H multiplied out as far as it is a polynomial."""
    whole: Any = system.graph.to_sympy(system.hamiltonian)
    flat = sp.Add(*(_flat(term, system) for term in sp.Add.make_args(whole)))
    variables = (*system.q, *system.p)
    return [
        term
        for term in sp.Add.make_args(flat)
        if term.is_polynomial(*variables) and sp.Poly(term, *variables).total_degree() == 2
    ]


def _quadratic(system: Equations, part: Any) -> Quadratic:
    variables = (*system.q, *system.p)
    polynomial = sp.Poly(part, *variables)
    if any(sum(powers) != 2 for powers in polynomial.monoms()) or not all(
        c.is_number for c in polynomial.coeffs()
    ):
        raise UnsolvableError(
            f"H₀ = {part} is a polynomial, but not of second degree in (q, p) with constant coefficients"
        )
    n, size = len(system.q), len(variables)
    hessian = [[Fraction(0)] * size for _ in range(size)]
    for powers, coefficient in polynomial.terms():
        first, *others = (i for i, power in enumerate(powers) for _ in range(power))
        second = others[0]
        value = _number(coefficient)
        hessian[first][second] += value
        hessian[second][first] += value
    field = (*hessian[n:], *([-x for x in row] for row in hessian[:n]))
    return Quadratic(tuple(map(tuple, field)), _remainder(system, part))


def _number(value: Any) -> Fraction:
    from canon.kernel.structure import exact

    return exact(value, "a coefficient of H₀")


# Kepler's motion ------------------------------------------------------------------------------------


def _centres(system: Equations, part: Any) -> Centres:
    read = _Terms(system, part)
    if read.pairs or read.others or not read.centres:
        raise UnsolvableError(
            f"H₀ = {part} is not Σ |p|²/2m − k/|q|, motion about centres at the origin, nor quadratic in (q, p)"
        )
    bodies, attractions = [], []
    for _, axes, strength in read.centres:
        if strength <= 0:
            raise UnsolvableError(
                f"the centre at {axes} repels (−k/r with k = {float(strength):g}): k is to be positive"
            )
        bodies.append(tuple(system.q.index(x) for x in axes))
        attractions.append(strength)
    covered = [i for body in bodies for i in body]
    if sorted(covered) != list(range(len(system.q))):
        raise UnsolvableError(
            "H₀ has to move every coordinate about one centre: some q are without, or in two of them"
        )
    masses = [read.mass_of(body) for body in bodies]
    return Centres(tuple(bodies), tuple(masses), tuple(attractions), _remainder(system, part))


class _Terms:
    """The terms of a sum: kinetic energies, attractions of pairs and of centres, and others."""

    def __init__(self, system: Equations, part: Any = None) -> None:
        self.system = system
        whole: Any = system.graph.to_sympy(system.hamiltonian) if part is None else part
        self.kinetic: list[Any] = []
        self.inverse_mass: dict[int, Fraction] = {}
        self.pairs: list[tuple[tuple[tuple[Any, Any], ...], Fraction]] = []
        self.centres: list[tuple[Any, tuple[Any, ...], Fraction]] = []
        self.others: list[Any] = []
        terms = [t for term in sp.Add.make_args(whole) for t in sp.Add.make_args(_flat(term, system))]
        for term in terms:
            if not (self._read_kinetic(term) or self._read_attraction(term)):
                self.others.append(term)

    def _read_kinetic(self, term: Any) -> bool:
        coefficient, power = term.as_coeff_Mul()
        if not (power.is_Pow and power.exp == 2 and power.base in self.system.p):
            return False
        self.kinetic.append(term)
        self.inverse_mass[self.system.p.index(power.base)] = 2 * _number(coefficient)
        return True

    def _read_attraction(self, term: Any) -> bool:
        coefficient, power = term.as_coeff_Mul()
        if not (
            power.is_Pow and power.exp == sp.Rational(-1, 2) and power.base.is_polynomial(*self.system.q)
        ):
            return False
        form = sp.Poly(power.base, *self.system.q)
        squares = _squares(form)
        if squares is None:
            return False
        strength = -_number(coefficient)
        if all(b is None for _, b in squares):
            self.centres.append((term, tuple(a for a, _ in squares), strength))
            return True
        if any(b is None for _, b in squares):
            return False
        self.pairs.append((tuple((a, b) for a, b in squares), strength))
        return True

    def mass_of(self, body: Sequence[int]) -> Fraction:
        found = {self.inverse_mass.get(i, Fraction(0)) for i in body}
        if len(found) > 1 or not found or min(found) <= 0:
            names = ", ".join(str(self.system.p[i]) for i in body)
            shown = ", ".join(f"{float(x):g}" for x in sorted(found))
            raise UnsolvableError(
                f"the kinetic energy of ({names}) is to be |p|²/2m with one positive mass; 1/m is {shown}"
            )
        return 1 / found.pop()

    def planets(self) -> Planets:
        if self.others or self.centres:
            raise UnsolvableError(
                f"beside kinetic energies and attractions of pairs H holds {self._stray()}; "
                "name two parts, parts=(H0, H1)"
            )
        bodies = sorted({body for axes, _ in self.pairs for body in _two_bodies(axes, self.system)})
        if sorted(i for body in bodies for i in body) != list(range(len(self.system.q))):
            raise UnsolvableError("the attractions of pairs do not group the coordinates into bodies")
        masses = [self.mass_of(body) for body in bodies]
        order = sorted(range(len(bodies)), key=lambda i: (-masses[i] if i == _heaviest(masses) else 0, i))
        strength = {frozenset(_two_bodies(axes, self.system)): k for axes, k in self.pairs}
        places = [bodies[i] for i in order]
        table = tuple(
            tuple(strength.get(frozenset((a, b)), Fraction(0)) if a != b else Fraction(0) for b in places)
            for a in places
        )
        for i, row in enumerate(table[1:], start=1):
            if sum(row[:i]) <= 0:
                raise UnsolvableError(
                    f"body {i} is not attracted by the star and the bodies before it: no Kepler motion"
                )
        return Planets(tuple(places), tuple(masses[i] for i in order), table)

    def _stray(self) -> str:
        return str([*self.others, *(term for term, _, _ in self.centres)][0])


def _heaviest(masses: Sequence[Fraction]) -> int:
    return max(range(len(masses)), key=lambda i: (masses[i], -i))


def _squares(form: Any) -> list[tuple[Any, Any]] | None:
    """Read Σ (a − b)² or Σ a² off a polynomial: the pairs (a, b), b None where there is one coordinate only."""
    seen, cross = dict[int, Any](), list[tuple[int, int]]()
    for powers, coefficient in form.terms():
        places = [i for i, power in enumerate(powers) for _ in range(power)]
        if len(places) != 2:
            return None
        first, second = places
        if first == second:
            if coefficient != 1:
                return None
            seen[first] = None
        elif coefficient == -2:
            cross.append((first, second))
        else:
            return None
    paired = [i for pair in cross for i in pair]
    if len(set(paired)) != len(paired) or not set(paired) <= set(seen):
        return None
    found = [(form.gens[a], form.gens[b]) for a, b in cross]
    return found + [(form.gens[i], None) for i in seen if i not in paired]


def _two_bodies(
    axes: Sequence[tuple[Any, Any]], system: Equations
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the two bodies of a distance: of each axis the earlier coordinate belongs to the first."""
    places = [sorted((system.q.index(a), system.q.index(b))) for a, b in axes]
    return tuple(sorted(a for a, _ in places)), tuple(sorted(b for _, b in places))
