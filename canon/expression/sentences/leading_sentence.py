"""Leading sentences: what stands before an equation in any language, up to a colon or to letters of another script.

``Beschleunigung: x'' = g``, ``Натяжение нити: λ = m g``, ``よって運動方程式は m x'' = -k x となる。`` Only words are
passed over, none of them declared or made of declared names, one of them known to name a formula, and none that denies
it, leaves it open or restricts it; what is behind them holds an equality sign, so that it says by itself what it is
about.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.sentences.known_words import EASTERN, HARMLESS, is_denial
from canon.expression.text.declared_names import function_name
from canon.expression.text.scope import split
from canon.expression.text.tokens import GREEK

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["end_of_sentence", "is_name", "start_of_sentence_behind"]

_EAST = r"\u3005-\u3007\u3040-\u30ff\u3400-\u9fff\uac00-\ud7af"
_CYRILLIC = r"\u0400-\u04ff"
_WORD = re.compile(rf"[{_EAST}]+|[^\W\d_]+")
_LABEL = re.compile(
    r"\s*(?P<said>[^\W\d_](?:[^\W\d_]|[ ,.'’`«»„“”-]){1,118}?)[*_]{0,2}\s?:(?![:=])[*_]{0,2}\s*(?=[^\s:=+*/^<>)])"
)
"""Words up to a colon."""
_TITLE = re.compile(
    r"\s*(?P<said>Answer|Solution|Result|Antwort|Lösung|Ergebnis|Réponse|Résultat|Respuesta|Solución|Risposta|Soluzione"
    r"|Resposta|Odpowiedź|Rozwiązanie|Ответ|Решение|Відповідь|Svar)\.\s+(?=[^\s:=+*/^<>)])"
)
"""Titles with a full stop, as books set them."""
_OTHER_SCRIPT = re.compile(
    rf"\s*(?P<said>(?:[{_EAST}{_CYRILLIC}]++['’]?(?:\s?[,、，:]\s?|\s+|\b|(?<=[{_EAST}]))){{1,12}}+)(?=[^\s=+*/^<>)])"
)
"""Words in letters that no formula has."""
_CONCLUDED = re.compile(
    r"(?<=[\w)\]}'′″²³$])\s*(?:[とに](?:なる|なります|書ける|表せる|表される|求まる|求められる)|である|です|が成り立つ|が得られる|を得る"
    r"|이다|입니다|가 된다|이 된다|成立|即为所求)[\s.。]*(?=\$?\s*$)"
)
"""What Japanese, Korean and Chinese say behind an equation, where nothing in it denies it."""
_ELIDED = re.compile(
    r"(?<![^\W\d_])(?:[cdjlmst]|qu|all|dall|dell|nell|sull)['’](?=[^\W\d_]{2})", re.IGNORECASE
)
"""French and Italian words before a vowel."""
_SHORTEST = 3
"""Letters of a word that is not of the list; shorter ones may be quantities."""
_MOST_WORDS = 14
_GREEK = frozenset((*GREEK.values(), "varphi", "vartheta", "varepsilon"))


def end_of_sentence(text: str, begin: int, scope: Scope) -> int:
    """Return where the words before an equation end; where they begin if they may say something of it.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": coordinates("x")})
    >>> [end_of_sentence(said, 0, scope) for said in ("Beschleunigung: x'' = 1", "Falsch: x'' = 1", "mit x: x'' = 1")]
    [16, 0, 0]
    """
    title = _TITLE.match(text, begin)
    if title and "=" in text[title.end() :] and not is_name(title["said"], scope):
        return title.end()
    for pattern in (_LABEL, _OTHER_SCRIPT):
        found = pattern.match(text, begin)
        if found and "=" in text[found.end() :] and _says_nothing(found["said"], scope):
            return found.end()
    return begin


def start_of_sentence_behind(text: str, begin: int) -> int:
    """Return where an equation ends before ``となる。`` and the like.

    Examples
    --------
    >>> start_of_sentence_behind("x'' = -x となる。", 0), start_of_sentence_behind("x'' = -x ではない。", 0)
    (8, 14)
    """
    found = _CONCLUDED.search(text, begin)
    return found.start() if found else len(text)


def _says_nothing(said: str, scope: Scope) -> bool:
    """Tell whether words, in whatever language, are none that change what follows."""
    words = [word for word in _WORD.findall(_ELIDED.sub("", said)) if word]
    if not 0 < len(words) <= _MOST_WORDS or re.search(r"['’]", _ELIDED.sub("", said)):
        return False
    return any(map(_names_a_formula, words)) and all(_is_word(word, scope) for word in words)


def _names_a_formula(word: str) -> bool:
    """Tell whether a word is one of those that name a formula or lead to it: others alone may mock it."""
    return (len(word) > _SHORTEST and word.lower() in HARMLESS) or EASTERN.search(word) is not None


def _length(word: str) -> int:
    """Return how many letters a word has; a Chinese one is a word by itself."""
    return _SHORTEST if re.match(f"[{_EAST}]", word) else len(word)


def _is_word(word: str, scope: Scope) -> bool:
    """Tell whether a word is no name, no product of names, no function, and denies nothing."""
    if is_name(word, scope):
        return False
    if word.lower() in HARMLESS:
        return True
    return (
        _length(word) >= _SHORTEST and _is_known_script(word) and word not in _GREEK and not is_denial(word)
    )


def is_name(word: str, scope: Scope) -> bool:
    """Tell whether a word is declared, a product of declared names, or a function.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> is_name("sin", Scope()), is_name("energy", Scope())
    (True, False)
    """
    known = word in scope.functions or scope.declares(word)
    return known or split(word, scope) != "" or function_name(word, scope) != ""


def _is_known_script(word: str) -> bool:
    """Tell whether a word is in a script whose words of denial are listed."""
    return (
        re.fullmatch(
            rf"[A-Za-z\u00c0-\u024f\u1e00-\u1eff\u0370-\u03ff\u1f00-\u1fff{_CYRILLIC}{_EAST}]+", word
        )
        is not None
    )
