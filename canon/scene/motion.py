"""Scenes in motion: any scene's equations of first order on one graph, carried by heyoka's Taylor method.

The variables are (q, p) always, so that momenta of ignorable coordinates stay exactly what they are. A Lagrangian with
its forces and constraints gives p = M q̇ + b, ṗ = ∂L/∂q + Q + Aᵀλ, all solved by L D Lᵀ on the graph; λ follows from
M q̈ − Aᵀλ = f, A q̈ = −γ, where 2α ġ + α² f is added to the differentiated constraints, so that round-off off the
constraints dies out (J. Baumgarte, Comput. Methods Appl. Mech. Eng. 1, 1 (1972), doi:10.1016/0045-7825(72)90018-7).
Where the energy is not conserved the work W = ∫ P dt is carried along, P = Q·q̇ − Σ λ a₀ − ∂L/∂t, and E − W is constant.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon.expression.arithmetic import LONGDOUBLE
from canon.expression.graph import Graph
from canon.expression.symbol import momentum, velocity
from canon.flow.stepping import NonFiniteStateError
from canon.flow.variation import Field, exact_numbers
from canon.kernel.taylor import heyoka_expressions
from canon.mechanics.constrained_derivation import constrained, constrained_motion
from canon.mechanics.derivation import derivation_of_lagrangian
from canon.mechanics.factorisation import solved_on_graph
from canon.scene.parts import SceneError, Start, multiplier

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray
    from sympy import Expr, Symbol

    from canon.mechanics.derivation import Equations
    from canon.scene.scene import Scene

    Array = NDArray[np.float64]

__all__ = ["Equation", "Motion", "equation_of", "first_zero", "run", "start_state"]

_PULL = 12.0
"""How many times in a period a deviation from the constraints falls by a factor e."""

_COMPACT_FROM = 60
"""Equations with more operations are compiled in heyoka's compact mode."""

_TURN_HIGH, _TURN_LOW = 6.28125, 1.9353071795864769e-03
"""2π in two parts, the first with so few digits that a multiple of it is exact."""

_WORK = sp.Dummy("W")


@dataclass(frozen=True, eq=False)
class Equation:
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

    field: Field
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


@dataclass(frozen=True, eq=False)
class Motion:
    """A sampled motion of a scene.

    Parameters
    ----------
    scene, start
        What moved, and from where.
    equation
        Its equations.
    t
        Sample times, shape (times,).
    x
        States (q, p), with W last where the energy is not conserved; shape (variables, times). Angles are within
        half a turn of 0.
    turns
        How many whole turns the variables have made besides, shape (variables, times).
    steps
        Steps of the integrator.
    """

    scene: Scene
    start: Start
    equation: Equation
    t: Array
    x: Array
    turns: Array
    steps: int

    @property
    def q(self) -> Array:
        """Coordinates, shape (n, times), angles with all their turns."""
        n = len(self.scene.q)
        return self.x[:n] + 2.0 * np.pi * self.turns[:n]

    def values(self, nodes: Sequence[int]) -> NDArray[Any]:
        """Return the values of nodes along the motion, evaluated in long double, shape (nodes, times)."""
        field = self.equation.field
        turn = 2 * LONGDOUBLE.named("pi")
        wide = (*(self.x.astype(np.longdouble) + turn * self.turns), self.t.astype(np.longdouble))
        found = field.graph.evaluate(nodes, dict(zip((*field.x, field.t), wide, strict=True)), LONGDOUBLE)
        return np.array([np.broadcast_to(np.asarray(f, np.longdouble), self.t.shape) for f in found])

    def observed(self, f: Expr) -> Array:
        """Return a function of q, q̇, p and t along the motion, shape (times,)."""
        return self.values([self.equation.node(f, str(f))])[0].astype(np.float64)


def equation_of(scene: Scene) -> Equation:
    """Return a scene's equations of motion.

    Examples
    --------
    >>> from canon.scene import find
    >>> found = equation_of(find("simple-pendulum"))
    >>> found.field.x
    (theta, p_theta)
    """
    if scene.H_of is not None and scene.L_of is None and scene.bodies_of is None:
        return _hamiltonian_equation(scene)
    return _lagrangian_equation(scene)


