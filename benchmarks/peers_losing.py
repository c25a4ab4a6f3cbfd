"""Three kinds of problems that canon is not made for, beside libraries that are: stiff, large, with close encounters.

stiff
    A pendulum on a spring with k/m = 1e8, g = l = 1, which starts at rest 1 rad from the vertical with its spring as
    stretched as it hangs; a time of 2π. Told is the largest error of its place at the end, beside Taylor steps of a
    tolerance of 1e-15. ``relaxation`` is van der Pol's oscillator with µ = 1000 for a time of 2000, slow but for two
    jumps, beside Taylor steps of 1e-12: canon has no implicit method whose steps vary.
large
    Bodies of equal masses in a Plummer sphere, G = M = 1, E = −1/4, softened over 0.02; ``bodies`` 1,000 of them for a
    crossing time of 2√2, ``more-bodies`` 10,000 for an eighth of it. Told is |ΔE/E| between the ends, of every library
    from its states, by NumPy.
encounters
    A star and three planets of 3e-4 of its mass on orbits as near as two to three Hill radii, over 100 turns of the
    innermost, with some encounters within a Hill radius. Told is the largest |ΔE/E| at 200 instants.

Settings go from cheap to dear; the first that keeps an accuracy is timed, the median of runs that take turns: the loop
alone and the whole of a further call, as in ``benchmarks/peers.py``::

    python benchmarks/peers_losing.py --store
    python benchmarks/peers_losing.py --run --small

Without ``--run`` or ``--store`` the stored table is printed.
"""

from __future__ import annotations

import importlib.util
import statistics
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from peer_problems import PATIENCE, Array, Run, installed, parser_of, tell, timed

from canon import (
    Gauss,
    Hamiltonian,
    Lagrangian,
    Splitting,
    Taylor,
    TimeTransformed,
    WisdomHolman,
    coordinates,
    propagate,
)
from canon.flow import GalerkinVariational, prepare
from canon.mechanics import pair_sum, row_sum

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

STORED = Path(__file__).parent / "results" / "peers_losing.txt"
OTHERS = ("numbalsoda", "scipy", "jitcode", "diffrax", "rebound")
TURNS = 3


@dataclass
class Contender:
    """A method of a library: its settings from cheap to dear, and what runs one: seconds of its loop, what came out."""

    name: str
    settings: Iterable[Any]
    run: Callable[[Any], Run]
    chosen: dict[float, tuple[Any, float]] = field(default_factory=dict)


@dataclass
class Problem:
    """What it is, the accuracies wanted, how wrong what came out is, and who tries."""

    name: str
    accuracies: tuple[float, ...]
    error: Callable[[Array], float]
    contenders: list[Contender]


def canon_contender(
    method: str, system: Any, span: float, start: Any, settings: Iterable[Any], **how: Any
) -> Contender:
    """Return a method with its steps as settings; ``made`` tells what a setting asks for."""
    made = how.pop("made")
    kept: dict[Any, Any] = {}

    def run(setting: Any) -> Run:
        if setting not in kept:
            kept.clear()
            kept[setting] = prepare(system, (0.0, span), **how, **made(setting))
        motion = kept[setting].propagate(start)
        return motion.cpu_seconds, motion.y

    return Contender(f"canon {method}", settings, run)


def relative(energy: Array) -> float:
    error = float(abs(energy / energy[0] - 1).max())
    return error if np.isfinite(error) else np.inf


# stiff ---------------------------------------------------------------------------------------------

STIFFNESS, FRICTION = 1e8, 1e3
SPAN = 2 * np.pi


