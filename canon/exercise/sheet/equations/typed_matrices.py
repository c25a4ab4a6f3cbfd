"""Typed matrices, by equations: ``M q'' = -K q, M = diag(m, m), q = (x, y)^T``, ``d/dt [x; v] = [0 1; -w 0] [x; v]``.

Read are lists of rows, MATLAB's rows behind semicolons, columns that are said to be such by ``^T``, diagonal matrices;
a name stands for one where the answer defines it and the question has no such name.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING

from canon.exercise.sheet.equations.matrix_products import equations_of_products
from canon.expression.text.declared_names import key_of
from canon.expression.text.notation import closing_of
from canon.expression.text.scope import split

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.expression.text.scope import Scope

__all__ = ["equations_of_matrices"]

_LONGEST = 2_000
_PAIRS = {"(": ")", "[": "]"}
_COLUMN = re.compile(r"\s?(?:\^\s?(?:\{\s?)?(?:T|⊤)(?:\s?\})?|ᵀ)(?![\w'])")
_WORDS = "(?:with|where|mit|wobei|avec|and|und|et)"
_JOINED = re.compile(rf"\s{_WORDS}(?=\s)")
_DEFINED = re.compile(rf"\s*(?:{_WORDS}\s)?\s*(?P<name>[A-Za-z]\w{{0,5}})\s*=(?!=)(?P<value>.+)", re.DOTALL)
_RATE = re.compile(r"(?<![\w\\])(?:d\s?/\s?dt|d(?:\^2|²)\s?/\s?dt(?:\^2|²))\s*(?=Matrix\()")
_ALONE = re.compile(r"^\(([^()]*)\) =")
"""A component by itself on the left, which may define a velocity: ``x' = v``."""
_MATRIX = re.compile(r"Matrix\(\[")
_COMPONENT = re.compile(r"\s*\(?\s*([^\W\d_]\w{0,9}'?)\s*\)?\s*")


class _NoMatrixError(Exception):
    """Raised within this module where brackets are not those of matrices, or of ones that can't be read."""


def equations_of_matrices(text: str, scope: Scope) -> str:
    """Return the equations of the components, with semicolons between them; other texts as they are.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({s.name: s for s in (*coordinates("x y"), *parameters("m k"))})
    >>> equations_of_matrices("M q'' = 0, M = diag(m, k), q = (x, y)^T", scope)
    "((m)*(x'') + (0)*(y'')) = 0; ((0)*(x'') + (k)*(y'')) = 0"
    >>> equations_of_matrices("m [x'' + k x] = 0", scope)
    "m [x'' + k x] = 0"
    """
    has_matrix = re.search(r"\[\s*\[|\[[^\[\]]*;|(?<!\w)diag\(|[)\]]\s?(?:\^\s?\{?\s?[T⊤]|ᵀ)", text)
    if len(text) > _LONGEST or "\\" in text or "$" in text or "\n" in text or not has_matrix:
        return text
    if any(scope.declares(name) or name in scope.functions for name in ("T", "d", "diag", "Matrix")):
        return text
    try:
        first, *others = _statements(text)
        known = dict(_definition(each, scope) for each in others)
        made = _differentiated(_with_names(_written(first), known))
    except _NoMatrixError:
        return text
    equations = [_ALONE.sub(r"\1 =", each) for each in equations_of_products(made, str)]
    return "; ".join(equations) if equations else text


def _statements(text: str) -> list[str]:
    """Return an equation and the definitions behind it, parted at commas and semicolons outside brackets."""
    cuts = [at for at, depth in _depths(text) if depth == 0 and text[at] in ",;"]
    depths = dict(_depths(text))
    words = [m.start() for m in _JOINED.finditer(text) if depths[m.start()] == 0]
    ends = sorted([*cuts, *words])
    parts = [text[a + 1 : b] for a, b in pairwise([-1, *ends, len(text.rstrip(" .")) if ends else len(text)])]
    found = [part for part in parts if part.strip(" .")]
    if not all("=" in part for part in found):
        raise _NoMatrixError
    return found


def _depths(text: str) -> list[tuple[int, int]]:
    """Return the place of each sign with how many brackets are open there."""
    depth, found = 0, list[tuple[int, int]]()
    for at, sign in enumerate(text):
        depth -= sign in ")]}"
        found.append((at, depth))
        depth += sign in "([{"
    return found


def _definition(text: str, scope: Scope) -> tuple[str, str]:
    """Return a name of the answer's own, and the matrix that it stands for."""
    found = _DEFINED.fullmatch(text.rstrip(" ."))
    value = _written(found["value"]).strip() if found else ""
    known = {key_of(name) for name in scope.spelled}
    if found is None or key_of(found["name"]) in known or split(found["name"], scope):
        raise _NoMatrixError
    if not (_MATRIX.match(value) and _closing(value, len("Matrix")) == len(value) - 1):
        raise _NoMatrixError
    return found["name"], value


