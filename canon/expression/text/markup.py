"""Markup around formulas: Markdown's marks, HTML of course systems, MathML, each to the plain text that it shows.

Nothing is interpreted but the few tags and marks that change how a formula is read; entities of XML are not expanded.
"""

from __future__ import annotations

import html
import re
from dataclasses import dataclass, field
from html.parser import HTMLParser
from itertools import accumulate, pairwise

from canon.expression.text.tokens import MAX_CHARACTERS, LanguageError

__all__ = ["unmarked"]

MAX_NESTING = 64
_HTML = re.compile(r"</[A-Za-z]{1,12}>|<br ?/?>|&(?:#?[A-Za-z0-9]{2,12});")
_MATHML = re.compile(r"<(?:math|mrow|mi|mfrac)\b")
_ENTITY = re.compile(r"&(?!lt;|gt;|amp;)#?[A-Za-z0-9]{2,12};")
_SUB = re.compile(r"<sub>\s*([\w,]{1,12})\s*</sub>", re.IGNORECASE)
_SUP = re.compile(r"<sup>([^<>]{1,200})</sup>", re.IGNORECASE)
_FRACTION = re.compile(r"<sup>\s*(\w{1,9})\s*</sup>\s*[⁄/]\s*<sub>\s*(\w{1,9})\s*</sub>", re.IGNORECASE)
_BREAK = re.compile(r"<br ?/?>|</(?:p|div|li|tr)>", re.IGNORECASE)
_TAG = re.compile(
    r"</?(?:p|div|span|i|em|b|strong|var|code|pre|tt|li|ul|ol|font|u|small)(?: [^<>]{0,200})?>", re.IGNORECASE
)
_STYLED = re.compile(
    r"<[a-z]{1,10} [^<>]{0,120}?((?:text-decoration[\w-]{0,20}\s{0,3}:[^;\"'<>]{0,40}(?:overline|line-through))"
    r"|vertical-align\s{0,3}:\s{0,3}(?:super|sub|-?[.\d]))",
    re.IGNORECASE,
)
"""A line over a radicand or through a term, and letters that are raised, by a style."""
_DRAWN = re.compile(
    r"[─━│⎛⎜⎝⎞⎟⎠⎡⎢⎣⎤⎥⎦⎧⎨⎩⌠⌡╲╱]|(?<=\n)[ \t]{0,99}-{1,99}[ \t]{0,99}(?=\n)|_{3}|^\[ +\]$|^[ ]+\d[\d ]*(?=\n *\S)",
    re.MULTILINE,
)
"""Lines and large brackets that are drawn with characters."""
_NAMED = (
    r"(?:(?:new|total|full|transformed|reduced|resulting|general|corresponding) )?"
    r"(?:[Hh]amiltonian|Kamiltonian|[Ll]agrangian|Routhian|[Aa]nswer|[Ss]olution|[Rr]esult|EOM|EoM"
    r"|[Ee]quations? of motion)"
)
_PROMPT = re.compile(
    r"^\s*(?:\(%[io]\d{1,5}\)|%[io]\d{1,5}\s?[=:]|ans\s?=|(?:In|Out)\s?\[\d{1,5}\](?::=|=|:)|>>>)(?=\s)"
    r"|(?:(?<==)|^)\s*@\([\w, ]{1,60}\)"
    rf"|^\s*(?:{_NAMED}|[Tt]he {_NAMED}|E-?L|Euler[-–]Lagrange|[Ee]q(?:n|uation)?s?\.?"
    r"|(?:Newton|Lagrange|Hamilton)(?:['’]s)?(?: equations?)?)(?: ?\(\d{1,2}\)| \d{1,2})?:(?=\s)"
    rf"|^\s*[Tt]he {_NAMED} (?:is|are|reads?|becomes?|equals)(?: given by)?:?(?=\s)"
    r"|^\s*(?:(?:\d{1,2}|[a-h]|i{1,3})\))[ \t]{1,9}(?=\S)|^\s*\*[ \t]{1,9}(?=\S[^\n]{0,400}=)"
)
"""What programs and people write before a line: prompts, names of what follows, numbers and points of a list."""
_SAID_BEHIND = re.compile(
    r"[\s.,;]{0,9}(?:✓|✔|∎|□|■|\\(?:checkmark|qed|blacksquare)\b|\\(?:text|mathrm)\{\s*(?:q\.e\.d\.|QED)\s*\}|\bQED\b|q\.\s?e\.\s?d\.?|c\.\s?q\.\s?f\.\s?d\.?|w\.\s?z\.\s?b\.\s?w\.?|ч\.\s?т\.\s?д\.?|[😊🙂😀😃😄😁🎉👍💪🥳😎]{1,3}!{0,3})[\s.]*$"
)
"""Signs behind a formula that say nothing of it."""
_APART_ACCENT = re.compile(r"(?<=[^\W\d]) ([\u0307\u0308])")
"""A dot that Word's linear format sets apart from its letter."""
_EMPHASISED = re.compile(r"^(\s*)(?:\*\*|__|[*_])([A-Za-z]\w{0,9})(?:\*\*|__|[*_])(\s*=)")
"""A bold or slanted name before ``=``."""
_ELEMENTWISE = re.compile(r"(?<=[\w)\]])\.([*/^])")
"""MATLAB's operators for arrays."""
_WIDTHLESS = re.compile(r"[\u200b\u2060\ufeff]")
_ASSIGNED = re.compile(r"^(\s*[A-Za-z]\w{0,9}\s*):(?![:=])(?=[^;]*;\s*$)")
"""Maxima's ``L: …;``."""
_PRIMED = re.compile(r"Derivative\[([1-4])\]\[((?:\\\[[A-Z][A-Za-z]{1,20}\]|\w){1,40})\](?=\[)")
_TWICE = re.compile(r"(?<!\w)d([2-4])([^\W\d_]\w{0,15})/dt\1(?!\w)")
"""``d2x/dt2``, without a sign of the power."""
_DECIMAL_COMMA = re.compile(
    r"(?<![\w.,])(?:(0),([0-9]{1,9})|([1-9][0-9]{0,3}),([0-9]{1,2}|[0-9]{4,9}))(?![\w.,])"
)
"""``9,81``; ``1,000`` may be a thousand, and what is in brackets a list."""
_BRACED_COMMA = re.compile(r"(?<![0-9])([0-9]{1,12})\{,\}(?=[0-9])")
_BRACED_THOUSAND = re.compile(r"(?<![\w.,])[1-9][0-9]{0,3}\{,\}[0-9]{3}(?![0-9])")
"""``1{,}000``: LaTeX keeps the blank away behind both kinds of comma."""
_MAPLE = re.compile(r"(?:\[\s?)?(?<=[\s,\[])([a-z])\s?\$\s?([1-4])(\s?\])?(?=\s?\))")
"""Maple's ``t$2`` and ``[t$2]``."""
_FENCE = re.compile(r"^\s*```[a-z]{0,12}\n(.*?)\n?```\s*$", re.DOTALL)