def stiff() -> Problem:
    x, y = coordinates("x y")
    V = y + sp.Float(STIFFNESS) / 2 * (sp.sqrt(x**2 + y**2) - 1) ** 2
    px, py = x.momentum, y.momentum
    system = Hamiltonian((px**2 + py**2) / 2 + V, [x, y], [px, py])
    stretched = 1 + np.cos(1) / STIFFNESS
    start = [stretched * np.sin(1), -stretched * np.cos(1), 0.0, 0.0]
    best = propagate(system, (0, SPAN), start, method=Taylor(1e-15), samples=1).y[:2, -1]
    found: list[Contender] = []

    def ours(method: str, settings: Iterable[Any], made: Callable[[Any], dict[str, Any]]) -> None:
        found.append(canon_contender(method, system, SPAN, start, settings, made=made, samples=1))

    for s in (2, 3, 4):
        way = Gauss(s, iteration="newton")
        steps = [50 * 2**k for k in range(8)]
        ours(str(way), steps, lambda n, way=way: {"method": way, "step": SPAN / n, "precision": "double"})
    fast = round(SPAN * STIFFNESS**0.5)
    ours(
        "verlet", [fast, 2 * fast],
        lambda n: {"method": Splitting("verlet"), "step": SPAN / n, "precision": "double"},
    )  # fmt: skip
    ours("Taylor", [1e-3, 1e-6, 1e-9, 1e-12], lambda tolerance: {"method": Taylor(tolerance)})
    a, b, u, v = sp.symbols("a b u v", real=True)
    r = sp.sqrt(a**2 + b**2)
    pull = STIFFNESS * (r - 1) / r
    found += stiff_others([a, b, u, v], [u, v, -pull * a, -pull * b - 1], np.array(start), SPAN, ("Radau",))
    return Problem(
        "spring pendulum, k/m = 1e8", (1e-4, 1e-8), lambda last: float(abs(last[:2, -1] - best).max()), found
    )


def relaxation() -> Problem:
    x = coordinates("x")
    pushed = sp.Float(FRICTION) * (1 - x**2) * x.dot
    system = Lagrangian((x.dot**2 - x**2) / 2, [x], forces=[pushed])
    a, u = sp.symbols("a u", real=True)
    rates, start, span = [u, FRICTION * (1 - a**2) * u - a], np.array([2.0, 0.0]), 2 * FRICTION
    best = propagate(system, (0, span), start, method=Taylor(1e-12), samples=1).y[0, -1]
    found = [
        canon_contender(
            "galerkin-2", system, span, start, [200_000 * 2**k for k in range(6)], samples=1,
            made=lambda n: {"method": GalerkinVariational(2), "step": span / n},
        ),
        canon_contender(
            "Taylor", system, span, start, [1e-3, 1e-6, 1e-9], samples=1,
            made=lambda tolerance: {"method": Taylor(tolerance)},
        ),
    ]  # fmt: skip
    found += stiff_others([a, u], rates, start, span, ("Radau", "BDF", "LSODA"))
    return Problem("van der Pol, µ = 1000", (1e-3, 1e-6), lambda last: float(abs(last[0, -1] - best)), found)


