"""Variational equations: Hamilton's equations together with those of small deviations from a motion."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp

if TYPE_CHECKING:
    from sympy import Symbol

    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["of_all_variables", "variational"]


_SYSTEMS = 16
"""Systems whose variational equations are kept: Newton's method asks for those of one system again and again."""


@functools.lru_cache(maxsize=_SYSTEMS)
def of_all_variables(system: HamiltonEquations) -> HamiltonEquations:
    """Return equations in which what differs from orbit to orbit, or fills up a half, is a variable like others."""
    return replace(system, varying=0, spare=0)


@functools.lru_cache(maxsize=_SYSTEMS)
def variational(system: HamiltonEquations, variations: int) -> HamiltonEquations:
    """Return the equations of (q, δq; p, δp) with so many variations δ: δẋ_i = Σ_j ∂ẋ_i/∂x_j δx_j.

    A velocity ∂H/∂p gives δq̇ and a force gives δṗ, so that what splits still splits. Splitting and Runge–Kutta
    methods commute with differentiation: a step of these equations is the step of Hamilton's equations and,
    exactly, its derivative (E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, 2nd ed., Springer
    2006, Lemma VI.4.1).

    Parameters
    ----------
    system
        Hamilton's equations, without parameters that vary.
    variations
        How many variations.

    Raises
    ------
    ValueError
        The method keeps constraints itself, or moves by the flows of parts of H.
    """
    if system.keeps_constraints:
        raise ValueError(
            "the derivative of steps that keep constraints themselves is not known here: use Taylor() or Gauss(6), "
            "whose variations hold where they keep the constraints"
        )
    if system.lagrangian is not None:
        raise ValueError(
            "the derivative of steps of a discrete action is not known here: use Taylor(), DOP853() or Gauss(6), or "
            "hamiltonian(L) with a Gauss method, whose steps are symplectic too"
        )
    if system.lie_poisson is not None:
        raise ValueError(
            "variational equations are no sum of parts that a Lie–Poisson splitting moves by: it has a tangent loop of "
            "its own; use Taylor(), DOP853() or Gauss(6)"
        )
    graph, x = system.graph, (*system.q, *system.p)
    slopes = [graph.gradient(rate, x) for rate in (*system.velocity, *system.force)]
    n = len(system.q)
    q, p, velocity, force = list(system.q), list(system.p), list(system.velocity), list(system.force)
    for _ in range(variations):
        varied: list[Symbol] = [sp.Dummy(f"delta_{s.name}", real=True) for s in x]
        nodes = [graph.symbol(s) for s in varied]
        rates = [graph.add([graph.mul([a, b]) for a, b in zip(row, nodes, strict=True)]) for row in slopes]
        q += varied[:n]
        p += varied[n:]
        velocity += rates[:n]
        force += rates[n:]
    return replace(
        system,
        q=tuple(q),
        p=tuple(p),
        written=system.moving_by(velocity, force),
        variations=system.variations + variations,
    )
