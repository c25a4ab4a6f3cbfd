"""Sample functions in place of arbitrary ones, with derivatives carried out."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.function import AppliedUndef, Derivative, Subs

from canon.proof.domain.declarations import said_of

if TYPE_CHECKING:
    import random
    from collections.abc import Sequence

    from sympy import Expr, Symbol

__all__ = ["evaluated", "with_example_functions"]


def with_example_functions(
    expressions: Sequence[Expr], chance: random.Random
) -> tuple[tuple[Expr, ...], dict[str, str]]:
    """Put short random polynomials for the arbitrary functions: the claim is for every such function.

    Functions declared positive, negative or of one sign get such polynomials; one of which more was said
    stays, and the expression then has no value.
    """
    applied = sorted(set[sp.Basic]().union(*(e.atoms(AppliedUndef) for e in expressions)), key=str)
    chosen: dict[str, str] = {}
    replaced = [_by_symbols(e) for e in expressions]
    for function, sample in {a.func: a for a in applied}.items():
        places = sp.symbols(f"_u0:{len(sample.args)}", real=True)
        polynomial = _as_declared(_random_polynomial(places, chance), sample)
        if polynomial is None:
            continue
        shown = polynomial.xreplace(dict(zip(places, sample.args, strict=True)))
        chosen[str(sample)] = str(shown)
        body = sp.Lambda(places, polynomial)
        replaced = [cast("Expr", e.replace(function, body)) for e in replaced]
    return tuple(evaluated(e) for e in replaced), chosen


def _by_symbols(expr: Expr) -> Expr:
    """Write ∂U(r(x))/∂r(x) as U′ at the place r(x): there is no derivative by an example of r."""
    if not expr.has(Derivative):
        return expr
    standing = expr.replace(
        lambda e: isinstance(e, Derivative) and not all(v.is_Symbol for v in _by(e)), _at_places
    )
    return cast("Expr", standing)


def _at_places(derivative: Derivative) -> Expr:
    places = {v: sp.Dummy() for v in sorted(_by(derivative), key=str) if not isinstance(v, sp.Symbol)}
    by = [(places.get(v, v), n) for v, n in cast("Sequence[tuple[Expr, Expr]]", derivative.variable_count)]
    return Subs(Derivative(derivative.expr.xreplace(places), *by), tuple(places.values()), tuple(places))


def _by(derivative: Derivative) -> set[sp.Basic]:
    """Return what a derivative is by."""
    return set(cast("tuple[sp.Basic, ...]", derivative.variables))


def _random_polynomial(places: tuple[Symbol, ...], chance: random.Random) -> Expr:
    terms: list[Expr] = [sp.Rational(chance.randint(1, 9), 4)]
    for place in places:
        terms.extend(
            sp.Rational(chance.randint(-6, 6), chance.choice((1, 2, 3))) * place**k for k in (1, 2, 3)
        )
    if len(places) > 1:
        terms.append(chance.randint(1, 5) * sp.Mul(*places))
        terms.append(chance.randint(1, 5) * places[0] ** 2 * places[-1])
    return sp.Add(*terms)


def _as_declared(polynomial: Expr, function: sp.Basic) -> Expr | None:
    """Return an example of which is true what was declared of a function."""
    said = said_of(function)
    if not said:
        return polynomial
    if not said.keys() <= _SIGNS or said.get("zero"):
        return None
    positive = polynomial**2 + sp.Rational(1, 4)
    return -positive if said.get("negative") or said.get("nonpositive") else positive


_SIGNS = {"positive", "negative", "nonnegative", "nonpositive", "zero", "nonzero"}


def evaluated(expr: Expr) -> Expr:
    """Carry out the derivatives of what is not an arbitrary function."""
    if not expr.has(Derivative, Subs):
        return expr
    done = expr.replace(
        lambda e: isinstance(e, Derivative | Subs) and not e.has(AppliedUndef), lambda e: e.doit()
    )
    return cast("Expr", done)