def stiff_others(
    state: list[Any], rates: list[Any], first: Array, span: float, implicit: tuple[str, ...]
) -> Iterator[Contender]:
    tolerances = [10.0**-k for k in range(4, 13)]

    def ends(spent: float, last: Any) -> Run:
        return spent, np.stack([first, np.asarray(last)], axis=1)

    if importlib.util.find_spec("numbalsoda"):
        import numba
        import numbalsoda

        place, size = sp.IndexedBase("s"), len(first)
        compiled = numba.njit(
            sp.lambdify(
                place, tuple(r.xreplace({s: place[i] for i, s in enumerate(state)}) for r in rates), "math"
            )
        )

        @numba.cfunc(numbalsoda.lsoda_sig)
        def right_side(_t: float, state: Array, rate: Array, _data: Array) -> None:
            found = compiled(state)
            for i in range(size):
                rate[i] = found[i]

        def lsoda(tolerance: float) -> Run:
            how = {"rtol": tolerance, "atol": tolerance, "mxstep": 10**7}
            spent, (states, _) = timed(
                lambda: numbalsoda.lsoda(right_side.address, first, np.array([0.0, span]), **how)
            )
            return ends(spent, states[-1])

        yield Contender("numbalsoda lsoda", tolerances, lsoda)
    if importlib.util.find_spec("scipy"):
        from scipy.integrate import solve_ivp

        jacobian = sp.lambdify([state], sp.Matrix(rates).jacobian(state).tolist(), "math", cse=True)
        plain = sp.lambdify([state], rates, "math", cse=True)
        for method in implicit:

            def solved(tolerance: float, method: str = method) -> Run:
                spent, motion = timed(
                    lambda: solve_ivp(
                        lambda _, s: plain(s.tolist()), (0, span), first, method, [span], rtol=tolerance,
                        atol=tolerance, jac=lambda _, s: np.array(jacobian(s.tolist())),
                    )
                )  # fmt: skip
                return ends(spent, motion.y[:, -1])

            yield Contender(f"scipy {method}", tolerances[::2], solved)
    if importlib.util.find_spec("diffrax"):
        yield kvaerno(rates, state, first, span)


def kvaerno(rates: list[Any], state: list[Any], first: Array, span: float) -> Contender:
    import jax

    jax.config.update("jax_enable_x64", bool(1))
    import diffrax
    import jax.numpy as jnp

    plain = sp.lambdify([state], rates, "jax", cse=True)

    @jax.jit
    def solve(tolerance: Any) -> Any:
        return diffrax.diffeqsolve(
            diffrax.ODETerm(lambda _t, s, _args: jnp.stack([jnp.asarray(r) for r in plain(s)])), diffrax.Kvaerno5(),
            0.0, span, None, jnp.array(first), saveat=diffrax.SaveAt(t1=True), max_steps=2**20, throw=False,
            stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=tolerance),
        ).ys[-1]  # fmt: skip

    def run(tolerance: float) -> Run:
        spent, last = timed(lambda: solve(tolerance).block_until_ready())
        return spent, np.stack([first, np.asarray(last)], axis=1)

    run(1e-2)
    return Contender("diffrax Kvaerno5", [1e-4, 1e-6, 1e-8, 1e-10], run)


# large ---------------------------------------------------------------------------------------------

SOFTENING = 0.02


def plummer(bodies: int) -> tuple[Array, Array]:
    """Return places and velocities, each (bodies, 3), of a Plummer sphere at rest as a whole."""
    drawn = np.random.default_rng(1)
    scale = 3 * np.pi / 16
    r = scale / np.sqrt(drawn.uniform(0, 0.999, bodies) ** (-2 / 3) - 1)
    share = np.empty(0)
    while len(share) < bodies:
        tried, level = drawn.uniform(0, 1, 4 * bodies), drawn.uniform(0, 0.1, 4 * bodies)
        share = np.concatenate([share, tried[level < tried**2 * (1 - tried**2) ** 3.5]])
    speed = share[:bodies] * np.sqrt(2) * (r**2 + scale**2) ** -0.25
    ways = drawn.normal(size=(2, bodies, 3))
    x, v = ways / np.linalg.norm(ways, axis=2, keepdims=True) * np.array([r, speed])[:, :, None]
    return x - x.mean(axis=0), v - v.mean(axis=0)


def energy_of(x: Array, v: Array) -> float:
    bodies = len(x)
    V = sum(
        float((1 / np.sqrt(((x[k + 1 :] - x[k]) ** 2).sum(axis=1) + SOFTENING**2)).sum())
        for k in range(bodies)
    )
    return float((v**2).sum()) / 2 / bodies - V / bodies**2


