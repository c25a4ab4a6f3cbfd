"""Possible motions: real and continuous, with continuous velocities, as there are no impacts.

A coordinate that the equations know up to whole turns may be given so.
"""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.expression.text.open_readings import is_angle
from canon.mechanics.algebra.substitution import substitute, symbols_of
from canon.proof.analytic import proved_sign
from canon.proof.continuity.continuity import continuity
from canon.proof.continuity.jumps import shown
from canon.proof.continuity.one_sided import cuts_of
from canon.proof.definedness.real_values import is_nowhere_real, real_bounds
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.domain import Domain, conditions_hold
from canon.proof.domain.verdict import Counterexample, Evidence, Status, Verdict
from canon.proof.rungs.ladder import is_empty
from canon.proof.trees.affine_form import is_affine
from canon.proof.trees.sympy_types import arguments, free_symbols
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Rational, Symbol
    from sympy.logic.boolalg import Boolean

__all__ = ["motion_is_continuous", "motion_is_real", "real_somewhere", "where_real"]

POINTS = 40
"""Points at which a motion is looked at."""

MOVED = 6
"""Points from which one that makes a motion real is looked for."""

SECONDS = 0.5
"""Time for the proof that an angle keeps away from the origin."""


def motion_is_real(motion: Mapping[Symbol, Expr], domain: Domain) -> Iterator[Verdict]:
    """Yield whether x(t) is real; conditions on the coordinates themselves are left out."""
    on_time = Domain(tuple(c for c in domain.conditions if not c.has(*motion)), domain.box)
    for x, place in motion.items():
        yield _is_real(place, x, on_time)


def where_real(functions: Sequence[Expr], domain: Domain, momenta: Sequence[Expr] = ()) -> Domain:
    """Return the part of a domain where square roots and logarithms are real: elsewhere there is no motion.

    Each root and logarithm is asked to be real by itself, as √(x³)/√x is written for x > 0. It is the domain itself
    where there is no such part, or where all of it is.

    Parameters
    ----------
    functions
        What is to be real.
    domain
        Where it is looked for.
    momenta
        Momenta that are claimed: beyond a bound where all of them are real there is motion too, and an answer that has
        log x times what vanishes does not choose by it where it is asked.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> where_real([x ** sp.Rational(3, 2) + sp.log(2 - x)], Domain()).conditions
    (x > 0, x < 2)
    >>> p = sp.sqrt(1 - x**2) + (sp.sin(x)**2 + sp.cos(x)**2 - 1) * sp.log(x)
    >>> where_real([p], Domain(), [p]).conditions
    (1 - x**2 > 0,)
    """
    bounds = _bounds(functions, domain)
    symbols = {s for f in functions for s in symbols_of(f)}
    for point in domain.points(symbols, POINTS) if momenta and bounds else ():
        beyond = [bound for bound in bounds if not conditions_hold([bound], point)]
        if beyond and all(_is_real_at(p, point) for p in momenta):
            bounds = [bound for bound in bounds if bound not in beyond]
    real = Domain((*domain.conditions, *bounds), domain.box)
    return real if bounds and next(iter(real.points(symbols, 1)), None) is not None else domain


def _bounds(functions: Sequence[Expr], domain: Domain) -> list[Boolean]:
    """Return that what stands under each square root and in each logarithm is positive, where it is not known to be."""
    parts = sorted({part for f in functions for part in f.atoms(sp.Pow, sp.log)}, key=sp.default_sort_key)
    inside = dict.fromkeys(
        part.args[0]
        for part in parts
        if isinstance(part, sp.log) or (part.args[1].is_Rational and sp.fraction(part.args[1])[1] % 2 == 0)
    )
    open_ = [f for f in inside if f.is_extended_real and not proved_sign(f, domain).endswith("+")]
    return [bound for f in open_ if (bound := sp.Gt(f, 0)) not in (sp.true, sp.false)]


def _is_real_at(f: Expr, point: Mapping[Symbol, Rational]) -> bool:
    """Tell whether a function may be real at a point, as far as its value there is known."""
    with precision(128):
        try:
            return bool(value(f, point).imag.contains(0))
        except (NotDecided, Undefined, Unmodelled):
            return False


