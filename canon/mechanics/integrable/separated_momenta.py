"""Separated Hamilton–Jacobi equations: each momentum as a function of its own coordinate and the constants.

Constants come off one after another: the momentum of an ignorable coordinate; a function f_i(q_i, p_i) through which
alone q_i and p_i stand in H; and at the end, with a multiplier D, Liouville's sum D (H − E) = Σ f_i(q_i, p_i, E), or
Stäckel's matrix (L. D. Landau and E. M. Lifshitz, Mechanics, section 48; H. Goldstein, Classical Mechanics, 10.7).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.integrable.function_splitting import product_parts, sum_parts
from canon.mechanics.integrable.staeckel_matrix import staeckel_matrix
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy.logic.boolalg import Boolean

    from canon.mechanics.hamilton.hamiltonian import Hamiltonian
    from canon.proof.domain.domain import Domain

__all__ = ["NotSeparatedError", "SeparatedMomentum", "separated_momenta"]


class NotSeparatedError(ValueError):
    """Raised where a Hamilton–Jacobi equation does not separate, or its separated equations were not found."""


@dataclass(frozen=True)
class SeparatedMomentum:
    """One momentum p = shift ± √square as a function of its own coordinate and the constants.

    Parameters
    ----------
    q, p
        The coordinate and its momentum.
    shift
        Half the sum of both solutions.
    square
        The square of half their difference; None where the momentum has one value.
    constant
        The constant that this equation defines.
    defined_as
        That constant as a function of (q, p).
    where
        What holds along the motion besides: that a root which was squared is positive.
    """

    q: Symbol
    p: Symbol
    shift: Expr
    square: Expr | None
    constant: Symbol | None = None
    defined_as: Expr | None = None
    where: Boolean = sp.true

    def value(self, sign: int = 1) -> Expr:
        """Return the momentum, with the sign of the root."""
        return self.shift if self.square is None else self.shift + sign * sp.sqrt(self.square)


@dataclass
class _Separation:
    """A Hamilton–Jacobi equation in the course of its separation."""

    domain: Domain
    energy: Symbol
    rest: Expr
    left: list[tuple[Symbol, Symbol]]
    taken: set[Symbol]
    found: list[SeparatedMomentum] = field(default_factory=list[SeparatedMomentum])
    constants: list[tuple[Symbol, Expr]] = field(default_factory=list[tuple[Symbol, Expr]])

    def new_constant(self, q: Symbol, meaning: Expr) -> Symbol:
        """Return a symbol for the constant that separates q; remember what it is in (q, p)."""
        name = f"alpha_{q.name}"
        while Symbol(name, real=True) in self.taken:
            name += "_"
        constant = Symbol(name, real=True)
        self.taken.add(constant)
        known = dict(self.constants)
        self.constants.append((constant, substitute(meaning, known)))
        return constant


def separated_momenta(
    H: Hamiltonian, energy: Symbol, domain: Domain
) -> tuple[tuple[SeparatedMomentum, ...], tuple[tuple[Symbol, Expr], ...]]:
    """Return the momenta p_i(q_i, α), and the constants α as functions of (q, p) with the energy last.

    Raises
    ------
    NotSeparatedError
        Where none of the ways of separation was found to apply.
    """
    symbols = {s for s in H.H.free_symbols if isinstance(s, Symbol)} | {energy}
    work = _Separation(domain, energy, H.H, list(zip(H.q, H.p, strict=True)), symbols)
    while work.left:
        if not (_ignorable(work) or _last(work) or _inner(work) or _together(work) or _by_staeckel(work)):
            names = ", ".join(str(q) for q, _ in work.left)
            raise NotSeparatedError(
                f"no separated equations were found for {names}; they are looked for where H is at most "
                "quadratic in each momentum, without products of momenta, with a Stäckel matrix whose entries "
                "have values at simple places. Give H so, or eliminate ignorable coordinates first"
            )
    constants = (*work.constants, (energy, H.H))
    by_q = {found.q: found for found in work.found}
    return tuple(by_q[q] for q in H.q), constants


def _ignorable(work: _Separation) -> bool:
    """Take off a coordinate that H does not depend on."""
    for q, p in work.left:
        if len(work.left) > 1 and (
            not work.rest.has(q) or vanishes(work.rest.diff(q), work.domain, 1.0).holds
        ):
            constant = work.new_constant(q, p)
            work.rest = substitute(work.rest, {p: constant})
            work.found.append(SeparatedMomentum(q, p, constant, None, constant, p))
            work.left.remove((q, p))
            return True
    return False


def _last(work: _Separation) -> bool:
    """Solve the equation of the only coordinate that is left."""
    if len(work.left) != 1:
        return False
    ((q, p),) = work.left
    momentum = _solved(work.rest - work.energy, q, p)
    if momentum is None:
        return False
    work.found.append(momentum)
    work.left.clear()
    return True


def _inner(work: _Separation) -> bool:
    """Take off a coordinate that stands with its momentum in one function f(q, p) alone."""
    for q, p in work.left:
        others = [s for pair in work.left if pair != (q, p) for s in pair]
        coefficients = _quadratic(work.rest, p)
        if coefficients is None:
            continue
        a, b, c = coefficients
        scale = product_parts(a if a != 0 else b, [[q], others], work.domain)
        if scale is None:
            continue
        own, outer = scale
        linear = _own_part(b / outer, [q], others, work.domain) if a != 0 else own
        split = sum_parts(c / outer, [[q], others], work.domain)
        if split is None or linear is None:
            continue
        f = (own * p**2 if a != 0 else sp.S.Zero) + linear * p + split[0]
        constant = work.new_constant(q, f)
        momentum = _solved(f - constant, q, p)
        if momentum is None:
            return False
        work.found.append(
            SeparatedMomentum(q, p, momentum.shift, momentum.square, constant, f, momentum.where)
        )
        work.rest = outer * constant + outer * split[1]
        work.left.remove((q, p))
        return True
    return False


def _own_part(f: Expr, own: Sequence[Symbol], others: Sequence[Symbol], domain: Domain) -> Expr | None:
    """Return f without the other variables, which it only seems to hold; None where it does depend on them."""
    parts = sum_parts(f, [own, others], domain)
    if parts is None or parts[1].has(*others):
        return None
    return parts[0] + parts[1]


def _together(work: _Separation) -> bool:
    """Separate all that is left by D (H − E) = Σ f_i."""
    quadratics = {q: _quadratic(work.rest, p) for q, p in work.left}
    if any(found is None or found[0] == 0 for found in quadratics.values()):
        return False
    leading = {q: cast("tuple[Expr, Expr, Expr]", found)[0] for q, found in quadratics.items()}
    D = _multiplier(leading, work.domain)
    if D is None:
        return False
    variables = [q for q, _ in work.left]
    groups = [[q, p] for q, p in work.left]
    resting = {p: sp.S.Zero for _, p in work.left}
    linear_terms = sp.Add(*(p * substitute(work.rest.diff(p), resting) for _, p in work.left))
    own = [_own_part(D * a, [q], [s for s in variables if s != q], work.domain) for q, a in leading.items()]
    sums = [
        sum_parts(part, groups, work.domain)
        for part in (D * linear_terms, D * substitute(work.rest, resting), D)
    ]
    if None in own or None in sums:
        return False
    linear, static, of_D = cast("list[list[Expr]]", sums)
    functions = [
        cast("Expr", own[i]) * p**2 + linear[i] + static[i] - work.energy * of_D[i]
        for i, (_, p) in enumerate(work.left)
    ]
    return _share_out(work, functions)


def _by_staeckel(work: _Separation) -> bool:
    """Separate all that is left by Stäckel's matrix."""
    resting = {p: sp.S.Zero for _, p in work.left}
    leading: dict[Symbol, Expr] = {}
    shifts: list[Expr] = []
    for q, p in work.left:
        coefficients = _quadratic(work.rest, p)
        if coefficients is None or coefficients[0] == 0 or any(f.has(*resting) for f in coefficients[:2]):
            return False
        a, b, _ = coefficients
        shift = _own_part(b / (2 * a), [q], [s for s, _ in work.left if s != q], work.domain)
        if shift is None:
            return False
        leading[q] = a
        shifts.append(shift)
    completed = sp.Add(*(a * shift**2 for a, shift in zip(leading.values(), shifts, strict=True)))
    matrix = staeckel_matrix(leading, substitute(work.rest, resting) - completed, work.domain)
    if matrix is None:
        return False
    squares = [(p + shift) ** 2 for (_, p), shift in zip(work.left, shifts, strict=True)]
    defined = matrix.constants(squares, next(iter(leading.values())))
    names = [work.new_constant(q, f) for (q, _), f in zip(work.left[1:], defined, strict=True)]
    own = [None, *zip(names, defined, strict=True)]
    for i, (q, p) in enumerate(work.left):
        terms = zip(matrix.rows[i], (*names, work.energy), strict=True)
        square = sp.Add(*(u * alpha for u, alpha in terms), -matrix.potential[i])
        constant, meaning = own[i] or (None, None)
        work.found.append(SeparatedMomentum(q, p, -shifts[i], square, constant, meaning))
    work.left.clear()
    return True


