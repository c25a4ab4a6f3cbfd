"""MathML of formulas as they were written: from the syntax tree, so nothing is evaluated or reordered.

The markup is a tree of elements, never text put together: whatever a formula says, it stays a formula.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element, SubElement

from canon.expression.parse import syntax_of
from canon.expression.ranges.range_of_call import ranges, without_bounds
from canon.expression.text.syntax import (
    Call,
    Comparison,
    LanguageError,
    Name,
    Negative,
    Node,
    Number,
    Power,
    Product,
    Sum,
    Tuple,
)
from canon.expression.text.tokens import GREEK

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.expression.text.scope import Scope

__all__ = ["formula", "mathml"]

MAX_CHARACTERS = 3_000
"""Longest formula that is set; nobody reads a longer one."""
_LETTERS = {name: letter for letter, name in GREEK.items() if letter not in "ϑϕ"} | {"hbar": "ħ", "ell": "ℓ"}
_RELATIONS = {"<=": "≤", ">=": "≥", "!=": "≠", "==": "="}
_FUNCTIONS = {
    "log": "ln", "asin": "arcsin", "acos": "arccos", "atan": "arctan", "acot": "arccot", "asinh": "arsinh",
    "acosh": "arcosh", "atanh": "artanh", "sign": "sgn", "Max": "max", "Min": "min", "LambertW": "W",
    "elliptic_k": "K", "elliptic_e": "E", "elliptic_f": "F", "elliptic_pi": "Π", "jacobi_am": "am", "jacobi_sn": "sn",
    "jacobi_cn": "cn", "jacobi_dn": "dn", "jacobi_epsilon": "ε",
}  # fmt: skip
_RAISED = ("sin", "cos", "tan", "cot", "sec", "csc", "sinh", "cosh", "tanh")
"""Functions whose powers are written sin²(x)."""
_RATES = (("_ddot", 2), ("_dot", 1))
_TIMES, _APPLY = "\u2062", "\u2061"
_STEM = re.compile(r"([A-Za-z]+)_?(.*)")


def formula(text: str, scope: Scope) -> Element | None:
    """Return a text of the expression language as a ``<math>`` element, None where it is none or too long.

    Parameters
    ----------
    text
        An expression, a condition or an equation, in LaTeX where it begins with ``$``.
    scope
        The declared names, which LaTeX is read with.

    Examples
    --------
    >>> from xml.etree.ElementTree import tostring
    >>> from canon.expression.text.scope import Scope
    >>> tostring(formula("theta_dot/2", Scope()), encoding="unicode")
    '<math><mfrac><mover accent="true"><mi>θ</mi><mo>˙</mo></mover><mn>2</mn></mfrac></math>'
    >>> "".join(formula("Integral(s**2, (s, 0, x))", Scope()).itertext())
    '∫0xs2ds'
    """
    if len(text) > MAX_CHARACTERS:
        return None
    try:
        math = Element("math")
        math.append(mathml(syntax_of(text, scope)))
    except (LanguageError, RecursionError):
        return None
    return math


def mathml(node: Node) -> Element:
    """Return a syntax tree as a MathML element."""
    match node:
        case Number():
            return _leaf("mn", _digits(node))
        case Name():
            return _name(node)
        case Negative(operand):
            return _row(_leaf("mo", "−"), _in_brackets(operand, Sum, Negative, Comparison))
        case Sum(terms):
            return _sum(terms)
        case Product(factors):
            return _product(factors)
        case Power():
            return _power(node)
        case Comparison(operands, relations):
            row = _row(mathml(operands[0]))
            for relation, operand in zip(relations, operands[1:], strict=True):
                row.extend((_leaf("mo", _RELATIONS.get(relation, relation)), mathml(operand)))
            return row
        case Tuple(items):
            return _bracketed(items)
        case _:
            return _call(node)


def _leaf(tag: str, text: str) -> Element:
    element = Element(tag)
    element.text = text
    return element


def _over(tag: str, *children: Element, **attributes: str) -> Element:
    element = Element(tag, attributes)
    element.extend(children)
    return element


def _row(*children: Element) -> Element:
    return _over("mrow", *children)


def _bracketed(nodes: Sequence[Node], opening: str = "(", closing: str = ")") -> Element:
    row = _row(_leaf("mo", opening))
    for i, node in enumerate(nodes):
        if i:
            row.append(_leaf("mo", ","))
        row.append(mathml(node))
    row.append(_leaf("mo", closing))
    return row


def _in_brackets(node: Node, *kinds: type[Node]) -> Element:
    """Return a tree, in brackets where it is of one of these kinds."""
    return _bracketed((node,)) if isinstance(node, kinds) else mathml(node)


def _digits(node: Number) -> str:
    if node.denominator == 1:
        return str(node.numerator)
    places = len(str(node.denominator)) - 1
    digits = str(node.numerator).rjust(places + 1, "0")
    return f"{digits[:-places]}.{digits[-places:]}"


def _name(node: Name) -> Element:
    text, rate = node.text, node.primes
    for ending, dots in _RATES:
        if not rate and text.endswith(ending) and text != ending:
            text, rate = text.removesuffix(ending), dots
    match = _STEM.fullmatch(text)
    stem, below = (match.group(1), match.group(2)) if match else (text, "")
    base = _leaf("mi", _LETTERS.get(stem, stem))
    if rate:
        base = _over(
            "mover", base, _leaf("mo", "˙" if rate == 1 else "¨" if rate == 2 else "⃛"), accent="true"
        )
    if not below:
        return base
    parts = ",".join(_LETTERS.get(part, part) for part in below.split("_"))
    return _over("msub", base, _leaf("mn" if parts.isdigit() else "mi", parts))


def _sum(terms: Sequence[tuple[bool, Node]]) -> Element:
    row = _row()
    for i, (minus, term) in enumerate(terms):
        if i or minus:
            row.append(_leaf("mo", "−" if minus else "+"))
        bare = mathml(term) if not i and not minus else _in_brackets(term, Sum, Negative, Comparison)
        row.append(_bracketed((term,)) if i and _begins_with_minus(term) else bare)
    return row


def _begins_with_minus(node: Node) -> bool:
    return isinstance(node, Product) and isinstance(node.factors[0][1], Negative)


def _product(factors: Sequence[tuple[bool, Node]]) -> Element:
    """Set a product as it was written: ``g/l*sin(x)`` is a fraction g/l and a sine."""
    pieces: list[Element] = []
    numbers: list[bool] = []
    above: list[Node] = []
    below: list[Node] = []

    def close() -> None:
        if below:
            pieces.append(_over("mfrac", _factors(above, whole=True), _factors(below, whole=True)))
            numbers.append(True)
        else:
            for node in above:
                first = not pieces
                pieces.append(_factor(node, first=first))
                numbers.append(isinstance(node, Number))
        above.clear()
        below.clear()

    for divides, node in factors:
        if divides:
            below.append(node)
        else:
            if below:
                close()
            above.append(node)
    close()
    return _joined(pieces, numbers)


def _factors(nodes: Sequence[Node], *, whole: bool) -> Element:
    if whole and len(nodes) == 1:
        return mathml(nodes[0])  # the bar of the fraction is its bracket
    pieces = [_factor(node, first=i == 0) for i, node in enumerate(nodes)]
    return _joined(pieces, [isinstance(node, Number) for node in nodes])


def _factor(node: Node, *, first: bool) -> Element:
    return _in_brackets(node, Sum, Comparison) if first else _in_brackets(node, Sum, Comparison, Negative)


def _joined(pieces: Sequence[Element], numbers: Sequence[bool]) -> Element:
    row = _row()
    for i, (piece, number) in enumerate(zip(pieces, numbers, strict=True)):
        if i:
            row.append(_leaf("mo", "·" if number and numbers[i - 1] else _TIMES))
        row.append(piece)
    return row if len(pieces) > 1 else pieces[0]


def _power(node: Power) -> Element:
    base, exponent = node.base, node.exponent
    match exponent:
        case Product(((False, Number(1, 1)), (True, Number(2, 1)))) | Number(5, 10):
            return _over("msqrt", mathml(base))
        case Number() if isinstance(base, Call) and base.function in _RAISED:
            name = _over("msup", _leaf("mi", base.function), mathml(exponent))
            return _row(name, _leaf("mo", _APPLY), _bracketed(base.arguments))
        case _:
            pass
    plain = isinstance(base, Name | Number) or (isinstance(base, Call) and base.function in ("Abs", "sqrt"))
    return _over("msup", mathml(base) if plain else _bracketed((base,)), mathml(exponent))


def _integral(integrand: Node, over: Sequence[Node]) -> Element:
    """Return an integral over one range after the other, the last the outermost, or over a variable without limits."""
    found, alone = ranges(over), without_bounds(over)
    row = _row()
    for one in reversed(found):
        row.append(_over("msubsup", _leaf("mo", "∫"), mathml(one.lower), mathml(one.upper)))
    if alone is not None:
        row.append(_leaf("mo", "∫"))
    row.append(_in_brackets(integrand, Sum, Comparison))
    for variable in (alone,) if alone is not None else (one.variable for one in found):
        row.append(_row(_leaf("mo", "d"), mathml(variable)))
    return row


def _call(node: Call) -> Element:
    match node.function, node.arguments:
        case "sqrt", (argument,):
            return _over("msqrt", mathml(argument))
        case "Abs", (argument,):
            return _bracketed((argument,), "|", "|")
        case "exp", (argument,):
            return _over("msup", _leaf("mi", "e"), mathml(argument))
        case "Ne", (left, right):
            return mathml(Comparison((left, right), ("!=",), node.column))
        case "Derivative", (function, *variables) if variables:
            return _derivative(function, variables)
        case ("Integral", (integrand, *over)) if ranges(over) or without_bounds(over):
            return _integral(integrand, over)
        case "Piecewise", pieces if pieces and len(pairs := _pairs(pieces)) == len(pieces):
            return _piecewise(pairs)
        case _:
            pass
    name = _FUNCTIONS.get(node.function)
    head = _leaf("mi", name) if name else _name(Name(node.function, 0, node.column))
    return _row(head, _leaf("mo", _APPLY), _bracketed(node.arguments))


def _derivative(function: Node, variables: Sequence[Node]) -> Element:
    orders: list[tuple[Node, Node | None]] = []
    for variable in variables:
        if isinstance(variable, Tuple) and len(variable.items) == 2:
            orders.append((variable.items[0], variable.items[1]))
        else:
            orders.append((variable, None))
    single = len(orders) == 1 and isinstance(function, Call) and len(function.arguments) == 1
    sign = "d" if single else "∂"
    above = _leaf("mo", sign)
    total = _total_order([order for _, order in orders])
    if total != 1:
        above = _over("msup", above, _leaf("mn", str(total)) if total is not None else _leaf("mi", "n"))
    below = _row()
    for variable, order in orders:
        below.append(_leaf("mo", sign))
        set_variable = _in_brackets(variable, Sum, Product, Negative, Comparison)
        below.append(set_variable if order is None else _over("msup", set_variable, mathml(order)))
    if isinstance(function, Name):
        return _over("mfrac", _row(above, mathml(function)), below)
    return _row(_over("mfrac", above, below), _in_brackets(function, Sum, Negative, Product, Comparison))


def _total_order(orders: Sequence[Node | None]) -> int | None:
    """Return how often is differentiated in all; None where an order is no number."""
    total = 0
    for order in orders:
        if order is not None and not isinstance(order, Number):
            return None
        total += 1 if order is None else order.numerator
    return total


def _pairs(pieces: Sequence[Node]) -> list[tuple[Node, Node]]:
    """Return the values with their conditions, as far as pieces are pairs of these."""
    return [(p.items[0], p.items[1]) for p in pieces if isinstance(p, Tuple) and len(p.items) == 2]


def _piecewise(pairs: Sequence[tuple[Node, Node]]) -> Element:
    table = Element("mtable", {"columnalign": "left"})
    for value, condition in pairs:
        row = SubElement(table, "mtr")
        SubElement(row, "mtd").append(mathml(value))
        otherwise = condition == Name("True", 0, condition.column)
        SubElement(row, "mtd").append(_leaf("mtext", "otherwise") if otherwise else mathml(condition))
    return _row(_leaf("mo", "{"), table)