def run(
    scene: Scene, start: str | Start | None = None, periods: float = 100.0, samples: int = 1009
) -> Motion:
    """Return the motion of a scene over some periods, by heyoka's Taylor method to round-off.

    Parameters
    ----------
    scene
        The scene, with the values of its parameters.
    start
        One of its starts, by name, or another; its first one unless given.
    periods
        Duration in the scene's periods.
    samples
        How many evenly spaced states to keep after the first; a prime meets other phases in each period.

    Raises
    ------
    canon.flow.stepping.NonFiniteStateError
        The motion can't be continued over the whole span.

    Examples
    --------
    >>> from canon.scene import find
    >>> motion = run(find("simple-pendulum"), "small", periods=1, samples=4)
    >>> motion.q.round(3) + 0.0
    array([[ 0.1,  0. , -0.1,  0. ,  0.1]])
    """
    if not periods > 0.0:
        raise SceneError(f"periods={periods}: a motion takes some time")
    chosen = start if isinstance(start, Start) else scene.start(start)
    equation = equation_of(scene)
    times = np.linspace(0.0, periods * scene.period, samples + 1)
    y0 = start_state(scene, chosen, equation)
    angles = [s.name in scene.angles.split() for s in scene.q]
    x, turns, steps = _carried(equation.field, y0, times, np.flatnonzero(angles))
    return Motion(scene, chosen, equation, times, x, turns, steps)


def _carried(field: Field, y0: Array, times: Array, angles: NDArray[np.intp]) -> tuple[Array, Array, int]:
    """Return states and turns at the times, and the steps taken; angles are turned back as they grow.

    An angle that went on growing would be rounded to ever fewer digits, and heyoka's steps with it, as their error is
    relative to the largest variable.
    """
    import heyoka as hy

    large = len(field.graph.reachable(field.rates)) > _COMPACT_FROM
    integrator = hy.taylor_adaptive(field.heyoka_pairs(), y0, compact_mode=large)
    turns = np.zeros(len(field.x))
    rows, whole, steps = [y0], [turns.copy()], 0
    slices = len(times) - 1 if angles.size else 1
    for part in np.array_split(np.arange(1, len(times)), slices):
        outcome, _, _, taken, _, found = integrator.propagate_grid(times[part[0] - 1 : part[-1] + 1])
        if outcome != hy.taylor_outcome.time_limit or not np.isfinite(found).all():
            raise NonFiniteStateError(
                f"the motion can't be continued after t = {integrator.time:.9g} ({outcome}): a collision or the edge "
                "of the equations' domain; take fewer periods",
                float(integrator.time),
                np.array(integrator.state),
            )
        steps += int(taken)
        state = integrator.state
        back = np.round(state[angles] / (2.0 * np.pi))
        state[angles] = (state[angles] - back * _TURN_HIGH) - back * _TURN_LOW
        rows += [*found[1:-1], state.copy()]
        whole += [turns.copy()] * (len(part) - 1)
        turns[angles] += back
        whole.append(turns.copy())
    return np.array(rows).T, np.array(whole).T, steps


def first_zero(scene: Scene, start: str | None, f: Expr, periods: float) -> Motion:
    """Return the motion up to the first instant at which f(q, q̇, p, t) vanishes: its start and that instant.

    Raises
    ------
    canon.flow.stepping.NonFiniteStateError
        f does not vanish within these periods, or the motion ends before.

    Examples
    --------
    A pendulum let go at 0.1 rad is at its lowest after a quarter of its period, T = 2π √(l/g) (1 + θ₀²/16 + …):

    >>> from canon.scene import find
    >>> scene = find("simple-pendulum")
    >>> quarter = first_zero(scene, "small", scene.q[0], periods=1).t[-1]
    >>> float((4 * quarter / scene.period - 1).round(6))
    0.000625
    """
    import heyoka as hy

    chosen, equation = scene.start(start), equation_of(scene)
    field = equation.field
    pairs = field.heyoka_pairs()
    variables = {s: pair[0] for s, pair in zip(field.x, pairs, strict=True)} | {field.t: hy.time}
    crossing = heyoka_expressions(field.graph, [equation.node(f, "the event")], variables)[0]
    y0 = start_state(scene, chosen, equation)
    integrator = hy.taylor_adaptive(pairs, y0, t_events=[hy.t_event(crossing)], compact_mode=True)
    outcome, _, _, steps, _, _ = integrator.propagate_until(periods * scene.period)
    if int(outcome) not in (-1, 0) or not np.isfinite(integrator.state).all():
        raise NonFiniteStateError(
            f"{f} does not vanish before t = {integrator.time:.9g} ({outcome}); follow the motion longer",
            float(integrator.time),
            np.array(integrator.state),
        )
    t = np.array([0.0, float(integrator.time)])
    x = np.array([y0, integrator.state]).T
    return Motion(scene, chosen, equation, t, x, np.zeros_like(x), int(steps))


