r"""LaTeX grammar: formulas to the syntax tree of the expression language, with columns of the LaTeX text.

Names are resolved while the text is cut into words (:mod:`canon.expression.latex.words`), an LALR(1) grammar
finds the structure in linear time, and :mod:`canon.expression.latex.meaning` says what stands side by side means.
Nothing is evaluated, and what a reader could take two ways is refused with what to write instead.

Conventions
-----------
* ``a b`` is a product; ``mgl`` is m g l where these are declared and ``mgl`` is not.
* A function without brackets takes the factors that follow it, up to the next sign, operator or function:
  ``\sin 2\theta`` is sin(2θ), ``\sin\theta\cos\theta`` is sin(θ) cos(θ), ``\cos\omega t`` is cos(ω t). Behind a
  coordinate it takes no velocity, ``\sin\theta\dot\theta`` is sin(θ) θ̇, and behind an angle no bracket. Only numbers
  and parameters may stand before the last of these factors; ``\sin\theta\,x``, ``\sin\alpha x``, ``\sin a(b+c)``,
  ``\sin\theta^2`` and ``\sin\theta/2`` are refused.
* With brackets or braces it takes exactly these: ``\sin(a)b`` is sin(a) b, ``\sin(a)^2`` is sin(a)².
* ``\sin^2 x`` is sin(x)², ``\sin^{-1}x`` the inverse function; ``\log`` is the natural logarithm.
* Braces are not seen in print: ``{x^a}^b`` and ``\frac{a}{b}^2`` are refused.
* ``a/b c`` is refused; ``p^2/2m`` and ``g/l\sin\theta`` are read as :mod:`canon.expression.latex.quotient` tells.
"""

from __future__ import annotations

from functools import cache
from math import comb
from typing import TYPE_CHECKING, Any, NoReturn

from lark import Lark, Token, Transformer_NonRecursive, UnexpectedToken
from lark.exceptions import VisitError

from canon.expression.latex.argument_end import bare_argument
from canon.expression.latex.derivatives import are_differentials
from canon.expression.latex.latex_statement import spans
from canon.expression.latex.meaning import Meaning
from canon.expression.latex.pieces import FactorRun, Group, Head, Piece, Powered, whole
from canon.expression.latex.quotient import dividing, shown
from canon.expression.latex.words import Word, Words, words_of
from canon.expression.ranges.latex_ranges import with_ranges
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

if TYPE_CHECKING:
    from lark import ParseTree

    from canon.expression.text.scope import Scope

__all__ = ["parse_latex"]

_GRAMMAR = """
start: sum (RELATION sum)*
?sum: SIGN? product (SIGN product)*
?product: run ((TIMES | SLASH) run)*
?run: item+
?item: atom | power | head
power: atom CARET script
head: HEAD (_UNDER script)? (CARET script)?
?atom: ATOM | group | brace | bars | fraction | root | cases
?script: ATOM | brace | fraction | root
?part: ATOM | brace
group: LPAR sum (_COMMA sum)* _RPAR
brace: LBRACE sum (OVER sum)? _RBRACE
bars: LBAR sum _RBAR
cases: LCASES row (_CROW row)* _RCASES
row: sum _COMMA? _CCOLUMN condition _COMMA?
condition: COTHERWISE | disjunction
disjunction: conjunction (_COR conjunction)*
conjunction: clause (_CAND clause)*
?clause: comparison | _LCLAUSE disjunction _RCLAUSE
comparison: sum (RELATION sum)+
fraction: FRAC part part
root: SQRT (_LINDEX sum _RINDEX)? part
"""
_RELATIONS = {
    **dict.fromkeys(("<", "\\lt"), "<"), **dict.fromkeys((">", "\\gt"), ">"), "=": "=",
    **dict.fromkeys(("\\le", "\\leq", "\\leqslant", "≤"), "<="),
    **dict.fromkeys(("\\ge", "\\geq", "\\geqslant", "≥"), ">="), **dict.fromkeys(("\\ne", "\\neq", "≠"), "!="),
}  # fmt: skip
_MOST_CHOSEN = 100
"""Largest upper number of a binomial coefficient."""
_SILENT = (
    "UNDER", "COMMA", "RPAR", "RBRACE", "RBAR", "LINDEX", "RINDEX", "RCASES", "CROW", "CCOLUMN", "CAND",
    "COR", "LCLAUSE", "RCLAUSE",
)  # fmt: skip


