"""Linear equations on a graph, their pivots chosen from the matrix's values at the start of the motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.symbols.user_input import counted
from canon.mechanics.at_scale.ldl import solved_on_graph

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from sympy import Symbol

    from canon.array import Array
    from canon.expression.graph.graph import Graph

__all__ = [
    "SingularAtStartError",
    "independent_rows",
    "pivots_hold",
    "refuse_infinite",
    "solved_from_start",
    "undetermined",
]

_SMALL = 1e-11
"""A singular value below this part of the largest, in units in which masses are 1, is taken for round-off."""


class SingularAtStartError(ValueError):
    """The equations do not determine the accelerations at the start."""

    def __init__(self, direction: Array) -> None:
        super().__init__(f"the matrix is singular along {direction}")
        self.direction = direction


def solved_from_start(
    graph: Graph,
    matrix: Sequence[Sequence[int]],
    right: Sequence[int],
    values: Array,
    *,
    symmetric: bool = True,
) -> tuple[int, ...]:
    """Return the nodes x with A x = right, A regular at the start.

    A symmetric positive definite matrix is factorised as L D Lᵀ, and so is one bordered by constraints (its Schur
    complement is definite); no rows are exchanged. Any other is eliminated with the row exchanges that partial
    pivoting makes at the start, which are kept for the whole motion.

    Parameters
    ----------
    graph
        The graph.
    matrix, right
        Nodes, shapes (n, n) and (n,).
    values
        The matrix's values at the start, shape (n, n).
    symmetric
        Whether A is symmetric everywhere.

    Raises
    ------
    SingularAtStartError
        It is singular there; the error has the null direction.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.expression.graph.graph import Graph
    >>> graph, (a, b) = Graph(), symbols("a b")
    >>> A, B = graph.symbol(a), graph.symbol(b)
    >>> matrix = [[graph.zero, A], [A, graph.zero]]
    >>> x = solved_from_start(graph, matrix, [A, B], np.array([[0.0, 2.0], [2.0, 0.0]]))
    >>> [graph.to_sympy(node) for node in x]
    [b/a, 1]
    """
    balanced = _balanced(values, symmetric=symmetric)
    if symmetric and _has_diagonal_pivots(balanced):
        lower = [list(row[: i + 1]) for i, row in enumerate(matrix)]
        return solved_on_graph(graph, lower, right)
    return _eliminated(graph, matrix, right, balanced)


def _balanced(values: Array, *, symmetric: bool = True) -> Array:
    """Return a matrix of numbers in the units best for it, which have nothing to do with those of a user.

    Raises
    ------
    SingularAtStartError
        It is singular.
    """
    columns = _units(values) if symmetric else _reciprocals(np.abs(values).max(axis=0, initial=0.0))
    balanced = values * columns
    rows = columns if symmetric else _reciprocals(np.abs(balanced).max(axis=1, initial=0.0))
    balanced = balanced * rows[:, np.newaxis]
    _, singular, directions = np.linalg.svd(balanced)
    if not singular.size or singular[-1] <= _SMALL * singular[0]:
        null = directions[-1] * columns
        raise SingularAtStartError(null / np.abs(null).max())
    return balanced


def pivots_hold(masses: Array, velocities: Sequence[Symbol], order: Sequence[int]) -> bool:
    """Tell whether the masses at a start are eliminated in an order, without exchanges, with no small pivot.

    Raises
    ------
    ValueError
        They are not finite, or do not determine the accelerations.
    """
    where = "the mass matrix"
    refuse_infinite(masses, where)
    try:
        balanced = _balanced(masses)
    except SingularAtStartError as singular:
        raise ValueError(undetermined(singular, velocities, where)) from None
    return _has_diagonal_pivots(balanced[np.ix_(order, order)])


def undetermined(singular: SingularAtStartError, velocities: Sequence[Symbol], where: str) -> str:
    """Return in words which accelerations are left open."""
    moved = [f"{v}" for v, share in zip(velocities, singular.direction, strict=False) if abs(share) > 1e-6]
    along = f" along {', '.join(moved)}" if moved else ""
    return (
        f"{where} is singular at the start{along}: L does not determine {counted(len(velocities), 'acceleration')} "
        "there. Use fewer coordinates, add the constraints that hold the others, or start elsewhere"
    )


def refuse_infinite(values: Array, what: str) -> None:
    """Raise ValueError where values at the start are not finite."""
    if not np.isfinite(values).all():
        raise ValueError(
            f"{what} is not finite at the start: begin inside the domain of the system's functions"
        )


def _units(values: Array) -> Array:
    """Return the units in which every mass is 1, and every constraint on velocities in such units too."""
    diagonal = np.abs(np.diagonal(values))
    masses = np.where(diagonal > 0, _reciprocals(np.sqrt(diagonal)), 0.0)
    across = np.abs(values) @ masses
    without = _reciprocals(np.sqrt(np.abs(values).max(axis=1, initial=0.0)))
    others = np.where(across > 0, _reciprocals(across), without)
    return np.where(diagonal > 0, masses, others)


def _reciprocals(sizes: Array) -> Array:
    return np.divide(1.0, sizes, out=np.ones_like(sizes), where=sizes > 0)


def independent_rows(values: Array) -> list[int]:
    """Return which rows of a matrix to keep so that the rest depends on them; the earlier of two is kept.

    Every column is measured by its largest entry, as their units differ.

    Examples
    --------
    >>> independent_rows(np.array([[1.0, 0.0], [2.0, 0.0], [0.0, 3.0]]))
    [0, 2]
    """
    kept, basis = list[int](), list[Any]()
    for i, row in enumerate(values * _reciprocals(np.abs(values).max(axis=0, initial=0.0))):
        size = np.linalg.norm(row)
        rest = row / size if size else row
        for _ in range(2):  # once more takes what rounding has left
            for each in basis:
                rest = rest - each * (each @ rest)
        left = np.linalg.norm(rest)
        if size and left > 1e-10:
            kept.append(i)
            basis.append(rest / left)
    return kept


def _has_diagonal_pivots(values: NDArray[np.float64]) -> bool:
    """Return whether elimination without exchanges meets no small pivot."""
    rest = values.copy()
    for k in range(len(rest)):
        pivot = rest[k, k]
        if abs(pivot) < 1e-6 * np.abs(values[k]).max():
            return False
        rest[k + 1 :, k:] -= np.outer(rest[k + 1 :, k] / pivot, rest[k, k:])
    return True


def _eliminated(
    graph: Graph, matrix: Sequence[Sequence[int]], right: Sequence[int], values: NDArray[np.float64]
) -> tuple[int, ...]:
    """Eliminate with the row exchanges that the values ask for."""
    n, numbers = len(right), values.copy()
    rows = [[*row, b] for row, b in zip(matrix, right, strict=True)]
    for k in range(n):
        best = k + int(np.argmax(np.abs(numbers[k:, k])))
        rows[k], rows[best] = rows[best], rows[k]
        numbers[[k, best]] = numbers[[best, k]]
        inverse = graph.power(rows[k][k], -1)
        for i in range(k + 1, n):
            if rows[i][k] == graph.zero:
                continue
            factor = graph.mul((rows[i][k], inverse))
            rows[i] = [
                graph.add((a, graph.negative(graph.mul((factor, b))))) if j > k else graph.zero
                for j, (a, b) in enumerate(zip(rows[i], rows[k], strict=True))
            ]
            numbers[i] -= numbers[i, k] / numbers[k, k] * numbers[k]
    x = [graph.zero] * n
    for i in reversed(range(n)):
        taken = [graph.negative(graph.mul((rows[i][j], x[j]))) for j in range(i + 1, n)]
        x[i] = graph.mul((graph.add((rows[i][n], *taken)), graph.power(rows[i][i], -1)))
    return tuple(x)
