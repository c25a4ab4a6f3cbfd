"""Applied functions: ``sin θ``, ``sinθ``, ``sin^2 θ``, ``Sin[x]``, ``e^x``, and the constructors that SymPy prints.

Without brackets a function takes numbers and what follows them: one name, ``sin 2θ``; letters written as one word with
it, ``sin kx``; a parameter and the time, ``cos ω t``. It ends after the first name that moves. ``sin a x``, ``sin x/2``
and ``sin x^2`` are refused, with both readings.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import function_name
from canon.expression.text.differentials import PARTIAL, PRIMED
from canon.expression.text.open_readings import is_angle_of_functions
from canon.expression.text.syntax import (
    Call,
    Comparison,
    Name,
    Negative,
    Node,
    Number,
    Power,
    Product,
    Sum,
    Tuple,
    parts,
)
from canon.expression.text.vocabulary import WHICH_E

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from canon.expression.text.factor_parser import FactorParser
    from canon.expression.text.tokens import Token

__all__ = ["applied", "constructed", "is_function", "with_brackets"]

_INVERSE = {"sin": "asin", "cos": "acos", "tan": "atan", "cot": "acot", "sinh": "asinh", "cosh": "acosh",
            "tanh": "atanh"}  # fmt: skip
_BARE = frozenset((*_INVERSE, *_INVERSE.values(), "sec", "csc", "log", "exp", "sqrt", "atan"))
"""Functions that may stand without brackets."""
_MAX_CHAIN = 4
_OF_MATHEMATICA = re.compile(r"\\\[[A-Z]|(?<![A-Za-z])(?:Sin|Cos|Tan|Sinh|Cosh|Exp|Log|Sqrt|ArcTan)\[")
"""What only Mathematica writes, where E is Euler's number."""
_CONSTANTS = {"%pi": "pi", "Pi": "pi", "%i": "I", "π": "pi"}


def is_function(reader: FactorParser) -> bool:
    """Tell whether a function comes next."""
    token = reader.token
    return token.kind == "name" and function_name(token.text, reader.scope) in _BARE


def applied(reader: FactorParser, token: Token, chain: int = 1) -> Node | None:
    """Return a function of the language with its argument, the token being its name; None where it is none."""
    scope = reader.scope
    if token.text in _CONSTANTS and not scope.declares(token.text):
        return Name(_CONSTANTS[token.text], 0, token.column)
    if token.text in ("e", "E", "%e") and not scope.declares(token.text):
        return _exponential(reader, token)
    name = function_name(token.text, scope)
    if not name or token.primes:
        return None
    exponent = _exponent(reader) if name in _BARE else None
    following = reader.token
    if following.text in ("(", "["):
        node = _called(reader, token, name, following)
    elif name not in _BARE:
        return None if exponent is None else Name(token.text, 0, token.column)
    elif name == "sqrt" and reader.starts(following):
        node = reader.root(token)
    elif reader.starts(following):
        _refuse_a_base(reader, token.text)
        node = Call(name, (_bare(reader, name, chain),), token.column)
        reader.bare_end, reader.bare_start = reader.at, (token, following)
    elif following.text in ("+", "-"):
        raise reader.fault(f"{name} needs its argument in brackets here", f"write {name}(-x)")
    else:
        return Name(name, 0, token.column)
    return _raised(reader, node, exponent, name)


def _exponent(reader: FactorParser) -> Node | None:
    """Return the exponent between a function and its argument, ``sin^2 x``."""
    token = reader.token
    if token.kind == "super":
        reader.at += 1
        return reader.raised(token)
    if token.text not in ("^", "**"):
        return None
    reader.at += 1
    start = reader.token
    if start.text in ("(", "{"):
        reader.at += 1
        return reader.group(start)
    minus = reader.take("-")
    node = reader.token
    reader.at += 1
    if node.kind == "number" and node.text.isdigit():
        found: Node = reader.number(node)
    elif node.kind == "name":
        found = Name(node.text, 0, node.column)
    else:
        reader.at -= 1
        reason = "an exponent before an argument is a whole number or a name"
        raise reader.fault(reason, "write any other behind it, sin(x)**2")
    return Negative(found, node.column) if minus else found


def _raised(reader: FactorParser, node: Node, exponent: Node | None, name: str) -> Node:
    if exponent is None:
        return node
    inverse = (
        isinstance(exponent, Negative)
        and isinstance(exponent.operand, Number)
        and exponent.operand == Number(1, 1, exponent.operand.column)
    )
    if inverse and isinstance(node, Call):
        if name not in _INVERSE:
            raise reader.fault(
                f"{name} to the power −1 can be the inverse function or 1/{name}", "write it out"
            )
        return Call(_INVERSE[name], node.arguments, node.column)
    return Power(node, exponent, node.column)


