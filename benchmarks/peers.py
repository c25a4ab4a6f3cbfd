"""Work at a wanted accuracy over 1000 periods, beside every other library that is installed.

For each problem, contender and accuracy: the cheapest setting tried (steps a period, or tolerance) that keeps
max |ΔE/E| at 3137 instants below it, and the processor time a period of a run that keeps the last state only: the
median of runs that take turns. Of others it is the time of the call that integrates, on a problem that is set up and
compiled. Of canon both are told: the loop alone, and the whole of a call on a motion that is prepared likewise
(``canon.flow.prepare``), which checks the start and measures the energy of what comes out. Others are installed into an
environment of their own; canon needs none of them::

    pip install rebound galpy pyhamsys diffrax numbalsoda    # the last needs a Fortran compiler
    python benchmarks/peers.py --store

Without ``--run`` or ``--store`` the stored table is printed.
"""

from __future__ import annotations

import argparse
import importlib.util
import platform
import statistics
import time
import warnings
from dataclasses import dataclass, field
from datetime import date
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from canon import SABA, Gauss, Splitting, Taylor, WisdomHolman
from canon.flow import prepare
from canon.scene import find

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from canon.flow import PreparedMotion, Trajectory

STORED = Path(__file__).parent / "results" / "peers.txt"
ACCURACIES = (1e-4, 1e-8, 1e-12)
PERIODS, INSTANTS, TURNS = 1000, 3137, 5
TOLERANCES = [10.0**-k for k in range(3, 17)]
LIBRARIES = ("rebound", "galpy", "pyhamsys", "diffrax", "numbalsoda", "scipy", "heyoka")
DEAR, DEAR_PERIODS = ("scipy", "diffrax", "pyhamsys"), 50
"""These run for fewer periods; the error of the first two is taken to grow in proportion to time, as it does."""

PATIENCE = 8.0
"""Seconds of processor time after which dearer settings of a contender are not tried any more."""

Array = np.ndarray
Run = tuple[float, Array]
"""Processor seconds, and states (2n, times) or energies (times,)."""


def _is_thirds(x: Any) -> bool:
    """Tell whether a number is a quotient that doubles do not have: heyoka takes none."""
    return x.is_Rational and x.q & (x.q - 1) != 0


class Problem:
    """A scene from one of its starts, with numbers for its parameters, in plain SymPy symbols q0, …, p0, …"""

    def __init__(self, name: str, scene: str, start: int, fewest: int, periods: int = PERIODS) -> None:
        self.name, self.scene, self.fewest, self.periods = name, scene, fewest, periods
        known = find(scene)
        self.hamiltonian, self.values = known.hamiltonian, known.values
        whole = known.hamiltonian
        self.y0 = known.state(known.starts[start])
        self.span = periods * known.time_scale(known.values)
        self.q, self.p = (list(sp.symbols(f"{letter}:{len(whole.q)}", real=True)) for letter in "qp")
        numbers = {
            s: sp.Float(self.values[str(s)], 17) for s in whole.H.free_symbols if str(s) in self.values
        }
        plain = dict(zip((*whole.q, *whole.p), (*self.q, *self.p), strict=True))
        self.H = whole.H.xreplace({**numbers, **plain}).replace(_is_thirds, lambda x: sp.Float(x, 17))
        self.rates = [*(self.H.diff(x) for x in self.p), *(-self.H.diff(x) for x in self.q)]
        self.energy = sp.lambdify([*self.q, *self.p], self.H, "numpy", cse=True)

    def error(self, found: Array) -> float:
        """Return max |ΔE/E| of states or energies."""
        wide = np.asarray(found, dtype=np.longdouble)
        energy = wide if wide.ndim == 1 else self.energy(*wide)
        error = float(abs(energy / energy[0] - 1).max())
        return error if np.isfinite(error) else np.inf


@dataclass
class Contender:
    """A method of a library on a problem: settings from cheap to dear, and what runs one."""

    name: str
    settings: Iterable[Any]
    run: Callable[[Any, int], Run]
    chosen: dict[float, Any] = field(default_factory=dict)
    costs: dict[float, list[float]] = field(default_factory=dict)
    calls: dict[float, list[float]] = field(default_factory=dict)

    @property
    def library(self) -> str:
        """Whose it is."""
        return self.name.split()[0]

    def cost(self, accuracy: float) -> float:
        """Return microseconds a period."""
        return self._a_period(self.costs[accuracy])

    def call(self, accuracy: float) -> float:
        """Return microseconds a period of the whole call: of others, what :meth:`cost` is."""
        return self._a_period((self.calls if self.library == "canon" else self.costs)[accuracy])

    def _a_period(self, seconds: list[float]) -> float:
        periods = DEAR_PERIODS if self.library in DEAR else PERIODS
        return statistics.median(seconds[-TURNS:]) / periods * 1e6


