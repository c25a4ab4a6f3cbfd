"""Centre manifolds of equilibria: the motions that neither leave a saddle nor fall into it, to an order, in balls.

The exponents of an equilibrium such as the collinear points of the restricted problem are ±λ, ±iω₁, ±iω₂, irrational
over one another. Lie transforms take every term out of H that does not hold the two variables a, b of each hyperbolic
pair equally often; then a = b = 0 is invariant, and H there is the Hamiltonian of the centre manifold (À. Jorba,
J. Masdemont, Physica D 132, 189 (1999), doi:10.1016/S0167-2789(99)00042-1).
"""

from __future__ import annotations

import operator
from dataclasses import dataclass, field
from math import comb
from typing import TYPE_CHECKING, Any

import sympy as sp
from flint import acb, arb, fmpq
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.user_input import by_symbol, given_expression, given_kind
from canon.frozen_mapping import FrozenMapping
from canon.mechanics.algebra.substitution import exchanged
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.enclosed.enclosed_diagonal import (
    EnclosedDiagonalForm,
    enclosed_diagonal_form,
)
from canon.mechanics.perturbation.enclosed.enclosed_equilibrium import enclosed_equilibrium, enclosed_hessian
from canon.mechanics.perturbation.enclosed.enclosed_lie import (
    enclosed_homological_solution,
    enclosed_transformed,
)
from canon.mechanics.perturbation.enclosed.enclosed_polynomial import FixedPointRing, PrecisionError
from canon.mechanics.perturbation.enclosed.enclosed_series import enclosed_parts
from canon.mechanics.perturbation.enclosed.graded_polynomial import GradedPolynomial, PairBrackets, graded
from canon.mechanics.perturbation.taylor_parts import refuse_kinks
from canon.proof.domain.balls import precision, value

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.mechanics.perturbation.enclosed.enclosed_polynomial import EnclosedPolynomial

__all__ = ["CentreManifold", "centre_manifold"]

MOST_TERMS = 300_000
"""Terms of one homogeneous part beyond which it is not begun: some gigabytes with its products."""
MOST_BITS = 4_096
"""Bits beyond which digits are given up."""
GUARD = 64
"""Bits of the balls beyond those of the coefficients."""


