"""Relativistic form of a Hamiltonian: H = κ √(µ + s (p − A(q, t))²) + φ(q, t), c √(m²c² + (p − A)²) of a fast charge.

With π = p − A the velocity is q̇ = w π with w = κ s/√(µ + s π²), the same for all coordinates; forces are as in
:mod:`canon.kernel.magnetic.magnetic_form`. Along a turn of π by the magnetic field w does not change.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

if TYPE_CHECKING:
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["RelativisticForm", "relativistic_form"]


@dataclass(frozen=True, eq=False)
class RelativisticForm:
    """The parts of H = κ √(µ + s (p − A)²) + φ, nodes on the graph of its equations.

    Parameters
    ----------
    factor
        κ s, free of q, p and t.
    rest, slope
        µ and s, free of them too.
    vector_potential
        A.
    potential
        φ.
    """

    factor: int
    rest: int
    slope: int
    vector_potential: tuple[int, ...]
    potential: int


def relativistic_form(system: HamiltonEquations) -> RelativisticForm | None:
    """Return the parts of a Hamiltonian in relativistic form; None where it is none."""
    graph, n = system.graph, (len(system.q) - system.varying) // (1 + system.variations)
    q, p, H = system.q[:n], system.p[:n], system.hamiltonian
    moving, half = {*q, *p, system.t}, graph.number(Fraction(1, 2))
    roots = [
        node
        for node in graph.reachable([H])
        if graph.nodes[node].kind == "pow"
        and graph.nodes[node].operands[1] == half
        and graph.all_symbols([node]) & {*p}
    ]
    if len(roots) != 1:
        return None
    base, symbol = graph.nodes[roots[0]].operands[0], sp.Dummy("root", real=True)
    slopes = graph.gradient(base, p)
    seconds = [graph.gradient(slope, p) for slope in slopes]
    s = graph.scaled(Fraction(1, 2), seconds[0][0])
    for i, row in enumerate(seconds):
        if any(row[j] != (seconds[0][0] if i == j else graph.zero) for j in range(n)):
            return None
    if s == graph.zero:
        return None
    at_rest = graph.substitute(slopes, {graph.symbol(each): graph.zero for each in p})
    inverse = graph.power(graph.scaled(-2, s), -1)
    A = [graph.mul((slope, inverse)) for slope in at_rest]
    (rest,) = graph.substitute([base], {graph.symbol(each): a for each, a in zip(p, A, strict=True)})
    (in_root,) = graph.substitute([H], {roots[0]: graph.symbol(symbol)})
    kappa = graph.derivative(in_root, symbol)
    (phi,) = graph.substitute([in_root], {graph.symbol(symbol): graph.zero})
    if graph.all_symbols([kappa, rest, s]) & {*moving, symbol} or graph.all_symbols([phi]) & {*p}:
        return None
    return RelativisticForm(graph.mul((kappa, s)), rest, s, tuple(A), phi)
