"""Prefix forms of Lisp and Scheme, ``(+ (/ (* p p) (* 2 m)) (* k x))``, written with the signs between operands.

``(- x y)`` is x − y in Lisp and −x y to everybody else: a text is taken for Lisp only where ``(* …)``, ``(/ …)``,
``(= …)`` or ``(expt …)`` stands in it, which nobody else writes, and where all of it is made of such forms.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, TypeAlias

from canon.expression.text.notation import is_latex
from canon.expression.text.tokens import MAX_CHARACTERS
from canon.expression.text.vocabulary import FUNCTIONS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.expression.text.scope import Scope

__all__ = ["with_signs_between"]

_MOST_NESTED = 40
_WORD = re.compile(r"\s*(?:(?P<bracket>[()])|(?P<atom>[^\s()';,\"`]{1,60}))")
_OF_LISP = re.compile(r"\(\s?(?:[*/=]|expt)\s")
_NAMED = re.compile(r"\s*[^\W\d]\w{0,20}(?:\([\w, ]{1,40}\))?\s?=\s?(?=\()")
"""``H =`` before a form."""
_NUMBER = re.compile(r"-?(?:\d{1,40}(?:\.\d{0,40})?|\.\d{1,40})")
_RATIO = re.compile(r"-?\d{1,40}/\d{1,40}")
_NAME = re.compile(r"[^\W\d]\w{0,20}")
_OTHER_NAMES = {"abs": "Abs", "ln": "log"}

_Form: TypeAlias = "str | list[_Form]"


class _NotLispError(ValueError):
    """Raised where a text is not made of forms of Lisp alone."""


def with_signs_between(text: str, scope: Scope) -> str:
    """Return a text in Lisp as other people write it; any other text as it is.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> with_signs_between("(+ (/ (* p p) 2) (- x y))", Scope()), with_signs_between("(- x y)", Scope())
    ('(((p)*(p))/((2))) + ((x) - (y))', '(- x y)')
    >>> from canon import coordinates
    >>> with_signs_between("(+ (* m (((expt D 2) x) t)) (* k (x t)))", Scope({"x": coordinates("x")}))
    "((m)*(x'')) + ((k)*(x))"
    """
    if len(text) > MAX_CHARACTERS or not _OF_LISP.search(text) or is_latex(text):
        return text
    named = _NAMED.match(text)
    begin = named.end() if named else 0
    try:
        form = _form(text[begin:].rstrip(" \t\n.;"))
        if form[0] == "=" and len(form) == 3 and not named:
            return f"{_written(form[1], scope)} = {_written(form[2], scope)}"
        return text[:begin] + _written(form, scope)
    except _NotLispError:
        return text


def _form(text: str) -> list[_Form]:
    """Return the one form that a text is."""
    open_: list[list[_Form]] = [[]]
    at = 0
    while at < len(text):
        found = _WORD.match(text, at)
        if found is None or (len(open_) == 1 and open_[0]):
            raise _NotLispError
        at = found.end()
        if found["bracket"] == "(":
            open_.append([])
        elif found["bracket"] == ")":
            last = open_.pop()
            if not open_ or not last:
                raise _NotLispError
            open_[-1].append(last)
        else:
            open_[-1].append(found["atom"])
        if len(open_) > _MOST_NESTED:
            raise _NotLispError
    match open_:
        case [[[*form]]]:
            return form
        case _:
            raise _NotLispError


def _written(form: _Form, scope: Scope) -> str:
    """Return a form with its signs between brackets."""
    if isinstance(form, str):
        return _atom(form)
    head, *operands = form
    if isinstance(head, list):
        return _rate(head, operands, scope)
    said = [_written(operand, scope) for operand in operands]
    if not said:
        raise _NotLispError
    match head, said:
        case (("+" | "*"), _):
            return {"+": " + ", "*": "*"}[head].join(f"({each})" for each in said)
        case "-", [one]:
            return f"-({one})"
        case "-", _:
            return " - ".join(f"({each})" for each in said)
        case "/", [one]:
            return f"1/({one})"
        case "/", [first, *others]:
            return f"({first})/({'*'.join(f'({each})' for each in others)})"
        case "expt", [base, exponent]:
            return f"({base})**({exponent})"
        case "square", [base]:
            return f"({base})**2"
        case "cube", [base]:
            return f"({base})**3"
        case _:
            return _called(head, said, scope)


def _atom(atom: str) -> str:
    if _RATIO.fullmatch(atom):
        return f"({atom})"
    if _NUMBER.fullmatch(atom) or _NAME.fullmatch(atom):
        return atom
    raise _NotLispError


def _called(head: str, said: Sequence[str], scope: Scope) -> str:
    """Return the value of a function, or a coordinate with the time behind it."""
    name = _OTHER_NAMES.get(head, head)
    if head in scope.functions or (name in FUNCTIONS and not scope.declares(head)):
        return f"{name}({', '.join(said)})"
    if [*said] == [scope.time.name] and scope.takes_time(head):
        return head
    raise _NotLispError


def _rate(head: Sequence[_Form], operands: Sequence[_Form], scope: Scope) -> str:
    """Return the rate that ``((D x) t)`` and ``(((expt D 2) x) t)`` are."""
    if "D" in scope.functions or scope.declares("D"):
        raise _NotLispError
    match [*head], [*operands]:
        case ["D", str(name)], [clock] if clock == scope.time.name and scope.takes_time(name):
            return f"{name}'"
        case [["expt", "D", "2"], str(name)], [clock] if clock == scope.time.name and scope.takes_time(name):
            return f"{name}''"
        case _:
            raise _NotLispError
