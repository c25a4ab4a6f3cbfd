"""Close encounters and collisions."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from mpmath import mp, mpf

from canon import (
    DOP853,
    Event,
    Gauss,
    Hamiltonian,
    Splitting,
    TimeTransformed,
    WisdomHolman,
    coordinates,
    propagate,
)
from canon.flow import NonFiniteStateError
from extremes.numeric_tools import (
    Problem,
    by_taylor,
    motion_row,
    plain,
    rebound_installed,
    with_warnings,
)
from extremes.row import Outcome, Row, refused

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

x, y = coordinates("x y")
KEPLER = Hamiltonian(
    (x.momentum**2 + y.momentum**2) / 2 - 1 / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
)
LOGARITHMIC = TimeTransformed(Splitting("kahan-li-8"))


def rows() -> Iterator[Row]:
    """Yield the rows."""
    for gap, name in ((0.1, "0.9"), (0.01, "0.99"), (1e-6, "0.999999"), (1e-12, "1-1e-12")):
        yield motion_row(
            f"kepler-{name}-transformed",
            f"Kepler's motion, e = {name}, 16 revolutions from the pericentre; time-"
            "transformed splitting of order 8 (closed form, 60 digits)",
            partial(kepler, gap, 100.0),
            {"method": LOGARITHMIC, "step": 0.05 * gap},
            extra=with_rebound(partial(kepler, gap, 100.0)),
            limit=150.0,
        )
    for gap, name in ((0.01, "0.99"), (1e-6, "0.999999")):
        yield motion_row(
            f"kepler-{name}-taylor",
            f"the same, e = {name}, Taylor()",
            partial(kepler, gap, 100.0),
            {},
            others=(),
        )
    yield Row(
        "kepler-1-1e-12-taylor",
        "the same, e = 1 − 1e-12, Taylor(): derivatives of order 20 are beyond 1e308",
        lambda: refused(lambda: run(kepler(1e-12, 100.0)), ValueError, holds="time scale"),
    )
    yield motion_row(
        "kepler-1-1e-12-extended",
        "the same with precision='extended', whose exponents suffice, one revolution",
        partial(kepler, 1e-12, 6.5),
        {"precision": "extended"},
        others=(),
        limit=120,
    )
    yield motion_row(
        "kepler-apocentre",
        "e = 1 − 2.5e-13 from the apocentre, once through the pericentre, time-transformed",
        partial(from_apocentre, 7e-7),
        {"method": LOGARITHMIC, "step": 0.01},
    )
    yield Row(
        "kepler-apocentre-taylor",
        "the same, Taylor(): heyoka's derivatives overflow at the pericentre",
        lambda: refused(lambda: run(from_apocentre(7e-7)), NonFiniteStateError, holds="collision"),
    )
    yield motion_row(
        "kepler-0.999999-solvable",
        "e = 0.999999 by Kepler steps (Wisdom and Holman's map, no planets), 16 revolutions",
        partial(kepler, 1e-6, 100.0),
        {"method": WisdomHolman(), "step": 0.5},
        others=(),
    )
    yield motion_row(
        "kepler-0.999999-coarse",
        "e = 0.999999, Gauss(6) in steps of 0.01: 10⁷ times too long at the pericentre",
        partial(kepler, 1e-6, 10.0),
        {"method": Gauss(6), "step": 0.01},
        others=(),
    )
    yield Row(
        "collision-taylor",
        "a body falls straight into the centre, Taylor() up to t = 2; the collision is at π/√8 = 1.11",
        lambda: refused(lambda: run(fall(2.0)), NonFiniteStateError, holds="t = 1.1107207"),
        {"SciPy DOP853": lambda: passed_through("DOP853"), "heyoka": through_heyoka},
    )
    yield Row("collision-verlet", "the same, Verlet in steps of 0.01", fixed_through_collision)
    yield Row(
        "collision-solvable",
        "the same by Kepler steps of 0.01 (Wisdom and Holman's map), which turn back at the centre",
        solvable_through_collision,
    )
    yield Row(
        "collision-dop853",
        "the same, canon's DOP853()",
        lambda: refused(lambda: run(fall(2.0), method=DOP853()), NonFiniteStateError, holds="collision"),
    )
    yield Row(
        "collision-event",
        "the same, stopped at r = 1e-6 by an event (time in closed form)",
        stopped_before_collision,
    )
    yield motion_row(
        "flyby-1e-9",
        "a parabolic passage of the centre at a distance of 1e-9, time-transformed, |t| < 2",
        flyby,
        {"method": LOGARITHMIC, "step": 0.01},
        limit=90,
    )
    yield motion_row(
        "pythagorean",
        "Burrau's problem: masses 3, 4, 5 from rest, to t = 60, encounters at 4e-4, Taylor()",
        lambda: three_bodies(60.0),
        {},
        samples=60,
        extra=burrau_rebound(),
        limit=120,
    )
    yield motion_row(
        "pythagorean-transformed",
        "the same to t = 20, time-transformed splitting of order 8",
        lambda: three_bodies(20.0),
        {"method": LOGARITHMIC, "step": 5e-3},
        samples=20,
        others=(),
        limit=120,
    )


def run(given: Problem, **how: object) -> object:
    return propagate(given.hamiltonian, given.span, given.y0, samples=20, **how).final


def kepler(gap: float, until: float) -> Problem:
    start = (gap, 0.0, 0.0, ((2 - gap) / gap) ** 0.5)
    return Problem(KEPLER, start, (0.0, until), ellipse(start, 0))


def from_apocentre(speed: float) -> Problem:
    start = (2.0, 0.0, 0.0, speed)
    return Problem(KEPLER, start, (0.0, 6.0), ellipse(start, 1))


def ellipse(start: tuple[float, ...], half_turns: int) -> Callable[[np.ndarray], np.ndarray]:
    """Return Kepler's motion from an apsis on the x axis: the pericentre (0) or the apocentre (1)."""

    def truth(t: np.ndarray) -> np.ndarray:
        with mp.workdps(70):
            r, v = mpf(start[0]), mpf(start[3])
            a = 1 / (2 / r - v**2)
            sign = 1 - 2 * half_turns
            e, n = sign * (1 - r / a), mp.power(a, mpf(-3) / 2)
            found = [_at(a, e, n, n * mpf(float(s)) + half_turns * mp.pi) for s in t]
            return np.array(found, dtype=object).T * sign

    return truth


