"""Motion in quasi-velocities, and of bodies by Newton and Euler: the state is (q, u), of Newton and Euler (q, q̇).

The equations are linear in the rates of u and are solved on the graph. The energy of bodies is T + V, for Newton and
Euler T alone, V without its part linear in q̇. Where nothing depends on time and q̇ is linear in u it changes by the work
of the forces; where bodies are moved as time says, what moves them does work too, and the rate of the energy along the
motion is taken for it, as it is where q̇ is not proportional to u.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr

from canon.expression.graph.graph import Graph
from canon.expression.symbols.symbol import velocity
from canon.flow.equations.constrained.solved_balances import solved_balances
from canon.flow.equations.first_order_motion import FirstOrderMotion, Residual
from canon.flow.equations.lagrangian_motion import values_at_start
from canon.flow.equations.linear_equations import SingularAtStartError, independent_rows, solved_from_start
from canon.mechanics.algebra.substitution import entry, exchanged
from canon.mechanics.lagrange.appell import cross
from canon.mechanics.lagrange.body import RigidBody
from canon.mechanics.lagrange.quasi_velocity import Kinematics

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator, Mapping, Sequence

    from sympy import Symbol

    from canon.mechanics.lagrange.appell import GibbsAppell
    from canon.mechanics.lagrange.body import Body
    from canon.mechanics.lagrange.newton_euler import NewtonEuler
    from canon.mechanics.lagrange.sympy_bridge import QuasiMotion

__all__ = ["appell_motion", "newton_euler_motion", "quasi_motion"]


def quasi_motion(given: QuasiMotion, start: Mapping[Symbol, float]) -> FirstOrderMotion:
    """Return the first-order equations of motion in quasi-velocities; no energy is known of it.

    Parameters
    ----------
    given
        Kinematics, and as many equations as quasi-velocities.
    start
        Numbers for the state, t and the parameters: pivots are chosen there.

    Raises
    ------
    ValueError
        They do not determine the rates of the quasi-velocities at the start.
    """
    graph, kinematics = Graph(), given.kinematics
    nodes = [graph.from_sympy(e) for e in given.equations]
    rates = _solved(graph, kinematics.u_dot, nodes, start, symmetric=False)
    q_dot, named = _in_quasi_velocities(graph, kinematics, rates)
    letter = _letter(kinematics)
    return FirstOrderMotion(
        "motion in quasi-velocities", graph, kinematics.q, kinematics.u, letter, kinematics.t, (*q_dot, *rates),
        named=named, residuals=tuple(_kept(graph, given)),
    )  # fmt: skip


def _kept(graph: Graph, given: QuasiMotion) -> Iterator[Residual]:
    """Yield what vanishes along a motion that starts on the constraints."""
    yield from (Residual(graph.from_sympy(f), "position") for f in given.holonomic)
    rates = (*map(given.kinematics.rate, given.holonomic), *given.nonholonomic)
    yield from (Residual(graph.from_sympy(g), "rate") for g in rates)


def appell_motion(given: GibbsAppell, start: Mapping[Symbol, float]) -> FirstOrderMotion:
    """Return the first-order equations q̇ = f(q, u, t), ∂S/∂u̇ = U of Gibbs and Appell.

    Parameters
    ----------
    given
        Bodies, V and forces in quasi-velocities.
    start
        Numbers for the state, t and the parameters: pivots are chosen there.

    Raises
    ------
    ValueError
        S does not determine u̇ at the start.
    """
    graph, kinematics = Graph(), given.kinematics
    slopes = graph.gradient(graph.from_sympy(given.gibbs_function), kinematics.u_dot)
    forces = [graph.negative(graph.from_sympy(U)) for U in given.forces]
    nodes = [graph.add(pair) for pair in zip(slopes, forces, strict=True)]
    # A force that holds accelerations joins the inertia on its own row alone.
    symmetric = not graph.all_symbols(forces) & {*kinematics.u_dot}
    rates = _solved(graph, kinematics.u_dot, nodes, start, symmetric=symmetric)
    q_dot, named = _in_quasi_velocities(graph, kinematics, rates)
    energy = graph.from_sympy(_kinetic(given.bodies, kinematics) + _potential_energy(given))
    if _is_linear_in_u(kinematics, given.bodies):
        solved = {graph.symbol(s): node for s, node in zip(kinematics.u_dot, rates, strict=True)}
        along_q = graph.substitute([graph.from_sympy(kinematics.along(Q)) for Q in given.Q], solved)
        work = [graph.mul(pair) for pair in zip(along_q, q_dot, strict=True)]
        driven = graph.from_sympy(kinematics.along(given.V.diff(kinematics.t)))
        power = graph.add((*work, driven))
    else:
        state = (*kinematics.q, *kinematics.u, kinematics.t)
        slopes = graph.gradient(energy, state)
        power = graph.add([graph.mul(pair) for pair in zip(slopes, (*q_dot, *rates, graph.one), strict=True)])
    return FirstOrderMotion(
        "Gibbs–Appell equations", graph, kinematics.q, kinematics.u, _letter(kinematics), kinematics.t,
        (*q_dot, *rates), energy, power, named,
    )  # fmt: skip


def newton_euler_motion(given: NewtonEuler, start: Mapping[Symbol, float]) -> FirstOrderMotion:
    """Return the first-order equations of bodies by Newton and Euler, the reactions known by their symbols.

    Of more balances than unknowns, those that depend on the others at the start are looked at along the motion.

    Parameters
    ----------
    given
        The bodies with their loads.
    start
        Numbers for the state, t and the parameters: pivots are chosen there.

    Raises
    ------
    ValueError
        The balances are not linear in the unknowns, or leave one open at the start.
    """
    graph, unknown, q = Graph(), given.unknowns, given.q
    nodes = [graph.from_sympy(e) for e in given.balances]
    matrix = [graph.gradient(e, unknown) for e in nodes]
    _check_linear(graph, unknown, matrix)
    values = values_at_start(graph, [a for row in matrix for a in row], start, "the matrix of the balances")
    kept = independent_rows(values.reshape(len(nodes), -1))
    if len(kept) < len(unknown):
        raise ValueError(
            f"{len(kept)} independent balances at the start for {', '.join(map(str, unknown))}: too many reactions, a "
            "load is missing, or the bodies stand in a singular place"
        )
    with _singular_in_words(unknown):
        found = solved_balances(graph, given, nodes, start)
    kinematics, v, n = Kinematics(q, t=given.t), tuple(map(velocity, q)), len(q)
    through = {graph.symbol(s): node for s, node in zip(unknown, found, strict=True)}
    rest = graph.substitute([node for i, node in enumerate(nodes) if i not in kept], through)
    power = graph.substitute([graph.from_sympy(_power_of_loads(given, kinematics))], through)[0]
    return FirstOrderMotion(
        kind="Newton–Euler equations",
        graph=graph,
        q=q,
        second=v,
        letter="v",
        t=given.t,
        rates=(*map(graph.symbol, v), *found[:n]),
        energy=graph.from_sympy(_kinetic(given.bodies, kinematics)),
        power=power,
        named=dict(zip(unknown, found, strict=True)),
        residuals=tuple(Residual(node, "balance", left_out=True) for node in rest if node != graph.zero),
    )


def _check_linear(graph: Graph, unknown: Sequence[Symbol], matrix: Sequence[Sequence[int]]) -> None:
    if graph.all_symbols([a for row in matrix for a in row]) & {*unknown}:
        raise ValueError(f"the equations are not linear in {', '.join(map(str, unknown))}")


def _solved(
    graph: Graph,
    unknown: Sequence[Symbol],
    nodes: Sequence[int],
    start: Mapping[Symbol, float],
    *,
    symmetric: bool,
) -> tuple[int, ...]:
    """Return the unknowns of equations that are affine in them, each node = 0."""
    matrix = [list(graph.gradient(e, unknown)) for e in nodes]
    _check_linear(graph, unknown, matrix)
    still = {graph.symbol(s): graph.zero for s in unknown}
    right = [graph.negative(e) for e in graph.substitute(nodes, still)]
    values = values_at_start(graph, [a for row in matrix for a in row], start, "the mass matrix")
    with _singular_in_words(unknown):
        return solved_from_start(graph, matrix, right, values.reshape(len(nodes), -1), symmetric=symmetric)


@contextmanager
def _singular_in_words(unknown: Sequence[Symbol]) -> Generator[None]:
    """Say which unknowns a matrix that is singular at the start leaves open."""
    try:
        yield
    except SingularAtStartError as singular:
        held = [str(s) for s, x in zip(unknown, singular.direction, strict=False) if abs(x) > 1e-6]
        raise ValueError(
            f"the mass matrix is singular at the start along {', '.join(held)}: the equations do not determine them "
            "there. Start elsewhere, or use other coordinates"
        ) from None


def _in_quasi_velocities(
    graph: Graph, kinematics: Kinematics, rates: Sequence[int]
) -> tuple[list[int], dict[Symbol, int]]:
    """Return the nodes of q̇, and what q̇, q̈ and u̇ are called."""
    q_dot = [graph.from_sympy(f) for f in kinematics.q_dot]
    own = {velocity(s): node for s, node in zip(kinematics.q, q_dot, strict=True)}
    named: dict[Symbol, int] = {s: node for s, node in own.items() if s not in kinematics.u}
    return q_dot, named | dict(zip(kinematics.u_dot, rates, strict=True))


def _letter(kinematics: Kinematics) -> str:
    return "v" if kinematics.u == tuple(map(velocity, kinematics.q)) else "u"


def _is_linear_in_u(kinematics: Kinematics, bodies: Sequence[Body]) -> bool:
    """Return whether all that moves does so in proportion to u, so that the forces alone do work."""
    still = dict.fromkeys(kinematics.u, sp.S.Zero)
    rates = [*kinematics.q_dot]
    for body in bodies:
        rates += [kinematics.rate(place) for place in body.r]
        rates += body.angular_velocity(kinematics)
    return all(
        exchanged(rate, still) == 0
        and not rate.has(kinematics.t)
        and not any(rate.diff(w).has(*kinematics.u) for w in kinematics.u)
        for rate in rates
    )


def _potential_energy(given: GibbsAppell) -> Expr:
    """Return V − Σ q̇ ∂V/∂q̇ along the quasi-velocities: the part of V that is linear in q̇ stores no energy."""
    swept = (velocity(s) * given.V.diff(velocity(s)) for s in given.q)
    return given.kinematics.along(given.V - sp.Add(*swept))


def _kinetic(bodies: Sequence[Body], kinematics: Kinematics) -> Expr:
    """Return T(q, u, t)."""
    terms: list[Expr] = []
    for body in bodies:
        terms += [body.m * kinematics.rate(place) ** 2 / 2 for place in body.r]
        omega = body.angular_velocity(kinematics)
        n = range(len(omega))
        terms += [entry(body.inertia, i, j) * omega[i] * omega[j] / 2 for i in n for j in n]
    return sp.Add(*terms)


def _power_of_loads(given: NewtonEuler, kinematics: Kinematics) -> Expr:
    """Return Σ F·ṙ + M·ω over the bodies: the loads are what the rates of momentum exceed the balances by."""
    balances, terms = iter(given.balances), list[Expr]()
    for body in given.bodies:
        for place in body.r:
            speed = kinematics.rate(place)
            terms.append((body.m * kinematics.rate(speed) - next(balances)) * speed)
        omega = body.angular_velocity(kinematics)
        n = range(len(omega))
        spin = [sp.Add(*(entry(body.inertia, a, b) * omega[b] for b in n)) for a in n]
        # ω·(ω × I ω) = 0, so that what turns the body works with the rate of its spin alone.
        gyroscopic = cross(omega, spin) if isinstance(body, RigidBody) else [sp.S.Zero for _ in n]
        for w, s, c in zip(omega, spin, gyroscopic, strict=True):
            terms.append((kinematics.rate(s) + c - next(balances)) * w)
    return sp.Add(*terms)