@cache
def _parser() -> Lark:
    terminals = (
        "ATOM", "HEAD", "SIGN", "TIMES", "SLASH", "RELATION", "CARET", "LPAR", "LBRACE", "LBAR", "FRAC", "SQRT",
        "OVER", "LCASES", "COTHERWISE",
    )  # fmt: skip
    declared = " ".join((*terminals, *(f"_{kind}" for kind in _SILENT)))
    return Lark(f"{_GRAMMAR}\n%declare {declared}\n", parser="lalr", lexer="basic")


def parse_latex(text: str, scope: Scope) -> Node:
    r"""Return the syntax tree of one expression, condition or equation in LaTeX.

    Parameters
    ----------
    text
        The formula, with or without ``$``, ``\[ \]`` or a display around it.
    scope
        The declared names; ``\theta_1`` is ``theta_1`` or ``theta1``, ``\varphi`` is ``varphi`` or ``phi``,
        whichever is declared.

    Raises
    ------
    LanguageError
        With the column in the LaTeX text, the reason and a remedy.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression.parse import Scope, parse_equation
    >>> theta, (g, l) = coordinates("theta"), parameters("g l")
    >>> scope = Scope({"theta": theta, "g": g, "l": l})
    >>> formula = parse_equation(r"$\ddot\theta + \frac{g}{l}\sin\theta = 0$", scope)
    >>> formula == parse_equation("theta_ddot + g/l*sin(theta)", scope)
    True
    >>> parse_equation(r"$\sin\theta l = 0$", scope)
    Traceback (most recent call last):
        ...
    canon.expression.text.tokens.LanguageError: column 13: does this factor still belong to the argument of sin? ...
    """
    bare, statements = spans(text)
    sides, *others = statements
    if others:
        column = others[0][0].start + 1
        raise LanguageError(text, column, "a second equation begins here", "write one equation only")
    try:
        return _tree(bare, scope, sides[0].start, sides[-1].end)
    except VisitError as error:
        raise _of_field(text, error.orig_exc) from None
    except LanguageError as error:
        raise _of_field(text, error) from None


def _tree(text: str, scope: Scope, start: int, end: int) -> Node:
    """Return the tree of what stands between two places, integrals and sums read first."""

    def read(part: str, begin: int, stop: int, variable: str) -> Node:
        return _tree(part, scope.with_variable(variable), begin, stop)

    text, inner = with_ranges(text, start, end, read)
    words = words_of(text, scope, start, end, inner)
    return _Build(words, Meaning(text, scope, words.spaced)).transform(_structure(text, words))


def _of_field(text: str, error: Exception) -> Exception:
    """Return an error with the text as it was typed."""
    if isinstance(error, LanguageError):
        return LanguageError(text, error.column, error.reason, error.remedy)
    return error


def _structure(text: str, words: Words) -> ParseTree:
    """Return the parse tree; each of its tokens holds the number of a word."""
    state = _parser().parse_interactive("")
    before: Word | None = None
    for index, word in enumerate(words.words):
        kind = f"_{word.kind}" if word.kind in _SILENT else word.kind
        try:
            state.feed_token(Token(kind, "", start_pos=index))
        except UnexpectedToken:
            raise _unexpected(text, before, word, words.end) from None
        before = word
    try:
        return state.feed_eof()
    except UnexpectedToken:
        raise _unexpected(text, before, None, words.end) from None


