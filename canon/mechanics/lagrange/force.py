"""Forces: their work in virtual displacements, springs, dampers, and potentials that depend on velocities.

The virtual work of forces F at r and of torques M gives generalized forces, δW = Σ F·δr + M δφ = Σ Q δq. A damper's
Rayleigh function F(q, q̇) gives Q = −∂F/∂q̇. A charge e in potentials A, φ adds e (A·ṙ − φ) to L.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.input_in_words import described
from canon.expression.symbols.symbol import time, time_derivative, velocity
from canon.expression.symbols.user_input import all_of, counted, given_expression
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols, plain, plain_all
from canon.mechanics.algebra.substitution import refuse_unordered
from canon.mechanics.lagrange.body import RigidBody, kinetic_energy
from canon.mechanics.lagrange.lagrangian import Lagrangian, forces_in_order
from canon.mechanics.lagrange.quasi_velocity import Kinematics
from canon.proof.trees.affine_form import is_affine

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.mechanics.lagrange.body import Body
    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = [
    "charge_term", "damper", "do_no_work", "electric_field", "generalized_forces", "generalized_moments",
    "generalized_torques", "gravity",
    "lagrangian_of_bodies", "magnetic_field", "potential_forces", "rayleigh_forces", "spring",
]  # fmt: skip


def generalized_forces(
    forces: Sequence[Sequence[Expr]],
    positions: Sequence[Sequence[Expr]],
    q: Sequence[Symbol],
    t: Symbol = time,
) -> tuple[Expr, ...]:
    """Return Q = Σ F·∂r/∂q, from the work of forces in virtual displacements.

    Parameters
    ----------
    forces
        Force vectors, one a point.
    positions
        The positions r(q, t) at which they act, as vectors of the same length.
    q
        The generalized coordinates.
    t
        The time.

    Examples
    --------
    >>> from sympy import cos, sin, symbols
    >>> theta, l, F = symbols("theta l F")
    >>> generalized_forces([(F, 0)], [(l*sin(theta), -l*cos(theta))], [theta])
    (F*l*cos(theta),)
    """
    q = coordinate_symbols(q)
    forces, positions = (
        [plain_all(row, q, t) for row in _vectors(rows, what)]
        for rows, what in ((forces, "forces"), (positions, "positions"))
    )
    all_of(positions, len(forces), "positions", "forces")
    for k, (force, position) in enumerate(zip(forces, positions, strict=True)):
        all_of(position, len(force), f"positions[{k}]", "components of its force")
    return tuple(
        sp.Add(
            *(
                component * place.diff(s)
                for force, position in zip(forces, positions, strict=True)
                for component, place in zip(force, position, strict=True)
            )
        )
        for s in q
    )


def _vectors(rows: Sequence[Sequence[Expr]], name: str) -> list[Sequence[Expr]]:
    """Return vectors that were given in a list; a TypeError says where another thing is in a vector's place."""
    refuse_unordered(rows)
    vectors: list[Any] = list(rows) if hasattr(rows, "__iter__") else [rows]
    for each in vectors:
        refuse_unordered(each)
        if isinstance(each, str) or not hasattr(each, "__iter__"):
            raise TypeError(
                f"{name} should be a list of vectors, one a point, such as [(F, 0)], and {described(each)} stands in "
                "the place of a vector; write its components in brackets"
            )
    return vectors


def generalized_torques(
    torques: Sequence[Expr], angles: Sequence[Expr], q: Sequence[Symbol], t: Symbol = time
) -> tuple[Expr, ...]:
    """Return Q = Σ M ∂φ/∂q of torques that turn bodies through angles φ(q, t).

    A motor between two bodies works on their relative angle.

    Examples
    --------
    >>> from sympy import symbols
    >>> a, b, M = symbols("a b M")
    >>> generalized_torques([M], [b - a], [a, b])
    (-M, M)
    """
    q = coordinate_symbols(q)
    torques, angles = plain_all(torques, q, t), plain_all(angles, q, t)
    pairs = list(zip(torques, all_of(angles, len(torques), "angles", "torques"), strict=True))
    return tuple(sp.Add(*(torque * angle.diff(s) for torque, angle in pairs)) for s in q)