def _called(reader: FactorParser, token: Token, name: str, opening: Token) -> Node:
    """Return a function whose arguments stand in brackets; Mathematica's have some of theirs the other way round."""
    arguments = with_brackets(reader)
    if opening.text == "(" and token.text.startswith(("Elliptic", "Jacobi")):
        what = (
            f"is {token.text}( ) Mathematica's, of the parameter m, or Maple's, of the modulus k with m = k²?"
        )
        raise reader.fault(what, f"write {name}( ), which is of the parameter m", token)
    if opening.text == "[" and len(arguments) == 2 and name in ("atan", "log"):
        return Call("atan2" if name == "atan" else "log", arguments[::-1], token.column)
    if token.text in ("ArcTan", "arctan") and len(arguments) == 2:
        if token.text == "ArcTan":
            raise reader.fault(
                "ArcTan of two: (x, y) as in Mathematica, or (y, x)?", "write atan2(y, x)", token
            )
        name = "atan2"
    return Call(name, arguments, token.column)


def with_brackets(reader: FactorParser) -> tuple[Node, ...]:
    """Return the arguments in the brackets that come next."""
    opening = reader.token
    closing = {"(": ")", "[": "]"}[opening.text]
    reader.at += 1
    bars, reader.bars = reader.bars, 0
    reader.deeper(opening)
    arguments: list[Node] = []
    while not reader.take(closing):
        if arguments and not reader.take(","):
            raise reader.unclosed(opening)
        arguments.append(reader.comparison())
    reader.depth -= 1
    reader.bars = bars
    return tuple(arguments)


def _bare(reader: FactorParser, name: str, chain: int) -> Node:
    """Return the argument of a function without brackets."""
    first = reader.token
    if first.kind == "name" and (inner := function_name(first.text, reader.scope)) in _BARE:
        return _applied_inside(reader, first, inner, chain)
    taken: list[Node] = []
    numeric = True
    while reader.starts(reader.token) and (numeric or _still(reader, first, name, taken)):
        node = reader.atom()
        taken.append(node)
        numeric = numeric and _is_numeric(reader, node)
        if not isinstance(node, Number | Name):
            break
    if numeric and reader.token.text == "*":
        number = reader.text[first.column - 1 : reader.token.column - 1].strip()
        raise reader.fault(f"{name}({number}) times this, or {name} of the product?", "write brackets")
    return taken[0] if len(taken) == 1 else Product(tuple((False, node) for node in taken), first.column)


def _refuse_a_base(reader: FactorParser, name: str) -> None:
    """Refuse ``log10(x)`` and ``exp2(x)``, which name a base elsewhere."""
    number, behind = reader.tokens[reader.at : reader.at + 2]
    if name in ("log", "exp") and number.kind == "number" and number.tight and reader.starts(behind):
        n = number.text
        remedy = f"write {f'log(x)/log({n})' if name == 'log' else f'{n}**x'}, or {name}({n}*x)"
        raise reader.fault(f"is {n} the base of {name}, or a factor?", remedy)


def _applied_inside(reader: FactorParser, token: Token, name: str, chain: int) -> Node:
    """Return the argument of a function that is a function without brackets, ``sin cos x``."""
    if chain >= _MAX_CHAIN:
        raise reader.fault(f"more than {_MAX_CHAIN} functions without brackets", "write brackets")
    reader.at += 1
    node = applied(reader, token, chain + 1)
    if node is None or isinstance(node, Name):
        raise reader.fault(f"{name} needs its argument", "write brackets")
    return node


def _is_numeric(reader: FactorParser, node: Node) -> bool:
    is_pi = isinstance(node, Name) and node.text == "pi" and not reader.scope.declares("pi")
    return is_pi or isinstance(node, Number)


def _still(reader: FactorParser, first: Token, name: str, taken: list[Node]) -> bool:
    """Tell whether a factor still belongs to an argument without brackets."""
    last, token = taken[-1], reader.token
    if isinstance(last, Name) and (last.primes or reader.scope.moves(last.text)):
        return False
    if is_function(reader):
        return False
    word = token.tight and token.kind == "name" and not first.tight
    clock = token.kind == "name" and token.text == reader.scope.time.name
    angle = isinstance(last, Name) and is_angle_of_functions(
        last.text
    )  # v cos α t is v t cos α, or v cos(α t)
    if word or (clock and not angle):
        return True
    raise reader.fault(
        f"does this factor still belong to the argument of {name}?",
        f"write {name}(x)*y or {name}(x*y), or this factor first",
    )