def timed(call: Callable[[], Any]) -> tuple[float, Any]:
    begun = time.process_time()
    found = call()
    return time.process_time() - begun, found


def steps(problem: Problem, factor: float = 1.15) -> list[int]:
    """Return numbers of steps a period, from few to many."""
    return sorted({round(problem.fewest * factor**k) for k in range(round(np.log(150) / np.log(factor)))})


# canon ---------------------------------------------------------------------------------------------


def canon_methods(problem: Problem) -> Iterator[Contender]:
    splittings = ["mclachlan-4", "blanes-moan-4", "blanes-moan-6", "srkn-6a", "srkn-6b", "kahan-li-8",
                  "sofroniou-spaletta-10"]  # fmt: skip
    methods: list[Any] = [Splitting(name) for name in splittings]
    if problem.scene == "kepler":
        methods.append(WisdomHolman())
    if problem.scene == "outer-solar-system":
        methods = [WisdomHolman(), WisdomHolman(corrector=11), WisdomHolman(corrector=11, commutator=True),
                   SABA(2), SABA(4), SABA("8-6-4"), SABA("10-6-4")]  # fmt: skip
    if problem.scene == "henon-heiles":
        methods += [SABA("8-6-4"), SABA("10-6-4")]
    if problem.scene == "double-pendulum":
        methods = [Gauss(s) for s in (2, 3, 4, 5, 6, 8)]
    made: dict[Any, PreparedMotion] = {}

    def motion_of(method: Any, instants: int, **settings: Any) -> Trajectory:
        """Return a motion; what is not the start's is worked out once, as other libraries' problems are."""
        key = str(method), instants, *settings.values()
        if key not in made:
            made[key] = prepare(
                problem.hamiltonian, (0.0, problem.span), method=method, parameters=problem.values,
                samples=instants, **settings,
            )  # fmt: skip
        return made[key].propagate(problem.y0)

    for method in methods:

        def run(setting: int, instants: int, method: Any = method) -> Run:
            step = problem.span / problem.periods / setting * (1 + 1e-10)
            motion = motion_of(method, instants, step=step, precision="double")
            # A run of fewer steps than instants shows every step.
            return motion.cpu_seconds, np.pad(motion.energy, (0, instants + 1 - len(motion.energy)), "edge")

        fewest = (
            [1, 2, 3] if isinstance(method, type(WisdomHolman())) and problem.scene != "henon-heiles" else []
        )
        yield Contender(f"canon {method}", [*fewest, *steps(problem)], run)

    def taylor(setting: float, instants: int) -> Run:
        motion = motion_of(Taylor(setting), instants)
        return motion.cpu_seconds, motion.energy

    yield Contender("canon Taylor", TOLERANCES, taylor)


# the others ----------------------------------------------------------------------------------------


def heyoka_methods(problem: Problem) -> Iterator[Contender]:
    import heyoka as hy

    H = hy.from_sympy(problem.H)
    q, p = ([hy.make_vars(str(s)) for s in half] for half in (problem.q, problem.p))
    system = hy.hamiltonian(H, q, p)
    made: dict[Any, Any] = {}
    for compact in (False, True):
        if compact != (len(problem.q) > 8):
            continue
        for way in ({}, {"high_accuracy": True}, {"fast_math": True}):

            def run(
                setting: float, instants: int, compact: bool = compact, way: dict[str, bool] = way
            ) -> Run:
                key = setting, compact, *way
                if key not in made:
                    made[key] = hy.taylor_adaptive(
                        system, problem.y0, tol=setting, compact_mode=compact, **way
                    )
                own = made[key]
                own.time, own.state[:] = 0.0, problem.y0
                if instants == 1:
                    spent, _ = timed(lambda: own.propagate_until(problem.span))
                    return spent, np.stack([problem.y0, own.state], axis=1)
                grid = np.linspace(0, problem.span, instants + 1)
                spent, found = timed(lambda: own.propagate_grid(grid))
                return spent, found[-1].T

            words = [*(["compact"] if compact else []), *(word.replace("_", " ") for word in way)]
            yield Contender(f"heyoka {' '.join(words)}".rstrip(), TOLERANCES, run)


