"""Chaos: what deviations cost beside an orbit, a map of MEGNO beside heyoka, and how often the verdicts err.

    python benchmarks/chaos.py            # costs, a part of the map, verdicts, planets
    python benchmarks/chaos.py --whole    # and the whole map, 256 × 256 orbits over 1000 periods

Seconds are of the processor, all threads together; ratios within one run are what can be compared.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

sys.path.insert(0, str(Path(__file__).parents[1]))
from canon import SABA, Gauss, Hamiltonian, Splitting, WisdomHolman, coordinates, propagate
from canon.flow import (
    Regularity,
    fast_lyapunov_indicator,
    frequency_diffusion,
    gali,
    largest_lyapunov_exponent,
    lyapunov_spectrum,
    megno,
    reversal_test,
    sali,
)
from canon.scene import find

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

x, y, z = coordinates("x y z")
PERIOD = 2 * np.pi


def of_potential(V: Any, *q: Any) -> Hamiltonian:
    return Hamiltonian(sum(s.momentum**2 for s in q) / 2 + V, list(q), [s.momentum for s in q])


HENON_HEILES = of_potential((x**2 + y**2) / 2 + x**2 * y - y**3 / 3, x, y)
REGULAR, CHAOTIC = [0.0, 0.1, 0.3838402445462608, 0.1], [0.0, -0.25, 0.4208127057650866, 0.0]


def chain(masses: int, *, quartic: bool = False) -> Hamiltonian:
    q = [coordinates(f"q{i}") for i in range(masses)]
    stretched = [b - a for a, b in zip([0, *q], [*q, 0], strict=True)]
    return of_potential(sum(r**2 / 2 + (r**4 / 4 if quartic else r**3 / 12) for r in stretched), *q)


def seconds(work: Callable[[], object], repeats: int = 3) -> float:
    """The least processor time of some runs, after one that compiles."""
    work()
    best = float("inf")
    for _ in range(repeats):
        started = time.process_time()
        work()
        best = min(best, time.process_time() - started)
    return best


# what deviations cost -----------------------------------------------------------------------------------


def costs() -> None:
    print("cost in orbits alone, by propagate with the same method, step and samples")
    print(f"{'':34}{'1 vector':>10}{'2n vectors':>12}{'   wanted':>10}")
    start = [*np.sin(np.pi * np.arange(1, 33) / 33), *[0.0] * 32]
    cases: list[tuple[str, Any, list[float], Any, float, float, str]] = [
        ("Hénon–Heiles, verlet", HENON_HEILES, CHAOTIC, Splitting("verlet"), 0.05, 100_000, "2.5, 5"),
        ("Hénon–Heiles, kahan-li-8", HENON_HEILES, CHAOTIC, Splitting("kahan-li-8"), 0.2, 50_000, "2.5, 5"),
        ("Hénon–Heiles, gauss-4", HENON_HEILES, CHAOTIC, Gauss(4), 0.2, 10_000, "2.5, 5"),
        ("FPUT, 32 masses, verlet", chain(32), start, Splitting("verlet"), 0.1, 50_000, "2.5, 40"),
        ("FPUT, 32 masses, kahan-li-8", chain(32), start, Splitting("kahan-li-8"), 0.4, 20_000, "2.5, 40"),
    ]
    for name, system, y0, method, step, span, wanted in cases:
        how = {"method": method, "step": step, "samples": 100}
        alone, one, whole = (
            seconds(functools.partial(follow, system, (0, span), y0, **how))
            for follow in (propagate, largest_lyapunov_exponent, lyapunov_spectrum)
        )
        print(f"{name:34}{one / alone:10.1f}{whole / alone:12.1f}{wanted:>10}")


# a map --------------------------------------------------------------------------------------------------


def on_the_section(energy: float, side: int) -> np.ndarray:
    """Starts with x = 0, p_x > 0 on a square grid of (y, p_y) where the energy reaches, repeated to fill the square."""
    ys, ps = np.meshgrid(np.linspace(-0.45, 0.65, side), np.linspace(-0.5, 0.5, side))
    rest = 2 * energy - ps**2 - ys**2 + 2 * ys**3 / 3
    reached = np.flatnonzero(rest.ravel() > 0)
    filled = np.resize(reached, side * side)
    ys, ps, rest = (each.ravel()[filled] for each in (ys, ps, rest))
    return np.array([0 * ys, ys, np.sqrt(rest), ps])


def energy_error(starts: np.ndarray, states: np.ndarray) -> float:
    """The largest relative difference of H between two arrays of states, shape (4, orbits)."""

    def energy(state: np.ndarray) -> np.ndarray:
        u, v, pu, pv = state
        return (pu**2 + pv**2 + u**2 + v**2) / 2 + u**2 * v - v**3 / 3

    return float(np.abs(energy(states) / energy(starts) - 1).max())


def heyoka_seconds(starts: np.ndarray, span: float, tolerance: float) -> tuple[float, float]:
    """Processor time of heyoka's batches, as wide as it recommends, with one deviation, and its energy's error."""
    import heyoka as hy

    q = hy.make_vars("x", "y", "px", "py")
    d = hy.make_vars("dx", "dy", "dpx", "dpy")
    (u, v, pu, pv), (a, b, pa, pb) = q, d
    field = [(u, pu), (v, pv), (pu, -u - 2.0 * u * v), (pv, -v - u * u + v * v)]
    beside = [
        (a, pa),
        (b, pb),
        (pa, -a - 2.0 * (a * v + u * b)),
        (pb, -b - 2.0 * u * a + 2.0 * v * b),
    ]
    batch = hy.recommended_simd_size()
    first = np.concatenate([starts[:, :batch], np.full((4, batch), 0.5)])
    going = hy.taylor_adaptive_batch(field + beside, np.ascontiguousarray(first), tol=tolerance)
    started, worst = time.process_time(), 0.0
    for k in range(0, starts.shape[1] - batch + 1, batch):
        going.set_time(0.0)
        going.state[:4], going.state[4:] = starts[:, k : k + batch], 0.5
        for end in np.linspace(0, span, 101)[1:]:
            going.propagate_until(float(end))
            going.state[4:] /= np.linalg.norm(going.state[4:], axis=0)
        worst = max(worst, energy_error(starts[:, k : k + batch], going.state[:4]))
    return time.process_time() - started, worst


def jitcode_seconds(starts: np.ndarray, span: float, tolerance: float) -> float:
    """Processor time of jitcode_lyap with one deviation, by SciPy's DOP853; its compilation is not counted."""
    from jitcode import jitcode_lyap
    from jitcode import y as of  # its symbols of the state

    u, v, pu, pv = (of(k) for k in range(4))
    going = jitcode_lyap([pu, pv, -u - 2 * u * v, -v - u * u + v * v], n_lyap=1)
    with tempfile.TemporaryDirectory() as empty, contextlib.chdir(empty):  # elsewhere it reads pyproject.toml
        going.compile_C()  # where that fails it would go on with Python's functions
    going.set_integrator("dop853", rtol=tolerance, atol=tolerance)
    times = np.linspace(0, span, 101)[1:]
    going.set_initial_value(starts[:, 0], 0.0)
    going.integrate(times[0])
    started = time.process_time()
    for start in starts.T:
        going.set_initial_value(start, 0.0)
        for end in times:
            going.integrate(end)
    return time.process_time() - started


