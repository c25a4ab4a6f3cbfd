"""Mass matrices without digits, constraints violated, redundant or nearly so, and long constrained runs."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from canon import Lagrangian, Particle, coordinates
from canon.mechanics.at_scale.constrained import constrained, constrained_motion
from canon.mechanics.at_scale.numeric_functions import acceleration_function, mass_condition_function
from canon.mechanics.at_scale.second_order import derivation, derivation_of_lagrangian
from canon.mechanics.lagrange.dependence import DependentConstraintsError
from extremes.row import Outcome, Row, refused

if TYPE_CHECKING:
    from collections.abc import Iterator

x, y = coordinates("x y")
GAP = sp.Symbol("epsilon", positive=True)


def rows() -> Iterator[Row]:
    """Yield the rows."""
    for name, gap in (("1e12", 4e-12), ("1e6", 4e-6)):
        yield Row(
            f"mass-matrix-{name}",
            f"a mass matrix of condition {name}: accelerations, against exact fractions",
            partial(near_singular, gap),
            {"NumPy": partial(by_numpy, gap)},
        )
    yield Row(
        "mass-matrix-1e16",
        "a mass matrix of condition 1e16: no digit is left",
        lambda: refused(lambda: accelerations(2.0**-52), ArithmeticError, holds="singular"),
        {"NumPy": partial(by_numpy, 2.0**-52)},
    )
    yield Row(
        "mass-matrix-singular",
        "a singular mass matrix that rounding makes regular, (ẋ + 0.3 ẏ)²/2",
        lambda: refused(singular, ArithmeticError, holds="singular"),
        {"NumPy": singular_by_numpy},
    )
    yield Row("mass-ratio-1e100", "masses 1 and 1e100: well conditioned in units that suit", mass_ratio)
    yield Row(
        "constraint-violated",
        "a pendulum in x, y starts 1e-3 off its circle, with a velocity along the rod",
        violated,
    )
    yield Row(
        "constraint-unreachable",
        "a point from which x² + y² + 1 = 0 is to be reached",
        lambda: refused(unreachable, ArithmeticError),
    )
    yield Row(
        "constraint-redundant",
        "the circle said twice, x² + y² = 1 and (x² + y²)² = 1",
        lambda: refused(redundant, DependentConstraintsError, ValueError, holds="depend"),
    )
    for name, gap in (("1e-6", 1e-6), ("1e-14", 1e-14)):
        yield Row(
            f"constraint-nearly-dependent-{name}",
            f"two planes at an angle of {name} to each other: multipliers and accelerations",
            partial(nearly_dependent, gap),
        )
    yield Row(
        "constraint-singular-point",
        "the constraint x y = 0 at x = y = 0, where its gradient vanishes",
        lambda: refused(at_singular_point, ArithmeticError, holds="singular"),
    )
    yield Row(
        "constrained-long",
        "a pendulum in x, y under its constraint, 10⁵ steps of RK4 with projection: stays on the circle, "
        "energy beside that of the angle's equation",
        partial(long_run, projected=True),
        limit=120,
    )
    yield Row(
        "constrained-long-drifting",
        "the same without projection: the drift is seen in the residual",
        partial(long_run, projected=False),
        limit=120,
    )


def equations() -> object:
    u, v = x.dot, y.dot
    return derivation_of_lagrangian(
        Lagrangian((u**2 + 2 * u * v + (1 + GAP) * v**2) / 2 - x**2 / 2 - y**2, [x, y])
    )


def accelerations(gap: float) -> np.ndarray:
    return acceleration_function(equations(), {GAP: gap})([0.3, 0.7], [0.0, 0.0], 0.0)


def exact(gap: float) -> list[sp.Rational]:
    f = sp.Matrix([-sp.Rational(0.3), -2 * sp.Rational(0.7)])
    e = sp.Rational(gap)
    return list(sp.Matrix([[1 + e, -1], [-1, 1]]) / e * f)


def _relative(found: np.ndarray, gap: float) -> float:
    return float(max(abs(sp.Rational(float(a)) - b) / abs(b) for a, b in zip(found, exact(gap), strict=True)))


def near_singular(gap: float) -> Outcome:
    condition = mass_condition_function(equations(), {GAP: gap})([0.3, 0.7], [0.0, 0.0], 0.0)
    words = f"condition {condition:.1e}: {np.log10(condition):.0f} digits fewer"
    return Outcome(words, _relative(accelerations(gap), gap), condition * 2.0**-52)


def by_numpy(gap: float) -> Outcome:
    found = np.linalg.solve([[1.0, 1.0], [1.0, 1.0 + gap]], [-0.3, -1.4])
    error = _relative(found, gap)
    return Outcome("solve(), no complaint", error, right=False if error > 0.1 else None)


def singular() -> object:
    c = sp.Symbol("c", positive=True)
    made = derivation_of_lagrangian(Lagrangian((x.dot + c * y.dot) ** 2 / 2 - x**2 / 2 - y**2, [x, y]))
    return acceleration_function(made, {c: 0.1 * 3})([0.3, 0.7], [0.0, 0.0], 0.0)


def singular_by_numpy() -> Outcome:
    c = 0.1 * 3
    try:
        found = np.linalg.solve([[1.0, c], [c, c * c]], [-0.3, -1.4])
    except np.linalg.LinAlgError as error:
        return Outcome(str(error), refused=True)
    return Outcome(f"solve() says {found}", right=False)


def mass_ratio() -> Outcome:
    m = sp.Symbol("m", positive=True)
    made = derivation_of_lagrangian(Lagrangian(x.dot**2 / 2 + m * y.dot**2 / 2 - x**2 / 2 - y, [x, y]))
    found = acceleration_function(made, {m: 1e100})([0.5, 0.0], [0.0, 0.0], 0.0)
    condition = mass_condition_function(made, {m: 1e100})([0.5, 0.0], [0.0, 0.0], 0.0)
    return Outcome(
        f"condition {condition:g}",
        float(max(abs(found[0] + 0.5) * 2, abs(found[1] * 1e100 + 1))),
        condition * 2.0**-52,
    )


def hung(*constraints: sp.Expr) -> object:
    free = derivation([Particle(sp.Integer(1), (x, y))], [x, y], field=(0, -10))
    return constrained_motion(constrained(free, holonomic=constraints or (x**2 + y**2 - 1,)), {})


def violated() -> Outcome:
    motion = hung()
    start = [0.6 * 1.001, -0.8 * 1.001], [0.3, -0.4]
    before = [float(abs(part).max()) for part in motion.residual(*start, 0.0)]
    q, v = motion.projected(*start, 0.0)
    after = [float(abs(part).max()) for part in motion.residual(q, v, 0.0)]
    error = float(max(abs(q - [0.6, -0.8]).max(), abs(v).max()))
    return Outcome(
        f"residuals {before[0]:.1e}, {before[1]:.1e} before projection, {after[0]:.1e}, {after[1]:.1e} after",
        error,
        1e-15,
    )


def unreachable() -> object:
    return hung(x**2 + y**2 + 1).projected([1.0, 1.0], [0.0, 0.0], 0.0)


def redundant() -> object:
    return hung(x**2 + y**2 - 1, (x**2 + y**2) ** 2 - 1)


def nearly_dependent(gap: float) -> Outcome:
    z = coordinates("z")
    free = derivation([Particle(sp.Integer(1), (x, y, z))], [x, y, z], field=(0, 0, -10))
    e = sp.Rational(gap)
    try:
        motion = constrained_motion(constrained(free, holonomic=(z + x, z + x + e * y)), {})
        found, forces = motion.accelerations([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 0.0)
    except (DependentConstraintsError, ArithmeticError) as error:
        return Outcome(f"{type(error).__name__}: {error}"[:180], refused=True)
    # On z = −x and y = 0: z̈ = −ẍ = −5, ÿ = 0.
    error = float(abs(found - [5.0, 0.0, -5.0]).max() / 5)
    return Outcome(
        f"accelerations {found.round(6)}, multipliers {forces.round(3)}", error, 4 * 2.0**-52 / gap
    )


def at_singular_point() -> object:
    return hung(x * y).accelerations([0.0, 0.0], [0.0, 0.0], 0.0)


def long_run(*, projected: bool) -> Outcome:
    """Ten seconds of motion in steps of 10⁻⁴; the truth by the angle's equation in steps of order 8."""
    from canon import Hamiltonian, Splitting, propagate

    motion, h, steps = hung(), 1e-3, 20_000
    q, v = np.array([0.6, -0.8]), np.array([0.0, 0.0])

    def rate(state: np.ndarray) -> np.ndarray:
        return np.concatenate([state[2:], motion.accelerations(state[:2], state[2:], 0.0)[0]])

    state = np.concatenate([q, v])
    for _ in range(steps):
        k1 = rate(state)
        k2 = rate(state + h / 2 * k1)
        k3 = rate(state + h / 2 * k2)
        k4 = rate(state + h * k3)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if projected:
            state = np.concatenate(motion.projected(state[:2], state[2:], 0.0))
    values, rates = motion.residual(state[:2], state[2:], 0.0)
    theta = coordinates("theta")
    H = Hamiltonian(theta.momentum**2 / 2 - 10 * sp.cos(theta), [theta], [theta.momentum])
    angle = propagate(
        H,
        (0, h * steps),
        [sp.atan2(sp.Rational(6, 10), sp.Rational(8, 10)), 0],
        method=Splitting("kahan-li-8"),
        step=1e-2,
    ).final[0]
    error = float(abs(state[:2] - [np.sin(angle), -np.cos(angle)]).max())
    off = float(max(abs(values).max(), abs(rates).max()))
    # RK4's own error, from its half-step twin: 1/15 of what doubling the step changes; what is stated is the residual.
    words = f"off the constraint by {off:.1e}; place wrong by {error:.1e} after {steps} steps"
    return Outcome(words, right=(off < 1e-14) == projected)