def _share_out(work: _Separation, functions: Sequence[Expr]) -> bool:
    """Put each f_i equal to its constant; the constants add up to zero."""
    total = sp.S.Zero
    momenta: list[SeparatedMomentum] = []
    known = {work.energy: work.rest}
    for (q, p), f in zip(work.left[:-1], functions[:-1], strict=True):
        constant = work.new_constant(q, substitute(f, known))
        total -= constant
        solved = _solved(f - constant, q, p)
        if solved is None:
            return False
        momenta.append(SeparatedMomentum(q, p, solved.shift, solved.square, constant, f, solved.where))
    last = _solved(functions[-1] - total, *work.left[-1])
    if last is None:
        return False
    work.found += [*momenta, last]
    work.left.clear()
    return True


def _multiplier(leading: dict[Symbol, Expr], domain: Domain) -> Expr | None:
    """Return D with D·a_i a function of q_i alone, for the coefficients a_i of p_i²."""
    (first, a), (_, b), *_ = leading.items()  # one coordinate alone was the last
    ratio = product_parts(a / b, [[first], [s for s in leading if s != first]], domain)
    return None if ratio is None else ratio[0] / a


def _quadratic(f: Expr, p: Symbol) -> tuple[Expr, Expr, Expr] | None:
    """Return the coefficients of p², p and 1; None for what is no such polynomial."""
    a = f.diff(p, 2) / 2
    if a.has(p):
        return None
    b, c = f.diff(p).subs(p, 0), f.subs(p, 0)
    if a.has(sp.nan, sp.zoo) or b.has(sp.nan, sp.zoo) or c.has(sp.nan, sp.zoo):
        return None
    return a, b, c


