"""Where an expression has a value: almost everywhere, nowhere, or not on a part of the domain.

An expression with a certified value at one point has denominators that are not zero there; without roots, moduli
and pieces they are meromorphic, and vanish almost nowhere then. Whether one vanishes everywhere, the normal form
tells. With pieces the formula that applies around a point is looked at.
"""

from __future__ import annotations

import random
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from canon.proof.definedness.formula_around import NoPiece, formula_around, put_in
from canon.proof.definedness.hazards import branching, hazards, incomplete, unconditional
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.declarations import declared_complex
from canon.proof.domain.domain import EVERYWHERE, Domain
from canon.proof.domain.limits import QUICK
from canon.proof.domain.verdict import Counterexample
from canon.proof.refute.refute import landmarks
from canon.proof.refute.sample_functions import with_example_functions
from canon.proof.rungs.ladder import REFUSALS, is_empty, prove_zero
from canon.proof.trees.anatomy import Anatomy, anatomy
from canon.proof.trees.replacement import NoValue, defined_nowhere, replaced
from canon.proof.worker.budget import prove_in_worker

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from flint import acb
    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

__all__ = ["Lack", "lack_beside", "lack_of_value", "may_lack"]

QUICK_SECONDS = 0.3
"""Time for the proof that one denominator is zero, in the user's own process."""

BITS = (64, 256)
"""Precisions at which a value is looked for."""

NO_VALUE = (NotDecided, Undefined, Unmodelled)


@dataclass(frozen=True)
class Lack:
    """That an expression has no value, and why; or that none was found.

    Parameters
    ----------
    why
        What takes the value.
    proved
        Whether that is certain.
    point
        Where; None if everywhere.
    """

    why: str
    proved: bool = True
    point: Mapping[Symbol, sp.Rational] | None = None

    def sentence(self, name: str) -> str:
        """Say of what is called ``name`` that it has no value."""
        because = f": {self.why}" if self.why else ""
        if not self.proved:
            return f"it was not shown that {name} has a value anywhere{because}"
        if self.point is None:
            return f"{name} has a value nowhere{because}"
        where = ", ".join(f"{s} = {number}" for s, number in self.point.items())
        return f"{name} has no value around {where}{because}"

    @property
    def counterexample(self) -> Counterexample | None:
        """The point, where it is one."""
        if self.point is None:
            return None
        return Counterexample(
            {s.name: str(number) for s, number in self.point.items()}, "no value", "a value", 0
        )


NOT_FOUND = Lack("no point was found where it certainly has one", proved=False)
NOT_LOOKED_AT = Lack("there was no time to look everywhere", proved=False)


def lack_of_value(expr: Expr, domain: Domain, deadline: float, *, valued: bool = False) -> Lack | None:
    """Return why an expression has a value nowhere on a domain, or isn't known to have one; None if it has.

    Parameters
    ----------
    expr, domain
        The expression, and where it is meant.
    deadline
        Value of :func:`time.monotonic` to stop at.
    valued
        Whether a certified value at a point of the domain is known.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> hidden = (x + 1)**2 - x**2 - 2*x - 1
    >>> print(lack_of_value(1 / x, EVERYWHERE, time.monotonic() + 1))
    None
    >>> lack_of_value(1 / hidden, EVERYWHERE, time.monotonic() + 1).sentence("f")
    'f has a value nowhere: its denominator -x**2 - 2*x + (x + 1)**2 - 1 is zero everywhere'
    """
    found = anatomy([expr])
    if defined_nowhere(expr, found):
        return Lack("it is infinite or undefined")
    open_ = incomplete(found.parts)
    if valued and not found.has(sp.Piecewise):
        return None
    risks = hazards(found.parts)
    if not risks and not open_:
        return None
    if _has_value_at_some(
        domain.points(found.symbols, 4, deadline=deadline, but_functions=True), expr, deadline
    ):
        return None
    needed = unconditional(expr)
    harmless = True
    for risk in risks:
        if _is_nonzero_somewhere(risk.argument, domain, deadline):
            continue
        harmless = False
        if risk.part in needed and _vanishes(risk.argument, domain, deadline):
            return Lack(f"{risk} everywhere")
    if harmless and not open_:
        return None
    if any(_no_piece(part, domain, deadline) for part in needed if isinstance(part, sp.Piecewise)):
        return Lack("none of its pieces has one")
    if vacuous := _vacuous(expr, open_, domain, deadline):
        return vacuous
    return None if _has_value_at_some(_points(found, domain, deadline), expr, deadline) else NOT_FOUND


