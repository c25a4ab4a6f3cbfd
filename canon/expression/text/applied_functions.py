"""Applied functions: ``sin θ``, ``sinθ``, ``sin^2 θ``, ``Sin[x]``, ``e^x``.

Without brackets a function takes numbers and what follows them: one name, ``sin 2θ``; letters written as one word with
it, ``sin kx``; a parameter or a constant root and the time, ``cos ω t``, ``cos √(k/m) t``. It ends after the first
name that moves. ``sin a x``, ``cos ω · t``, ``cos t √(k/m)``, ``sin x/2`` and ``sin x^2`` are refused, with both
readings.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import function_name
from canon.expression.text.factor_parser import CLOSING, ROOTS
from canon.expression.text.open_readings import is_angle_of_functions
from canon.expression.text.syntax import (
    Call,
    Name,
    Negative,
    Node,
    Number,
    Power,
    Product,
    parts,
)
from canon.expression.text.vocabulary import WHICH_E

if TYPE_CHECKING:
    from canon.expression.text.factor_parser import FactorParser
    from canon.expression.text.tokens import Token

__all__ = ["applied", "is_function", "with_brackets"]

_INVERSE = {"sin": "asin", "cos": "acos", "tan": "atan", "cot": "acot", "sinh": "asinh", "cosh": "acosh",
            "tanh": "atanh"}  # fmt: skip
_BARE = frozenset((*_INVERSE, *_INVERSE.values(), "sec", "csc", "log", "exp", "sqrt", "atan"))
"""Functions that may stand without brackets."""
_WAVES = frozenset(("sin", "cos", "sinh", "cosh", "tan", "tanh"))
"""Functions of a frequency times the time."""
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
        _refuse_a_bracket_of_frequency(reader, name, following, node)
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


def _refuse_a_bracket_of_frequency(reader: FactorParser, name: str, opening: Token, called: Node) -> None:
    """Refuse ``cos (2π/T) t`` and ``cos (k/m)^(1/2) t``, whose bracket may be but a factor of the argument."""
    if opening.tight or name not in _WAVES or _moves(reader, called) or _of_angles(reader, called):
        return
    behind = _behind_exponent(reader)
    if not _is_clock(reader, reader.tokens[behind]):
        return
    clock, raised = reader.scope.time.name, behind > reader.at
    within = reader.text[opening.column - 1 : reader.tokens[behind].column - 1].strip()[:40]
    shown = f"({name}{within})*{clock}" if raised else f"{name}{within}*{clock}"
    raise reader.fault(
        f"does {clock} still belong to the argument of {name}? {shown} or {name}({within}*{clock})",
        "write the one that is meant",
        reader.tokens[behind],
    )


def _behind_exponent(reader: FactorParser) -> int:
    """Return the place of the token behind an exponent that comes next, of this one where none does."""
    at, tokens = reader.at, reader.tokens
    if tokens[at].kind == "super":
        return at + 1
    if tokens[at].text not in ("^", "**"):
        return at
    closing = CLOSING.get(tokens[at + 1].text)
    if closing is None:
        return at + 2 if tokens[at + 1].kind == "number" else at
    ends = [place for place in range(at + 2, len(tokens)) if tokens[place].text == closing]
    return ends[0] + 1 if ends else at


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
    inner = function_name(first.text, reader.scope) if first.kind == "name" else ""
    if inner in _BARE and inner != "sqrt":
        return _applied_inside(reader, first, inner, chain)
    taken: list[Node] = []
    numeric = True
    while reader.starts(reader.token) and (numeric or _still(reader, first, name, taken)):
        node = reader.atom()
        taken.append(node)
        numeric = numeric and _is_numeric(reader, node)
        if not isinstance(node, Number | Name) and _moves(reader, node):
            break
    if reader.token.text == "*":
        _refuse_a_sign(reader, first, name, taken[-1], numeric=numeric)
    return taken[0] if len(taken) == 1 else Product(tuple((False, node) for node in taken), first.column)


def _moves(reader: FactorParser, node: Node) -> bool:
    """Tell whether anything in a factor moves."""
    names = (part for part in parts(node) if isinstance(part, Name))
    return any(name.primes or reader.scope.moves(name.text) for name in names)


def _of_angles(reader: FactorParser, node: Node) -> bool:
    """Tell whether every name in a factor is that of an angle."""
    names = [part for part in parts(node) if isinstance(part, Name) and not _is_numeric(reader, part)]
    return bool(names) and all(is_angle_of_functions(name.text) for name in names)


def _is_clock(reader: FactorParser, token: Token) -> bool:
    return token.kind == "name" and token.text == reader.scope.time.name


def _refuse_a_sign(reader: FactorParser, first: Token, name: str, last: Node, *, numeric: bool) -> None:
    """Refuse a sign behind an argument that may go on: ``cos 2 * x``, ``cos ω · t``."""
    constant = not _moves(reader, last) and not _of_angles(reader, last)
    if numeric or (constant and _is_clock(reader, reader.tokens[reader.at + 1])):
        shown = reader.text[first.column - 1 : reader.token.column - 1].strip()[:40]
        raise reader.fault(f"{name}({shown}) times this, or {name} of the product?", "write brackets")


def _is_sqrt(reader: FactorParser) -> bool:
    """Tell whether a root comes next, by its sign or its name."""
    token = reader.token
    return token.text in ROOTS or (token.kind == "name" and function_name(token.text, reader.scope) == "sqrt")


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
    if isinstance(node, Call):  # √2
        return node.function == "sqrt" and all(_is_numeric(reader, inside) for inside in node.arguments)
    is_pi = isinstance(node, Name) and node.text == "pi" and not reader.scope.declares("pi")
    return is_pi or isinstance(node, Number)


def _still(reader: FactorParser, first: Token, name: str, taken: list[Node]) -> bool:
    """Tell whether a factor still belongs to an argument without brackets."""
    last, token = taken[-1], reader.token
    if isinstance(last, Name) and (last.primes or reader.scope.moves(last.text)):
        _refuse_root_of_frequency(reader, name, taken)
        return False
    angle = _of_angles(reader, last)  # v cos α t is v t cos α, or v cos(α t)
    if is_function(reader) and (angle or not _is_sqrt(reader)):
        return False
    word = token.tight and token.kind == "name" and not first.tight and isinstance(last, Name)
    clock = _is_clock(reader, token)
    if word or (clock and not angle):
        return True
    if angle and not isinstance(last, Name) and not clock:
        return False
    raise reader.fault(
        f"does this factor still belong to the argument of {name}?",
        f"write {name}(x)*y or {name}(x*y), or this factor first",
    )


def _refuse_root_of_frequency(reader: FactorParser, name: str, taken: list[Node]) -> None:
    """Refuse ``cos t √(k/m)``, which says cos(√(k/m) t), or √(k/m) cos t."""
    clock = reader.scope.time.name
    alone = all(_is_numeric(reader, node) for node in taken[:-1])
    if alone and taken[-1] == Name(clock, 0, taken[-1].column) and _is_sqrt(reader):
        raise reader.fault(
            f"does this root still belong to the argument of {name}?",
            f"write {name}({clock})*sqrt(…) or {name}(sqrt(…)*{clock})",
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