def scipy_methods(problem: Problem) -> Iterator[Contender]:
    from scipy.integrate import solve_ivp

    rates = sp.lambdify([[*problem.q, *problem.p]], problem.rates, "math", cse=True)
    for method in ("DOP853", "LSODA"):

        def run(setting: float, instants: int, method: str = method) -> Run:
            at = np.linspace(0, problem.span, instants + 1)
            spent, found = timed(
                lambda: solve_ivp(
                    lambda _, y: rates(y.tolist()),
                    (0, problem.span),
                    problem.y0,
                    method,
                    at,
                    rtol=setting,
                    atol=setting,
                )
            )
            return spent, found.y

        yield Contender(f"scipy {method}", [1e-7, 1e-10, 1e-13], run)


def rebound_methods(problem: Problem) -> Iterator[Contender]:
    import rebound

    if problem.scene not in ("kepler", "outer-solar-system"):
        return
    values = problem.values
    planets = problem.scene == "outer-solar-system"
    masses = [values[f"m{i}"] for i in range(6)] if planets else [1.0, 0.0]
    places = problem.y0.reshape(2, -1, 3) if planets else np.zeros((2, 2, 3))
    if not planets:
        places[:, 1, :2] = problem.y0.reshape(2, 2)

    def simulation(integrator: str, **settings: Any) -> Any:
        sim = rebound.Simulation()
        # In units where G = 1, which WHFast512 asks for.
        gravity = values["G"] if planets else values["mu"]
        for m, x, u in zip(masses, places[0], places[1], strict=True):
            v = u / (m if planets else 1.0)
            sim.add(m=gravity * m, x=x[0], y=x[1], z=x[2], vx=v[0], vy=v[1], vz=v[2])
        sim.move_to_com()
        sim.integrator = integrator
        for name, value in settings.items():
            setattr(sim.integrator, name, value)
        return sim

    def energy(sim: Any) -> float:
        if planets:
            return sim.energy()
        body, star = sim.particles[1], sim.particles[0]
        d, u = (
            np.array([getattr(body, c) - getattr(star, c) for c in names])
            for names in (("x", "y"), ("vx", "vy"))
        )
        return u @ u / 2 - values["mu"] / np.sqrt(d @ d)

    def contender(name: str, integrator: str, **settings: Any) -> Contender:
        def run(setting: float, instants: int) -> Run:
            sim = simulation(integrator, **settings)
            if integrator == "ias15":
                sim.integrator.epsilon = setting
            else:
                sim.dt = problem.span / problem.periods / setting
            energies, spent, exact = [energy(sim)], 0.0, int(integrator == "ias15")
            for k in range(1, instants + 1):
                more, _ = timed(
                    lambda t=problem.span * k / instants: sim.integrate(t, exact_finish_time=exact)
                )
                spent += more
                if spent > PATIENCE / 8:
                    raise RuntimeError(f"{name} in {setting} steps a period doesn't come to an end")
                sim.synchronize()
                energies.append(energy(sim))
            return spent, np.array(energies)

        fixed = [1, 2, 3, *steps(problem)]
        return Contender(f"rebound {name}", [1e-6, 1e-9] if integrator == "ias15" else fixed, run)

    yield contender("IAS15", "ias15")
    for corrector in (0, 17):
        yield contender(f"WHFast c{corrector}", "whfast", corrector=corrector, safe_mode=0)
    if planets:
        for kind in ("2", "4", "8_6_4", "10_6_4"):
            yield contender(f"SABA {kind}", "saba", type=kind, safe_mode=0)
        if getattr(rebound, "avx512_available", False):
            for corrector in (0, 17):
                yield contender(f"WHFast512 c{corrector}", "whfast512", corrector=corrector)


def galpy_methods(problem: Problem) -> Iterator[Contender]:
    from galpy.orbit import Orbit
    from galpy.potential import HenonHeilesPotential, KeplerPotential

    if problem.scene not in ("kepler", "henon-heiles"):
        return
    kepler = problem.scene == "kepler"
    field_ = KeplerPotential(amp=problem.values["mu"]).toPlanar() if kepler else HenonHeilesPotential(amp=1.0)
    x, y, u, v = problem.y0
    R, phi = np.hypot(x, y), np.arctan2(y, x)
    start = [R, (x * u + y * v) / R, (x * v - y * u) / R, phi]
    for method in ("dop853_c", "symplec6_c"):
        adaptive = method == "dop853_c"

        def run(setting: float, instants: int, method: str = method, adaptive: bool = adaptive) -> Run:
            at = np.linspace(0, problem.span, instants + 1)
            orbit = Orbit(start)
            keywords = (
                {"rtol": setting, "atol": setting}
                if adaptive
                else {"dt": at[1] / max(1, round(setting * problem.periods / instants))}
            )
            spent, _ = timed(
                lambda: orbit.integrate(at, field_, method=method, progressbar=False, **keywords)
            )
            return spent, np.array([orbit.x(at), orbit.y(at), orbit.vx(at), orbit.vy(at)])

        yield Contender(f"galpy {method}", TOLERANCES if adaptive else steps(problem), run)