def _exponential(reader: FactorParser, token: Token) -> Node | None:
    """Return exp of what e is raised to."""
    exponent = reader.token
    if exponent.kind == "super":
        reader.at += 1
        return _raised_e(reader, token, reader.raised(exponent))
    if sign := reader.take("^", "**"):
        reader.deeper(sign)
        inside = reader.exponent(sign)
        reader.depth -= 1
        bracketed = reader.tokens[reader.at - 1].text in (")", "}", "]")
        tight = reader.starts(reader.token) and reader.token.tight
        if not bracketed and (tight or _goes_on_with_what_moves(reader, inside)):
            raise reader.fault("does this still belong to the exponent?", "write brackets, e^(a*t)")
        return _raised_e(reader, token, inside)
    if token.text == "e":
        raise reader.fault(WHICH_E, "write exp(1) for the number; a name is declared", token)
    return Call("exp", (Number(1, 1, token.column),), token.column) if token.text == "%e" else None


def _goes_on_with_what_moves(reader: FactorParser, exponent: Node) -> bool:
    """Tell whether a constant exponent may go on behind a blank, as in ``e^-γ t`` and ``e^i ω t``."""
    names = [part.text for part in parts(exponent) if isinstance(part, Name)]
    following = reader.token
    programs = _OF_MATHEMATICA.search(reader.text) is not None
    if programs or not names or any(map(reader.scope.moves, names)):
        return False
    if following.kind != "name" or following.primes:
        return False
    turns = [name for name in names if not reader.scope.declares(name)] in (["i"], ["I"], ["j"])
    behind = reader.tokens[reader.at + 1] if turns else following
    return reader.scope.moves(following.text) or (behind.kind == "name" and reader.scope.moves(behind.text))


def _raised_e(reader: FactorParser, token: Token, exponent: Node) -> Node:
    """Return exp of an exponent; with a bare number as exponent, e may be a name that is not declared."""
    of_mathematica = token.text == "E" and _OF_MATHEMATICA.search(reader.text) is not None
    if isinstance(exponent, Number) and token.text != "%e" and not of_mathematica:
        shown = f"{exponent.numerator}"[:9]
        raise reader.fault(
            WHICH_E if token.text == "e" else "is E Euler's number, or a name that is not declared?",
            f"write exp({shown}) for the number; a name is declared",
            token,
        )
    return Call("exp", (exponent,), token.column)


def constructed(reader: FactorParser, token: Token) -> Node | None:
    """Return what a constructor of SymPy or Mathematica makes, as ``Mul(Integer(2), Symbol('x'))``; else None."""
    opening = reader.token
    if opening.text not in ("(", "[") or reader.scope.declares(token.text) or token.primes:
        return None
    if token.text in ("Symbol", "Function") and opening.text == "(":
        return _quoted(reader, token)
    make = _CONSTRUCTORS.get(token.text)
    if make is None:
        return None
    arguments = [node for node in with_brackets(reader) if not _is_assumption(node)]
    node = make(token.column, arguments)
    if isinstance(node, Name) and token.text == "Subscript":
        return _with_subscript(reader, node)
    if node is None:
        raise reader.fault(
            f"{token.text} with {len(arguments)} argument(s)", "write the formula itself", token
        )
    return node


def _with_subscript(reader: FactorParser, name: Name) -> Name:
    """Return the declared name that ``Subscript[m, 1]`` is, m_1 or m1, and pass over ``[t]`` behind one that moves."""
    plain = name.text.replace("_", "")
    if not reader.scope.declares(name.text) and reader.scope.declares(plain):
        name = Name(plain, 0, name.column)
    if [t.text for t in reader.tokens[reader.at : reader.at + 3]] == ["[", reader.scope.time.name, "]"]:
        reader.at += 3
    return name


def _is_assumption(node: Node) -> bool:
    """Tell whether this is ``real=True`` or ``evaluate=False``, which changes no formula here."""
    match node:
        case Comparison((Name(), Name(text="True" | "False" | "true" | "false")), ("=",)):
            return True
        case _:
            return False