def _at(a: mpf, e: mpf, n: mpf, mean: mpf) -> list[mpf]:
    mean -= 2 * mp.pi * mp.nint(mean / (2 * mp.pi))
    low, high = mpf(0), mp.pi
    for _ in range(240):
        middle = (low + high) / 2
        low, high = (middle, high) if middle - e * mp.sin(middle) < abs(mean) else (low, middle)
    E = mp.sign(mean) * low
    r, b = 1 - e * mp.cos(E), mp.sqrt(1 - e * e)
    return [a * (mp.cos(E) - e), a * b * mp.sin(E), -a * n * mp.sin(E) / r, a * n * b * mp.cos(E) / r]


def fall(until: float) -> Problem:
    return Problem(KEPLER, (1.0, 0.0, 0.0, 0.0), (0.0, until), lambda t: np.full((4, len(t)), np.nan))


def passed_through(method: str) -> Outcome:
    from scipy.integrate import solve_ivp

    def rate(_t: float, s: np.ndarray) -> list[float]:
        r3 = (s[0] ** 2 + s[1] ** 2) ** 1.5
        return [s[2], s[3], -s[0] / r3, -s[1] / r3]

    with np.errstate(all="ignore"):
        found = solve_ivp(rate, (0, 2), [1, 0, 0, 0], method=method, rtol=1e-12, atol=1e-12)
    words = f"{found.message} at t = {found.t[-1]:.6g}, x = {found.y[0, -1]:.3g}"
    return Outcome(words, right=False) if found.success else Outcome(words, refused=True)


def through_heyoka() -> Outcome:
    import heyoka as hy

    a, b, u, v = hy.make_vars("a", "b", "u", "v")
    r3 = (a**2 + b**2) ** -1.5
    integrator = hy.taylor_adaptive([(a, u), (b, v), (u, -a * r3), (v, -b * r3)], [1.0, 0.0, 0.0, 0.0])
    outcome = integrator.propagate_until(2.0, max_steps=100_000)[0]
    words = f"{str(outcome).split('.')[-1]} at t = {integrator.time:.9g}"
    return (
        Outcome(words, right=False)
        if outcome == hy.taylor_outcome.time_limit
        else Outcome(words, refused=True)
    )


def fixed_through_collision() -> Outcome:
    given = fall(2.0)
    _, warning = with_warnings(lambda: run(given, method=Splitting("verlet"), step=0.01))
    return Outcome(warning or "no warning", refused=bool(warning), right=None if warning else False)


