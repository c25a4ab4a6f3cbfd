"""Inverses of maps of polar type: q = r(P) sin Q, p = s(P) cos Q, one way or the other.

An angle given as an arc, Q = atan2(y, x), says y = ρ sin Q, x = ρ cos Q with one more unknown ρ > 0. An old
angle φ that occurs in sin φ and cos φ only is replaced by two unknowns with sin² φ + cos² φ = 1, and is
then atan2 of them. Both ways the equations become algebraic, and no half of the plane is lost, as it is by
tan Q = y/x. (H. Goldstein, C. Poole, J. Safko, Classical Mechanics, 3rd ed., section 9.3.)

What is found here is a suggestion of one branch; :mod:`inverse_transformation` proves it both ways.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from sympy import Expr, Symbol, atan, atan2, cos, pi, sin

from canon.mechanics.algebra.branch_point import BranchPoint
from canon.mechanics.algebra.solve_on_branch import Inversion, solve_system
from canon.mechanics.algebra.substitution import exchanged, shortened, size, substitute

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy.logic.boolalg import Boolean

__all__ = [
    "AngleFromArc",
    "BranchOfInverse",
    "free_angles",
    "plain_arcs",
    "plain_sign",
    "polar_branch",
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
    """

    values: Mapping[Symbol, Expr]
    ranges: tuple[Boolean, ...]
    angles: Mapping[Symbol, AngleFromArc]
    within_a_turn: tuple[Expr, ...] = ()

    def returns(self, meaning: Mapping[Symbol, Expr]) -> list[tuple[str, Expr]]:
        """Return what must vanish in the old variables so that each of them comes back."""
        claims: list[tuple[str, Expr]] = []
        for z, value in self.values.items():
            angle = self.angles.get(z)
            if angle is None:
                claims.append((f"{z} comes back", substitute(value, meaning) - z))
                continue
            claims.append((f"the sine of {z} comes back", substitute(angle.sine, meaning) - sin(z)))
            claims.append((f"the cosine of {z} comes back", substitute(angle.cosine, meaning) - cos(z)))
            claims.append((f"{z} stays within one turn", atan2(sin(z), cos(z)) + 2 * pi * angle.turns - z))
        return claims

    def undoes(self, meaning: Mapping[Symbol, Expr]) -> list[tuple[str, Expr]]:
        """Return what must vanish in the new variables so that each of them comes back.

        The images hold angles that were found as arcs by their sines and cosines only, and atan2(s, c) has the
        sine s and the cosine c where s² + c² = 1, so that no arc is left in the claims.
        """
        claims: list[tuple[str, Expr]] = []
        for z, angle in self.angles.items():
            claims.append((f"the squares add up to one for {z}", angle.sine**2 + angle.cosine**2 - 1))
        arcs = {atan2(sin(angle), cos(angle)): angle for angle in self.within_a_turn}
        there = {new: exchanged(self.at(image), arcs) for new, image in meaning.items()}
        return [*claims, *((f"{new} comes back", f - new) for new, f in there.items())]

    def at(self, f: Expr) -> Expr:
        """Return a function of the old variables in the new ones, sines and cosines of angles without arcs."""
        named: dict[Expr, Symbol] = {}
        values = dict(self.values)
        for z, angle in self.angles.items():
            for part, value in ((sin(z), angle.sine), (cos(z), angle.cosine)):
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


def free_angles(variables: Sequence[Symbol], images: Sequence[Expr]) -> list[Symbol]:
    """Return the real variables that occur in images by their sines and cosines only, by both.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> free_angles([x, y], [y*cos(x), y*sin(x)])
    [x]
    """
    found: list[Symbol] = []
    for z in variables:
        names: dict[Expr, Expr] = {sin(z): sp.Dummy(), cos(z): sp.Dummy()}
        seen = [exchanged(f, names) for f in images]
        both = all(any(f.has(name) for f in seen) for name in names.values())
        if z.is_real and both and not any(f.has(z) for f in seen):
            found.append(z)
    return found


def polar_branch(
    variables: Sequence[Symbol],
    meaning: Mapping[Symbol, Expr],
    witness: BranchPoint,
    deadline: float = math.inf,
) -> BranchOfInverse | None:
    """Return the branch of the inverse that the witness shows; None where the map is not of polar type.

    Parameters
    ----------
    variables
        The old variables.
    meaning
        The new variables as expressions in the old ones.
    witness
        A point of the domain, which tells the branch.
    deadline
        When to give up, on the monotonic clock; a step that is under way is finished.

    Examples
    --------
    >>> q, p, Q, P = sp.symbols("q p Q P", real=True)
    >>> meaning = {Q: atan2(q, p), P: (q**2 + p**2)/2}
    >>> witness = BranchPoint({q: sp.Rational(1), p: sp.Rational(-2)}, meaning)
    >>> dict(polar_branch([q, p], meaning, witness).values)
    {q: sqrt(2)*sqrt(P)*sin(Q), p: sqrt(2)*sqrt(P)*cos(Q)}
    """
    system = _Polar([], dict(meaning), [], [], [])
    for symbol, image in meaning.items():
        system.add(symbol, image, variables, witness)
    parts = {z: _sine_and_cosine(z) for z in free_angles(variables, list(meaning.values()))}
    if not (parts or system.radii):
        return None
    named = {f: name for pair in parts.values() for f, name in pair.items()}
    equations = [(exchanged(lhs, named), rhs) for lhs, rhs in system.equations]
    unknowns = [*(z for z in variables if z not in parts), *system.radii]
    known = {**system.meaning, **{name: f for f, name in named.items()}}
    inversion = Inversion(BranchPoint(witness.point, known), deadline=deadline)
    solved = _solved(equations, unknowns, [tuple(pair.values()) for pair in parts.values()], inversion)
    if solved is None:
        return None
    sizes = {f: new for new, image in meaning.items() for f in _sizes(new, image)}
    solved = {z: shortened(exchanged(united_squares(value), sizes)) for z, value in solved.items()}
    angles = _angles(parts, solved, witness)
    if angles is None:
        return None
    values = {z: angles[z].value if z in angles else solved[z] for z in variables}
    signs = (cast("Boolean", sp.Gt(new, 0)) for new in sizes.values())
    ranges = tuple(dict.fromkeys((*system.ranges, *signs, *positive_radicands(solved.values()))))
    return BranchOfInverse(values, ranges, angles, tuple(system.angles))