def map_of_megno(*, whole: bool) -> None:
    periods = 1000
    side = 256 if whole else 64
    starts = on_the_section(1 / 8, side)
    print(
        f"\nmap of MEGNO: Hénon–Heiles at E = 1/8, {side} × {side} orbits over {periods} periods of the linear motion"
    )
    each: dict[int, tuple[float, float]] = {}
    for steps in (8, 11, 16, 24):  # all in doubles, as heyoka's are
        how = {
            "method": Splitting("srkn-6b"),
            "step": PERIOD / steps,
            "samples": 100,
            "precision": "double",
        }
        megno(HENON_HEILES, (0, 60 * PERIOD), starts, **how)
        wall, cpu = time.perf_counter(), time.process_time()
        found = megno(HENON_HEILES, (0, periods * PERIOD), starts, **how)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        motion = propagate(HENON_HEILES, (0, periods * PERIOD), starts[:, :64], **how)
        each[steps] = cpu / side**2, float(np.abs(motion.energy_error).max())
        print(
            f"canon, srkn-6b, T/{steps}, energy to {each[steps][1]:.1e}: {cpu:.1f} s of the processor, {wall:.1f} s of "
            f"the clock; so 256 × 256 orbits take {each[steps][0] * 65536:.1f} s of the processor\n  {found}"
        )
    few = starts[:, :: max(1, side**2 // 32)][:, :32]
    for tolerance in (1e-15, 1e-9, 1e-7, 1e-6):
        spent, error = heyoka_seconds(few, periods * PERIOD, tolerance)
        steps = next((k for k in each if each[k][1] <= error), max(each))
        print(
            f"heyoka in batches, one deviation, tolerance {tolerance:.0e}, energy to {error:.1e}: "
            f"{spent / few.shape[1] / each[steps][0]:.1f} × as much for an orbit as T/{steps}, to {each[steps][1]:.1e}"
        )
    try:
        for tolerance in (1e-9, 1e-6):
            own = jitcode_seconds(few[:, :4], periods * PERIOD, tolerance) / 4
            said = f"jitcode_lyap, DOP853, one deviation, tolerance {tolerance:.0e}"
            print(f"{said}: {own / each[8][0]:.1f} × as much for an orbit as T/8")
    except ImportError:
        print("JiTCODE is not installed here (pip install jitcode)")


# verdicts -----------------------------------------------------------------------------------------------


def known_orbits() -> Iterator[tuple[str, Hamiltonian, np.ndarray, Any, float, float, Regularity]]:
    """Name, system, starts (2n, orbits), method, step, period, and what the orbits are."""
    regular, chaotic = Regularity.REGULAR, Regularity.CHAOTIC
    kahan_li, moan = Splitting("kahan-li-8"), Splitting("blanes-moan-6")
    r = sp.sqrt(x**2 + y**2)
    toda = sp.exp(x - y) + sp.exp(y - z) + sp.exp(z - x) - 3
    a, b, c = x, y, z
    yield "Hénon–Heiles, E = 1/100", HENON_HEILES, random_section(1 / 100, 8), kahan_li, 0.2, PERIOD, regular
    yield "Hénon–Heiles, E = 1/30", HENON_HEILES, random_section(1 / 30, 6), kahan_li, 0.2, PERIOD, regular
    twin = of_potential((x**2 + y**2) / 2 + x**2 * y + y**3 / 3, x, y)
    yield (
        "its integrable twin",
        twin,
        np.array([[0, 0.1, 0.3, 0.2], [0.2, 0.1, 0.1, 0.3], [0.1, -0.2, 0, 0.2]]).T,
        kahan_li,
        0.2,
        PERIOD,
        regular,
    )
    ellipses = np.array([[1 - e, 0, 0, np.sqrt((1 + e) / (1 - e))] for e in (0.1, 0.3, 0.6, 0.8)]).T
    yield "Kepler", of_potential(-1 / r, x, y), ellipses, kahan_li, 0.02, PERIOD, regular
    yield (
        "central, r⁴",
        of_potential(r**4 / 4, x, y),
        np.array([[1, 0, 0, 0.4], [1, 0, 0.3, 1.2]]).T,
        kahan_li,
        0.1,
        5.0,
        regular,
    )
    yield (
        "central, ln r",
        of_potential(sp.log(x**2 + y**2) / 2, x, y),
        np.array([[1, 0, 0, 0.3], [1, 0, 0.5, 0.8]]).T,
        kahan_li,
        0.02,
        4.0,
        regular,
    )
    yield (
        "oscillators",
        of_potential(x**2 / 2 + y**2 + 3 * z**2 / 2, x, y, z),
        np.array([[1, 0.5, 0.2, 0, 0.3, 0.1], [0.1, 0, 0.2, 1, 0, 0]]).T,
        kahan_li,
        0.1,
        PERIOD,
        regular,
    )
    yield (
        "one oscillator",
        of_potential(x**2 / 2, x),
        np.array([[1.0, 0.0]]).T,
        kahan_li,
        0.2,
        PERIOD,
        regular,
    )
    yield (
        "Toda, 3 masses",
        of_potential(toda, a, b, c),
        np.array(
            [
                [1, 0.5, -1.5, 0, 0.3, -0.3],
                [0.1, 0, -0.1, 0.1, 0, -0.1],
                [2, 0, -2, 1, 0, -1],
                [3, -1, -2, 0, 0, 0],
            ]
        ).T,
        kahan_li,
        0.1,
        4.0,
        regular,
    )
    yield (
        "pendulum",
        of_potential(-sp.cos(x), x),
        np.array([[0.5, 0], [3.0, 0], [0, 2.1], [0, 3], [np.pi - 1e-6, 0]]).T,
        kahan_li,
        0.1,
        PERIOD,
        regular,
    )
    yield (
        "x⁴ + y⁴",
        of_potential(x**4 + y**4, x, y),
        np.array([[1, 0.3, 0, 0.2], [0.5, 1, 0.1, 0]]).T,
        kahan_li,
        0.05,
        3.0,
        regular,
    )
    yield "FPUT, 8 masses, small", chain(8), chain_starts(0.05, 2), moan, 0.2, PERIOD, regular

    yield (
        "Hénon–Heiles, E = 0.1665",
        HENON_HEILES,
        section(
            0.1665,
            [
                (-0.1, 0),
                (0.05, 0.2),
                (0.0, 0.3),
                (-0.2, 0.1),
                (0.4, 0.1),
                (-0.3, 0.05),
                (0.1, -0.35),
                (0.6, 0.05),
            ],
        ),
        kahan_li,
        0.15,
        PERIOD,
        chaotic,
    )
    yield (
        "Hénon–Heiles, E = 1/8",
        HENON_HEILES,
        section(1 / 8, [(-0.25, 0), (-0.23, 0.02), (-0.24, 0.0), (-0.26, -0.05)]),
        kahan_li,
        0.2,
        PERIOD,
        chaotic,
    )
    quartic = of_potential(x**2 * y**2 / 2 + (x**4 + y**4) / 80, x, y)
    yield (
        "x²y² and a little more",
        quartic,
        np.array([[1, 0.3, 0, 0.2], [0.5, 1, 0.1, 0], [2, 0.1, 0.3, 0.5], [1, 1.1, -0.4, 0.7]]).T,
        moan,
        0.05,
        6.0,
        chaotic,
    )
    yield "FPUT, 8 masses, large", chain(8, quartic=True), chain_starts(3.0, 3), moan, 0.05, PERIOD, chaotic
    theta, phi = coordinates("theta phi")
    p, s = theta.momentum, phi.momentum
    double = Hamiltonian(
        (p**2 + 2 * s**2 - 2 * p * s * sp.cos(theta - phi)) / (2 * (1 + sp.sin(theta - phi) ** 2))
        - 2 * sp.cos(theta)
        - sp.cos(phi),
        [theta, phi],
        [p, s],
    )
    yield (
        "double pendulum, high",
        double,
        np.array([[2.0, 2.5, 0, 0], [2.5, 0.5, 0, 0], [1.8, -1.0, 0.5, 0]]).T,
        Gauss(4),
        0.05,
        PERIOD,
        chaotic,
    )
    yield (
        "double pendulum, low",
        double,
        np.array([[0.1, 0.05, 0, 0], [0.2, -0.1, 0, 0.1]]).T,
        Gauss(4),
        0.1,
        PERIOD,
        regular,
    )


def section(energy: float, places: list[tuple[float, float]]) -> np.ndarray:
    """Starts with x = 0, p_x > 0 at places (y, p_y)."""
    return np.array(
        [[0, v, np.sqrt(2 * energy - p**2 - v**2 + 2 * v**3 / 3), p] for v, p in places], dtype=float
    ).T


def random_section(energy: float, count: int) -> np.ndarray:
    random, size = np.random.default_rng(11), np.sqrt(2 * energy)
    return section(energy, [tuple(random.uniform(-0.6, 0.6, 2) * size) for _ in range(count)])


def chain_starts(size: float, count: int) -> np.ndarray:
    """Starts at rest in the lowest modes."""
    places = np.arange(1, 9) / 9
    modes = [np.concatenate([size * np.sin((k + 1) * np.pi * places), np.zeros(8)]) for k in range(count)]
    return np.array(modes).T


def confirmed(orbits: list[tuple[Any, ...]]) -> int:
    """How many of the orbits called chaotic here part by more than e^100 over a longer run, by another method."""
    count = 0
    for _, system, starts, method, step, period, truth in orbits:
        if truth is Regularity.CHAOTIC:
            other = Gauss(6) if isinstance(method, Gauss) else Splitting("sofroniou-spaletta-10")
            found = fast_lyapunov_indicator(
                system, (0, 2000 * period), starts, method=other, step=step, samples=200, seed=9
            )
            count += int((found.value > 100).sum())
    return count


def by_frequency(system: Hamiltonian, span: tuple[float, float], starts: np.ndarray, **how: Any) -> Any:
    """Verdicts by the main frequency of the first momentum in the two halves of the run."""
    samples = 2 * how["samples"]
    each = max(1, round((span[1] - span[0]) / how["step"] / samples))
    step = (span[1] - span[0]) / (samples * each)
    motion = propagate(system, span, starts, method=how["method"], step=step, samples=samples)
    momenta = motion.y[len(starts) // 2]
    found = [frequency_diffusion(motion.t, p) for p in momenta.T]
    return SimpleNamespace(verdict=[each.verdict for each in found], all=found)


def by_reversal(system: Hamiltonian, span: tuple[float, float], starts: np.ndarray, **how: Any) -> Any:
    return reversal_test(system, span, starts, method=how["method"], step=how["step"])


INDICATORS: dict[str, tuple[Callable[..., Any], int]] = {
    "megno, fast_lyapunov_indicator": (megno, 3),
    "lyapunov_spectrum": (lyapunov_spectrum, 3),
    "sali": (sali, 3),
    "gali, 3 vectors": (functools.partial(gali, vectors=3), 3),
    "frequency_diffusion": (by_frequency, 1),
    "reversal_test": (by_reversal, 1),
}
"""The indicators, and how many directions of deviations each is tried with."""


def called(
    orbits: list[tuple[Any, ...]], indicator: Callable[..., Any], seeds: int, periods: int
) -> Counter[tuple[Regularity, Regularity]]:
    """How often orbits of each kind are called what."""
    found: Counter[tuple[Regularity, Regularity]] = Counter()
    for _, system, starts, method, step, period, truth in orbits:
        if isinstance(indicator, functools.partial) and len(starts) < 4:
            continue  # GALI of three vectors takes two degrees of freedom
        how = {"method": method, "step": step, "samples": min(1000, 4 * periods)}
        for seed in range(seeds):
            judged = indicator(system, (0, periods * period), starts, seed=seed, **how)
            found.update((truth, verdict) for verdict in judged.verdict)
    return found


def verdicts(spans: tuple[int, ...] = (100, 1000)) -> None:
    orbits, kinds = list(known_orbits()), (Regularity.REGULAR, Regularity.CHAOTIC)
    regular, chaotic = (sum(o[2].shape[1] for o in orbits if o[6] is kind) for kind in kinds)
    parted = confirmed(orbits)
    print(
        f"\nverdicts on {regular} regular and {chaotic} chaotic orbits, each with up to 3 directions of deviations"
    )
    print(f"(of the {chaotic}, {parted} part as e^100 or more in 2000 periods by another method)")
    print(f"{'':32}{'':>8}{'regular ones called':>32}{'chaotic ones called':>32}")
    print(f"{'':32}{'periods':>8}{'regular   chaotic   not known':>32}{'regular   chaotic   not known':>32}")
    for name, (indicator, seeds) in INDICATORS.items():
        for periods in spans:
            found = called(orbits, indicator, seeds, periods)
            row = [found[truth, said] for truth in kinds for said in (*kinds, Regularity.NOT_KNOWN)]
            print(
                f"{name:32}{periods:8}{row[0]:12}{row[1]:10}{row[2]:10}{row[3]:12}{row[4]:10}{row[5]:10}",
                flush=True,
            )


# planets ------------------------------------------------------------------------------------------------


def of_planets() -> None:
    """What MEGNO costs beside the orbit of the outer planets, and beside REBOUND's where it is installed."""
    scene, steps, step = find("outer-solar-system"), 200_000, 200.0
    start, span = scene.start("1994"), (0.0, steps * step)
    y0 = [*start.q, *start.p]
    print(f"\nplanets: the outer solar system, {steps} steps of {step:g} days")
    print(
        "canon: whole calls, 100 samples; REBOUND: its integration alone, in safe mode where MEGNO asks for it"
    )
    print(f"{'':44}{'µs a step':>10}{'with MEGNO':>12}{'ratio':>7}{'MEGNO':>8}")

    def row(name: str, alone: float, beside: float, value: float) -> None:
        print(
            f"{name:44}{1e6 * alone / steps:10.3f}{1e6 * beside / steps:12.3f}{beside / alone:7.1f}{value:8.2f}"
        )

    for method in (
        WisdomHolman(),
        WisdomHolman(corrector=17),
        WisdomHolman(coordinates="democratic-heliocentric"),
        SABA(4),
    ):
        how = {"method": method, "step": step, "samples": 100, "parameters": scene.values}
        alone, beside = (
            seconds(functools.partial(follow, scene.hamiltonian, span, y0, **how))
            for follow in (propagate, megno)
        )
        row(f"canon {method}", alone, beside, megno(scene.hamiltonian, span, y0, **how).value)
    try:
        import rebound
    except ImportError:
        print("REBOUND is not installed here (pip install rebound)")
        return

    def run(*, indicator: bool, repeats: int = 3) -> tuple[float, float]:
        best, value = float("inf"), float("nan")
        gravity, masses = scene.values["G"], [scene.values[f"m{i}"] for i in range(6)]
        places = np.array(y0, dtype=float).reshape(2, -1, 3)
        for _ in range(repeats):
            sim = rebound.Simulation()
            for m, q, p in zip(masses, *places, strict=True):
                v = p / m
                sim.add(m=gravity * m, x=q[0], y=q[1], z=q[2], vx=v[0], vy=v[1], vz=v[2])
            sim.move_to_com()
            sim.integrator, sim.dt = "whfast", step
            sim.integrator.safe_mode = int(indicator)  # which its MEGNO asks for
            if indicator:
                sim.init_megno(seed=1)
            started = time.process_time()
            sim.integrate(span[1], exact_finish_time=0)
            best = min(best, time.process_time() - started)
            value = float(sim.megno()) if indicator else value
        return best, value

    (alone, _), (beside, value) = run(indicator=False), run(indicator=True)
    row(f"REBOUND {rebound.__version__} WHFast", alone, beside, value)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--whole", action="store_true", help="the whole map, 256 × 256 orbits")
    parser.add_argument("--only", choices=["costs", "map", "verdicts", "planets"], help="one part")
    given = parser.parse_args()
    warnings.simplefilter("error", RuntimeWarning)
    if given.only in (None, "costs"):
        costs()
    if given.only in (None, "map"):
        map_of_megno(whole=given.whole)
    if given.only in (None, "verdicts"):
        verdicts()
    if given.only in (None, "planets"):
        of_planets()


if __name__ == "__main__":
    main()
