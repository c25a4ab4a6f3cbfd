"""Implicit maps, given by equations without a closed solution, refuted at one certified point.

The old variables and the parameters are rational; the new ones near them are found by Newton's method and
enclosed by the Krawczyk operator (R. Krawczyk, Computing 4 (1969) 187, doi:10.1007/BF02234767; S. M. Rump, Acta
Numerica 19 (2010) 287, §13), so that a solution certainly lies in the box. What should vanish is evaluated on
the box: where its ball keeps away from zero the claim is false. Nothing is ever proved true here.
"""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

import sympy as sp
from flint import acb, arb, arb_mat
from sympy import Symbol
from sympy.core.function import AppliedUndef

from canon.mechanics.algebra.substitution import size, symbols_of
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, holds_at, precision, value
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Counterexample, Status, Verdict
from canon.proof.kinks import off_kinks
from canon.proof.refute.sample_functions import with_example_functions
from canon.proof.trees.sympy_types import rational

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr

__all__ = ["enclosed", "refuted_at_a_point", "solved_somewhere"]

PRECISION = 192
POINTS = 8
ITERATIONS = 40
RADIUS = arb(2) ** -100
"""Half the width of the box around the solution that Newton's method found."""
DIGITS = 15
EXAMPLES = 3
"""Choices of arbitrary functions with which a solution is looked for."""
STEPS = 400_000
"""Nodes that are evaluated for solutions, of which there are mostly some hundred at a start."""
ITERATIONS_OF_A_START = 10
"""Iterations that a start counts for: where Newton's method converges it takes fewer."""
_ONE = rational(sp.Rational(1))


def refuted_at_a_point(
    equations: Sequence[Expr],
    old: Sequence[Symbol],
    new: Sequence[Symbol],
    should_vanish: Mapping[str, Expr],
    domain: Domain,
) -> Verdict | None:
    """Return FAILS with a point where something that should vanish certainly does not, or None.

    Parameters
    ----------
    equations
        As many expressions, each = 0, as there are new variables.
    old, new
        The old variables, and the new ones near them.
    should_vanish
        What should vanish on the solutions, by its name.
    domain
        Where the claim is meant; points are drawn from its box.

    Examples
    --------
    >>> import sympy as sp
    >>> q, p, Q, P = sp.symbols("q p Q P", real=True)
    >>> step = (Q - q - P/10, P - p + sp.sin(Q)/10 + Q**5/100)
    >>> print(refuted_at_a_point(step, (q, p), (Q, P), {"0": P - P, "P": P}, Domain()).question)
    P
    """
    domain = off_kinks((*equations, *should_vanish.values()), domain).strictly
    given = [
        s for s in symbols_of(*equations, *should_vanish.values(), *old, *_named(domain)) if s not in new
    ]
    drawn = _of_given(domain, given)
    with precision(PRECISION):
        for point in drawn.points(given, POINTS, seed=7):
            try:
                box = enclosed(equations, new, point, [point[s] for s in old])
                if box is None or not _allowed(domain, new, point, box):
                    continue
                for name, expression in should_vanish.items():
                    found = value(expression, point, _boxed(new, box))
                    if not found.contains(0):
                        return _refuted(name, expression, found, point, new, box)
            except (NotDecided, Undefined):
                continue
            except Unmodelled:
                return None
    return None


def solved_somewhere(
    equations: Sequence[Expr], old: Sequence[Symbol], new: Sequence[Symbol], domain: Domain
) -> bool:
    """Tell whether equations certainly have a regular real solution at some point of a domain.

    Arbitrary functions are looked at by examples.

    Parameters
    ----------
    equations, old, new, domain
        As for :func:`refuted_at_a_point`.

    Examples
    --------
    >>> import sympy as sp
    >>> q, p, Q, P = sp.symbols("q p Q P", real=True)
    >>> [solved_somewhere([first, P - p], (q, p), (Q, P), Domain()) for first in (Q - q, (Q - q)**2 + 1)]
    [True, False]
    """
    steps = 0
    arbitrary = any(equation.has(AppliedUndef) for equation in equations)
    for seed in range(EXAMPLES if arbitrary else 1):
        shown = with_example_functions(equations, random.Random(seed))[0]
        off = off_kinks(shown, domain)
        there = [off.seen(equation) for equation in shown]
        given = [s for s in symbols_of(*there, *old, *_named(off.strictly)) if s not in new]
        cost = ITERATIONS_OF_A_START * sum(size(f) + sum(size(f.diff(u)) for u in new) for f in there)
        with precision(PRECISION):
            for point, start in _starts(off.strictly, given, old, new, seed):
                if steps > STEPS:
                    return False
                steps += cost
                if _solved_near(there, new, point, start, off.strictly):
                    return True
    return False


def _starts(
    domain: Domain, given: Sequence[Symbol], old: Sequence[Symbol], new: Sequence[Symbol], seed: int
) -> Iterator[tuple[Mapping[Symbol, sp.Rational], list[sp.Rational]]]:
    """Yield points of a domain, each with new variables that are as the old ones there, and with ones."""
    drawn = _of_given(domain, given)
    for point in (*drawn.points(given, POINTS, seed=seed), *drawn.points(given, POINTS, in_box=False)):
        yield point, [point[s] for s in old]
        yield point, [_ONE] * len(new)


def _solved_near(
    equations: Sequence[Expr],
    new: Sequence[Symbol],
    point: Mapping[Symbol, sp.Rational],
    start: Sequence[sp.Rational],
    domain: Domain,
) -> bool:
    try:
        box = enclosed(equations, new, point, start)
        return box is not None and _allowed(domain, new, point, box)
    except (NotDecided, Undefined, Unmodelled):
        return False


