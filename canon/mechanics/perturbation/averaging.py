"""Averaging over fast angles: the averaged Hamiltonian to an order in ε, its generator, F₂, adiabatic invariants."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from math import comb, factorial
from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.user_input import given_kind, given_symbols
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.fourier_series import (
    fourier_bracket,
    fourier_expression,
    fourier_series,
)
from canon.mechanics.perturbation.lie_series import lie_deprit, powers_of
from canon.mechanics.perturbation.normal_form_step import Module, whole_vector
from canon.mechanics.perturbation.secular.von_zeipel import von_zeipel_function
from canon.proof.analytic import is_analytic, proved_sign
from canon.proof.domain.domain import EVERYWHERE, Domain, as_domain
from canon.proof.domain.pinched_bounds import with_pinched_bounds
from canon.proof.domain.relations import linear, parts_of
from canon.proof.domain.verdict import Status, Verdict, all_hold
from canon.proof.rungs.ladder import is_empty
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.mechanics.canonical.generating_function import GeneratingFunction
    from canon.mechanics.perturbation.fourier_series import Harmonic, Series

__all__ = ["Averaged", "AveragingError", "adiabatic_invariant", "average"]

ZERO_SECONDS = 2.0
"""Time for the proof that a divisor vanishes, which only those with roots or functions need."""


class AveragingError(ValueError):
    """Raised where averaging ends before the order that was asked for.

    Parameters
    ----------
    message
        Why, and what to do instead.
    reached
        The average to the last order that was finished; None where there is none.
    """

    def __init__(self, message: str, reached: Averaged | None = None) -> None:
        super().__init__(message)
        self.reached = reached


@dataclass(frozen=True)
class Averaged:
    """The averaged Hamiltonian K to an order in ε, and the generator W of the map that leads to it.

    Parameters
    ----------
    source
        The Hamiltonian.
    angles, actions
        The fast angles and their momenta.
    small
        ε.
    order
        The highest power of ε.
    resonances
        The vectors whose span stays, as they were given; None where only k·ω = 0 stays.
    terms
        The coefficients of 1, ε … in K.
    generators
        W₁, W₂ …, where W = Σ Wₙ₊₁ εⁿ/n! is Deprit's.
    divisors
        The k·ω that were divided by, by k.
    domain
        Where it is meant: what ties frequencies there makes them resonant.
    """

    source: Hamiltonian
    angles: tuple[Symbol, ...]
    actions: tuple[Symbol, ...]
    small: Symbol
    order: int
    resonances: tuple[tuple[int, ...], ...] | None
    terms: tuple[Expr, ...]
    generators: tuple[Expr, ...]
    divisors: Mapping[Harmonic, Expr] = field(repr=False)
    domain: Domain = field(default=EVERYWHERE, repr=False)

    @cached_property
    def K(self) -> Expr:
        """The averaged Hamiltonian, in the new variables under the names of the old ones."""
        return sp.Add(*(term * self.small**n for n, term in enumerate(self.terms)))

    @cached_property
    def W(self) -> Expr:
        """Deprit's generator Σ Wₙ₊₁ εⁿ/n!."""
        return sp.Add(*(w * self.small**n / factorial(n) for n, w in enumerate(self.generators)))

    @cached_property
    def F2(self) -> GeneratingFunction:
        """Von Zeipel's generating function Σ q P + ε S₁(q, P) + … of the map from old to new variables."""

        def harmonics(f: Expr) -> Expr:
            return fourier_expression(fourier_series(f, self.angles), self.angles)

        return von_zeipel_function(self.W, self.source.q, self.source.p, self.order, self.small, harmonics)

    def to_new(self, f: Expr) -> Expr:
        """Return a function of the old variables in terms of the new ones, to the order."""
        return lie_deprit(f, self.W, self.source.q, self.source.p, self.order, self.small)

    def from_new(self, f: Expr) -> Expr:
        """Return a function of the new variables in terms of the old ones, to the order."""
        known = f
        for n in range(1, self.order + 1):
            image = lie_deprit(known, self.W, self.source.q, self.source.p, n, self.small)
            excess = sp.expand(image - f).coeff(self.small, n)
            known = known - self.small**n * excess
        return known

    def is_average(self, budget: float = 10.0) -> Verdict:
        """Tell whether Deprit's transform of H with W is K to the order, and K is free of the angles' fast terms.

        The transform is taken by SymPy's derivatives of the whole expressions, not by Fourier series.

        Raises
        ------
        AveragingError
            Where H depends on the time, or it was not decided whether a k·ω vanishes.
        """
        _check_autonomous(self.source)
        question = f"K is H averaged over {', '.join(map(str, self.angles))} to order {self.order}"
        frequencies = [self.terms[0].diff(action) for action in self.actions]
        module = None if self.resonances is None else Module(self.resonances)
        for n, term in enumerate(self.terms):
            for k in fourier_series(term, self.angles):
                if not _stays(k, _divisor(k, frequencies, self.domain), module):
                    why = f"the coefficient of {self.small}**{n} still has the fast term of k = {k}"
                    return Verdict(Status.FAILS, question, "exact", term, feedback=why)
        left = cast("Expr", sp.expand(self.to_new(self.source.H) - self.K))
        each = (
            vanishes(cast("Expr", left.coeff(self.small, n)), self.domain, budget / (self.order + 1)).about(
                f"the coefficient of {self.small}**{n} is that of K"
            )
            for n in range(self.order + 1)
        )
        return all_hold(each, question)


