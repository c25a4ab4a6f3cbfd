"""Equivalence of two systems of equations: whether they have the same solutions at generic points."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.cached_property import cached_property
from canon.expression.symbols.repeated_sum import written_out
from canon.expression.symbols.user_input import given_expression, given_kind, given_seconds, given_symbols
from canon.proof.analytic import is_analytic, proved_sign
from canon.proof.definedness.open_regimes import regimes
from canon.proof.domain.domain import EVERYWHERE, Domain, as_domain
from canon.proof.domain.verdict import Evidence, Status, Verdict
from canon.proof.kinks import off_kinks, vanishes_on_no_piece
from canon.proof.refute.largest_minor import determinant, largest_minor
from canon.proof.trees.affine_form import is_affine
from canon.proof.trees.replacement import defined_nowhere
from canon.proof.trees.sympy_types import arguments
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.proof.refute.largest_minor import Pivots, Rows

__all__ = [
    "NotAffineError",
    "Stray",
    "equivalent_equations",
    "not_affine",
    "systems_compared",
    "without_solution",
]

SAME_SOLUTIONS = "the two systems of equations have the same solutions"

GENERIC = "generic point: the coefficients' largest minor is not zero"

LONGEST_SAID = 80
"""Characters of conditions that are spelt out."""

_ORDINALS = ("first", "second")


@dataclass(frozen=True)
class Stray:
    """An equation of one of two systems that does not follow from the other; the numbers count from 0."""

    system: int
    number: int
    equation: Expr

    def __str__(self) -> str:
        own, other = _ORDINALS[self.system], _ORDINALS[1 - self.system]
        which = f"equation {self.number + 1} of the {own} system"
        return f"{which} does not follow from the {other}: {self.equation} = 0"


class NotAffineError(ValueError):
    """An equation of one of two systems that is not affine in the unknowns; the numbers count from 0."""

    def __init__(self, which: str, number: int, equation: Expr) -> None:
        super().__init__(f"equation {number + 1} of the {which} system is {not_affine(equation)}")
        self.which, self.number, self.equation = which, number, equation


def not_affine(equation: Expr) -> str:
    """Return in words that an equation is not affine, and what can be done."""
    return f"not affine in the unknowns: {equation} = 0; solve it for the unknowns or name others"


def equivalent_equations(
    system_a: Sequence[Expr],
    system_b: Sequence[Expr],
    unknowns: Sequence[Symbol],
    domain: Domain = EVERYWHERE,
    budget: float = 10.0,
) -> Verdict:
    """Decide whether two systems, each expression meaning ``expr = 0``, have the same solutions.

    Both must be affine in ``unknowns``; the remaining symbols are coefficients. The systems are
    equivalent at generic points exactly when their augmented matrices span one row space over the
    functions of those symbols: every row of either then has vanishing determinants when it borders a
    largest nonvanishing minor of the other. Two systems that both have no solution are equivalent.

    That needs coefficients without zero divisors. Where they have pieces (Abs, sign, Piecewise, integer
    symbols, roots that may change branch) a system follows from another only if the minor is proved to
    vanish nowhere on the domain, and is refuted only at a point where the minor is not zero.

    Parameters
    ----------
    system_a, system_b
        Expressions; the numbers of equations may differ.
    unknowns
        What is solved for, such as accelerations.
    domain, budget
        As for :func:`canon.proof.vanishes`.

    Returns
    -------
    Verdict
        FAILS names the equation of one system that does not follow from the other.

    Raises
    ------
    ValueError
        If an equation is not affine in the unknowns (UNDECIDED if that is not known).

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y, u, v = symbols("x y u v")
    >>> equivalent_equations([u + v - x, u - v], [2*u - x, u*y - v*y], [u, v]).status
    <Status.HOLDS: 'holds'>
    >>> print(equivalent_equations([u - x, v], [u - x], [u, v]).feedback)
    equation 2 of the first system does not follow from the second: v = 0
    """
    return systems_compared(system_a, system_b, unknowns, domain, budget, str)


def systems_compared(
    system_a: Sequence[Expr],
    system_b: Sequence[Expr],
    unknowns: Sequence[Symbol],
    domain: Domain,
    budget: float,
    said: Callable[[Stray], str],
) -> Verdict:
    """Decide what :func:`equivalent_equations` does, and say in the caller's words which equation does not follow.

    Raises
    ------
    NotAffineError
        If an equation is not affine in the unknowns.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, u, v = symbols("x u v")
    >>> def said(stray):
    ...     return f"{stray.equation} is more than the other system says"
    >>> systems_compared([u - x, v], [u - x], [u, v], EVERYWHERE, 1.0, said).feedback
    'v is more than the other system says'
    """
    unknowns, domain = given_symbols(unknowns, "unknowns"), as_domain(domain)
    for name, system in (("system_a", system_a), ("system_b", system_b)):
        given_kind(system, (list, tuple), name, "put a single equation into brackets")
    start = time.monotonic()
    deadline = start + given_seconds(budget)
    given = [
        [
            written_out(given_expression(e, f"equation {i} of the {which} system"))
            for i, e in enumerate(system, start=1)
        ]
        for which, system in zip(_ORDINALS, (system_a, system_b), strict=True)
    ]
    off = off_kinks([e for system in given for e in system], domain)
    first, second = ([off.seen(e) for e in system] for system in given)
    verdict = off.ask(lambda there: _equivalent(first, second, unknowns, there, deadline, said))
    refuted = None
    if verdict.undecided:
        refuted = _refuted_in_a_regime(first, second, unknowns, off.domain, deadline, said)
    return replace(verdict if refuted is None else refuted, seconds=time.monotonic() - start)


def _refuted_in_a_regime(
    system_a: Sequence[Expr],
    system_b: Sequence[Expr],
    unknowns: Sequence[Symbol],
    domain: Domain,
    deadline: float,
    said: Callable[[Stray], str],
) -> Verdict | None:
    """Return that systems differ on an open part of the domain on which all their pieces are one formula each.

    (|x| + x)(ẍ + x) = 0 is ẍ + x = 0 where x > 0, and says nothing where x < 0. A regime is a part of the domain, so a
    verdict FAILS on it is one on the whole; that systems agree there proves nothing. Regimes are of states: where
    pieces turn on the unknowns, the solutions may lie in other ones.
    """
    for regime in regimes([*system_a, *system_b], domain, deadline):
        if any(condition.has(*unknowns) for condition in regime.conditions):
            continue
        a, b = regime.formulas[: len(system_a)], regime.formulas[len(system_a) :]
        where = f" where {regime}" if len(str(regime)) <= LONGEST_SAID else ""
        try:
            verdict = _equivalent(
                a, b, unknowns, regime.domain, deadline, lambda stray, where=where: f"{said(stray)}{where}"
            )
        except NotAffineError:
            continue
        if verdict.fails:
            return verdict
    return None


def _equivalent(
    system_a: Sequence[Expr],
    system_b: Sequence[Expr],
    unknowns: Sequence[Symbol],
    domain: Domain,
    deadline: float,
    said: Callable[[Stray], str],
) -> Verdict:
    a = _augmented(system_a, unknowns, domain, "first", deadline)
    b = _augmented(system_b, unknowns, domain, "second", deadline)
    unknown = [system for system in (a, b) if isinstance(system, str)]
    if isinstance(a, str) or isinstance(b, str):
        verdict = Verdict(Status.UNDECIDED, evidence=tuple(Evidence("affine", text) for text in unknown))
        return replace(verdict, question=SAME_SOLUTIONS)
    field = is_analytic([entry for system in (a, b) for row in system for entry in row], domain)
    first, second = (
        _Basis(rows, name, domain, deadline, field) for rows, name in zip((a, b), _ORDINALS, strict=True)
    )
    extra = _rows_follow(b, first, system_b, 1, said)
    if extra.fails:
        return replace(extra, question=SAME_SOLUTIONS)
    missing = _rows_follow(a, second, system_a, 0, said)
    worst = missing if missing.fails or extra.holds else extra
    assumed = tuple(dict.fromkeys((*extra.assumed, *missing.assumed))) if worst.holds else worst.assumed
    return replace(worst, question=SAME_SOLUTIONS, assumed=assumed)


def without_solution(system: Sequence[Expr], unknowns: Sequence[Symbol], domain: Domain = EVERYWHERE) -> bool:
    """Tell whether a system is certainly without solution at generic points of the domain.

    At some point is not enough: x u = 1 has no solution at x = 0 alone.

    Parameters
    ----------
    system, unknowns, domain
        As for :func:`equivalent_equations`.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, u, v = symbols("x u v")
    >>> without_solution([u + v, u + v - x], [u, v]), without_solution([u + v - x], [u, v])
    (True, False)
    """
    deadline = time.monotonic() + 1.0
    augmented = _augmented(system, unknowns, domain, "given", deadline)
    if isinstance(augmented, str):
        return False
    field = is_analytic([entry for row in augmented for entry in row], domain)
    basis = _Basis(augmented, "given", domain, deadline, field)
    return basis.needs_rest and basis.is_inconsistent


def _augmented(
    system: Sequence[Expr], unknowns: Sequence[Symbol], domain: Domain, which: str, deadline: float
) -> Rows | str:
    """Return slopes and rest of each equation, whose sum Σ slope·u + rest is proved to be the equation.

    A vanishing second derivative would not do: u·sign(u) and atan(tan u) have locally constant slopes.
    """
    at_rest: dict[sp.Basic, Expr] = dict.fromkeys(unknowns, sp.Integer(0))
    rows: list[tuple[Expr, ...]] = []
    for number, equation in enumerate(system, start=1):
        expr = given_expression(equation, f"equation {number} of the {which} system")
        try:
            row = [cast("Expr", expr.diff(u).xreplace(at_rest)) for u in unknowns]
        except ValueError as reason:  # SymPy keeps the derivative of floor(u) by u, and has none by 0
            raise NotAffineError(which, number - 1, expr) from reason
        row.append(cast("Expr", expr.xreplace(at_rest)))
        if not is_affine(expr, unknowns):
            again = sp.Add(*(slope * u for slope, u in zip(row, unknowns, strict=False)), row[-1])
            without_value = any(map(defined_nowhere, row))
            rebuilt = None if without_value else vanishes(expr - again, domain, deadline - time.monotonic())
            if rebuilt is None or rebuilt.fails:
                raise NotAffineError(which, number - 1, expr)
            if not rebuilt.holds:
                return f"equation {number} of the {which} system was not proved affine in the unknowns"
        rows.append(tuple(row))
    return tuple(rows)


def _rows_follow(
    rows: Rows,
    basis: _Basis,
    equations: Sequence[Expr],
    which: int,
    said: Callable[[Stray], str],
) -> Verdict:
    """Decide whether every row of one system lies in the row space of the other.

    Everything follows from a basis without solutions, one whose largest minor needs the column of the rest.
    """
    own, other = _ORDINALS[which], _ORDINALS[1 - which]
    undecided: list[Evidence] = []
    if not basis.is_sure:
        lost = f"the minor {basis.minor} of the {other} system may vanish on a piece"
        undecided.append(Evidence("rank", lost))
    if basis.needs_rest and not basis.is_inconsistent:
        unknown = f"whether the {other} system has solutions at generic points"
        return Verdict(Status.UNDECIDED, evidence=(Evidence("rank", unknown),))
    for number, row in enumerate(() if basis.needs_rest else rows):
        for verdict in basis.verdicts_on(row):
            if verdict.fails:
                stray = Stray(which, number, equations[number])
                return replace(verdict, residual=stray.equation, feedback=said(stray))
            if not verdict.holds:
                text = f"whether equation {number + 1} of the {own} system follows"
                undecided += [*verdict.evidence, Evidence("equation", text)]
    if undecided:
        return Verdict(Status.UNDECIDED, evidence=tuple(dict.fromkeys(undecided)))
    assumed = _generic(basis.minor, basis.domain) if basis.field else ()
    return Verdict(Status.HOLDS, certificate="exact", assumed=assumed)


@dataclass(frozen=True)
class _Basis:
    """A system whose row space is asked about; ``field`` tells whether its coefficients have no zero divisors."""

    rows: Rows
    name: str
    domain: Domain
    deadline: float
    field: bool

    @cached_property
    def pivots(self) -> Pivots:
        return largest_minor(self.rows, self.domain)

    @cached_property
    def minor(self) -> Expr:
        return determinant([[self.rows[i][c] for c in self.pivots.columns] for i in self.pivots.rows])

    @cached_property
    def is_sure(self) -> bool:
        """Whether the minor is proved to vanish on no piece of the domain."""
        return self._is_sure(self.minor)

    def _is_sure(self, minor: Expr) -> bool:
        domain = self.domain
        return (
            self.field
            or proved_sign(minor, domain) in ("+", "-")
            or is_analytic(_without_moduli(minor), domain)
            or vanishes_on_no_piece(minor, domain)
        )

    @property
    def needs_rest(self) -> bool:
        """Whether the largest minor that was found needs the column of the rest."""
        return bool(self.rows) and len(self.rows[0]) - 1 in self.pivots.columns

    @cached_property
    def is_inconsistent(self) -> bool:
        """Whether the slopes alone are proved to have the smaller rank; balls may only not tell them from zero."""
        rest = len(self.rows[0]) - 1
        slopes = self.pivots.left_of(rest)
        minor = determinant([[self.rows[i][c] for c in slopes.columns] for i in slopes.rows])
        outside = [row for number, row in enumerate(self.rows) if number not in slopes.rows]
        bordered = (d for row in outside for d in self._bordered(row[:rest], slopes))
        return self._is_sure(minor) and all(self._vanishes(d).holds for d in bordered)

    @cached_property
    def is_spanned(self) -> bool:
        """Whether every row is proved to depend on the pivots' rows.

        Without that a row outside the pivots' span may still follow from the basis.
        """
        others = (row for number, row in enumerate(self.rows) if number not in self.pivots.rows)
        return all(self._vanishes(d).holds for row in others for d in self._bordered(row))

    def verdicts_on(self, row: Sequence[Expr]) -> Iterator[Verdict]:
        """Yield for each border of the largest minor by a row whether its determinant vanishes."""
        for bordered in self._bordered(row):
            verdict = self._vanishes(bordered)
            if verdict.fails and not self.is_sure:
                verdict = self._vanishes(self.minor * bordered)
            if verdict.fails and not self.is_spanned:
                unknown = Evidence("rank", f"the rank of the {self.name} system is not known")
                verdict = Verdict(Status.UNDECIDED, evidence=(unknown,))
            yield verdict

    def _vanishes(self, f: Expr) -> Verdict:
        return vanishes(f, self.domain, max(0.1, self.deadline - time.monotonic()))

    def _bordered(self, row: Sequence[Expr], pivots: Pivots | None = None) -> Iterator[Expr]:
        """Border a minor, the largest if no other is given, with a row and, in turn, each of its columns outside it."""
        pivots = pivots or self.pivots
        for column in range(len(row)):
            if column not in pivots.columns:
                columns = (*pivots.columns, column)
                inner = ([self.rows[i][c] for c in columns] for i in pivots.rows)
                yield determinant([*inner, [row[c] for c in columns]])


def _without_moduli(minor: Expr) -> list[Expr]:
    """Return the factors of a minor, |g| and sign(g) as g, which vanishes where they do and nowhere else."""
    powers = [factor.as_base_exp() for factor in sp.Mul.make_args(minor)]
    return [
        (arguments(base)[0] if isinstance(base, sp.Abs | sp.sign) else base) ** exponent
        for base, exponent in powers
    ]


def _generic(minor: Expr, domain: Domain) -> tuple[str, ...]:
    """Say what a generic point is: one where the largest minor of the coefficients is not zero."""
    factors = [f.base if isinstance(f, sp.Pow) else f for f in sp.Mul.make_args(minor)]
    left = [f for f in factors if not f.is_nonzero and proved_sign(f, domain) not in ("+", "-")]
    if not left:
        return ()
    said = ", ".join(f"{f} ≠ 0" for f in left)
    return (f"generic point: {said}" if len(said) <= LONGEST_SAID else GENERIC,)
