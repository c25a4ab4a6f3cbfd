"""Validity of actions in closed form: where the motions are bounded, and of the kind that a formula is for.

A formula is certified on some tori and holds for all that are continued into each other. Of most known integrals there
is one kind of bounded motion; a pendulum swings or turns over, a double well has motions on one side and over both.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr

from canon.mechanics.integrable.closed_form.actions_in_closed_form import (
    about_its_kink,
    in_reciprocals,
    recognised,
    terms_in,
)
from canon.mechanics.integrable.closed_form.elliptic_coordinates import sides_of_roots
from canon.mechanics.integrable.cycles import CycleKind

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from sympy import Symbol

    from canon.mechanics.integrable.actions import ActionVariables

__all__ = ["Validity", "validity"]

_BELOW_ZERO = ("Kepler", "Morse", "Pöschl–Teller", "isochrone")
"""Integrals of motions that are bounded exactly where the constant term of p² is negative."""


@dataclass(frozen=True)
class Validity:
    """What is positive, as functions of the constants, where formulas of actions are valid.

    Parameters
    ----------
    bounded
        Where motions are bounded: elsewhere there is no action.
    kind
        Where bounded motions are of the kind of the formulas: elsewhere the actions are others.
    """

    bounded: tuple[Expr, ...]
    kind: tuple[Expr, ...]


def validity(torus: ActionVariables) -> Validity:
    """Return where the recognised actions of a torus are valid.

    Examples
    --------
    >>> from canon.mechanics import Hamiltonian, action_variables, hamilton_jacobi
    >>> q, p = sp.symbols("q p", real=True)
    >>> pendulum = hamilton_jacobi(Hamiltonian(p**2/2 - sp.cos(q), q, p))
    >>> [validity(action_variables(pendulum, {q: 0, p: speed})).kind for speed in (1, 3)]
    [(2 - 2*E,), (2*E - 2,)]
    """
    bounded, kind = list[Expr](), list[Expr]()
    for momentum, cycle in zip(torus.integral.momenta, torus.cycles, strict=True):
        found = recognised(momentum, cycle, torus.values)
        if found is None or cycle.kind is CycleKind.IGNORABLE:
            continue
        if momentum.square is None:
            bounded += _turning(momentum.shift, momentum.q)
            continue
        terms = terms_in(in_reciprocals(about_its_kink(momentum.square, momentum.q)), momentum.q)
        A = terms.pop(sp.S.One, sp.S.Zero)
        bounded += _bounded(found[1], A, terms, momentum.q)
        kind += _of_the_kind(found[1], A, terms, momentum.q)
        if found[1] == "elliptic coordinates":
            kind += sides_of_roots(A, terms, momentum.q, torus.values)
    return Validity(*(tuple(dict.fromkeys(f for f in fs if not f.is_positive)) for fs in (bounded, kind)))


def _bounded(name: str, A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Iterator[Expr]:
    if name in _BELOW_ZERO:
        yield -A
    elif name in ("oscillator", "radial oscillator"):
        yield -terms[q**2]
    elif name == "soft quartic well":  # inside its two hills, whose height is where the zeros of p² meet
        yield A
        yield terms[q**2] ** 2 - 4 * A * terms[q**4]
    yield from (-c for c in _walls(name, terms, q) if not c.is_nonpositive)


def _walls(name: str, terms: Mapping[Expr, Expr], q: Symbol) -> Iterator[Expr]:
    """Yield the coefficients in p² of what keeps the coordinate off its singular or distant places, if negative."""
    match name:
        case "Kepler" | "isochrone" | "radial oscillator":
            yield terms[q**-2]
        case "polar angle" | "even power":
            yield from terms.values()
        case "Morse":
            rates = {cast("Expr", f.args[0]).diff(q): c for f, c in terms.items()}
            yield from (c for rate, c in rates.items() if rate / 2 in rates)
        case _:
            return


def _turning(p: Expr, q: Symbol) -> Iterator[Expr]:
    """Yield A² − B² of p = N/(A + B cos q), whose rate A + B cos q vanishes nowhere then."""
    below = sp.fraction(sp.together(p))[1]
    if below.has(q):
        terms = terms_in(below, q)
        A = terms.pop(sp.S.One, sp.S.Zero)
        yield A**2 - sp.Add(*terms.values()) ** 2


def _of_the_kind(name: str, A: Expr, terms: Mapping[Expr, Expr], q: Symbol) -> Iterator[Expr]:
    """Yield what tells the motions of a formula from others: the sides of a separatrix.

    √(A + B cos q) has zeros where A < |B|. With C < 0 the motion over both wells of A + B q² + C q⁴ passes q = 0, so
    that A > 0; without wells, B ≤ 0, there is no other.
    """
    match name:
        case "pendulum, libration":
            yield sp.Abs(terms[sp.cos(q)]) - A
        case "pendulum, rotation":
            yield A - sp.Abs(terms[sp.cos(q)])
        case "double well, on one side":
            yield -A
        case "quartic well" if not terms[q**2].is_nonpositive:
            yield A
        case _:
            return
