"""Generators of one near-identity map in other forms: Hori's single exponential, and Deprit's generator of a flow.

A normal form is found as a product exp(L_χ₃) exp(L_χ₄) …, which is Dragt's and Finn's form. The same map is exp(L_χ)
with one χ = χ₃ + χ₄ + … (G.-I. Hori, Publ. Astron. Soc. Jpn. 18, 287 (1966)), and the flow of dx/dε = {x, W(ε)} from
ε = 0 to 1 with W = Σ W_s ε^(s−3) (A. Deprit, Celest. Mech. 1, 12 (1969), doi:10.1007/BF01230629). Both are found degree
by degree: where two maps first differ, they do by {x, δ}, and Euler's theorem gives δ.
"""

from __future__ import annotations

from math import comb, factorial
from typing import TYPE_CHECKING

from flint import fmpq

from canon.mechanics.perturbation.lie_transform import added, bracket_parts

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from canon.mechanics.perturbation.birkhoff import NormalForm
    from canon.mechanics.perturbation.lie_transform import Brackets
    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial

__all__ = ["deprit_generator", "hori_generator"]

Parts = dict[int, "PhasePolynomial"]


def hori_generator(form: NormalForm) -> Parts:
    """Return the homogeneous parts of the χ with exp(L_χ) H = K to the order, in the variables (a, b) of the form.

    Examples
    --------
    >>> import sympy as sp
    >>> from canon.mechanics import birkhoff_normal_form, deprit_generator
    >>> from canon.mechanics.hamilton.hamiltonian import Hamiltonian
    >>> q, p = sp.symbols("q p", real=True)
    >>> form = birkhoff_normal_form(Hamiltonian((p**2 + q**2) / 2 + q**3, q, p), 3)
    >>> form.expression(hori_generator(form)), hori_generator(form) == deprit_generator(form)
    (-2*p**3/3 - p*q**2, True)
    """
    return _generator(form, _exponential, lambda _degree: 1)


def deprit_generator(form: NormalForm) -> Parts:
    """Return the homogeneous parts W_s of Deprit's generator Σ W_s ε^(s−3), whose flow to ε = 1 takes H to K.

    Examples
    --------
    >>> import sympy as sp
    >>> from canon.mechanics.hamilton.hamiltonian import Hamiltonian
    >>> from canon.mechanics.perturbation.birkhoff import birkhoff_normal_form
    >>> q, p = sp.symbols("q p", real=True)
    >>> form = birkhoff_normal_form(Hamiltonian((p**2 + q**2) / 2 + q**3, q, p), 3)
    >>> form.expression(deprit_generator(form))
    -2*p**3/3 - p*q**2
    """
    return _generator(form, _flow, lambda degree: degree - 2)


def _generator(
    form: NormalForm,
    image: Callable[[PhasePolynomial, Parts, int, Brackets], Parts],
    factor: Callable[[int], int],
) -> Parts:
    """Return the generator whose images of the variables are the form's; its part of degree s is ``factor`` δ_s."""
    bracket, order = form.diagonal.brackets, form.order
    ring = form.diagonal.eigenvalues[0].ring
    variables = [ring.variable(j) for j in range(ring.size)]
    targets = [form.to_normal({1: z}) for z in variables]
    generator: Parts = {}
    for degree in range(3, order + 1):
        images = [image(z, generator, degree - 1, bracket) for z in variables]
        missing = [
            target.get(degree - 1, ring.zero) - found.get(degree - 1, ring.zero)
            for target, found in zip(targets, images, strict=True)
        ]
        part = _by_euler(missing, bracket).times(fmpq(factor(degree), degree))
        if part:
            generator[degree] = part
    return generator


def _by_euler(changes: Sequence[PhasePolynomial], bracket: Brackets) -> PhasePolynomial:
    """Return Σ zⱼ ∂δ/∂zⱼ from {aⱼ, δ} = cⱼ ∂δ/∂bⱼ and {bⱼ, δ} = −cⱼ ∂δ/∂aⱼ."""
    ring, n = changes[0].ring, len(bracket.constants)
    total = ring.zero
    for j, c in enumerate(bracket.constants):
        moved = changes[j] * ring.variable(n + j) - changes[n + j] * ring.variable(j)
        total = total + moved * c.inverse()
    return total


def _exponential(z: PhasePolynomial, generator: Parts, order: int, bracket: Brackets) -> Parts:
    """Return exp(L_χ) z to an order."""
    total: Parts = {1: z}
    term: Mapping[int, PhasePolynomial] = total
    for k in range(1, order):
        brackets = bracket_parts(term, generator, order, bracket)
        term = {d: f.times(fmpq(1, k)) for d, f in brackets.items()}
        total = added(total, term)
    return total


def _flow(z: PhasePolynomial, generator: Parts, order: int, bracket: Brackets) -> Parts:
    """Return z at the end of the flow of W, to an order, by Deprit's triangle: its n-th image has the degree 1 + n."""
    ring = z.ring
    W = [generator.get(m + 3, ring.zero).times(factorial(m)) for m in range(order)]
    row = [z, *(ring.zero for _ in range(order - 1))]
    total: Parts = {1: z}
    for n in range(1, order):
        row = [
            row[k + 1]
            + ring.sum_of_products(
                (ring.rational(comb(k, m)), bracket(row[k - m], W[m])) for m in range(k + 1)
            )
            for k in range(len(row) - 1)
        ]
        total[1 + n] = row[0].times(fmpq(1, factorial(n)))
    return total
