"""Hamiltonians and Hamilton's equations.

What proves is imported when something is to be proved: a Hamiltonian that is only integrated does without.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING

import sympy as sp

from canon.cached_property import cached_property
from canon.expression.symbols.repeated_sum import sums_within
from canon.expression.symbols.symbol import Rate, time
from canon.expression.symbols.user_input import counted, given_expression
from canon.mechanics.algebra.dynamicsymbols import (
    check_none_reads_as_the_time,
    coordinate_symbols,
    plain,
    plain_all,
    plain_places,
)
from canon.mechanics.hamilton.bracket import poisson_bracket

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = ["Hamiltonian"]


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
        Where the variables are not as many momenta as coordinates, all different, one is the time, or H holds
        velocities.

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
        check_none_reads_as_the_time((*self.q, *self.p), "Hamiltonian(H, q, p", t)
        given = given_expression(H, "H")
        sums = sums_within(given)
        keep = not sums or any(each.is_long for each in sums)
        object.__setattr__(self, "H", plain(given, (*self.q, *self.p), t, keep_sums=keep))
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
        from canon.mechanics.algebra.all_vanish import having_values
        from canon.proof.domain.domain import as_domain
        from canon.proof.domain.verdict import all_hold
        from canon.proof.kinks import vanishes_off_kinks

        domain = as_domain(domain)
        state = (*self.q, *self.p)
        claimed = [claim for rates in (q_dot, p_dot) for claim in plain_all(rates, state, self.t)]
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
        from canon.mechanics.algebra.all_vanish import having_values
        from canon.mechanics.algebra.possible_motion import motion_is_continuous, motion_is_real
        from canon.mechanics.algebra.substitution import substitute
        from canon.proof.domain.domain import as_domain
        from canon.proof.domain.verdict import all_hold
        from canon.proof.kinks import vanishes_off_kinks

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
