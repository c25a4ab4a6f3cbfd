r"""Products and sums of matrices in one field, ``m\begin{pmatrix} \ddot x \\ \ddot y \end{pmatrix}``, by components.

Read are sums of terms that each are a factor, matrices side by side, and a vector last. Each factor and each entry is
read by itself first, at its columns; what is then written for a component has brackets around all of them.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from canon.exercise.sheet.field_texts import components_of, is_name_of_matrix

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    _Check = Callable[[str], object]
    _Known = Sequence[tuple[int, int, tuple[str, ...]]]

__all__ = ["components_of_products", "equations_of_products"]

_OPENS = re.compile(
    r"(?:\\left\s*[(\[]\s*)?\\begin\{(?P<name>(?:[pbB]|small)?matrix|array)\}(?:\{[clr| ]{1,20}\})?"
    r"|(?:\w{1,9}\.)?(?:Immutable|Mutable)?(?:Dense)?(?P<plain>Matrix|array)\(\s*(?=\[)"
)
_BRACKET_BEHIND = re.compile(r"\s*\\right\s*[)\]]")
_SPACE = r"(?:\s|\\[,;:! ])*"
_TIMES = re.compile(rf"{_SPACE}(?:\\cdot(?![A-Za-z])|\*|@)?{_SPACE}")
"""At most one sign of a product: ``**`` is a power, which is not taken for one."""
_BLANK = re.compile(r"(?:[\s$.,&]|\\[,;:! ])*")
_ZERO = re.compile(r"[\s$&.]*(?:0|\\(?:vec|mathbf|boldsymbol)\s*\{?\s*0\s*\}?)[\s$.]*")
_SIGN = re.compile(r"(?<![<>!:=])={1,2}(?!=)")
_MOST_ENTRIES = 36
_MOST_MATRICES = 8


@dataclass(frozen=True)
class _Matrix:
    """Rows of entries as text, and where the matrix stands in its field."""

    rows: tuple[tuple[str, ...], ...]
    begin: int
    end: int
    elementwise: bool = False

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.rows), len(self.rows[0])


def equations_of_products(text: str, check: _Check, known: _Known = ()) -> list[str]:
    r"""Return the equations of the components of ``M v + w = 0``; nothing where a side is no sum of vectors.

    Parameters
    ----------
    text
        The field.
    check
        Reads one factor or entry, at its columns, and raises the error that is told of it.
    known
        Vectors that are written by a letter, ``\nabla V``: where each begins and ends, and its components.

    Examples
    --------
    >>> equations_of_products("m*Matrix([x'', y'']) = -k*Matrix([x, y])", str)
    ["((m)*(x'')) = (-(k)*(x))", "((m)*(y'')) = (-(k)*(y))"]
    >>> equations_of_products("m*Matrix([x, y]) = k*Matrix([x, y, z])", str)
    []
    """
    signs = [*_SIGN.finditer(text)]
    if len(signs) != 1:
        return []
    left, right = text[: signs[0].start()], " " * signs[0].end() + text[signs[0].end() :]
    sides = [_vector(side, check, known) for side in (left, right)]
    lengths = {len(side) for side in sides if side}
    if len(lengths) != 1 or not all(
        side or _ZERO.fullmatch(said) for side, said in zip(sides, (left, right), strict=True)
    ):
        return []
    above, below = (side or ["0"] * max(lengths) for side in sides)
    return [f"{_mark(text)}{a} = {b}" for a, b in zip(above, below, strict=True)]


def components_of_products(text: str, check: _Check) -> list[str]:
    r"""Return the components of ``\frac{1}{m}\begin{pmatrix} p_x \\ p_y \end{pmatrix}``, a name before it passed over.

    Examples
    --------
    >>> components_of_products("Matrix([[0, 1], [-1, 0]])*Matrix([x, y])", str)
    ['((0)*(x) + (1)*(y))', '((-1)*(x) + (0)*(y))']
    """
    signs = [*_SIGN.finditer(text)]
    if len(signs) > 1 or (signs and not is_name_of_matrix(text[: signs[0].start()])):
        return []
    begin = signs[0].end() if signs else 0
    return [_mark(text) + one for one in _vector(" " * begin + text[begin:], check, ())]


def _mark(text: str) -> str:
    return "$" if "\\" in text or "$" in text else ""


def _vector(text: str, check: _Check, known: _Known) -> list[str]:
    """Return the components of a side as text; nothing where it is no sum of vectors."""
    matrices = sorted((*_matrices(text), *_by_letters(text, known)), key=lambda matrix: matrix.begin)
    if not matrices or sum(len(m.rows) * len(m.rows[0]) for m in matrices) > _MOST_ENTRIES * _MOST_MATRICES:
        return []
    found: list[list[str]] = []
    shapes: set[tuple[int, int]] = set()
    for begin, end in _terms(text, matrices):
        term = _term(text, begin, end, [m for m in matrices if begin <= m.begin < end], check)
        if term is None:
            return []
        components, shape = term
        found.append(components)
        shapes.add(shape)
    if len(shapes) != 1 or min(min(shapes)) != 1 or len(found[0]) == 1:
        return []
    return [" + ".join(f"({part})" for part in parts) for parts in zip(*found, strict=True)]


def _by_letters(text: str, known: _Known) -> list[_Matrix]:
    """Return the vectors of one side that are written by letters, as columns."""
    mark = _mark(text) or " "
    return [
        _Matrix(tuple((" " * (begin - 1) + mark + entry,) for entry in entries), begin, end)
        for begin, end, entries in known
        if end <= len(text) and text[begin:end].strip()
    ]


def _terms(text: str, matrices: Sequence[_Matrix]) -> list[tuple[int, int]]:
    """Return where each term of a sum begins and ends, its sign included."""
    cuts, depth, at = [0], 0, 0
    inside = {m.begin: m.end for m in matrices}
    while at < len(text):
        if at in inside:
            at = inside[at]
            continue
        depth += (text[at] in "([{") - (text[at] in ")]}")
        if text[at] in "+-−" and depth == 0 and not _BLANK.fullmatch(text[cuts[-1] : at]):
            cuts.append(at)
        at += 1
    return [*zip(cuts, [*cuts[1:], len(text)], strict=True)]


def _term(
    text: str, begin: int, end: int, matrices: Sequence[_Matrix], check: _Check
) -> tuple[list[str], tuple[int, int]] | None:
    """Return the entries of one term and its shape, None where it is no product of matrices."""
    if not matrices or not _BLANK.fullmatch(text[matrices[-1].end : end]) or not _fit(text, matrices):
        return None
    sign, factor = _factor(text, begin, matrices[0].begin)
    if factor.strip():
        check(factor)
    for entry in (entry for m in matrices for row in m.rows for entry in row):
        check(entry)
    rows = [list(row) for row in matrices[0].rows]
    for m in matrices[1:]:
        columns = [*zip(*m.rows, strict=True)]
        rows = [[_sum(row, column, _dot(text)) for column in columns] for row in rows]
    scaled = f"{sign}({_bare(factor)}){_dot(text)}" if factor.strip() else sign
    entries = [f"{scaled}({_bare(entry)})" if scaled else _bare(entry) for row in rows for entry in row]
    return entries, (len(rows), len(rows[0]))


def _fit(text: str, matrices: Sequence[_Matrix]) -> bool:
    """Tell whether matrices side by side have a product: NumPy's ``*`` between arrays goes entry by entry."""
    for m, after in pairwise(matrices):
        between = text[m.end : after.begin]
        elementwise = (m.elementwise or after.elementwise) and between.strip() != "@"
        if not _TIMES.fullmatch(between) or m.shape[1] != after.shape[0] or elementwise:
            return False
    return True