@dataclass(frozen=True)
class CentreManifold:
    """The centre manifold of an equilibrium to a degree, with its Hamiltonian.

    Parameters
    ----------
    source
        The Hamiltonian.
    order
        The highest degree of the Hamiltonian on the manifold.
    digits
        Digits after the point that are certain in every coefficient.
    equilibrium
        Balls that hold it, by variable.
    diagonal
        Williamson's variables there.
    parts
        The parts of degree 2 … order of the Hamiltonian on the manifold, in z₁ … zₘ, z̄₁ … z̄ₘ of the elliptic pairs.
    generators
        Degree and generator of each step, in all variables (a, b).
    """

    source: Hamiltonian
    order: int
    digits: int
    equilibrium: Mapping[Symbol, arb]
    diagonal: EnclosedDiagonalForm
    parts: Mapping[int, EnclosedPolynomial] = field(repr=False)
    generators: tuple[tuple[int, GradedPolynomial], ...] = field(repr=False)

    @property
    def bits(self) -> int:
        """The precision that the balls were computed with."""
        return self.parts[2].ring.bits + GUARD

    @property
    def frequencies(self) -> tuple[arb, ...]:
        """ω of each elliptic pair in a ball, negative where H₂ has the action with a minus sign; its size falls."""
        with precision(self.bits):
            return self.diagonal.frequencies

    @property
    def rates(self) -> tuple[arb, ...]:
        """λ of each hyperbolic pair in a ball."""
        return tuple(e.real for e in self.diagonal.exponents[: self.diagonal.hyperbolic])

    @property
    def error(self) -> float:
        """A bound on the error of every coefficient."""
        return max(part.bound for part in self.parts.values())

    @cached_property
    def coefficients(self) -> dict[tuple[int, ...], acb]:
        """The coefficients of the Hamiltonian in balls, by the exponents of z₁ … zₘ, z̄₁ … z̄ₘ."""
        with precision(self.bits):
            return {k: c for part in self.parts.values() for k, c in part.coefficients.items()}

    @cached_property
    def q(self) -> tuple[Symbol, ...]:
        """Coordinates Q₁ … Qₘ on the manifold: z = Q + i P."""
        return tuple(Symbol(f"Q{j + 1}", real=True) for j in range(len(self.frequencies)))

    @cached_property
    def p(self) -> tuple[Symbol, ...]:
        """Momenta P₁ … Pₘ on the manifold."""
        return tuple(Symbol(f"P{j + 1}", real=True) for j in range(len(self.frequencies)))

    @cached_property
    def hamiltonian(self) -> Hamiltonian:
        """The Hamiltonian on the manifold in (Q, P), its coefficients rounded beyond the digits that are certain.

        Raises
        ------
        PrecisionError
            Where an error, in these variables, is more than the digits allow.
        ValueError
            Where no direction is elliptic.
        """
        if not self.q:
            raise ValueError("no direction is elliptic, so that the centre manifold is the equilibrium alone")
        return Hamiltonian(self._in_real_variables(self.parts), self.q, self.p)

    @cached_property
    def embedding(self) -> dict[Symbol, Expr]:
        """The old variables (q, p) as polynomials of degree order − 1 in (Q, P).

        Raises
        ------
        PrecisionError
            Where an error of a coefficient is more than the digits allow.
        """
        return {z: self._embedded(j, z) for j, z in enumerate((*self.source.q, *self.source.p))}

    def _embedded(self, j: int, z: Symbol) -> Expr:
        form = self.diagonal
        n, h = len(form.exponents), form.hyperbolic
        ring, brackets = FixedPointRing(2 * n, self.parts[2].ring.bits, h), PairBrackets(h, n - h)
        with precision(self.bits):
            parts = {1: graded(ring.linear(form.columns[j]), 1)}
            for degree, chi in self.generators:
                parts = enclosed_transformed(parts, chi, degree, self.order - 1, brackets)
            kept = {d: _on_manifold(part) for d, part in parts.items()}
        return self._rounded(self.equilibrium[z]) + self._in_real_variables(kept)

    def _rounded(self, number: arb) -> Expr:
        with precision(self.bits):
            self._refuse_wide(float(number.rad()))
            middle = number.mid()
            text = "0" if abs(middle) < arb(10) ** -self.digits else middle.str(self.digits + 8, radius=False)
        return sp.Float(text, self.digits + 8) if text != "0" else sp.S.Zero

    def _refuse_wide(self, error: float) -> None:
        if not error <= 10.0**-self.digits:
            raise PrecisionError(
                f"a coefficient is known to within {error:.1e}, not 1e-{self.digits}; "
                "give centre_manifold more digits"
            )

    def _in_real_variables(self, parts: Mapping[int, EnclosedPolynomial]) -> Expr:
        """Return a real polynomial in z = Q + i P, z̄ = Q − i P; what is zero to the digits is left out."""
        m, symbols = len(self.q), (*self.q, *self.p)
        total: dict[tuple[int, ...], acb] = {}
        with precision(self.bits):
            for degree, part in parts.items():
                # (Q + iP)ᵏ (Q − iP)ˡ has no coefficient above 2ᵏ⁺ˡ: this bounds the terms that have no ball too
                self._refuse_wide(part.bound * 2.0**degree)
                for powers, c in part.coefficients.items():
                    for real, factor in _expanded(powers, m).items():
                        total[real] = total.get(real, acb(0)) + c * factor
        ordered = sorted(total.items(), key=lambda item: (sum(item[0]), item[0]))
        return sp.Add(
            *(
                self._rounded(c.real) * sp.Mul(*(s**k for s, k in zip(symbols, powers, strict=True)))
                for powers, c in ordered
            )
        )