def average(
    H: Hamiltonian,
    angles: Sequence[Symbol] | Symbol,
    order: int,
    small: Symbol,
    resonances: Sequence[Sequence[int]] | None = None,
    domain: Domain | None = None,
) -> Averaged:
    """Return H averaged over fast angles to an order in ε, by Deprit's method.

    H = H₀(I) + ε H₁ + …, where H₀ depends on the momenta of the fast angles alone, and Hₙ are trigonometric polynomials
    in these angles with any dependence on all else. Slow variables may stand in Hₙ. A Hamiltonian with the time in it
    is averaged over τ = Ω t as an angle, with Ω T added to H. The same map by von Zeipel's function is ``F2``. Any
    consistent units (H. von Zeipel, Ark. Mat. Astr. Fys. 11 (1916); A. Deprit, doi:10.1007/BF01230629).

    Parameters
    ----------
    H
        The Hamiltonian, a polynomial in ε.
    angles
        The fast angles, among H.q.
    order
        The highest power of ε, at least 1.
    small
        ε.
    resonances
        Vectors k whose span stays, with the angles k·θ slow; without them only terms with k·ω = 0 identically stay.
    domain
        What holds of the parameters: with ω₁ = ω₂ the term of θ₁ − θ₂ stays.

    Raises
    ------
    AveragingError
        Where H depends on the time, H₀ on more than the actions, a divisor k·ω is zero for a k outside ``resonances``,
        or it was not decided whether one vanishes on the domain; ``reached`` keeps what was found.
    NoFourierSeriesError
        Where H is no trigonometric polynomial in the angles.
    TypeError, ValueError
        Where ε is no symbol, or a vector of ``resonances`` does not hold a whole number for each angle.

    Examples
    --------
    >>> theta, I, w, eps = sp.symbols("theta I omega epsilon", positive=True)
    >>> H = Hamiltonian(w * I + eps * I**2 * sp.cos(theta) ** 4, theta, I)
    >>> average(H, theta, 2, eps).K
    -17*I**3*epsilon**2/(64*omega) + 3*I**2*epsilon/8 + I*omega
    """
    fast = _fast_angles(H, angles, order)
    _check_autonomous(H)
    momentum = dict(zip(H.q, H.p, strict=True))
    actions = tuple(momentum[theta] for theta in fast)
    slow_q = [x for x in H.q if x not in fast]
    slow_p = [momentum[x] for x in slow_q]
    parts = powers_of(H.H, small, order)
    _check_of_actions_alone(parts[0], {*H.q, *H.p} - {*actions}, small)
    frequencies = [parts[0].diff(action) for action in actions]
    named = None if resonances is None else _vectors(resonances, len(fast))
    module = None if named is None else Module(named)
    domain = with_pinched_bounds(as_domain(domain))
    column = [fourier_series(part * factorial(n), fast) for n, part in enumerate(parts)]
    divisors: dict[Harmonic, Expr] = {}
    terms, generators = [parts[0]], list[Expr]()
    W: list[Series] = []

    def bracket(f: Series, g: Series) -> Series:
        return fourier_bracket(f, g, actions, slow_q, slow_p)

    def result() -> Averaged:
        return Averaged(
            H, fast, actions, small, len(W), named, tuple(terms), tuple(generators), divisors, domain
        )

    for n in range(1, order + 1):
        known = _diagonal(column, W, n, bracket)
        removed = _divisors(known, frequencies, module, domain)
        _check_nonzero(removed, result())
        divisors |= removed
        W.append({k: known[k] / (sp.I * divisor) for k, divisor in removed.items()})
        kept = {k: c for k, c in known.items() if k not in removed}
        terms.append(sp.expand(fourier_expression(kept, fast) / factorial(n)))
        generators.append(fourier_expression(W[-1], fast))
    return result()