def unmarked(text: str) -> str:
    """Return a text without the markup around its formula; text without any is returned as it is.

    Raises
    ------
    LanguageError
        Where it is a drawing over several lines, whose rows mean nothing one by one, or where a braced comma may be
        that of a decimal or of a thousand.

    Examples
    --------
    >>> unmarked("<p>&theta;&#775;<sup>2</sup></p>"), unmarked("**`2*m`**"), unmarked("x**2")
    ('θ̇^(2)', '2*m', 'x**2')
    >>> unmarked("<math><mfrac><msup><mi>p</mi><mn>2</mn></msup><mrow><mn>2</mn><mi>m</mi></mrow></mfrac></math>")
    '(p^(2))/(2 m)'
    """
    if len(text) > MAX_CHARACTERS:
        return text
    text = _SAID_BEHIND.sub(_blank, text)
    text = _APART_ACCENT.sub(r"\1 ", text.replace("〖", "(").replace("〗", ")"))
    text = _ASSIGNED.sub(r"\1=", _PROMPT.sub(_blank, text))
    if "\n" not in text.strip():
        text = text.replace("│", "|").replace("ℯ", "%e")
    text = _EMPHASISED.sub(r"\1\2\3", text)
    text = text.replace("~", " ") if "\\" in text else _ELEMENTWISE.sub(r"\1", text).replace("≡", "=")
    text = _TWICE.sub(r"d^\1\2/dt^\1", text)
    text = _with_points(text) if "," in text else text
    if "$" in text and "\\" not in text:
        text = _MAPLE.sub(lambda found: f"{found[1]},{found[2]}".rjust(len(found.group())), text)
    if "Derivative[" in text:
        text = _PRIMED.sub(_with_primes, text)
    if drawn := _DRAWN.search(text) or _rows_of_a_drawing(text):
        reason = "this is a drawing of the formula over several lines, as SymPy's pprint makes it"
        raise LanguageError(text, drawn.start() + 1, reason, "write what print(…) or latex(…) of it shows")
    if _MATHML.search(text):
        reader = _MathML(text)
        reader.feed(text)
        return reader.text()
    if _HTML.search(text):
        text = _FRACTION.sub(r"(\1/\2)", _ENTITY.sub(lambda found: html.unescape(found.group()), text))
        text = _BREAK.sub("\n", _SUP.sub(r"^(\1)", _SUB.sub(r"_\1", text)))
        if styled := _STYLED.search(text):
            shown = f"{styled[1]} of a tag changes what the formula says"
            raise LanguageError(text, styled.start() + 1, shown, "write sqrt( ) and ^ without styles")
        text = _WIDTHLESS.sub("", html.unescape(_TAG.sub("", text))).strip()
    return _without_markdown(text)


