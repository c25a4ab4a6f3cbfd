"""Frobenius's theorem: constraints on velocities that are integrable, that is, constraints on positions.

Constraints ωₐ = aₐ·dq + a₀ₐ dt are integrable together exactly where dωₐ(X, Y) = 0 for all X, Y that satisfy them
(F. G. Frobenius 1877). Of constraints that are not, some combinations still may be: those with
Σ cₐ dωₐ(X, Y) = 0, and again of these, until nothing changes (the derived flag, É. Cartan).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.linear import eliminate
from canon.mechanics.algebra.potential import potential
from canon.mechanics.algebra.substitution import entry, shortened
from canon.proof.domain.domain import Domain, as_domain

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian

__all__ = ["Pfaffian", "exterior_derivative", "integrals", "pfaffian"]

Row = tuple[Expr, ...]


@dataclass(frozen=True)
class Pfaffian:
    """Pfaffian constraints ωₐ = Σ aₐⱼ dzⱼ = 0 on the displacements of variables z.

    Parameters
    ----------
    forms
        The coefficients aₐⱼ(z), one row a constraint.
    z
        The variables, time among them where it matters.
    domain
        Where the constraints are meant.
    """

    forms: tuple[Row, ...]
    z: tuple[Symbol, ...]
    domain: Domain

    @cached_property
    def allowed(self) -> tuple[Row, ...]:
        """A basis X of the displacements that satisfy the constraints."""
        matrix = sp.Matrix([list(form) for form in self.forms])
        return eliminate(matrix, domain=self.domain).null_directions

    @cached_property
    def curvatures(self) -> tuple[tuple[tuple[int, int], Row], ...]:
        """For each pair of allowed displacements the values dωₐ(X, Y), one a constraint."""
        pairs = combinations(range(len(self.allowed)), 2)
        return tuple(
            (
                (i, j),
                tuple(
                    exterior_derivative(form, self.z, self.allowed[i], self.allowed[j]) for form in self.forms
                ),
            )
            for i, j in pairs
        )

    @cached_property
    def derived(self) -> Pfaffian:
        """The combinations of the constraints whose curvature vanishes on allowed displacements."""
        rows = [list(values) for _, values in self.curvatures]
        if not rows:
            return self
        combos = eliminate(sp.Matrix(rows), domain=self.domain).null_directions
        if len(combos) == len(self.forms):
            return self
        forms = tuple(
            tuple(
                sp.cancel(sp.Add(*(c * form[j] for c, form in zip(combination, self.forms, strict=True))))
                for j in range(len(self.z))
            )
            for combination in combos
        )
        return Pfaffian(forms, self.z, self.domain)

    @cached_property
    def holonomic_part(self) -> Pfaffian:
        """The combinations that are integrable: as many positions are restricted as it has rows."""
        part = self
        while part.forms:
            smaller = part.derived
            if smaller is part:
                break
            part = smaller
        return part


def pfaffian(constrained: ConstrainedLagrangian, domain: Domain | None = None) -> Pfaffian:
    """Return the nonholonomic constraints of a system as forms in dq and dt."""
    first = len(constrained.holonomic)
    A, rests = constrained.directions, constrained.rests
    forms = tuple((*A.row(a), rests[a]) for a in range(first, A.rows))
    return Pfaffian(forms, (*constrained.lagrangian.q, constrained.lagrangian.t), as_domain(domain))


def integrals(constrained: ConstrainedLagrangian, domain: Domain | None = None) -> tuple[Expr, ...]:
    """Return functions f(q, t) that the nonholonomic constraints keep constant, as far as they are found.

    Each is proved: df vanishes on every allowed displacement. There are as many independent ones as
    ``pfaffian(constrained).holonomic_part`` has rows; fewer are returned where no closed form was found.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    >>> x, y, z = coordinates("x y z", positive=True)
    >>> L = Lagrangian((x.dot**2 + y.dot**2 + z.dot**2)/2, [x, y, z])
    >>> integrals(ConstrainedLagrangian(L, nonholonomic=[y*z*x.dot + x*z*y.dot + x*y*z.dot]))
    (x*y*z,)
    """
    whole = pfaffian(constrained, domain)
    part = whole.holonomic_part
    found: list[Expr] = []
    for f in _candidates(part):
        rows = [[g.diff(s) for s in part.z] for g in (*found, f)]
        if eliminate(sp.Matrix(rows), domain=part.domain).rank <= len(found):
            continue
        kept = (
            (str(X), sp.Add(*(v * f.diff(s) for v, s in zip(X, part.z, strict=True)))) for X in whole.allowed
        )
        if all_vanish(kept, "constant on allowed displacements", part.domain).holds:
            found.append(f)
        if len(found) == len(part.forms):
            break
    return tuple(found)


def exterior_derivative(form: Row, z: Sequence[Symbol], X: Row, Y: Row) -> Expr:
    """Return dω(X, Y) = Σ (∂ᵢaⱼ − ∂ⱼaᵢ) Xᵢ Yⱼ.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> exterior_derivative((-y, x), (x, y), (sp.S.One, sp.S.Zero), (sp.S.Zero, sp.S.One))
    2
    """
    pairs = combinations(range(len(z)), 2)
    return sp.Add(
        *((form[j].diff(z[i]) - form[i].diff(z[j])) * (X[i] * Y[j] - X[j] * Y[i]) for i, j in pairs)
    )


def _candidates(part: Pfaffian) -> Iterator[Expr]:
    """Yield potentials of the forms, of their solved versions, and of both times an integrating factor."""
    for form in (*part.forms, *_solved(part)):
        f = potential(form, part.z, part.domain)
        if f is not None:
            yield f
            continue
        for factor in _integrating_factors(form, part):
            scaled = [sp.cancel(factor * a) for a in form]
            f = potential(scaled, part.z, part.domain)
            if f is not None:
                yield shortened(f)
                break


def _solved(part: Pfaffian) -> Iterator[Row]:
    """Yield the constraints solved for one differential each: dzₚ − …, by full elimination."""
    reduced = eliminate(sp.Matrix([list(form) for form in part.forms]), domain=part.domain)
    rows = [list(row) for row in reduced.rows[: reduced.rank]]
    for i in reversed(range(len(rows))):
        pivot = reduced.pivots[i]
        rows[i] = [sp.cancel(a / rows[i][pivot]) for a in rows[i]]
        for k in range(i):
            factor = rows[k][pivot]
            rows[k] = [sp.cancel(a - factor * b) for a, b in zip(rows[k], rows[i], strict=True)]
    yield from (tuple(row) for row in rows)


def _integrating_factors(form: Row, part: Pfaffian) -> Iterator[Expr]:
    """Yield μ with d(μω) = 0: from dω = θ ∧ ω, θ = −dω(X, ·) for an X with ω(X) = 1, μ = exp(−∫θ) where θ is closed."""
    z = part.z
    rotation = sp.Matrix(len(z), len(z), lambda i, j: form[j].diff(z[i]) - form[i].diff(z[j]))
    for p, a in enumerate(form):
        if a == 0:
            continue
        theta = [sp.cancel(-entry(rotation, p, j) / a) for j in range(len(z))]
        h = potential(theta, z, part.domain)
        if h is not None:
            yield sp.exp(-h)
