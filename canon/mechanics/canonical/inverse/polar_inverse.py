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
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol, atan, atan2, cos, pi, sin

from canon.mechanics.algebra.branch_point import BranchPoint
from canon.mechanics.algebra.solve_on_branch import Inversion, solve_system
from canon.mechanics.algebra.substitution import exchanged, shortened, size, substitute
from canon.mechanics.canonical.inverse.inverse_branch import (
    AngleFromArc,
    BranchOfInverse,
    positive_radicands,
    united_squares,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy.logic.boolalg import Boolean

__all__ = ["free_angles", "polar_branch"]


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