def _rows_of_a_drawing(text: str) -> re.Match[str] | None:
    """Return the second of two lines that are rows of a drawing; None if there are none.

    Such lines never stand one under the other, as an exponent above its base, or have a bracket in common.
    """
    if "<" in text or not 0 < text.count("\n") <= MAX_NESTING:
        return None
    if "\\" not in text and (line := re.search("--", text)):
        return line
    lines = list(re.finditer(r"[^\n]+", text))
    for above, middle, below in zip(lines, lines[1:], lines[2:], strict=False):
        if _have_a_short_fraction(*(f" {line.group()}  " for line in (above, middle, below))):
            return middle
    latex = "\\" in text
    return next(
        (below for above, below in pairwise(lines) if _are_drawn(above.group(), below.group(), latex)), None
    )


def _are_drawn(above: str, below: str, latex: bool) -> bool:
    """Tell whether two lines have a large bracket in common, or never stand one under the other."""
    if _have_a_bracket(above, below):
        return True
    if latex or not all(any(map(str.isalnum, line)) for line in (above, below)):
        return False
    first, second = ({i for i, c in enumerate(line) if not c.isspace()} for line in (above, below))
    return first & second <= _bars(above, below)


def _bars(above: str, below: str) -> set[int]:
    """Return the columns in which bars go through two lines."""
    return {i for i, pair in enumerate(zip(above, below, strict=False)) if pair == ("|", "|")}


def _have_a_short_fraction(above: str, middle: str, below: str) -> bool:
    """Tell whether a lone minus stands between two lone letters or figures."""
    return any(
        line[1] == "-" and a[1:2].isalnum() and b[1:2].isalnum() and _lone(a) and _lone(line) and _lone(b)
        for a, line, b in (
            (above[i : i + 3], middle[i : i + 3], below[i : i + 3]) for i in range(len(middle) - 2)
        )
    )


def _lone(three: str) -> bool:
    """Tell whether one character stands between blanks."""
    return len(three) == 3 and three[0] + three[2] == "  " and not three[1].isspace()


def _have_a_bracket(above: str, below: str) -> bool:
    """Tell whether the upper half of a large bracket of slashes stands over its lower half, or over bars."""
    columns = list(zip(above, below, strict=False))
    left = next((i for i, pair in enumerate(columns) if pair in (("/", "\\"), ("/", "|"))), None)
    return left is not None and any(pair in (("\\", "/"), ("\\", "|")) for pair in columns[left + 1 :])


def _with_points(text: str) -> str:
    """Return a text with points in place of decimal commas outside brackets, as long as it was."""
    if "{,}" in text:
        if found := _BRACED_THOUSAND.search(text):
            shown = found.group()
            reason = f"is {shown} a decimal, or are its figures set apart in threes?"
            remedy = f"write {shown.replace('{,}', '.')} or {shown.replace('{,}', '')}"
            raise LanguageError(text, found.start() + 1, reason, remedy)
        text = _BRACED_COMMA.sub(r"  \1.", text)
    commas = [found.start() + found.group().index(",") for found in _DECIMAL_COMMA.finditer(text)]
    if commas:
        steps = ((c in "([{") - (c in ")]}") for c in text)
        depths = list(accumulate(steps))
        signs = list(text)
        for comma in commas:
            if depths[comma] == 0:
                signs[comma] = "."
        text = "".join(signs)
    return text


def _blank(found: re.Match[str]) -> str:
    return " " * len(found.group())


def _with_primes(found: re.Match[str]) -> str:
    """Return Mathematica's ``Derivative[2][x]`` as ``x''``, as long as it was."""
    return f"{found[2]}{chr(39) * int(found[1])}".rjust(len(found.group()))


def _without_markdown(text: str) -> str:
    """Return a text without the marks that stand around the whole of it."""
    if fenced := _FENCE.match(text):
        text = fenced.group(1)
    for _ in range(3):
        bare = text.strip()
        for mark in ("```", "**", "__", "*", "`"):
            inside = bare[len(mark) : -len(mark)]
            whole = len(bare) > 2 * len(mark) and bare.startswith(mark) and bare.endswith(mark)
            if whole and (mark[0] != "`" or "`" not in inside.strip("`")):
                text = inside
                break
        else:
            return text
    return text


