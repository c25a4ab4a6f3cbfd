"""Near-identity maps of normal forms, in both directions, and what is canonical about their truncations."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.cached_property import cached_property
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.mechanics.perturbation.lie_transform import added, bracket_parts, truncated_product
from canon.mechanics.perturbation.normal_form_step import Module, weight_of
from canon.proof.domain.verdict import Evidence, Status, Verdict

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.mechanics.perturbation.birkhoff import NormalForm
    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial

__all__ = ["NearIdentityMap", "is_normal_form", "near_identity_map"]

Parts = dict[int, "PhasePolynomial"]


@dataclass(frozen=True)
class NearIdentityMap:
    """A map x ↦ x + … given by polynomials to a degree, canonical up to terms of that degree.

    Parameters
    ----------
    form
        The normal form that it belongs to.
    images
        The homogeneous parts of what each of (q, p) becomes, in the variables (a, b).
    degree
        The degree that the images are kept to.
    to_new
        Whether the images are the new variables as functions of the old ones, or the old of the new.
    """

    form: NormalForm
    images: tuple[Parts, ...]
    degree: int
    to_new: bool

    @cached_property
    def transformation(self) -> CanonicalTransformation:
        """The polynomials as a :class:`CanonicalTransformation` of (q, p), from the equilibrium."""
        n = len(self.form.source.q)
        shown = [self.form.expression(parts) for parts in self.images]
        return CanonicalTransformation(self.form.source.q, self.form.source.p, shown[:n], shown[n:])

    @cached_property
    def residual(self) -> dict[tuple[int, int], Parts]:
        """What the brackets of the images have too much, {x_i, x_j} − J_ij, by homogeneous parts; all degrees."""
        n, everything = len(self.form.source.q), 2 * self.degree
        ring = self.form.diagonal.eigenvalues[0].ring
        found: dict[tuple[int, int], Parts] = {}
        for i in range(2 * n):
            for j in range(i + 1, 2 * n):
                bracket = self.form.diagonal.brackets
                parts = bracket_parts(self.images[i], self.images[j], everything, bracket)
                due: Parts = {0: -ring.one} if j == i + n else {}
                found[i, j] = {d: f for d, f in added(parts, due).items() if f}
        return found

    def is_canonical(self) -> Verdict:
        """Tell whether the brackets are right to the degree that the truncation allows, degree − 1, exactly.

        Returns
        -------
        Verdict
            HOLDS says in its evidence where the residual begins: the truncated map itself is not canonical.
        """
        started = clock.monotonic()
        first = min((d for parts in self.residual.values() for d in parts), default=None)
        question = f"the map is canonical to degree {self.degree - 1}"
        where = "nowhere: the map is canonical" if first is None else f"at degree {first}"
        seconds = clock.monotonic() - started
        evidence = (Evidence("first residual of {Q, P}", where),)
        if first is None or first >= self.degree:
            return Verdict(Status.HOLDS, question, "exact", evidence=evidence, seconds=seconds)
        pair = next(pair for pair, parts in self.residual.items() if first in parts)
        left = self.form.expression({first: self.residual[pair][first]})
        return Verdict(Status.FAILS, question, "exact", left, evidence=evidence, seconds=seconds)

    def of(self, f: Expr, symbols: Sequence[Symbol] | None = None) -> Expr:
        """Return f with the images for (q, p), not truncated."""
        old = symbols or (*self.form.source.q, *self.form.source.p)
        return substitute(f, dict(zip(old, self.transformation.images, strict=True)))


def near_identity_map(form: NormalForm, to_new: bool = False) -> NearIdentityMap:
    """Return the map of a normal form: the old variables as functions of the new ones, or the other way round.

    Both are counted from the equilibrium, have the degree order − 1, and carry H to K and K to H to the order.

    Examples
    --------
    >>> import sympy as sp
    >>> from canon.mechanics.hamilton.hamiltonian import Hamiltonian
    >>> from canon.mechanics.perturbation.birkhoff import birkhoff_normal_form
    >>> q, p = sp.symbols("q p", real=True)
    >>> form = birkhoff_normal_form(Hamiltonian((p**2 + q**2) / 2 + q**3, q, p), 3)
    >>> near_identity_map(form).transformation.images
    (-2*p**2 - q**2 + q, 2*p*q + p)
    >>> near_identity_map(form).is_canonical().status
    <Status.HOLDS: 'holds'>
    """
    degree = form.order - 1
    carried = form.from_normal if to_new else form.to_normal
    images = tuple(
        {d: f for d, f in carried({1: column}).items() if d <= degree} for column in form.diagonal.columns
    )
    return NearIdentityMap(form, images, degree, to_new)


def is_normal_form(form: NormalForm) -> Verdict:
    """Tell by another route whether K is a normal form of H: the map is put into H, and no bracket is used.

    Holds where H∘Φ − K has no part up to the order and every part of K commutes with H₂, or consists of terms of the
    given resonances.
    """
    started = clock.monotonic()
    question = f"K is the normal form of H to degree {form.order}"
    images = near_identity_map(form).images
    n = len(form.source.q)
    variables = [_linear_in(form.diagonal.rows[j], images, form.order) for j in range(2 * n)]
    carried: Parts = {}
    for part in form.original.values():
        carried = added(carried, _composed(part, variables, form.order))
    difference = added(carried, {d: -f for d, f in form.parts.items()})
    wrong = {d: f for d, f in sorted(difference.items()) if f and d <= form.order}
    moving = _moving(form)
    seconds = clock.monotonic() - started
    left = wrong or moving
    if not left:
        return Verdict(Status.HOLDS, question, "exact", seconds=seconds)
    degree = min(left)
    why = "H∘Φ − K" if wrong else "what should not stay in K"
    residual = form.expression({degree: left[degree]})
    return Verdict(
        Status.FAILS,
        question,
        "exact",
        residual,
        seconds=seconds,
        feedback=f"{why} has a part of degree {degree}",
    )


def _moving(form: NormalForm) -> Parts:
    """Return the parts of K that do not commute with H₂, or are outside the resonances that were named."""
    if form.resonances is None:
        return bracket_parts(form.parts, {2: form.original[2]}, form.order, form.diagonal.brackets)
    module = Module(form.resonances)
    strangers = {
        d: [term for weight, term in f.split(weight_of).items() if weight not in module]
        for d, f in form.parts.items()
    }
    return {d: terms[0] for d, terms in strangers.items() if terms}


def _linear_in(row: PhasePolynomial, images: Sequence[Parts], order: int) -> Parts:
    """Return a linear function of (q, p) at the images."""
    total: Parts = {}
    for j, image in enumerate(images):
        factor = row.derivative(j)
        if factor:
            total = added(total, {d: f * factor for d, f in image.items() if d <= order})
    return total


def _composed(part: PhasePolynomial, images: Sequence[Mapping[int, PhasePolynomial]], order: int) -> Parts:
    """Return a polynomial at images given by homogeneous parts, to an order."""
    total: Parts = {}
    for exponents, term in part.split(lambda e: tuple(map(int, e))).items():
        product: Parts = {0: term.coefficient_alone()}
        for image, times in zip(images, exponents, strict=True):
            for _ in range(times):
                product = truncated_product(product, image, order)
        total = added(total, product)
    return total
