"""Hamiltonians: Hamilton's equations, and Legendre's transformation both ways."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.repeated_sum import sums_within
from canon.expression.symbols.symbol import Rate, momentum, time, velocity
from canon.expression.symbols.user_input import counted, given_expression, given_kind
from canon.mechanics.algebra.all_vanish import having_values
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols, plain, plain_all, plain_places
from canon.mechanics.algebra.linear import is_regular
from canon.mechanics.algebra.possible_motion import motion_is_continuous, motion_is_real
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.legendre import (
    LegendreError,
    eliminate_velocities,
    is_dual,
    legendre_residual,
    where_root_is_real,
)
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import Status, Verdict, all_hold
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

__all__ = [
    "Hamiltonian",
    "LegendreError",
    "hamiltonian",
    "has_hamiltonian",
    "is_hamiltonian_of",
    "lagrangian",
]


@dataclass(frozen=True)
class Hamiltonian:
    """A Hamiltonian H(q, p, t) in canonical variables.

    Parameters
    ----------
    H
        The Hamiltonian.
    q, p
        Coordinates and their conjugate momenta, in the same order.
    t
        The time.

    Raises
    ------
    ValueError
        Where the variables are not as many momenta as coordinates, all different, or H holds velocities.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> x = coordinates("x")
    >>> m, k = parameters("m k", positive=True)
    >>> oscillator = Hamiltonian(x.momentum**2/(2*m) + k*x**2/2, [x], [x.momentum])
    >>> oscillator.q_dot, oscillator.p_dot
    ((p_x/m,), (-k*x,))
    """

    H: Expr
    q: tuple[Symbol, ...]
    p: tuple[Symbol, ...]
    t: Symbol = time

    def __init__(
        self, H: Expr, q: Sequence[Symbol] | Symbol, p: Sequence[Symbol] | Symbol, t: Symbol = time
    ) -> None:
        object.__setattr__(self, "q", coordinate_symbols(q))
        object.__setattr__(self, "p", coordinate_symbols(p))
        given = given_expression(H, "H")
        long = any(each.is_long for each in sums_within(given))
        object.__setattr__(self, "H", plain(given, (*self.q, *self.p), t, keep_sums=long))
        object.__setattr__(self, "t", t)
        if not self.q:
            raise ValueError("no coordinates given; a system moves in at least one")
        if len(self.q) != len(self.p):
            raise ValueError(
                f"{counted(len(self.q), 'coordinate')} and "
                f"{counted(len(self.p), 'momentum', 'momenta')}; each coordinate needs one"
            )
        if len({*self.q, *self.p}) < 2 * len(self.q):
            raise ValueError(
                f"the variables {(*self.q, *self.p)} are not all different; each needs a symbol of its own"
            )
        momenta = {*self.p}
        rates = sorted(s.name for s in self.H.free_symbols if isinstance(s, Rate) and s not in momenta)
        if rates:
            raise ValueError(
                f"H holds {', '.join(rates)}, and is a function of coordinates and momenta; write it in "
                f"{', '.join(map(str, self.p))}, or take it from a Lagrangian, Lagrangian(L, q).hamiltonian()"
            )

    @cached_property
    def q_dot(self) -> tuple[Expr, ...]:
        """The velocities q̇ = ∂H/∂p."""
        return tuple(self.H.diff(p) for p in self.p)

    @cached_property
    def p_dot(self) -> tuple[Expr, ...]:
        """The rates ṗ = −∂H/∂q."""
        return tuple(-self.H.diff(q) for q in self.q)

    @property
    def vector_field(self) -> tuple[Expr, ...]:
        """The right-hand side (q̇, ṗ) of Hamilton's equations, of length 2n."""
        return (*self.q_dot, *self.p_dot)

    def rate(self, u: Expr) -> Expr:
        """Return du/dt = {u, H} + ∂u/∂t for u(q, p, t).

        Examples
        --------
        >>> from sympy import symbols
        >>> q, p = symbols("q p", real=True)
        >>> Hamiltonian(p**2/2 + q**2/2, q, p).rate(q*p)
        p**2 - q**2
        """
        u = plain(u, (*self.q, *self.p), self.t)
        return poisson_bracket(u, self.H, self.q, self.p) + u.diff(self.t)

    def has_equations(
        self, q_dot: Sequence[Expr], p_dot: Sequence[Expr], domain: Domain | None = None
    ) -> Verdict:
        """Tell whether q̇ = ``q_dot`` and ṗ = ``p_dot`` are Hamilton's equations of H."""
        domain = as_domain(domain)
        claimed = plain_all((*q_dot, *p_dot), (*self.q, *self.p), self.t)
        if len(claimed) != 2 * len(self.q):
            raise ValueError(
                f"{counted(len(claimed), 'rate')} given for {2 * len(self.q)} canonical variables; give one each"
            )
        verdict = all_hold(
            (
                vanishes_off_kinks(claim - rate, domain).about(f"d{z}/dt = {claim}")
                for z, rate, claim in zip((*self.q, *self.p), self.vector_field, claimed, strict=True)
            ),
            "these are Hamilton's equations",
        )
        answers = {f"d{z}/dt": f for z, f in zip((*self.q, *self.p), claimed, strict=True)}
        return having_values(verdict, answers, [self.H], domain)

    def is_solution(self, motion: Mapping[Symbol, Expr], domain: Domain | None = None) -> Verdict:
        """Tell whether these functions of time solve Hamilton's equations.

        Parameters
        ----------
        motion
            Each canonical variable as an expression in ``t`` and parameters.
        domain
            Where the claim is meant, such as a range of times.

        Examples
        --------
        >>> from canon import time as t
        >>> from sympy import symbols, sin, cos
        >>> q, p = symbols("q p", real=True)
        >>> Hamiltonian(p**2/2 + q**2/2, q, p).is_solution({q: sin(t), p: cos(t)}).status.name
        'HOLDS'
        """
        domain = as_domain(domain)
        variables = (*self.q, *self.p)
        motion = plain_places(motion, variables, (), self.t)
        missing = [str(z) for z in variables if z not in motion]
        if missing:
            raise ValueError(f"the motion does not say what {', '.join(missing)} is; give every variable")
        satisfied = (
            vanishes_off_kinks(motion[z].diff(self.t) - substitute(rate, motion), domain).about(
                f"{z}(t) satisfies its equation"
            )
            for z, rate in zip(variables, self.vector_field, strict=True)
        )
        question = "these functions solve Hamilton's equations"
        answers = {f"{z}(t)": motion[z] for z in variables}
        verdict = having_values(all_hold(satisfied, question), answers, [self.t], domain)
        if not verdict.holds:
            return verdict
        real = motion_is_real(motion, domain)
        continuous = motion_is_continuous(motion, domain, [self.H], self.t, velocities=False)
        return all_hold(chain([verdict], real, continuous), question)

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle H = {sp.latex(self.H)}$"


