"""Vector equations: equations between lists of components, ``{m x'', m y''} == {-k x, -k y}``, one by one."""

from __future__ import annotations

import re

from canon.exercise.sheet.field_texts import components_of, of_matrix

__all__ = ["vector_equations"]

_EQUATION = re.compile(r"\s*(?:Eq|Equality|Equal)\s*[(\[](?P<inside>.*)[)\]][\s.]*", re.DOTALL)
_SIGN = re.compile(r"(?<![<>!:=])={1,2}(?!=)")
_ZERO = re.compile(r"[\s$&.]*(?:0|\\(?:vec|mathbf|boldsymbol)\s*\{?\s*0\s*\}?)[\s$.]*")
_MATRIX = re.compile(r"matrix|Matrix|Vector|array")


def vector_equations(text: str) -> list[str]:
    r"""Return the equations of the components of one field, each at its columns; nothing where it is none.

    What has components on both sides needs as many on each. What stands alone, or is zero, is a list of what vanishes;
    but ``{f, g} = 0`` may be a bracket and is left alone.

    Examples
    --------
    >>> [" ".join(one.split()) for one in vector_equations("{m x'', m y''} == {-k x, -k y}")]
    ["m x'' = -k x", "m y'' = -k y"]
    >>> [one.split() for one in vector_equations("[x, y, z] = 0")], vector_equations("[x, y] = [1, 2, 3]")
    ([['x'], ['y'], ['z']], [])
    """
    if found := _EQUATION.fullmatch(text):
        begin, end = found.span("inside")
        cut = _comma(text, begin, end)
        return [] if cut is None else _between(text, (begin, cut), (cut + 1, end), cut)
    signs = [match for match in _SIGN.finditer(text) if _depth(text, 0, match.start()) == 0]
    if not signs:
        entries = _entries(text, 0, len(text))
        return [] if any("=" in one or "Eq(" in one for one in entries) else entries
    if len(signs) > 1:
        return []
    sign = signs.pop()
    return _between(text, (0, sign.start()), (sign.end(), len(text)), sign.start())


def _between(text: str, left: tuple[int, int], right: tuple[int, int], sign: int) -> list[str]:
    """Return the equations between the components on two sides, their signs at the place of that between the sides."""
    above, below = _entries(text, *left), _entries(text, *right)
    for entries, (begin, end) in ((above, right), (below, left)):
        if entries and _ZERO.fullmatch(text, begin, end):
            return entries if len(entries) > 2 or _MATRIX.search(text) else []
    if len(above) != len(below):
        return []
    return [
        f"{a.ljust(sign)}={b[sign + 1 :].replace('$', ' ', 1)}" for a, b in zip(above, below, strict=True)
    ]


def _entries(text: str, begin: int, end: int) -> list[str]:
    piece = " " * begin + text[begin:end]
    return of_matrix(piece) or components_of(piece)


def _depth(text: str, begin: int, end: int) -> int:
    return sum((c in "([{⟨") - (c in ")]}⟩") for c in text[begin:end])


def _comma(text: str, begin: int, end: int) -> int | None:
    """Return where the one comma outside brackets stands."""
    found = [i for i in range(begin, end) if text[i] == "," and _depth(text, begin, i) == 0]
    return found[0] if len(found) == 1 else None