def _no_piece(function: sp.Piecewise, domain: Domain, deadline: float) -> bool:
    """Tell whether each piece is proved to have no value where its condition holds, or to apply nowhere."""
    for piece, condition in cast("tuple[tuple[Expr, Boolean], ...]", function.args):
        there = domain if condition == sp.true else Domain((*domain.conditions, condition), domain.box)
        lack = lack_of_value(piece, there, deadline)
        if (lack is None or not lack.proved) and not is_empty(there, deadline):
            return False
    return True


def _vacuous(expr: Expr, open_: Sequence[sp.Piecewise], domain: Domain, deadline: float) -> Lack | None:
    """Return that an expression has no value if it is proved to equal whatever one likes where it has one."""
    generic = _off_equalities(expr, open_, domain, deadline)
    anything = sp.Dummy("c", real=True)
    if not defined_nowhere(generic) and not _vanishes(generic - anything, domain, deadline):
        return None
    return Lack("none of its pieces applies, except perhaps at single points" if open_ else "")


def _off_equalities(expr: Expr, open_: Sequence[sp.Piecewise], domain: Domain, deadline: float) -> Expr:
    """Return what an expression is where none of the equalities holds that its pieces ask for."""
    by: dict[sp.Basic, Expr] = {}
    for condition in anatomy(open_).of(sp.Eq, sp.Ne):
        gap = cast("Expr", condition.lhs - condition.rhs)
        if not branching(anatomy([gap]).parts) and _is_nonzero_somewhere(gap, domain, deadline):
            by[condition] = cast("Expr", sp.true if isinstance(condition, sp.Ne) else sp.false)
    try:
        return replaced(expr, by) if by else expr
    except NoValue:
        return expr


def _vanishes(expr: Expr, domain: Domain, deadline: float) -> bool:
    now = time.monotonic()
    try:
        proof = prove_zero(expr, domain, min(deadline, now + QUICK_SECONDS), QUICK)
    except RecursionError:
        return False
    if proof.holds or not proof.capped or (seconds := deadline - time.monotonic()) <= 0:
        return proof.holds
    answer = prove_in_worker([expr], domain, seconds / 2)
    return not isinstance(answer, str) and answer[0].holds


def _has_value_at_some(points: Iterable[Mapping[Symbol, sp.Rational]], expr: Expr, deadline: float) -> bool:
    return any(_valued(shown[0], point, deadline) for shown, point in _examples([expr], points))


def _valued(expr: Expr, point: Mapping[Symbol, sp.Rational], deadline: float) -> bool:
    """Tell whether an expression certainly has values around a point."""
    try:
        with precision(BITS[-1]):
            here = formula_around(expr, point)
    except (NoPiece, *NO_VALUE, *REFUSALS):
        return False
    return _ball(here, point, deadline) is not None


def _is_nonzero_somewhere(argument: Expr, domain: Domain, deadline: float) -> bool:
    """Tell whether a point is known where something is not zero: of the domain, or any if it is open."""
    found = anatomy([argument])
    draws = [domain.points(found.symbols, 4, deadline=deadline, but_functions=True)]
    relations = anatomy(domain.conditions).of(Relational)
    is_open = all(
        isinstance(r, sp.Gt | sp.Lt | sp.Ne) for r in relations
    )  # x ≥ 2 and x ≤ 2 leave no room around 2
    if is_open and not branching(found.parts):
        draws.append(EVERYWHERE.points(found.symbols, 3, deadline=deadline))
    for draw in draws:
        for shown, point in _examples([argument], draw):
            ball = _ball(shown[0], point, deadline)
            if ball is not None and not ball.contains(0):
                return True
    return False


def may_lack(found: Anatomy) -> bool:
    """Tell whether an expression may have no value on a part of a domain though it has one elsewhere.

    That takes pieces that do not cover everything, or denominators that can vanish on one branch alone.
    """
    if incomplete(found.parts):
        return True
    branches = branching(found.parts)
    if not branches:
        return False
    pieces = found.has(sp.Piecewise)
    return any(pieces or risk.part.args[0] in branches for risk in hazards(found.parts))


def lack_beside(expr: Expr, others: Sequence[Expr], domain: Domain, deadline: float) -> Lack | None:
    """Return a point around which an expression has no value, though all the others have one; None if none was found.

    Where the time ends before all points were looked at, that is what comes back, and nothing is proved.

    Parameters
    ----------
    expr, others
        What should have a value wherever all the others have.
    domain, deadline
        As for :func:`lack_of_value`.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> lack_beside(sp.Piecewise((x, x > 2)), [x], EVERYWHERE, time.monotonic() + 1).why
    'none of its pieces applies there'
    >>> print(lack_beside(sp.Piecewise((x, sp.Ne(x, 2))), [x], EVERYWHERE, time.monotonic() + 1))
    None
    """
    found = anatomy([expr, *others])
    if not may_lack(anatomy([expr])):
        return None
    for shown, point in _examples([expr, *others], _points(found, domain, deadline)):
        why = _what_takes_the_value(shown[0], point, deadline)
        if why and all(_valued(other, point, deadline) for other in shown[1:]):
            return Lack(f"{why} there", point=point)
    return NOT_LOOKED_AT if time.monotonic() > deadline else None


