"""Birkhoff's and Gustavson's normal form of a Hamiltonian at an equilibrium, to a degree, exactly."""

from __future__ import annotations

import operator
from dataclasses import dataclass, field
from math import comb, isnan
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.user_input import by_symbol, free_name, given_expression, given_kind
from canon.mechanics.algebra.substitution import entry, substitute, symbols_of
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.coefficient_field import ring_over
from canon.mechanics.perturbation.lie_transform import chain, transformed
from canon.mechanics.perturbation.normal_form_step import (
    Divisors,
    Module,
    SmallDivisor,
    ZeroDivisorError,
    homological_solution,
    whole_vector,
)
from canon.mechanics.perturbation.quadratic_form import DiagonalForm, characteristic_exponents, diagonal_form
from canon.mechanics.perturbation.taylor_parts import (
    NotAnalyticError,
    constants_in,
    homogeneous_parts,
    refuse_kinks,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial

__all__ = ["NormalForm", "NormalFormError", "birkhoff_normal_form"]

MOST_TERMS = 3_000_000
"""Terms of one homogeneous part beyond which it is not begun: about a gigabyte with its products."""


class NormalFormError(ValueError):
    """Raised where a normal form ends before the order that was asked for.

    Parameters
    ----------
    message
        Why, and what to do instead.
    reached
        The normal form to the last order that was finished; None where there is none.
    """

    def __init__(self, message: str, reached: NormalForm | None = None) -> None:
        super().__init__(message)
        self.reached = reached


@dataclass(frozen=True)
class NormalForm:
    """The normal form K = K₂ + … of a Hamiltonian to a degree, and the map that leads to it.

    Parameters
    ----------
    source
        The Hamiltonian.
    equilibrium
        Where it is expanded, by variable.
    order
        The highest degree in (q, p).
    resonances
        The module whose terms stay, as it was given; None for all with k·λ = 0.
    diagonal
        The variables (a, b) of Williamson's form.
    original
        The homogeneous parts of H in (a, b).
    parts
        Those of the normal form.
    generators
        Lowest degree and generator χ of each step; exp(L_χ) of all of them, one after another, takes H to K.
    small_divisors
        The divisors k·λ that were divided by, smallest first, and behind them those that depend on parameters.
    """

    source: Hamiltonian
    equilibrium: Mapping[Symbol, Expr]
    order: int
    resonances: tuple[tuple[int, ...], ...] | None
    diagonal: DiagonalForm
    original: Mapping[int, PhasePolynomial] = field(repr=False)
    parts: Mapping[int, PhasePolynomial] = field(repr=False)
    generators: tuple[tuple[int, PhasePolynomial], ...] = field(repr=False)
    small_divisors: tuple[SmallDivisor, ...] = field(repr=False)

    @property
    def frequencies(self) -> tuple[Expr, ...]:
        """ω of each elliptic pair, negative where H₂ has the action with a minus sign; λ of the others."""
        return tuple(self.diagonal.frequency(j) for j in range(len(self.source.q)))

    @cached_property
    def complex_variables(self) -> tuple[Symbol, ...]:
        """Symbols of (a, b): z₁ … zₙ, z̄₁ … z̄ₙ where all pairs are elliptic."""
        n = len(self.source.q)
        return tuple(Symbol(f"{letter}{j + 1}") for letter in ("z", "zbar") for j in range(n))

    @cached_property
    def K(self) -> Expr:
        """The normal form in the complex variables z = q + i p, z̄ = q − i p (scaled), as one expression."""
        ring = self.diagonal.eigenvalues[0].ring
        return sp.Add(*(ring.expression(f, self.complex_variables) for f in self.parts.values()))

    def in_variables(self, q: Sequence[Symbol] | None = None, p: Sequence[Symbol] | None = None) -> Expr:
        """Return K in the real new variables; they have the names of the old ones unless others are given."""
        return self.expression(self.parts, q, p)

    def expression(
        self,
        parts: Mapping[int, PhasePolynomial],
        q: Sequence[Symbol] | None = None,
        p: Sequence[Symbol] | None = None,
    ) -> Expr:
        """Return a polynomial in (a, b), given by its homogeneous parts, in real variables (q, p)."""
        symbols = (*(q or self.source.q), *(p or self.source.p))
        ring = self.diagonal.eigenvalues[0].ring
        return sp.Add(*(ring.expression(f.composed(self.diagonal.rows), symbols) for f in parts.values()))

    @cached_property
    def actions(self) -> tuple[Symbol, ...]:
        """Symbols I₁ … Iₙ of the actions, with an underscore behind them where H has a parameter of that name."""
        taken = {s.name for s in symbols_of(self.source.H)}
        return tuple(Symbol(free_name(f"I{j + 1}", taken), real=True) for j in range(len(self.source.q)))

    def in_actions(self) -> Expr:
        """Return K as a function of the actions Iⱼ = z z̄/(2κ), or a b of a hyperbolic pair.

        Raises
        ------
        NormalFormError
            Where the normal form has resonant terms, which depend on angles.
        """
        n = len(self.source.q)
        ring = self.diagonal.eigenvalues[0].ring
        total = sp.S.Zero
        units = [ring.expression(self.diagonal.action(j), [sp.S.One] * 2 * n) for j in range(n)]
        for part in self.parts.values():
            for exponents, term in part.split(lambda e: tuple(map(int, e))).items():
                if exponents[:n] != exponents[n:]:
                    raise NormalFormError(
                        "the normal form has resonant terms, so it is no function of the actions alone; "
                        "read K or in_variables()",
                        self,
                    )
                powers = ((I / u) ** k for I, u, k in zip(self.actions, units, exponents[:n], strict=True))
                total += ring.expression(term.coefficient_alone(), [sp.S.One] * 2 * n) * sp.Mul(*powers)
        return sp.collect(sp.expand(total), self.actions)

    def amplitude_frequencies(self) -> tuple[Expr, ...]:
        """Return ∂K/∂I: how frequencies depend on the actions, the series of Lindstedt and Poincaré."""
        K = self.in_actions()
        return tuple(sp.expand(K.diff(I)) for I in self.actions)

    def to_normal(self, f: Mapping[int, PhasePolynomial]) -> dict[int, PhasePolynomial]:
        """Return a function of the old variables in terms of the new ones, to the order."""
        return chain(f, self.generators, self.order, self.diagonal.brackets)

    def from_normal(self, f: Mapping[int, PhasePolynomial]) -> dict[int, PhasePolynomial]:
        """Return a function of the new variables in terms of the old ones, to the order."""
        backwards = [(degree, -chi) for degree, chi in reversed(self.generators)]
        return chain(f, backwards, self.order, self.diagonal.brackets)


def birkhoff_normal_form(
    H: Hamiltonian,
    order: int,
    resonances: Sequence[Sequence[int]] | None = None,
    at: Mapping[Symbol, Expr] | None = None,
    *,
    superconvergent: bool = False,
) -> NormalForm:
    """Return the normal form of a Hamiltonian at an equilibrium to a degree in (q, p), exactly.

    With H₂ diagonal, exp(L_χ) with {χ, H₂} = the terms of H_s whose divisor k·λ is not zero removes them, for s = 3 …
    order; what stays commutes with H₂ (G. D. Birkhoff, Dynamical Systems, ch. III; F. G. Gustavson, Astron. J. 71, 670
    (1966), doi:10.1086/110172; A. Deprit, Celest. Mech. 1, 12 (1969), doi:10.1007/BF01230629). Any consistent units.

    Parameters
    ----------
    H
        A Hamiltonian without the time in it, analytic at the equilibrium.
    order
        The highest degree, at least 2.
    resonances
        Vectors k that span the module of terms that are kept, near-resonances among them; without them every term with
        k·λ = 0 exactly is kept, and no other.
    at
        The equilibrium, by variable or its name; 0 for those not named.
    superconvergent
        Take Kolmogorov's steps: from degree N one exp(L_χ) with χ = χ_{N+1} + … + χ_{2N−1}, {χ, K} = the rest of H to
        first order, leads to degree 2N − 1, so that three steps reach 5 and six 33. The normal form is the same up to
        what is free, and where nothing resonates the same (A. N. Kolmogorov, Dokl. Akad. Nauk SSSR 98, 527 (1954)).

    Raises
    ------
    NormalFormError
        Where the point is no equilibrium, a divisor is zero for a k outside ``resonances``, or the next order has more
        terms than fit into memory; ``reached`` keeps what was found.
    NoDiagonalFormError, NoExactFieldError, NotAnalyticError
        Where H₂ is not semisimple, the coefficients are in no field, or H has no Taylor series.
    ValueError
        Where H depends on the time, ``at`` names what is no variable, or a resonance is no vector of whole numbers.

    Examples
    --------
    >>> x, y, px, py = sp.symbols("x y p_x p_y", real=True)
    >>> H = Hamiltonian((px**2 + py**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py])
    >>> birkhoff_normal_form(H, 4).K.coeff(sp.Symbol("z1"), 2).coeff(sp.Symbol("zbar1"), 2)
    -5/48
    >>> q, p = sp.symbols("q p", real=True)
    >>> birkhoff_normal_form(Hamiltonian(p**2 / 2 - sp.cos(q), q, p), 6).in_actions()
    -I1**3/256 - I1**2/16 + I1 - 1
    """
    given_kind(H, Hamiltonian, "H", "give Hamiltonian(H, q, p)")
    if not hasattr(order, "__index__") or operator.index(order) < 2:
        raise ValueError(f"the order should be a whole number from 2, not {order!r}")
    variables = (*H.q, *H.p)
    if H.H.has(H.t):
        raise ValueError("H depends on the time; take (t, −E) as another pair of variables, or average it")
    given_place = by_symbol(at or {}, variables, "at")
    place = {z: given_expression(given_place.get(z, 0), f"the place of {z}") for z in variables}
    moved = substitute(
        sp.nsimplify(H.H, rational=True), {z: place[z] + z for z in variables if place[z] != 0}
    )
    refuse_kinks(moved, variables)
    hessian = _hessian(moved, variables)
    exponents = characteristic_exponents(hessian)
    constants = [*constants_in(moved, variables), *hessian.flat()]
    constants += [part for exponent, _ in exponents for part in exponent.as_real_imag()]
    ring = ring_over(constants, len(variables))
    exact = [
        [ring.number(entry(hessian, i, j)) for j in range(len(variables))] for i in range(len(variables))
    ]
    diagonal = diagonal_form(exact, exponents, ring)
    series = homogeneous_parts(moved, variables, ring, order)
    original = {d: part.composed(diagonal.columns) for d, part in series.items() if d != 1}
    module = None if resonances is None else Module(_vectors(resonances, len(H.q)))
    return _normalised(H, place, order, module, diagonal, original, superconvergent)


def _hessian(H: Expr, variables: Sequence[Symbol]) -> sp.Matrix:
    """Return ∂²H at 0, which is an equilibrium."""
    origin = dict.fromkeys(variables, sp.S.Zero)
    slopes = [H.diff(z) for z in variables]
    forces = [substitute(f, origin) for f in slopes]
    for z, force in zip(variables, forces, strict=True):
        if force.has(sp.nan, sp.zoo, sp.oo):
            raise NormalFormError(
                f"∂H/∂{z} has no value at the point; take an equilibrium where H is analytic"
            )
        if force.equals(0) is not True:
            raise NormalFormError(
                f"the point is no equilibrium: ∂H/∂{z} = {force} there; give one with at={{…}}"
            )
    curvature = sp.Matrix([[substitute(f.diff(z), origin) for z in variables] for f in slopes])
    if curvature.has(sp.nan, sp.zoo, sp.oo):
        raise NotAnalyticError("∂²H has no value at the point, so H has no Taylor series there")
    return curvature.applyfunc(sp.factor)


def _vectors(resonances: Sequence[Sequence[int]], n: int) -> tuple[tuple[int, ...], ...]:
    return tuple(whole_vector(k, n, "each of the resonances", "degree of freedom") for k in resonances)


def _normalised(
    H: Hamiltonian,
    place: Mapping[Symbol, Expr],
    order: int,
    module: Module | None,
    diagonal: DiagonalForm,
    original: dict[int, PhasePolynomial],
    superconvergent: bool,
) -> NormalForm:
    size = 2 * len(H.q)
    values = [None if e.free_symbols else complex(e.evalf()) for e in diagonal.exponents]
    divisors = Divisors(diagonal.eigenvalues, values, module)
    divided_by: dict[tuple[int, ...], SmallDivisor] = {}
    generators: list[tuple[int, PhasePolynomial]] = []
    parts = dict(original)
    named = None if module is None else module.resonances

    def result(reached: int) -> NormalForm:
        kept = {d: f for d, f in parts.items() if d <= reached}
        steps = tuple((d, chi) for d, chi in generators if d <= reached)
        small = tuple(sorted(divided_by.values(), key=lambda s: (isnan(s.value), s.value)))
        return NormalForm(H, place, reached, named, diagonal, original, kept, steps, small)

    reached = 2
    while reached < order:
        top = min(2 * reached - 1, order) if superconvergent else reached + 1
        _check_size(range(reached + 1, top + 1), size, result, reached)
        try:
            chi, met = _step(parts, reached, top, diagonal, divisors)
        except ZeroDivisorError as zero:
            raise _ended(str(zero), result(reached)) from zero
        for small in met:
            divided_by.setdefault(small.weight, small)
        if chi:
            whole = diagonal.eigenvalues[0].ring.total(chi.values())
            generators.append((min(chi), whole))
            parts = transformed(parts, whole, min(chi), order, diagonal.brackets)
        reached = top
    return result(order)


def _step(
    parts: Mapping[int, PhasePolynomial], reached: int, top: int, diagonal: DiagonalForm, divisors: Divisors
) -> tuple[dict[int, PhasePolynomial], list[SmallDivisor]]:
    """Return the parts of χ that take H, normal to a degree, to first order to a higher one, and what divided them."""
    chi: dict[int, PhasePolynomial] = {}
    divided_by: list[SmallDivisor] = []
    for degree in range(reached + 1, top + 1):
        rest = _to_first_order(parts, chi, degree, reached, diagonal)
        try:
            _, solution, met = homological_solution(rest, divisors)
        except ZeroDivisorError as zero:
            raise ZeroDivisorError(f"at degree {degree} {zero}") from zero
        divided_by += [SmallDivisor(_either_sign(k), value, degree) for k, value in met.items()]
        if solution:
            chi[degree] = solution
    return chi, divided_by


def _check_size(degrees: range, size: int, result: Callable[[int], NormalForm], reached: int) -> None:
    """Refuse a step to degrees that have more terms than memory holds."""
    for degree in degrees:
        terms = comb(degree + size - 1, size - 1)
        if terms > MOST_TERMS:
            raise _ended(f"degree {degree} may have {terms} terms, more than memory holds", result(reached))


def _to_first_order(
    parts: Mapping[int, PhasePolynomial],
    chi: Mapping[int, PhasePolynomial],
    degree: int,
    reached: int,
    diagonal: DiagonalForm,
) -> PhasePolynomial:
    """Return the part of this degree of H + {K, χ}, without {H₂, χ}, for the χ of one step that are known."""
    rest = parts.get(degree, diagonal.eigenvalues[0].ring.zero)
    for s, f in chi.items():
        known = parts.get(degree - s + 2)
        if known is not None and degree - s + 2 <= reached:
            rest = rest + diagonal.brackets(known, f)
    return rest


def _ended(why: str, reached: NormalForm) -> NormalFormError:
    kept = f"the normal form to degree {reached.order} is in `reached` of this error"
    return NormalFormError(f"{why}; {kept}", reached)


def _either_sign(k: tuple[int, ...]) -> tuple[int, ...]:
    return max(k, tuple(-j for j in k))