def motion_is_continuous(
    motion: Mapping[Symbol, Expr], domain: Domain, laws: Sequence[Expr], t: Symbol, *, velocities: bool
) -> Iterator[Verdict]:
    """Yield whether x(t) is continuous, and its velocity too where that is part of the state.

    Parameters
    ----------
    motion
        The claimed functions of time.
    domain
        Where they are claimed, with their constants and parameters.
    laws
        Expressions in the coordinates that make the equations of motion.
    t
        The time.
    velocities
        Whether velocities must be continuous beside the places.
    """
    for x, place in motion.items():
        rest, turns = _without_turns(place, x, domain, laws, t)
        verdict = continuity(rest, [t], domain, name=f"{x} = {place}")
        yield replace(verdict, assumed=(*verdict.assumed, *turns))
        if turns and not _is_an_angle(x, rest, laws, t):
            yield _may_be_no_angle(x, place)
        if turns:
            yield from _beside_the_origin(place - rest, domain)
        if velocities:
            yield continuity(place.diff(t), [t], domain, name=f"the velocity of {x} = {place}")


def _is_real(place: Expr, x: Symbol, domain: Domain) -> Verdict:
    """Tell whether a motion is real, as far as it is claimed to be one.

    A root or logarithm leaves the real numbers where the motion ends: it is claimed up to there.
    """
    verdict = real_somewhere([place], domain, f"{x} is real")
    if verdict.holds and verdict.assumed:
        return replace(verdict, assumed=(f"{x} = {place} is claimed where it is real",))
    if verdict.fails and verdict.counterexample is not None:
        example = verdict.counterexample
        where = ", ".join(f"{name} = {number}" for name, number in example.point.items())
        why = f"{x} = {place} is no motion: it is not real, but {example.left} at {where}"
        return replace(verdict, feedback=why)
    return verdict


def real_somewhere(functions: Sequence[Expr], domain: Domain, question: str) -> Verdict:
    """Tell whether functions are real together somewhere: where one is not, it is not claimed.

    A point where one is not real refutes nothing, nor do many: √(t − 1000) is real later. FAILS is said where
    a function is proved to be real almost nowhere, and where one holds i and is not real at a point. Points where all
    are real are looked for where roots, logarithms and arcs are; where none is found that is UNDECIDED.

    Parameters
    ----------
    functions, domain
        The functions, and where they are meant.
    question
        What is asked.

    Examples
    --------
    >>> t = sp.Symbol("t", real=True)
    >>> [real_somewhere([f], Domain(), "").status.name for f in (sp.sqrt(t - 1000), sp.sqrt(-1 - t**2), sp.I * t)]
    ['HOLDS', 'FAILS', 'FAILS']
    """
    looked_at = [f for f in functions if f.is_real is not True]
    real, example = _looked_at(looked_at, domain)
    if example is None:
        return Verdict(Status.HOLDS, question, "exact")
    guilty, shown_there = example
    if guilty.has(sp.I) or is_nowhere_real(guilty, domain):
        return Verdict(Status.FAILS, question, "ball", counterexample=shown_there)
    bounds = real_bounds(looked_at, domain)
    there = Domain((*domain.conditions, *bounds), domain.box)
    if real or (
        bounds and (_looked_at(looked_at, there)[0] or _is_real_further_on(looked_at, bounds, domain))
    ):
        return Verdict(Status.HOLDS, question, "exact", assumed=("claimed where it is real",))
    why = f"no point was found where {guilty} is real; say in the domain where it is"
    return Verdict(Status.UNDECIDED, question, evidence=(Evidence("open", why),))


def _looked_at(functions: Sequence[Expr], domain: Domain) -> tuple[bool, tuple[Expr, Counterexample] | None]:
    """Return whether all functions may be real at one of some points, and one that is not, with where it is not."""
    real, example = False, None
    symbols = {s for f in functions for s in free_symbols(f)}
    for point in domain.points(symbols, POINTS) if functions else ():
        try:
            with precision(128):
                balls = [(f, value(f, point)) for f in functions]
        except (NotDecided, Undefined, Unmodelled):
            continue
        beyond = next(((f, ball) for f, ball in balls if not ball.imag.contains(0)), None)
        real = real or beyond is None
        if beyond is not None and example is None:
            names = {s.name: str(number) for s, number in point.items()}
            example = beyond[0], Counterexample(names, shown(beyond[1]), "a real number", 8)
    return real, example


def _is_real_further_on(functions: Sequence[Expr], bounds: Sequence[Boolean], domain: Domain) -> bool:
    """Whether functions may be real at a point where one symbol after another was moved to where bounds hold."""
    symbols = {s for f in functions for s in free_symbols(f)}
    for point, s in product(domain.points(symbols, MOVED), sorted(symbols, key=str)):
        moved = _moved_along(s, point, bounds)
        if domain.admits(moved) and all(_is_real_at(f, moved) for f in functions):
            return True
    return False