def hamiltonian(
    lagrangian: Lagrangian, p: Sequence[Symbol] | None = None, domain: Domain | None = None
) -> Hamiltonian:
    """Return H(q, p, t) = Σ p q̇ − L with the velocities eliminated.

    Momenta linear in the velocities are solved by elimination, others (such as relativistic ones) in
    closed form on the branch that the domain determines, and that branch is proved.

    Parameters
    ----------
    lagrangian
        A Lagrangian without non-potential forces.
    p
        Symbols for the momenta; ``q.momentum`` unless given.
    domain
        Conditions on q, q̇ and t, such as a speed below that of light.

    Raises
    ------
    LegendreError
        With the null direction, where the velocity Hessian is singular; or where the velocities have no
        closed form.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> (r, phi) = coordinates("r phi")
    >>> m = parameters("m", positive=True)
    >>> hamiltonian(Lagrangian(m*(r.dot**2 + r**2*phi.dot**2)/2, [r, phi])).H
    p_phi**2/(2*m*r**2) + p_r**2/(2*m)

    A Lagrangian is meant where it is real, here below the speed of light:

    >>> from sympy import sqrt
    >>> x, c = coordinates("x"), parameters("c", positive=True)
    >>> hamiltonian(Lagrangian(-m*c**2*sqrt(1 - x.dot**2/c**2), [x])).H
    c*sqrt(c**2*m**2 + p_x**2)
    """
    given_kind(lagrangian, Lagrangian, "what hamiltonian() transforms", "lagrangian() goes the other way")
    if any(Q != 0 for Q in lagrangian.forces):
        raise LegendreError(
            "the system has forces without a potential; Hamilton's equations of H alone would miss them. "
            "Put what has a potential into L, or stay with Lagrange's equations"
        )
    momenta = coordinate_symbols(p) if p is not None else tuple(momentum(q) for q in lagrangian.q)
    if len(momenta) != len(lagrangian.q):
        raise ValueError(
            f"{counted(len(momenta), 'momentum', 'momenta')} for "
            f"{counted(len(lagrangian.q), 'coordinate')}; each needs one"
        )
    H = eliminate_velocities(
        lagrangian.L, lagrangian.velocities, momenta, as_domain(domain), "L", "velocities"
    )
    return Hamiltonian(H, lagrangian.q, momenta, lagrangian.t)