def generalized_moments(
    moments: Sequence[Sequence[Expr]],
    bodies: Sequence[RigidBody | Sequence[Expr]],
    q: Sequence[Symbol],
    t: Symbol = time,
) -> tuple[Expr, ...]:
    """Return Q = Σ M·∂ω/∂q̇ of moments on bodies.

    Parameters
    ----------
    moments
        The components of each moment along the axes of its body.
    bodies
        The bodies they act on, or the components of their angular velocities ω(q, q̇, t) along the same axes.
    q
        The coordinates.
    t
        The time.

    Raises
    ------
    ValueError
        Where an angular velocity is not affine in the velocities, or has not the components of its moment.

    Examples
    --------
    A moment about the axis of a top works on its spin, and by cos θ on its precession:

    >>> from canon import coordinates
    >>> from canon.mechanics.lagrange.body import RigidBody, euler_rotation
    >>> from sympy import symbols
    >>> theta, phi, psi = coordinates("theta phi psi")
    >>> top = RigidBody(1, (), (1, 1, 2), euler_rotation(phi, theta, psi))
    >>> [Q.trigsimp() for Q in generalized_moments([(0, 0, symbols("M"))], [top], [theta, phi, psi])]
    [0, M*cos(theta), M]
    """
    kinematics = Kinematics(q, t=t)
    velocities = [velocity(s) for s in kinematics.q]
    pairs: list[tuple[Expr, Expr]] = []
    for moment, body in zip(moments, bodies, strict=True):
        given = body.angular_velocity(kinematics) if isinstance(body, RigidBody) else body
        omega = [kinematics.along(w) for w in given]
        pairs += zip((kinematics.plain(given_expression(M)) for M in moment), omega, strict=True)
    slopes = [[w.diff(v) for _, w in pairs] for v in velocities]
    if not all(is_affine(w, velocities) for _, w in pairs):
        raise ValueError(
            "an angular velocity is not affine in the velocities, so its moment has no virtual work"
        )
    return tuple(sp.Add(*(M * slope for (M, _), slope in zip(pairs, row, strict=True))) for row in slopes)


def potential_forces(V: Expr, q: Sequence[Symbol], t: Symbol = time) -> tuple[Expr, ...]:
    """Return Q = d/dt ∂V/∂q̇ − ∂V/∂q, which is −∂V/∂q where V does not depend on velocities.

    Examples
    --------
    The magnetic part of a charge's potential, −e A·ṙ, gives Lorentz's force:

    >>> from canon import coordinates
    >>> from sympy import symbols
    >>> x, y = coordinates("x y")
    >>> potential_forces(-symbols("B")*x*y.dot, [x, y])
    (B*y_dot, -B*x_dot)
    """
    q = coordinate_symbols(q)
    energy = plain(V, q, t)
    return tuple(time_derivative(energy.diff(velocity(s)), q, t) - energy.diff(s) for s in q)


def do_no_work(
    forces: Sequence[Sequence[Expr]],
    positions: Sequence[Sequence[Expr]],
    q: Sequence[Symbol],
    domain: Domain | None = None,
    t: Symbol = time,
) -> Verdict:
    """Tell whether reactions are ideal: Σ F·δr = 0 in every virtual displacement, time held fixed.

    Examples
    --------
    >>> from sympy import cos, sin, symbols
    >>> theta, l, S = symbols("theta l S", real=True)
    >>> place = (l*sin(theta), -l*cos(theta))
    >>> do_no_work([(-S*sin(theta), S*cos(theta))], [place], [theta]).status.name
    'HOLDS'
    """
    q = coordinate_symbols(q)
    Q = generalized_forces(forces, positions, q, t)
    claims = [(f"the work along {s}", work) for s, work in zip(q, Q, strict=True)]
    return all_vanish(claims, "the reactions do no virtual work", domain)


def gravity(bodies: Sequence[Body], g: Sequence[Expr]) -> Expr:
    """Return the potential energy −Σ m g·r in a uniform field of acceleration vector g."""
    return sp.Add(*(-body.m * a * x for body in bodies for a, x in zip(g, body.r, strict=bool(body.r))))


def spring(k: Expr, first: Sequence[Expr], second: Sequence[Expr], rest: Expr = sp.S.Zero) -> Expr:
    """Return the energy ½ k (d − rest)² of a spring between two points at the distance d.

    Examples
    --------
    >>> from sympy import symbols
    >>> k, x, y = symbols("k x y")
    >>> spring(k, (x, y), (0, 0))
    k*(x**2 + y**2)/2
    """
    square = sp.Add(*((a - b) ** 2 for a, b in zip(first, second, strict=True)))
    return k * square / 2 if rest == 0 else k * (sp.sqrt(square) - rest) ** 2 / 2


def damper(
    c: Expr, first: Sequence[Expr], second: Sequence[Expr], q: Sequence[Symbol], t: Symbol = time
) -> Expr:
    """Return Rayleigh's function ½ c ḋ² of a damper between two points at the distance d."""
    q = coordinate_symbols(q)
    gaps = [a - b for a, b in zip(plain_all(first, q, t), plain_all(second, q, t), strict=True)]
    square = sp.Add(*(gap**2 for gap in gaps))
    along = sp.Add(*(gap * time_derivative(gap, q, t) for gap in gaps))
    return c * along**2 / (2 * square)


