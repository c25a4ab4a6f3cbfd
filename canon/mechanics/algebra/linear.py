"""Elimination over expressions: solving, rank and null directions without a symbolic inverse.

Entries stay as they are built; only pivots are asked whether they vanish, and the proof room answers that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.mechanics.algebra.substitution import exchanged, size
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import Evidence, Status, Undecided, Verdict
from canon.proof.kinks import WITH_PIECES, vanishes_off_kinks
from canon.proof.refute.largest_minor import determinant
from canon.proof.zero_pieces import has_hidden_pieces, zero_piece

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "Elimination",
    "SingularMatrixError",
    "eliminate",
    "is_plainly_nonzero",
    "is_regular",
    "solve",
    "solve_affine",
]


class SingularMatrixError(ValueError):
    """Raised where a matrix that has to be regular is singular.

    Parameters
    ----------
    message
        What was wrong and what to do instead.
    null_direction
        The components v with A v = 0.
    """

    def __init__(self, message: str, null_direction: tuple[Expr, ...]) -> None:
        super().__init__(message)
        self.null_direction = null_direction

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes this error again, in another process too."""
        return type(self), (str(self), self.null_direction)


@dataclass(frozen=True)
class Elimination:
    """The row echelon form that elimination reached.

    Parameters
    ----------
    rows
        The rows of (A | B) after elimination, pivot rows first.
    pivots
        The column of the pivot of each of the first rows.
    columns
        How many columns belong to A.
    order
        Which row of (A | B) each row came from. Where a symmetric A kept its order, the pivots are D of
        A = L D Lᵀ and the right-hand side has become L⁻¹ B.
    assumed
        What the zero tests of the pivots took for granted.
    """

    rows: tuple[tuple[Expr, ...], ...]
    pivots: tuple[int, ...]
    columns: int
    order: tuple[int, ...]
    assumed: tuple[str, ...] = ()

    @property
    def rank(self) -> int:
        """The rank at generic points."""
        return len(self.pivots)

    @cached_property
    def null_directions(self) -> tuple[tuple[Expr, ...], ...]:
        """A basis of the v with A v = 0, each free of denominators where they are common.

        Each has a component that the others have not: that of a column without pivot.
        """
        free = [j for j in range(self.columns) if j not in self.pivots]
        return tuple(self._null_direction(j) for j in free)

    @cached_property
    def null_direction(self) -> tuple[Expr, ...] | None:
        """One v with A v = 0, or None."""
        return self.null_directions[0] if self.null_directions else None

    def _null_direction(self, free: int) -> tuple[Expr, ...]:
        direction: list[Expr] = [sp.S.Zero] * self.columns
        direction[free] = sp.S.One
        for row, j in reversed(list(zip(self.rows, self.pivots, strict=False))):
            total = sp.Add(*(row[k] * direction[k] for k in range(j + 1, self.columns)))
            direction[j] = sp.cancel(-total / row[j])
        denominator = sp.lcm([sp.denom(v) for v in direction])
        return tuple(sp.cancel(v * denominator) for v in direction)

    def back_substituted(self) -> tuple[tuple[Expr, ...], ...]:
        """Return X with A X = B, one tuple a row of X; A must have full column rank."""
        width = len(self.rows[0]) - self.columns
        solution: list[tuple[Expr, ...]] = [()] * self.columns
        for row, j in reversed(list(zip(self.rows, self.pivots, strict=False))):
            solution[j] = tuple(
                (
                    row[self.columns + b]
                    - sp.Add(*(row[k] * solution[k][b] for k in range(j + 1, self.columns)))
                )
                / row[j]
                for b in range(width)
            )
        return tuple(solution)


