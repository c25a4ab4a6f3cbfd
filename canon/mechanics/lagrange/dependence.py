"""Dependent constraints: which rows, by which combination, and whether they contradict each other.

Rows aₐ·q̇ + a₀ₐ = 0 depend on one another where Σ cₐ aₐ = 0 for some c(q, t). Then either Σ cₐ a₀ₐ = 0 and a row is
redundant, its multiplier undetermined, or the rows contradict one another. For f(q, t) = 0 the values decide.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.all_vanish import differ
from canon.mechanics.algebra.linear import eliminate
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.kinks import vanishes_off_kinks
from canon.proof.trees.polynomial import polynomial_factors

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["DependentConstraintsError", "check_independent"]


class DependentConstraintsError(ValueError):
    """Raised for constraints that are redundant or contradictory.

    Parameters
    ----------
    message
        What was wrong and what to do instead.
    rows
        The numbers of the constraints that depend on one another, counted from 1.
    combination
        The coefficients c of all rows with Σ cₐ aₐ = 0.
    contradictory
        True, where they cannot hold together; False, where one follows from the others; None where that
        was not decided.
    """

    def __init__(
        self, message: str, rows: tuple[int, ...], combination: tuple[Expr, ...], contradictory: bool | None
    ) -> None:
        super().__init__(message)
        self.rows = rows
        self.combination = combination
        self.contradictory = contradictory

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes this error again, in another process too."""
        return type(self), (str(self), self.rows, self.combination, self.contradictory)


def check_independent(
    directions: sp.MatrixBase,
    constraints: Sequence[Expr],
    rests: Sequence[Expr],
    holonomic: int,
    moving: Sequence[Symbol],
    domain: Domain | None = None,
) -> None:
    """Raise an error that names the rows, where the directions of constraints depend on one another.

    Parameters
    ----------
    directions
        The rows aₐ.
    constraints
        The constraints as the user gave them.
    rests
        a₀ₐ, the part of each constraint's rate that holds no velocity.
    holonomic
        How many of them, at the front, are functions f(q, t).
    moving
        Coordinates and time.
    domain
        Where the constraints are meant.

    Raises
    ------
    DependentConstraintsError
        With the rows, the combination, and whether they contradict one another.
    """
    factors = [_factors(a, f) for a, f in enumerate(constraints[:holonomic], 1)]
    for c in eliminate(directions.T, domain=domain).null_directions:
        rows = tuple(a + 1 for a, factor in enumerate(c) if factor != 0)
        contradictory = _contradict(c, constraints, rests, holonomic, moving, domain)
        named = " and ".join(f"constraint {a} ({constraints[a - 1]} = 0)" for a in rows)
        sum_ = " + ".join(f"({c[a - 1]})·({a})" for a in rows)
        if len(rows) == 1:
            what, remedy = "restricts no velocity", "leave it out, or correct it"
        elif contradictory:
            what, remedy = f"contradict one another, as {sum_} shows", "correct one of them"
        elif contradictory is None:
            what, remedy = f"depend on one another: {sum_} holds no velocity", "leave one of them out"
        else:
            what, remedy = f"depend on one another: {sum_} vanishes", "leave one of them out"
        raise DependentConstraintsError(f"{named} {what}; {remedy}", rows, c, contradictory)
    _refuse_multiples(constraints, [[h for h in each if h.has(*moving)] for each in factors])


def _factors(a: int, f: Expr) -> list[Expr]:
    """Return the factors of f, and refuse hᵏ, whose gradient vanishes where f does: no reaction follows from it."""
    if f.has(sp.Piecewise):  # SymPy factors no polynomials in these
        return []
    factors = polynomial_factors(f)
    repeated = [h for h, power in factors if power > 1]
    if repeated:
        raise DependentConstraintsError(
            f"constraint {a} ({f} = 0) holds a power, so its gradient vanishes where it does; write "
            f"{sp.Mul(*(h for h, _ in factors))} = 0",
            (a,),
            (),
            contradictory=None,
        )
    return [h for h, _ in factors]


def _refuse_multiples(constraints: Sequence[Expr], factors: Sequence[Sequence[Expr]]) -> None:
    """Refuse f = h k beside h = 0, from which it follows: their gradients are parallel where both hold, and only there.

    Parameters
    ----------
    constraints
        The constraints as the user gave them, holonomic ones first.
    factors
        The factors of each holonomic one that change with the motion.
    """
    for a, whole in enumerate(factors):
        for b, parts in enumerate(factors):
            if a != b and len(whole) == 1 and {whole[0], -whole[0]} & {*parts}:
                raise DependentConstraintsError(
                    f"constraint {b + 1} ({constraints[b]} = 0) follows from constraint {a + 1} "
                    f"({constraints[a]} = 0), a factor of it; leave it out",
                    (a + 1, b + 1),
                    (),
                    contradictory=False,
                )


def _contradict(
    c: tuple[Expr, ...],
    constraints: Sequence[Expr],
    rests: Sequence[Expr],
    holonomic: int,
    moving: Sequence[Symbol],
    domain: Domain | None,
) -> bool | None:
    rest = sp.Add(*(factor * a0 for factor, a0 in zip(c, rests, strict=True)))
    if differ(rest, domain):
        return True
    if all(factor == 0 for factor in c[holonomic:]):
        if any(factor.has(*moving) for factor in c):
            return None
        value = sp.Add(*(factor * f for factor, f in zip(c, constraints, strict=True)))
        return _undecided_as_none(value, domain)
    if any(factor != 0 for factor in c[:holonomic]):
        return None
    return False


def _undecided_as_none(value: Expr, domain: Domain | None) -> bool | None:
    verdict = vanishes_off_kinks(value, as_domain(domain))
    return None if verdict.undecided else verdict.fails
