"""Known truths of a scene compared with what canon derives and integrates, each check with its bound.

Symbolic checks are verdicts: dI/dt vanishes by the equations of motion. Along a run an integral's change is measured in
long double and divided by its value at the start, or by the largest of its terms (the median along the run) where that
value is less than a tenth of it. A driven or damped scene's energy E is held against the work W done on
it: E − W is constant.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.scene.parts import Integral, SceneError, Solution
from canon.scene.scene_motion import SceneMotion, first_zero, run

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray
    from sympy import Expr

    from canon.proof.domain.verdict import Verdict
    from canon.scene.scene import Scene

__all__ = ["Check", "check", "conserved", "integrals_along", "rate_of", "solutions_met"]


@dataclass(frozen=True)
class Check:
    """Something known, measured.

    Parameters
    ----------
    name
        What is known.
    error, bound
        How far the motion is from it, and how far it may be.
    of
        What the error is: relative to what, or an absolute value.
    about
        Start and duration; or why nothing could be measured.
    why
        Why the bound is as large as it is, where it is more than usual.
    """

    name: str
    error: float
    bound: float
    of: str
    about: str
    why: str = ""

    @property
    def passed(self) -> bool:
        """Whether the error is within its bound; a number that is none never is."""
        return self.error <= self.bound

    def __str__(self) -> str:
        sign = "≤" if self.passed else "EXCEEDS"
        reason = f"; {self.why}" if self.why else ""
        return f"{self.name}: {self.error:.1e} {sign} {self.bound:.0e} {self.of} ({self.about}{reason})"


def conserved(scene: Scene, integral: Integral) -> Verdict:
    """Tell whether a known integral is constant along every motion of the scene.

    Under constraints its rate is taken on the velocities that they leave free.

    Examples
    --------
    >>> from canon.scene import find
    >>> scene = find("kepler")
    >>> conserved(scene, scene.integrals[0]).status.name
    'HOLDS'
    >>> conserved(scene, Integral("a wrong one", lambda s: s.x)).status.name
    'FAILS'
    """
    from canon.proof.vanish import vanishes

    return vanishes(rate_of(scene, integral.build(scene.symbols))).about(f"{integral.name} is conserved")


def rate_of(scene: Scene, f: Expr) -> Expr:
    """Return df/dt by the scene's equations of motion, for f(q, q̇, p, t).

    Examples
    --------
    >>> from canon.scene import find
    >>> scene = find("damped-oscillator")
    >>> rate_of(scene, scene.symbols.x.dot)
    (-c*x_dot - k*x)/m
    """
    from canon.expression.symbols.symbol import acceleration, momentum, time_derivative, velocity
    from canon.mechanics.algebra.substitution import exchanged
    from canon.mechanics.lagrange.quasi_velocity import independent_velocities

    if scene.is_free and not f.has(*map(velocity, scene.q)):
        return scene.hamiltonian.rate(f)
    lagrangian = scene.lagrangian
    through = dict(zip(map(momentum, scene.q), lagrangian.momenta, strict=True))
    rate = time_derivative(exchanged(f, through), scene.q, lagrangian.t)
    bound = scene.constrained if scene.is_constrained else None
    accelerations = (bound or lagrangian).accelerations
    rate = exchanged(rate, dict(zip(map(acceleration, scene.q), accelerations, strict=True)))
    return exchanged(rate, independent_velocities(bound).through) if bound else rate


def check(scene: Scene, start: str | None = None, periods: float | None = None) -> tuple[Check, ...]:
    """Return everything known of a scene, measured along motions of it.

    Parameters
    ----------
    scene
        The scene.
    start
        One of its starts by name; all of them unless given.
    periods
        Duration of the runs along which integrals are measured; 100, or up to the scene's horizon.

    Raises
    ------
    SceneError
        There is no such start, or no such number of periods.

    Examples
    --------
    >>> from canon.scene import find
    >>> all(each.passed for each in check(find("harmonic-oscillator"), periods=10))
    True
    """
    names = [start] if start is not None else [each.name for each in scene.starts]
    found: list[Check] = []
    for name in names:
        found += integrals_along(run(scene, name, min(100.0 if periods is None else periods, scene.horizon)))
    return (*found, *solutions_met(scene, start))


def integrals_along(motion: SceneMotion) -> tuple[Check, ...]:
    """Return how well energy, integrals and constraints are kept along a motion.

    Examples
    --------
    >>> from canon.scene import find
    >>> for kept in integrals_along(run(find("chaplygin-sleigh"), periods=2)):
    ...     print(kept.name, kept.passed)
    energy True
    energy m (u² + k² ω²)/2 True
    constraints True
    """
    scene, equation = motion.scene, motion.equation
    about = f"{motion.start.name}, {motion.t[-1] / scene.period:g} periods"
    name = "energy" if equation.work == equation.field.graph.zero else "energy less the work done"
    energy = Integral(name, lambda s: s.t, scene.energy_bound, scene.energy_why)
    found = [_kept(motion, energy, equation.energy, about, equation.work)]
    for integral in scene.integrals:
        node = equation.node(integral.build(scene.symbols), integral.name)
        found.append(_kept(motion, integral, node, about))
    if equation.residuals:
        largest = float(np.abs(motion.values(equation.residuals)).max())
        bound = max(1e-12, scene.energy_bound)
        found.append(Check("constraints", largest, bound, "in their own units", about))
    return tuple(found)


def solutions_met(scene: Scene, start: str | None = None) -> Iterator[Check]:
    """Yield how well the motions known beforehand are met, one after another.

    What is not known at these values of the parameters is passed over.

    Examples
    --------
    >>> from canon.scene import find
    >>> for met in solutions_met(find("hemisphere"), "aside"):
    ...     print(met.name, met.passed)
    it leaves from rest at θ₀ where cos θ = (2/3) cos θ₀ True
    """
    for solution in scene.solutions:
        if start is not None and solution.start != start:
            continue
        if solution.condition is not None and not solution.condition.met(scene.values):
            continue
        about = f"{solution.start}, {solution.periods:g} periods"
        try:
            yield _met(scene, solution, about)
        except NonFiniteStateError as lost:
            yield Check(solution.name, np.nan, solution.bound, "", f"{about}: {lost}")


def _met(scene: Scene, solution: Solution, about: str) -> Check:
    quantity = solution.quantity(scene.symbols)
    if solution.event is not None:
        event = solution.event(scene.symbols)
        motion, about = first_zero(scene, solution.start, event, solution.periods), f"{about}, event"
    else:
        motion = run(scene, solution.start, solution.periods, solution.samples)
    t = motion.t[1:]
    seen = motion.observed(quantity)[1:]
    known = np.broadcast_to(np.asarray(solution.value(scene.values, t), dtype=np.float64), t.shape)
    if not np.isfinite(known).all():
        raise SceneError(f"{scene.name}: {solution.name} is not finite with these parameters; choose others")
    scale = float(np.abs(known).max())
    size = scale if scale > 0.0 else 1.0
    of = "relative to its largest value" if scale > 0.0 else "in its own units"
    return Check(
        solution.name, float(np.abs(seen - known).max() / size), solution.bound, of, about, solution.source
    )


def _kept(motion: SceneMotion, integral: Integral, node: int, about: str, work: int | None = None) -> Check:
    """Return how much a quantity, less the work, changes along a motion, relative to itself or its terms."""
    graph = motion.equation.field.graph
    kind, operands, _ = graph.nodes[node]
    parts = operands if kind == "add" else (node,)
    values: NDArray[Any] = motion.values([node, graph.zero if work is None else work, *parts])
    change = float(np.abs(values[0] - values[0][0] - values[1]).max())
    first, terms = abs(float(values[0][0])), float(np.median(np.abs(values[2:]).max(axis=0)))
    size, of = (first, "relative") if first > terms / 10 else (terms, "of its largest term")
    if size == 0.0:
        size, of = 1.0, "in its own units"
    why = integral.why if change > 1e-13 * size else ""
    return Check(integral.name, change / size, integral.bound, of, about, why)
