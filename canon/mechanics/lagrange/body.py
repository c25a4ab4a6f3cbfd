"""Bodies by position, orientation and mass: kinetic energy and its parts.

Positions and orientations are functions of the coordinates and of time. With q̇ it follows that
T = ½ q̇ᵀA q̇ + b·q̇ + c; b and c vanish where nothing depends on time explicitly (L. A. Pars, Analytical Dynamics, § 3.4).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import Rate, time, velocity
from canon.expression.symbols.user_input import counted, given_expression, given_kind
from canon.mechanics.algebra.all_vanish import all_vanish, is_quadratic_in
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols, plain, plain_all
from canon.mechanics.algebra.substitution import as_tuple, entry, exchanged
from canon.mechanics.lagrange.quasi_velocity import Kinematics

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = [
    "Body", "KineticForm", "Particle", "PlanarBody", "RigidBody", "euler_rotation", "is_scleronomic", "kinetic_energy",
    "kinetic_form",
]  # fmt: skip


@dataclass(frozen=True)
class Particle:
    """A point mass.

    Parameters
    ----------
    m
        Mass.
    r
        Position as a function of q and t, of any dimension.
    """

    m: Expr
    r: tuple[Expr, ...]

    def __init__(self, m: Expr, r: Sequence[Expr] | sp.MatrixBase) -> None:
        object.__setattr__(self, "m", given_expression(m, "m"))
        object.__setattr__(self, "r", as_tuple(r))

    @property
    def inertia(self) -> sp.ImmutableDenseMatrix:
        """No inertia against turning: a matrix of shape (0, 0)."""
        return sp.ImmutableDenseMatrix(0, 0, [])

    def angular_velocity(self, kinematics: Kinematics) -> tuple[Expr, ...]:
        """Return nothing: a point does not turn."""
        del kinematics
        return ()


@dataclass(frozen=True)
class PlanarBody:
    """A rigid body that moves in a plane.

    Parameters
    ----------
    m
        Mass.
    r
        Position of the centre of mass as a function of q and t; ``()`` where it is fixed.
    moment
        Moment of inertia about the axis through the centre of mass.
    angle
        Angle of rotation as a function of q and t.
    omega
        Instead of ``angle``: the angular velocity as a function of q, q̇, t.
    """

    m: Expr
    r: tuple[Expr, ...]
    moment: Expr
    angle: Expr | None = None
    omega: Expr | None = None

    def __init__(
        self,
        m: Expr,
        r: Sequence[Expr] | sp.MatrixBase,
        moment: Expr,
        angle: Expr | None = None,
        omega: Expr | None = None,
    ) -> None:
        if (angle is None) == (omega is None):
            raise ValueError("say how the body turns by angle or by omega, and not by both")
        object.__setattr__(self, "m", given_expression(m, "m"))
        object.__setattr__(self, "r", as_tuple(r))
        object.__setattr__(self, "moment", given_expression(moment, "moment"))
        object.__setattr__(self, "angle", None if angle is None else given_expression(angle, "angle"))
        object.__setattr__(self, "omega", None if omega is None else given_expression(omega, "omega"))

    @property
    def inertia(self) -> sp.ImmutableDenseMatrix:
        """The moment of inertia as a matrix of shape (1, 1)."""
        return sp.ImmutableDenseMatrix([[self.moment]])

    def angular_velocity(self, kinematics: Kinematics) -> tuple[Expr, ...]:
        """Return the rate of the angle."""
        if self.angle is not None:
            return (kinematics.rate(self.angle),)
        return (kinematics.along(self.omega),)


@dataclass(frozen=True)
class RigidBody:
    """A rigid body in space.

    Parameters
    ----------
    m
        Mass.
    r
        Position of the centre of mass; ``()`` where it is fixed.
    inertia
        Moments of inertia about the centre of mass (about the fixed point where ``r`` is empty) in axes that
        turn with the body: a symmetric 3×3 matrix, or three principal moments.
    rotation
        The orthogonal matrix R(q, t) that takes components along the body's axes to those along fixed axes.
    omega
        Instead of ``rotation``: the angular velocity along the axes of ``inertia`` as a function of q, q̇, t.
    """

    m: Expr
    r: tuple[Expr, ...]
    inertia: sp.ImmutableDenseMatrix
    rotation: sp.ImmutableDenseMatrix | None = None
    omega: tuple[Expr, ...] | None = None

    def __init__(
        self,
        m: Expr,
        r: Sequence[Expr] | sp.MatrixBase,
        inertia: Sequence[Expr] | sp.MatrixBase,
        rotation: sp.MatrixBase | None = None,
        omega: Sequence[Expr] | None = None,
    ) -> None:
        matrix = inertia if isinstance(inertia, sp.MatrixBase) else sp.diag(*as_tuple(inertia))
        if matrix.shape != (3, 3) or matrix != matrix.T:
            raise ValueError(
                f"the inertia {matrix.tolist()} is neither a symmetric 3×3 matrix nor three principal moments"
            )
        if (rotation is None) == (omega is None):
            raise ValueError("say how the body turns by rotation or by omega, and not by both")
        object.__setattr__(self, "m", given_expression(m, "m"))
        object.__setattr__(self, "r", as_tuple(r))
        object.__setattr__(self, "inertia", sp.ImmutableDenseMatrix(matrix))
        turned = None if rotation is None else sp.ImmutableDenseMatrix(rotation)
        object.__setattr__(self, "rotation", turned)
        object.__setattr__(self, "omega", None if omega is None else as_tuple(omega))
        if self.omega is not None and len(self.omega) != 3:
            raise ValueError(
                f"{counted(len(self.omega), 'component')} of the angular velocity; in space there are three"
            )

    def __repr__(self) -> str:
        turned = f"omega={self.omega}" if self.rotation is None else f"rotation={self.rotation.tolist()}"
        return f"RigidBody(m={self.m}, r={self.r}, inertia={self.inertia.tolist()}, {turned})"

    def angular_velocity(self, kinematics: Kinematics) -> tuple[Expr, ...]:
        """Return ω along the body's axes: the three entries of Rᵀ Ṙ."""
        if self.omega is not None:
            return tuple(kinematics.along(w) for w in self.omega)
        R = sp.Matrix(self.rotation).applyfunc(kinematics.plain)
        spin = R.T * R.applyfunc(kinematics.rate)
        return tuple(sp.expand(entry(spin, i, j)) for i, j in ((2, 1), (0, 2), (1, 0)))


