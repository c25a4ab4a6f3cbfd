"""Sums of one term over many rows of arguments, kept as the term and the rows: a SymPy expression of a few nodes.

A chain of 10,000 sites is two terms and a list of sites. Written out, SymPy, the expression graph and the compiler meet
each of its 30,000 terms; kept as it is, each meets one. What knows nothing of such sums sees them written out.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import sympy as sp
from mpmath.libmp import prec_to_dps
from sympy import Dummy, Expr, Symbol, Tuple
from sympy.printing.precedence import PRECEDENCE

from canon.cached_property import cached_property

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from sympy.printing.printer import Printer

__all__ = ["RepeatedSum", "sums_within", "written_out"]

_FEWEST = 64
"""Sums of fewer terms are written out."""


class RepeatedSum(Expr):
    """Σ f(x₁, …, x_k) over rows of arguments, or Σ f(x, y) over every pair of rows.

    Parameters
    ----------
    term
        f, in the symbols that stand for its arguments, and parameters.
    slots
        Those symbols; over pairs first those of the first row, then those of the second.
    columns
        For each slot of a row its arguments, as many for each: row i is what stands at place i of all columns.
    pairs
        Whether the sum goes over pairs i < j of rows rather than over rows.

    Examples
    --------
    >>> from sympy import Dummy, symbols
    >>> a, b = Dummy("a"), Dummy("b")
    >>> x = symbols("x0:3")
    >>> chain = RepeatedSum((b - a)**2, [a, b], [x[:-1], x[1:]])
    >>> written_out(chain)
    (-x0 + x1)**2 + (-x1 + x2)**2
    >>> chain.diff(x[0])
    2*x0 - 2*x1
    """

    is_commutative = True
    precedence = PRECEDENCE["Mul"]

    def __new__(
        cls, term: Any, slots: Iterable[Any], columns: Iterable[Iterable[Any]], pairs: Any = sp.false
    ) -> RepeatedSum:
        """Return the sum; the arguments may be SymPy's own, as they come from an expression that is taken apart."""
        rows = Tuple(*(column if isinstance(column, Tuple) else Tuple(*column) for column in columns))
        return Expr.__new__(
            cls, sp.sympify(term, strict=True), Tuple(*slots), rows, sp.true if pairs else sp.false
        )

    @property
    def _given(self) -> tuple[Any, Any, Any, Any]:
        term, slots, columns, pairs = self.args
        return term, slots, columns, pairs

    @property
    def term(self) -> Expr:
        """The term f."""
        return self._given[0]

    @property
    def slots(self) -> tuple[Symbol, ...]:
        """The symbols of f that stand for its arguments."""
        return self._given[1].args

    @property
    def columns(self) -> tuple[tuple[Expr, ...], ...]:
        """The arguments by slot of a row."""
        return tuple(column.args for column in self._given[2].args)

    @property
    def pairs(self) -> bool:
        """Whether the sum goes over pairs of rows."""
        return self._given[3] is sp.true

    @property
    def rows(self) -> list[tuple[Expr, ...]]:
        """The rows of arguments."""
        return list(zip(*self.columns, strict=True))

    @property
    def length(self) -> int:
        """How many terms it has."""
        rows = len(self.columns[0])
        return rows * (rows - 1) // 2 if self.pairs else rows

    @property
    def arguments(self) -> Iterator[tuple[Expr, ...]]:
        """The arguments of f, term by term."""
        if not self.pairs:
            return iter(self.rows)
        return (first + second for first, second in itertools.combinations(self.rows, 2))

    def of(self, term: Expr) -> RepeatedSum:
        """Return the sum of another term over the same arguments."""
        return RepeatedSum(term, *self._given[1:])

    @property
    def free_symbols(self) -> set[Any]:
        """The symbols of the sum; those that stand for arguments are none of them."""
        return set(self._held)

    @cached_property
    def _held(self) -> frozenset[Any]:
        held: set[Any] = self.term.free_symbols - {*self.slots}
        arguments = {*itertools.chain(*self.columns)}
        symbols = {each for each in arguments if isinstance(each, Symbol)}
        return frozenset(held.union(symbols, *(each.free_symbols for each in arguments - symbols)))

    @property
    def depth(self) -> int:
        """How deep sums stand in each other, 1 where none stands in the term."""
        return 1 + max((each.depth for each in sums_within(self.term)), default=0)

    @property
    def is_long(self) -> bool:
        """Whether it is worth to be kept: short ones are written out, and then the compiler sees every term."""
        return self.length >= _FEWEST

    def doit(self, **_hints: Any) -> Expr:
        """Return the sum written out, sums in its term included."""
        term = written_out(self.term)
        return sp.Add(*(written_out(self._at(term, row)) for row in self.arguments))

    def _xreplace(self, rule: Any) -> Any:
        """Put expressions for others, but for the symbols of arguments, which mean nothing outside."""
        if self in rule:
            return rule[self], True
        outside = {old: new for old, new in rule.items() if old not in self.slots}
        whole = self
        if any({*self.slots} & getattr(new, "free_symbols", set()) for new in outside.values()):
            other: dict[Any, Any] = {slot: Dummy(slot.name, real=True) for slot in self.slots}
            whole = RepeatedSum(self.term.xreplace(other), other.values(), *self._given[2:])
        term, in_term = whole.term._xreplace(outside)  # noqa: SLF001, what SymPy's own classes override and call
        columns, in_columns = whole._given[2]._xreplace(rule)  # noqa: SLF001
        if not (in_term or in_columns):
            return self, False
        return RepeatedSum(term, whole.slots, columns, self.pairs), True

    def _at(self, f: Expr, row: Sequence[Expr]) -> Expr:
        placed: Any = f.xreplace(dict(zip(self.slots, row, strict=True)))
        return placed

    @cached_property
    def _holding(self) -> dict[Any, list[int]]:
        """The rows in which a symbol stands, by symbol."""
        found: dict[Any, list[int]] = {}
        for i, row in enumerate(self.rows):
            for symbol in {s for each in row for s in each.free_symbols}:
                found.setdefault(symbol, []).append(i)
        return found

    def _eval_derivative(self, s: Any) -> Expr:
        inner = sp.Integer(0) if s in self.slots else self.term.diff(s)
        whole = list[Expr]() if inner == 0 else list[Expr]([self.of(inner)])
        slopes = [self.term.diff(slot) for slot in self.slots]
        for row in self._rows_with(s):
            chained = zip(slopes, row, strict=True)
            whole += [self._at(slope, row) * each.diff(s) for slope, each in chained if each.has(s)]
        return sp.Add(*whole)

    def _rows_with(self, s: Any) -> Iterator[tuple[Expr, ...]]:
        """Return the arguments of the terms in which a symbol stands."""
        rows, own = self.rows, self._holding.get(s, [])
        if not self.pairs:
            return (rows[i] for i in own)
        held = {*own}
        partners = ((i, j) for i in own for j in range(len(rows)) if j not in held or j > i)
        return (rows[min(pair)] + rows[max(pair)] for pair in partners)

    def _eval_evalf(self, prec: int) -> Any:
        return self.doit().evalf(prec_to_dps(prec))

    def _eval_is_polynomial(self, syms: Any) -> Any:
        return self.doit().is_polynomial(*syms)

    def _shown(self) -> Expr:
        """Return the term with letters for its arguments, a_i, b_i …, and of the second of a pair a_j, b_j …."""
        width = len(self.columns)
        letters = [Symbol(f"{chr(97 + k % width % 26)}_{'ij'[k // width]}") for k in range(len(self.slots))]
        return self._at(self.term, letters)

    def _sympystr(self, printer: Printer) -> str:
        count, first = len(self.columns[0]), ", ".join(printer.doprint(each) for each in self.rows[0])
        letters = ", ".join(chr(97 + k % 26) for k in range(len(self.columns)))
        over = f"i < j = 1…{count}" if self.pairs else f"i = 1…{count}"
        return f"Sum({printer.doprint(self._shown())}, {over}, ({letters})_1 = ({first}))"

    def _latex(self, printer: Printer) -> str:
        count = len(self.columns[0])
        index = rf"1 \le i < j \le {count}" if self.pairs else f"i = 1 \\ldots {count}"
        return rf"\sum_{{{index}}} \left({printer.doprint(self._shown())}\right)"

    def _code(self, printer: Printer) -> str:
        """Return the sum written out in the language of a printer of code."""
        return f"({printer.doprint(self.doit())})"

    _pythoncode = _numpycode = _scipycode = _mpmathcode = _lambdacode = _ccode = _code


def sums_within(expression: Any) -> set[RepeatedSum]:
    """Return the sums in an expression, those inside other sums aside; nothing recurses, however deep it is."""
    if isinstance(expression, RepeatedSum):
        return {expression}
    found, seen = set[RepeatedSum](), set[int]()
    waiting = [expression] if isinstance(expression, sp.Basic) else []
    while waiting:
        for each in waiting.pop().args:
            if isinstance(each, RepeatedSum):
                found.add(each)
            elif each.args and id(each) not in seen:
                seen.add(id(each))
                waiting.append(each)
    return found


def written_out(expression: Any) -> Any:
    """Return an expression with its sums over rows written out, and everything else as it is.

    Examples
    --------
    >>> from canon.mechanics import row_sum
    >>> from sympy import symbols
    >>> written_out(1 + row_sum(lambda x: x**2, symbols("x y")))
    x**2 + y**2 + 1
    """
    found = sums_within(expression)
    return expression.xreplace({each: each.doit() for each in found}) if found else expression
