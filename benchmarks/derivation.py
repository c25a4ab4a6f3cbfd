"""Derivation at scale against SymPy's LagrangesMethod and KanesMethod and heyoka's lagrangian, in one run.

Prints processor milliseconds, the best of a few repeats for canon and one run for SymPy (which caches), and the
ratios. LagrangesMethod is given T − V, KanesMethod the points with their velocities, and building these is not counted;
canon starts from positions and masses. LagrangesMethod takes two minutes and more for 20 links, so both are asked up to
``--peer`` links:

    python benchmarks/derivation.py            # 10 links at most for SymPy
    python benchmarks/derivation.py --peer 20
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np
import sympy as sp
from sympy.physics import mechanics
from sympy.physics.mechanics import KanesMethod, LagrangesMethod, Point, ReferenceFrame, dynamicsymbols

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "mechanics"))

from chains import heavy_top, n_body, planar_pendulum, spatial_arm, spherical_chain

from canon.expression.graph.python_source import python_function
from canon.expression.symbols.symbol import coordinates, parameters
from canon.mechanics.at_scale.constrained import constrained, constrained_motion
from canon.mechanics.at_scale.first_order import canonical_derivation
from canon.mechanics.at_scale.ldl import solved_on_graph
from canon.mechanics.at_scale.numeric_functions import (
    acceleration_function,
    energy_function,
    hamilton_function,
)
from canon.mechanics.at_scale.second_order import derivation, derivation_of_lagrangian
from canon.mechanics.lagrange.body import Particle, PlanarBody
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.reduction.routh import routhian

SIZES = (1, 2, 5, 10, 20, 40)


def best(function, repeats=5):
    """Return the value and the least processor time in ms."""
    least = np.inf
    for _ in range(repeats):
        start = time.process_time()
        value = function()
        least = min(least, time.process_time() - start)
    return value, 1e3 * least


def ours(n):
    """Return the times of canon for n links, and its operations as SymPy counts them."""
    bodies, q, field = planar_pendulum(n)
    equations, derive = best(lambda: derivation(bodies, q, field=field))
    values = dict.fromkeys(equations.parameters, 1.0)

    def callable_():
        acceleration_function(derivation(bodies, q, field=field), values)([0.1] * n, [0.2] * n, 0.0)

    def hamilton():
        canonical = canonical_derivation(bodies, q, field=field)
        energy_function(canonical, values)([0.1] * n, [0.2] * n, 0.0)
        hamilton_function(canonical, values)([0.1] * n, [0.2] * n, 0.0)

    _, call = best(callable_)
    (replacements, M, f), objects = best(lambda: derivation(bodies, q, field=field).to_sympy())
    _, nodes = best(lambda: canonical_derivation(bodies, q, field=field))
    _, canonical = best(hamilton)
    lower = [M[i, j] for i in range(n) for j in range(i + 1)]
    operations = sum(sp.count_ops(e) for e in (*(e for _, e in replacements), *lower, *f))
    return {
        "derive": derive,
        "call": call,
        "objects": objects,
        "H": nodes,
        "H called": canonical,
        "ops": operations,
    }


def masses_and_lengths(n):
    masses, lengths = sp.symbols(f"m:{n}", positive=True), sp.symbols(f"l:{n}", positive=True)
    return masses, lengths, sp.Symbol("g", positive=True)


def by_lagrange(n):
    """Return the same links for LagrangesMethod: what derives M and f, their places and speeds."""
    q = dynamicsymbols(f"theta:{n}")
    (t,) = q[0].args
    m, l, g = masses_and_lengths(n)
    x = y = T = V = sp.S.Zero
    for angle, mass, length in zip(q, m, l, strict=True):
        x, y = x + length * sp.sin(angle), y - length * sp.cos(angle)
        T += mass * (x.diff(t) ** 2 + y.diff(t) ** 2) / 2
        V += mass * g * y

    def derive():
        method = LagrangesMethod(T - V, q)
        method.form_lagranges_equations()
        return method.mass_matrix, method.forcing

    return derive, q, [s.diff(t) for s in q]


def by_kane(n):
    """Return the same links for KanesMethod: a frame turns with each link, and the angular speeds are the speeds."""
    q, u = dynamicsymbols(f"theta:{n}"), dynamicsymbols(f"u:{n}")
    (t,) = q[0].args
    m, l, g = masses_and_lengths(n)
    ground, joint = ReferenceFrame("N"), Point("O")
    joint.set_vel(ground, 0)
    bodies, loads = [], []
    for i in range(n):
        link = ground.orientnew(f"A{i}", "Axis", [q[i], ground.z])
        link.set_ang_vel(ground, u[i] * ground.z)
        end = joint.locatenew(f"P{i}", -l[i] * link.y)
        end.v2pt_theory(joint, ground, link)
        bodies.append(mechanics.Particle(f"body{i}", end, m[i]))
        loads.append((end, -m[i] * g * ground.y))
        joint = end

    def derive():
        speeds = [speed - angle.diff(t) for angle, speed in zip(q, u, strict=True)]
        method = KanesMethod(ground, q_ind=q, u_ind=u, kd_eqs=speeds)
        method.kanes_equations(bodies, loads)
        return method.mass_matrix, method.forcing

    return derive, q, u


def accelerations_of(M, f, places, speeds, n):
    """Return what SymPy's function of places, speeds and parameters answers where each of them is 0.1."""
    m, l, g = masses_and_lengths(n)
    v = {s: sp.Symbol(f"v{i}") for i, s in enumerate(speeds)}
    q = {s: sp.Symbol(f"q{i}") for i, s in enumerate(places)}
    M, f = (e.xreplace(v).xreplace(q) for e in (M, f))
    inputs = [*q.values(), *v.values(), *m, *l, g]
    function = sp.lambdify(inputs, [M, f], cse=True)
    return np.linalg.solve(*function(*[0.1] * len(inputs))).ravel()


