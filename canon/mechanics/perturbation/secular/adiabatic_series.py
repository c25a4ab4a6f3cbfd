"""Adiabatic invariants as series J = I + ε J₁ + ε² J₂ … where frequencies depend on slow variables or a slow time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.user_input import given_kind, given_symbols
from canon.mechanics.hamilton.bracket import poisson_bracket
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.averaging import ZERO_SECONDS, AveragingError
from canon.mechanics.perturbation.fourier_series import (
    fourier_bracket,
    fourier_expression,
    fourier_series,
)
from canon.mechanics.perturbation.lie_series import powers_of
from canon.proof.domain.verdict import Verdict, all_hold
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.mechanics.perturbation.fourier_series import Harmonic, Series

__all__ = ["AdiabaticInvariant", "adiabatic_invariants"]


@dataclass(frozen=True)
class AdiabaticInvariant:
    """A series J = J₀ + ε J₁ + … + εⁿ Jₙ with dJ/dt = O(εⁿ⁺¹) along the motion.

    Parameters
    ----------
    source
        The Hamiltonian, with τ as a symbol of its own where it depends on a slow time.
    small
        ε.
    slow_q
        The coordinates whose pairs move at the rate ε: q̇ = ε ∂H/∂p, ṗ = −ε ∂H/∂q.
    slow_time
        τ = ε t, or None.
    terms
        J₀ … Jₙ, where J₀ is an action.
    divisors
        The k·ω that were divided by, functions of the actions and the slow variables. Where one vanishes there is a
        resonance, and the invariant may jump when the motion passes it.
    """

    source: Hamiltonian
    small: Symbol
    slow_q: tuple[Symbol, ...]
    slow_time: Symbol | None
    terms: tuple[Expr, ...]
    divisors: dict[Harmonic, Expr]

    @property
    def order(self) -> int:
        """The power of ε of the last term."""
        return len(self.terms) - 1

    @cached_property
    def J(self) -> Expr:
        """The series as one expression."""
        return sp.Add(*(term * self.small**n for n, term in enumerate(self.terms)))

    @cached_property
    def rate(self) -> tuple[Expr, ...]:
        """The coefficients of 1, ε … εⁿ⁺¹ in dJ/dt, by derivatives of the whole expressions."""
        parts = powers_of(self.source.H, self.small, self.order + 1)
        momentum = dict(zip(self.source.q, self.source.p, strict=True))
        slow = [[*self.slow_q], [momentum[x] for x in self.slow_q]]
        fast = [[x for x in self.source.q if x not in self.slow_q]]
        fast.append([momentum[x] for x in fast[0]])
        found: list[Expr] = []
        for n in range(self.order + 2):
            total = sp.S.Zero
            for k, term in enumerate(self.terms[: n + 1]):
                total += poisson_bracket(term, parts[n - k], *fast)
                if k < n:
                    total += poisson_bracket(term, parts[n - k - 1], *slow)
            if self.slow_time is not None and n:
                total += self.terms[n - 1].diff(self.slow_time)
            found.append(total)
        return tuple(found)

    def is_adiabatic(self, budget: float = 10.0) -> Verdict:
        """Tell whether dJ/dt has no term up to εⁿ; Fourier series are not used for this."""
        question = f"dJ/dt = O({self.small}**{self.order + 1})"
        each = (
            vanishes(f, budget=budget / (self.order + 1)).about(
                f"the coefficient of {self.small}**{n} in dJ/dt vanishes"
            )
            for n, f in enumerate(self.rate[:-1])
        )
        return all_hold(each, question)


def adiabatic_invariants(
    H: Hamiltonian,
    angles: Sequence[Symbol] | Symbol,
    order: int,
    small: Symbol,
    slow_q: Sequence[Symbol] | Symbol = (),
    slow_time: Symbol | None = None,
) -> tuple[AdiabaticInvariant, ...]:
    """Return the adiabatic invariant of each fast angle's action to an order in ε.

    H = H₀(I, q, p, τ) + ε H₁(θ, I, q, p, τ) + …, where θ and I are fast angles and their actions, the slow pairs (q, p)
    move at the rate ε, q̇ = ε ∂H/∂p and ṗ = −ε ∂H/∂q, so that (q, p/ε) is canonical, and τ = ε t. Lie series in the
    bracket {f, g} + ε {f, g}_slow take the angles out of H up to εⁿ; the new actions as functions of the old variables
    are the invariants (A. I. Neishtadt, J. Appl. Math. Mech. 45, 766 (1981); J. Henrard, Dynamics Reported 2, 117
    (1993), doi:10.1007/978-3-642-61232-9_4). Any consistent units.

    Parameters
    ----------
    H
        The Hamiltonian, a polynomial in ε and a trigonometric polynomial in the angles; names for irrational numbers
        in it keep coefficients short.
    angles
        The fast angles, among H.q.
    order
        The highest power of ε, at least 1.
    small
        ε.
    slow_q
        The coordinates of the slow pairs: all of H.q that are not fast.
    slow_time
        The symbol of τ in H.

    Returns
    -------
    tuple of AdiabaticInvariant
        One for each angle.

    Raises
    ------
    AveragingError
        Where H₀ depends on an angle, a pair is neither fast nor slow, or a divisor k·ω vanishes identically.
    NoFourierSeriesError
        Where H is no trigonometric polynomial in the angles.

    Examples
    --------
    An oscillator of the slow frequency ω(τ), in its angle and action:

    >>> theta, tau = sp.symbols("theta tau", real=True)
    >>> I, eps = sp.symbols("I epsilon", positive=True)
    >>> w = sp.Function("omega", positive=True)(tau)
    >>> H = Hamiltonian(w * I + eps * I * w.diff(tau) / (2 * w) * sp.sin(2 * theta), theta, I)
    >>> (found,) = adiabatic_invariants(H, theta, 1, eps, slow_time=tau)
    >>> found.J
    I*epsilon*sin(2*theta)*Derivative(omega(tau), tau)/(2*omega(tau)**2) + I
    >>> found.is_adiabatic().status
    <Status.HOLDS: 'holds'>
    """
    given_kind(H, Hamiltonian, "H", "give Hamiltonian(H, q, p)")
    fast, slow = given_symbols(angles, "angles"), given_symbols(slow_q, "slow_q")
    if order < 1:
        raise ValueError(f"the order should be a whole number from 1, not {order}")
    scales = _Scales.of(H, fast, slow, slow_time)
    column = [fourier_series(part, fast) for part in powers_of(H.H, small, order)]
    if any(any(k) for k in column[0]):
        raise AveragingError(
            f"H at {small} = 0 depends on the angles; change to the action and angle of H at fixed slow variables first"
        )
    start = column[0].get((0,) * len(fast), sp.S.Zero)
    frequencies = [start.diff(action) for action in scales.actions]
    if slow_time is not None:
        column[0] = {(0,) * len(fast): start + scales.energy}
    divisors: dict[Harmonic, Expr] = {}
    generators: list[Series] = []
    for n in range(1, order + 1):
        generators.append(_generator(column[n], frequencies, divisors, n))
        column = scales.transformed(column, generators[-1], n)
    invariants: list[AdiabaticInvariant] = []
    for action in scales.actions:
        series: list[Series] = [{(0,) * len(fast): action}, *({} for _ in range(order))]
        for n, chi in reversed([*enumerate(generators, 1)]):
            series = scales.transformed(series, {k: -c for k, c in chi.items()}, n)
        terms = tuple(_in_factors(fourier_expression(f, fast), fast) for f in series)
        invariants.append(AdiabaticInvariant(H, small, slow, slow_time, terms, divisors))
    return tuple(invariants)


def _generator(part: Series, frequencies: Sequence[Expr], divisors: dict[Harmonic, Expr], n: int) -> Series:
    """Return χ with {H₀, χ} + (the terms of a part that depend on the angles) = 0."""
    chi: Series = {}
    for k, c in part.items():
        if not any(k):
            continue
        divisor: Any = sp.factor(sp.Add(*(j * omega for j, omega in zip(k, frequencies, strict=True))))
        if divisor == 0 or vanishes(divisor, budget=ZERO_SECONDS).holds:
            raise AveragingError(
                f"at order {n} the term of k = {k} has the divisor k·ω = 0, so the actions of its angles are no "
                "adiabatic invariants by themselves; take k·θ for an angle, which is slow"
            )
        divisors[max(k, tuple(-j for j in k))] = divisor if k > tuple(-j for j in k) else -divisor
        chi[k] = c / (sp.I * divisor)
    return chi


def _in_factors(f: Expr, angles: Sequence[Symbol]) -> Expr:
    """Return a trigonometric sum with the coefficient of each wave in factors."""
    waves = sorted((w for w in f.atoms(sp.cos, sp.sin) if w.has(*angles)), key=sp.default_sort_key)
    rows: dict[Expr, Expr] = sp.collect(sp.expand_mul(f), waves, evaluate=False)
    return sp.Add(*(sp.factor(c) * wave for wave, c in rows.items()))


@dataclass(frozen=True)
class _Scales:
    """The bracket {f, g} + ε {f, g}_slow of series in ε with coefficients that are Fourier series."""

    actions: tuple[Symbol, ...]
    slow_q: tuple[Symbol, ...]
    slow_p: tuple[Symbol, ...]
    energy: Symbol

    @classmethod
    def of(
        cls, H: Hamiltonian, fast: tuple[Symbol, ...], slow: tuple[Symbol, ...], slow_time: Symbol | None
    ) -> _Scales:
        if not fast or not {*fast} <= {*H.q}:
            raise ValueError(f"the angles should be among the coordinates {', '.join(map(str, H.q))}")
        left = [x for x in H.q if x not in (*fast, *slow)]
        if left or {*fast} & {*slow} or not {*slow} <= {*H.q}:
            names = ", ".join(map(str, left)) or "one of them"
            raise AveragingError(
                f"each coordinate should be a fast angle or stand in slow_q, and {names} is neither, or both"
            )
        if H.H.has(H.t):
            raise ValueError(f"H depends on {H.t}; write the slow time as a symbol of its own, slow_time")
        momentum, energy = dict(zip(H.q, H.p, strict=True)), sp.Dummy("T")
        of_time = ((), ()) if slow_time is None else ((slow_time,), (energy,))
        return cls(
            tuple(momentum[x] for x in fast),
            (*slow, *of_time[0]),
            (*(momentum[x] for x in slow), *of_time[1]),
            energy,
        )

    def transformed(self, f: Sequence[Series], chi: Series, n: int) -> list[Series]:
        """Return exp(L_χ εⁿ) f to the order of f."""
        total = [dict(part) for part in f]
        term, k = [dict(part) for part in f], 1
        while any(term):
            term = self._bracket(term, chi, n, k)
            for place, part in zip(total, term, strict=True):
                _add(place, part)
            k += 1
        return [{k: value for k, c in part.items() if (value := sp.cancel(c)) != 0} for part in total]

    def _bracket(self, f: Sequence[Series], chi: Series, n: int, divisor: int) -> list[Series]:
        """Return {f, εⁿ χ}/divisor: its fast part raises the power of ε by n, its slow part by n + 1."""
        found: list[Series] = [{} for _ in f]
        for m, part in enumerate(f):
            if m + n < len(f):
                _add(found[m + n], fourier_bracket(part, chi, self.actions, (), ()), divisor)
            if m + n + 1 < len(f):
                _add(found[m + n + 1], fourier_bracket(part, chi, (), self.slow_q, self.slow_p), divisor)
        return found


def _add(total: Series, more: Series, divisor: int = 1) -> None:
    for k, c in more.items():
        total[k] = total.get(k, sp.S.Zero) + c / divisor
