"""Parameters that the domain of a claim ties to one another: their values decide whether frequencies are resonant."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.mechanics.algebra.substitution import substitute
from canon.proof.domain.pinched_bounds import with_pinched_bounds
from canon.proof.domain.relations import parts_of
from canon.proof.domain.verdict import Undecided
from canon.proof.trees.affine_form import is_affine
from canon.proof.trees.sympy_types import free_symbols

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from canon.exercise.sheet.reading import Reading

__all__ = ["with_tied_values"]


def with_tied_values(reading: Reading, energy: Expr) -> Expr:
    """Return H with the values that the domain gives to parameters: whether frequencies are resonant depends on them.

    Raises
    ------
    Undecided
        Where it ties parameters of several frequencies otherwise.
    """
    state = {*reading.symbols("q"), *reading.symbols("p")}
    ties = [
        cast("Expr", tie.lhs) - cast("Expr", tie.rhs)
        for tie in parts_of(with_pinched_bounds(reading.domain).conditions)
        if isinstance(tie, sp.Eq) and not free_symbols(tie) & state
    ]
    while ties:
        tie = ties.pop(0)
        value = _value_of(tie)
        if value is None:
            if free_symbols(tie) & free_symbols(energy) and len(reading.symbols("q")) > 1:
                raise Undecided(f"the domain ties parameters, {tie} = 0: write their values into H")
            continue
        energy, ties = substitute(energy, value), [substitute(other, value) for other in ties]
    return energy


def _value_of(tie: Expr) -> dict[Symbol, Expr] | None:
    """Return the value that an equation gives to one of its names, alone or as a square of what is positive."""
    for name in sorted(free_symbols(tie), key=str):
        slope = tie.diff(name)
        if slope.is_nonzero and not slope.has(name) and is_affine(tie, [name]):
            return {name: sp.cancel(name - tie / slope)}
        of_square = tie.diff(name, 2) / 2
        if name.is_positive and of_square.is_nonzero and not of_square.has(name):
            rest = sp.expand(tie - of_square * name**2)
            if not rest.has(name):
                return {name: sp.sqrt(-rest / of_square)}
    return None
