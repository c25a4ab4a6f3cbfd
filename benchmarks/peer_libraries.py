"""The methods of other libraries, as contenders of ``benchmarks/peers.py``: each library in its fastest settings."""

from __future__ import annotations

import contextlib
import tempfile
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from peer_problems import PATIENCE, TOLERANCES, Array, Contender, Problem, Run, steps, timed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


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

        yield Contender(f"scipy {method}", [1e-7, 1e-10, 1e-13], run, grows=True)


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

    def simulation(integrator: str, settings: dict[str, Any]) -> Any:
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
        prepared = simulation(integrator, settings)

        def run(setting: float, instants: int) -> Run:
            sim = prepared.copy()
            if integrator == "ias15":
                sim.integrator.epsilon = setting
            else:
                sim.dt = problem.span / problem.periods / setting
            if integrator == "whfast512":
                sim.integrator.concatenate_steps = max(1, round(setting * problem.periods / instants))
            energies, spent, exact = [energy(sim)], 0.0, int(integrator == "ias15")
            for k in range(1, instants + 1):
                more, _ = timed(
                    (lambda: sim.steps(1))
                    if integrator == "whfast512"
                    else lambda t=problem.span * k / instants: sim.integrate(t, exact_finish_time=exact)
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
        for more in (
            {"keep_unsynchronized": 1},
            {"kernel": "lazy"},
            {"kernel": "modifiedkick", "corrector2": 1},
        ):
            name = (
                f"WHFast c17 {' '.join(str(x) if isinstance(x, str) else name for name, x in more.items())}"
            )
            yield contender(name, "whfast", corrector=17, safe_mode=0, **more)
        for kind in ("2", "4", "8_6_4", "10_6_4", "CL_2"):
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

    yield Contender("diffrax Dopri8", [1e-6, 1e-8, 1e-10, 1e-12, 1e-14], run, grows=True)


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

        # LSODA refuses tolerances below some units of rounding.
        yield Contender(f"numbalsoda {name}", TOLERANCES[: -3 if name == "lsoda" else None], run)


def gala_methods(problem: Problem) -> Iterator[Contender]:
    import gala.potential as gp
    from gala.integrate import DOPRI853Integrator, LeapfrogIntegrator, Ruth4Integrator

    if problem.scene not in ("kepler", "henon-heiles"):
        return
    kepler = problem.scene == "kepler"
    field_ = gp.KeplerPotential(m=problem.values["mu"]) if kepler else gp.HenonHeilesPotential()
    system = gp.Hamiltonian(field_)
    x, y, u, v = problem.y0
    start = np.array([x, y, 0.0, u, v, 0.0] if kepler else [x, y, u, v])
    ways: dict[str, Any] = {
        "leapfrog": LeapfrogIntegrator, "Ruth4": Ruth4Integrator, "DOPRI853": DOPRI853Integrator,
    }  # fmt: skip
    for name, way in ways.items():
        adaptive = name == "DOPRI853"

        def run(setting: float, instants: int, way: Any = way, adaptive: bool = adaptive) -> Run:
            # The first step that DOPRI853 tries is as long as the grid's.
            parts = 1 if adaptive else max(1, round(setting * problem.periods / instants))
            grid = max(instants, problem.periods) if adaptive else instants * parts
            how = {"atol": setting, "rtol": setting, "nmax": 2**30} if adaptive else {}
            spent, orbit = timed(
                lambda: system.integrate_orbit(
                    start, Integrator=way, Integrator_kwargs=how, dt=problem.span / grid, n_steps=grid,
                    save_all=instants > 1,
                )
            )  # fmt: skip
            n, far = len(problem.q), orbit.pos.xyz.value.reshape(system.ndim // 2, -1)
            fast = orbit.vel.d_xyz.value.reshape(system.ndim // 2, -1)
            states = np.concatenate([far[:n], fast[:n]])[:, ::parts]
            return spent, states if instants > 1 else np.stack([problem.y0, states[:, -1]], axis=1)

        yield Contender(f"gala {name}", TOLERANCES if adaptive else steps(problem), run)


def jitcode_methods(problem: Problem) -> Iterator[Contender]:
    from jitcode import jitcode
    from jitcode import y as of
    from jitcode.integrator_tools import UnsuccessfulIntegration
    from symengine import sympify

    read = {sympify(s): of(i) for i, s in enumerate((*problem.q, *problem.p))}
    own = jitcode([sympify(r).subs(read) for r in problem.rates], verbose=False)
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.chdir(folder),
    ):  # it reads a pyproject.toml beside it
        own.generate_f_C(simplify=False, do_cse=True)
        own.compile_C()

    def run(setting: float, instants: int) -> Run:
        own.set_integrator("dop853", rtol=setting, atol=setting, nsteps=10**9)
        own.set_initial_value(problem.y0, 0.0)
        at = np.linspace(0, problem.span, instants + 1)[1:]
        try:
            spent, found = timed(lambda: [own.integrate(t) for t in at])
        except UnsuccessfulIntegration as gone:
            raise RuntimeError(str(gone)) from gone
        return spent, np.array([problem.y0, *found]).T

    yield Contender("jitcode dop853", TOLERANCES, run)


def desolver_methods(problem: Problem) -> Iterator[Contender]:
    import desolver
    from desolver.exception_types import FailedIntegration

    rates = sp.lambdify([[*problem.q, *problem.p]], problem.rates, "math", cse=True)
    splits = not any(r.has(*problem.q) for r in problem.rates[: len(problem.q)])
    for name in ("ABAS5O6H", "BABS9O7H", "RK8713M") if splits else ("RK8713M",):
        adaptive = name.startswith("RK")

        def run(setting: float, instants: int, name: str = name, adaptive: bool = adaptive) -> Run:
            step = problem.span / problem.periods / (20 if adaptive else setting)
            system = desolver.OdeSystem(
                lambda _t, y: np.array(rates(y.tolist())), problem.y0, t=(0.0, problem.span), dt=step,
                rtol=setting, atol=setting,
            )  # fmt: skip
            system.method = name
            try:
                spent, _ = timed(system.integrate)
            except FailedIntegration as gone:
                raise RuntimeError(str(gone)) from gone
            kept = np.linspace(0, len(system.y) - 1, instants + 1).astype(int)
            return spent, np.asarray(system.y)[kept].T

        yield Contender(
            f"desolver {name}", [1e-6, 1e-9, 1e-12] if adaptive else steps(problem, 1.5), run, grows=adaptive
        )


LIBRARIES: dict[str, Callable[[Problem], Iterator[Contender]]] = {
    "heyoka": heyoka_methods, "rebound": rebound_methods, "galpy": galpy_methods, "diffrax": diffrax_methods,
    "pyhamsys": pyhamsys_methods, "scipy": scipy_methods, "numbalsoda": numbalsoda_methods,
    "gala": gala_methods, "jitcode": jitcode_methods, "desolver": desolver_methods,
}  # fmt: skip
