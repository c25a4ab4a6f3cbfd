"""Terms of one shape in a long sum, gathered as a sum over rows: what a loop wrote out becomes a loop again."""

from __future__ import annotations

import itertools
import math
import re
from typing import TYPE_CHECKING, Any, NamedTuple

import sympy as sp
from sympy import Dummy

from canon.expression.symbols.repeated_sum import RepeatedSum
from canon.expression.symbols.symbols_and_functions import symbols_and_functions

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Symbol

__all__ = ["gathered"]

_MANY = 1000
"""A sum of fewer terms is compiled before it is worth a look."""

_FEWEST = 64
"""So many terms of one shape are kept as a sum over rows."""

_DEEPEST = 40
"""Where expressions stand deeper in each other, terms are left as they are."""


class _Row(NamedTuple):
    """A term: its symbols in order, and the number that multiplies the rest of it."""

    symbols: tuple[Symbol, ...]
    factor: Expr
    rest: Expr


class _Pairs(NamedTuple):
    """All pairs of rows: which columns are of the first and which of the second, and the rows."""

    first: list[int]
    second: list[int]
    rows: list[tuple[Expr, ...]]


def gathered(function: Expr, variables: Sequence[Symbol], t: Symbol) -> Expr:
    """Return a sum of a thousand terms and more with those of one shape as sums over rows, else the function as it is.

    Terms are of one shape where they differ in their symbols and in a factor only.

    Parameters
    ----------
    function
        A function of the variables, the time and parameters.
    variables, t
        Coordinates and momenta, as many of each, and the time.

    Examples
    --------
    >>> q, p = sp.symbols("q0:500", real=True), sp.symbols("p0:500", real=True)
    >>> whole = sp.Add(*(x**2 / 2 for x in p), *(sp.cos(b - a) for a, b in zip([*q, 0], [0, *q])))
    >>> made = gathered(whole, (*q, *p), sp.Symbol("t"))
    >>> len(whole.args), len(made.args), made.xreplace({s: s.doit() for s in made.atoms(RepeatedSum)}) == whole
    (1001, 6, True)
    """
    addends = [*_addends(function)]
    if len(addends) < _MANY:
        return function
    held = [symbols_and_functions(rest)[0] - {t} for _, rest in addends]
    order, half = _order(variables, {*itertools.chain(*held)}), len(variables) // 2
    forms, shapes = _Forms(), dict[Any, list[_Row]]()
    for (factor, rest), unordered in zip(addends, held, strict=True):
        symbols = tuple(sorted(unordered, key=order.__getitem__))
        form = forms.number(rest, {s: k for k, s in enumerate(symbols)}, _DEEPEST)
        if form is None:
            return function
        # Coordinates are summed apart from momenta, however alike q² and p² are.
        of_momenta = tuple(half <= order[s] < 2 * half for s in symbols)
        shapes.setdefault((form, of_momenta), []).append(_Row(symbols, factor, rest))
    single = [row.factor * row.rest for rows in shapes.values() if len(rows) < _FEWEST for row in rows]
    many = [rows for rows in shapes.values() if len(rows) >= _FEWEST]
    return sp.Add(*single, *_sums(many, order, 2 * half)) if many else function


def _addends(function: Expr) -> Iterator[tuple[Expr, Expr]]:
    """Return the terms of a sum, each as a number and a rest; what multiplies a long sum multiplies each term of it."""
    for addend in sp.Add.make_args(function):
        factors = addend.args if isinstance(addend, sp.Mul) else ()
        long = [each for each in factors if isinstance(each, sp.Add) and len(each.args) >= _FEWEST]
        if len(long) == 1:
            others = sp.Mul(*(each for each in factors if each is not long[0]))
            yield from ((others * each).as_coeff_Mul() for each in long[0].args)
        else:
            yield addend.as_coeff_Mul()


def _order(variables: Sequence[Symbol], held: set[Any]) -> dict[Any, int]:
    """Return the places of symbols: the variables, then parameters by their names, m9 before m10."""
    others = held.difference(variables)
    named = sorted(others, key=lambda s: [(len(part), part) for part in re.split(r"(\d+)", s.name)])
    return {s: k for k, s in enumerate((*variables, *named))}


