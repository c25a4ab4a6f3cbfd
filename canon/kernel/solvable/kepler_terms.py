"""Kepler terms of a Hamiltonian: p²/2m, −k/|q| and −k/|q − q′|, read off its sum."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.kernel.program.hamilton_equations import HamiltonEquations, exact_number

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Centre", "Pair", "Terms", "UnsolvableError", "flat", "number", "terms_of"]


class UnsolvableError(ValueError):
    """H has no part whose motion canon knows in closed form, or not the part that was named."""


@dataclass(frozen=True)
class Centre:
    """The attraction −k/|q| of a centre at the origin.

    Parameters
    ----------
    term
        It as it stands in H.
    axes
        The coordinates of q.
    strength
        k, negative where the centre repels.
    """

    term: Any
    axes: tuple[Any, ...]
    strength: Fraction


@dataclass(frozen=True)
class Pair:
    """The attraction −k/|q − q′| of two bodies.

    Parameters
    ----------
    first, second
        Indices of the coordinates of both: along each axis the earlier coordinate belongs to the first.
    strength
        k, negative where they repel.
    """

    first: tuple[int, ...]
    second: tuple[int, ...]
    strength: Fraction


@dataclass
class Terms:
    """The terms of a sum by what they are.

    Parameters
    ----------
    system
        Whose coordinates and momenta they hold.
    kinetic
        Kinetic energies.
    inverse_mass
        1/m by the index of the momentum.
    pairs, centres
        Attractions.
    others
        What is none of these.
    """

    system: HamiltonEquations
    kinetic: list[Any] = field(default_factory=list[Any])
    inverse_mass: dict[int, Fraction] = field(default_factory=dict[int, Fraction])
    pairs: list[Pair] = field(default_factory=list[Pair])
    centres: list[Centre] = field(default_factory=list[Centre])
    others: list[Any] = field(default_factory=list[Any])

    def mass_of(self, body: Sequence[int]) -> Fraction:
        """Return the mass of the body with these coordinates.

        Raises
        ------
        UnsolvableError
            Its kinetic energy is not |p|²/2m.
        """
        found = {self.inverse_mass.get(i, Fraction(0)) for i in body}
        if len(found) > 1 or not found or min(found) <= 0:
            names = ", ".join(str(self.system.p[i]) for i in body)
            shown = ", ".join(f"{float(x):g}" for x in sorted(found))
            raise UnsolvableError(
                f"the kinetic energy of ({names}) is to be |p|²/2m with one positive mass; 1/m is {shown}"
            )
        return 1 / found.pop()


def terms_of(system: HamiltonEquations, part: Any) -> Terms:
    """Return the terms of a part of H."""
    found = Terms(system)
    for term in (t for summand in sp.Add.make_args(part) for t in sp.Add.make_args(flat(summand, system))):
        if not (_read_kinetic(term, found) or _read_attraction(term, found)):
            found.others.append(term)
    return found


def flat(term: Any, system: HamiltonEquations) -> Any:
    """Return a term multiplied out where it is a polynomial of coordinates and momenta."""
    return sp.expand(term) if term.is_polynomial(*system.q, *system.p) else term


def number(value: Any) -> Fraction:
    """Return a coefficient as the exact number it is."""
    return exact_number(value, "a coefficient of H₀")


def _read_kinetic(term: Any, found: Terms) -> bool:
    coefficient, power = term.as_coeff_Mul()
    if not (power.is_Pow and power.exp == 2 and power.base in found.system.p):
        return False
    found.kinetic.append(term)
    found.inverse_mass[found.system.p.index(power.base)] = 2 * number(coefficient)
    return True


def _read_attraction(term: Any, found: Terms) -> bool:
    coefficient, power = term.as_coeff_Mul()
    q = found.system.q
    if not (power.is_Pow and power.exp == sp.Rational(-1, 2) and power.base.is_polynomial(*q)):
        return False
    squares = _squares(sp.Poly(power.base, *q))
    if squares is None:
        return False
    strength = -number(coefficient)
    if all(b is None for _, b in squares):
        found.centres.append(Centre(term, tuple(q[a] for a, _ in squares), strength))
        return True
    pairs = [sorted((a, b)) for a, b in squares if b is not None]
    if len(pairs) < len(squares):
        return False
    first, second = (tuple(sorted(pair[k] for pair in pairs)) for k in (0, 1))
    found.pairs.append(Pair(first, second, strength))
    return True


def _squares(form: sp.Poly) -> list[tuple[int, int | None]] | None:
    """Read Σ (a − b)² or Σ a² off a polynomial: indices (a, b), b None where there is one coordinate only."""
    seen, cross = dict[int, None](), list[tuple[int, int]]()
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
    return [*cross, *((i, None) for i in seen if i not in paired)]