Body = Particle | PlanarBody | RigidBody
"""What has mass."""


def bodies_of(given: Any) -> tuple[Body, ...]:
    """Return one body or several as a tuple.

    Raises
    ------
    TypeError
        Where something else is among them.
    """
    several = tuple(given) if isinstance(given, Iterable) else (given,)
    for each in several:
        given_kind(each, (Particle, PlanarBody, RigidBody), "what has mass", "write Particle(m, (x, y))")
    return several


def euler_rotation(phi: Expr, theta: Expr, psi: Expr) -> sp.ImmutableDenseMatrix:
    """Return R = R_z(φ) R_x(θ) R_z(ψ): precession, nutation, spin (Goldstein, Classical Mechanics, § 4.4).

    Examples
    --------
    >>> from sympy import symbols
    >>> euler_rotation(*symbols("phi theta psi"))[2, 2]
    cos(theta)
    """

    def about_z(angle: Expr) -> sp.Matrix:
        c, s = sp.cos(angle), sp.sin(angle)
        return sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    c, s = sp.cos(theta), sp.sin(theta)
    about_x = sp.Matrix([[1, 0, 0], [0, c, -s], [0, s, c]])
    return sp.ImmutableDenseMatrix(about_z(phi) * about_x * about_z(psi))


def kinetic_energy(bodies: Sequence[Body], q: Sequence[Symbol], t: Symbol = time) -> Expr:
    """Return T = Σ ½ m ṙ² + ½ ω·I ω as a function of q, q̇, t (König's theorem).

    Examples
    --------
    A bead on a parabolic wire that turns with the angular velocity w:

    >>> from canon import coordinates, parameters, time as t
    >>> from sympy import cos, sin
    >>> s = coordinates("s")
    >>> m, w = parameters("m w", positive=True)
    >>> T = kinetic_energy([Particle(m, (s*cos(w*t), s*sin(w*t), s**2))], [s])
    >>> (T - m*((1 + 4*s**2)*s.dot**2 + w**2*s**2)/2).expand().trigsimp()
    0
    """
    kinematics = Kinematics(q, t=t)
    bodies = bodies_of(bodies)
    terms: list[Expr] = []
    for body in bodies:
        terms += [body.m * kinematics.rate(place) ** 2 / 2 for place in body.r]
        omega = body.angular_velocity(kinematics)
        terms += [
            entry(body.inertia, i, j) * a * b / 2 for i, a in enumerate(omega) for j, b in enumerate(omega)
        ]
    return sp.Add(*terms)