def _fast_angles(H: Hamiltonian, angles: Sequence[Symbol] | Symbol, order: int) -> tuple[Symbol, ...]:
    given_kind(H, Hamiltonian, "H", "give Hamiltonian(H, q, p)")
    fast = given_symbols(angles, "angles")
    if not fast or not {*fast} <= {*H.q}:
        raise ValueError(f"the angles should be among the coordinates {', '.join(map(str, H.q))}")
    if order < 1:
        raise ValueError(f"the order should be a whole number from 1, not {order}")
    return fast


def _vectors(resonances: Sequence[Sequence[int]], n: int) -> tuple[tuple[int, ...], ...]:
    return tuple(whole_vector(k, n, "each of the resonances", "fast angle") for k in resonances)


def _check_autonomous(H: Hamiltonian) -> None:
    """Refuse a time in H: the generator would depend on it, and ∂W/∂t is of the order of what is removed."""
    if H.H.has(H.t):
        raise AveragingError(
            f"H depends on the time {H.t}; take τ = Ω {H.t} as another fast angle, and add Ω T to H, where T is its "
            "momentum"
        )


def _check_of_actions_alone(H0: Expr, others: set[Symbol], small: Symbol) -> None:
    found = sorted((s for s in others if H0.has(s)), key=str)
    if found:
        raise AveragingError(
            f"H at {small} = 0 depends on {', '.join(map(str, found))}; it may depend on the momenta of the fast "
            f"angles alone: put {small} before what is slow, or change to action and angle first"
        )


def _divisors(
    series: Series, frequencies: Sequence[Expr], module: Module | None, domain: Domain
) -> dict[Harmonic, Expr]:
    """Return k·ω of the terms that the average is to lose."""
    found = {k: _divisor(k, frequencies, domain) for k in series if any(k)}
    return {k: divisor for k, divisor in found.items() if not _stays(k, divisor, module)}


def _check_nonzero(divisors: Mapping[Harmonic, Expr], reached: Averaged) -> None:
    zero = next((k for k, divisor in divisors.items() if divisor == 0), None)
    if zero is not None:
        raise AveragingError(
            f"at order {reached.order + 1} the term of k = {zero} has the divisor k·ω = 0 and is not among the "
            f"resonances; name it: resonances=[{zero}]; the average to order {reached.order} is in `reached` of this "
            "error",
            reached,
        )


def _stays(k: Harmonic, divisor: Expr, module: Module | None) -> bool:
    """Tell whether the term of k belongs to the average: it is slow, or resonant."""
    return not any(k) or (divisor == 0 if module is None else k in module)