def _moved_along(
    s: Symbol, point: Mapping[Symbol, Rational], bounds: Sequence[Boolean]
) -> dict[Symbol, Rational]:
    """Return a point with one symbol moved to where bounds that are linear in it hold, one after another."""
    moved = dict(point)
    for bound in bounds:
        sides = cast("sp.Gt", bound)
        gap = substitute(
            cast("Expr", sides.gts) - cast("Expr", sides.lts), {z: n for z, n in moved.items() if z != s}
        )
        slope = gap.diff(s)
        if slope.is_Rational and slope != 0 and not conditions_hold([bound], moved):
            moved[s] = cast("Rational", substitute((1 - gap) / slope, {s: sp.S.Zero}))
    return moved


def _without_turns(
    place: Expr, x: Symbol, domain: Domain, laws: Sequence[Expr], t: Symbol
) -> tuple[Expr, tuple[str, ...]]:
    """Leave out angles that jump by whole turns where the equations do not know of turns; say so.

    An angle that goes on uniformly is no reason: ω t says the same without a jump. Nor is a staircase of turns beside a
    place that goes on uniformly, which stands still or moves evenly in between.
    """
    turning = [term for term in sp.Add.make_args(place) if _jumps_by_turns(term)]
    if turning and vanishes(place.diff(t, 2), domain, 0.5).holds:
        return place, ()
    turning = [term for term in turning if not vanishes(term.diff(t, 2), domain, 0.5).holds]
    if not turning or not all(_knows_no_turns(e, x) for e in laws):
        return place, ()
    return place - sp.Add(*turning), (f"{x} is an angle of which whole turns do not count",)


def _beside_the_origin(turning: Expr, domain: Domain) -> Iterator[Verdict]:
    """Yield UNDECIDED for angles that may pass the origin, where they jump by half a turn."""
    for angle in turning.atoms(sp.atan2):
        y, x = arguments(angle)
        zeros = (cast("Boolean", sp.Eq(y, 0)), cast("Boolean", sp.Eq(x, 0)))
        at_origin = Domain((*domain.conditions, *zeros), domain.box)
        if not is_empty(at_origin, time.monotonic() + SECONDS):
            open_ = (
                f"whether {y} and {x} vanish together, where {angle} jumps by half a turn, was not decided"
            )
            yield Verdict(Status.UNDECIDED, "the motion is continuous", evidence=(Evidence("open", open_),))


def _jumps_by_turns(term: Expr) -> bool:
    factor, angle = term.as_coeff_Mul()
    if isinstance(angle, sp.atan2):  # through the origin it jumps by half a turn
        around = all(cut.beyond is not None for cut in cuts_of(angle, sorted(free_symbols(angle), key=str)))
        return factor.is_integer is True and around
    return isinstance(angle, sp.atan) and factor.is_even is True and _goes_through_infinity(angle)


def _goes_through_infinity(angle: Expr) -> bool:
    """Tell whether 2 atan turns once where the tangent does: of (a tan u + b)/(c tan u + d), not of exp(tan u)."""
    inside = arguments(angle)[0]
    tangents = inside.atoms(sp.tan)
    if len(tangents) != 1:
        return False
    T = sp.Dummy("T", real=True)
    above, below = sp.fraction(sp.together(inside.xreplace({next(iter(tangents)): T})))
    return (above.has(T) or below.has(T)) and all(is_affine(side, [T]) for side in (above, below))


def _is_an_angle(x: Symbol, rest: Expr, laws: Sequence[Expr], t: Symbol) -> bool:
    """Tell whether a coordinate is an angle: it is called so, or stands in the laws and does nothing but wind."""
    return is_angle(x.name) or (any(law.has(x) for law in laws) and not rest.has(t))


def _may_be_no_angle(x: Symbol, place: Expr) -> Verdict:
    why = (
        f"{x} = {place} jumps by whole turns, and whether {x} is an angle was not decided; "
        "call it theta or phi if it is one"
    )
    return Verdict(
        Status.UNDECIDED, "the motion is continuous", evidence=(Evidence("open", why),), feedback=why
    )


def _knows_no_turns(equation: Expr, x: Symbol) -> bool:
    if not equation.has(x):
        return True
    turned = substitute(equation, {x: x + 2 * sp.pi})
    return vanishes(turned - equation, budget=0.5).holds