class _Build(Transformer_NonRecursive[Token, Any]):
    """Builds the tree from the leaves up, without recursion."""

    def __init__(self, words: Words, meaning: Meaning) -> None:
        super().__init__(visit_tokens=True)
        self.words = words.words
        self.meaning = meaning

    def __default_token__(self, token: Token) -> Any:
        word = self.words[token.start_pos or 0]
        return word if word.item is None else word.item

    def start(self, children: list[Any]) -> Node:
        nodes = tuple(self.meaning.node(child) for child in children[::2])
        if len(nodes) == 1:
            return nodes[0]
        return Comparison(nodes, tuple(_RELATIONS[word.shown] for word in children[1::2]), nodes[0].column)

    def sum(self, children: list[Any]) -> Node:
        signed: list[Any] = children if isinstance(children[0], Word) else [None, *children]
        terms: tuple[tuple[bool, Node], ...] = tuple(
            (sign is not None and sign.shown != "+", self.meaning.node(term))
            for sign, term in zip(signed[::2], signed[1::2], strict=True)
        )
        if terms[1:]:
            return Sum(terms, children[0].column)
        ((minus, node),) = terms
        return Negative(node, children[0].column) if minus else node

    def product(self, children: list[Any]) -> Node:
        factors: list[tuple[bool, Node]] = []
        children = self.with_derivatives(children)
        signs: list[Word | None] = [None, *children[1::2], None]
        for before, piece, after in zip(signs[:-1], children[::2], signs[1:], strict=True):
            items = _items(piece)
            found = self.meaning.factors(items)
            self._refuse_open_end(items, after)
            if before is None or before.kind != "SLASH":
                factors += [(False, node) for node in found]
            else:
                above = [node for _, node in factors]
                last = dividing(above, items, found, self.meaning.ends, self.meaning.text)
                if last is None:
                    self.open_quotient(before, above, found)
                factors += [(number < last, node) for number, node in enumerate(found)]
            if after and after.kind == "SLASH" and (argument := bare_argument(items)):
                self.open_slash(after, found[-1], argument, children)
        return Product(tuple(factors), children[0].column)

    def open_slash(
        self, slash: Word, function: Node, argument: tuple[Piece, ...], children: list[Any]
    ) -> None:
        r"""Refuse a slash behind a function without brackets, ``\sin x / l``, with both readings."""
        behind = next((c for c in children[1:] if not isinstance(c, Word) and c.column > slash.column), None)
        if behind and self.meaning.ends.divides(argument, _items(behind)[0]):
            return
        below = shown(self.meaning.factors(_items(behind))[:1]) if behind else "…"
        over, inside = shown([function]), shown(self.meaning.factors(argument))
        readings = f"{over}/{below} or {over.replace(f'({inside})', f'({inside}/{below})')}"
        told = f"does this divide the function or its argument? {readings}"
        self.meaning.refuse(slash.column, told, r"write \frac{a}{b} or brackets, whichever is meant")

    def _refuse_open_end(self, items: tuple[Piece, ...], after: Word | None) -> None:
        if after and after.kind == "TIMES" and self.meaning.leaves_open(items):
            self.meaning.refuse(
                after.column,
                "does this factor still belong to the argument before it?",
                r"write brackets, \cos(\omega t)",
            )
        if after and after.kind == "SLASH" and self.meaning.ends_with_derivative_of_fraction(items):
            self.meaning.refuse(
                after.column, "does this divide the derivative or the fraction?", "write brackets"
            )

    def with_derivatives(self, children: list[Any]) -> list[Any]:
        r"""Return pieces and signs, a derivative with a slash, ``d\theta/dt``, made one piece."""
        found = children[:1]
        for sign, piece in zip(children[1::2], children[2::2], strict=True):
            above, below = _items(found[-1]), _items(piece)
            derivative = self.meaning.spelled_with_slash(above, below) if sign.kind == "SLASH" else None
            if derivative is None:
                found += (sign, piece)
                continue
            start, made, end = derivative
            items = (*above[:start], made, *below[end:])
            found[-1] = FactorRun(items, items[0].column)
        return found

    def open_quotient(self, slash: Word, above: list[Node], below: list[Node]) -> NoReturn:
        """Refuse a quotient of which it is open where it ends, with both readings."""
        over, first, rest, all_ = shown(above[-1:]), shown(below[:1]), shown(below[1:]), shown(below)
        readings = f"({over}/{first}) {rest} or {over}/({all_})"
        self.meaning.refuse(
            slash.column,
            f"does the quotient end after one factor? {over}/{first} {rest} can be {readings}",
            rf"write \frac{{{over}}}{{{first}}} {rest} or \frac{{{over}}}{{{all_}}}, whichever is meant",
        )

    def run(self, children: list[Any]) -> FactorRun:
        return FactorRun(tuple(children), children[0].column)

    def power(self, children: list[Any]) -> Powered:
        base, sign, exponent = children
        inner = exponent.inner if isinstance(exponent, Group) and exponent.braces else None
        if (
            isinstance(base, Name)
            and isinstance(inner, Group)
            and whole(self.meaning.node(inner)) is not None
        ):
            reason = f"is this the derivative of {base.text}, or a power?"
            self.meaning.refuse(sign.column, reason, "write dots for rates, ^2 for a power")
        return self.meaning.raised(base, self.meaning.node(exponent))

    def head(self, children: list[Any]) -> Head:
        function, *scripts = children
        base = exponent = None
        while scripts:
            script = scripts.pop()
            if scripts and isinstance(scripts[-1], Word):
                scripts.pop()
                exponent = self.meaning.node(script)
            else:
                base = self.meaning.node(script)
        return Head(function, base, exponent, function.column)

    def group(self, children: list[Any]) -> Group:
        opening, *inner = children
        if isinstance(inner[0], FactorRun) and are_differentials(inner[0].items):
            return Group(inner[0], braces=False, column=opening.column)
        if len(inner) == 1:
            return Group(self.meaning.node(inner[0]), braces=False, column=opening.column)
        if opening.shown != "(":
            self.meaning.refuse(opening.column, "a bracket of two is not an expression", "write it out")
        pair = Tuple(tuple(self.meaning.node(piece) for piece in inner), opening.column)
        return Group(pair, braces=False, column=opening.column)

    def brace(self, children: list[Any]) -> Piece:
        opening, inner, *over = children
        if over:
            return self.meaning.fraction(inner, over[1], opening.column)
        return Group(inner, braces=True, column=opening.column)

    def cases(self, children: list[Any]) -> Node:
        return Call("Piecewise", tuple(children[1:]), children[0].column)

    def row(self, children: list[Any]) -> Node:
        value = self.meaning.node(children[0])
        return Tuple((value, children[1]), value.column)

    def condition(self, children: list[Any]) -> Node:
        if isinstance(children[0], Word):
            return Name("True", 0, children[0].column)
        return children[0]

    def disjunction(self, children: list[Any]) -> Node:
        return children[0] if len(children) == 1 else Call("Or", tuple(children), children[0].column)

    def conjunction(self, children: list[Any]) -> Node:
        return children[0] if len(children) == 1 else Call("And", tuple(children), children[0].column)

    def comparison(self, children: list[Any]) -> Node:
        nodes = tuple(self.meaning.node(child) for child in children[::2])
        signs = (_RELATIONS[word.shown] for word in children[1::2])
        return Comparison(nodes, tuple("==" if sign == "=" else sign for sign in signs), nodes[0].column)

    def bars(self, children: list[Any]) -> Node:
        return Call("Abs", (self.meaning.node(children[1]),), children[0].column)

    def fraction(self, children: list[Any]) -> Piece:
        word, above, below = children
        if word.shown.endswith("binom"):
            return Group(self.binomial(word, above, below), braces=False, column=word.column)
        return self.meaning.fraction(above, below, word.column)

    def binomial(self, word: Word, above: Piece, below: Piece) -> Node:
        """Return the number that a binomial coefficient of two whole numbers is."""
        n, k = whole(self.meaning.node(above)), whole(self.meaning.node(below))
        if n is None or k is None or n > _MOST_CHOSEN:
            reason = f"binomial coefficients are read of whole numbers up to {_MOST_CHOSEN}"
            self.meaning.refuse(word.column, reason, "write it out")
        return Number(comb(n, k), 1, word.column)

    def root(self, children: list[Any]) -> Node:
        column = children[0].column
        radicand = self.meaning.node(children[-1])
        index = self.meaning.node(children[1]) if len(children) == 3 else Number(2, 1, column)
        one = (False, Number(1, 1, column))
        return Power(radicand, Product((one, (True, index)), column), column)


