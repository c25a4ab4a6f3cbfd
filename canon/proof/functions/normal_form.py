"""Normal form of SymPy expressions: fractions over a tower of generators.

Every rewriting is an identity of principal branches that holds wherever its left side is defined; the
docstring of each rule says why. Whatever has no rule becomes an opaque kernel, known only by its name and
the normal forms of its arguments, which is always sound: equal functions of equal arguments are equal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from flint import arb, fmpq
from sympy.core.function import AppliedUndef, Derivative, Subs

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.declarations import declared_complex
from canon.proof.domain.limits import THOROUGH, Limits
from canon.proof.domain.reality import certainly_real
from canon.proof.functions import (
    angles,
    arcs,
    complex_parts,
    elliptic,
    elliptic_arcs,
    gammas,
    jacobi_addition,
    large_powers,
    powers,
    waves,
)
from canon.proof.tower.forms import Forms

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    from flint import fmpq_mpoly
    from sympy import Expr

    from canon.proof.domain.domain import Domain
    from canon.proof.tower.tower import Fraction

__all__ = ["NormalForm"]


class NormalForm(Forms):
    """Normal forms of expressions over one tower; parameters as for :class:`~canon.proof.tower.forms.Forms`."""

    def __init__(
        self,
        domain: Domain,
        parts: dict[Hashable, Any],
        deadline: float = float("inf"),
        limits: Limits = THOROUGH,
        capacity: int = 16,
    ) -> None:
        super().__init__(domain, parts, deadline, limits, capacity)
        self._memo: dict[sp.Basic, Fraction] = {}
        self._gaps: list[tuple[fmpq_mpoly, bool]] = []
        for condition in domain.conditions:
            self._learn(condition)
        if len(self._gaps) > 1:
            self.empty = self.empty or any(self.signs.contradicts(p, strict=s) for p, s in self._gaps)

    def _learn(self, condition: sp.Basic) -> None:
        """Take p > 0 or p ≥ 0 from an inequality; notice when the facts before contradict it.

        A fraction has the zeros of its numerator, unless its denominator is a power that may be infinite.
        """
        if condition == sp.false:
            self.empty = True
        elif isinstance(condition, sp.And):
            for part in condition.args:
                self._learn(part)
        elif isinstance(condition, sp.Eq) and isinstance(condition.lhs, sp.Expr):
            gap = self.form(condition.lhs - cast("Expr", condition.rhs))
            if not self._may_be_infinite(gap):
                powers.learn_zero(self, gap.num)
        elif isinstance(condition, sp.Ne) and isinstance(condition.lhs, sp.Expr):
            gap = self.form(condition.lhs - condition.rhs)
            if gap.num.is_zero():
                self.empty = True
            elif not self._may_be_infinite(gap):
                self.signs.learn_nonzero(gap.num)
        elif isinstance(condition, sp.StrictLessThan | sp.LessThan | sp.StrictGreaterThan | sp.GreaterThan):
            gap = self.form(cast("Expr", condition.gts) - cast("Expr", condition.lts))
            if not self._may_be_infinite(gap):
                self._learn_positive(gap, isinstance(condition, sp.StrictLessThan | sp.StrictGreaterThan))

    def _learn_positive(self, gap: Fraction, strict: bool) -> None:
        """Take from gap > 0 or gap ≥ 0 what it says of the numerator, where the sign below it is known."""
        below = self.signs.of(self.denominator(gap)) if gap.den else "+"
        if below not in ("+", "-"):
            return
        above = (gap if below == "+" else self.negative(gap)).num
        known = self.signs.of(above)
        self.empty = self.empty or known == "-" or (strict and (known == "0-" or above.is_zero()))
        if not known.endswith("+"):
            self._gaps.append((above, strict))
            self.signs.learn(above, strict=strict)

    def _may_be_infinite(self, f: Fraction) -> bool:
        """Tell whether the denominator holds exp(y log u), which stands for 1/u^−y also at u = 0."""
        return any(self.powers_of_zero.intersection(self.tower.used(self.tower.base(i))) for i, _ in f.den)

    def sign_of_constant(self, p: fmpq_mpoly) -> str:
        """Return the proven sign of a polynomial in numbers, or in waves of one frequency."""
        if not all(self.is_constant(k) for k in self.tower.used(p)):
            return waves.sign_of_polynomial(self, p)
        expr = self.expression(p)
        for bits in (64, 256, 1024):
            with precision(bits):
                try:
                    ball = value(expr, {})
                except (NotDecided, Undefined, Unmodelled):
                    continue
                if not ball.imag.contains(0):
                    return ""
                real: arb = ball.real
                if real > 0:
                    return "+"
                if real < 0:
                    return "-"
        return ""

    # -- functions -------------------------------------------------------------------------------

    def root(self, f: Fraction, exponent: fmpq) -> Fraction:
        """Return f**exponent, the principal value."""
        return powers.root(self, f, exponent)

    def exponential(self, f: Fraction) -> Fraction:
        """Return exp(f)."""
        return powers.exponential(self, f)

    def logarithm(self, f: Fraction) -> Fraction:
        """Return log(f), the principal value."""
        return powers.logarithm(self, f)

    def modulus(self, f: Fraction) -> Fraction:
        """Return |f|."""
        return powers.modulus(self, f)

    def cos_sin_of_arc(self, kernel: tuple[object, ...], r: fmpq) -> tuple[Fraction, Fraction] | None:
        """Return cos and sin of r times an inverse circular function, where there is a rule."""
        return arcs.cos_sin_of_arc(self, kernel, r) or elliptic_arcs.cos_sin_of_amplitude(self, kernel, r)

    # -- recursion -------------------------------------------------------------------------------

    def form(self, expr: sp.Basic) -> Fraction:
        """Return the normal form of an expression."""
        found = self._memo.get(expr)
        if found is None:
            self.tower.check_time()
            found = self._memo[expr] = self._fresh(expr)
        return found

    def _fresh(self, expr: sp.Basic) -> Fraction:
        t = self.tower
        match expr:
            case sp.Rational():
                return t.number(fmpq(int(expr.p), int(expr.q)))
            case sp.Symbol():
                return self.atom(("symbol", expr), _declared_sign(expr), lambda: expr)
            case sp.Add():
                return t.sum(self.form(term) for term in expr.args)
            case sp.Mul():
                return t.times(*(self.form(factor) for factor in expr.args))
            case sp.Pow():
                return self._power(expr)
            case sp.exp():
                return powers.exponential(self, self.form(expr.args[0]))
            case sp.log() if len(expr.args) == 1:
                return powers.logarithm(self, self.form(expr.args[0]))
            case sp.Abs():
                return powers.modulus(self, self.form(expr.args[0]))
            case sp.sign():
                return complex_parts.sign_function(self, expr) or self._opaque(expr)
            case _ if expr is sp.pi:
                return self.pi
            case _ if expr is sp.I:
                return self.imaginary_unit
            case _ if expr is sp.E:
                return powers.exponential(self, t.number(1))
            case _ if expr is sp.GoldenRatio:
                return self.form((1 + sp.sqrt(5)) / 2)
            case _:
                pass
        elementary = (
            angles.elementary(self, expr)
            or arcs.elementary(self, expr)
            or complex_parts.elementary(self, expr)
            or gammas.elementary(self, expr)
            or elliptic.elementary(self, expr)
            or elliptic_arcs.elementary(self, expr)
            or jacobi_addition.elementary(self, expr)
        )
        return self._opaque(expr) if elementary is None else elementary

    def _power(self, expr: sp.Pow) -> Fraction:
        """Return a power; b^e = exp(e log b) is its definition for b ≠ 0.

        At b = 0 the functions x^e with e ≥ 0 are continuous from the right and the others are undefined,
        so an identity of powers extends there.
        """
        base, exponent = expr.args
        if isinstance(exponent, sp.Integer):
            return large_powers.power(self, self.form(base), int(exponent))
        if isinstance(exponent, sp.Rational):
            return powers.root(self, self.form(base), fmpq(int(exponent.p), int(exponent.q)))
        logarithm = powers.logarithm(self, self.form(base), whole_powers=bool(exponent.is_integer))
        return powers.exponential(self, self.tower.times(self.form(exponent), logarithm))

    def _opaque(self, expr: sp.Basic) -> Fraction:
        """Return a kernel that is equal for equal functions of equal arguments."""
        if isinstance(expr, Derivative | Subs) and expr.has(AppliedUndef):
            key, real = _derivative_key(expr, self)
            return self.atom(key, "real" if real else "", lambda: cast("Expr", expr))
        if not isinstance(expr, sp.Function) or not expr.args:
            known_real = cast("Expr", expr).is_real
            return self.atom(("opaque", expr), "real" if known_real else "", lambda: cast("Expr", expr))
        arguments = [self.tower.canonical(self.form(a)) for a in expr.args]
        keys = tuple(self.fraction_key(a) for a in arguments)
        real = all(self.is_real(a) for a in arguments)
        if isinstance(expr, AppliedUndef):
            sign = _declared_sign(expr) if real else ""
        else:
            sign = "real" if real and isinstance(expr, sp.sign | sp.Max | sp.Min | sp.acot) else ""
        return self.atom((expr.func, keys), sign, lambda: cast("Expr", expr))


def _declared_sign(symbol: sp.Expr) -> str:
    """Return the sign that was declared of a symbol, or of a function of real arguments."""
    if declared_complex(symbol):
        return ""
    if symbol.is_positive:
        return "+"
    if symbol.is_negative:
        return "-"
    if symbol.is_nonnegative:
        return "0+"
    if symbol.is_nonpositive:
        return "0-"
    return "real"


def _derivative_key(expr: sp.Basic, forms: Forms) -> tuple[Hashable, bool]:
    """Return one key for ∂f at given arguments, whether SymPy writes Derivative or Subs, and if it is real.

    A derivative of a real function is real where the arguments are.
    """
    inner: sp.Basic = expr
    places: dict[sp.Basic, Expr] = {}
    if isinstance(expr, Subs):
        inner = expr.expr
        variables, point = cast("tuple[sp.Symbol, ...]", expr.variables), cast("tuple[Expr, ...]", expr.point)
        places = dict(zip(variables, point, strict=True))
    if isinstance(inner, Derivative) and isinstance(inner.expr, AppliedUndef):
        orders = _orders(inner, inner.expr.args)
        if orders is not None:
            there = [forms.tower.canonical(forms.form(a.xreplace(places))) for a in inner.expr.args]
            real = not declared_complex(inner.expr) and all(map(forms.is_real, there))
            keys = tuple(map(forms.fraction_key, there))
            return ("derivative", inner.expr.func, orders, keys), real
    real = isinstance(inner, Derivative) and certainly_real(cast("Expr", inner.expr))
    return ("opaque", expr), real and all(map(certainly_real, places.values()))


def _orders(derivative: Derivative, arguments: Sequence[sp.Basic]) -> tuple[int, ...] | None:
    """Return how often is differentiated by each argument; None where that is not by arguments, each for itself."""
    taken = cast("tuple[tuple[sp.Basic, sp.Basic], ...]", derivative.variable_count)
    counts = {v: int(n) for v, n in taken if isinstance(n, sp.Integer)}
    whole = len(counts) == len(taken)
    plain = all(isinstance(a, sp.Symbol) or not (a.free_symbols & set(counts)) for a in arguments)
    if not whole or not plain or any(sum(1 for a in arguments if a == v) != 1 for v in counts):
        return None
    return tuple(counts.get(a, 0) for a in arguments)
