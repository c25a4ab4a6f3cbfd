"""Commutator {H₁, {H₀, H₁}} of a perturbation H₁(q): a function of q, so that kicks can include it with H₁.

With A = ∂²H₀/∂p² it is −Σ A_ij ∂_iH₁ ∂_jH₁; the kick by τH₁ + γτ³ {H₁, {H₀, H₁}} adds 2γτ³ Σ A_ij ∂_i∂_kH₁ ∂_jH₁ to
−τ ∂_kH₁.

Source: J. Laskar, P. Robutel, High order symplectic integrators for perturbed Hamiltonian systems, Celest. Mech. Dyn.
Astron. 80 (2001) 39–62, doi:10.1023/A:1012098603882, § 6.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["commutator_force"]


def commutator_force(rest: HamiltonEquations, inverse_mass: Sequence[Sequence[Fraction]]) -> tuple[int, ...]:
    """Return the nodes of ∂_k(½ Σ A_ij ∂_iH₁ ∂_jH₁) in the graph of H₁'s equations of motion.

    Parameters
    ----------
    rest
        The equations of H₁, a function of q.
    inverse_mass
        A, symmetric.
    """
    graph = rest.graph
    terms = [
        graph.scaled(a / 2, graph.mul((rest.force[i], rest.force[j])))
        for i, row in enumerate(inverse_mass)
        for j, a in enumerate(row)
        if a
    ]
    return graph.gradient(graph.add(terms), rest.q)
