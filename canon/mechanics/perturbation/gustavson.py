"""Formal integrals: series whose derivative along the motion begins beyond the order, Gustavson's among them."""

from __future__ import annotations

import time as clock
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from canon.cached_property import cached_property
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.perturbation.lie_transform import bracket_parts
from canon.mechanics.perturbation.normal_form_step import whole_vector
from canon.proof.domain.verdict import Evidence, Status, Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

    from canon.mechanics.perturbation.birkhoff import NormalForm
    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial

__all__ = ["FormalIntegral", "formal_integral"]


@dataclass(frozen=True)
class FormalIntegral:
    """A polynomial I in the old variables with {I, H} of degree order + 1 and beyond.

    Parameters
    ----------
    form
        The normal form that it comes from.
    weights
        I = Σ wⱼ Iⱼ in the new variables.
    parts
        Its homogeneous parts in (a, b) of the old variables.
    """

    form: NormalForm
    weights: tuple[int, ...]
    parts: dict[int, PhasePolynomial]

    @cached_property
    def expression(self) -> Expr:
        """The integral as a polynomial in (q, p)."""
        from_equilibrium = {z: z - z0 for z, z0 in self.form.equilibrium.items() if z0 != 0}
        return substitute(sp.expand(self.form.expression(self.parts)), from_equilibrium)

    @cached_property
    def rate(self) -> dict[int, PhasePolynomial]:
        """The homogeneous parts of {I, H} that the given terms of H yield, by degree; the first is what drifts."""
        form = self.form
        return bracket_parts(self.parts, form.original, form.order + 1, form.diagonal.brackets)

    def is_formal_integral(self) -> Verdict:
        """Tell whether {I, H} vanishes to the order, exactly; the evidence says where it begins."""
        started = clock.monotonic()
        first = min(self.rate, default=None)
        question = f"{{I, H}} vanishes to degree {self.form.order}"
        seconds = clock.monotonic() - started
        beyond = "not up to the next degree" if first is None else f"at degree {first}"
        evidence = (Evidence("{I, H} begins", beyond),)
        if first is None or first > self.form.order:
            return Verdict(Status.HOLDS, question, "exact", evidence=evidence, seconds=seconds)
        residual = self.form.expression({first: self.rate[first]})
        return Verdict(Status.FAILS, question, "exact", residual, evidence=evidence, seconds=seconds)


def formal_integral(form: NormalForm, weights: Sequence[int] | None = None) -> FormalIntegral:
    """Return the formal integral Σ wⱼ Iⱼ of a normal form, as a function of the old variables.

    Without weights it is Gustavson's, H₂ of the new variables, divided by nothing: I = H₂ + …

    Parameters
    ----------
    form
        The normal form.
    weights
        Whole numbers w with w·k = 0 for every resonance k that occurs, one for each degree of freedom.

    Raises
    ------
    ValueError
        Where Σ wⱼ Iⱼ does not commute with the normal form, or there are more or fewer weights, or others.

    Examples
    --------
    >>> from canon.mechanics.hamilton.hamiltonian import Hamiltonian
    >>> from canon.mechanics.perturbation.birkhoff import birkhoff_normal_form
    >>> q, p = sp.symbols("q p", real=True)
    >>> form = birkhoff_normal_form(Hamiltonian((p**2 + q**2) / 2 + q**3, q, p), 3)
    >>> formal_integral(form).expression
    p**2/2 + q**3 + q**2/2
    """
    diagonal = form.diagonal
    if weights is None:
        start, chosen = form.original[2], ()
    else:
        chosen = whole_vector(weights, len(form.source.q), "the weights", "degree of freedom")
        ring = diagonal.eigenvalues[0].ring
        start = ring.zero
        for j, w in enumerate(chosen):
            start = start + diagonal.action(j).times(w)
    moving = bracket_parts({2: start}, form.parts, form.order, diagonal.brackets)
    if moving:
        raise ValueError(
            f"the actions with weights {chosen or 'of H₂'} do not commute with the normal form: its part of degree "
            f"{min(moving)} has a resonance that they are not orthogonal to"
        )
    return FormalIntegral(form, chosen, form.from_normal({2: start}))