def _named(domain: Domain) -> set[Symbol]:
    return {s for condition in domain.conditions for s in condition.free_symbols if isinstance(s, Symbol)}


def _of_given(domain: Domain, given: Sequence[Symbol]) -> Domain:
    """Return the conditions and ranges that concern what is given alone."""
    conditions = tuple(c for c in domain.conditions if c.free_symbols <= set(given))
    return Domain(conditions, {s: ends for s, ends in domain.box.items() if s in given})


def enclosed(
    equations: Sequence[Expr],
    unknowns: Sequence[Symbol],
    point: Mapping[Symbol, sp.Rational],
    start: Sequence[sp.Rational],
) -> list[arb] | None:
    """Return a box that certainly holds one real solution, and a regular Jacobian; None where none was found.

    The working precision should be that of this module.

    Examples
    --------
    >>> import sympy as sp
    >>> x = sp.Symbol("x", real=True)
    >>> with precision(PRECISION):
    ...     (root,) = enclosed([sp.cos(x) - x], [x], {}, [sp.Integer(1)])
    >>> (root.cos() - root).contains(0), root.rad() < 1e-20
    (True, True)
    """
    slopes = [[equation.diff(u) for u in unknowns] for equation in equations]
    at = _newton_root(equations, slopes, unknowns, point, start)
    if at is None:
        return None
    size = len(unknowns)
    around = [arb(a, RADIUS) for a in at]
    inverse = _inverse(_matrix(slopes, unknowns, point, at))
    whole = _column(equations, unknowns, point, around)
    if inverse is None or any(not f.rad() < RADIUS * 2**40 for f in whole.entries()):
        return None  # wide although the box is narrow: it touches a jump
    inverse = arb_mat([[inverse[i, j].mid() for j in range(size)] for i in range(size)])
    unit = arb_mat([[int(i == j) for j in range(size)] for i in range(size)])
    spread = unit - inverse * _matrix(slopes, unknowns, point, around)
    gaps = arb_mat([[a - b] for a, b in zip(around, at, strict=True)])
    image = arb_mat([[a] for a in at]) - inverse * _column(equations, unknowns, point, at) + spread * gaps
    krawczyk = image.entries()
    return krawczyk if all(a.contains_interior(k) for a, k in zip(around, krawczyk, strict=True)) else None


def _newton_root(
    equations: Sequence[Expr],
    slopes: Sequence[Sequence[Expr]],
    unknowns: Sequence[Symbol],
    point: Mapping[Symbol, sp.Rational],
    start: Sequence[sp.Rational],
) -> list[arb] | None:
    """Return where Newton's method converges to, which encloses nothing yet; None where it does not converge."""
    at = [arb(int(s.p)) / int(s.q) for s in start]
    for _ in range(ITERATIONS):
        step = _newton_step(equations, slopes, unknowns, point, at)
        if step is None:
            return None
        at = [(a - s).mid() for a, s in zip(at, step, strict=True)]
        if all(abs(s) < RADIUS / 1024 for s in step):
            return at
    return None


def _newton_step(
    equations: Sequence[Expr],
    slopes: Sequence[Sequence[Expr]],
    unknowns: Sequence[Symbol],
    point: Mapping[Symbol, sp.Rational],
    at: Sequence[arb],
) -> list[arb] | None:
    inverse = _inverse(_matrix(slopes, unknowns, point, at))
    return None if inverse is None else (inverse * _column(equations, unknowns, point, at)).entries()


def _inverse(matrix: arb_mat) -> arb_mat | None:
    try:
        return matrix.inv()
    except ZeroDivisionError:
        return None


def _matrix(
    rows: Sequence[Sequence[Expr]],
    unknowns: Sequence[Symbol],
    point: Mapping[Symbol, sp.Rational],
    at: Sequence[arb],
) -> arb_mat:
    memo = _boxed(unknowns, at)
    return arb_mat([[_real(value(f, point, memo)) for f in row] for row in rows])


def _column(
    equations: Sequence[Expr],
    unknowns: Sequence[Symbol],
    point: Mapping[Symbol, sp.Rational],
    at: Sequence[arb],
) -> arb_mat:
    return _matrix([[equation] for equation in equations], unknowns, point, at)


def _real(found: acb) -> arb:
    if not found.imag.is_zero():
        raise NotDecided("an equation is not certainly real here")
    return found.real


def _boxed(unknowns: Sequence[Symbol], box: Sequence[arb]) -> dict[sp.Basic, acb]:
    return {u: acb(b) for u, b in zip(unknowns, box, strict=True)}


def _allowed(
    domain: Domain, new: Sequence[Symbol], point: Mapping[Symbol, sp.Rational], box: Sequence[arb]
) -> bool:
    """Whether the solution certainly satisfies what is assumed of the new variables, and all conditions."""
    for symbol, ball in zip(new, box, strict=True):
        if symbol.is_integer or (symbol.is_nonzero and ball.contains(0)):
            return False
        if (symbol.is_nonnegative and not ball > 0) or (symbol.is_nonpositive and not ball < 0):
            return False
    memo = _boxed(new, box)
    return all(holds_at(condition, point, memo) for condition in domain.conditions)


def _refuted(
    name: str,
    expression: Expr,
    found: acb,
    point: Mapping[Symbol, sp.Rational],
    new: Sequence[Symbol],
    box: Sequence[arb],
) -> Verdict:
    there = {s.name: str(number) for s, number in point.items()}
    there |= {u.name: f"{b.str(DIGITS, radius=False)}…" for u, b in zip(new, box, strict=True)}
    left = found.real.str(DIGITS, radius=False)
    return Verdict(
        Status.FAILS,
        name,
        certificate="ball",
        residual=expression,
        counterexample=Counterexample(there, left, "0", DIGITS),
    )
