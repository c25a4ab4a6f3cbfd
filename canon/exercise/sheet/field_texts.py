"""Field texts: pieces of a field as texts of their own, every character at the column where it was typed."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from canon.expression.text.notation import is_latex
from canon.expression.text.scope import split
from canon.frozen_mapping import FrozenMapping

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from canon.expression.text.scope import Scope
    from canon.expression.text.statement import Side, Statement

__all__ = [
    "NEARLY",
    "components_of",
    "entries_of",
    "equation_between",
    "equations_listed",
    "is_name_of_matrix",
    "of_matrix",
    "says_constant",
    "texts_in",
    "whole_statement",
    "with_equality_signs",
    "with_texts",
    "without_remainder",
    "without_terms_of_rest",
]

MOST_ENTRIES = 100
"""Most components in one field."""
_LATEX_MATRIX = re.compile(
    r"[\s$]*(?:\\left\s*[(\[])?\s*\\begin\{((?:[pbB]|small)?matrix|array)\}"
    r"(?:\{[clr| ]{1,20}\})?(?P<inside>.*)\\end\{\1\}"
    r"\s*(?:\\right\s*[)\]])?[\s$.,]*",
    re.DOTALL,
)
_PLAIN_MATRIX = re.compile(
    r"\s*(?:(?:\w{1,9}\.)?(?:Immutable|Mutable)?(?:Dense)?(?:Matrix|Vector|array)\(\s*\[(?P<inside>.*)\]|"
    r"matrix\((?P<rows>\s*\[.*\]))\s*\)[\s.;]*",
    re.DOTALL,
)
_BEFORE_MATRIX = re.compile(
    r"[^=<>]{1,400}=(?=[\s$&]*(?:\\left\s*[(\[]\s*)?(?:\\begin\{(?:(?:[pbB]|small)?matrix|array)\}|(?:\w{1,9}\.)?"
    r"(?:Immutable|Mutable)?(?:Dense)?(?:Matrix|Vector|matrix|array)\())"
)
_NAME_OF_MATRIX = re.compile(
    r"[\s$]*(?:\\(?:dot|ddot|vec|mathbf|boldsymbol|bm|hat|mathrm|mathcal|underline)\s*)?"
    r"\{?\s*\\?[^\W\d]\w{0,12}\s*\}?(?:_\{?\w{1,9}\}?)?'{0,2}\s*(?:\([\w, \\]{0,40}\))?\s*|[\s$]*\[\s*X\s*,\s*Y\s*\]\s*"
)
_NAME_OF_VECTOR = re.compile(r"[\s$]*\\(?:vec|mathbf|boldsymbol)\s*\{?\s*\\?[A-Za-z]{1,12}\s*\}?\s*=")
_DRESS = re.compile(
    r"^\s*MatrixForm(?=\[.*\]\s*$)|//\s*MatrixForm\s*$|\\left(?![A-Za-z])|\\right(?![A-Za-z])"
    r"|(?<=[)\]}])\s*\^\s*\{?\s*(?:T|\\top|\\intercal|\\mathsf\s*\{?T\}?)\s*\}?(?=[\s$.]*$)|(?<=[)\]}])ᵀ(?=[\s.]*$)"
)
"""What is around a list of components and says nothing of them."""
_CONSTANT = re.compile(
    r"[\s$]*(?:\\(?:text|mathrm|textrm|operatorname|mbox|rm)\s*\{?\s*)?(?:[cCkK]onst(?:ante?)?|costante|cte|stała|константа)\.?\s*\}?[\s$.,;]*"
)


def says_constant(text: str, scope: Scope | None = None) -> bool:
    r"""Tell whether a side says no more than that it is constant.

    Examples
    --------
    >>> says_constant(r"$\text{const.}"), says_constant(" constant"), says_constant("c")
    (True, True, False)
    """
    found = _CONSTANT.fullmatch(text)
    return found is not None and not (scope is not None and "cte" in text and split("cte", scope))


def equation_between(left: Side, right: Side) -> str:
    """Return the text ``left = right``, each side at its column."""
    start = right.column - 1
    latex = right.text[start : start + 1] == "$"
    sign = start if latex else start - 1
    return f"{left.text}{' ' * (sign - len(left.text))}={right.text[sign + 1 :]}"


def whole_statement(statement: Statement, text: str) -> str:
    """Return a statement on its own, at its columns."""
    first, last = statement.sides[0], statement.sides[-1]
    return f"{first.text}{text[len(first.text) : len(last.text)]}"


def of_matrix(text: str) -> list[str]:
    r"""Return the entries of a matrix of one column or one row, each at its column; nothing where it is none.

    Examples
    --------
    >>> [entry.strip() for entry in of_matrix(r"$\begin{pmatrix} y \\ -x \end{pmatrix}$")]
    ['$ y', '$ -x']
    >>> [entry.split() for entry in of_matrix("Matrix([x, y]) = Matrix([1, 2])")]
    [['x', '=', '1'], ['y', '=', '2']]
    >>> [entry.strip() for entry in of_matrix("Matrix([[y], [-x]])")], of_matrix("Matrix([[1, 0], [0, 1]])")
    (['y', '-x'], [])
    """
    if before := _BEFORE_MATRIX.match(text):
        right = of_matrix(" " * before.end() + text[before.end() :])
        left = text[: before.end() - 1]
        if not right or is_name_of_matrix(left):
            return right
        named = of_matrix(left)
        if len(named) != len(right):
            return []
        return [_equation(a, b, before.end() - 1) for a, b in zip(named, right, strict=True)]
    if found := _LATEX_MATRIX.fullmatch(text):
        return _of_latex_matrix(text, *found.span("inside"))
    if found := _PLAIN_MATRIX.fullmatch(text):
        return _of_plain_matrix(text, *found.span("inside" if found["inside"] is not None else "rows"))
    return []


def is_name_of_matrix(left: str) -> bool:
    """Tell whether what stands before ``=`` is the name of a vector or matrix."""
    return _NAME_OF_MATRIX.fullmatch(left) is not None


def _equation(left: str, right: str, sign: int) -> str:
    """Return the equation of two entries, its sign where that of the matrices stood."""
    return f"{left.ljust(sign)}={right[sign + 1 :].replace('$', ' ', 1)}"


def _of_latex_matrix(text: str, begin: int, end: int) -> list[str]:
    inside = text[begin:end]
    if "\\begin" in inside:
        return []
    cuts = [*re.finditer(r"\\\\|&", inside)]
    if cuts and not inside[cuts[-1].end() :].strip():
        end = begin + cuts.pop().start()
    if len({cut.group() for cut in cuts}) != 1 or len(cuts) >= MOST_ENTRIES:
        return []
    starts = [begin, *(begin + cut.end() for cut in cuts)]
    ends = [*(begin + cut.start() for cut in cuts), end]
    return [" " * (a - 1) + "$" + text[a:b] for a, b in zip(starts, ends, strict=True)]


def _of_plain_matrix(text: str, begin: int, end: int) -> list[str]:
    rows = components_of(" " * (begin - 1) + "[" + text[begin:end] + ", 0]")[:-1]
    nested = [components_of(row) or [row] for row in rows]
    if len(rows) == 1:
        return nested[0] if len(nested[0]) > 1 else []
    if any(len(row) > 1 for row in nested):
        return []
    return [re.sub(r"^(\s*)\[(.*)\]\s*$", r"\1 \2", row) for row in rows]


def components_of(text: str) -> list[str]:
    r"""Return the components of ``(a, b)`` or ``[[a, b]]``, each at its column; nothing where it is no such bracket.

    Examples
    --------
    >>> components_of("[[x, y]]"), components_of("x + y")
    (['  x', '     y'], [])
    >>> components_of(r"$\vec v = (x, y)^T$")
    ['          $x', '            $ y']
    """
    named = _NAME_OF_VECTOR.match(text)
    bare = _DRESS.sub(_blanks, text if named is None else " " * named.end() + text[named.end() :])
    bare = bare.replace("\\langle", "⟨      ").replace("\\rangle", "⟩      ")
    latex = "$" in text or "\\" in text
    return _listed(bare.replace("$", " "), "$" if latex else " ")


def _blanks(found: re.Match[str]) -> str:
    return " " * len(found.group())


def _listed(text: str, mark: str) -> list[str]:
    """Return what stands between the commas of one bracket, the mark in the place of each comma."""
    stripped = text.strip().rstrip(". ")
    pairs = {"(": ")", "[": "]", "{": "}", "⟨": "⟩"}
    if len(stripped) < 3 or pairs.get(stripped[0]) != stripped[-1]:
        return []
    begin = text.index(stripped[0])
    depth, cuts = 0, [begin]
    for i, character in enumerate(stripped):
        depth += (character in pairs) - (character in pairs.values())
        if depth == 0 and i < len(stripped) - 1:
            return []
        if depth == 1 and character == ",":
            cuts.append(begin + i)
    cuts.append(begin + len(stripped) - 1)
    if len(cuts) == 2:
        return _listed(" " * (begin + 1) + text[begin + 1 : cuts[-1]], mark)
    if len(cuts) > MOST_ENTRIES + 1:
        return []
    return [" " * a + mark + text[a + 1 : b] for a, b in pairwise(cuts)]


def equations_listed(text: str) -> list[str]:
    """Return the equations of one list, each at its column; nothing where it is none.

    Examples
    --------
    >>> [equation.strip() for equation in equations_listed("[Eq(x', p), Eq(p', -x)]")], equations_listed("(a, b)")
    (["Eq(x', p)", "Eq(p', -x)"], [])
    """
    entries = [] if is_latex(text) else components_of(text)
    return entries if all("=" in entry or "Eq(" in entry for entry in entries) else []


def entries_of(text: str) -> list[str]:
    """Return the entries of a set or list, each at its column; the text itself where it is none."""
    inside = re.sub(r"\\left(?![A-Za-z])|\\right(?![A-Za-z])", lambda found: " " * len(found.group()), text)
    inside = inside.replace("\\{", " {").replace("\\}", " }") if "\\{" in inside else inside
    dollar = inside.lstrip().startswith("$")
    stripped = inside.strip(" $.")
    pairs = {"(": ")", "[": "]", "{": "}"}
    set_ = len(stripped) > 1 and pairs.get(stripped[0]) == stripped[-1]
    cuts = _commas(inside, set_)
    if not cuts:
        return [text]
    begin = inside.index(stripped[0]) if set_ else (inside.index("$") if dollar else -1)
    end = inside.rindex(stripped[-1]) if set_ else len(inside.rstrip(" $"))
    marks = zip([begin, *cuts], [*cuts, end], strict=True)
    return [_at(inside, a + 1, b, dollar=dollar) for a, b in marks]


def _at(text: str, start: int, end: int, *, dollar: bool) -> str:
    return f"{' ' * (start - 1)}{'$' if dollar else ' '}{text[start:end]}"[-end if start else 0 :]


def _commas(text: str, set_: bool) -> list[int]:
    """Return the places of the commas and semicolons that part entries."""
    depth, found = 0, list[int]()
    for at, sign in enumerate(text):
        depth += (sign in "([{") - (sign in ")]}")
        if sign in ",;" and depth == int(set_) and text[at - 1 : at] != "\\":
            found.append(at)
    return found


_REMAINDER = re.compile(
    r"[+\-−]\s*(?:(?:\\math(?:cal|rm|scr|bb)\s*\{?\s*[Oo]\s*\}?|\\operatorname\{[Oo]\}|[Oo𝒪])\s*(?:\\[!,;]\s*)*"
    r"(?:\\left|\\[bB]igg?l?)?\s*\((?:[^()]|\([^()]*\))*\)|\\[lc]?dots\b|\.\.\.|…|⋯)(?=[\s.,$]*(?:\\[)\]])?[\s.,$]*$)"
)


def without_remainder(text: str) -> tuple[str, str]:
    r"""Return an expansion with its remainder blanked, and the remainder; an empty one where there is none.

    Examples
    --------
    >>> without_remainder("x - x^3/6 + O(x^5)")
    ('x - x^3/6         ', 'O(x^5)')
    >>> without_remainder(r"$x - \frac{x^3}{6} + \mathcal{O}\left(x^5\right)$")[1], without_remainder("x + y")
    ('\\mathcal{O}\\left(x^5\\right)', ('x + y', ''))
    """
    found = _REMAINDER.search(text)
    if found is None or not text[: found.start()].strip(" $"):
        return text, ""
    blank = " " * (found.end() - found.start())
    return text[: found.start()] + blank + text[found.end() :], found.group()[1:].strip()


NEARLY = re.compile(r"\\(?:approx|simeq)(?![A-Za-z])|[≈≃≅]")
"""Signs between what is nearly equal."""


def with_equality_signs(text: str) -> str:
    """Return a text with ``=`` for ≈, every column where it was.

    Examples
    --------
    >>> with_equality_signs("x'' ≈ -x")
    "x'' = -x"
    """
    return NEARLY.sub(lambda found: "=".ljust(len(found.group())), text)


_AT_REST = re.compile(
    r"\+\s*(?:\\(?:text|mathrm)\s?\{\s*)?[(\[]?(?:"
    r"(?:other |some )?terms (?:without|independent of|free of)(?: the)? accelerations?"
    r"|Terme ohne Beschleunigung(?:en)?|termes sans accélérations?)[)\]]?\s*\}?(?=[\s.$]*$)"
)


def without_terms_of_rest(text: str) -> str:
    """Return Gibbs's function without ``+ (terms without accelerations)``, of which it says nothing.

    Examples
    --------
    >>> without_terms_of_rest("m x''²/2 + (terms without accelerations)").strip()
    "m x''²/2"
    """
    return _AT_REST.sub(lambda found: " " * len(found.group()), text)


_PLUS_CONSTANT = re.compile(
    r"\+\s*(?:\\(?:text|mathrm)\s?\{\s*)?(?P<name>C|[Cc]onst(?:ant)?)\b\.?\s*\}?(?=[\s.,$]*$)"
)


def without_constant(text: str) -> tuple[str, str]:
    r"""Return a function with ``+ C`` or ``+ const`` blanked, and that name; an empty one where there is none.

    Examples
    --------
    >>> without_constant("x^2/2 + C"), without_constant(r"q P + \text{const.}")[1], without_constant("x + y")
    (('x^2/2    ', 'C'), 'const', ('x + y', ''))
    """
    found = _PLUS_CONSTANT.search(text)
    if found is None or not text[: found.start()].strip(" $"):
        return text, ""
    return text[: found.start()] + " " * (found.end() - found.start()) + text[found.end() :], found["name"]


def with_texts(value: Any, others: Mapping[str, str]) -> Any:
    """Return what stands under a key with other texts in place of some.

    Examples
    --------
    >>> with_texts(["a", {"value": "b"}], {"b": "c"})
    ['a', {'value': 'c'}]
    """
    if isinstance(value, str):
        return others.get(value, value)
    if isinstance(value, dict | FrozenMapping):
        return {name: with_texts(item, others) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [with_texts(item, others) for item in value]
    return value


def texts_in(value: Any, key: str = "") -> Iterator[tuple[str, str]]:
    """Yield every text under some keys, each with the first of the keys that lead to it."""
    if isinstance(value, str):
        yield key, value
    elif isinstance(value, dict | FrozenMapping):
        for name, item in value.items():
            yield from texts_in(item, key or str(name))
    elif isinstance(value, list | tuple):
        for item in value:
            yield from texts_in(item, key)
