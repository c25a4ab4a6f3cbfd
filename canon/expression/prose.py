r"""Prose around a formula: words that lead to it, its heading, and what is said of it behind.

``**Equation of motion:** $m\ddot x + kx = 0$``, ``Die Bewegungsgleichung lautet m x'' = -k x``, ``m x'' = -k x, where k
is the spring constant``. Words are passed over where all of them are of a list of those that name a formula or lead to
it: no other word is known to leave it as it is, and a name of the question is never one of them.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.sentences.closing_sentence import start_of_closing
from canon.expression.sentences.known_words import HARMLESS, LEADING
from canon.expression.sentences.leading_sentence import end_of_sentence, start_of_sentence_behind
from canon.expression.symbols.symbol import Coordinate
from canon.expression.text.declared_names import Words
from canon.expression.text.scope import split
from canon.expression.text.tokens import MAX_CHARACTERS, tokens

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["WORD", "end_of_words", "is_prose", "without_prose"]

_QUOTED = r">(?!\s*[=>])(?=[^<>=!]*=)"
"""A sign of quoted mail, which stands before an equation; before anything else it says what is greater."""
_MARKS = re.compile(
    rf"\s*(?:(?:{_QUOTED}|[✅☑✔→⟶•▪⇒⟹∴]|=>|-{{1,2}}>|<=>|#{{1,6}}(?=\s))\s*)*(?:\*\*(?=[^\W\d_]{{2}}))?"
)
_BULLET = re.compile(r"\s*[-*]\s+")
WORD = (
    r"(?:[Ss]i (?:ottiene|ha|trova|ricava|scrive)(?!\w)|(?:[Ee]qn?s?|[Ss]oln?|[Aa]ns)\.(?=[ :])"
    r"|(?:(?:[cdjlmst]|[CDJLMST]|[Qq]u)['’])?[^\W\d_]{2,}(?:['’][^\W\d_]{1,9})?(?:[.-][^\W\d_]+)*|[^\W\d_](?!['’]))"
)
_ELIDED = re.compile(r"^(?:[cdjlmst]|qu|all|dall|dell|nell|sull)['’](?=[^\W\d_]{2})", re.IGNORECASE)
"""French and Italian words before a vowel."""
_HEADING = re.compile(
    rf"(?P<words>{WORD}(?:[ ,]{{1,3}}{WORD}){{0,7}})(?: ?\(?\d{{1,2}}\)?)?[*_]{{0,2}}"
    r"(?: ?:(?![=:])[*_]{0,2}(?=[\s$\\(*])|\s*\n)\s*"
)
_LEADING_WORD = re.compile(rf"(?P<word>{WORD})[,:]?(?:\s+|(?=\$|\\[\[(]))")
_UPRIGHT = re.compile(
    r"\\(?:text|textrm|textbf|mathrm)\s?\{\s*(?P<words>[^\W\d_][^{}=\\$]{1,60})\}(?:\s|\\q?quad(?![A-Za-z])|\\[,;: ])*"
    r"(?=[^\s=+*/^-])"
)
_SENTENCE = re.compile(
    r"(?:[\s.,;$]|\\\]|\\q?quad(?![A-Za-z])|\\[,;: ]){1,12}(?:\\(?:text|textrm)\s?\{\s*)?(?:"
    r"for (?:all|every|any) \}?\s?\$?(?P<every>\\?\w{1,12})\$?"
    r"|(?:where|wobei|où|donde|onde|dove|waar|kde|gdzie|где) \}?\s?\$?(?P<symbol>\\?\w{1,12})\$? "
    r"(?P<role>(?:is|denotes|ist|bezeichnet|est|désigne|es|è|é|jest|je) [^\W\d_ ][\w ]{2,80})"
    r"|(?P<words>(?:which|this|that|it) is [^\W\d_][^\W\d_ -]*(?:[ -][^\W\d_]+){1,12}))\s?\}?[\s.$]{0,9}$",
    re.IGNORECASE,
)
"""What may be said of a formula behind it: for whom it holds, what a letter is, what it is called."""
_CALLED = re.compile(
    rf"(?<=[\w)\]}}'′″²³$])(?:\s[—–]\s+|,?\s(?=(?:is|ist|est|es|è)\s))(?P<words>{WORD}(?: {WORD}){{1,9}})[\s.]*$"
)
"""Words behind an equation, after a dash or *is*."""
_LONGEST_SENTENCE = 240
"""Characters of a sentence that is looked for behind a formula."""
_MOST_WORDS = 12
_EQUATION = frozenset((
    "equation", "equations", "answer", "solution", "result", "bewegungsgleichung", "bewegungsgleichungen", "gleichung",
    "lösung", "ergebnis", "équation", "équations", "ecuación", "ecuaciones", "equazione", "equazioni", "equação",
))  # fmt: skip
"""What an equation is called behind it."""
_CONSTANT = frozenset(("constant", "konstant", "constante", "costante", "stały", "stała", "konstantní"))


def without_prose(text: str, scope: Scope) -> str:
    r"""Return a text with blanks in place of the words before and behind its formula.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": coordinates("x")})
    >>> [without_prose(text, scope).strip() for text in ("Bewegungsgleichung: x'' = -x", "x'' = -x for all t")]
    ["x'' = -x", "x'' = -x"]
    >>> without_prose("mass x'' = -x", scope)
    "mass x'' = -x"
    """
    is_formula = re.search(r"[=+*/^\\\d$'′]", text) is not None or _MARKS.fullmatch(text[:1])
    if len(text) > MAX_CHARACTERS or not is_formula:
        return text
    begin = _beginning(text, scope)
    end = _end(text, begin, scope)
    return text if (begin, end) == (0, len(text)) else re.sub(r"[^\n]", " ", text[:begin]) + text[begin:end]


def end_of_words(text: str, scope: Scope) -> int:
    """Return where the words before a formula end; 0 where none stand there.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> end_of_words("Equation of motion: x'' = 0", Scope()), end_of_words("x'' = 0", Scope())
    (20, 0)
    """
    return _beginning(text, scope)


def _beginning(text: str, scope: Scope) -> int:
    """Return where the formula begins behind marks, headings and the words that lead to it."""
    marks = _MARKS.match(text)
    begin = marks.end() if marks and marks.group().strip() and text[marks.end() :].strip() else 0
    bullet = _BULLET.match(text, begin)
    if bullet and (behind := _heading_end(text, bullet.end(), scope)) > bullet.end():
        begin = behind
    for _ in range(3):
        found = max(
            step(text, begin, scope) for step in (_heading_end, _upright_end, _lead_end, end_of_sentence)
        )
        marks = _MARKS.match(text, found)
        found = marks.end() if marks and found > begin else found
        if found == begin or not text[found:].strip():
            break
        begin = found
    return begin


def _heading_end(text: str, begin: int, scope: Scope) -> int:
    """Return the end of ``Equation of motion:`` or of a line of words."""
    marked = re.search(r"#{1,6}\s|\*\*$", text[:begin]) is not None
    begin += len(text[begin:]) - len(text[begin:].lstrip())
    found = _HEADING.match(text, begin)
    if found is None or not (marked or ":" in found.group()):
        return begin
    rest, said = text[found.end() :], re.findall(WORD, found["words"])
    coordinates = [word for word in said if isinstance(scope.symbol(word), Coordinate)]
    others = [word for word in said if word not in coordinates]
    of_them = "=" in rest and all(word in rest for word in coordinates)
    if coordinates and not of_them:  # x : 1, and y: x'' = 0
        return begin
    return found.end() if (not others or is_prose(others, scope)) and said else begin


def _upright_end(text: str, begin: int, scope: Scope) -> int:
    r"""Return the end of ``\text{Thus, }``: words with a sign behind them, or the last of which leads to a formula."""
    begin += len(text[begin:]) - len(text[begin:].lstrip())
    found = _UPRIGHT.match(text, begin)
    if found is None:
        return begin
    said = re.findall(WORD, found["words"])
    leads = found["words"].rstrip().endswith((",", ":")) or said[-1].lower() in LEADING
    return found.end() if leads and is_prose(said, scope) else begin


def _lead_end(text: str, begin: int, scope: Scope) -> int:
    """Return the end of the words that lead to a formula, the last of which says so: ``… lautet``, ``we get``."""
    at = end = begin + len(text[begin:]) - len(text[begin:].lstrip())
    for _ in range(_MOST_WORDS):
        found = _LEADING_WORD.match(text, at)
        if found is None or not is_prose([found["word"]], scope):
            break
        at = found.end()
        if _ELIDED.sub("", found["word"]).lower() in LEADING:
            end = at
        if re.match(r"(?:\$\$?|\\[\[(])\s*[^\s=+*/^][^=]{0,99}=", text[at:]):  # dollars end the words
            end = at
    return end if re.match(r"=>|[^=+*/^]", text[end:]) else begin


def _end(text: str, begin: int, scope: Scope) -> int:
    """Return where a sentence behind the formula begins."""
    concluded = min(start_of_sentence_behind(text, begin), start_of_closing(text, begin, scope))
    if concluded < len(text):
        return concluded
    tail = max(begin, len(text) - _LONGEST_SENTENCE)
    found = _SENTENCE.search(text, tail)
    if found is None or not re.search(r"[\w)\]}'′″²³$]$", text[begin : found.start()]):
        return _end_before_its_name(text, begin, tail, scope)
    said = re.findall(WORD, found["role"] or found["words"] or "all")
    restricts = (
        found["symbol"] and _CONSTANT & {word.lower() for word in said} and _moves(found["symbol"], scope)
    )
    return found.start() if is_prose(said, scope) and not restricts else len(text)


def _moves(symbol: str, scope: Scope) -> bool:
    """Tell whether a name stands for what changes in time: said to be constant, it is another motion."""
    return any(scope.moves(name) for name in Words("", scope).declared(tokens(symbol.lstrip("\\"))[0].text))


def _end_before_its_name(text: str, begin: int, tail: int, scope: Scope) -> int:
    """Return where an equation ends that is called one behind it; ``m is the mass`` says something of a letter."""
    called = _CALLED.search(text, tail) if "=" in text[begin:] else None
    words = re.findall(WORD, called["words"]) if called else []
    named = _EQUATION & {word.lower() for word in words}
    return called.start() if called and named and is_prose(words, scope) else len(text)


def is_prose(said: list[str], scope: Scope) -> bool:
    """Tell whether words are all of those that never change a formula, and none is a name of the question.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> [is_prose(text.split(), Scope()) for text in ("equation of motion", "twice the energy", "Hooke's law", "")]
    [True, False, True, False]
    """
    plain = [_ELIDED.sub("", re.sub(r"['’]s$|\.$", "", word)) for word in said]
    known = all(word.lower() in HARMLESS for each in plain for word in each.split("-"))
    names = any(w in scope.functions or scope.declares(w) or split(w, scope) for w in plain)
    return bool(said) and known and not names
