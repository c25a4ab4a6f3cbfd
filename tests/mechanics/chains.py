"""Systems of any size: chains of links, chains on carts and in space, bodies that attract one another."""

from itertools import combinations, pairwise

import sympy as sp

from canon.expression.symbols.symbol import coordinates, parameters
from canon.mechanics.lagrange.body import Particle, PlanarBody, RigidBody, euler_rotation

g = parameters("g", positive=True)


def planar_pendulum(n, on_cart=False):
    """Point masses on n massless links, perhaps hung from a cart; gravity (0, −g)."""
    q = coordinates(" ".join(f"theta{i}" for i in range(n)) + ",")
    l = parameters(" ".join(f"l{i}" for i in range(n)) + ",", positive=True)
    m = parameters(" ".join(f"m{i}" for i in range(n)) + ",", positive=True)
    x, y, bodies = sp.S.Zero, sp.S.Zero, []
    if on_cart:
        x = coordinates("x")
        bodies.append(Particle(parameters("M", positive=True), (x, sp.S.Zero)))
    for angle, length, mass in zip(q, l, m, strict=True):
        place = bodies[-1].r if bodies else (x, y)
        bodies.append(Particle(mass, (place[0] + length * sp.sin(angle), place[1] - length * sp.cos(angle))))
    return bodies, ((x, *q) if on_cart else q), (0, -g)


def rods(n):
    """Uniform rods of one length hung from one another."""
    q = coordinates(" ".join(f"theta{i}" for i in range(n)) + ",")
    m, l = parameters("m l", positive=True)
    x, y, bodies = sp.S.Zero, sp.S.Zero, []
    for angle in q:
        dx, dy = l * sp.sin(angle) / 2, -l * sp.cos(angle) / 2
        bodies.append(PlanarBody(m, (x + dx, y + dy), m * l**2 / 12, angle))
        x, y = x + 2 * dx, y + 2 * dy
    return bodies, q, (0, -g)


def spherical_chain(n):
    """Point masses on n links in space."""
    theta = coordinates(" ".join(f"theta{i}" for i in range(n)) + ",")
    phi = coordinates(" ".join(f"phi{i}" for i in range(n)) + ",")
    m, l = parameters("m l", positive=True)
    place, bodies = (sp.S.Zero,) * 3, []
    for a, b in zip(theta, phi, strict=True):
        link = (l * sp.sin(a) * sp.cos(b), l * sp.sin(a) * sp.sin(b), -l * sp.cos(a))
        place = tuple(x + dx for x, dx in zip(place, link, strict=True))
        bodies.append(Particle(m, place))
    return bodies, tuple(s for pair in zip(theta, phi, strict=True) for s in pair), (0, 0, -g)


def heavy_top():
    """A top with its tip fixed, centre of mass at l."""
    q = coordinates("theta phi psi")
    m, l, I1, I3 = parameters("m l I1 I3", positive=True)
    rotation = euler_rotation(q[1], q[0], q[2])
    return [RigidBody(m, [l * rotation[i, 2] for i in range(3)], (I1, I1, I3), rotation)], q, (0, 0, -g)


def spatial_arm():
    """Three links: one turns about the vertical, two bend; full inertia tensors on the last."""
    q = coordinates("q0 q1 q2")
    m, l = parameters("m l", positive=True)
    A, B, C, D = parameters("A B C D", positive=True)
    bodies, place, bend = [], sp.Matrix([0, 0, 0]), sp.S.Zero
    for i, angle in enumerate(q):
        bend = bend + angle if i else bend
        rotation = euler_rotation(q[0], bend, sp.S.Zero)
        axis = rotation[:, 2] * l
        inertia = sp.Matrix([[A, D, 0], [D, B, 0], [0, 0, C]]) if i == 2 else sp.diag(A, A, C)
        bodies.append(RigidBody(m, tuple(place + axis / 2), inertia, rotation))
        place = place + axis
    return bodies, q, (0, 0, -g)


def n_body(n):
    """Gravitating points in space; the potential energy comes beside."""
    names = [f"{axis}{i}" for i in range(n) for axis in "xyz"]
    q = coordinates(" ".join(names) + ",")
    m = parameters(" ".join(f"m{i}" for i in range(n)) + ",", positive=True)
    G = parameters("G", positive=True)
    places = [q[3 * i : 3 * i + 3] for i in range(n)]
    V = sp.Add(
        *(
            -G * m[i] * m[j] / sp.sqrt(sum((a - b) ** 2 for a, b in zip(places[i], places[j], strict=True)))
            for i, j in combinations(range(n), 2)
        )
    )
    return [Particle(mass, place) for mass, place in zip(m, places, strict=True)], q, V


def spring_chain(n):
    """Equal masses on a line between springs."""
    q = coordinates(" ".join(f"x{i}" for i in range(n)) + ",")
    m, k = parameters("m k", positive=True)
    V = sp.Add(*(k * (b - a) ** 2 / 2 for a, b in pairwise(q)))
    return [Particle(m, (s,)) for s in q], q, V