def rayleigh_forces(F: Expr, q: Sequence[Symbol], t: Symbol = time) -> tuple[Expr, ...]:
    """Return Q = −∂F/∂q̇ of Rayleigh's dissipation function F(q, q̇, t)."""
    q = coordinate_symbols(q)
    power = plain(F, q, t)
    return tuple(-power.diff(velocity(s)) for s in q)


def charge_term(
    e: Expr,
    r: Sequence[Expr],
    q: Sequence[Symbol],
    A: Sequence[Expr] | None = None,
    phi: Expr = sp.S.Zero,
    t: Symbol = time,
) -> Expr:
    """Return what a charge adds to L: e (A·ṙ − φ), in units where the force is e (E + ṙ × B).

    Parameters
    ----------
    e
        The charge.
    r
        Its position as a function of q and t.
    q
        The coordinates.
    A, phi
        The potentials at the position, as functions of q and t.
    t
        The time.

    Raises
    ------
    ValueError
        Where A has not as many components as the position.

    Examples
    --------
    >>> from canon import coordinates
    >>> from sympy import symbols
    >>> x, y = coordinates("x y")
    >>> e, B = symbols("e B")
    >>> charge_term(e, (x, y), [x, y], A=(0, B*x))
    B*e*x*y_dot
    """
    if A is not None and len(A) != len(r):
        raise ValueError(
            f"A has {counted(len(A), 'component')} at a position of {len(r)}; give as many, 0 where there is none"
        )
    q = coordinate_symbols(q)
    along = zip(plain_all(A or (sp.S.Zero,) * len(r), q, t), plain_all(r, q, t), strict=True)
    return e * (sp.Add(*(a * time_derivative(x, q, t) for a, x in along)) - plain(phi, q, t))


def electric_field(A: Sequence[Expr], phi: Expr, x: Sequence[Symbol], t: Symbol = time) -> tuple[Expr, ...]:
    """Return E = −∇φ − ∂A/∂t in Cartesian coordinates."""
    x = coordinate_symbols(x)
    potential, components = plain(phi, x, t), plain_all(all_of(A, len(x), "A", "coordinates"), x, t)
    return tuple(-potential.diff(s) - a.diff(t) for s, a in zip(x, components, strict=True))


def magnetic_field(A: Sequence[Expr], x: Sequence[Symbol], t: Symbol = time) -> tuple[Expr, Expr, Expr]:
    """Return B = ∇ × A in Cartesian coordinates.

    Raises
    ------
    ValueError
        Where there are not three components and three coordinates.
    """
    x = coordinate_symbols(x)
    if len(x) != 3 or len(A) != 3:
        raise ValueError(
            f"{counted(len(A), 'component')} of A and {counted(len(x), 'coordinate')}: give three components and three "
            "coordinates, 0 for a component that is none"
        )
    a = plain_all(A, x, t)
    return (
        a[2].diff(x[1]) - a[1].diff(x[2]),
        a[0].diff(x[2]) - a[2].diff(x[0]),
        a[1].diff(x[0]) - a[0].diff(x[1]),
    )


def lagrangian_of_bodies(
    bodies: Sequence[Body],
    q: Sequence[Symbol],
    V: Expr = sp.S.Zero,
    forces: Sequence[Expr] | Mapping[Symbol, Expr] | None = None,
    dissipation: Expr = sp.S.Zero,
    t: Symbol = time,
) -> Lagrangian:
    """Return L = T − V of bodies, with generalized forces and Rayleigh's damping.

    Parameters
    ----------
    bodies
        What has mass.
    q
        The coordinates.
    V
        The potential energy; one that depends on velocities (−e (A·ṙ − φ) of a charge) is welcome.
    forces
        Generalized forces Q, one a coordinate; or by coordinate, ``{x: -c*x.dot}``.
    dissipation
        Rayleigh's function.
    t
        The time.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.mechanics.lagrange.body import Particle
    >>> x = coordinates("x")
    >>> m, k, c = parameters("m k c", positive=True)
    >>> lagrangian_of_bodies([Particle(m, (x,))], [x], k*x**2/2, dissipation=c*x.dot**2/2).equations
    (c*x_dot + k*x + m*x_ddot,)
    """
    q = coordinate_symbols(q)
    damping = rayleigh_forces(dissipation, q, t)
    given = plain_all(forces_in_order(forces, q) or (sp.S.Zero,) * len(q), q, t)
    Q = [a + b for a, b in zip(given, damping, strict=True)]
    L = kinetic_energy(bodies, q, t) - plain(V, q, t)
    return Lagrangian(L, q, Q if any(f != 0 for f in Q) else None, t)
