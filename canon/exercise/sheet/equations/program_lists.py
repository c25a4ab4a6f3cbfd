"""Lists as programs write them: Mathematica's rules ``{{a -> b}}``, MATLAB's column ``[a; b]``, Maple's ``<a, b>``.

SymPy's dictionary ``{a: b}`` of a solution is a list of rules as well. Each is made into the equations or the list that
people write, and keeps its length.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from canon.expression.text.notation import is_latex
from canon.expression.text.tokens import MAX_CHARACTERS, LanguageError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["listed_plainly", "lists_in", "rule_as_equation"]

_OPEN, _CLOSE = "([{", ")]}"
_SIGN = re.compile(r"(?<![<>!:=])={1,2}(?!=)")
_VECTOR = re.compile(r"\s*<(?P<inside>[^<>=|]{3,2000})>[\s.;]*")
_RULES = ("->", "→", ":")
_RULE = re.compile(r"(?P<name>[^=<>→↦{}-]{1,40})(?P<sign>->|→|↦)(?P<value>[^=<>→↦{}]{1,4000})")
_OF_NUMBERS = re.compile(r"[\s\d.,+\-−∞]*")
_MOST_LAYERS = 2


def lists_in(value: Any) -> Any:
    """Return what stands under a key with every list in it as people write one."""
    if isinstance(value, str):
        return listed_plainly(value)
    return [lists_in(item) for item in value] if isinstance(value, list) else value


def listed_plainly(text: str) -> str:
    r"""Return a text with the lists of programs in it as people write them.

    Raises
    ------
    LanguageError
        Where several solutions stand in one list.

    Examples
    --------
    >>> listed_plainly("{{x''[t] -> -x[t]}}").strip(), listed_plainly("[-x; y]"), listed_plainly("<-x, y>")
    ("x''[t] =  -x[t]", '[-x, y]', '⟨-x, y⟩')
    >>> listed_plainly("[1, 2; 3, 4]"), listed_plainly("a -> b")
    ('[1, 2; 3, 4]', 'a -> b')
    """
    if len(text) > MAX_CHARACTERS or is_latex(text):
        return text
    if any(sign in text for sign in _RULES) and "{" in text:
        text = _with_equations(text)
    if ";" in text and "[" in text:
        text = _with_commas(text)
    return _with_angles(text) if "<" in text else text


def rule_as_equation(text: str, is_name: Callable[[str], bool]) -> str:
    """Return a rule ``H -> p^2/2`` as an equation, where its left side is what is asked for; it keeps its length.

    ``x → 0`` says where x tends to, and is left alone.

    Examples
    --------
    >>> rule_as_equation("H -> p^2/2", lambda name: name.strip() == "H"), rule_as_equation("H -> 0", lambda name: True)
    ('H =  p^2/2', 'H -> 0')
    """
    found = None if is_latex(text) else _RULE.fullmatch(text)
    if found is None or _OF_NUMBERS.fullmatch(found["value"]) or not is_name(found["name"]):
        return text
    return f"{found['name']}{'='.ljust(len(found['sign']))}{found['value']}"


def _with_equations(text: str) -> str:
    """Return the rules of one solution as equations, without the braces around them."""
    inside = text
    for _ in range(_MOST_LAYERS):
        bare = _inside_brackets(inside)
        if bare is None:
            break
        inside = bare
    if inside is text:
        return text
    signs = list(inside)
    outside = [at for at, depth in _depths(inside) if depth == 0]
    rules = [at for at in outside if inside.startswith(_RULES, at) and not inside.startswith(":=", at)]
    if not rules:
        if re.search(r"\}\s*,\s*\{", inside):
            told = "several solutions stand in this list: which one is meant?"
            raise LanguageError(text, 1, told, "write one equation for each rate")
        return text
    if any(inside[at] == "=" for at in outside):
        return text
    for at in outside:
        signs[at] = ";" if signs[at] == "," else signs[at]
    for at in rules:
        signs[at] = "="
        if inside[at] == "-":
            signs[at + 1] = " "
    return "".join(signs)


def _inside_brackets(text: str) -> str | None:
    """Return a text with blanks for the braces, or the bracket of a list of such, around it; None without."""
    begin, end = len(text) - len(text.lstrip()), len(text.rstrip(" \t\n.;"))
    around = text[begin : begin + 1] + text[end - 1 : end]
    if around != "{}" and not (around == "[]" and text[begin + 1 : end - 1].strip().startswith("{")):
        return None
    if any(depth == 0 for at, depth in _depths(text) if begin < at < end - 1):
        return None
    return f"{text[:begin]} {text[begin + 1 : end - 1]} {text[end:]}"


def _depths(text: str) -> Iterator[tuple[int, int]]:
    """Yield the place of each sign that is no bracket, with how many brackets are open there."""
    depth = 0
    for at, sign in enumerate(text):
        if sign in _CLOSE:
            depth -= 1
        elif sign in _OPEN:
            depth += 1
        else:
            yield at, depth


def _with_commas(text: str) -> str:
    """Return a text with commas for the semicolons of columns ``[a; b]``; rows of several entries, equations stay."""
    signs = list(text)
    open_: list[int] = []
    parted: dict[int, list[int]] = {}
    rows: set[int] = set()
    for at, sign in enumerate(text):
        if sign in _OPEN:
            open_.append(at)
        elif sign in _CLOSE and open_:
            open_.pop()
        elif sign in ",;=" and open_ and text[open_[-1]] == "[":
            if sign == ";":
                parted.setdefault(open_[-1], []).append(at)
            else:
                rows.add(open_[-1])
    for opening, places in parted.items():
        if opening not in rows:
            for at in places:
                signs[at] = ","
    return "".join(signs)


def _with_angles(text: str) -> str:
    """Return a text in which the sides that are vectors of Maple's stand in brackets of their own."""
    made, begin = "", 0
    for end in [*(sign.start() for sign in _SIGN.finditer(text)), len(text)]:
        side = text[begin:end]
        lead = len(side) - len(side.lstrip("= "))
        vector = _VECTOR.fullmatch(side, lead)
        if vector and "," in vector["inside"]:
            a, b = vector.span("inside")
            side = f"{side[: a - 1]}⟨{side[a:b]}⟩{side[b + 1 :]}"
        made += side
        begin = end
    return made
