"""Ten thousand orbits over 100 periods, beside heyoka's batches and REBOUND: processor time an orbit.

Of each contender the cheapest setting tried that keeps max |ΔE/E| ≤ 1e-8 at the ends of 16 equal stretches, over 64 of
the orbits; then all orbits, the last states kept, the largest error among them told. The time is the processor's, of
all threads together, of a whole call from starts to ends on a problem that is set up and compiled, and of the loop
alone: the calls that integrate. Orbits of Hénon–Heiles start on the section x = 0 with energy 1/12, those of Kepler at
the pericentre with eccentricities of 0 … 0.6. REBOUND has one simulation an orbit, one after the other::

    python benchmarks/peers_ensembles.py --store              # all, and keep what is printed
    python benchmarks/peers_ensembles.py --run --orbits 200   # a small one

Without ``--run`` or ``--store`` the stored table is printed.
"""

from __future__ import annotations

import importlib.util
import statistics
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from peer_problems import Array, Problem, Run, installed, parser_of, steps, tell, timed

from canon import Splitting, WisdomHolman
from canon.flow import prepare

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

STORED = Path(__file__).parent / "results" / "peers_ensembles.txt"
ACCURACY, PERIODS, STRETCHES, TURNS = 1e-8, 100, 16, 3
TOLERANCES = [10.0**-k for k in range(7, 16)]

Contender = tuple[str, "Iterable[Any]", "Callable[[Any, Array, int], Run]"]
"""Its name, settings from cheap to dear, and what runs one from starts (2n, orbits) in so many stretches: the seconds
of its loop and states (2n, stretches + 1, orbits)."""


def starts_of(problem: Problem, orbits: int) -> Array:
    drawn = np.random.default_rng(1)
    if problem.scene == "kepler":
        e = drawn.uniform(0, 0.6, orbits)
        return np.array([1 - e, 0 * e, 0 * e, np.sqrt(problem.values["mu"] * (1 + e) / (1 - e))])
    y, p = drawn.uniform(-0.25, 0.3, orbits), drawn.uniform(-0.2, 0.2, orbits)
    return np.array([0 * y, y, np.sqrt(1 / 6 - p**2 - y**2 + 2 * y**3 / 3), p])


# contenders ----------------------------------------------------------------------------------------


def canon_methods(problem: Problem) -> Iterator[Contender]:
    methods: list[Any] = [Splitting(name) for name in ("srkn-6a", "srkn-6b", "blanes-moan-6", "kahan-li-8")]
    if problem.scene == "kepler":
        methods = [WisdomHolman(), *methods]
    made: dict[Any, Any] = {}
    for method in methods:

        def run(setting: int, starts: Array, stretches: int, method: Any = method) -> Run:
            key = str(method), setting, stretches
            if key not in made:
                made[key] = prepare(
                    problem.hamiltonian, (0.0, problem.span), method=method, parameters=problem.values,
                    step=problem.span / problem.periods / setting * (1 + 1e-10), samples=stretches,
                    precision="double",
                )  # fmt: skip
            motion = made[key].propagate(starts)
            return motion.cpu_seconds, motion.y

        yield (
            f"canon {method}",
            [*([1] if isinstance(method, type(WisdomHolman())) else []), *steps(problem)],
            run,
        )


def heyoka_methods(problem: Problem) -> Iterator[Contender]:
    import heyoka as hy

    q, p = ([hy.make_vars(str(s)) for s in half] for half in (problem.q, problem.p))
    system = hy.hamiltonian(hy.from_sympy(problem.H), q, p)
    made: dict[Any, Any] = {}

    def integrator(lanes: int, setting: float, **way: bool) -> Any:
        key = lanes, setting, *way
        if key not in made:
            first = np.tile(problem.y0[:, None], (1, lanes))
            made[key] = (
                hy.taylor_adaptive_batch(system, first, tol=setting, **way)
                if lanes > 1
                else hy.taylor_adaptive(system, problem.y0, tol=setting, **way)
            )
        return made[key]

    def begin(own: Any, lanes: int, part: Array) -> Any:
        own.set_time(0.0) if lanes > 1 else setattr(own, "time", 0.0)
        own.state[:] = part if lanes > 1 else part[:, 0]
        return own

    def in_turn(lanes: int, name: str, **way: bool) -> Contender:
        def run(setting: float, starts: Array, stretches: int) -> Run:
            own, found = integrator(lanes, setting, **way), [starts.copy() for _ in range(stretches + 1)]
            spent = 0.0
            for k in range(0, starts.shape[1], lanes):
                begin(own, lanes, starts[:, k : k + lanes])
                for i in range(1, stretches + 1):
                    spent += timed(lambda i=i: own.propagate_until(problem.span * i / stretches))[0]
                    found[i][:, k : k + lanes] = own.state.reshape(-1, lanes)
            return spent, np.stack(found, axis=1)

        return f"heyoka {name}", TOLERANCES, run

    yield in_turn(1, "one by one", fast_math=True)
    for lanes in (hy.recommended_simd_size(), 2 * hy.recommended_simd_size()):
        yield in_turn(lanes, f"batch of {lanes}")
        yield in_turn(lanes, f"batch of {lanes}, fast math", fast_math=True)
    lanes = hy.recommended_simd_size()

    def ensemble(setting: float, starts: Array, stretches: int) -> Run:
        parts = starts.shape[1] // lanes
        spent, found = timed(
            lambda: hy.ensemble_propagate_grid_batch(
                integrator(lanes, setting, fast_math=True), np.linspace(0, problem.span, stretches + 1), parts,
                lambda own, i: begin(own, lanes, starts[:, i * lanes : (i + 1) * lanes]),
            )
        )  # fmt: skip
        return spent, np.concatenate([each[-1].transpose(1, 0, 2) for each in found], axis=2)

    yield f"heyoka ensemble_propagate_grid_batch, {lanes}", TOLERANCES, ensemble


