"""Gauge integrals: Sᵢ = ∫ Aᵢ dqᵢ of a vector potential in closed form, which shift momenta in magnetic splittings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.kernel.magnetic.gauge_shifts import GaugeShifts
from canon.kernel.magnetic.magnetic_form import NotMagneticError, magnetic_form
from canon.mechanics.algebra.table_integrals import table_integral
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["gauge_shifts"]


def gauge_shifts(system: HamiltonEquations) -> GaugeShifts:
    """Return the parts of H = Σ (p − A)²/2m + φ with the integrals of A.

    Raises
    ------
    NotMagneticError
        H is not of that form or holds the time, or an integral is not known in closed form.
    """
    form, graph = magnetic_form(system), system.graph
    if form.relativistic is not None:
        raise NotMagneticError(
            "MagneticSplitting is for H = Σ (p − A)²/2m + φ, and this is a relativistic charge's; use Boris(), "
            "Gauss(6) or Taylor()"
        )
    if not system.autonomous:
        raise NotMagneticError(
            "H holds the time: MagneticSplitting is for H(q, p); use Boris(), Gauss(6) or Taylor()"
        )
    n = len(form.force) // (1 + system.variations)
    shifts: list[tuple[tuple[tuple[int, int], ...], ...]] = []
    for i, (node, q) in enumerate(zip(form.vector_potential[:n], system.q, strict=False)):
        if node == graph.zero:
            continue
        others = [j for j in range(n) if j != i and system.q[j] in graph.symbols(node)]
        pushes = [(i, node)]
        if others:
            S = graph.from_sympy(_integral(graph.to_sympy(node), q))
            pushes += [(j, graph.derivative(S, system.q[j])) for j in others]
        shifts.append((tuple(pushes), *_of_deviations(system, pushes, n)))
    return GaugeShifts(form, tuple(shifts))


def _of_deviations(
    system: HamiltonEquations, pushes: Sequence[tuple[int, int]], n: int
) -> Iterator[tuple[tuple[int, int], ...]]:
    """Yield what the same part does to each deviation: the derivative of every push."""
    graph, q = system.graph, system.q[:n]
    for first in range(n, n * (1 + system.variations), n):
        delta = [graph.symbol(s) for s in system.q[first : first + n]]
        yield tuple(
            (
                first + j,
                graph.add([graph.mul(pair) for pair in zip(graph.gradient(node, q), delta, strict=True)]),
            )
            for j, node in pushes
        )


def _integral(A: Expr, q: Symbol) -> Expr:
    """Return ∫ A dq, proved."""
    found = [table_integral(term, q) for term in sp.Add.make_args(sp.expand(A))]
    S = sp.Add(*(term for term in found if term is not None))
    rest = sp.expand(S.diff(q) - A)
    if None in found or not (rest == 0 or vanishes(rest).holds):
        raise NotMagneticError(
            f"∫ {A} d{q} is not known in closed form: choose another gauge, or use Boris(), Gauss(6) or Taylor()"
        )
    return S
