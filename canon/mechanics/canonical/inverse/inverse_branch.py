"""Branch of an inverse map: the old variables as functions of the new ones, what must vanish for it, and where.

Angles and areas are kept as the sine and cosine that they should have, so that claims about them hold no arcs.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from sympy import Expr, Symbol, acosh, atan2, cos, cosh, pi, sin, sinh

from canon.mechanics.algebra.substitution import exchanged, size, substitute

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy.logic.boolalg import Boolean

__all__ = [
    "AngleFromArc",
    "AreaFromCosine",
    "BranchOfInverse",
    "plain_arcs",
    "plain_sign",
    "positive_radicands",
    "united_squares",
]


@dataclass(frozen=True)
class BranchOfInverse:
    """The old variables as functions of the new ones, on one branch that is yet to be proved.

    Parameters
    ----------
    values
        Each old variable as an expression in the new ones.
    ranges
        What the new variables satisfy on this branch: the range of each arc, radicands that are positive.
    angles
        For each old angle that was found as an arc, what should be its sine and its cosine, and its turns.
    within_a_turn
        Angles, in the new variables, that the ranges put between -pi and pi.
    areas
        For each old variable that was found as ±acosh, what should be its hyperbolic sine and cosine.
    """

    values: Mapping[Symbol, Expr]
    ranges: tuple[Boolean, ...]
    angles: Mapping[Symbol, AngleFromArc]
    within_a_turn: tuple[Expr, ...] = ()
    areas: Mapping[Symbol, AreaFromCosine] = field(default_factory=dict[Symbol, "AreaFromCosine"])

    def returns(self, meaning: Mapping[Symbol, Expr]) -> list[tuple[str, Expr]]:
        """Return what must vanish in the old variables so that each of them comes back."""
        claims: list[tuple[str, Expr]] = []
        for z, value in self.values.items():
            angle = self.angles.get(z)
            if z in self.areas:
                area = self.areas[z]
                claims.append(
                    (f"the hyperbolic sine of {z} comes back", substitute(area.sine, meaning) - sinh(z))
                )
                claims.append(
                    (f"the hyperbolic cosine of {z} comes back", substitute(area.cosine, meaning) - cosh(z))
                )
                claims.append((f"{z} keeps its sign", area.sign * acosh(cosh(z)) - z))
            elif angle is None:
                claims.append((f"{z} comes back", substitute(value, meaning) - z))
            else:
                claims.append((f"the sine of {z} comes back", substitute(angle.sine, meaning) - sin(z)))
                claims.append((f"the cosine of {z} comes back", substitute(angle.cosine, meaning) - cos(z)))
                claims.append(
                    (f"{z} stays within one turn", atan2(sin(z), cos(z)) + 2 * pi * angle.turns - z)
                )
        return claims

    def undoes(self, meaning: Mapping[Symbol, Expr]) -> list[tuple[str, Expr]]:
        """Return what must vanish in the new variables so that each of them comes back.

        The images hold angles that were found as arcs by their sines and cosines only, and atan2(s, c) has the
        sine s and the cosine c where s² + c² = 1, so that no arc is left in the claims.
        """
        claims: list[tuple[str, Expr]] = []
        for z, angle in self.angles.items():
            claims.append((f"the squares add up to one for {z}", angle.sine**2 + angle.cosine**2 - 1))
        for z, area in self.areas.items():
            claims.append((f"the squares differ by one for {z}", area.cosine**2 - area.sine**2 - 1))
        arcs = {atan2(sin(angle), cos(angle)): angle for angle in self.within_a_turn}
        there = {new: exchanged(self.at(image), arcs) for new, image in meaning.items()}
        return [*claims, *((f"{new} comes back", f - new) for new, f in there.items())]

    def at(self, f: Expr) -> Expr:
        """Return a function of the old variables in the new ones, sines and cosines of angles without arcs."""
        named: dict[Expr, Symbol] = {}
        values = dict(self.values)
        known: dict[Expr, Expr] = {}
        for z, angle in self.angles.items():
            known |= {sin(z): angle.sine, cos(z): angle.cosine}
        for z, area in self.areas.items():
            known |= {sinh(z): area.sine, cosh(z): area.cosine}
        for part, value in known.items():
            named[part] = sp.Dummy("part", real=True)
            values[named[part]] = value
        there = united_squares(plain_arcs(substitute(exchanged(f, named), values)))
        positive = [cast("Expr", c.lhs) for c in self.ranges if isinstance(c, sp.Gt) and c.rhs == 0]
        return exchanged(there, {sp.Abs(f): f for f in positive})


@dataclass(frozen=True)
class AngleFromArc:
    """An old angle atan2(sine, cosine) + 2π turns."""

    sine: Expr
    cosine: Expr
    turns: int

    @property
    def value(self) -> Expr:
        """The angle, without the factors that its sine and its cosine have in common."""
        return plain_arcs(atan2(self.sine, self.cosine)) + 2 * pi * self.turns


@dataclass(frozen=True)
class AreaFromCosine:
    """An old variable ±acosh(cosine), with the sign of its hyperbolic sine."""

    sine: Expr
    cosine: Expr
    sign: int

    @property
    def value(self) -> Expr:
        """The variable."""
        return self.sign * acosh(self.cosine)


def united_squares(f: Expr) -> Expr:
    """Return f with sin² x + cos² x = 1 used in its sums, from the inside out, where that makes them shorter.

    Examples
    --------
    >>> x, a, b = sp.symbols("x a b")
    >>> united_squares(a*cos(x)**2/(2*b) + a*sin(x)**2/(2*b))
    a/(2*b)
    >>> united_squares((a*sin(x) + b*cos(x))**2 + (a*cos(x) - b*sin(x))**2)
    a**2 + b**2
    """
    if not f.has(sin, cos) or not f.args:
        return f
    inside = f.func(*(united_squares(cast("Expr", part)) for part in f.args))
    if not inside.is_Add:
        return inside
    multiplied = sp.expand(inside)
    squares = {
        g: (1 - cos(g.base.args[0]) ** 2) ** (g.exp / 2)
        for g in multiplied.atoms(sp.Pow)
        if isinstance(g.base, sin) and g.exp.is_Integer and g.exp.is_positive and g.exp.is_even
    }
    return min((inside, cast("Expr", sp.expand(exchanged(multiplied, squares)))), key=size)


def positive_radicands(values: Any) -> list[Boolean]:
    """Return what must be positive under the square roots, where it is not by its symbols alone."""
    powers = {
        power for f in values for power in f.atoms(sp.Pow) if power.exp.is_Rational and power.exp.q == 2
    }
    signs = {plain_sign(sp.Gt(sp.factor_terms(power.base), 0)) for power in powers}
    return sorted((sign for sign in signs if sign != sp.true), key=str)


def plain_arcs(f: Expr) -> Expr:
    """Return f with factors that are not negative taken out of both arguments of each atan2.

    atan2(k y, k x) = atan2(y, x) for k ≥ 0 wherever the left side has a value, as k is not zero there. Square
    roots are such factors, being real where the arc is.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> plain_arcs(atan2(sp.sqrt(y)*sin(x)/2, sp.sqrt(y)*cos(x)/3))
    atan2(3*sin(x), 2*cos(x))
    """
    return exchanged(f, {arc: _plain(arc) for arc in f.atoms(atan2)})


def plain_sign(condition: Boolean) -> Boolean:
    """Return f > 0 or f < 0 without the factors of f that are positive where they have a value and are not zero.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> plain_sign(-sp.sqrt(y)*cos(x) < 0)
    0 < cos(x)
    """
    if not isinstance(condition, sp.StrictGreaterThan | sp.StrictLessThan) or condition.rhs != 0:
        return condition
    powers = _powers(cast("Expr", condition.lhs))
    kept = {b: n for b, n in powers.items() if not (b.is_positive or _is_halved(powers, b))}
    f = _product(kept)
    if f.could_extract_minus_sign():
        return cast("Boolean", condition.func(0, -f)) if f.args else condition
    return cast("Boolean", condition.func(f, 0))


def _plain(arc: Expr) -> Expr:
    y, x = (sp.factor_terms(cast("Expr", leg)) for leg in arc.args)
    if y == 0 or x == 0:
        return arc
    of_y, of_x = _powers(y), _powers(x)
    for base in {*of_y, *of_x}:
        if base.is_nonnegative or (_is_halved(of_y, base) and _is_halved(of_x, base)):
            least = min(of_y.get(base, sp.S.Zero), of_x.get(base, sp.S.Zero))
            of_y[base] = of_y.get(base, sp.S.Zero) - least
            of_x[base] = of_x.get(base, sp.S.Zero) - least
    return atan2(_product(of_y), _product(of_x))


def _powers(f: Expr) -> dict[Expr, Expr]:
    """Return the factors of f with their rational exponents; numbers as primes, so that they may cancel."""
    powers: dict[Expr, Expr] = {}
    for factor in sp.Mul.make_args(f):
        base, exponent = factor.as_base_exp()
        if not exponent.is_Rational:
            base, exponent = factor, sp.S.One
        numbers: Any = sp.factorrat(base) if base.is_Rational and base.is_positive else {base: 1}
        for part, power in numbers.items():
            key = cast("Expr", sp.sympify(part, strict=True))
            powers[key] = powers.get(key, sp.S.Zero) + exponent * power
    return powers


def _is_halved(powers: Mapping[Expr, Expr], base: Expr) -> bool:
    """Whether a factor occurs under a square root, which is real only where the factor is not negative."""
    exponent = powers.get(base)
    return exponent is not None and exponent.is_Rational is True and cast("Any", exponent).q == 2


def _product(powers: Mapping[Expr, Expr]) -> Expr:
    return sp.Mul(*(base**exponent for base, exponent in powers.items()))