def theirs(n, by):
    """Return the times of a method of SymPy for the same links."""
    derive_them, places, speeds = by(n)
    start = time.process_time()
    M, f = derive_them()
    derive = time.process_time() - start
    accelerations_of(M, f, places, speeds, n)
    call = time.process_time() - start
    replacements, shared = sp.cse([M, f])
    operations = sum(sp.count_ops(e) for _, e in replacements) + sum(sp.count_ops(e) for e in shared)
    return {"derive": 1e3 * derive, "call": 1e3 * call, "objects": 1e3 * derive, "ops": operations}


def links(peer):
    print("planar pendulum of n links, processor ms (SymPy / canon):")
    print("   n   derive  callable   as SymPy   H nodes  H callable  operations")
    for n in SIZES:
        mine = ours(n)
        row = f"{n:4d} {mine['derive']:8.1f} {mine['call']:9.1f} {mine['objects']:10.1f} {mine['H']:9.1f}"
        row += f" {mine['H called']:11.1f} {mine['ops']:11d}"
        print(row, flush=True)
        for name, by in (("LagrangesMethod", by_lagrange), ("KanesMethod", by_kane)):
            if n <= peer:
                other = theirs(n, by)
                shown = ", ".join(
                    f"{key} {other[key] / mine[key]:.1f}" for key in ("derive", "call", "objects", "ops")
                )
                print(f"       {name + ' / canon:':24} {shown}", flush=True)


def piston():
    """Seven coordinates, six constraints: crank, rod and piston with their centres of mass."""
    x1, y1, x2, y2, theta, phi, s = q = coordinates("x1 y1 x2 y2 theta phi s")
    m1, m2, m3, J1, J2, r, a, b, c, e = parameters("m1 m2 m3 J1 J2 r a b c e", positive=True)
    bodies = [PlanarBody(m1, (x1, y1), J1, theta), PlanarBody(m2, (x2, y2), J2, phi), Particle(m3, (s,))]
    rules = [
        s - r * sp.cos(theta) - (a + b) * sp.cos(phi), e - r * sp.sin(theta) + (a + b) * sp.sin(phi),
        x1 - c * sp.cos(theta), y1 - c * sp.sin(theta),
        x2 - r * sp.cos(theta) - a * sp.cos(phi), y2 - b * sp.sin(phi) - e,
    ]  # fmt: skip

    def build():
        system = constrained(derivation(bodies, q), rules)
        values = dict(zip(system.parameters, np.linspace(0.5, 1.5, len(system.parameters)), strict=True))
        constrained_motion(system, values).accelerations([0.1] * 7, [0.2] * 7, 0.0)

    return build


def others():
    print("other systems, processor ms until the first acceleration:")
    systems = {
        "10 links on a cart": planar_pendulum(10, on_cart=True),
        "spatial arm of 3 links": spatial_arm(),
        "spherical chain of 5": spherical_chain(5),
        "heavy top": heavy_top(),
        "8 attracting bodies": n_body(8),
    }
    for name, (bodies, q, field) in systems.items():

        def build(bodies=bodies, q=q, field=field):
            around = {"V": field} if isinstance(field, sp.Expr) else {"field": field}
            equations = derivation(bodies, q, **around)
            values = dict.fromkeys(equations.parameters, 1.0)
            places = np.linspace(0.3, 1.7, len(q))
            acceleration_function(equations, values)(places, places, 0.0)

        print(f"  {name:28s} {best(build)[1]:8.1f}")
    print(f"  {'piston engine, 7 and 6':28s} {best(piston())[1]:8.1f}")