def eliminate(
    matrix: sp.MatrixBase, right: sp.MatrixBase | None = None, domain: Domain | None = None
) -> Elimination:
    """Bring (A | B) to row echelon form with pivots that certainly do not vanish identically.

    The diagonal is preferred where A is symmetric, the simplest entry of the column elsewhere.

    Parameters
    ----------
    matrix
        A, of any shape.
    right
        B with as many rows as A; nothing where only the rank matters.
    domain
        Where the entries are meant; a pivot must not vanish identically there.

    Raises
    ------
    Undecided
        Where no entry of a column is certainly nonzero and one is not certainly zero.

    Examples
    --------
    >>> from sympy import Matrix, symbols
    >>> m = symbols("m", positive=True)
    >>> eliminate(Matrix([[m, -m], [-m, m]])).null_direction
    (1, 1)
    """
    domain = as_domain(domain)
    whole = matrix if right is None else matrix.row_join(right)
    rows: list[list[Expr]] = [list(whole.row(i)) for i in range(whole.rows)]
    order = list(range(whole.rows))
    symmetric = matrix.rows == matrix.cols and matrix == matrix.T
    pivots: list[int] = []
    assumed: dict[str, None] = {}
    for j in range(matrix.cols):
        top = len(pivots)
        chosen = _pivot_row(rows, top, j, domain, assumed, by_size=not symmetric)
        if chosen is None:
            continue
        rows[top], rows[chosen] = rows[chosen], rows[top]
        order[top], order[chosen] = order[chosen], order[top]
        for i in range(top + 1, len(rows)):
            if rows[i][j] != 0:
                factor = rows[i][j] / rows[top][j]
                rows[i] = [a if b == 0 else a - factor * b for a, b in zip(rows[i], rows[top], strict=True)]
                rows[i][j] = sp.S.Zero
        pivots.append(j)
    return Elimination(tuple(map(tuple, rows)), tuple(pivots), matrix.cols, tuple(order), tuple(assumed))


def solve(
    matrix: sp.MatrixBase, right: sp.MatrixBase, domain: Domain | None = None, name: str = "the matrix"
) -> sp.Matrix:
    """Return X with A X = B for a square A, by elimination.

    Raises
    ------
    SingularMatrixError
        With the null direction, where A is singular at every point.

    Examples
    --------
    >>> from sympy import Matrix, symbols
    >>> m = symbols("m", positive=True)
    >>> solve(Matrix([[2 * m, 0], [0, m]]), Matrix([4, 3 * m]))
    Matrix([
    [2/m],
    [  3]])
    """
    eliminated = eliminate(matrix, right, domain)
    null = eliminated.null_direction
    if null is not None:
        raise SingularMatrixError(
            f"{name} is singular: it maps the direction ({_listed(null)}) to zero", null
        )
    return sp.Matrix([list(row) for row in eliminated.back_substituted()])


def is_regular(matrix: sp.MatrixBase, domain: Domain | None = None, name: str = "the matrix") -> Verdict:
    """Tell whether a square matrix is regular at generic points of the domain.

    Without pieces one nonzero value of the determinant is enough, as it is analytic. With pieces, or where a root, arc
    or logarithm in it may step at a pole, the determinant must be proved to vanish on no open part of the domain.

    Returns
    -------
    Verdict
        FAILS names the null direction as evidence; UNDECIDED where a pivot's zero test was not decided.

    Examples
    --------
    >>> from sympy import Matrix, symbols
    >>> a = symbols("a", real=True)
    >>> is_regular(Matrix([[a, 1], [a**2, a]])).status.name
    'FAILS'
    """
    question = f"{name} is regular"
    try:
        eliminated = eliminate(matrix, domain=domain)
    except Undecided as undecided:
        return Verdict(Status.UNDECIDED, question, evidence=(Evidence("pivot", str(undecided)),))
    null = eliminated.null_direction
    if null is None:
        on_pieces = _on_pieces(matrix, as_domain(domain), name)
        if on_pieces is not None:
            return on_pieces
        return Verdict(Status.HOLDS, question, certificate="exact", assumed=eliminated.assumed)
    return Verdict(
        Status.FAILS,
        question,
        certificate="exact",
        assumed=eliminated.assumed,
        evidence=(Evidence("null direction", f"({_listed(null)})"),),
        feedback=f"{name} is singular: it maps the direction ({_listed(null)}) to zero",
    )


