"""Jacobian of splittings by solvable parts: the product of the derivatives of their flows and kicks.

Kepler's flow has its derivative in closed form, a linear one is it itself, and a kick by W(q) turns δp by −∂²W δq. All
are taken along the states of the motion, of very many steps at a time, in doubles, so that the Jacobian is symplectic
to round-off.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon.expression.graph.number_systems import FLOAT64
from canon.flow.geometry.kepler_derivative import kepler_derivative
from canon.flow.integrate import integrate
from canon.flow.run.sampling_plan import fixed_plan
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.program.commutator import commutator_force
from canon.kernel.program.hamilton_equations import equations
from canon.kernel.schemes.perturbed_schemes import corrector
from canon.kernel.solvable.linear_motion import flow_matrices
from canon.kernel.solvable.solvable_parts import Planets, Quadratic, named_part, solvable_part

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array
    from canon.flow.method.solvable_splitting import SolvableSplitting
    from canon.flow.task import Task
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.solvable.solvable_parts import Centres, Part

__all__ = ["solvable_jacobian"]

_BLOCK = 512
"""Steps taken at a time."""


def solvable_jacobian(task: Task) -> tuple[Array, Array, Array]:
    """Return times, the motion, and its Jacobian, shape (2n, 2n, times).

    Parameters
    ----------
    task
        The motion, of one orbit, by a splitting by solvable parts.

    Raises
    ------
    ValueError
        The planets' coordinates are democratic heliocentric ones, in which kicks depend on momenta.
    """
    method = task.method.solvable
    assert method is not None
    if method.coordinates != "jacobi":
        raise ValueError(
            f"{method} carries no variations: in democratic heliocentric coordinates kicks depend on momenta, and the "
            "derivative of their flow is not known here. Use Jacobi's coordinates, or Gauss(6)"
        )
    assert task.plan.h is not None
    part = solvable_part(task.system) if method.parts is None else named_part(task.system, *method.parts)
    step = _step(task.system, part, method, task.plan.h)
    found, stops = integrate(task), set(task.plan.stops)
    states, total, kept = task.states, np.eye(len(found.y)), [np.eye(len(found.y))]
    for begin in range(0, task.plan.stops[-1], _BLOCK):
        count = min(_BLOCK, task.plan.stops[-1] - begin)
        made = integrate(
            replace(
                task, states=states, plan=fixed_plan(task.plan.start, task.plan.h, tuple(range(count + 1)))
            )
        )
        for number, factor in enumerate(step.derivative(made.y[:, :-1, 0]), begin + 1):
            total = factor @ total
            if number in stops:
                kept.append(total)
        states = made.y[:, -1], made.carried[:, -1]
    return found.t, found.y[:, :, 0], np.stack(kept, axis=2)


@dataclass(frozen=True, eq=False)
class _Map:
    """Parts of a step in their order, each a function of states and their variations, (2n, s) and (s, 2n, 2n)."""

    moves: tuple[Any, ...]

    def derivative(self, y: Array) -> Array:
        """Return the derivative of a step at states (2n, s), shape (s, 2n, 2n)."""
        delta: Array = np.broadcast_to(np.eye(len(y)), (y.shape[1], len(y), len(y))).copy()
        for move in self.moves:
            y, delta = move(y, delta)
        return delta


# a step ---------------------------------------------------------------------------------------------------


def _step(system: HamiltonEquations, part: Part, method: SolvableSplitting, h: Fraction) -> _Map:
    """Return a step, with what a corrector does before and after it."""
    scheme = method.kicks
    chosen = corrector(method.scheme, method.corrector) if method.corrector else None
    none = Fraction(0)
    weights = scheme.commutators or (none,) * len(scheme.b)
    pairs = [(b, a, c) for b, a, c in zip(scheme.b, scheme.a[1:], weights, strict=True)]
    around = [
        [(b, a, none) for b, a in chosen.pairs(inverse=back)] if chosen else [] for back in (False, True)
    ]
    kick, flow = _kick(system, part), _flow(system, part)
    moves = list[Any]()
    for b, a, weight in [*around[0], (none, scheme.a[0], none), *pairs, *around[1]]:
        if b or weight:
            moves.append(functools.partial(kick, float(b * h), float(2 * weight * h**3)))
        if a:
            moves.append(flow(a * h))
    return _Map(tuple(moves))


def _kick(system: HamiltonEquations, part: Part) -> Any:
    """Return the kick by −τ ∂H₁ + σ ∂(½ Σ A_ij ∂_iH₁ ∂_jH₁), A = ∂²H₀/∂p², as a function of τ, σ, y, δ."""
    rest = _planets_rest(system, part) if isinstance(part, Planets) else part.rest
    graph, n = rest.graph, len(rest.q)
    rates = [rest.force, commutator_force(rest, _inverse_mass(part, n))]
    slopes = [[slope for rate in each for slope in graph.gradient(rate, rest.q)] for each in rates]

    def kick(tau: float, sigma: float, y: Array, delta: Array) -> tuple[Array, Array]:
        y, delta, values = y.copy(), delta.copy(), dict(zip(rest.inputs, (*y, 0.0), strict=True))
        turned, s = np.zeros((n, n, y.shape[1])), y.shape[1]
        for size, force, hessian in zip((tau, sigma), rates, slopes, strict=True):
            if size:
                found = graph.evaluate([*force, *hessian], values, FLOAT64)
                numbers = np.stack([np.broadcast_to(np.asarray(x, float), (s,)) for x in found])
                y[n:] += size * numbers[:n]
                turned += size * numbers[n:].reshape(n, n, s)
        delta[:, n:] += np.moveaxis(turned, 2, 0) @ delta[:, :n]
        return y, delta

    return kick


def _inverse_mass(part: Part, n: int) -> list[list[Fraction]]:
    """Return ∂²H₀/∂p²."""
    if isinstance(part, Quadratic):
        return [list(row[n:]) for row in part.field[:n]]
    by_index = {i: 1 / mass for body, mass in zip(part.bodies, part.masses, strict=True) for i in body}
    return [[by_index[i] if i == j else Fraction(0) for j in range(n)] for i in range(n)]


def _planets_rest(system: HamiltonEquations, part: Planets) -> HamiltonEquations:
    """Return the equations of H₁ = −Σ k_ij/|q_i − q_j| + Σ k'_i/|X_i|, X_i Jacobi's coordinates."""
    places = [sp.Matrix([system.q[i] for i in body]) for body in part.bodies]
    weights, _, strengths = _jacobi(part)

    def over_distance(strength: Fraction, x: Any) -> Any:
        return sp.Rational(strength.numerator, strength.denominator) / sp.sqrt(sum(each**2 for each in x))

    terms = list[Any]()
    for i, row in enumerate(part.attractions):
        terms += [-over_distance(k, places[i] - places[j]) for j, k in enumerate(row[:i]) if k]
    for row, strength in zip(weights[1:], strengths[1:], strict=True):
        own = [sp.Rational(w.numerator, w.denominator) * q for w, q in zip(row, places, strict=True)]
        terms.append(over_distance(strength, sum(own[1:], own[0])))
    return equations(sp.Add(*terms), system.q, system.p, system.t, {})


def _jacobi(part: Planets) -> tuple[list[list[Fraction]], list[Fraction], list[Fraction]]:
    """Return Jacobi's coordinates as rows of weights of the bodies', the first the centre of mass; m'_i; k'_i."""
    masses, count = part.masses, len(part.masses)
    inner, total = masses[0], sum(masses, Fraction(0))
    rows, reduced, strengths = [[m / total for m in masses]], [total], [Fraction(0)]
    for i in range(1, count):
        rows.append([-masses[j] / inner if j < i else Fraction(j == i) for j in range(count)])
        reduced.append(masses[i] * inner / (inner + masses[i]))
        strengths.append(sum(part.attractions[i][:i], Fraction(0)))
        inner += masses[i]
    return rows, reduced, strengths


# flows of H₀ ----------------------------------------------------------------------------------------------


def _flow(system: HamiltonEquations, part: Part) -> Any:
    """Return what makes of a time the flow of H₀ as a function of y and δ."""
    if isinstance(part, Quadratic):
        return functools.partial(_linear_flow, part)
    n = len(system.q)
    if isinstance(part, Planets):
        rows, masses, strengths = _jacobi(part)
    else:
        masses, strengths = list(part.masses), list(part.attractions)
        rows = [[Fraction(i == j) for j in range(len(masses))] for i in range(len(masses))]
    return functools.partial(_kepler_flow, _Bodies.of(part, rows, masses, strengths, n))


def _linear_flow(part: Quadratic, time: Fraction) -> Any:
    size = len(part.field)
    entries = np.array(flow_matrices(part, DOUBLE, [time]), dtype=float).reshape(2, size, size)
    matrix = np.eye(size) + entries.sum(axis=0).T

    def flow(y: Array, delta: Array) -> tuple[Array, Array]:
        return matrix @ y, matrix @ delta

    return flow


@dataclass(frozen=True, eq=False)
class _Bodies:
    """Bodies that move about centres in coordinates of their own, y' = Sy, symplectic.

    Parameters
    ----------
    into, out
        S and its inverse; body i has the coordinates i d … i d + d − 1.
    axes
        d.
    masses, strengths
        m and k of |p|²/2m − k/|q|; a body with k = 0 moves evenly.
    """

    into: Array
    out: Array
    axes: int
    masses: tuple[float, ...]
    strengths: tuple[float, ...]

    @staticmethod
    def of(
        part: Planets | Centres,
        rows: Sequence[Sequence[Fraction]],
        masses: Sequence[Fraction],
        strengths: Sequence[Fraction],
        n: int,
    ) -> _Bodies:
        """Return the bodies whose coordinates are sums of the given ones with the weights in rows."""
        axes, own = len(part.bodies[0]), np.zeros((n, n))
        for i, row in enumerate(rows):
            for body, weight in zip(part.bodies, row, strict=True):
                for axis, place in enumerate(body):
                    own[i * axes + axis, place] = float(weight)
        none: Array = np.zeros((n, n))
        back: Array = np.linalg.inv(own).astype(np.float64)
        into: Array = np.block([[own, none], [none, back.T]])
        out: Array = np.block([[back, none], [none, own.T]])
        return _Bodies(into, out, axes, tuple(map(float, masses)), tuple(map(float, strengths)))


def _kepler_flow(bodies: _Bodies, time: Fraction) -> Any:
    t = float(time)

    def flow(y: Array, delta: Array) -> tuple[Array, Array]:
        y, delta, n, d = bodies.into @ y, bodies.into @ delta, len(y) // 2, bodies.axes
        for i, (m, k) in enumerate(zip(bodies.masses, bodies.strengths, strict=True)):
            q, p = slice(i * d, i * d + d), slice(n + i * d, n + i * d + d)
            if not k:
                y[q] += t / m * y[p]
                delta[:, q] += t / m * delta[:, p]
                continue
            x, u, M = kepler_derivative(y[q], y[p] / m, k / m, t)
            y[q], y[p] = x, m * u
            turn = np.moveaxis(M, 2, 0)
            own = np.concatenate([delta[:, q], delta[:, p] / m], axis=1)
            delta[:, q], delta[:, p] = turn[:, :d] @ own, m * (turn[:, d:] @ own)
        return bodies.out @ y, bodies.out @ delta

    return flow