def reduced_systems():
    theta, phi, psi, r = coordinates("theta phi psi r")
    m, l, g, k, I1, I3 = parameters("m l g k I1 I3", positive=True)
    s, c = sp.sin(theta), sp.cos(theta)
    turning = I1 * (theta.dot**2 + phi.dot**2 * s**2) / 2 + I3 * (psi.dot + phi.dot * c) ** 2 / 2
    return {
        "spherical pendulum": Lagrangian(
            m * l**2 * (theta.dot**2 + phi.dot**2 * s**2) / 2 + m * g * l * c, [theta, phi]
        ),
        "heavy top": Lagrangian(turning - m * g * l * c, [theta, phi, psi]),
        "central force": Lagrangian(m * (r.dot**2 + r**2 * phi.dot**2) / 2 + k / r, [r, phi]),
    }


def accelerations_in_microseconds(lagrangian):
    """Return the operations of the explicit accelerations and the time of one call."""
    equations = derivation_of_lagrangian(lagrangian)
    explicit = solved_on_graph(equations.graph, equations.M, equations.f)
    inputs = (*equations.q, *equations.velocities, *equations.parameters)
    function = python_function(equations.graph, explicit, inputs)
    point = np.linspace(0.4, 1.3, len(inputs)).tolist()
    _, ms = best(lambda: [function(point) for _ in range(2000)], repeats=9)
    return sum(
        1 for each in equations.graph.reachable(explicit) if equations.graph.nodes[each].operands
    ), ms / 2


def reduction():
    print("Routh's reduction, operations and microseconds of one right-hand side (scalar Python):")
    for name, lagrangian in reduced_systems().items():
        whole = accelerations_in_microseconds(lagrangian)
        reduced = accelerations_in_microseconds(routhian(lagrangian).lagrangian)
        print(
            f"  {name:20s} {whole[0]:4d} operations {whole[1]:6.2f} us  →  {reduced[0]:4d} operations "
            f"{reduced[1]:6.2f} us   {whole[1] / reduced[1]:.2f} times faster"
        )


def compiled(n):
    """Return ns a call of accelerations compiled by heyoka: canon's explicit ones against hy.lagrangian's."""
    import heyoka as hy

    from canon.kernel.heyoka_bridge import heyoka_expressions

    bodies, q, field = planar_pendulum(n)
    equations = derivation(bodies, q, field=field)
    variables = {s: hy.expression(s.name) for s in (*q, *equations.velocities)}
    variables |= {s: hy.expression(1 + 0.01 * i) for i, s in enumerate(equations.parameters)}
    explicit = solved_on_graph(equations.graph, equations.M, equations.f)
    mine = heyoka_expressions(equations.graph, explicit, variables)
    of = {s.name: variables[s] for s in equations.parameters}
    places, speeds = ([variables[s] for s in group] for group in (q, equations.velocities))
    vx = vy = y = L = hy.expression(0.0)
    for i, (angle, speed) in enumerate(zip(places, speeds, strict=True)):
        l, m = of[f"l{i}"], of[f"m{i}"]
        vx, vy = vx + l * hy.cos(angle) * speed, vy + l * hy.sin(angle) * speed
        y = y - l * hy.cos(angle)
        L = L + m * (vx * vx + vy * vy) * 0.5 - m * of["g"] * y
    other = [rate for _, rate in hy.lagrangian(L, places, speeds)[n:]]
    functions = [hy.cfunc(e, [*places, *speeds], compact_mode=n > 6) for e in (mine, other)]
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (2 * n, 2000))
    gap = np.abs(functions[0](points) - functions[1](points)).max() / np.abs(functions[1](points)).max()
    times = [best(lambda f=f: f(points), repeats=15)[1] * 1e6 / 2000 for f in functions]
    return *times, gap


def against_heyoka():
    print("accelerations compiled by heyoka, ns a point: canon's / those of heyoka's lagrangian")
    for n in (2, 5, 10):
        mine, other, gap = compiled(n)
        print(
            f"  {n:3d} links {mine:8.1f} / {other:8.1f} = {mine / other:.2f}   (they agree to {gap:.1e})",
            flush=True,
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--peer", type=int, default=10, help="the longest chain that SymPy is given")
    options = parser.parse_args()
    links(options.peer)
    others()
    reduction()
    against_heyoka()