def large(bodies: int, span: float) -> Problem:
    x, v = plummer(bodies)
    places = [sp.symbols(f"x{k} y{k} z{k}", real=True) for k in range(bodies)]
    momenta = sp.symbols(f"p0:{3 * bodies}", real=True)
    m = sp.Rational(1, bodies)

    def attraction(a: Any, b: Any) -> Any:
        apart = sum((s - t) ** 2 for s, t in zip(a, b, strict=True))
        return -(m**2) / sp.sqrt(apart + sp.Float(SOFTENING) ** 2)

    H = row_sum(lambda p: p**2 / (2 * m), momenta) + pair_sum(attraction, places)
    system = Hamiltonian(H, [s for place in places for s in place], momenta)
    start = np.concatenate([x.ravel(), v.ravel() / bodies])
    found: list[Contender] = []
    steps = [round(span / 0.08 * 2 ** (k / 2)) for k in range(11)]
    for name in ("verlet", "mclachlan-4", "blanes-moan-4"):
        way = Splitting(name)
        every = [max(1, round(n / way.stages)) for n in steps]
        made = lambda n, way=way: {"method": way, "step": span / n * (1 + 1e-10)}  # noqa: E731
        found.append(
            canon_contender(name, system, span, start, every, made=made, samples=1, precision="double")
        )
    if importlib.util.find_spec("rebound"):
        found += large_others(x, v, span, steps)
    first = energy_of(x, v)

    def error(last: Array) -> float:
        far, fast = last[:, -1].reshape(2, bodies, 3)
        return abs(energy_of(far, fast * bodies) / first - 1)

    return Problem(f"{bodies:,} bodies, {span:.3g} units of time", (1e-3, 1e-5), error, found)


def add_bodies(sim: Any, masses: Array, x: Array, v: Array) -> None:
    for m, place, speed in zip(masses, x, v, strict=True):
        where, how_fast = zip("xyz", place, strict=True), zip(("vx", "vy", "vz"), speed, strict=True)
        sim.add(m=m, **dict(where), **dict(how_fast))


def large_others(x: Array, v: Array, span: float, steps: list[int]) -> Iterator[Contender]:
    import rebound

    def contender(name: str, gravity: str, angle: float = 0.0, order: int = 2) -> Contender:
        prepared = rebound.Simulation()
        prepared.softening = SOFTENING
        prepared.root_size = 1000.0
        prepared.gravity = gravity
        prepared.opening_angle2 = angle**2
        add_bodies(prepared, np.full(len(x), 1 / len(x)), x, v)
        prepared.integrator = "leapfrog"
        prepared.integrator.order = order

        def run(number: int) -> Run:
            sim = prepared.copy()
            sim.dt = span / number * (1 + 1e-12)
            spent, _ = timed(lambda: sim.integrate(span, exact_finish_time=0))
            far, fast = np.empty((len(x), 3)), np.empty((len(x), 3))
            sim.serialize_particle_data(xyz=far, vxvyvz=fast)
            return spent, np.concatenate([far.ravel(), fast.ravel() / len(x)])[:, None]

        stages = {2: 1, 4: 3}[order]
        return Contender(f"rebound {name}", [max(1, round(n / stages)) for n in steps], run)

    yield contender("leapfrog", "basic")
    yield contender("leapfrog 4", "basic", order=4)
    for angle in (0.5, 0.8, 1.2):
        yield contender(f"leapfrog, tree of angle {angle}", "tree", angle)


# encounters ----------------------------------------------------------------------------------------

PLANET, RADII, PHASES = 3e-4, (1.0, 1.16, 1.35), (0.0, 3.5, 0.9)


def planets() -> tuple[Array, Array, Array]:
    """Return masses, places and velocities, in the frame of the centre of mass."""
    a, f = np.array(RADII), np.array(PHASES)
    masses = np.array([1.0, *[PLANET] * len(a)])
    tilt = 0.01 * np.arange(1, len(a) + 1)
    x = np.stack([a * np.cos(f), a * np.sin(f), tilt * a * np.sin(f)], axis=1)
    v = np.stack([-np.sin(f), np.cos(f), tilt * np.cos(f)], axis=1) * np.sqrt((1 + PLANET) / a)[:, None]
    x, v = (np.concatenate([np.zeros((1, 3)), each]) for each in (x, v))
    return masses, *(each - (masses @ each) / masses.sum() for each in (x, v))


