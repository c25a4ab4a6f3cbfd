"""Long runs, tiny steps, many bodies, many orbits."""

from __future__ import annotations

import itertools
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from mpmath import mp, mpf

from canon import RK4, Hamiltonian, Splitting, coordinates, propagate
from extremes.numeric_tools import Problem, by_taylor, motion_row, outcome_of, plain, rebound_installed
from extremes.row import Outcome, Row

if TYPE_CHECKING:
    from collections.abc import Iterator

x, y = coordinates("x y")
OSCILLATOR = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])


def rows() -> Iterator[Row]:
    """Yield the rows."""
    yield Row(
        "steps-1e9",
        "10⁹ steps of Verlet, h = 2⁻⁶, an oscillator (the discrete motion in closed form, its "
        "phase to 60 digits)",
        billion,
        {"plain Python": loop_in_numbers},
        limit=150,
    )
    yield Row("steps-1e8-resumed", "10⁸ steps at once and in two halves: the same bits?", resumed, limit=60)
    yield Row(
        "clock-1e6-of-0.1",
        "10⁶ steps of 0.1: the time is t0 + n h, exactly rounded",
        clock,
        {"t += h": clock_plainly},
    )
    yield motion_row(
        "clock-1e15",
        "a driven oscillator from t0 = 1e15, where doubles are 1/8 apart, to t0 + 100, h = 1/64",
        late,
        {"method": Splitting("kahan-li-8"), "step": 1 / 64},
    )
    for precision in ("double", "compensated"):
        yield motion_row(
            f"step-1e-8-{precision}",
            f"10⁷ steps of 1e-8, Verlet in {precision} (closed form)",
            partial(oscillator, 0.1),
            {"method": Splitting("verlet"), "step": 1e-8, "precision": precision},
            others=(),
            limit=90,
        )
    yield motion_row(
        "oscillator-1e5-periods",
        "an oscillator over 10⁵ periods, splitting of order 8, h = 0.2",
        partial(oscillator, 2e5 * float(np.pi)),
        {"method": Splitting("kahan-li-8"), "step": 0.2},
        others=(),
        limit=150,
    )
    yield motion_row(
        "rk4-2e4-periods",
        "an oscillator over 2·10⁴ periods, RK4, h = 0.05: the energy decays",
        partial(oscillator, 4e4 * float(np.pi)),
        {"method": RK4(), "step": 0.05},
        others=(),
        limit=150,
    )
    yield Row(
        "bodies-200",
        "200 bodies in a disc, 400 degrees of freedom, softened by 0.05, t = 0 … 0.1 in 20 steps of order 4",
        many_bodies,
        {"rebound IAS15": bodies_by_rebound} if rebound_installed() else {},
        limit=400,
    )
    yield Row(
        "lattice-4096",
        "Fermi, Pasta, Ulam and Tsingou, α = 0.25, N = 4096, 1000 steps of order 4",
        partial(lattice, 4096, 0.25),
        limit=400,
    )
    yield Row(
        "lattice-4096-linear",
        "the same chain without α: its normal modes in closed form",
        partial(lattice, 4096, 0.0),
        limit=400,
    )
    yield Row(
        "ensemble-1e6",
        "10⁶ pendulums side by side, 100 steps of order 8; the error of 50 of them estimated",
        ensemble,
        {"SciPy DOP853": ensemble_by_scipy},
        limit=120,
        memory=8.0,
    )


def billion() -> Outcome:
    n, h = 10**9, Fraction(1, 64)
    motion = propagate(
        OSCILLATOR, (0, float(n * h)), [1.0, 0.0], method=Splitting("verlet"), step=float(h), samples=4
    )
    with mp.workdps(60):
        # Kick–drift–kick or drift–kick–drift: the discrete motion turns by the angle 2 asin(h/2) a step.
        angle = 2 * mp.asin(mpf(1) / 128)
        turned = mp.cos(n * angle), mp.sin(n * angle)
        measure = mp.sqrt(1 - mpf(1) / 128**2)
        q, p = (mpf(float(v)) for v in motion.final)
        # x stays on cos(nθ); the momentum's factor is √(1 − h²/4), or its inverse, as drifts or kicks come first.
        error = float(
            min(abs(q - turned[0]) + abs(abs(p) - abs(turned[1]) * f) for f in (measure, 1 / measure))
        )
    exact = motion.t[-1] == float(n * h) and motion.steps == n
    energy = abs(motion.energy_error).max()
    spent = f"{motion.cpu_seconds:.2f} s of processor"
    words = f"{motion.steps} steps, t exact: {exact}, {spent}, energy error {energy:.1e}"
    # Compensated round-off: one unit a step would be 2⁻⁵² √n; carried along it stays near 2⁻⁵².
    return Outcome(words, error, 2.0**-52 * n**0.5 if exact else 0.0)