def rebound_methods(problem: Problem) -> Iterator[Contender]:
    import rebound

    if problem.scene != "kepler":
        return

    def contender(integrator: str, settings: Iterable[Any], **more: int) -> Contender:
        prepared = rebound.Simulation()
        prepared.add(m=problem.values["mu"])
        prepared.add(m=0.0, x=1.0)
        prepared.integrator = integrator
        for name, value in more.items():
            setattr(prepared.integrator, name, value)

        def run(setting: float, starts: Array, stretches: int) -> Run:
            found, spent, exact = (
                np.empty((4, stretches + 1, starts.shape[1])),
                0.0,
                int(integrator == "ias15"),
            )
            for k, (x, y, u, v) in enumerate(starts.T):
                sim = prepared.copy()
                if integrator == "ias15":
                    sim.integrator.epsilon = setting
                else:
                    sim.dt = problem.span / problem.periods / setting
                body = sim.particles[1]
                body.x, body.y, body.vx, body.vy = x, y, u, v
                found[:, 0, k] = x, y, u, v
                for i in range(1, stretches + 1):
                    end = problem.span * i / stretches
                    spent += timed(lambda sim=sim, end=end: sim.integrate(end, exact_finish_time=exact))[0]
                    sim.synchronize()
                    found[:, i, k] = body.x, body.y, body.vx, body.vy
            return spent, found

        return f"rebound {integrator}", settings, run

    yield contender("whfast", [1, 2, 3, *steps(problem)], safe_mode=0)
    yield contender("ias15", [1e-6, 1e-9])


METHODS = {"canon": canon_methods, "heyoka": heyoka_methods, "rebound": rebound_methods}
PROBLEMS = {
    "henon-heiles": ("Hénon–Heiles", "henon-heiles", 0, 4, PERIODS),
    "kepler": ("Kepler, e = 0 … 0.6", "kepler", 0, 10, PERIODS),
}


# the comparison ------------------------------------------------------------------------------------


def worst(problem: Problem, found: Array) -> float:
    energy = problem.energy(*found.astype(np.longdouble))
    error = float(abs(energy / energy[0] - 1).max())
    return error if np.isfinite(error) else np.inf


def cheapest(problem: Problem, contender: Contender, starts: Array) -> Any:
    """Return the first setting that keeps the accuracy, None where none does."""
    _, settings, run = contender
    for setting in settings:
        if worst(problem, run(setting, starts, STRETCHES)[1]) <= ACCURACY:
            return setting
    return None


def compare(key: tuple[str, str, int, int, int], orbits: int) -> Iterator[str]:
    problem = Problem(*key)
    starts = starts_of(problem, orbits)
    yield f"{problem.name}, {orbits} orbits, max |ΔE/E| ≤ {ACCURACY:.0e}"
    rows: list[tuple[float, float, str, Any, float]] = []
    for library, methods in METHODS.items():
        for contender in methods(problem) if importlib.util.find_spec(library) else ():
            name, _, run = contender
            setting = cheapest(problem, contender, starts[:, :64])
            if setting is None:
                continue
            wholes, loops = list[float](), list[float]()
            for _ in range(TURNS):
                seconds, (loop, found) = timed(lambda run=run, setting=setting: run(setting, starts, 1))
                wholes.append(seconds)
                loops.append(loop)
            loop, whole = (statistics.median(each) / orbits * 1e6 for each in (loops, wholes))
            rows.append((whole, loop, name, setting, worst(problem, found)))
    for whole, loop, name, setting, error in sorted(rows):
        yield f"    {name:38} {setting:10.4g} {error:9.1e} {loop:12.2f} µs an orbit, {whole:.2f} the whole call"
    yield from ratio(rows)


def ratio(rows: list[tuple[float, float, str, Any, float]]) -> Iterator[str]:
    loops, wholes = (
        [
            min((row[k] for row in rows if row[2].startswith("canon") == mine), default=0.0)
            for mine in (True, False)
        ]
        for k in (1, 0)
    )
    if loops[1]:
        told = (
            f"{loops[0] / loops[1]:.2f} × the cheapest other, {wholes[0] / wholes[1]:.2f} × by the whole call"
        )
        yield f"    canon {told}"


def main() -> None:
    """Print the table."""
    parser = parser_of(__doc__, PROBLEMS)
    parser.add_argument("--orbits", type=int, default=10_000)
    given = parser.parse_args()

    def lines() -> Iterator[str]:
        yield from installed(name for name in METHODS if name != "canon")
        for name in given.problems or PROBLEMS:
            yield from compare(PROBLEMS[name], given.orbits)

    tell(given, STORED, lines)


if __name__ == "__main__":
    main()
