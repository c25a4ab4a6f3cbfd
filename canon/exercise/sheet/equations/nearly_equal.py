"""Nearly equal sides: of ``√(1+ε) ≈ 1 + ε/2`` the last is the answer, where an answer to an order is asked for.

``θ'' = -(g/l) sin θ ≈ -(g/l) θ`` says θ'' = -(g/l) θ to that order, and ``sin θ ≈ θ`` beside an equation is a step to
it. What stands before the last ≈ is passed over, which is told; what is left is judged.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING

from sympy import Poly

from canon.exercise.sheet.field_texts import NEARLY, with_equality_signs
from canon.expression.parse import LanguageError, parse_expression
from canon.expression.symbols.symbol import Rate
from canon.expression.text.open_readings import stem_of
from canon.expression.text.tokens import GREEK

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.exercise.sheet.equations.sides import Sides
    from canon.expression.text.statement import Side, Statement

__all__ = ["expansion_alone", "without_deltas", "without_nearly_equal"]

_Span = tuple[int, int]
_DELTA = r"(?:\\delta(?![A-Za-z])|δ)\s?"
_ACCENTS = r"(?:\\d{0,2}dot(?![A-Za-z])\s?|\{\s?)*"
_IN_BRACKETS = re.compile(
    r"(?:[\s,]|\\[,;:! ]|\\q?quad(?![A-Za-z])|\\left(?=\())*"
    rf"\((?:[^()]|\([^()]*\))*(?:{NEARLY.pattern})(?:[^()]|\([^()]*\))*\)(?=(?:[\s.$]|\\[\])])*$)"
)
"""``(sin θ ≈ θ)`` behind an equation."""
_BEHIND_A_WORD = re.compile(
    r"(?:[\s,;$]|\\[,;:! ]|\\q?quad(?![A-Za-z]))+(?:\\(?:text|textrm|mbox|mathrm)\s?\{\s*)?"
    r"(?:for|with|where|since|because|as|using|if|when|für|mit|da|wobei|pour|avec|car)(?![A-Za-z])\s*\}?"
    rf"[^='′″]{{1,60}}?(?:{NEARLY.pattern})[^='′″]{{1,60}}$"
)
"""The same behind a word, ``… = 0 for sin θ ≈ θ``."""
_LONGEST = 2_000


def expansion_alone(place: str, text: str, known: Sides, *, remainder: bool) -> str:
    """Return an expansion without what it is nearly equal to, which is told; the name of the answer stays.

    Parameters
    ----------
    place
        Where it stands in the claim.
    text
        The text, without the remainder behind it.
    known
        What is known of its sides.
    remainder
        Whether there was one, so that the last side is right to an order, whatever sign is before it.

    Raises
    ------
    Exception
        What ``known.fault`` makes, where the expansion does not stand last.
    """
    plain = with_equality_signs(text)
    if (plain == text and not remainder) or len(text) > _LONGEST:
        return plain
    statements = known.statements(place, plain)
    for statement in statements:
        last = remainder and statement is statements[-1]
        at = len(statement.sides) - 1 if last else _last_nearly(text, statement)
        passed = [side for side in statement.sides[:at] if known.can_read(side)]
        if not passed:
            continue
        if _stands_first(statement.sides[at:], passed, known):
            reason = "which side is the answer? what is right to an order stands behind ≈"
            raise known.told(place, text, statement.sides[at], reason, "write the expansion last, or alone")
        begin, end = _span(passed[0])[0], _span(statement.sides[at])[0]
        plain = _without(place, plain, [(begin, end)], known)
    return plain


def _stands_first(answer: Sequence[Side], passed: Sequence[Side], known: Sides) -> bool:
    """Tell whether an expansion stands before what has the function itself, ``1 + ε/2 ≈ √(1+ε)``."""
    return not any(_is_expanded(side, known) for side in answer) and any(
        _is_expanded(side, known) for side in passed
    )


def _is_expanded(side: Side, known: Sides) -> bool:
    """Tell whether a side is a sum of powers of what is small."""
    expression = _expression(side, known)
    small = known.keys.get("small", [])
    names = small if isinstance(small, list) else [small]
    symbols = [s for name in names if isinstance(name, str) and (s := known.scope.symbol(name)) is not None]
    return expression is not None and (not symbols or bool(expression.is_polynomial(*symbols)))


def without_nearly_equal(place: str, text: str, known: Sides) -> str:
    """Return equations without the steps of an approximation, which are told.

    Parameters
    ----------
    place
        Where they stand in the claim.
    text
        The text as it was written.
    known
        What is known of its sides.
    """
    if len(text) > _LONGEST or NEARLY.search(text) is None:
        return with_equality_signs(text)
    for pattern in (_IN_BRACKETS, _BEHIND_A_WORD):
        found = pattern.search(text)
        if found and "=" in text[: found.start()] and "dot" not in found.group():
            shown = found.group().strip(" ,;$")
            known.passed.append(f"{shown} in {place} is passed over: it is a step of the approximation")
            blanked = re.sub(r"[^$]", " ", found.group())
            text = text[: found.start()] + blanked + text[found.end() :]
    plain = with_equality_signs(text)
    if plain == text:
        return plain
    return _without(place, plain, list(_steps(text, known.statements(place, plain), known)), known)


def without_deltas(text: str, known: Sides) -> str:
    r"""Return linear equations without the δ before each coordinate, which is read as the deviation there anyway.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.exercise.sheet.equations.sides import Sides
    >>> from canon.expression.parse import Scope
    >>> known = Sides({"q": ["theta"]}, Scope({"theta": coordinates("theta")}), lambda place, error: error, [])
    >>> without_deltas("δθ'' = -δθ", known), without_deltas("δθ'' = -θ", known)
    (" θ'' = - θ", "δθ'' = -θ")
    """
    listed = known.keys.get("q", [])
    names = [name for name in (listed if isinstance(listed, list) else [listed]) if isinstance(name, str)]
    if len(text) > _LONGEST or re.search(_DELTA, text) is None or known.scope.declares("delta") or not names:
        return text
    spelled = "|".join(dict.fromkeys(_spelling(stem_of(name)) for name in names))
    before = re.compile(rf"{_DELTA}(?={_ACCENTS}(?:{spelled}))")
    if len(before.findall(text)) < max(len(re.findall(spelled, text)), len(re.findall(_DELTA, text))):
        return text
    known.passed.append("δ before coordinates is passed over: they are read as deviations")
    return before.sub(lambda found: " " * len(found.group()), text)


def _spelling(name: str) -> str:
    r"""Return a pattern of a name as it is typed, ``θ`` and ``\theta`` for theta."""
    letters = "".join(letter for letter, spelled in GREEK.items() if spelled == name)
    return (
        rf"\\{name}(?![A-Za-z])|[{letters}]" if letters else rf"(?<![A-Za-z\\]){re.escape(name)}(?![A-Za-z])"
    )


def _steps(text: str, statements: Sequence[Statement], known: Sides) -> Iterator[_Span]:
    """Yield where the steps of an approximation stand."""
    stepped = False
    for i, statement in reversed(list(enumerate(statements))):
        sides, at = statement.sides, _last_nearly(text, statement)
        alone = len(statements) > 1 and not any(_has_rates(side, known) for side in sides)
        if (at and alone) or (stepped and not _is_linear(statement, known)):
            begin = _span(sides[0])[0]
            yield begin, (_span(statements[i + 1].sides[0])[0] if i + 1 < len(statements) else len(text))
            stepped = i + 1 < len(statements)
        elif at > 1:  # θ'' = … ≈ …
            yield _span(sides[0])[1], _span(sides[at - 1])[1]
        elif at == 1 and len(sides) > 2:  # … ≈ … = 0
            yield _span(sides[0])[0], _span(sides[1])[0]


def _last_nearly(text: str, statement: Statement) -> int:
    """Return which side of a statement stands behind its last ≈, 0 where there is none."""
    sides = statement.sides
    gaps = [text[_span(a)[1] : _span(b)[0]] for a, b in pairwise(sides)]
    return max((i for i, gap in enumerate(gaps, 1) if NEARLY.search(gap)), default=0)


def _has_rates(side: Side, known: Sides) -> bool:
    expression = _expression(side, known)
    return expression is None or bool(expression.atoms(Rate))


def _is_linear(statement: Statement, known: Sides) -> bool:
    """Tell whether every side is linear in coordinates and rates, as far as it can be read."""
    q = known.keys.get("q", [])
    symbols = [
        s for name in (q if isinstance(q, list) else [q]) if (s := known.scope.symbol(name)) is not None
    ]
    return all(
        f is None or _is_of_first_degree(f, symbols) for f in (_expression(s, known) for s in statement.sides)
    )


def _is_of_first_degree(f: Expr, symbols: Sequence[Symbol]) -> bool:
    unknowns = [*symbols, *f.atoms(Rate)]
    return not unknowns or (bool(f.is_polynomial(*unknowns)) and Poly(f, *unknowns).total_degree() <= 1)


def _expression(side: Side, known: Sides) -> Expr | None:
    try:
        return parse_expression(side.text, known.scope)
    except LanguageError:
        return None


def _span(side: Side) -> _Span:
    """Return where a side begins and ends in its field."""
    return len(side.text) - len(side.text.lstrip(" $")), len(side.text)


def _without(place: str, text: str, spans: Sequence[_Span], known: Sides) -> str:
    """Return a text with blanks for what is passed over."""
    for begin, end in spans:
        shown = text[begin:end].strip(" ,;=$\n")[:60]
        known.passed.append(f"{shown} in {place} is passed over: what stands behind ≈ is judged")
        text = text[:begin] + re.sub(r"[^$]", " ", text[begin:end]) + text[end:]
    return text