def loop_in_numbers() -> Outcome:
    """One hundredth of it as a plain loop."""
    q, p, h = 1.0, 0.0, 1 / 64
    for _ in range(10**6):
        p -= h / 2 * q
        q += h * p
        p -= h / 2 * q
    angle = 2 * np.arcsin(h / 2)
    return Outcome("10⁶ steps in plain Python, no compensation", float(abs(q - np.cos(10**6 * angle))))


def resumed() -> Outcome:
    how = {"method": Splitting("verlet"), "step": 2.0**-6}
    span = 10**8 / 64
    whole = propagate(OSCILLATOR, (0, span), [1.0, 0.0], samples=2, **how)
    half = propagate(OSCILLATOR, (0, span / 2), [1.0, 0.0], samples=1, **how).resume(span, samples=1)
    same = bool((whole.y == half.y).all() and (whole.carried == half.carried).all())
    return Outcome(f"the same bits: {same}", right=same)


def clock() -> Outcome:
    motion = propagate(
        OSCILLATOR, (0, 100_000), [1.0, 0.0], method=Splitting("verlet"), step=0.1, samples=1000
    )
    true = [float(Fraction(k, 10)) for k in range(0, 10**6 + 1, 1000)]
    error = float(abs(motion.t - true).max())
    return Outcome(f"largest error of the time {error:g}", error, 0.0)


def clock_plainly() -> Outcome:
    t = 0.0
    for _ in range(10**6):
        t += 0.1
    return Outcome(f"t = {t!r}", abs(t - 1e5))


def late() -> Problem:
    H = Hamiltonian(
        x.momentum**2 / 2 + x**2 / 2 - x * sp.sin(sp.Rational(1, 2) * sp.Symbol("t", real=True)),
        [x],
        [x.momentum],
    )
    t0 = 1e15

    def truth(t: np.ndarray) -> np.ndarray:
        with mp.workdps(60):
            s0 = mpf(t0)
            # x = (4/3) sin(t/2) + A cos(t − t0) + B sin(t − t0), from rest at 0.
            a, b = -mpf(4) / 3 * mp.sin(s0 / 2), -mpf(2) / 3 * mp.cos(s0 / 2)
            found = []
            for s in t:
                s = mpf(float(s))
                c, d = mp.cos(s - s0), mp.sin(s - s0)
                found.append(
                    [mpf(4) / 3 * mp.sin(s / 2) + a * c + b * d, mpf(2) / 3 * mp.cos(s / 2) - a * d + b * c]
                )
            return np.array(found, dtype=object).T

    return Problem(H, (0.0, 0.0), (t0, t0 + 100), truth)


def oscillator(until: float) -> Problem:
    def truth(t: np.ndarray) -> np.ndarray:
        with mp.workdps(40):
            return np.array([[mp.cos(mpf(float(s))), -mp.sin(mpf(float(s)))] for s in t], dtype=object).T

    return Problem(OSCILLATOR, (1.0, 0.0), (0.0, until), truth)


def _ball(count: int) -> tuple[Hamiltonian, np.ndarray]:
    rng = np.random.default_rng(7)
    places = rng.normal(size=(count, 2)) * 0.5
    speeds = rng.normal(size=(count, 2)) * 0.3
    q = coordinates(" ".join(f"{c}{i}" for i in range(count) for c in "xy") + ",")
    p = [c.momentum for c in q]
    m, soft = sp.Rational(1, count), sp.Rational(1, 400)
    kinetic = sp.Add(*[c**2 / (2 * m) for c in p])
    pairs = [
        -(m**2) / sp.sqrt(sp.Add(*[(q[2 * i + k] - q[2 * j + k]) ** 2 for k in range(2)], soft))
        for i in range(count)
        for j in range(i)
    ]
    return Hamiltonian(sp.Add(kinetic, *pairs), q, p), np.concatenate(
        [places.ravel(), speeds.ravel() / count]
    )


def many_bodies() -> Outcome:
    """Against the forces written with NumPy in long double and the same method in steps a tenth as long."""
    H, start = _ball(200)
    motion = propagate(H, (0, 0.1), start, method=Splitting("mclachlan-4"), step=0.005, samples=2)
    return outcome_of(motion, np.stack([_numpy_ball(start, t) for t in motion.t], axis=1))


def _numpy_ball(start: np.ndarray, until: float) -> np.ndarray:
    n = 200
    q, v = (half.reshape(n, 2).astype(np.longdouble) for half in np.split(start, 2))
    v = v * n
    scheme = Splitting("kahan-li-8").scheme
    steps = max(round(until / 0.005), 0)
    h = np.longdouble(until) / max(steps, 1)
    for _ in range(steps):
        for a, b in zip(scheme.a, (*scheme.b, 0), strict=True):
            q = q + h * (np.longdouble(a.numerator) / np.longdouble(a.denominator)) * v
            if b:
                d = q[:, None] - q[None]
                w = 1 / (np.sum(d * d, axis=2) + np.longdouble(1) / 400) ** 1.5 / n
                v = v - h * (np.longdouble(b.numerator) / np.longdouble(b.denominator)) * np.einsum(
                    "ij,ijk->ik", w, d
                )
    return np.concatenate([q.ravel(), v.ravel() / n])