def _factor(text: str, begin: int, end: int) -> tuple[str, str]:
    """Return the sign of a term and the factor before its first matrix, at its columns; blank where there is none."""
    bare = re.sub(rf"{_TIMES.pattern}$", "", text[begin:end], count=1)
    unsigned = re.sub(r"^[\s$&]*[-+−]?", "", bare, count=1)
    at = len(bare) - len(unsigned)
    sign = "-" if bare[:at].endswith(("-", "−")) else ""
    return sign, _placed(text, begin + at, begin + len(bare))


def _placed(text: str, begin: int, end: int) -> str:
    """Return a piece at its columns, marked as LaTeX where the field is."""
    piece = text[begin:end]
    if not piece.strip(" $"):
        return ""
    return f"{' ' * (begin - 1)}{_mark(text) or ' '}"[-begin if begin else 0 :] * (begin > 0) + piece


def _bare(entry: str) -> str:
    return entry.strip(" $\n\t")


def _dot(text: str) -> str:
    return "\\cdot " if _mark(text) else "*"


def _sum(row: Sequence[str], column: Sequence[str], dot: str) -> str:
    return " + ".join(f"({_bare(a)}){dot}({_bare(b)})" for a, b in zip(row, column, strict=True))


def _matrices(text: str) -> list[_Matrix]:
    """Return the matrices of a text from left to right, those in another one not among them; none where one is open."""
    found: list[_Matrix] = []
    at = 0
    while opening := _OPENS.search(text, at):
        matrix = _latex(text, opening) if opening["name"] else _plain(text, opening)
        if matrix is None or len(found) == _MOST_MATRICES:
            return []
        found.append(matrix)
        at = matrix.end
    return found


def _latex(text: str, opening: re.Match[str]) -> _Matrix | None:
    closing = f"\\end{{{opening['name']}}}"
    end = text.find(closing, opening.end())
    inside = text[opening.end() : end]
    if end < 0 or "\\begin" in inside:
        return None
    cuts = [-2, *(m.start() for m in re.finditer(r"\\\\", inside)), len(inside)]
    if not inside[cuts[-2] + 2 :].strip() and len(cuts) > 2:
        cuts.pop()
    rows: list[tuple[str, ...]] = []
    for a, b in pairwise(cuts):
        bounds = [a + 1, *(a + 2 + m.start() for m in re.finditer("&", inside[a + 2 : b])), b]
        rows.append(
            tuple(_placed(text, opening.end() + i + 1, opening.end() + j) for i, j in pairwise(bounds))
        )
    behind = end + len(closing)
    after = _BRACKET_BEHIND.match(text, behind) if opening.group().startswith("\\left") else None
    return _whole(rows, opening.start(), after.end() if after else behind)


def _plain(text: str, opening: re.Match[str]) -> _Matrix | None:
    end, depth = opening.end(), 0
    for end in range(opening.end(), len(text)):
        depth += (text[end] in "([{") - (text[end] in ")]}")
        if depth < 0:
            break
    if depth >= 0:
        return None
    said = " " * opening.end() + text[opening.end() : end]
    rows = [tuple(components_of(row)) or (row,) for row in components_of(said[:-1].rstrip() + ", 0]")[:-1]]
    return _whole(rows, opening.start(), end + 1, elementwise=opening["plain"] == "array")


def _whole(rows: list[tuple[str, ...]], begin: int, end: int, *, elementwise: bool = False) -> _Matrix | None:
    """Return a matrix of rows that are equally long and have no empty entries."""
    if len({len(row) for row in rows}) != 1 or not all(_bare(entry) for row in rows for entry in row):
        return None
    return _Matrix(tuple(rows), begin, end, elementwise)
