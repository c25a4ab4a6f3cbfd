"""Ignorable coordinates, also those that appear only after a linear change of coordinates.

A coordinate is ignorable where neither L nor a generalized force depends on its value: ∂L/∂q = 0, Q = 0. More
generally L may keep its value along a constant direction, Σ cᵢ ∂L/∂qᵢ = 0, as for relative distances; then a
coordinate counted along c is ignorable (E. T. Whittaker, Analytical Dynamics, § 38).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.symbol import Coordinate, acceleration, velocity
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.dynamicsymbols import coordinate as symbol_of
from canon.mechanics.algebra.linear import eliminate
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.continuity.smooth import PIECED
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import all_hold

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.proof.domain.verdict import Verdict

__all__ = ["Adapted", "adapted", "ignorable_coordinates", "ignorable_directions", "is_ignorable"]


def is_ignorable(lagrangian: Lagrangian, coordinate: Symbol, domain: Domain | None = None) -> Verdict:
    """Tell whether L does not depend on q and no generalized force acts along q or depends on it.

    That ∂L/∂q = 0 is not enough: the slope of sign q vanishes on both sides of the step.

    Raises
    ------
    ValueError
        Where the symbol is no coordinate of this Lagrangian.
    """
    coordinate = symbol_of(coordinate)
    if coordinate not in lagrangian.q:
        raise ValueError(
            f"{coordinate} is no coordinate of this Lagrangian; its coordinates are "
            f"{', '.join(map(str, lagrangian.q))}"
        )
    claims = [(f"∂L/∂{coordinate} = 0", lagrangian.L.diff(coordinate))]
    for s, force in zip(lagrangian.q, lagrangian.forces, strict=False):
        if s == coordinate:
            claims.append((f"no force acts along {coordinate}", force))
        claims.append((f"the force along {s} does not depend on {coordinate}", force.diff(coordinate)))
    verdict = all_vanish(claims, f"{coordinate} is ignorable", domain)
    changing = [f for f in (lagrangian.L, *lagrangian.forces) if f.has(coordinate)]
    elsewhere = sp.Dummy(coordinate.name, **coordinate.assumptions0)
    return _and_steady(verdict, changing, {coordinate: elsewhere}, domain)


def _and_steady(
    verdict: Verdict, functions: Sequence[Expr], moved: Mapping[Symbol, Expr], domain: Domain | None
) -> Verdict:
    """Return the verdict on functions whose slopes vanish, once it is seen that they have the same values elsewhere."""
    if not verdict.holds or not functions:
        return verdict
    here = as_domain(domain)
    there = tuple(cast("Boolean", c.xreplace(moved)) for c in here.conditions if c.has(*moved))
    both = replace(here, conditions=(*here.conditions, *there))
    claims = [(f"{f} has one value", substitute(f, moved) - f) for f in functions]
    return all_hold([verdict, all_vanish(claims, verdict.question, both)], verdict.question)


def ignorable_coordinates(lagrangian: Lagrangian, domain: Domain | None = None) -> tuple[Symbol, ...]:
    """Return the coordinates that certainly are ignorable.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> r, phi = coordinates("r phi")
    >>> ignorable_coordinates(Lagrangian(r.dot**2 + r**2*phi.dot**2 - 1/r, [r, phi]))
    (phi,)
    """
    return tuple(s for s in lagrangian.q if is_ignorable(lagrangian, s, domain).holds)


def ignorable_directions(
    lagrangian: Lagrangian, domain: Domain | None = None
) -> tuple[tuple[Expr, ...], ...]:
    """Return independent constant directions c with Σ cᵢ ∂L/∂qᵢ = 0 and Σ cᵢ Qᵢ = 0, each proved.

    They are read off the derivatives ∂L/∂q over a common denominator, multiplied out, sines and cosines of sums and
    multiples taken apart and sin² written as 1 − cos². That finds every direction where ∂L/∂q is rational in q, q̇, t
    and in sines, cosines and exponentials of linear combinations with rational coefficients of them; elsewhere, as with
    roots of different sums, one that only identities between different functions would show may be missed.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, parameters
    >>> x, y = coordinates("x y")
    >>> k = parameters("k", positive=True)
    >>> ignorable_directions(Lagrangian(x.dot**2 + y.dot**2 - k*(x - y)**2, [x, y]))
    ((1, 1),)
    """
    q = lagrangian.q
    constant = _constant_combinations([lagrangian.L.diff(s) for s in q], lagrangian)
    return tuple(c for c in constant if _along(lagrangian, c, domain).holds)


@dataclass(frozen=True)
class Adapted:
    """A Lagrangian in coordinates some of which are ignorable.

    Parameters
    ----------
    lagrangian
        L in the new coordinates.
    old
        Each old coordinate in terms of the new ones.
    ignorable
        Those of the new coordinates that are ignorable.
    """

    lagrangian: Lagrangian
    old: Mapping[Symbol, Expr]
    ignorable: tuple[Symbol, ...]


def adapted(lagrangian: Lagrangian, domain: Domain | None = None) -> Adapted:
    """Return L in coordinates that are ignorable along every constant direction L does not feel.

    For a direction c the coordinate qⱼ (cⱼ ≠ 0) is kept to count along it, and every other qᵢ with cᵢ ≠ 0 is
    replaced by ``qᵢ_rel`` = qᵢ − (cᵢ/cⱼ) qⱼ.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, parameters
    >>> x, y = coordinates("x y")
    >>> k = parameters("k", positive=True)
    >>> pair = adapted(Lagrangian((x.dot**2 + y.dot**2)/2 - k*(x - y)**2/2, [x, y]))
    >>> pair.ignorable, pair.lagrangian.L
    ((x,), -k*y_rel**2/2 + x_dot**2/2 + (x_dot + y_rel_dot)**2/2)
    """
    directions = ignorable_directions(lagrangian, domain)
    kept = [_kept(c, directions) for c in directions]
    shares: dict[Symbol, Expr] = {}
    renamed: dict[Symbol, Symbol] = {}
    for i, s in enumerate(lagrangian.q):
        share = sp.Add(*(c[i] / c[j] * lagrangian.q[j] for c, j in zip(directions, kept, strict=True)))
        if i in kept or share == 0:
            shares[s] = s
            continue
        renamed[s] = Coordinate(f"{s.name}_rel", real=True)
        shares[s] = renamed[s] + share
    ignored = tuple(lagrangian.q[j] for j in kept)
    new = [renamed.get(s, s) for s in lagrangian.q]
    rates = {velocity(s): sp.Add(*(e.diff(x) * velocity(x) for x in new)) for s, e in shares.items()}
    through = rates | {
        acceleration(s): sp.Add(*(e.diff(x) * acceleration(x) for x in new)) for s, e in shares.items()
    }
    at_origin = dict.fromkeys(ignored, sp.S.Zero)
    places = {s: exchanged(e, at_origin) for s, e in shares.items()}
    L, *forces = (exchanged(e, {**places, **through}) for e in (lagrangian.L, *lagrangian.forces))
    projected = [
        sp.Add(*(Q * shares[s].diff(x) for s, Q in zip(lagrangian.q, forces, strict=False))) for x in new
    ]
    return Adapted(Lagrangian(L, new, projected if forces else None, lagrangian.t), shares, ignored)


def _kept(direction: tuple[Expr, ...], directions: Sequence[tuple[Expr, ...]]) -> int:
    """Return the index of a component that only this direction has."""
    return next(
        i
        for i, component in enumerate(direction)
        if component != 0 and all(other[i] == 0 for other in directions if other is not direction)
    )


def _along(lagrangian: Lagrangian, c: Sequence[Expr], domain: Domain | None) -> Verdict:
    """Tell whether L and the forces keep their values along c, and no force acts along it."""

    def slope(f: Expr) -> Expr:
        return sp.Add(*(factor * f.diff(s) for factor, s in zip(c, lagrangian.q, strict=True)))

    claims = [("L keeps its value", slope(lagrangian.L))]
    claims += [
        (f"the force along {s} keeps its value", slope(Q))
        for s, Q in zip(lagrangian.q, lagrangian.forces, strict=False)
    ]
    work = sp.Add(*(factor * Q for factor, Q in zip(c, lagrangian.forces, strict=False)))
    verdict = all_vanish(
        [*claims, ("no force acts", work)], f"L is constant along ({', '.join(map(str, c))})", domain
    )
    step = sp.Dummy("step", real=True)
    moved = {s: s + factor * step for s, factor in zip(lagrangian.q, c, strict=True) if factor != 0}
    functions = (lagrangian.L, *lagrangian.forces)
    in_pieces = [f for f in functions if any(piece.has(*moved) for piece in f.atoms(*PIECED))]
    return _and_steady(verdict, in_pieces, moved, domain)


def _constant_combinations(slopes: Sequence[Expr], lagrangian: Lagrangian) -> tuple[tuple[Expr, ...], ...]:
    """Return constants c with Σ cᵢ fᵢ = 0 term by term, after multiplying out."""
    moving = (*lagrangian.q, *lagrangian.velocities, lagrangian.t)
    rows: dict[Expr, list[Expr]] = {}
    for i, slope in enumerate(_over_common_denominator(slopes)):
        for term in sp.Add.make_args(slope):
            constant, function = term.as_independent(*moving, as_Add=False)
            row = rows.setdefault(function, [sp.S.Zero] * len(slopes))
            row[i] += constant
    matrix = sp.Matrix(list(rows.values())) if rows else sp.zeros(1, len(slopes))
    return eliminate(matrix).null_directions


def _over_common_denominator(slopes: Sequence[Expr]) -> list[Expr]:
    """Return all of them times one function, as sums of terms that differ in an independent product of functions."""
    fractions = [sp.fraction(sp.together(_in_sines(slope))) for slope in slopes]
    denominators = list(dict.fromkeys(below for _, below in fractions))
    return [
        _multiplied_out(above * sp.Mul(*(other for other in denominators if other != below)))
        for above, below in fractions
    ]


def _in_sines(f: Expr) -> Expr:
    for function, quotient in _QUOTIENTS.items():
        f = cast("Expr", f.replace(function, quotient))
    return cast("Expr", sp.expand_trig(f))


_QUOTIENTS: dict[Any, Callable[[Expr], Expr]] = {
    sp.tan: lambda a: sp.sin(a) / sp.cos(a),
    sp.cot: lambda a: sp.cos(a) / sp.sin(a),
    sp.sec: lambda a: 1 / sp.cos(a),
    sp.csc: lambda a: 1 / sp.sin(a),
}


def _multiplied_out(f: Expr) -> Expr:
    """Multiply out, and leave no power of a sine."""
    expanded = sp.expand(f)
    powers = {
        e: (1 - sp.cos(e.base.args[0]) ** 2) ** (e.exp // 2) * e.base ** (e.exp % 2)
        for e in expanded.atoms(sp.Pow)
        if isinstance(e.base, sp.sin) and e.exp.is_Integer and e.exp > 1
    }
    return cast("Expr", sp.expand(exchanged(expanded, powers)))