def _items(piece: Piece) -> tuple[Piece, ...]:
    return piece.items if isinstance(piece, FactorRun) else (piece,)


def _unexpected(text: str, before: Word | None, word: Word | None, end: int) -> LanguageError:
    """Return the error of a word that the grammar has no place for, in terms of what stands before it."""
    column = word.column if word else end
    last = before.kind if before else ""
    kind = word.kind if word else ""
    remedy = ""
    if last in ("CARET", "UNDER") and kind == "SIGN":
        reason, remedy = "LaTeX raises only the sign", "write braces, x^{-1}"
    elif last in ("SIGN", "TIMES", "SLASH") and kind == "SIGN":
        reason, remedy = "two signs in a row", "write brackets, a - (-b)"
    elif kind == "CARET" and last not in ("SIGN", "TIMES", "SLASH", "RELATION", "LPAR", "LBRACE", ""):
        reason, remedy = "a second exponent, or one of nothing", "write (x^a)^b or x^{a b}"
    elif kind == "UNDER":
        reason, remedy = "a subscript belongs directly after a name", "write x_1^2, q_{12}"
    elif kind == "COMMA":
        reason, remedy = "a comma separates arguments only", "write 0.5 for a decimal"
    elif kind == "RELATION":
        reason, remedy = f"{word.shown if word else ''} where an expression should be", ""
    elif last in ("FRAC", "SQRT"):
        reason, remedy = (
            f"{before.shown if before else ''} needs its arguments",
            r"write \frac{a}{b}, \sqrt{x}",
        )
    elif word is None or kind in ("RPAR", "RBRACE", "RBAR", "RINDEX"):
        reason = "the formula ends too early" if word is None else f"something is missing before {word.shown}"
    else:
        reason = f"{word.shown} where a number, a name or a bracket should be"
    return LanguageError(text, column, reason, remedy)