def pyhamsys_methods(problem: Problem) -> Iterator[Contender]:
    from pyhamsys import Parameters, solve_ivp_symp

    if problem.scene not in ("kepler", "henon-heiles"):
        return
    n = len(problem.q)
    force = sp.lambdify([problem.q], problem.rates[n:], "math", cse=True)

    def drift(h: float, y: Array) -> Array:
        return np.concatenate([y[:n] + h * y[n:], y[n:]])

    def kick(h: float, y: Array) -> Array:
        return np.concatenate([y[:n], y[n:] + h * np.array(force(y[:n].tolist()))])

    def run(setting: int, instants: int) -> Run:
        at = np.linspace(0, problem.span, instants + 1)
        with_step = Parameters(step=problem.span / problem.periods / setting, solver="BM6", display=False)
        spent, found = timed(
            lambda: solve_ivp_symp(
                lambda h, _, y: kick(h, drift(h, y)),
                lambda h, _, y: drift(h, kick(h, y)),
                (0, problem.span),
                problem.y0,
                t_eval=at,
                params=with_step,
            )
        )
        return spent, found.y

    yield Contender("pyhamsys BM6", steps(problem, 1.5), run)


def diffrax_methods(problem: Problem) -> Iterator[Contender]:
    import jax

    jax.config.update("jax_enable_x64", bool(1))
    import diffrax
    import jax.numpy as jnp

    rates = sp.lambdify([[*problem.q, *problem.p]], problem.rates, "jax", cse=True)
    term = diffrax.ODETerm(lambda _t, y, _args: jnp.stack(rates(y)))

    @jax.jit
    def solve(tolerance: Any, at: Any) -> Any:
        control = diffrax.PIDController(rtol=tolerance, atol=tolerance)
        return diffrax.diffeqsolve(
            term, diffrax.Dopri8(), 0.0, problem.span, None, jnp.array(problem.y0),
            saveat=diffrax.SaveAt(ts=at), stepsize_controller=control, max_steps=2**24, throw=False,
        ).ys  # fmt: skip

    def run(setting: float, instants: int) -> Run:
        at = jnp.linspace(0, problem.span, instants + 1)
        solve(1e-3, at).block_until_ready()
        spent, found = timed(lambda: solve(setting, at).block_until_ready())
        return spent, np.asarray(found).T

    yield Contender("diffrax Dopri8", [1e-6, 1e-8, 1e-10, 1e-12, 1e-14], run)


def numbalsoda_methods(problem: Problem) -> Iterator[Contender]:
    import numba
    import numbalsoda

    u = sp.IndexedBase("u")
    size = len(problem.y0)
    places = {s: u[i] for i, s in enumerate((*problem.q, *problem.p))}
    rates = numba.njit(sp.lambdify(u, tuple(r.xreplace(places) for r in problem.rates), "math", cse=True))

    @numba.cfunc(numbalsoda.lsoda_sig)
    def right_side(_t: float, state: Array, rate: Array, _data: Array) -> None:
        found = rates(state)
        for i in range(size):
            rate[i] = found[i]

    solvers: dict[str, Any] = {"lsoda": numbalsoda.lsoda, "dop853": numbalsoda.dop853}
    for name, solver in solvers.items():

        def run(setting: float, instants: int, solver: Any = solver) -> Run:
            at = np.linspace(0, problem.span, instants + 1)
            keywords = {"rtol": setting, "atol": setting, "mxstep": 10**6}
            spent, (found, done) = timed(lambda: solver(right_side.address, problem.y0, at, **keywords))
            return spent, found.T if done else np.full((size, instants + 1), np.nan)

        yield Contender(f"numbalsoda {name}", TOLERANCES, run)


