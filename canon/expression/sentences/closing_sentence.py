r"""Closing sentences: what is said behind a formula and changes nothing of it, and that it is conserved.

``…, as expected for a pendulum``, ``…, d'où le résultat``, ``K = H since ∂F/∂t = 0``, ``m r² φ' is conserved``. A
reason never makes a wrong formula right; one that restricts it, ``since k = 0``, or denies something stays where it is.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.sentences.known_words import HARMLESS, WHERE, is_denial
from canon.expression.sentences.leading_sentence import is_name
from canon.expression.text.notation import is_latex

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["start_of_closing", "with_constancy"]

_BEHIND = r"(?<=[\w)\]}'′″²³$])"
"""A formula ends so."""
_EXPECTED = re.compile(
    rf"{_BEHIND}[,.;]?\s(?:just )?(?:"
    r"as (?:we |was |is )?(?:expected|required|desired|claimed|wanted|stated|it should(?: be)?|it must(?: be)?)"
    r"|wie (?:erwartet|gewünscht|verlangt|behauptet|gefordert|zu erwarten(?: war)?|es sein (?:soll|muss))"
    r"|was zu (?:zeigen|beweisen) war|respectively"
    r"|comme (?:attendu|prévu|voulu|annoncé|il se doit)|d['’]où le résultat|ce qu['’]il fallait (?:démontrer|montrer)"
    r"|como (?:se esperaba|esperado|era de esperar|se quería demostrar|queríamos demostrar)"
    r"|come (?:previsto|atteso|richiesto|volevasi dimostrare)|zoals verwacht|jak oczekiwano|как и ожидалось"
    r")(?P<words>(?: [^\W\d_]{1,20}){0,8})[\s.$]*$",
    re.IGNORECASE,
)
"""Words by which who wrote a formula agrees with it, and of what it is expected."""
_SINCE = (
    r"(?:since|because|weil|denn|da|car|puisque|parce que|porque|ya que|poiché|perché|pois|omdat|ponieważ|protože"
    r"|так как|потому что|поскольку)"
)
_REASON = re.compile(
    rf"{_BEHIND},?\s{_SINCE}\s(?P<reason>[^=]{{3,80}}(?:=\s?0(?![\w.])[^=]{{0,40}})?)$", re.IGNORECASE
)
_RATE_IS_ZERO = re.compile(
    r"\$?(?:[d∂]|\\partial )\s?[^\W\d_]\w{0,3}\s?/\s?(?:[d∂]|\\partial )\s?[^\W\d_]\w{0,9}\s?=\s?0\$?(?!\w)"
    r"|\$?\\[dt]?frac\{(?:d|\\partial)\s?[^\W\d_]\w{0,3}\}\{(?:d|\\partial)\s?[^\W\d_]\w{0,9}\}\s?=\s?0\$?"
)
_INDEPENDENT = re.compile(
    r"[^\W\d_]\w{0,9} (?:does|do) not (?:explicitly )?(?:depend (?:explicitly )?on|contain|involve) [^\W\d_]\w{0,9}"
    r"(?: explicitly)?(?!\w)"
    r"|(?:is|are) (?:cyclic|ignorable)(?!\w)"
)
"""What a reason may say of names: all other words of it must be words, and none of them may deny or restrict."""
_CONSTANT = re.compile(
    rf"{_BEHIND},?\s(?:(?:is|are|remains?|stays?) (?:conserved|constant|a conserved quantity"
    r"|an? (?:first )?(?:integral|constant) of (?:the )?motion)"
    r"|(?:ist|bleibt) (?:erhalten|konstant|eine (?:Erhaltungsgröße|Konstante der Bewegung))"
    r"|est (?:conservée?|constante?|une constante du mouvement)|se conserve|se conserva|si conserva"
    r"|es (?:constante|una constante (?:del|de) movimiento)|è (?:costante|conservat[ao])|сохраняется)[\s.]*$"
)
_CLAUSE = re.compile(rf"(?<!\w)(?:{_SINCE}|{'|'.join(sorted(WHERE))})(?!\w)", re.IGNORECASE)
"""What begins a sentence of its own: *is constant* is said of what stands in it, not of the formula."""
_LONGEST = 160
_SHORTEST = 3
_MOST_WORDS = 9


def start_of_closing(text: str, begin: int, scope: Scope) -> int:
    """Return where a formula ends before words that change nothing of it; the end of the text where there are none.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> [start_of_closing(said, 0, Scope()) for said in ("x = 1, as expected", "x = 1, as half expected")]
    [5, 23]
    >>> said = "x = 1 since dF/dt = 0", "x = 1 since k = 0", "x = 1 because the energy is conserved"
    >>> [start_of_closing(each, 0, Scope()) for each in said]
    [5, 17, 5]
    """
    tail = max(begin, len(text) - _LONGEST)
    agreed = _EXPECTED.search(text, tail)
    if agreed and all(_is_harmless(word, scope) for word in agreed["words"].split()):
        return agreed.start()
    because = _REASON.search(text, tail)
    return because.start() if because and _is_reason(because["reason"], scope) else len(text)


def _is_harmless(word: str, scope: Scope) -> bool:
    return word.lower() in HARMLESS and not is_name(word, scope)


def _is_reason(reason: str, scope: Scope) -> bool:
    """Tell whether a reason only says that a derivative is zero, or words none of which denies or restricts."""
    plain, zeros = _RATE_IS_ZERO.subn(" ", reason)
    named = _INDEPENDENT.sub(" ", plain)
    if zeros > 1 or re.search(r"[^\w\s.,'’-]|\d", named):
        return False
    words = re.findall(r"[^\W\d_]+", named)
    said = [word for word in words if word.lower() in HARMLESS and len(word) > _SHORTEST]
    known = zeros > 0 or named != plain or bool(said)
    return known and len(words) <= _MOST_WORDS and all(_is_word(word, scope) for word in words)


def _is_word(word: str, scope: Scope) -> bool:
    """Tell whether a word is no name, and is known or long enough to be a word, and denies nothing."""
    if is_name(word, scope):
        return False
    return word.lower() in HARMLESS or (len(word) > _SHORTEST and not is_denial(word))


def with_constancy(text: str, scope: Scope) -> str:
    r"""Return a text with ``= const`` for *is conserved* at its end.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> with_constancy("m v is conserved.", Scope()), with_constancy("m v is not conserved", Scope())
    ('m v = const', 'm v is not conserved')
    >>> with_constancy(r"$m\dot x$ is conserved", Scope())
    '$m\\dot x = \\mathrm{const}$'
    """
    found = _CONSTANT.search(text, max(0, len(text) - _LONGEST))
    if found is None or scope.declares("const") or any(map(scope.declares, ("is", "se", "si", "conserved"))):
        return text
    before = text[: found.start()]
    if _CLAUSE.search(before, before.rfind("=") + 1):
        return text
    if not is_latex(text):
        return f"{before} = const"
    closing = re.search(r"(?:\$\$?|\\[\])])$", before)
    if closing is None:
        return f"{before} = \\mathrm{{const}}"
    return f"{before[: closing.start()]} = \\mathrm{{const}}{closing.group()}"
