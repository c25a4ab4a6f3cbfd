"""Newton–Euler equations body by body, joint forces included, without a Lagrangian.

m r̈ = Σ F for the centre of mass; I α = Σ M in a plane, I ω̇ + ω × I ω = Σ M along the body's axes in space. With
positions and orientations as functions of q they are linear in q̈ and in the unknown reactions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import acceleration, time, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.dynamicsymbols import check_none_reads_as_the_time, coordinate_symbols, plain_all
from canon.mechanics.algebra.linear import eliminate, solve
from canon.mechanics.algebra.substitution import as_tuple, entry, exchanged
from canon.mechanics.lagrange.appell import cross
from canon.mechanics.lagrange.body import Particle, RigidBody
from canon.mechanics.lagrange.overdetermined import solve_overdetermined, symmetric_product
from canon.mechanics.lagrange.quasi_velocity import Kinematics
from canon.proof.trees.affine_form import is_affine

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.mechanics.lagrange.body import Body
    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = ["Load", "NewtonEuler", "joint", "weights"]


@dataclass(frozen=True)
class Load:
    """A force or torque on one body.

    Parameters
    ----------
    body
        The number of the body, counted from 0.
    force
        Its components along fixed axes.
    at
        The point where it acts; the centre of mass unless given.
    torque
        A torque besides: one number in a plane, three components along fixed axes in space.
    """

    body: int
    force: tuple[Expr, ...] = ()
    at: tuple[Expr, ...] | None = None
    torque: tuple[Expr, ...] = ()

    def __init__(
        self,
        body: int,
        force: Sequence[Expr] = (),
        at: Sequence[Expr] | None = None,
        torque: Sequence[Expr] | Expr = (),
    ) -> None:
        object.__setattr__(self, "body", body)
        object.__setattr__(self, "force", as_tuple(force))
        object.__setattr__(self, "at", None if at is None else as_tuple(at))
        object.__setattr__(self, "torque", as_tuple(torque))


def joint(first: int, second: int, force: Sequence[Expr], at: Sequence[Expr]) -> tuple[Load, Load]:
    """Return a force on the first body at a point, and its opposite on the second (actio = reactio)."""
    return Load(first, force, at), Load(second, [-component for component in force], at)


def weights(bodies: Sequence[Body], g: Sequence[Expr]) -> tuple[Load, ...]:
    """Return the weights m g of bodies in a field of acceleration vector g."""
    return tuple(Load(i, [body.m * a for a in g]) for i, body in enumerate(bodies))


@dataclass(frozen=True)
class NewtonEuler:
    """Newton's and Euler's equations of bodies under given forces and unknown reactions.

    Parameters
    ----------
    bodies
        Particles and rigid bodies, positions and orientations as functions of q and t.
    q
        The coordinates.
    loads
        Given forces and unknown reactions.
    reactions
        The symbols of the unknown reactions.
    t
        The time.

    Raises
    ------
    ValueError
        Where a load is on no body, or its force, its place or its torque has not the dimension of its body.

    Examples
    --------
    A pendulum and the force in its string:

    >>> from canon import coordinates, parameters
    >>> from sympy import cos, sin, symbols
    >>> theta = coordinates("theta")
    >>> m, l, g = parameters("m l g", positive=True)
    >>> S = symbols("S", real=True)
    >>> bob = Particle(m, (l*sin(theta), -l*cos(theta)))
    >>> string = Load(0, (-S*sin(theta), S*cos(theta)))
    >>> hung = NewtonEuler([bob], [theta], [*weights([bob], (0, -g)), string], [S])
    >>> [hung.unknowns, hung.solution[0].trigsimp(), hung.solution[1].trigsimp()]
    [(theta_ddot, S), -g*sin(theta)/l, m*(g*cos(theta) + l*theta_dot**2)]
    """

    bodies: tuple[Body, ...]
    q: tuple[Symbol, ...]
    loads: tuple[Load, ...]
    reactions: tuple[Symbol, ...] = ()
    t: Symbol = time

    def __init__(
        self,
        bodies: Sequence[Body],
        q: Sequence[Symbol],
        loads: Sequence[Load],
        reactions: Sequence[Symbol] = (),
        t: Symbol = time,
    ) -> None:
        object.__setattr__(self, "bodies", tuple(bodies))
        object.__setattr__(self, "q", coordinate_symbols(q))
        object.__setattr__(self, "reactions", coordinate_symbols(reactions))
        named = (*self.q, *self.reactions)
        check_none_reads_as_the_time(named, "NewtonEuler(bodies, q, loads, reactions", t)
        object.__setattr__(self, "loads", tuple(_plain_load(load, named, t) for load in loads))
        object.__setattr__(self, "t", t)
        for load in self.loads:
            if not 0 <= load.body < len(self.bodies):
                raise ValueError(
                    f"a load is on body {load.body}; there are {len(self.bodies)}, counted from 0"
                )
            _check_dimensions(load, self.bodies[load.body])

    @cached_property
    def balances(self) -> tuple[Expr, ...]:
        """Newton's equations of each body followed by Euler's, each expression = 0."""
        kinematics = Kinematics(self.q, t=self.t)
        return tuple(
            e
            for i in range(len(self.bodies))
            for e in (*self._newton(i, kinematics), *self._euler(i, kinematics))
        )

    @property
    def unknowns(self) -> tuple[Symbol, ...]:
        """The accelerations, then the reactions."""
        return (*(acceleration(s) for s in self.q), *self.reactions)

    @cached_property
    def solution(self) -> tuple[Expr, ...]:
        """The accelerations and reactions as functions of q, q̇, t.

        Raises
        ------
        ValueError
            Where the balances leave an unknown open (name the reactions that are missing or too many), are not
            linear in them, or are certainly inconsistent.
        """
        still = dict.fromkeys(self.unknowns, sp.S.Zero)
        matrix = sp.Matrix([[e.diff(x) for x in self.unknowns] for e in self.balances])
        acting = (part for load in self.loads for part in (*load.force, *load.torque))
        if matrix.has(*self.unknowns) or not all(is_affine(part, self.unknowns) for part in acting):
            raise ValueError("the balances are not linear in the reactions; write each reaction as a factor")
        right = sp.Matrix([-exchanged(e, still) for e in self.balances])
        reduced = eliminate(matrix, right)
        open_ = reduced.null_direction
        if open_ is not None:
            names = ", ".join(str(x) for x, part in zip(self.unknowns, open_, strict=True) if part != 0)
            raise ValueError(
                f"the balances do not determine {names}: too many reactions, or a load is missing"
            )
        left_over = [row[-1] for row in reduced.rows[reduced.rank :]]
        consistent = all_vanish((("a balance is left over", value) for value in left_over), "")
        if not consistent.holds:
            raise ValueError(
                "the bodies cannot move like that under these loads: "
                f"{consistent.residual} = 0 is left over. Add the reactions that hold them"
            )
        return self._solved(matrix, right)

    def _solved(self, matrix: sp.Matrix, right: sp.Matrix) -> tuple[Expr, ...]:
        """Return the unknowns, without poles where the bodies have none."""
        if not self.has_mass_matrix:
            return solve_overdetermined(matrix, right.flat(), self.weights)
        n, J, every = len(self.q), self.partial_velocities, range(matrix.rows)
        turning = matrix.extract(every, range(n))
        holding = matrix.extract(every, range(n, matrix.cols))
        masses = symmetric_product(J, turning.tolist(), [sp.S.One] * len(J))
        found = solve(masses, sp.Matrix(J).T * right, name="the mass matrix")
        return (*found.flat(), *solve_overdetermined(holding, (right - turning * found).flat(), self.weights))

    @cached_property
    def has_mass_matrix(self) -> bool:
        """Whether the accelerations follow from a symmetric matrix of the masses alone.

        They do where reactions do no virtual work and no load holds accelerations itself.
        """
        rates = [acceleration(s) for s in self.q]
        loads = [sp.Matrix([*load.force, *load.torque]) for load in self.loads]
        return self.ideal.holds and not any(load.has(*rates) for load in loads)

    @cached_property
    def partial_velocities(self) -> tuple[tuple[Expr, ...], ...]:
        """The slopes ∂/∂q̇ of what each balance is the rate of: velocities, and angular velocities."""
        kinematics = Kinematics(self.q, t=self.t)
        moving = (
            rate
            for body in self.bodies
            for rate in (*map(kinematics.rate, body.r), *body.angular_velocity(kinematics))
        )
        return tuple(tuple(rate.diff(velocity(s)) for s in self.q) for rate in moving)

    @cached_property
    def ideal(self) -> Verdict:
        """Whether the reactions do no virtual work, so that the accelerations follow without them."""
        slopes = zip(*self.partial_velocities, strict=True)
        claims = [
            (f"the virtual work of {force} along {s}", sp.Add(*(a * e.diff(force) for a, e in pairs)))
            for s, column in zip(self.q, slopes, strict=True)
            for force in self.reactions
            for pairs in [list(zip(column, self.balances, strict=True))]
        ]
        return all_vanish(claims, "the reactions do no virtual work")

    @cached_property
    def weights(self) -> tuple[Expr, ...]:
        """1/m of each of Newton's balances and 1/tr I of each of Euler's, 1 of a body without mass."""
        sizes = (
            size
            for body in self.bodies
            for size in (*[body.m] * len(body.r), *[body.inertia.trace()] * body.inertia.rows)
        )
        return tuple(sp.S.One if size == 0 else 1 / size for size in sizes)

    def agrees_with(self, equations: Sequence[Expr], domain: Domain | None = None) -> Verdict:
        """Tell whether equations of motion (Lagrange's, Appell's) hold for the accelerations found here."""
        found = dict(zip(self.unknowns, self.solution, strict=True))
        claims = [(f"{e} = 0", exchanged(e, found)) for e in equations]
        return all_vanish(claims, "Newton and Euler agree with the equations", domain)

    def _newton(self, i: int, kinematics: Kinematics) -> list[Expr]:
        body = self.bodies[i]
        acting = [load for load in self.loads if load.body == i and load.force]
        return [
            sp.Add(body.m * kinematics.rate(kinematics.rate(place)), *(-load.force[k] for load in acting))
            for k, place in enumerate(body.r)
        ]

    def _euler(self, i: int, kinematics: Kinematics) -> list[Expr]:
        body = self.bodies[i]
        if isinstance(body, Particle):
            return []
        omega = body.angular_velocity(kinematics)
        spin = (body.inertia * sp.Matrix(omega)).flat()
        turning = [kinematics.rate(component) for component in spin]
        moment = self._moment(i, len(omega))
        if isinstance(body, RigidBody):
            turning = [a + b for a, b in zip(turning, cross(omega, spin), strict=True)]
            moment = _along_the_body(body, kinematics, moment)
        return [a - b for a, b in zip(turning, moment, strict=True)]

    def _moment(self, i: int, axes: int) -> list[Expr]:
        """Return the moment of the loads on a body about its centre of mass, along fixed axes."""
        centre = plain_all(self.bodies[i].r, self.q, self.t)
        total: list[Expr] = [sp.S.Zero] * axes
        for load in self.loads:
            if load.body != i:
                continue
            arms: list[Sequence[Expr]] = [load.torque] if load.torque else []
            if load.at is not None and load.force:
                d = [a - b for a, b in zip(load.at, centre, strict=True)]
                F = load.force
                arms.append([d[0] * F[1] - d[1] * F[0]] if axes == 1 else cross(d, F))
            for arm in arms:
                total = [a + b for a, b in zip(total, arm, strict=True)]
        return total


def _check_dimensions(load: Load, body: Body) -> None:
    dimension, axes = len(body.r), body.inertia.rows
    given = {"a force": load.force, "a force at a point": load.at or ()}
    for what, components in given.items():
        if components and len(components) != dimension:
            raise ValueError(
                f"{what} of {counted(len(components), 'component')} "
                f"on body {load.body}, whose position has {dimension}; give as many"
            )
    if load.torque and axes == 0:
        raise ValueError(
            f"a torque acts on body {load.body}, a particle, which does not turn; make it a PlanarBody or a RigidBody"
        )
    if load.torque and len(load.torque) != axes:
        raise ValueError(
            f"a torque of {counted(len(load.torque), 'component')} on body {load.body}, which turns about "
            f"{counted(axes, 'axis', 'axes')}; give as many"
        )


def _plain_load(load: Load, q: tuple[Symbol, ...], t: Symbol) -> Load:
    at = None if load.at is None else plain_all(load.at, q, t)
    return Load(load.body, plain_all(load.force, q, t), at, plain_all(load.torque, q, t))


def _along_the_body(body: RigidBody, kinematics: Kinematics, moment: Sequence[Expr]) -> list[Expr]:
    if all(component == 0 for component in moment):
        return list(moment)
    if body.rotation is None:
        raise ValueError("a moment acts on a body given by omega; give its rotation, to know the body's axes")
    turned = sp.Matrix(body.rotation).applyfunc(kinematics.plain).T * sp.Matrix(moment)
    return [entry(turned, k, 0) for k in range(3)]