@dataclass
class _Element:
    """An element of MathML with the plain text of what is inside."""

    tag: str
    kind: str
    """The tag of what is shown in the same way."""
    inside: list[str] = field(default_factory=list[str])


class _MathML(HTMLParser):
    """Reads presentation MathML into plain text; what is nested deeper than anyone writes is left out."""

    def __init__(self, source: str) -> None:
        super().__init__(convert_charrefs=True)
        self.source = source
        self.open = [_Element("math", "math")]

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Open an element; what its marks say of the formula is kept, or refused.

        Raises
        ------
        LanguageError
            For strokes through a formula, binomials, and brackets other than moduli.
        """
        marks = {name: value or "" for name, value in attrs}
        fences = marks.get("open", "("), marks.get("close", ")")
        kind = tag
        if tag == "mfenced" and fences in (("|", "|"), ("∣", "∣")):
            kind = "modulus"
        elif tag == "menclose" and marks.get("notation") == "radical":
            kind = "msqrt"
        elif (
            tag == "menclose"
            or re.fullmatch(r"0+(?:\.0*)?[a-z]*", marks.get("linethickness", ""))
            or (tag == "mfenced" and fences not in _FENCES)
        ):
            shown = " ".join(marks.values())[:30]
            raise LanguageError(
                self.source, 1, f"<{tag}> with {shown!r} is not read", "write the formula in LaTeX"
            )
        if len(self.open) < MAX_NESTING:
            self.open.append(_Element(tag, kind))

    def handle_endtag(self, tag: str) -> None:
        """Close an element, and whatever was left open in it."""
        while len(self.open) > 1:
            element = self.open.pop()
            self.open[-1].inside.append(_shown(element))
            if element.tag == tag:
                return

    def handle_data(self, data: str) -> None:
        """Keep the text of an element."""
        if data.strip():
            self.open[-1].inside.append(data.strip())

    def text(self) -> str:
        """Return the plain text of everything that was read."""
        while len(self.open) > 1:
            self.handle_endtag(self.open[-1].tag)
        return _joined(self.open[0].inside)


_FENCES = (("(", ")"), ("[", "]"), ("{", "}"))
_SIGNS = {"\u2062": " ", "\u2061": " ", "\u2063": ",", "−": "-", "⋅": "*", "·": "*", "×": "*"}
_ACCENTS = {"˙": "'", "\u0307": "'", ".": "'", "¨": "''", "\u0308": "''", "..": "''"}


def _shown(element: _Element) -> str:
    """Return what an element shows, as plain text."""
    inside = element.inside
    match element.kind, inside:
        case "mfrac", [above, below]:
            if re.match(r"[d∂](?:\^\(\d\))?(?: |$)", above) and re.match(r"[d∂] ", below):
                return f"{above}/{below.replace(' ', '')}"
            return f"({above})/({below})"
        case "msup", [base, exponent]:
            primes = exponent.replace("′", "'").replace("″", "''")
            return f"{base}{primes}" if set(primes) == {"'"} else f"{_whole(base)}^({exponent})"
        case "msub", [base, sub]:
            return f"{base}_{sub.replace(' ', '')}"
        case "msubsup", [base, sub, exponent]:
            return f"{base}_{sub.replace(' ', '')}^({exponent})"
        case "mover", [base, accent] if accent in _ACCENTS:
            return f"{base}{_ACCENTS[accent]}"
        case "msqrt", _:
            return f"sqrt({_joined(inside)})"
        case "mroot", [base, index]:
            return f"({base})^(1/({index}))"
        case "modulus", _:
            return f"Abs({_joined(inside)})"
        case "mfenced", _:
            return f"({', '.join(inside)})"
        case "mo", [sign]:
            return _SIGNS.get(sign, sign)
        case "semantics", [first, *_]:
            return first
        case (("annotation" | "annotation-xml" | "mspace"), _):
            return " "
        case (("mtr" | "mlabeledtr"), _):
            return f"{_joined(inside)}\n"
        case _:
            return _joined(inside)


def _whole(base: str) -> str:
    """Return what is raised, in brackets where it is more than one name or bracket."""
    single = re.fullmatch(r"\w+'*|\([^()]*\)|[\w']+", base)
    return base if single else f"({base})"


def _joined(pieces: list[str]) -> str:
    """Return pieces with blanks between names."""
    return re.sub(
        r" +", " ", re.sub(r"(?<=[\w')\u0307\u0308]) (?=[(,)])|(?<=\() ", "", " ".join(pieces))
    ).strip(" ")