def encounters(turns: int) -> Problem:
    masses, x, v = planets()
    span, instants, n = 2 * np.pi * turns, 200, len(masses)
    places = [sp.symbols(f"x{k} y{k} z{k}", real=True) for k in range(n)]
    momenta = [sp.symbols(f"px{k} py{k} pz{k}", real=True) for k in range(n)]
    m = [sp.Float(each) for each in masses]
    pairs = [(i, k) for i in range(n) for k in range(i)]
    V = sum(
        -m[i] * m[k] / sp.sqrt(sum((s - t) ** 2 for s, t in zip(places[i], places[k], strict=True)))
        for i, k in pairs
    )
    T = sum(p**2 / (2 * m[i]) for i in range(n) for p in momenta[i])
    q, p = ([s for each in half for s in each] for half in (places, momenta))
    system = Hamiltonian(T + V, q, p)
    start = np.concatenate([x.ravel(), (masses[:, None] * v).ravel()])
    found = [
        canon_contender("Taylor", system, span, start, [10.0**-k for k in range(5, 16)], samples=instants,
                        made=lambda tolerance: {"method": Taylor(tolerance)}),
    ]  # fmt: skip
    steps = [round(turns * 20 * 2**k) for k in range(9)]
    ways: list[Any] = [WisdomHolman(), Splitting("srkn-6b"), TimeTransformed(Splitting("blanes-moan-6"))]
    for way in ways:
        more = {} if isinstance(way, TimeTransformed) else {"precision": "double"}
        made = lambda k, way=way: {"method": way, "step": span / k * (1 + 1e-10)}  # noqa: E731
        found.append(
            canon_contender(str(way), system, span, start, steps, made=made, samples=instants, **more)
        )
    if importlib.util.find_spec("rebound"):
        found += encounters_others(span, steps, instants)

    def error(states: Array) -> float:
        far, fast = states.astype(np.longdouble).reshape(2, n, 3, -1)
        kinetic = ((fast**2).sum(axis=1) / (2 * masses[:, None])).sum(axis=0)
        return relative(
            kinetic
            - sum(masses[i] * masses[k] / np.sqrt(((far[i] - far[k]) ** 2).sum(axis=0)) for i, k in pairs)
        )

    return Problem(
        f"a star, three planets, close encounters, {turns} turns", (1e-5, 1e-7, 1e-9), error, found
    )


def encounters_others(span: float, steps: list[int], instants: int) -> Iterator[Contender]:
    import rebound

    masses, x, v = planets()

    def contender(name: str, settings: Iterable[Any], apply: Callable[[Any, Any], None]) -> Contender:
        prepared = rebound.Simulation()
        add_bodies(prepared, masses, x, v)
        prepared.integrator = name

        def run(setting: Any) -> Run:
            sim, spent, found = prepared.copy(), 0.0, np.empty((2, instants + 1, len(masses), 3))
            apply(sim, setting)
            for k in range(instants + 1):
                if k:
                    spent += timed(lambda k=k: sim.integrate(span * k / instants, exact_finish_time=0))[0]
                    sim.synchronize()
                sim.serialize_particle_data(xyz=found[0, k], vxvyvz=found[1, k])
            found[1] *= masses[:, None]
            return spent, found.transpose(0, 2, 3, 1).reshape(-1, instants + 1)

        return Contender(f"rebound {name}", settings, run)

    def stepped(sim: Any, number: int) -> None:
        sim.dt = span / number

    def tolerant(sim: Any, tolerance: float) -> None:
        sim.integrator.eps_abs = sim.integrator.eps_rel = tolerance

    yield contender(
        "ias15", [1e-4, 1e-6, 1e-9], lambda sim, epsilon: setattr(sim.integrator, "epsilon", epsilon)
    )
    yield contender("bs", [10.0**-k for k in range(4, 14)], tolerant)
    for name in ("mercurius", "trace"):
        yield contender(name, steps, stepped)


