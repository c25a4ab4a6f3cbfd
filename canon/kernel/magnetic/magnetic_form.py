"""Magnetic form of a Hamiltonian: H = Σ wᵢ (pᵢ − Aᵢ(q, t))²/2 + φ(q, t), recognised in its equations.

With kinetic momenta π = p − A the motion is q̇ᵢ = wᵢ πᵢ, π̇ᵢ = Eᵢ + Σ Bᵢⱼ wⱼ πⱼ, E = −∂φ/∂q − ∂A/∂t and
Bᵢⱼ = ∂Aⱼ/∂qᵢ − ∂Aᵢ/∂qⱼ: charges in fields, and bodies in rotating frames, where A = m Ω × r.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.kernel.magnetic.relativistic_form import relativistic_form

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.expression.graph.graph import Graph
    from canon.kernel.magnetic.relativistic_form import RelativisticForm
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["MagneticForm", "NotMagneticError", "magnetic_form"]


class NotMagneticError(ValueError):
    """H is not of the form Σ (p − A)²/2m + φ; the message says what is not."""


@dataclass(frozen=True, eq=False)
class MagneticForm:
    """The parts of H = Σ wᵢ (pᵢ − Aᵢ)²/2 + φ, nodes on the graph of its equations.

    Parameters
    ----------
    inverse_masses
        wᵢ, free of q, p and t; of a relativistic charge what is above the root in w.
    vector_potential
        Aᵢ(q, t), the charge being part of it.
    force
        Eᵢ(q, t).
    field
        Bᵢⱼ(q, t), row by row: antisymmetric but where deviations move along.
    relativistic
        The parts of H where it is not this sum but that of a relativistic charge.
    """

    inverse_masses: tuple[int, ...]
    vector_potential: tuple[int, ...]
    force: tuple[int, ...]
    field: tuple[tuple[int, ...], ...]
    relativistic: RelativisticForm | None = None

    def blocks(self, zero: int) -> tuple[tuple[int, ...], ...]:
        """Return the sets of coordinates that B mixes, those of one coordinate included."""
        left, found = [*range(len(self.force))], list[tuple[int, ...]]()
        while left:
            block = [left.pop(0)]
            for i in block:
                more = [j for j in left if self.field[i][j] != zero or self.field[j][i] != zero]
                block += more
                left = [j for j in left if j not in more]
            found.append(tuple(sorted(block)))
        return tuple(found)


def magnetic_form(system: HamiltonEquations) -> MagneticForm:
    """Return the parts of a Hamiltonian in magnetic form.

    Raises
    ------
    NotMagneticError
        It is none.
    """
    graph, n = system.graph, len(system.q) - system.varying
    q, p, velocity = system.q[:n], system.p[:n], system.velocity[:n]
    relativistic = relativistic_form(system)
    if relativistic is not None and system.variations:
        raise NotMagneticError(
            "the derivative of Boris's step of a relativistic charge is not known here: use Taylor() or Gauss(6)"
        )
    if relativistic is not None:
        return _of_relativistic(system, relativistic, n)
    inverse_masses = [_inverse_mass(system, i, n) for i in range(n)]
    at_rest = graph.substitute(velocity, {graph.symbol(s): graph.zero for s in p})
    A = [graph.negative(a) for a in _quotients(graph, at_rest, inverse_masses)]
    still = graph.substitute(system.force[:n], {graph.symbol(s): a for s, a in zip(p, A, strict=True)})
    force = [
        graph.add((f, graph.negative(graph.derivative(a, system.t)))) for f, a in zip(still, A, strict=True)
    ]
    slopes = [graph.gradient(a, q) for a in A]
    turning = [[slopes[j][i] for j in range(n)] for i in range(n)]
    if system.variations:  # ∂Aⱼ/∂qᵢ is not what momenta do to their forces, as it else is
        turning = [_quotients(graph, graph.gradient(f, p), inverse_masses) for f in system.force[:n]]
    field = tuple(
        tuple(graph.add((turning[i][j], graph.negative(slopes[i][j]))) for j in range(n)) for i in range(n)
    )
    return MagneticForm(tuple(inverse_masses), tuple(A), tuple(force), field)


def _of_relativistic(system: HamiltonEquations, given: RelativisticForm, n: int) -> MagneticForm:
    graph, q, A = system.graph, system.q[:n], given.vector_potential
    pulls = graph.gradient(given.potential, q)
    force = [
        graph.negative(graph.add((pull, graph.derivative(a, system.t))))
        for pull, a in zip(pulls, A, strict=True)
    ]
    slopes = [graph.gradient(a, q) for a in A]
    field = tuple(
        tuple(graph.add((slopes[j][i], graph.negative(slopes[i][j]))) for j in range(n)) for i in range(n)
    )
    return MagneticForm((given.factor,) * n, A, tuple(force), field, given)


def _quotients(graph: Graph, above: Sequence[int], below: Sequence[int]) -> list[int]:
    return [graph.mul((a, graph.power(b, -1))) for a, b in zip(above, below, strict=True)]


def _inverse_mass(system: HamiltonEquations, i: int, n: int) -> int:
    """Return the node of ∂²H/∂pᵢ², which is to depend on nothing that moves.

    Raises
    ------
    NotMagneticError
        It does, or the velocity holds another momentum.
    """
    graph, q, p = system.graph, system.q[:n], system.p[:n]
    slopes = graph.gradient(system.velocity[i], p)
    others = [p[j].name for j in range(n) if j != i and slopes[j] != graph.zero]
    if others:
        raise _refusal(f"∂H/∂{p[i]} depends on {', '.join(others)}")
    if slopes[i] == graph.zero or graph.all_symbols([slopes[i]]) & {*q, *p, system.t}:
        raise _refusal(f"∂²H/∂{p[i]}² is no inverse of a constant mass")
    return slopes[i]


def _refusal(why: str) -> NotMagneticError:
    return NotMagneticError(
        f"H is not Σ (p − A)²/2m + φ with constant masses, {why}; use Gauss(6), SemiexplicitSplitting(4) or Taylor()"
    )