def centre_manifold(
    H: Hamiltonian,
    order: int,
    at: Mapping[Symbol, Any] | None = None,
    parameters: Mapping[Symbol, Any] | None = None,
    digits: int = 15,
) -> CentreManifold:
    """Return the centre manifold of an equilibrium with hyperbolic and elliptic directions, with certain digits.

    Any consistent units.

    Parameters
    ----------
    H
        A Hamiltonian without the time in it, of powers, exponentials, logarithms, sines and cosines; floats are taken
        as what they are.
    order
        The highest degree, from 2, of the Hamiltonian on the manifold.
    at
        The equilibrium or a place near it, by variable or its name: Newton's iteration goes on from there. 0 for those
        not named.
    parameters
        Values of all other symbols; exact ones, as ``Rational``, are taken exactly, floats as what they are.
    digits
        Digits after the point that should be certain.

    Raises
    ------
    ValueError
        For an order below 2, a time in H, a symbol without value, a place of what is no variable, or an equilibrium
        without hyperbolic directions.
    NoDiagonalFormError
        Where exponents are zero, equal, or four belong together.
    NotAnalyticError
        Where H has no Taylor series there.
    PrecisionError
        Where no precision up to 4096 bits gives the digits, or no equilibrium is proved.

    Examples
    --------
    >>> x, y, px, py = sp.symbols("x y p_x p_y", real=True)
    >>> saddle = Hamiltonian((px**2 - x**2 + py**2 + 2 * y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py])
    >>> found = centre_manifold(saddle, 4)
    >>> round(float(found.rates[0]), 12), round(float(found.frequencies[0]), 12), found.error < 1e-15
    (1.0, 1.414213562373, True)
    >>> found.hamiltonian.H.coeff(found.q[0], 3).evalf(8)
    -0.19820119
    """
    given_kind(H, Hamiltonian, "H", "give Hamiltonian(H, q, p)")
    if not hasattr(order, "__index__") or operator.index(order) < 2:
        raise ValueError(f"the order should be a whole number from 2, not {order!r}")
    if not hasattr(digits, "__index__") or not 1 <= operator.index(digits) <= 300:
        raise ValueError(f"digits should be from 1 to 300, not {digits!r}")
    if H.H.has(H.t):
        raise ValueError("H depends on the time; take (t, −E) as another pair of variables, or average it")
    n = len(H.q)
    if comb(order + 2 * n - 1, 2 * n - 1) > MOST_TERMS:
        raise ValueError(
            f"degree {order} in {2 * n} variables may have {comb(order + 2 * n - 1, 2 * n - 1)} terms, more than "
            "memory holds; take a lower order"
        )
    place = by_symbol(at or {}, (*H.q, *H.p), "at")
    refuse_kinks(H.H, (*H.q, *H.p))
    floats = {x: sp.Rational(x) for x in H.H.atoms(sp.Float)}
    exact = Hamiltonian(exchanged(H.H, floats), H.q, H.p, H.t) if floats else H
    bits = 32 + int(3.33 * digits) + 8 * order
    while True:
        try:
            found = _at_precision(exact, order, place, parameters or {}, digits, bits)
        except PrecisionError:
            if 2 * bits > MOST_BITS:
                raise
        else:
            if found.error < 10.0 ** -(digits + 1):
                return found
            if 2 * bits > MOST_BITS:
                raise PrecisionError(
                    f"{MOST_BITS} bits give an error bound of {found.error:.1e} only; "
                    "take a lower order or fewer digits"
                )
        bits *= 2


def _at_precision(
    H: Hamiltonian,
    order: int,
    at: Mapping[Symbol, Any],
    parameters: Mapping[Symbol, Any],
    digits: int,
    bits: int,
) -> CentreManifold:
    variables = (*H.q, *H.p)
    n = len(H.q)
    with precision(bits + GUARD):
        constants = {s: acb(_number(c, f"the parameter {s}")) for s, c in parameters.items()}
        unknown = sorted(map(str, H.H.free_symbols - {*variables, *constants}))
        if unknown:
            raise ValueError(f"{', '.join(unknown)} has no value; give it in parameters={{…}}")
        near = [_number(at.get(z, 0), f"the place of {z}") for z in variables]
        place = enclosed_equilibrium(H.H, variables, near, constants)
        values = {**constants, **{z: acb(x) for z, x in zip(variables, place, strict=True)}}
        form = enclosed_diagonal_form(enclosed_hessian(H.H, variables, values))
        if not form.hyperbolic:
            raise ValueError(
                "the equilibrium has no hyperbolic direction, so that all is centre manifold; use birkhoff_normal_form"
            )
        ring = FixedPointRing(2 * n, bits, form.hyperbolic)
        displacements = {z: ring.linear(column) for z, column in zip(variables, form.columns, strict=True)}
        series = dict(enumerate(enclosed_parts(H.H, displacements, values, order)))
        parts, generators = _reduced(series, form, ring, order)
        kept = {d: _on_manifold(part) for d, part in parts.items()}
    equilibrium = FrozenMapping(dict(zip(variables, place, strict=True)))
    return CentreManifold(H, order, digits, equilibrium, form, kept, tuple(generators))