def bodies_by_rebound() -> Outcome:
    import rebound

    _, start = _ball(200)
    sim = rebound.Simulation()
    sim.softening = 0.05
    for place, speed in zip(start[:400].reshape(200, 2), start[400:].reshape(200, 2) * 200, strict=True):
        sim.add(m=1 / 200, x=place[0], y=place[1], vx=speed[0], vy=speed[1])
    sim.integrate(0.1)
    q = [c for b in sim.particles for c in (b.x, b.y)]
    v = [c / 200 for b in sim.particles for c in (b.vx, b.vy)]
    return plain(np.array([[*q, *v]]).T, _numpy_ball(start, 0.1)[:, None], f"{sim.steps_done} steps")


def lattice(n: int, alpha: float) -> Outcome:
    q = coordinates(" ".join(f"q{i}" for i in range(n)) + ",")
    p = [c.momentum for c in q]
    ends = [sp.S.Zero, *q, sp.S.Zero]
    stretch = [b - a for a, b in itertools.pairwise(ends)]
    a = sp.Rational(alpha)
    V = [r**2 / 2 + a * r**3 / 3 for r in stretch]
    H = Hamiltonian(sp.Add(*[c**2 / 2 for c in p], *V), q, p)
    modes = np.pi * np.arange(1, n + 1) / (n + 1)
    start = np.concatenate([np.sin(modes) + np.sin(500 * modes) * 0.01, np.zeros(n)])
    motion = propagate(H, (0, 100), start, method=Splitting("mclachlan-4"), step=0.1, samples=2)
    if alpha:
        return outcome_of(motion, np.stack([_numpy_chain(start, alpha, t) for t in motion.t], axis=1))
    from scipy.fft import dst, idst

    q0, omega = dst(start[:n].astype(np.longdouble), type=1), 2 * np.sin(modes / 2)
    truth = [
        np.concatenate([idst(q0 * np.cos(omega * t), type=1), idst(-q0 * omega * np.sin(omega * t), type=1)])
        for t in motion.t
    ]
    return outcome_of(motion, np.stack(truth, axis=1))


def _numpy_chain(start: np.ndarray, alpha: float, until: float) -> np.ndarray:
    q, p = (half.astype(np.longdouble) for half in np.split(start, 2))
    scheme = Splitting("kahan-li-8").scheme
    steps = round(until / 0.1)
    h = np.longdouble(until) / max(steps, 1)
    for _ in range(steps):
        for a, b in zip(scheme.a, (*scheme.b, 0), strict=True):
            q = q + h * (np.longdouble(a.numerator) / np.longdouble(a.denominator)) * p
            r = np.diff(np.concatenate([[0], q, [0]]))
            p = (
                p
                + h * (np.longdouble(b.numerator) / np.longdouble(b.denominator)) * np.diff(r + alpha * r * r)
                if b
                else p
            )
    return np.concatenate([q, p])


def _pendulums() -> tuple[Hamiltonian, np.ndarray]:
    H = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])
    return H, np.array([np.linspace(-3, 3, 10**6), np.linspace(0.5, -0.5, 10**6)])


def ensemble() -> Outcome:
    H, starts = _pendulums()
    motion = propagate(H, (0, 10), starts, method=Splitting("kahan-li-8"), step=0.1, samples=1)
    chosen = np.linspace(0, 10**6 - 1, 50).astype(int).tolist()
    estimate = motion.error_estimate(chosen)
    truth = by_taylor(H, starts[:, chosen], "quad")(motion.t)
    missed = abs(motion.y[:, :, chosen] - truth).astype(float)
    # The estimate is to bound each of them: the largest ratio tells.
    ratio = float((missed / estimate.error).max())
    return Outcome(
        f"error of 50 orbits up to {missed.max():.1e}, estimated {estimate.error.max():.1e}; "
        f"{motion.cpu_seconds:.1f} s",
        ratio,
        1.0,
    )


def ensemble_by_scipy() -> Outcome:
    from scipy.integrate import solve_ivp

    _, starts = _pendulums()
    some = starts[:, ::100]
    n = some.shape[1]
    found = solve_ivp(
        lambda _t, s: np.concatenate([s[n:], -np.sin(s[:n])]),
        (0, 10),
        some.ravel(),
        method="DOP853",
        rtol=1e-12,
        atol=1e-12,
    )
    return Outcome(f"10⁴ of them as one system: {found.nfev} evaluations", None)