def start_state(scene: Scene, start: Start, equation: Equation) -> Array:
    """Return the state to start from: (q, p), put onto the constraints, and W = 0 where work is done."""
    state, n = scene.state(start), len(scene.q)
    if equation.residuals:
        if start.v is None:
            raise SceneError(f"the start {start.name!r} of {scene.name} has constraints: give it velocities")
        bound = scene.constrained
        equations = constrained(
            derivation_of_lagrangian(scene.lagrangian), bound.holonomic, bound.nonholonomic
        )
        motion = constrained_motion(equations, scene.values_by_symbol())
        place, speed = (x.tolist() for x in motion.projected(start.q, start.v, 0.0))
        state = scene.state(Start(start.name, start.about, tuple(place), v=tuple(speed)))
    return np.append(state, 0.0) if len(equation.field.x) > 2 * n else state


def _hamiltonian_equation(scene: Scene) -> Equation:
    graph, hamiltonian = Graph(), scene.hamiltonian
    x, n, t = (*hamiltonian.q, *hamiltonian.p), len(hamiltonian.q), hamiltonian.t
    numbers = exact_numbers({**scene.values})
    H = Field(graph, x, t, numbers, ()).node(hamiltonian.H, "the Hamiltonian")
    slopes = graph.gradient(H, x)
    rates = (*slopes[n:], *map(graph.negative, slopes[:n]))
    named: dict[Symbol, int] = dict(zip(map(velocity, hamiltonian.q), slopes[n:], strict=True))
    field = Field(graph, x, t, numbers, rates)
    return _with_work(Equation(field, H, graph.zero, (), named), graph.derivative(H, t))


def _lagrangian_equation(scene: Scene) -> Equation:
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
    field = Field(graph, (*q, *p), t, numbers, rates)
    made = Equation(field, energy, graph.zero, tuple(nodes), named, multipliers)
    return _with_work(made, power)


def _velocities(found: Equations, momenta: Sequence[int], p: Sequence[Symbol]) -> tuple[int, ...]:
    """Return the nodes of q̇ from M q̇ = p − b."""
    graph, v = found.graph, found.velocities
    if any(graph.symbols(node) & set(v) for row in found.M for node in row):
        raise SceneError("L is not quadratic in the velocities; give the scene its Hamiltonian by H_of")
    drift = graph.substitute(momenta, {graph.symbol(w): graph.zero for w in v})
    excess = [graph.add((graph.symbol(s), graph.negative(b))) for s, b in zip(p, drift, strict=True)]
    return solved_on_graph(graph, found.M, excess)


def _constraints(
    scene: Scene, found: Equations
) -> tuple[list[int], tuple[int, ...], tuple[int, ...], tuple[tuple[int, ...], ...]]:
    """Return residuals, multipliers λ, a₀ and A of the scene's constraints as nodes in q, q̇, t."""
    if not (scene.holonomic_of or scene.nonholonomic_of):
        return [], (), (), ()
    graph, add, mul = found.graph, found.graph.add, found.graph.mul
    bound = scene.constrained
    system = constrained(found, bound.holonomic, bound.nonholonomic)
    pull = graph.number(Fraction(_PULL / scene.period).limit_denominator(10**6))
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


def _with_work(equation: Equation, power: int) -> Equation:
    """Return the equations with the work as a further variable where power is exchanged."""
    field = equation.field
    if power == field.graph.zero:
        return equation
    worked = Field(field.graph, (*field.x, _WORK), field.t, field.numbers, (*field.rates, power))
    return replace(equation, field=worked, work=field.graph.symbol(_WORK))