def _number(given: Any, name: str) -> arb:
    """Return a real number in a ball; a float stands for itself."""
    exact = given_expression(given, name)
    if isinstance(exact, sp.Float):
        ratio: Any = sp.Rational(exact)
        return arb(fmpq(int(ratio.p), int(ratio.q)))
    if exact.free_symbols or exact.is_real is False:
        raise ValueError(f"{name} should be a real number, not {exact}")
    return value(exact, {}).real


def _reduced(
    series: dict[int, EnclosedPolynomial], form: EnclosedDiagonalForm, ring: FixedPointRing, order: int
) -> tuple[dict[int, GradedPolynomial], list[tuple[int, GradedPolynomial]]]:
    """Return H with every a of a hyperbolic pair as often as its b, and the generators that lead there."""
    n, h = len(form.exponents), form.hyperbolic
    brackets = PairBrackets(h, n - h)
    series[2] = _quadratic(form, ring)
    parts = {d: graded(f, order + 1 - d) for d, f in series.items() if d > 1}
    generators: list[tuple[int, GradedPolynomial]] = []
    known: dict[tuple[int, ...], acb] = {}
    for degree in range(3, order + 1):
        part = parts[degree]
        kept, chi = enclosed_homological_solution(part, degree, form.exponents, known)
        parts = enclosed_transformed(parts, chi, degree, order, brackets, {2: kept - part})
        parts[degree] = kept
        generators.append((degree, chi))
    return parts, generators


def _quadratic(form: EnclosedDiagonalForm, ring: FixedPointRing) -> EnclosedPolynomial:
    """Return H₂ = Σ λ a b + Σ ω z z̄/2."""
    n, total = len(form.exponents), ring.zero
    for j, e in enumerate(form.exponents):
        factor = acb(e.real) if j < form.hyperbolic else acb(-e.imag / 2)
        total = total + ring.constant(factor) * ring.variable(j) * ring.variable(n + j)
    return total


def _on_manifold(f: GradedPolynomial) -> EnclosedPolynomial:
    """Return what is left of a polynomial where a = b = 0, in the variables of the elliptic pairs alone."""
    n, h = f.ring.size // 2, f.ring.hyperbolic
    ring, kept = FixedPointRing(2 * (n - h), f.ring.bits), f.grade(0)
    re, im = (
        {(*map(int, k[h:n]), *map(int, k[n + h :])): int(c) for k, c in part.to_dict().items()}
        for part in (kept.re, kept.im)
    )
    return ring.polynomial(re, im, f.error)


def _expanded(powers: Sequence[int], m: int) -> dict[tuple[int, ...], acb]:
    """Return the polynomial in Q₁ … Qₘ, P₁ … Pₘ that a product of powers of z and z̄ is."""
    total: dict[tuple[int, ...], acb] = {(0,) * (2 * m): acb(1)}
    for j in range(m):
        k, l = powers[j], powers[m + j]
        single: dict[int, acb] = {}
        for r in range(k + 1):
            for s in range(l + 1):
                single[r + s] = (
                    single.get(r + s, acb(0)) + comb(k, r) * comb(l, s) * acb(0, 1) ** r * acb(0, -1) ** s
                )
        following: dict[tuple[int, ...], acb] = {}
        for exponents, c in total.items():
            for r, d in single.items():
                e = [*exponents]
                e[j] += k + l - r
                e[m + j] += r
                following[tuple(e)] = c * d
        total = following
    return total