def _divisor(k: Harmonic, frequencies: Sequence[Expr], domain: Domain) -> Expr:
    """Return k·ω, 0 where it is proved to vanish on the domain, as √(3 + 2√2) − (1 + √2) does everywhere.

    What is not 0 is divided by. It need not vanish nowhere, as results are meant for parameters in general, but must
    not vanish on a part of the domain that is as large as the domain.

    Raises
    ------
    AveragingError
        Where that was not decided.
    """
    factored: Any = sp.factor(sp.Add(*(j * omega for j, omega in zip(k, frequencies, strict=True))))
    if factored.is_number or not domain.conditions:
        rational = not factored.has(sp.Function) and all(e.exp.is_Integer for e in factored.atoms(sp.Pow))
        if rational:
            return factored
    verdict = vanishes(factored, domain, ZERO_SECONDS)
    if verdict.holds:
        return sp.S.Zero
    if not (verdict.fails and _is_thick(factored, domain)) and not _vanishes_nowhere(factored, domain):
        raise AveragingError(
            f"whether {factored} vanishes, by which the term of k = {k} is divided, was not decided on the domain; "
            "write what it says of the frequencies into H"
        )
    return factored


def _is_thick(divisor: Expr, domain: Domain) -> bool:
    """Tell whether the zeros of what is not zero at one point of the domain are certainly thin in it.

    So it is for a power of a function analytic on a connected set that holds the domain, and for products of such
    powers, where the domain is open in a convex set: one that strict and linear conditions make. Thin sheets, as
    (a − b)(a − 2b) = 0 and (a − b)² (a − 2b)² ≤ 0 leave them, may lie among the zeros.
    """
    thin = (sp.Eq, sp.Ge, sp.Le)
    sheets = [c for c in parts_of(domain.conditions) if isinstance(c, thin) and not linear(c)]
    bases = [factor.as_base_exp()[0] for factor in sp.Mul.make_args(divisor)]
    return not sheets and is_analytic(bases, domain)


def _vanishes_nowhere(divisor: Expr, domain: Domain) -> bool:
    zeros = Domain((*domain.conditions, cast("Boolean", sp.Eq(divisor, 0))), domain.box)
    return proved_sign(divisor, domain) in ("+", "-") or is_empty(zeros, time.monotonic() + ZERO_SECONDS)


def _diagonal(
    column: Sequence[Series], W: Sequence[Series], n: int, bracket: Callable[[Series, Series], Series]
) -> Series:
    """Return f₀⁽ⁿ⁾ of Deprit's triangle without the bracket with Wₙ, which is not known yet."""
    row = [dict(f) for f in column[: n + 1]]
    while len(row) > 1:
        following: list[Series] = []
        for m in range(len(row) - 1):
            total = dict(row[m + 1])
            for j in range(m + 1):
                if j < len(W):
                    for k, c in bracket(row[m - j], W[j]).items():
                        total[k] = total.get(k, sp.S.Zero) + comb(m, j) * c
            following.append({k: value for k, c in total.items() if (value := sp.expand(c)) != 0})
        row = following
    return row[0]


def adiabatic_invariant(averaged: Averaged, action: Symbol | None = None) -> Expr:
    """Return the action of an average as a function of the old variables, to the order: I + ε … .

    Examples
    --------
    >>> theta, I, w, eps = sp.symbols("theta I omega epsilon", positive=True)
    >>> H = Hamiltonian(w * I + eps * I**2 * sp.cos(theta) ** 2, theta, I)
    >>> adiabatic_invariant(average(H, theta, 1, eps))
    I**2*epsilon*cos(2*theta)/(2*omega) + I
    """
    chosen = averaged.actions[0] if action is None else action
    if chosen not in averaged.actions:
        raise ValueError(f"{chosen} is no momentum of a fast angle; those are {averaged.actions}")
    if averaged.K.has(averaged.angles[averaged.actions.index(chosen)]):
        raise ValueError(f"{chosen} is no invariant of the average, which keeps resonant terms in its angle")
    return averaged.from_new(chosen)