class _Forms:
    """Numbers for what is equal of expressions that differ in their symbols only."""

    def __init__(self) -> None:
        self._known: dict[Any, int] = {}

    def number(self, expression: Any, place: Mapping[Any, int], deepest: int) -> int | None:
        """Return the number of an expression whose symbols have these places in a term; None of what is too deep."""
        if not expression.args:
            found = place.get(expression)
            return self._of(expression) if found is None else -1 - found
        parts = [self.number(each, place, deepest - 1) for each in expression.args] if deepest else [None]
        if None in parts:
            return None
        if isinstance(
            expression, sp.Add | sp.Mul
        ):  # SymPy orders these by the names of symbols, x10 before x9
            parts.sort()  # pyright: ignore[reportCallIssue]
        return self._of((expression.func, *parts))

    def _of(self, form: Any) -> int:
        return self._known.setdefault(form, len(self._known))


def _sums(shapes: Sequence[list[_Row]], order: Mapping[Any, int], variables: int) -> Iterator[Expr]:
    """Return the sums over the rows of each shape; shapes with the same rows are one sum."""
    most = max(len(rows[0].symbols) for rows in shapes)
    slots, slot_of_factor = [Dummy(f"x{k}") for k in range(most)], Dummy("c")
    terms: dict[tuple[tuple[Expr, ...], ...], Expr] = {}
    for rows in shapes:
        rows.sort(key=lambda row: [order[s] for s in row.symbols])
        one_factor = len({row.factor for row in rows}) == 1
        factor = rows[0].factor if one_factor else slot_of_factor
        term = factor * rows[0].rest.xreplace(dict(zip(rows[0].symbols, slots, strict=False)))
        columns = [*zip(*(row.symbols for row in rows), strict=True)]
        key = (*columns, () if one_factor else tuple(row.factor for row in rows))
        terms[key] = terms.get(key, sp.Integer(0)) + term
    for (*columns, factors), term in terms.items():
        named = dict(zip(slots, columns, strict=False)) | ({slot_of_factor: factors} if factors else {})
        yield _sum_over(term, named, order, variables)


def _sum_over(
    term: Expr, columns: Mapping[Dummy, Sequence[Expr]], order: Mapping[Any, int], variables: int
) -> RepeatedSum:
    same: dict[Any, Any] = {slot: column[0] for slot, column in columns.items() if len({*column}) == 1}
    of_the_rest: Any = term.xreplace(same)
    slots = [slot for slot in columns if slot not in same]
    rows = [*zip(*(columns[slot] for slot in slots), strict=True)]
    moving = sum(order.get(each, variables) < variables for each in rows[0])
    pairs = _as_pairs(rows, moving)
    if pairs is None:
        return RepeatedSum(of_the_rest, slots, zip(*rows, strict=True))
    both = [slots[k] for k in (*pairs.first, *pairs.second)]
    return RepeatedSum(of_the_rest, both, zip(*pairs.rows, strict=True), pairs=True)


def _as_pairs(rows: Sequence[tuple[Expr, ...]], moving: int) -> _Pairs | None:
    """Return rows as those of all pairs of bodies, (x_i, y_i, x_j, y_j, m_i, m_j); None where they are not."""
    width, count = len(rows[0]), (1 + math.isqrt(1 + 8 * len(rows))) // 2
    if width % 2 or moving % 2 or count * (count - 1) != 2 * len(rows):
        return None
    first = [*range(moving // 2), *range(moving, width, 2)]
    second = [*range(moving // 2, moving), *range(moving + 1, width, 2)]
    ends = [(tuple(row[k] for k in first), tuple(row[k] for k in second)) for row in rows]
    bodies = [*dict.fromkeys(itertools.chain(*ends))]
    # Rows are sorted, so that these begin with those of the first body, which meets the others in turn.
    return _Pairs(first, second, bodies) if ends == [*itertools.combinations(bodies, 2)] else None