def _quoted(reader: FactorParser, token: Token) -> Node | None:
    """Return the name in ``Symbol('x')``, or of ``Function('theta')(Symbol('t'))``."""
    string = reader.tokens[reader.at + 1]
    if string.kind != "string":
        return None
    name = string.text[1:-1]
    found = reader.words.declared(name)
    name = found[0] if len(found) == 1 else name
    while reader.token.text != ")":
        if reader.token.kind == "end":
            raise reader.fault("'(' is never closed", token=token)
        reader.at += 1
    reader.at += 1
    if token.text == "Symbol" or reader.tokens[reader.at].text != "(":
        return Name(name, 0, string.column)
    return Call(name, with_brackets(reader), string.column)


def _product(column: int, arguments: list[Node]) -> Node:
    return Product(tuple((False, node) for node in arguments), column)


def _quotient(column: int, arguments: list[Node]) -> Node | None:
    if len(arguments) != 2:
        return None
    return Product(((False, arguments[0]), (True, arguments[1])), column)


def _sum(column: int, arguments: list[Node]) -> Node:
    return Sum(tuple((False, node) for node in arguments), column)


def _power(column: int, arguments: list[Node]) -> Node | None:
    return Power(arguments[0], arguments[1], column) if len(arguments) == 2 else None


def _squared(column: int, arguments: list[Node]) -> Node | None:
    return Power(arguments[0], Number(2, 1, column), column) if len(arguments) == 1 else None


def _itself(column: int, arguments: list[Node]) -> Node | None:  # noqa: ARG001
    return arguments[0] if len(arguments) == 1 else None


def _equation(column: int, arguments: list[Node]) -> Node | None:
    return Comparison((arguments[0], arguments[1]), ("=",), column) if len(arguments) == 2 else None


def _tuple(column: int, arguments: list[Node]) -> Node:
    return Tuple(tuple(arguments), column)


def _derivative(column: int, arguments: list[Node]) -> Node | None:
    return Call("Derivative", tuple(arguments), column) if len(arguments) > 1 else None


def _over(kind: str) -> Callable[[int, list[Node]], Node | None]:
    """Return the constructor of an integral or sum; without a range it has no value."""
    return lambda column, arguments: Call(kind, tuple(arguments), column) if len(arguments) > 1 else None


def _outermost_first(column: int, arguments: list[Node]) -> Node | None:
    """Return Mathematica's integral, whose first range is the outermost; that of Integral is the innermost."""
    if len(arguments) < 2:
        return None
    operand, *over = arguments
    return Call("Integral", (operand, *reversed(over)), column)


def _slope_at(column: int, arguments: list[Node]) -> Node | None:
    """Return the derivative at a place that SymPy prints as ``Subs(Derivative(V(_xi_1), _xi_1), _xi_1, x)``."""
    match arguments:
        case [Call("Derivative", (Call(f, (Name(v),)), Name(w))), Name(u), place] if v == w == u:
            order = 1
        case [
            Call("Derivative", (Call(f, (Name(v),)), Tuple((Name(w), Number(order, 1))))),
            Name(u),
            place,
        ] if v == w == u:
            pass
        case _:
            return None
    value, times = Call(f, (place,), column), Number(order, 1, column)
    return (
        Call(PARTIAL, (value, place, times), column)
        if isinstance(place, Name)
        else Call(PRIMED, (value, times), column)
    )


def _subscripted(column: int, arguments: list[Node]) -> Node | None:
    """Return the name that Mathematica's ``Subscript[m, 1]`` is."""
    match arguments:
        case [Name(text, 0), Number(number, 1)]:
            return Name(f"{text}_{number}", 0, column)
        case [Name(text, 0), Name(index, 0)]:
            return Name(f"{text}_{index}", 0, column)
        case _:
            return None


_CONSTRUCTORS: Mapping[str, Callable[[int, list[Node]], Node | None]] = {
    "Mul": _product, "Times": _product, "Add": _sum, "Plus": _sum, "Pow": _power, "Power": _power, "pow": _power,
    "Rational": _quotient, "Fraction": _quotient, "Integer": _itself, "Float": _itself, "S": _itself,
    "sympify": _itself, "Hold": _itself, "HoldForm": _itself, "Tuple": _tuple, "D": _derivative,
    "Equal": _equation, "Equality": _equation, "power": _power, "square": _squared, "rational": _quotient,
    **dict.fromkeys(("Integral", "integrate"), _over("Integral")),
    "Integrate": _outermost_first,
    **dict.fromkeys(("Sum", "sum", "summation"), _over("Sum")),
    **dict.fromkeys(("Product", "product"), _over("Product")),
    "Subscript": _subscripted, "Subs": _slope_at,
}  # fmt: skip
