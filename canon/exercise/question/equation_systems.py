"""Systems of equations of motion, two of them compared as the claim numbers and names them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp
from sympy.core.function import AppliedUndef

from canon.expression.symbols.symbol import Coordinate
from canon.mechanics.algebra.substitution import exchanged, substitute, symbols_of
from canon.mechanics.lagrange.hidden_constraints import all_motions
from canon.proof.domain.verdict import Status, Undecided, Verdict
from canon.proof.equivalence import NotAffineError, Stray, not_affine, systems_compared, without_solution
from canon.proof.kinks import off_kinks, vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sympy import Expr, Symbol

    from canon.exercise.question.deadline import Deadline
    from canon.proof.domain.domain import Domain

__all__ = ["AFFINE", "same_equations"]

AFFINE = "the equations are affine in what they determine"

SECONDS = 1.0
"""Time for the question whether one equation holds on the motions of others."""

LONGEST_FORMULA = 200
"""Characters of an equation that is still written out in a sentence."""


def same_equations(
    claimed: tuple[Expr, ...],
    right: tuple[Expr, ...],
    unknowns: tuple[Symbol, ...],
    domain: Domain,
    deadline: Deadline,
    before: int = 0,
    time: Symbol | None = None,
) -> Verdict:
    """Tell whether two systems, affine in the unknowns, have the same solutions at generic points.

    The claim counts its equations from the one after the first ``before``. Where the right system binds the state, the
    rates of its equations belong to it too: they are looked at where the ``time`` is given. A verdict that turned on an
    equation that is not affine answers the question ``AFFINE``.
    """
    off = off_kinks((*claimed, *right), domain)
    claimed, right = (tuple(map(off.seen, system)) for system in (claimed, right))
    apart = [(i, part) for i, equation in enumerate(claimed) for part in _real_equations(equation)]
    numbers, claimed = [i - before for i, _ in apart], tuple(part for _, part in apart)
    for i, equation in zip(numbers, claimed, strict=True):
        slopes = sp.Matrix([[equation.diff(a).diff(b) for b in unknowns] for a in unknowns])
        affine = vanishes_off_kinks(slopes, domain, deadline.left)
        if not affine.holds:
            why = f"equation {i + 1} is not affine in {_listed(unknowns)}"
            return replace(affine, question=AFFINE, residual=equation, feedback=why)

    def said(stray: Stray) -> str:
        return _with_formula(_does_not_follow(stray, numbers), f"{stray.equation} = 0")

    try:
        verdict = systems_compared(claimed, right, unknowns, domain, deadline.left, said)
    except NotAffineError as error:  # |u| + 1 = 0 has no second derivative off its kink
        return Verdict(Status.FAILS, AFFINE, "exact", feedback=_not_affine(error, numbers))
    if verdict.holds and without_solution(right, unknowns, domain):
        lower = _equations_of_lower_order(claimed, right, unknowns, domain, deadline, said)
        if lower.fails and not _have_other_motions(claimed, right, unknowns, domain, time):
            return Verdict(Status.HOLDS, lower.question, "exact")
        return lower
    return verdict


def _real_equations(equation: Expr) -> tuple[Expr, ...]:
    """Return the real equations that one with i says: m (ẍ + i ÿ) + k (x + i y) = 0 says two.

    Raises
    ------
    Undecided
        Where its real and imaginary parts are not known.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> _real_equations(x + sp.I * y), _real_equations(x - y)
    ((x, y), (x - y,))
    """
    if not equation.has(sp.I):
        return (equation,)
    arbitrary = equation.atoms(AppliedUndef, sp.Derivative, sp.Subs)
    jets: dict[Expr, Expr] = {f: sp.Dummy(real=True) for f in arbitrary if not f.has(sp.I)}
    parts = exchanged(equation, jets).as_real_imag()
    if any(part.has(sp.I, sp.re, sp.im, sp.arg, sp.conjugate) for part in parts):
        raise Undecided("an equation holds i in a way that was not taken apart; claim both of its parts")
    functions = {symbol: f for f, symbol in jets.items()}
    return tuple(exchanged(part, functions) for part in parts if part != 0) or (sp.S.Zero,)


def _have_other_motions(
    claimed: tuple[Expr, ...],
    right: tuple[Expr, ...],
    unknowns: tuple[Symbol, ...],
    domain: Domain,
    time: Symbol | None,
) -> bool:
    """Tell whether some motion of one system is none of the other, where one is no combination of the other.

    x'' = −x is no combination of x' = y, y' = −x, and holds on all of its motions: each equation is asked on all
    motions of the other system, the rates of equations that bind the state included.

    Raises
    ------
    Undecided
        Where that was not decided.
    """
    if time is None:
        raise Undecided("the equations bind the state, and what follows from their rates was not looked into")
    named = {s.name: s for equation in (*claimed, *right) for s in symbols_of(equation)}
    bases = [u.name.removesuffix("_ddot") for u in unknowns]
    q = [named.get(base, Coordinate(base, real=True)) for base in bases]
    for given, asked in ((right, claimed), (claimed, right)):
        motions = all_motions(given, (), q, unknowns, domain, time)
        values = [substitute(equation, motions.through) for equation in asked]
        verdicts = [vanishes_off_kinks(value, motions.branch.domain, SECONDS) for value in values]
        if any(verdict.fails for verdict in verdicts):
            return True
        if not all(verdict.holds for verdict in verdicts):
            raise Undecided("whether an equation holds on all motions of the others was not decided")
    return False


def _equations_of_lower_order(
    claimed: tuple[Expr, ...],
    right: tuple[Expr, ...],
    unknowns: tuple[Symbol, ...],
    domain: Domain,
    deadline: Deadline,
    said: Callable[[Stray], str],
) -> Verdict:
    """Compare systems that no accelerations solve at a generic state, as they bind velocities or coordinates.

    With L = x ẏ − H both say ẋ = … and ẏ = …: what they determine are the velocities then.
    """
    known = {s.name: s for equation in (*claimed, *right) for s in symbols_of(equation)}
    bases = [u.name.removesuffix("_ddot").removesuffix("_dot") for u in unknowns]
    for ending in ("_dot", ""):
        names = (f"{base}{ending}" for base in bases)
        unknowns += tuple(known[n] for n in names if n in known and known[n] not in unknowns)
        try:
            verdict = systems_compared(claimed, right, unknowns, domain, deadline.left, said)
        except ValueError:
            break
        if not verdict.holds or not without_solution(right, unknowns, domain):
            return verdict
    raise Undecided("the equations bind the state in a way that is not affine; solve them for the velocities")


def _does_not_follow(stray: Stray, numbers: Sequence[int]) -> str:
    """Say which equation does not follow, counted as the claim does."""
    if stray.system == 0:
        return f"equation {numbers[stray.number] + 1} of the claim does not follow from those of motion"
    return f"equation {stray.number + 1} of motion does not follow from the claimed ones"


def _not_affine(error: NotAffineError, numbers: Sequence[int]) -> str:
    if error.which == "first":
        which = f"equation {numbers[error.number] + 1}"
    else:
        which = f"equation {error.number + 1} of motion"
    sentence, _, formula = not_affine(error.equation).partition(": ")
    return _with_formula(f"{which} is {sentence}", formula)


def _with_formula(sentence: str, formula: str) -> str:
    return f"{sentence}: {formula}" if len(formula) <= LONGEST_FORMULA else sentence


def _listed(symbols: Sequence[Symbol]) -> str:
    return ", ".join(map(str, symbols))