def _with_names(text: str, known: Mapping[str, str]) -> str:
    """Return a text with matrices for the names of such; each has to stand in it, none in an argument."""
    for name, value in known.items():
        pattern = rf"(?<!\w){re.escape(name)}('{{0,2}})(?![\w'(^]|\*\*)"
        text, count = re.subn(pattern, lambda found, v=value: _primed(v, found[1]), text)
        if count == 0 or re.search(rf"(?<!\w){re.escape(name)}(?!\w)", text):
            raise _NoMatrixError
    return text


def _differentiated(text: str) -> str:
    """Return a text with the rates of components for ``d/dt`` before a column."""
    while found := _RATE.search(text):
        end = _closing(text, found.end() + len("Matrix")) + 1
        primes = "''" if "2" in found.group() or "²" in found.group() else "'"
        text = f"{text[: found.start()]}{_primed(text[found.end() : end], primes)}{text[end:]}"
    return text


def _primed(matrix: str, primes: str) -> str:
    """Return a column of names with primes on each of them."""
    if not primes:
        return matrix
    entries = [_COMPONENT.fullmatch(each) for each in _parted(matrix[len("Matrix([") : -2], ",")]
    if not all(each and len(each[1]) - len(each[1].rstrip("'")) + len(primes) <= 2 for each in entries):
        raise _NoMatrixError
    return f"Matrix([{', '.join(each[1] + primes for each in entries if each)}])"


def _written(text: str) -> str:
    """Return a text with ``Matrix([…])`` for the matrices that are typed in it."""
    pieces: list[str] = []
    at = 0
    while at < len(text):
        diagonal = text.startswith("diag(", at) and not re.match(r"\w", text[at - 1 : at])
        begin = at + 4 if diagonal else at
        if text[begin] not in _PAIRS:
            pieces.append(text[at])
            at += 1
            continue
        end = _closing(text, begin)
        column = _COLUMN.match(text, end + 1)
        rows = _rows(text[begin + 1 : end], text[begin], column is not None, diagonal)
        behind = column.end() if column else end + 1
        if not rows:
            pieces.append(text[at] if not diagonal else "diag")
            at = begin + (0 if diagonal else 1)
            continue
        if re.match(r"\s?['′^]", text[behind:]):  # MATLAB's prime transposes
            raise _NoMatrixError
        pieces.append(f"Matrix([{', '.join(rows)}])")
        at = behind
    return re.sub(r"(?<=\]\)) *(?=Matrix)", "*", "".join(pieces))


def _rows(inside: str, bracket: str, column: bool, diagonal: bool) -> list[str]:
    """Return the rows in a bracket as lists, or the entries of a column; nothing where it is no matrix."""
    entries = [each.strip() for each in _parted(inside, ",")]
    if diagonal:
        size = range(len(entries))
        return [f"[{', '.join(entries[i] if i == j else '0' for j in size)}]" for i in size]
    if column and len(entries) > 1 and ";" not in inside:
        return entries
    if bracket != "[":
        return []
    lists = all(each.startswith("[") and _closing(each, 0) == len(each) - 1 for each in entries)
    if lists and not column and len(entries) > 1:
        return entries
    if ";" not in inside or column:
        return []
    rows = [_of_matlab(row) for row in _parted(inside, ";")]
    alone = all(len(row) == 1 for row in rows)
    return [row[0] for row in rows] if alone else [f"[{', '.join(row)}]" for row in rows]


def _of_matlab(row: str) -> Sequence[str]:
    """Return the entries of one row, between commas or blanks; ``a -b`` are two, ``a - b`` is one."""
    if len(entries := _parted(row, ",")) > 1:
        return [each.strip() for each in entries]
    joined = re.sub(r"\s*([-+−*/^])\s+|\s+([*/^])\s*", lambda found: found[1] or found[2], row.strip())
    return [each.strip() for each in _parted(joined, " ") if each.strip()]


def _parted(text: str, sign: str) -> list[str]:
    """Return the pieces of a text between signs outside brackets."""
    cuts = [at for at, depth in _depths(text) if depth == 0 and text[at] == sign]
    return [text[a + 1 : b] for a, b in pairwise([-1, *cuts, len(text)])]


def _closing(text: str, begin: int) -> int:
    """Return where a bracket ends."""
    end = closing_of(text, begin)
    if end is None:
        raise _NoMatrixError
    return end