# the comparison ------------------------------------------------------------------------------------

PROBLEMS: dict[str, Callable[[bool], Problem]] = {
    "stiff": lambda _small: stiff(),
    "relaxation": lambda _small: relaxation(),
    "bodies": lambda small: large(150 if small else 1000, 2 * np.sqrt(2) / (8 if small else 1)),
    "more-bodies": lambda small: large(300 if small else 10_000, np.sqrt(2) / 4),
    "encounters": lambda small: encounters(5 if small else 100),
}


def search(problem: Problem, contender: Contender, patience: float) -> None:
    """Find the first setting that keeps each accuracy, and what it keeps."""
    wanted, spent = sorted(problem.accuracies, reverse=True), 0.0
    for setting in contender.settings:
        try:
            seconds, (_, found) = timed(lambda setting=setting: contender.run(setting))
            error = problem.error(found)
        except (ArithmeticError, RuntimeError):
            continue
        while wanted and error <= wanted[0]:
            contender.chosen[wanted.pop(0)] = setting, error
        spent += seconds
        if not wanted or spent > patience:
            return


def compare(problem: Problem, patience: float, turns: int = TURNS) -> Iterator[str]:
    for contender in problem.contenders:
        search(problem, contender, patience)
    for accuracy in sorted(problem.accuracies, reverse=True):
        yield f"{problem.name}, error ≤ {accuracy:.0e}"
        able = [c for c in problem.contenders if accuracy in c.chosen]
        runs: dict[str, list[tuple[float, float]]] = {c.name: [] for c in able}
        for _ in range(turns):
            for c in able:
                whole, (loop, _) = timed(lambda c=c, accuracy=accuracy: c.run(c.chosen[accuracy][0]))
                runs[c.name].append((loop * 1e6, whole * 1e6))
        costs = {
            name: [statistics.median(each) for each in zip(*times, strict=True)]
            for name, times in runs.items()
        }
        for c in sorted(able, key=lambda c: costs[c.name]):
            setting, error = c.chosen[accuracy]
            loop, whole = costs[c.name]
            yield f"    {c.name:38} {setting:10.4g} {error:9.1e} {loop:14.0f} µs, {whole:.0f} the whole call"
        ratios = list[float]()
        for k in (0, 1):
            own, others = (
                [cost[k] for name, cost in costs.items() if name.startswith("canon") == mine]
                for mine in (True, False)
            )
            if own and others:
                ratios.append(min(own) / min(others))
        if ratios:
            won = (
                "canon loses"
                if max(ratios) > 1 and min(ratios) > 1
                else "canon wins"
                if max(ratios) < 1
                else "one each"
            )
            yield f"    canon {ratios[0]:.3g} × the cheapest other, {ratios[1]:.3g} × by the whole call: {won}"
        missing = ", ".join(c.name for c in problem.contenders if accuracy not in c.chosen)
        if missing:
            yield f"    not reached within {patience:g} s of settings tried: {missing}"


def main() -> None:
    """Print the table."""
    parser = parser_of(__doc__, PROBLEMS)
    parser.add_argument("--small", action="store_true", help="fewer bodies and turns, less patience")
    given = parser.parse_args()

    def lines() -> Iterator[str]:
        yield from installed(OTHERS)
        patience, turns = (1.0, 1) if given.small else (3 * PATIENCE, TURNS)
        for name in given.problems or PROBLEMS:
            yield from compare(PROBLEMS[name](given.small), patience, turns)

    tell(given, STORED, lines)


if __name__ == "__main__":
    main()