PEERS: dict[str, Callable[[Problem], Iterator[Contender]]] = {
    "heyoka": heyoka_methods, "rebound": rebound_methods, "galpy": galpy_methods, "diffrax": diffrax_methods,
    "pyhamsys": pyhamsys_methods, "scipy": scipy_methods, "numbalsoda": numbalsoda_methods,
}  # fmt: skip
PROBLEMS = {
    "kepler": ("Kepler, e = 0.6", "kepler", 0, 10),
    "henon-heiles": ("Hénon–Heiles", "henon-heiles", 0, 4),
    "planets": ("outer solar system", "outer-solar-system", 0, 4),
    "double-pendulum": ("double pendulum", "double-pendulum", 0, 4),
    "fput": ("FPUT chain, 31 masses", "fput", 0, 40),
}


# the comparison ------------------------------------------------------------------------------------


def search(problem: Problem, contender: Contender) -> None:
    """Find the first setting that keeps each accuracy."""
    wanted, spent = list(ACCURACIES), 0.0
    for setting in contender.settings:
        try:
            seconds, found = contender.run(setting, INSTANTS)
            error = problem.error(found) if found.shape[-1] == INSTANTS + 1 else np.inf
            if contender.library in DEAR[:2]:
                error *= PERIODS / DEAR_PERIODS
        except (ArithmeticError, RuntimeError):
            continue
        while wanted and error <= wanted[0]:
            contender.chosen[wanted.pop(0)] = setting
        spent += seconds
        if not wanted or spent > PATIENCE:
            return


def compare(key: tuple[str, str, int, int]) -> Iterator[str]:
    """Compare everything on one problem."""
    problem = Problem(*key)
    short = Problem(*key, DEAR_PERIODS)
    contenders = [*canon_methods(problem)]
    for library, methods in PEERS.items():
        if importlib.util.find_spec(library):
            contenders += methods(short if library in DEAR else problem)
    for contender in contenders:
        search(problem, contender)
    for accuracy in ACCURACIES:
        able = [c for c in contenders if accuracy in c.chosen]
        for turn in range(TURNS + 1):
            for c in able:
                costs = c.costs.setdefault(accuracy, [])
                if not turn or costs[0] < 1:
                    whole, (seconds, _) = timed(lambda c=c, accuracy=accuracy: c.run(c.chosen[accuracy], 1))
                    costs.append(seconds)
                    c.calls.setdefault(accuracy, []).append(whole)
        ranked = sorted(able, key=lambda c: c.cost(accuracy))
        yield f"{problem.name}, max |ΔE/E| ≤ {accuracy:.0e}"
        best: dict[str, float] = {}
        shown = set[str]()
        for c in ranked:
            cost, library = c.cost(accuracy), c.library
            best.setdefault(library, cost)
            shown.add(library)
            if c in ranked[:3] or best[library] == cost:
                whole = f", {c.call(accuracy):.3f} the whole call" if library == "canon" else ""
                yield f"    {c.name:38} {c.chosen[accuracy]:10.4g} {cost:12.3f} µs a period{whole}"
        others = [cost for library, cost in best.items() if library != "canon"]
        if others and "canon" in best:
            call = min(c.call(accuracy) for c in able if c.library == "canon")
            ratios = f"{best['canon'] / min(others):.2f} × the cheapest other, {call / min(others):.2f} × with the call"
            yield f"    canon {ratios}"
        missing = sorted({c.library for c in contenders} - shown)
        if missing:
            yield f"    not reached within {PATIENCE:g} s of settings tried: {', '.join(missing)}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--run", action="store_true")
    parser.add_argument("--store", action="store_true", help="run, and keep what is printed")
    parser.add_argument("problems", nargs="*", help=f"of {', '.join(PROBLEMS)}")
    given = parser.parse_args()
    if not (given.run or given.store):
        print(STORED.read_text(encoding="utf-8"), end="")
        return
    warnings.simplefilter("ignore")
    installed = [f"{name} {version(name)}" for name in LIBRARIES if importlib.util.find_spec(name)]
    absent = [name for name in LIBRARIES if not importlib.util.find_spec(name)]
    lines = [
        f"{date.today()}, {platform.machine()}, Python {platform.python_version()}, {', '.join(installed)}"
    ]
    if absent:
        lines.append(f"not installed, left out: {', '.join(absent)}")
    print(*lines, sep="\n", flush=True)
    for name in given.problems or PROBLEMS:
        for line in compare(PROBLEMS[name]):
            lines.append(line)
            print(line, flush=True)
    if given.store:
        STORED.parent.mkdir(exist_ok=True)
        STORED.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