def _on_pieces(matrix: sp.MatrixBase, domain: Domain, name: str) -> Verdict | None:
    """Return what is known of a matrix with pieces; None where it has none, or is proved to be regular on each."""
    entries = sp.Add(*(sp.Dummy() * entry for entry in matrix.flat()))
    if not (entries.has(*WITH_PIECES) or has_hidden_pieces(entries, domain)):
        return None
    # SymPy's own determinant cancels on the way, which takes minutes where roots are nested.
    where = zero_piece(determinant([list(row) for row in matrix.tolist()]), domain)
    if where == "":
        return None
    question = f"{name} is regular"
    if where is None:
        why = f"{name} has pieces, and may be singular on one of them; narrow the domain to one piece"
        return Verdict(Status.UNDECIDED, question, evidence=(Evidence("pieces", why),), feedback=why)
    return Verdict(Status.FAILS, question, "exact", feedback=f"{name} is singular where {where}")


def _pivot_row(
    rows: list[list[Expr]], top: int, column: int, domain: Domain, assumed: dict[str, None], *, by_size: bool
) -> int | None:
    open_: Expr | None = None
    candidates = [i for i in range(top, len(rows)) if rows[i][column] != 0]
    for i in sorted(candidates, key=lambda i: (_complexity(rows[i][column]) if by_size else 0, i)):
        entry = rows[i][column]
        if is_plainly_nonzero(entry):
            return i
        verdict = vanishes_off_kinks(entry, domain)
        if verdict.fails:
            assumed.update(dict.fromkeys(verdict.assumed))
            return i
        if verdict.holds:
            rows[i][column] = sp.S.Zero
        else:
            open_ = entry
    if open_ is not None:
        raise Undecided(f"whether the pivot {open_} vanishes was not decided; narrow the domain")
    return None


def _complexity(entry: Expr) -> int:
    return 0 if is_plainly_nonzero(entry) else size(entry)


def is_plainly_nonzero(entry: Expr) -> bool:
    """Tell whether an entry is a product of nonzero numbers and of powers of positive or nonzero symbols.

    Examples
    --------
    >>> from sympy import symbols
    >>> m, x = symbols("m", positive=True), symbols("x", real=True)
    >>> is_plainly_nonzero(m / 2), is_plainly_nonzero(m * x)
    (True, False)
    """
    factors = sp.Mul.make_args(entry)
    return all(
        factor != 0
        if factor.is_Rational
        else base.is_Symbol and base.is_nonzero is True and exponent.is_Integer
        for factor in factors
        for base, exponent in [factor.as_base_exp()]
    )


def _listed(direction: Sequence[Expr]) -> str:
    return ", ".join(map(str, direction))


def solve_affine(
    equations: Sequence[Expr],
    unknowns: Sequence[Symbol],
    domain: Domain | None = None,
    name: str = "the matrix of the equations",
) -> dict[Symbol, Expr]:
    """Return the unknowns that solve a square system, each expression = 0 and affine in them.

    Raises
    ------
    SingularMatrixError
        Where the system does not determine them.
    Undecided
        Where that could not be told.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y, a = symbols("x y a")
    >>> solve_affine([x + y - a, x - y], [x, y])
    {x: a/2, y: a/2}
    """
    at_rest = dict.fromkeys(unknowns, sp.S.Zero)
    matrix = sp.Matrix([[equation.diff(u) for u in unknowns] for equation in equations])
    right = sp.Matrix([-exchanged(equation, at_rest) for equation in equations])
    return dict(zip(unknowns, solve(matrix, right, domain, name).flat(), strict=True))
