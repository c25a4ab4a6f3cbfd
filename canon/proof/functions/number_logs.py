"""Normal form of logarithms of algebraic numbers, with the relations that products of their powers imply.

φ·(φ − 1) = 1 makes log(φ − 1) = −log φ, and 2 − √3 is a power of 2 + √3: their powers with any exponent are then
powers of one number. Relations are looked for in numerical logarithms and proved by multiplying out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import arb, fmpq, fmpz_mat

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.functions.angles import imaginary_split
from canon.proof.functions.complex_parts import cartesian
from canon.proof.tower.algebraic_numbers import field_of, norm
from canon.proof.tower.factors import primes

if TYPE_CHECKING:
    from flint import acb, fmpq_mpoly

    from canon.proof.tower.forms import Forms
    from canon.proof.tower.tower import Fraction

__all__ = ["is_number", "log_by_relations", "primes_below", "turns_of_number"]

BITS = 320
SCALE = 2**200
SMALL_RESIDUE = 2**30
LARGEST_POWER = 24
MOST_LOGARITHMS = 8
LARGEST_PRIME = 10**6

POWERS_OF_TURNS = (2, 3, 4, 5, 6, 8, 10, 12)
"""Whole powers among which one is looked for that makes a complex number real."""


def is_number(n: Forms, f: Fraction) -> bool:
    """Tell whether a fraction is an algebraic number written without anything below, and not a rational."""
    return not f.den and not f.num.is_constant() and field_of(n.tower, f.num) is not None


def log_by_relations(n: Forms, g: fmpq_mpoly, log_of_prime: dict[int, Fraction]) -> Fraction | None:
    """Return log g = −(1/k) Σ kᵢ log gᵢ for a number g > 0 with gᵏ·Π gᵢ^kᵢ = 1 and positive numbers gᵢ met before.

    The relation is verified by multiplying out; all numbers being positive, their real logarithms add up to zero.
    None where there is no such relation.
    """
    t = n.tower
    known = [(p, log) for p, log in n.number_logs]
    known += [(t.constant(p), log) for p, log in log_of_prime.items()]
    if not known or len(known) > MOST_LOGARITHMS:
        return None
    numbers = [p for p, _ in known] + [g]
    relation = _relation(n, numbers)
    if relation is None:
        return None
    terms = [n.scaled(fmpq(-k, relation[-1]), log) for k, (_, log) in zip(relation, known, strict=False) if k]
    return t.sum(terms)


def primes_below(n: Forms, g: fmpq_mpoly) -> list[int]:
    """Return the primes that divide the norm of a number, and those of the numbers met before."""
    found: set[int] = set()
    for p in (g, *(p for p, _ in n.number_logs)):
        size = norm(n.tower, p)
        if size is not None and size != 0:
            found |= {prime for prime, _ in primes(abs(size)) if prime < LARGEST_PRIME}
    return sorted(found)


def _relation(n: Forms, numbers: list[fmpq_mpoly]) -> list[int] | None:
    """Return small whole kᵢ, the last not 0, with Π numberᵢ^kᵢ = 1."""
    logarithms: list[int] = []
    with precision(BITS):
        for p in numbers:
            ball = _ball(n, p)
            if ball is None or not ball.real > 0:
                return None
            whole = (ball.real.log() * SCALE).floor().mid().man_exp()
            logarithms.append(int(whole[0]) * 2 ** int(whole[1]) if int(whole[1]) >= 0 else 0)
    size = len(numbers)
    rows = [[int(i == j) for j in range(size)] + [logarithms[i]] for i in range(size)]
    for row in fmpz_mat(rows).lll().tolist():
        *powers, residue = (int(k) for k in row)
        small = abs(residue) < SMALL_RESIDUE and all(abs(k) <= LARGEST_POWER for k in powers)
        if small and powers[-1] != 0 and _holds(n, numbers, powers):
            return powers
    return None


def _holds(n: Forms, numbers: list[fmpq_mpoly], powers: list[int]) -> bool:
    t = n.tower
    sides = [t.constant(1), t.constant(1)]
    for p, k in zip(numbers, powers, strict=True):
        sides[k < 0] = t.product(sides[k < 0], t.polynomial_power(p, abs(k)))
    return t.reduce(sides[0] - sides[1]).is_zero()


def turns_of_number(n: Forms, z: Fraction) -> fmpq | None:
    """Return arg z/π for an algebraic number z with a real power zᵐ: m·arg z/π is whole, and a ball tells which."""
    t = n.tower
    if not is_number(n, z) or cartesian(n, z) is None:
        return None
    for m in POWERS_OF_TURNS:
        power = t.power(z, m)
        if not imaginary_split(n, power)[1].num.is_zero():
            continue
        with precision(BITS):
            ball = _ball(n, z.num)
            if ball is None:
                return None
            whole = (ball.arg() / arb.pi() * m).unique_fmpz()
        return None if whole is None else fmpq(int(whole), m)
    return None


def _ball(n: Forms, p: fmpq_mpoly) -> acb | None:
    try:
        return value(n.expression(p), {})
    except (NotDecided, Undefined, Unmodelled):
        return None
