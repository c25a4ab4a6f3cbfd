"""Juxtaposition: formulas as people type them, factors side by side, ``2 m g l (1 - cos θ)``, ``½mẋ²``.

Only what can be read in one way is read. Refused, with both readings, are ``a/b c``, ``x^2y``, ``x 2``, ``2e3`` where
``e`` is declared, and a symbol before a bracket that could be its argument: ``f(x)`` with a bare name inside, or a
coordinate before a bracket with the time in it. ``theta(t)`` is the coordinate itself.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING
from unicodedata import numeric

from canon.expression.programs.constructors import constructed
from canon.expression.text.applied_functions import applied, is_function, with_brackets
from canon.expression.text.differentials import PARTIAL, PRIMED, derivative, of_operator
from canon.expression.text.factor_parser import CLOSING, FactorParser
from canon.expression.text.open_readings import (
    DECLARED_E,
    counts,
    is_angle,
    looks_like_eulers,
    prime_in_doubt,
)
from canon.expression.text.quotients import divisor, ended
from canon.expression.text.syntax import (
    Call,
    LanguageError,
    Name,
    Negative,
    Node,
    Number,
    Power,
    Product,
    Tuple,
)
from canon.expression.text.vocabulary import CONSTANTS

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope
    from canon.expression.text.tokens import Token

__all__ = ["Reader", "parse_juxtaposed"]

MAX_TIMES = 8
"""How often ``.diff`` may follow."""
_PRODUCT_OR_VALUE = "write * for a product; a function is declared in functions"


def parse_juxtaposed(text: str, scope: Scope) -> Node:
    """Return the syntax tree of a text in which factors may stand side by side.

    Raises
    ------
    LanguageError
        Where the text is not in the grammar, or could be read in two ways.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression.parse import Scope, parse_expression
    >>> theta, (m, g, l) = coordinates("theta"), parameters("m g l")
    >>> scope = Scope({s.name: s for s in (theta, m, g, l)})
    >>> parse_expression("2mgl (1 - cos θ)", scope) == parse_expression("2*m*g*l*(1 - cos(theta))", scope)
    True
    >>> parse_expression("g/2l", scope)
    Traceback (most recent call last):
        ...
    canon.expression.text.tokens.LanguageError: column 4: g/2l is g/2*l or g/(2*l)?; write the one that is meant
    g/2l
       ^
    """
    return Reader(text, scope).whole()


class Reader(FactorParser):
    """The grammar with what people leave out: signs of multiplication, brackets of arguments."""

    def product(self) -> Node:
        """Read factors with * and / between them, or nothing."""
        column, first = self.token.column, self.at
        factors = [(False, self.signed())]
        starts = [first]
        while True:
            begins = self.at
            if sign := self.take("*", "/"):
                self.after_bare(sign)
                factors.append((sign.text == "/", self.signed()))
                if sign.text == "/":
                    factors[-1] = (True, divisor(self, factors))
            elif self.starts(self.token):
                factors.append((False, self.beside(factors, starts)))
            else:
                return Product(tuple(factors), column) if len(factors) > 1 else factors[0][1]
            starts.append(begins)

    def after_bare(self, sign: Token) -> None:
        """Refuse a quotient that could belong to an argument without brackets: ``sin x/2``."""
        if sign.text == "/" and self.bare_end == self.at - 1 and not self.divides_sine():
            raise self.fault(*self.open_slash(), sign)

    def divides_sine(self) -> bool:
        """Tell whether a slash behind ``sin θ`` divides the sine: nobody divides an angle by a length."""
        argument = self.tokens[self.at - 2]
        if argument is not self.bare_start[1] or argument.kind != "name" or not is_angle(argument.text):
            return False
        if is_function(self):  # cos θ/sin θ
            return True
        texts = [token.text for token in self.tokens[self.at :]]
        end = texts.index(")") if texts[0] == "(" and ")" in texts else 1
        return any(self.scope.declares(text) and not counts(text) for text in texts[:end])

    def open_slash(self) -> tuple[str, str]:
        """Return the question behind a function without brackets, ``g sin θ / l``, and both its readings."""
        slash, below = (
            self.tokens[self.at - 1].column - 1,
            "(…)" if self.token.text == "(" else self.token.text,
        )
        head, first = (token.column - 1 for token in self.bare_start)
        name, argument = self.text[head:first].strip()[:20], self.text[first:slash].strip()[:20]
        readings = f"{name}({argument})/{below} or {name}({argument}/{below})"
        return f"does this divide the function or its argument? {readings}", "write the one that is meant"

    def beside(self, factors: list[tuple[bool, Node]], starts: list[int]) -> Node:
        """Return the factor that stands directly after another one."""
        token, last = self.token, self.tokens[self.at - 1]
        divides, before = factors[-1]
        if token.kind in ("number", "vulgar", "string"):
            raise self.fault("a number after a factor", "write x_2, x**2 or 2*x, whichever is meant")
        if token.text == "for" and not self.scope.declares("for"):
            raise self.fault("comprehensions are not part of the language")
        if divides:
            ended(self, factors, starts)
        if token.tight and self.bare_end != self.at and self.may_be_raised(before, last):
            raise self.fault(
                "does this still belong to the exponent?", "put a space or * before it, or brackets"
            )
        bars = any(earlier.text == "|" for earlier in self.tokens[: self.at])
        if token.text == "|" and token.tight and bars and last.text != "|":
            raise self.fault("does this bar open or close?", "write Abs( ) for one of the moduli")
        if token.tight and token.text in CLOSING and self.bare_end == self.at and not self.alone(last):
            raise self.fault(
                "does this factor still belong to the argument?", "write sin(x)*(y) or sin(x*(y))"
            )
        factor = self.power()
        name = last if last.kind == "name" else self.raised_name(before, token)
        if token.text in CLOSING and name is not None:
            self.no_value(token, name, factor.base if isinstance(factor, Power) else factor)
        return factor

    def raised_name(self, before: Node, opening: Token) -> Token | None:
        """Return the name whose power a bracket stands tight behind, as in ``x²(0)``; None where it is none."""
        power = before.operand if isinstance(before, Negative) else before
        if not (opening.tight and isinstance(power, Power) and isinstance(power.base, Name)):
            return None
        return next((token for token in self.tokens if token.column == power.base.column), None)

    def may_be_raised(self, before: Node, last: Token) -> bool:
        """Tell whether what follows a power may still belong to its exponent, ``x^2y``."""
        power = before.operand if isinstance(before, Negative) else before
        if not isinstance(power, Power) or last.kind == "super" or last.text in (")", "]", "}"):
            return False
        if isinstance(power.exponent, Number) and is_function(self):
            return False
        # R^2(…) is a product by hand; x**2(…) is code that lacks a sign.
        bracket = self.token.text == "(" and self.tokens[self.at - 2].text == "^"
        return not (last.kind == "number" and (bracket or self.is_raised_too(self.token)))

    def is_raised_too(self, token: Token) -> bool:
        """Tell whether a name is raised as the factor before it was: w^2q^2 is a product, w^2q may be none."""
        sign = self.tokens[self.at + 1]
        return token.kind == "name" and sign.tight and sign.text in ("^", "**") and not is_function(self)

    def alone(self, last: Token) -> bool:
        """Tell whether a function was taken of one angle that moves, which nobody multiplies inside."""
        return last is self.bare_start[1] and is_angle(last.text) and self.scope.moves(last.text)

    def no_value(self, opening: Token, name: Token, inside: Node) -> None:
        """Refuse a symbol before a bracket that could be the argument of a function of that name."""
        if not (self.scope.declares(name.text) or name.primes):
            return
        moves = self.scope.moves(name.text) or name.primes > 0
        held = [t.text for t in self.tokens[: self.at] if t.column > opening.column and t.kind == "name"]
        # Nothing that moves is taken at the place of another: P(q - a t) is a product, q(t - a) may be none.
        others = any(self.scope.moves(text) for text in held if text != self.scope.time.name)
        clock = self.scope.time.name in held and not others
        bare = isinstance(inside, Name) and not inside.primes
        clock = clock and not isinstance(inside, Name)
        if bare or isinstance(inside, Tuple) or (isinstance(inside, Number) and moves) or (moves and clock):
            raise self.fault(
                f"is {name.text} applied to this, or multiplied by it?", _PRODUCT_OR_VALUE, opening
            )

    def power(self) -> Node:
        """Read a base, and an exponent if there is one."""
        start = self.at
        base = self.differentiated(self.atom())
        token = self.token
        if (token.kind == "super" or token.text in ("**", "^")) and self.bare_end == self.at > start:
            raise self.fault("does this raise the function or its argument?", "write sin(x)**2 or sin(x**2)")
        if token.kind == "super":
            self.at += 1
            return self.of_its_argument(self.to_the(base, self.raised(token), token), self.tokens[start])
        if sign := self.take("**", "^"):
            self.deeper(sign)
            node = self.to_the(base, self.exponent(sign), sign)
            self.depth -= 1
            by_hand = isinstance(node.exponent, Number) and sign.text == "^"
            return self.of_its_argument(node, self.tokens[start]) if by_hand else node
        return base

    def of_its_argument(self, power: Power, first: Token) -> Power:
        """Return a power whose base has its argument behind the exponent: ``ẋ²(t)``, ``V²(x)``, not ``V²(a)``."""
        opening, base = self.token, power.base
        if not (opening.text in ("(", "[") and opening.tight and self.tokens[self.at - 1] is not first):
            return power
        if isinstance(base, Name) and self.scope.declares(base.text):
            if self.at_time(first):
                self.at += 3
            return power
        if first.text not in self.scope.functions or not isinstance(base, Name | Call):
            return power
        if isinstance(base, Call) and base.function != PARTIAL:  # V(x)²(…) has its argument
            return power
        variables = self.scope.functions[first.text]
        arguments = with_brackets(self)
        if [part.text if isinstance(part, Name) else "" for part in arguments] != [*variables]:
            raise self.fault(
                f"is {first.text} taken of this, or multiplied by it?", _PRODUCT_OR_VALUE, opening
            )
        whole = Call(base.text, arguments, base.column) if isinstance(base, Name) else base
        return Power(whole, power.exponent, power.column)

    def to_the(self, base: Node, exponent: Node, sign: Token) -> Power:
        """Return a power; code says ``e**t`` of what is declared, by hand it may be Euler's number."""
        if sign.text != "**" and looks_like_eulers(base, exponent, self.scope):
            raise self.fault(*DECLARED_E, sign)
        return Power(base, exponent, sign.column)

    def differentiated(self, base: Node) -> Node:
        """Read ``.diff(t)`` behind what it differentiates, as in Python."""
        times = 0
        while sign := self.take(".diff"):
            times += 1
            if times > MAX_TIMES:
                raise self.fault(f"differentiated more than {MAX_TIMES} times", token=sign)
            base = Call("Derivative", (base, *with_brackets(self)), sign.column)
        return base

    def atom(self) -> Node:
        """Read a number, a name, a call or a bracket."""
        token = self.token
        match token.text:
            case "√" | "∛" | "∜":
                self.at += 1
                return self.root(token)
            case "∂" if (node := derivative(self)) is not None:
                return node
            case "|":
                self.at += 1
                return self.modulus(token)
            case "[" | "{":
                self.at += 1
                return self.group(token)
            case _:
                pass
        if token.kind == "vulgar":
            self.at += 1
            value = Fraction(numeric(token.text)).limit_denominator(10)
            return Number(value.numerator, value.denominator, token.column)
        if token.kind == "string":
            raise self.fault("there are no string literals")
        return super().atom()

    def named(self, token: Token) -> Node:
        """Read a name, the call of a function, a function without brackets, or a derivative."""
        opening = self.token
        bracket = opening.text in ("(", "[")
        if token.text in self.scope.functions:
            return self.of_function(token, bracket)
        if self.scope.declares(token.text):
            return self.declared(token, opening)
        if token.text == "d" and (node := derivative(self, token)) is not None:
            return node
        if token.text == "D" and (rate := of_operator(self)) is not None:
            moves = rate.text not in self.scope.functions
            return (
                Name(rate.text, rate.primes, rate.column) if moves else self.of_function(rate, bracket=True)
            )
        if (node := constructed(self, token)) is not None:
            return node
        if (node := applied(self, token)) is not None:
            return node
        if bracket and opening.tight and token.text not in CONSTANTS:
            return self.called(token)
        return Name(token.text, token.primes, token.column)

    def declared(self, token: Token, opening: Token) -> Node:
        """Read a declared name, with ``(t)`` behind it where it is of a coordinate."""
        tight = opening.text in ("(", "[") and opening.tight
        if tight and self.at_time(token):
            self.at += 3
            if not token.primes:
                return Call(token.text, (Name(self.scope.time.name, 0, opening.column),), token.column)
        elif tight and opening.text == "[" and self.closes_after(2):
            raise self.fault("there is no indexing", "write ( ) for grouping, * for a product")
        return Name(token.text, token.primes, token.column)

    def closes_after(self, tokens: int) -> bool:
        """Tell whether a square bracket closes so many tokens on."""
        place = self.at + tokens
        return place < len(self.tokens) and self.tokens[place].text in ("]", "]]")

    def of_function(self, token: Token, bracket: bool) -> Node:
        """Read a value of a declared function, or with primes its derivative; V alone is V(x)."""
        if not token.primes and not bracket and self.starts(self.token):
            arguments = ", ".join(self.scope.functions[token.text])
            raise self.fault(f"{token.text} is a function", f"write {token.text}({arguments})", token)
        if not token.primes:
            return self.called(token) if bracket else Name(token.text, 0, token.column)
        variables = self.scope.functions[token.text]
        if not bracket and (doubt := prime_in_doubt(token.text, self.scope)):
            raise self.fault(doubt, f"write Derivative({token.text}({variables[0]}), {variables[0]})", token)
        arguments = with_brackets(self) if bracket else tuple(Name(v, 0, token.column) for v in variables)
        if len(variables) != 1 or len(arguments) != 1:
            raise self.fault(
                f"a prime after {token.text}: with respect to what?",
                f"write Derivative({token.text}(…), x)",
                token,
            )
        value = Call(token.text, arguments, token.column)
        if not isinstance(arguments[0], Name):
            return Call(PRIMED, (value, Number(token.primes, 1, token.column)), token.column)
        return Call(PARTIAL, (value, arguments[0], Number(token.primes, 1, token.column)), token.column)

    def called(self, token: Token) -> Node:
        """Read the arguments of a call in round or square brackets."""
        opening = self.token
        arguments = with_brackets(self)
        if opening.text == "[" and token.text not in self.scope.functions:
            raise self.fault(f"{token.text}[…] is not part of the language", "write round brackets", opening)
        return Call(token.text, arguments, token.column)

    def at_time(self, name: Token) -> bool:
        """Tell whether ``(t)`` follows what moves."""
        if not (self.scope.takes_time(name.text) or name.primes) or self.at + 2 >= len(self.tokens):
            return False
        opening, inside, closing = self.tokens[self.at : self.at + 3]
        return (
            name.text != self.scope.time.name
            and inside.text == self.scope.time.name
            and not inside.primes
            and closing.text == CLOSING[opening.text]
        )

    def number(self, token: Token) -> Node:
        """Return the exact value of a decimal, of one in degrees as well."""
        letter = token.text.lower().find("e")
        ending = token.text[letter:]
        spelled = ending.isalnum() and self.words.declared(ending)  # E0 is a spelling of E_0
        if letter > 0 and (spelled or self.scope.declares(ending[0])):
            raise LanguageError(
                self.text,
                token.column,
                f"{token.text[:20]} is one number, or a product with {ending[0]}?",
                "write 2*10**3 for the number, * for the product",
            )
        node = super().number(token)
        if self.take("°"):
            degrees = Product(
                ((False, Name("pi", 0, token.column)), (True, Number(180, 1, token.column))), token.column
            )
            return Product(((False, node), (False, degrees)), token.column)
        return node