def solvable_through_collision() -> Outcome:
    given = fall(2.0)
    motion = propagate(given.hamiltonian, given.span, given.y0, method=WisdomHolman(), step=0.01, samples=20)
    estimate = motion.error_estimate()
    until = estimate.meaningful_until
    told = until is not None and until < 1.3
    return Outcome(str(estimate).split("; by ")[0], refused=told, right=None if told else False)


def stopped_before_collision() -> Outcome:
    near = Event(sp.sqrt(x**2 + y**2) - sp.Rational(1, 10**6), -1, "stop")
    motion = propagate(KEPLER, (0, 2), [1.0, 0.0, 0.0, 0.0], events=[near])
    with mp.workdps(40):
        r = mpf(10) ** -6
        true = mp.sqrt(mpf(1) / 2) * (mp.acos(mp.sqrt(r)) + mp.sqrt(r * (1 - r)))
        error = float(abs(mpf(motion.events[0].t) - true))
    return Outcome(f"t = {motion.events[0].t:.15g}", error, float(motion.error_estimate().events[0]))


def flyby() -> Problem:
    """A parabola x = q(1 − s²), y = 2qs about the centre, t = √(2 q³)(s + s³/3), from t = −2 to 2."""
    q = mpf(2) ** -30

    def at(t: float) -> list[mpf]:
        c = mpf(t) / mp.sqrt(2 * q**3)
        w = mp.cbrt((3 * abs(c) + mp.sqrt(9 * c * c + 4)) / 2)
        s = mp.sign(c) * (w - 1 / w)
        rate = 1 / (mp.sqrt(2 * q**3) * (1 + s * s))
        return [q * (1 - s * s), 2 * q * s, -2 * q * s * rate, 2 * q * rate]

    with mp.workdps(60):
        start = tuple(sp.Rational(str(v)) for v in at(-2.0))

    def truth(t: np.ndarray) -> np.ndarray:
        with mp.workdps(60):
            return np.array([at(float(s)) for s in t], dtype=object).T

    return Problem(KEPLER, start, (-2.0, 2.0), truth)


def three_bodies(until: float) -> Problem:
    """C. Burrau, Numerische Berechnung eines Spezialfalles des Dreikörperproblems, Astron. Nachr. 195 (1913) 113."""
    q = coordinates("x1 y1 x2 y2 x3 y3")
    p = [c.momentum for c in q]
    masses = (3, 4, 5)
    kinetic = sum((p[2 * i] ** 2 + p[2 * i + 1] ** 2) / (2 * m) for i, m in enumerate(masses))
    pairs = ((0, 1), (0, 2), (1, 2))
    potential = sum(
        -masses[i] * masses[j] / sp.sqrt((q[2 * i] - q[2 * j]) ** 2 + (q[2 * i + 1] - q[2 * j + 1]) ** 2)
        for i, j in pairs
    )
    H = Hamiltonian(kinetic + potential, q, p)
    start = (1.0, 3.0, -2.0, -1.0, 1.0, -1.0, *[0.0] * 6)
    return Problem(H, start, (0.0, until), by_taylor(H, start, 50))


def with_rebound(problem: Callable[[], Problem]) -> dict[str, Callable[[], Outcome]]:
    if not rebound_installed():
        return {}

    def ias15() -> Outcome:
        import rebound

        given = problem()
        sim = rebound.Simulation()
        sim.add(m=1.0)
        sim.add(m=0.0, x=given.y0[0], y=given.y0[1], vx=given.y0[2], vy=given.y0[3])
        return _followed(sim, given, [1], [1.0])

    return {"rebound IAS15": ias15}


def burrau_rebound() -> dict[str, Callable[[], Outcome]]:
    if not rebound_installed():
        return {}

    def ias15() -> Outcome:
        import rebound

        given = three_bodies(60.0)
        sim = rebound.Simulation()
        for i, m in enumerate((3.0, 4.0, 5.0)):
            sim.add(m=m, x=given.y0[2 * i], y=given.y0[2 * i + 1])
        return _followed(sim, given, [0, 1, 2], [3.0, 4.0, 5.0])

    return {"rebound IAS15": ias15}


def _followed(sim: object, given: Problem, bodies: list[int], masses: list[float]) -> Outcome:
    t = np.linspace(*given.span, 21)
    rows = []
    for instant in t:
        sim.integrate(instant)
        each = [sim.particles[k] for k in bodies]
        place = [c for b in each for c in (b.x, b.y)]
        rows.append([*place, *(c for b, m in zip(each, masses, strict=True) for c in (m * b.vx, m * b.vy))])
    return plain(np.array(rows).T, given.truth(t), f"{sim.steps_done} steps, no complaint")