def _solved(equation: Expr, q: Symbol, p: Symbol) -> SeparatedMomentum | None:
    """Return the solution of an equation that is linear or quadratic in p, or in whose only root p stands so."""
    coefficients, where = _quadratic(equation, p), sp.true
    if coefficients is None:
        squared, where = _without_root(equation, p)
        coefficients = _quadratic(squared, p)
    if coefficients is None:
        return None
    a, b, c = coefficients
    if a == 0:
        return None if b == 0 else SeparatedMomentum(q, p, -c / b, None, where=where)
    shift = -b / (2 * a)
    over_a = sp.Add(*(term / a for term in cast("Sequence[Expr]", sp.Add.make_args(c))))
    square = shift**2 - over_a
    return SeparatedMomentum(q, p, shift, square if where == sp.true else sp.collect(square, q), where=where)


def _without_root(equation: Expr, p: Symbol) -> tuple[Expr, Boolean]:
    """Return B − r² of an equation √B = r with p in B alone, as that of a relativistic energy, and that r > 0."""
    rest, root = equation.as_independent(p, as_Add=True)
    factor, function = root.as_independent(p, as_Add=False)
    B, exponent = function.as_base_exp()
    if exponent != sp.S.Half:
        return equation, sp.true
    r = -rest / factor
    return sp.expand(B - r**2), sp.Gt(r, 0)
