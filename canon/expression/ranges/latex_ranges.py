r"""Ranges in LaTeX: ``\int_0^{2\pi} \sin^2\theta\,d\theta``, ``\sum_{i=1}^{3} p_i^2``, found before words are read.

An integral goes as far as its differential, or, where it has no limits and that comes first, to the next plus or minus
outside brackets, as a sum does; one behind which its variable or index goes on is refused. Each becomes one sign of the
text, its tree is kept beside it, and every column stays where it was. ``\int^q f(q')\,dq'`` is the integral over q
without limits.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.expression.ranges.range_of_call import INTEGRAL, LIMITS_ARE_MISSING, PRODUCT, SUM
from canon.expression.text.syntax import MAX_NESTING, Call, LanguageError, Name, Node, Product, Sum, Tuple
from canon.expression.text.tokens import GREEK

if TYPE_CHECKING:
    from collections.abc import Callable

    _Read = Callable[[str, int, int, str], Node]

__all__ = ["PLACE", "with_ranges"]

PLACE = "\ue000"
"""The sign that stands in the place of an integral or a sum."""
MOST_NESTED = 3
MOST_FIGURES = 9
"""Greatest bound of a sum whose index is replaced in the text."""

_OPERATOR = re.compile(r"\\(?:int|sum|prod)(?:\s*\\(?:no)?limits)?(?![A-Za-z])|[∫∑∏]")
_TOKEN = re.compile(r"\\(?:left|right|[bB]igg?[lrm]?)\s*(?:\\[{}]|[()\[\]|.])|\\(?:[A-Za-z]+|.)|.", re.DOTALL)
_DIFFERENTIAL = re.compile(
    r"(?:\\(?:mathrm|text|rm)\s*\{\s*d\s*\}|\\mathrm\s+d|\\dd(?![A-Za-z])|(?<![A-Za-z\\_^])d)\s*"
    r"(?P<variable>\\[A-Za-z]+|[A-Za-zα-ω])(?P<index>_(?:\w|\{\w{1,9}\}))?(?P<primes>'*)(?![A-Za-z])"
)
_SCRIPT = re.compile(r"\s*([_^])\s*")
_SPACE = re.compile(r"(?:\s|\\[,;:! ]|\\q?quad(?![A-Za-z]))*")
_INDEX = re.compile(r"\s*([A-Za-z])\s*=\s*(\d+)\s*")
_NUMBER = re.compile(r"\s*(\d+)\s*")


@dataclass(frozen=True, slots=True)
class _Operator:
    """An integral, sum or product sign with the places of its limits, and where they end; an integral may have none.

    ``upto`` is the place of the upper limit of an integral that has no other.
    """

    sign: str
    at: int
    limits: tuple[tuple[int, int], ...]
    end: int
    upto: tuple[int, int] | None = None


def with_ranges(text: str, start: int, end: int, read: _Read) -> tuple[str, dict[int, Node]]:
    """Return a text with one sign for each integral and sum between two places, and their trees by place.

    Parameters
    ----------
    text
        The whole field.
    start, end
        Where to look.
    read
        Reads the formula between two places of a text, in which one more name is known: the variable.

    Raises
    ------
    LanguageError
        Where limits or a differential are missing, or it is open how far a sum goes.
    """
    found: dict[int, Node] = {}
    at = start
    while match := _OPERATOR.search(text, at, end):
        if len(found) >= MAX_NESTING:
            raise LanguageError(
                text, match.start() + 1, f"more than {MAX_NESTING} integrals and sums", "split the claim"
            )
        operator = _operator(text, match, end)
        node, stop = (_integral if operator.sign == INTEGRAL else _sum)(text, operator, end, read)
        found[operator.at] = node
        text = text[: operator.at] + PLACE + " " * (stop - operator.at - 1) + text[stop:]
        at = stop
    return text, found


def _operator(text: str, match: re.Match[str], end: int) -> _Operator:
    """Return an operator with its limits."""
    sign = {"i": INTEGRAL, "∫": INTEGRAL, "s": SUM, "∑": SUM}.get(match.group().lstrip("\\")[0], PRODUCT)
    limits: dict[str, tuple[int, int]] = {}
    at = match.end()
    while script := _SCRIPT.match(text, at, end):
        begin, stop, at = _argument(text, script.end(), end)
        if script[1] in limits:
            raise LanguageError(
                text, script.start() + 1, f"a second {script[1]}", "write one lower and one upper limit"
            )
        limits[script[1]] = (begin, stop)
    if sign == INTEGRAL and [*limits] == ["^"]:
        return _Operator(sign, match.start(), (), at, limits["^"])
    if len(limits) < 2 and (sign != INTEGRAL or limits):
        what = r"\int_{0}^{a} f\,dx" if sign == INTEGRAL else r"\sum_{i=1}^{3} f"
        reason = f"{match.group()} {LIMITS_ARE_MISSING}"
        raise LanguageError(text, match.start() + 1, reason, f"write {what}, or the value")
    return _Operator(sign, match.start(), tuple(limits[script] for script in "_^" if script in limits), at)


def _argument(text: str, at: int, end: int) -> tuple[int, int, int]:
    """Return where a limit begins and ends, and what is behind it."""
    if text[at : at + 1] in ("{", "("):
        depth = 0
        for i in range(at, end):
            depth += (text[i] in "{(") - (text[i] in "})")
            if depth == 0:
                return at + 1, i, i + 1
        raise LanguageError(text, at + 1, f"{text[at]} is never closed")
    token = re.compile(r"\\[A-Za-z]+|[-+]?\w").match(text, at, end)
    stop = token.end() if token else at
    if token and token.group()[-1].isdigit() and re.match(r"\d|\\pi(?![A-Za-z])|π", text[stop:end]):
        reason = "a limit of more than one figure or letter stands in braces"
        raise LanguageError(text, at + 1, reason, "write ^{10}, or put a blank behind the limit")
    return at, stop, stop


def _integral(text: str, operator: _Operator, end: int, read: _Read) -> tuple[Node, int]:
    """Return the tree of an integral and where it ends: behind its differential."""
    at, depth, nested = operator.end, 0, 0
    while at < end:
        found = _DIFFERENTIAL.match(text, at, end) if depth == 0 else None
        if found and not nested:
            return _integrated(text, operator, found, end, read)
        nested -= found is not None
        token = _TOKEN.match(text, at, end)
        sign = token.group() if token else text[at]
        nested += depth == 0 and _OPERATOR.fullmatch(sign) is not None and sign.lstrip("\\")[0] in "i∫"
        if nested > MOST_NESTED:
            raise LanguageError(
                text, at + 1, f"more than {MOST_NESTED} integrals within one", "split the claim"
            )
        depth += sign.lstrip("\\").endswith(("(", "[", "{")) - sign.lstrip("\\").endswith((")", "]", "}"))
        at = found.end() if found else at + len(sign)
    lacks = "has no differential outside brackets" if operator.limits else LIMITS_ARE_MISSING
    remedy = r"write \int_{0}^{a} f\,dx, the differential at the end"
    raise LanguageError(text, operator.at + 1, f"this integral {lacks}", remedy)


def _integrated(
    text: str, operator: _Operator, differential: re.Match[str], end: int, read: _Read
) -> tuple[Node, int]:
    """Return the tree of an integral, from its differential, and where it ends."""
    begin = differential.start("variable")
    stop = max(differential.end("variable"), differential.end("index"))
    typed = text[begin:stop]
    if operator.upto is not None:
        text = _without_primes(text, operator, differential, typed)
    elif differential["primes"]:
        column = differential.start() + 1
        raise LanguageError(text, column, "a differential of a rate", "write the integral over one variable")
    if behind := re.compile(r"\s*[\^_]").match(text, differential.end()):
        column = behind.end()
        raise LanguageError(text, column, "a power or index of a differential", r"write \int_{0}^{a} f\,dx")
    name = "".join(GREEK.get(sign, sign) for sign in typed.lstrip("\\") if sign not in "{}")
    variable = read(text, begin, stop, name)
    if not isinstance(variable, Name):
        raise LanguageError(text, begin + 1, "an integral is over one variable", r"write \int_{0}^{a} f\,dx")
    source, first, last = _integrand(text, operator, differential, end, typed)
    integrand = read(source, first, last, variable.text)
    bounds = (read(text, *limit, "") for limit in operator.limits)
    node = Call(INTEGRAL, (integrand, Tuple((variable, *bounds), begin + 1)), operator.at + 1)
    return node, max(last, differential.end())


def _integrand(
    text: str, operator: _Operator, differential: re.Match[str], end: int, typed: str
) -> tuple[str, int, int]:
    """Return in which text an integrand stands, from where to where; it is 1 where there is none."""
    space = _SPACE.match(text, operator.end, differential.start())
    if space is None or space.end() < differential.start():
        return text, operator.end, differential.start()
    if not _goes_on(text, differential.end(), end):
        return text[: operator.end] + "1" + text[operator.end + 1 :], operator.end, operator.end + 1
    last = _end_of_term(text, differential.end(), end)
    again = _letter(typed).search(text, last, end)
    if operator.limits or again is not None:
        column = (again or differential).start() + 1
        reason = "does what follows belong to the integral?"
        raise LanguageError(text, column, reason, "write the differential at its end")
    return text, differential.end(), last


def _letter(typed: str) -> re.Pattern[str]:
    """Return what finds a variable as it is typed, and the primes behind it."""
    return re.compile(rf"(?<![A-Za-z\\]){re.escape(typed)}(?![A-Za-z])(?P<primes>'*)")


def _without_primes(text: str, operator: _Operator, differential: re.Match[str], typed: str) -> str:
    r"""Return a text without the primes that tell the variable of ``\int^q f(q')\,dq'`` from its end."""
    limit = text[slice(*operator.upto or (0, 0))].strip()
    if limit != typed:
        reason = f"this integral goes up to {limit[:20] or 'nothing'}, and its variable is {typed}"
        raise LanguageError(
            text, operator.at + 1, reason, rf"write \int^{typed} f\,d{typed}', or both limits"
        )
    primes = differential["primes"]
    for each in _letter(typed).finditer(text, operator.end, differential.start()):
        if each["primes"] != primes:
            reason = f"is this {typed} the variable of the integral, or its end?"
            raise LanguageError(text, each.start() + 1, reason, rf"write \int^{typed} f({typed}')\,d{typed}'")
        text = text[: each.start()] + typed.ljust(len(each.group())) + text[each.end() :]
    return text[: differential.start("primes")] + " " * len(primes) + text[differential.end("primes") :]


def _goes_on(text: str, at: int, end: int) -> bool:
    """Tell whether a factor follows."""
    space = _SPACE.match(text, at, end)
    rest = text[space.end() if space else at : end]
    return re.match(rf"\\(?!right)[A-Za-z]|[A-Za-zα-ω0-9({{\[√{PLACE}]", rest) is not None


def _sum(text: str, operator: _Operator, end: int, read: _Read) -> tuple[Node, int]:
    """Return the tree of a sum or product, its terms one by one, and where it ends."""
    index = _INDEX.fullmatch(text, *operator.limits[0])
    last = _NUMBER.fullmatch(text, *operator.limits[1])
    if index is None or last is None or int(last[1]) > MOST_FIGURES or int(index[2]) > int(last[1]):
        reason = f"the limits of a sum are numbers up to {MOST_FIGURES} here"
        raise LanguageError(
            text, operator.limits[0][0] + 1, reason, r"write \sum_{i=1}^{3}, or the terms one by one"
        )
    stop = _end_of_term(text, operator.end, end)
    if within := re.compile(r"\\(?:sum|prod|int)|[∫∑∏]").search(text, operator.end, stop):
        reason = "an integral or sum within a sum is not read"
        raise LanguageError(text, within.start() + 1, reason, "write the terms one by one")
    letter = rf"(?<![A-Za-z\\]){index[1]}(?![A-Za-z])"
    if after := re.compile(letter).search(text, stop, end):
        reason = f"does the sum go on to here, where {index[1]} stands again?"
        raise LanguageError(text, after.start() + 1, reason, "write brackets around what is summed")
    places = [found.start() for found in re.compile(letter).finditer(text, operator.end, stop)]
    if beside := next((i for i in places if re.search(r"\d\s*$", text[operator.end : i])), None):
        raise LanguageError(text, beside + 1, "an index behind a number", rf"write {index[1]} \cdot 2")
    digit = re.compile(rf"(?<!_)(?<!_\{{){index[1]}\s*\d").search(text, operator.end, stop)
    if digit is not None and digit.start() in places:
        raise LanguageError(text, digit.end(), "a number behind an index", rf"write 2 \cdot {index[1]}")
    double = rf"_\{{\s*(?:{index[1]}\s*[A-Za-z,]|[A-Za-z]\s*,?\s*{index[1]})"
    if both := re.compile(double).search(text, operator.end, stop):
        reason = f"which of these subscripts is the index {index[1]}?"
        raise LanguageError(text, both.start() + 1, reason, "write the terms one by one")
    terms: list[Node] = []
    for number in range(int(index[2]), int(last[1]) + 1):
        signs = [*text]
        for i in places:
            signs[i] = str(number)
        terms.append(read("".join(signs), operator.end, stop, ""))
    column = operator.at + 1
    parts = tuple((False, term) for term in terms)
    return (Product(parts, column) if operator.sign == PRODUCT else Sum(parts, column)), stop


def _end_of_term(text: str, at: int, end: int) -> int:
    """Return where the term that begins here ends: before a plus, minus or bracket outside its own brackets."""
    depth, begun = 0, False
    while at < end:
        token = _TOKEN.match(text, at, end)
        sign = token.group() if token else text[at]
        bare = sign.lstrip("\\")
        if depth == 0 and (
            (begun and sign in ("+", "-", "−")) or bare.endswith((")", "]", "}")) or sign in ("=", ",", ";")
        ):
            return at
        depth += bare.endswith(("(", "[", "{")) - bare.endswith((")", "]", "}"))
        begun = begun or not sign.isspace()
        at += len(sign)
    return end