def _points(found: Anatomy, domain: Domain, deadline: float) -> Iterator[Mapping[Symbol, sp.Rational]]:
    """Yield points of a domain: some in the box, some at all scales, and where pieces begin and end."""
    draw = found.symbols
    yield from domain.points(draw, 4, deadline=deadline, but_functions=True)
    marks = landmarks(found, domain)
    for piece in found.of(sp.Piecewise):
        for condition in _outside(piece):
            narrowed = Domain((*domain.conditions, condition), domain.box)
            yield from narrowed.points(
                draw, 3, marks=marks, in_box=False, deadline=deadline, but_functions=True
            )
    yield from domain.points(
        draw, 12, seed=1, in_box=False, marks=marks, deadline=deadline, but_functions=True
    )


def _outside(piece: sp.Piecewise) -> Iterator[Boolean]:
    """Yield what holds off the pieces, and each of the conditions."""
    conditions = [c for _, c in cast("tuple[tuple[Expr, Boolean], ...]", piece.args) if c != sp.true]
    yield sp.And(*(sp.Not(c) for c in conditions))
    yield from (c for c in conditions if not isinstance(c, sp.Eq))


def _examples(
    exprs: Sequence[Expr], points: Iterable[Mapping[Symbol, sp.Rational]]
) -> Iterator[tuple[Sequence[Expr], Mapping[Symbol, sp.Rational]]]:
    """Yield the points, each with the expressions, examples being put in for arbitrary functions."""
    unknown = _arbitrary(exprs)
    if not unknown:
        yield from ((exprs, point) for point in points)
        return
    for number, point in enumerate(points):
        examples = with_example_functions(unknown, random.Random(number))[0]
        by = dict[sp.Basic, sp.Basic](zip(unknown, examples, strict=True))
        yield [put_in(expr, by) for expr in exprs], point


def _arbitrary(exprs: Sequence[Expr]) -> list[Expr]:
    """Return the arbitrary functions in some expressions, and their derivatives."""
    found: dict[Expr, None] = {}
    stack: list[sp.Basic] = [*exprs]
    seen: set[sp.Basic] = set()
    while stack:
        part = stack.pop()
        if part in seen:
            continue
        seen.add(part)
        if isinstance(part, AppliedUndef | sp.Derivative | sp.Subs):
            found[part] = None
        else:
            stack.extend(part.args)
    return list(found)


def _what_takes_the_value(expr: Expr, point: Mapping[Symbol, sp.Rational], deadline: float) -> str:
    """Return what certainly leaves an expression without a value around a point; "" where nothing is known to."""
    try:
        with precision(BITS[-1]):
            here = formula_around(expr, point)
    except NoPiece:
        return "none of its pieces applies"
    except (*NO_VALUE, *REFUSALS):
        return ""
    return "" if _ball(here, point, deadline) is not None else _vanishing(here, point, deadline)


def _ball(expr: Expr, point: Mapping[Symbol, sp.Rational], deadline: float) -> acb | None:
    for bits in BITS:
        if time.monotonic() > deadline:
            break
        with precision(bits):
            try:
                return value(expr, point)
            except NotDecided:
                continue
            except (Undefined, Unmodelled):
                return None
    return None


def _vanishing(expr: Expr, point: Mapping[Symbol, sp.Rational], deadline: float) -> str:
    """Return what is proved to vanish around a point in an expression; "" where nothing is."""
    around, residues = _neighbourhood(point)
    for risk in hazards(anatomy([expr]).parts):
        ball = _ball(risk.argument, point, deadline)
        if ball is None or ball.contains(0):
            argument = cast("Expr", risk.argument.xreplace(residues))
            if _vanishes(argument, around, deadline):
                return str(risk)
    return ""


def _neighbourhood(point: Mapping[Symbol, sp.Rational]) -> tuple[Domain, dict[Symbol, Expr]]:
    """Return an open set around a point, and the integers with the same residue as those of the point."""
    conditions: list[Boolean] = []
    residues: dict[Symbol, Expr] = {}
    for s, number in point.items():
        if s.is_integer:
            residues[s] = RESIDUES * sp.Dummy(s.name, integer=True) + number % RESIDUES
        elif not declared_complex(s):
            width = abs(number) / 8 or sp.Rational(1, 8)
            conditions += [sp.Gt(s, number - width), sp.Lt(s, number + width)]
    return Domain(tuple(c for c in conditions if c != sp.true)), residues


RESIDUES = 12
"""Period of an integer in which an expression may have no value: every second, third, fourth or sixth number."""