def lagrangian(hamiltonian: Hamiltonian, domain: Domain | None = None) -> Lagrangian:
    """Return L(q, q̇, t) = Σ p q̇ − H with the momenta eliminated.

    Parameters
    ----------
    hamiltonian
        A Hamiltonian, regular in its momenta.
    domain
        Conditions on q, p and t that choose the branch.

    Raises
    ------
    LegendreError
        Where ∂²H/∂p² is singular, or p cannot be found as a function of q̇ in closed form.

    Examples
    --------
    >>> from canon import coordinates
    >>> x = coordinates("x")
    >>> lagrangian(Hamiltonian(x.momentum**2/6, x, x.momentum)).L
    3*x_dot**2/2
    """
    given_kind(hamiltonian, Hamiltonian, "what lagrangian() transforms", "hamiltonian() goes the other way")
    H, velocities = hamiltonian, tuple(velocity(q) for q in hamiltonian.q)
    L = eliminate_velocities(H.H, H.p, velocities, as_domain(domain), "H", "momenta")
    return Lagrangian(L, H.q, t=H.t)


def has_hamiltonian(lagrangian: Lagrangian, domain: Domain | None = None) -> Verdict:
    """Tell whether the velocities can be eliminated: whether ∂²L/∂q̇² is regular at generic points.

    Examples
    --------
    >>> from canon import coordinates
    >>> (x, y) = coordinates("x y")
    >>> has_hamiltonian(Lagrangian((x.dot + y.dot)**2, [x, y])).feedback
    'the velocity Hessian is singular: it maps the direction (-1, 1) to zero'
    """
    return is_regular(lagrangian.mass_matrix, domain, "the velocity Hessian")


def is_hamiltonian_of(
    lagrangian: Lagrangian, H: Expr, p: Sequence[Symbol], domain: Domain | None = None
) -> Verdict:
    """Tell whether H is the Hamiltonian of a Lagrangian.

    The velocity Hessian must be regular and H(q, ∂L/∂q̇, t) = Σ p q̇ − L, so nothing has to be inverted.

    Examples
    --------
    >>> from canon import coordinates
    >>> x = coordinates("x")
    >>> L = Lagrangian(x.dot**2/2 - x**2, [x])
    >>> is_hamiltonian_of(L, x.momentum**2/2 + x**2, [x.momentum]).status.name
    'HOLDS'
    >>> is_hamiltonian_of(L, x.momentum**2/2 - x**2, [x.momentum]).status.name
    'FAILS'
    """
    domain = where_root_is_real(lagrangian.L, lagrangian.velocities, as_domain(domain))
    question = "H is the Hamiltonian of L"

    momenta = coordinate_symbols(p)
    energy = plain(H, (*lagrangian.q, *momenta), lagrangian.t)

    def verdicts() -> Iterator[Verdict]:
        yield has_hamiltonian(lagrangian, domain)
        residual = legendre_residual(
            energy, dict(zip(momenta, lagrangian.momenta, strict=True)), lagrangian.jacobi_energy
        )
        plainly = vanishes_off_kinks(residual, domain)
        if plainly.status is Status.UNDECIDED and len(momenta) == 1:
            (v,), (p,) = lagrangian.velocities, momenta
            if is_dual(energy, lagrangian.L, v, p):
                plainly = Verdict(Status.HOLDS, question, "exact")
        yield plainly

    there = substitute(energy, dict(zip(momenta, lagrangian.momenta, strict=True)))
    return having_values(all_hold(verdicts(), question), {"H": there}, [lagrangian.L], domain)