def _sizes(new: Symbol, image: Expr) -> tuple[Expr, ...]:
    """Return |new| where the new variable is not negative as an image, whatever its symbol says."""
    return (sp.Abs(new),) if image.is_nonnegative and not new.is_nonnegative else ()


def _angles(
    parts: Mapping[Symbol, Mapping[Expr, Symbol]], solved: Mapping[Symbol, Expr], witness: BranchPoint
) -> dict[Symbol, AngleFromArc] | None:
    """Return the old angles by their sines and cosines, with the turns that the witness shows."""
    angles: dict[Symbol, AngleFromArc] = {}
    for z, pair in parts.items():
        sine, cosine = (solved[name] for name in pair.values())
        turns = witness.number((z - atan2(sine, cosine)) / (2 * pi))
        if turns is None:
            return None
        angles[z] = AngleFromArc(sine, cosine, round(turns))
    return angles


def _solved(
    equations: Sequence[tuple[Expr, Expr]],
    unknowns: Sequence[Symbol],
    pairs: Sequence[tuple[Symbol, ...]],
    inversion: Inversion,
) -> dict[Symbol, Expr] | None:
    """Solve for the unknowns and for pairs of sines and cosines, these from two equations that hold them."""
    if not pairs:
        return solve_system(equations, unknowns, inversion)
    # Equations without momenta come first, and the angle that stands in the fewest of them.
    simplest = sorted(equations, key=lambda each: (len(each[0].free_symbols), size(each[0])))
    pair, *others = sorted(pairs, key=lambda pair: sum(lhs.has(*pair) for lhs, _ in equations))
    for two in combinations([each for each in simplest if each[0].has(*pair)], 2):
        found = solve_system(two, pair, inversion)
        if found is None:
            continue
        one = sp.Add(*(value**2 for value in found.values()))
        rest = [(substitute(lhs, found) - rhs, sp.S.Zero) for lhs, rhs in equations if (lhs, rhs) not in two]
        solved = _solved([*rest, (one - 1, sp.S.Zero)], unknowns, others, inversion)
        if solved is not None:
            return {**solved, **{z: substitute(value, solved) for z, value in found.items()}}
    return None


def _sine_and_cosine(z: Symbol) -> dict[Expr, Symbol]:
    return {sin(z): sp.Dummy("sine", real=True), cos(z): sp.Dummy("cosine", real=True)}


@dataclass
class _Polar:
    """Equations of a map in which arcs are written with radii."""

    equations: list[tuple[Expr, Expr]]
    meaning: dict[Symbol, Expr]
    radii: list[Symbol]
    ranges: list[Boolean]
    angles: list[Expr]

    def add(self, symbol: Symbol, image: Expr, variables: Sequence[Symbol], witness: BranchPoint) -> None:
        """Add image = symbol, as two equations where the image is an arc but for constants."""
        arcs = [arc for arc in image.atoms(atan, atan2) if arc.has(*variables)]
        name = sp.Dummy("arc")
        rest = exchanged(image, {arcs[0]: name}) if len(arcs) == 1 else image
        slope = rest.diff(name)
        if slope == 0 or rest.has(*variables) or slope.has(name):
            self.equations.append((image, symbol))
            return
        angle = (symbol - exchanged(rest, {name: sp.S.Zero})) / slope
        y, x, half_range = _legs(cast("Expr", arcs[0]), witness)
        radius = sp.Dummy("radius", positive=True)
        self.meaning[radius] = sp.sqrt(x**2 + y**2)
        self.radii.append(radius)
        self.equations += [(y - radius * sin(angle), sp.S.Zero), (x - radius * cos(angle), sp.S.Zero)]
        self.angles.append(angle)
        self.ranges += [cast("Boolean", sp.Gt(angle, -half_range)), cast("Boolean", sp.Lt(angle, half_range))]


def _legs(arc: Expr, witness: BranchPoint) -> tuple[Expr, Expr, Expr]:
    """Return y and x with arc = atan2(y, x) on the branch of the witness, and the end of the arc's range."""
    if isinstance(arc, atan2):
        y, x = cast("tuple[Expr, Expr]", arc.args)
        return y, x, pi
    y, x = sp.fraction(sp.together(cast("Expr", arc.args[0])))
    left = (witness.number(x) or 0.0) < 0
    return (-y, -x, pi / 2) if left else (y, x, pi / 2)


def positive_radicands(values: Any) -> list[Boolean]:
    """Return what must be positive under the square roots, where it is not by its symbols alone."""
    powers = {
        power for f in values for power in f.atoms(sp.Pow) if power.exp.is_Rational and power.exp.q == 2
    }
    signs = {plain_sign(sp.Gt(sp.factor_terms(power.base), 0)) for power in powers}
    return sorted((sign for sign in signs if sign != sp.true), key=str)


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
