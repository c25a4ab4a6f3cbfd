"""Single equations in which the unknown occurs several times, solved as polynomials in one of its functions.

An equation in x, √x and the like, or in sin x and cos x, is a polynomial in those functions; the relations
among them eliminate all but one, whose roots are found by factors that are linear, quadratic or binomial.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.substitution import MOST_TERMS, exchanged, size, terms_if_expanded
from canon.proof.trees.polynomial_roots import low_degree_roots

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

__all__ = ["generator_values"]


def generator_values(equation: Expr, x: Symbol) -> Iterator[tuple[Expr, Expr, tuple[Expr, ...]]]:
    """Yield functions of x with the values that the equation may give them.

    Parameters
    ----------
    equation
        An expression that is to vanish.
    x
        The unknown.

    Yields
    ------
    tuple
        A function of x, a value without x, and the expressions whose signs tell this root from its partners.

    Examples
    --------
    >>> from sympy import symbols, sqrt
    >>> x, y = symbols("x y", positive=True)
    >>> [(str(f), str(value)) for f, value, _ in generator_values(x + sqrt(x) - y, x)][0]
    ('x', 'y + sqrt(4*y + 1)/2 + 1/2')
    """
    equation = _in_few_functions(equation, x)
    kernels = _kernels(equation, x)
    names: dict[Expr, Symbol] = {kernel: sp.Dummy() for kernel in kernels}
    back: dict[Symbol, Expr] = {name: kernel for kernel, name in names.items()}
    polynomial = sp.numer(sp.together(exchanged(equation, names)))
    for kernel in sorted(kernels, key=lambda k: (k != x, size(k))):
        reduced = _eliminated(polynomial, kernel, names, x)
        if reduced is None or terms_if_expanded(reduced) > MOST_TERMS:
            continue
        for root, signs in low_degree_roots(reduced, names[kernel]):
            value = exchanged(root, back)
            if not value.has(x):
                yield kernel, value, tuple(exchanged(sign, back) for sign in signs)


def _eliminated(polynomial: Expr, kept: Expr, names: Mapping[Expr, Symbol], x: Symbol) -> Expr | None:
    """Eliminate all generators but one by their relations with it: s² + c² = 1, r² = radicand, xⁿ.

    Functions without x are named meanwhile: SymPy eliminates among polynomials over the integers in a moment, among
    polynomials over functions it may take minutes.
    """
    u, constants = names[kept], dict[Expr, Symbol]()
    for kernel, name in names.items():
        if kernel == kept or not polynomial.has(name):
            continue
        relation = _relation(kernel, name, kept, u, names)
        if relation is None or relation.has(x) or _is_large(polynomial, relation, name):
            return None
        polynomial = cast(
            "Expr", sp.resultant(_named(polynomial, constants), _named(relation, constants), name)
        )
    polynomial = exchanged(polynomial, {name: f for f, name in constants.items()})
    return polynomial if polynomial.has(u) else None


def _is_large(polynomial: Expr, relation: Expr, name: Symbol) -> bool:
    """Whether the resultant, a product of the polynomial at all roots of the relation, may have many terms."""
    return terms_if_expanded(polynomial) ** sp.Poly(relation, name).degree() > MOST_TERMS


def _named(f: Expr, constants: dict[Expr, Symbol]) -> Expr:
    """Return f with a symbol for each function that stands in its sums, products and whole powers."""
    return exchanged(f, {g: constants.setdefault(g, sp.Dummy()) for g in _functions(f)})


def _functions(f: Expr) -> set[Expr]:
    if f.is_Add or f.is_Mul:
        return {g for part in f.args for g in _functions(cast("Expr", part))}
    if f.is_Pow and f.as_base_exp()[1].is_Integer:
        return _functions(f.as_base_exp()[0])
    return set() if f.is_Symbol or f.is_Rational else {f}


def _relation(kernel: Expr, name: Symbol, kept: Expr, u: Symbol, names: Mapping[Expr, Symbol]) -> Expr | None:
    if {kernel.func, kept.func} == {sp.sin, sp.cos} and kernel.args == kept.args:
        return name**2 + u**2 - 1
    if {kernel.func, kept.func} == {sp.sinh, sp.cosh} and kernel.args == kept.args:
        return name**2 - u**2 + (1 if kernel.func == sp.sinh else -1)
    base, exponent = kernel.as_base_exp()
    if isinstance(exponent, sp.Rational) and not exponent.is_Integer:
        return sp.numer(sp.together(name**exponent.q - exchanged(base, names) ** exponent.p))
    kept_base, kept_exponent = kept.as_base_exp()
    if isinstance(kept_exponent, sp.Rational) and kept_base == kernel and kept_exponent.p == 1:
        return name - u**kept_exponent.q
    return None


def _kernels(f: Expr, x: Symbol) -> set[Expr]:
    """Return the parts of f from which sums, products and whole powers build it, as far as they hold x."""
    if not f.has(x):
        return set()
    if f.is_Add or f.is_Mul:
        return {k for part in f.args for k in _kernels(cast("Expr", part), x)}
    if f.is_Pow and f.as_base_exp()[1].is_Integer:
        return _kernels(f.as_base_exp()[0], x)
    return {f}


def _in_few_functions(f: Expr, x: Symbol) -> Expr:
    """Write tan, cot, sec, csc by sin and cos where f holds those, else cot by tan."""

    def holds(*kinds: Any) -> bool:
        return any(g.has(x) for g in f.atoms(*kinds))

    angles = {g: cast("Expr", g.args[0]) for g in f.atoms(sp.tan, sp.cot, sp.sec, sp.csc)}
    if holds(sp.sin, sp.cos, sp.sec, sp.csc):
        return exchanged(f, {g: _through_sin_and_cos(g, y) for g, y in angles.items()})
    if holds(sp.cot) and holds(sp.tan):
        return exchanged(f, {g: 1 / sp.tan(y) for g, y in angles.items() if g.func == sp.cot})
    return f


def _through_sin_and_cos(g: Expr, y: Expr) -> Expr:
    if g.func == sp.sec:
        return 1 / sp.cos(y)
    if g.func == sp.csc:
        return 1 / sp.sin(y)
    return sp.sin(y) / sp.cos(y) if g.func == sp.tan else sp.cos(y) / sp.sin(y)
