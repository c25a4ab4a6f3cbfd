"""Scenes' equations of motion: of first order, all on one graph, whatever a scene is given by.

The variables are (q, p) always, so that momenta of ignorable coordinates stay exactly what they are. A Lagrangian with
its forces and constraints gives p = M q̇ + b, ṗ = ∂L/∂q + Q + Aᵀλ, all solved by L D Lᵀ on the graph; λ follows from
M q̈ − Aᵀλ = f, A q̈ = −γ, where 2α ġ + α² f is added to the differentiated constraints, so that round-off off the
constraints dies out (J. Baumgarte, Comput. Methods Appl. Mech. Eng. 1, 1 (1972), doi:10.1016/0045-7825(72)90018-7).
Where the energy is not conserved the work W = ∫ P dt is carried along, P = Q·q̇ − Σ λ a₀ − ∂L/∂t, and E − W is constant.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

from canon.expression.graph.graph import Graph
from canon.expression.symbols.symbol import momentum, velocity
from canon.flow.geometry.vector_field_motion import VectorFieldSystem
from canon.kernel.program.hamilton_equations import exact_numbers
from canon.mechanics.at_scale.constrained import constrained
from canon.mechanics.at_scale.ldl import solved_on_graph
from canon.mechanics.at_scale.second_order import derivation_of_lagrangian
from canon.scene.parts import SceneError, multiplier

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.mechanics.at_scale.second_order import SecondOrderEquations
    from canon.scene.scene import Scene

__all__ = ["SceneEquations", "scene_equations"]

_PULL = 12.0
"""How many times in a period a deviation from the constraints falls by a factor e."""

_WORK = sp.Dummy("W")


@dataclass(frozen=True, eq=False)
class SceneEquations:
    """A scene's equations of motion ẋ = X(x, t), numbers put in for the parameters.

    Parameters
    ----------
    field
        The equations; x is (q, p), followed by the work W where the energy is not conserved.
    energy
        H, or Jacobi's energy Σ q̇ ∂L/∂q̇ − L, a node.
    work
        The node of W, or of 0.
    residuals
        Nodes that the constraints make vanish: f(q, t) and A q̇ + a₀.
    rates
        The nodes of q̇.
    multipliers
        The nodes of λ.
    """

    field: VectorFieldSystem
    energy: int
    work: int
    residuals: tuple[int, ...]
    rates: Mapping[Symbol, int]
    multipliers: tuple[int, ...] = ()

    def node(self, f: Expr, what: str) -> int:
        """Return the node of a function of q, q̇, p, t, the parameters and the multipliers λ."""
        graph = self.field.graph
        general = graph.from_sympy(sp.sympify(f, strict=True))
        given = {multiplier(i): node for i, node in enumerate(self.multipliers, 1)} | dict(self.rates)
        known = {
            graph.symbol(s): given[s] if s in given else graph.number(self.field.numbers[s.name])
            for s in graph.symbols(general)
            if s in given or s.name in self.field.numbers
        }
        found = graph.substitute([general], known)[0]
        unknown = graph.symbols(found) - {*self.field.x, self.field.t}
        if unknown:
            raise SceneError(f"{what} holds {', '.join(sorted(map(str, unknown)))}, which the scene lacks")
        return found


def scene_equations(scene: Scene) -> SceneEquations:
    """Return a scene's equations of motion.

    Examples
    --------
    >>> from canon.scene import find
    >>> found = scene_equations(find("simple-pendulum"))
    >>> found.field.x
    (theta, p_theta)
    """
    return _lagrangian_equation(scene) if scene.has_lagrangian else _hamiltonian_equation(scene)


def _hamiltonian_equation(scene: Scene) -> SceneEquations:
    graph, hamiltonian = Graph(), scene.hamiltonian
    x, n, t = (*hamiltonian.q, *hamiltonian.p), len(hamiltonian.q), hamiltonian.t
    numbers = exact_numbers({**scene.values})
    H = VectorFieldSystem(graph, x, t, numbers, ()).node(hamiltonian.H, "the Hamiltonian")
    slopes = graph.gradient(H, x)
    rates = (*slopes[n:], *map(graph.negative, slopes[:n]))
    named: dict[Symbol, int] = dict(zip(map(velocity, hamiltonian.q), slopes[n:], strict=True))
    field = VectorFieldSystem(graph, x, t, numbers, rates)
    return _with_work(SceneEquations(field, H, graph.zero, (), named), graph.derivative(H, t))


def _lagrangian_equation(scene: Scene) -> SceneEquations:
    lagrangian = scene.lagrangian
    q, v, t = lagrangian.q, lagrangian.velocities, lagrangian.t
    found = derivation_of_lagrangian(lagrangian)
    graph, add, n = found.graph, found.graph.add, len(q)
    L = graph.from_sympy(lagrangian.L)
    both = graph.gradient(L, (*q, *v))
    Q = [graph.from_sympy(force) for force in lagrangian.forces] or [graph.zero] * n
    residuals, multipliers, rests, A = _constraints(scene, found)
    reactions = [_dot(graph, multipliers, [row[i] for row in A]) for i in range(n)]
    p_dot = [add(terms) for terms in zip(both[:n], Q, reactions, strict=True)]
    speeds = [graph.symbol(w) for w in v]
    energy = add((_dot(graph, speeds, both[n:]), graph.negative(L)))
    lost = (_dot(graph, multipliers, rests), graph.derivative(L, t))
    power = add((_dot(graph, Q, speeds), *map(graph.negative, lost)))
    p = tuple(map(momentum, q))
    q_dot = _velocities(found, both[n:], p)
    numbers = exact_numbers({**scene.values})
    known = {graph.symbol(s): graph.number(numbers[s.name]) for s in scene.values_by_symbol()}
    q_dot = graph.substitute(q_dot, known)
    named: dict[Symbol, int] = dict(zip(v, q_dot, strict=True))
    known.update(zip(speeds, q_dot, strict=True))
    nodes = iter(graph.substitute((*p_dot, power, energy, *multipliers, *residuals), known))
    rates = (*q_dot, *(next(nodes) for _ in p_dot))
    power, energy = next(nodes), next(nodes)
    multipliers = tuple(next(nodes) for _ in multipliers)
    field = VectorFieldSystem(graph, (*q, *p), t, numbers, rates)
    made = SceneEquations(field, energy, graph.zero, tuple(nodes), named, multipliers)
    return _with_work(made, power)


def _velocities(found: SecondOrderEquations, momenta: Sequence[int], p: Sequence[Symbol]) -> tuple[int, ...]:
    """Return the nodes of q̇ from M q̇ = p − b."""
    graph, v = found.graph, found.velocities
    if any(graph.symbols(node) & set(v) for row in found.M for node in row):
        raise SceneError("L is not quadratic in the velocities; give the scene its Hamiltonian by H_of")
    drift = graph.substitute(momenta, {graph.symbol(w): graph.zero for w in v})
    excess = [graph.add((graph.symbol(s), graph.negative(b))) for s, b in zip(p, drift, strict=True)]
    return solved_on_graph(graph, found.M, excess)


def _constraints(
    scene: Scene, found: SecondOrderEquations
) -> tuple[list[int], tuple[int, ...], tuple[int, ...], tuple[tuple[int, ...], ...]]:
    """Return residuals, multipliers λ, a₀ and A of the scene's constraints as nodes in q, q̇, t."""
    if not scene.is_constrained:
        return [], (), (), ()
    graph, add, mul = found.graph, found.graph.add, found.graph.mul
    bound = scene.constrained
    system = constrained(found, bound.holonomic, bound.nonholonomic)
    fast = Fraction(_PULL / scene.period)
    pull = graph.number(fast.limit_denominator(max(10**6, round(1000 / fast))))  # to 1e-3, however slow
    speeds = [graph.symbol(w) for w in found.velocities]
    rates = [add((_dot(graph, row, speeds), a0)) for row, a0 in zip(system.A, system.rests, strict=True)]
    right, lower = list(found.f), [list(row) for row in found.M]
    for i, (curvature, rate) in enumerate(zip(system.curvatures, rates, strict=True)):
        terms = [curvature, mul((graph.number(2), pull, rate))]
        if i < len(system.values):
            terms.append(mul((pull, pull, system.values[i])))
        right.append(graph.negative(add(terms)))
        lower.append([*system.A[i], *[graph.zero] * (i + 1)])
    solved = solved_on_graph(graph, lower, right)
    multipliers = tuple(map(graph.negative, solved[len(found.q) :]))
    return [*system.values, *rates], multipliers, system.rests, system.A


def _dot(graph: Graph, a: Sequence[int], b: Sequence[int]) -> int:
    return graph.add([graph.mul(pair) for pair in zip(a, b, strict=True)])


def _with_work(equation: SceneEquations, power: int) -> SceneEquations:
    """Return the equations with the work as a further variable where power is exchanged."""
    field = equation.field
    if power == field.graph.zero:
        return equation
    worked = VectorFieldSystem(field.graph, (*field.x, _WORK), field.t, field.numbers, (*field.rates, power))
    return replace(equation, field=worked, work=field.graph.symbol(_WORK))