@dataclass(frozen=True)
class KineticForm:
    """A kinetic energy split by powers of the velocities, T = ½ q̇ᵀA q̇ + b·q̇ + c.

    Parameters
    ----------
    A
        Symmetric matrix of shape (n, n).
    b
        Coefficients of the part linear in the velocities, shape (n,).
    c
        The part without velocities.
    q
        The coordinates.
    """

    A: sp.ImmutableDenseMatrix
    b: tuple[Expr, ...]
    c: Expr
    q: tuple[Symbol, ...]

    @cached_property
    def parts(self) -> tuple[Expr, Expr, Expr]:
        """T₂, T₁ and T₀, homogeneous of degree 2, 1 and 0 in the velocities."""
        v = [velocity(s) for s in self.q]
        n = range(len(v))
        T2 = sp.Add(*(entry(self.A, i, j) * v[i] * v[j] / 2 for i in n for j in n))
        return T2, sp.Add(*(a * w for a, w in zip(self.b, v, strict=True))), self.c

    def is_quadratic(self, domain: Domain | None = None) -> Verdict:
        """Tell whether b = 0 and c = 0, so that T = ½ q̇ᵀA q̇ and Jacobi's energy is T + V."""
        claims = [(f"b of {s} = 0", b) for s, b in zip(self.q, self.b, strict=True)]
        return all_vanish([*claims, ("c = 0", self.c)], "T is a quadratic form in the velocities", domain)


def kinetic_form(T: Expr, q: Sequence[Symbol]) -> KineticForm:
    """Return A, b and c of a kinetic energy.

    Raises
    ------
    ValueError
        Where T is of higher degree in the velocities.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> r, theta = coordinates("r theta")
    >>> m = parameters("m", positive=True)
    >>> kinetic_form(m*(r.dot**2 + r**2*theta.dot**2)/2, [r, theta]).A
    Matrix([
    [m,      0],
    [0, m*r**2]])
    """
    q = coordinate_symbols(q)
    energy, v = plain(T, q), [velocity(s) for s in q]
    at_rest = dict.fromkeys(v, sp.S.Zero)
    slopes = [energy.diff(w) for w in v]
    A = sp.ImmutableDenseMatrix([[slope.diff(w) for w in v] for slope in slopes])
    if not is_quadratic_in(energy, v):
        raise ValueError("T is not quadratic in the velocities; it cannot be the kinetic energy of bodies")
    return KineticForm(A, tuple(exchanged(s, at_rest) for s in slopes), exchanged(energy, at_rest), q)


def _at_rest(omega: Expr) -> Expr:
    """Return an angular velocity at q̇ = 0; what is named as a velocity is one."""
    rates = [s for s in omega.atoms(Symbol) if isinstance(s, Rate) or s.name.endswith("_dot")]
    return exchanged(omega, dict.fromkeys(rates, sp.S.Zero))


def is_scleronomic(
    bodies: Sequence[Body], q: Sequence[Symbol] = (), domain: Domain | None = None, t: Symbol = time
) -> Verdict:
    """Tell whether positions and orientations do not depend on time explicitly (else they are rheonomic).

    Parameters
    ----------
    bodies
        Particles and rigid bodies.
    q
        The coordinates, to be named only where positions are written in SymPy's dynamicsymbols.
    domain
        Where the claim is meant.
    t
        The time.

    Examples
    --------
    >>> from canon import coordinates, time as t
    >>> s = coordinates("s")
    >>> is_scleronomic([Particle(1, (s, s**2))]).status.name, is_scleronomic([Particle(1, (s + t,))]).status.name
    ('HOLDS', 'FAILS')
    """
    named = coordinate_symbols(q)
    claims: list[tuple[str, Expr]] = []
    for i, body in enumerate(bodies, 1):
        claims += [(f"∂r/∂t of body {i}", plain(place, named, t).diff(t)) for place in body.r]
        if isinstance(body, PlanarBody):
            angles, rates = ((), (body.omega,)) if body.angle is None else ((body.angle,), ())
        elif isinstance(body, RigidBody):
            angles, rates = ((), body.omega or ()) if body.rotation is None else (body.rotation.flat(), ())
        else:
            continue
        omegas = plain_all(rates, named, t)
        claims += [(f"∂/∂t of how body {i} stands", part.diff(t)) for part in plain_all(angles, named, t)]
        claims += [(f"∂ω/∂t of body {i}", omega.diff(t)) for omega in omegas]
        claims += [(f"ω of body {i} while q rests", _at_rest(omega)) for omega in omegas]
    return all_vanish(claims, "the bodies are bound scleronomically", domain)
