"""HTML page of a report: formulas set, steps shown, in one file without scripts or anything fetched.

Everything a stranger wrote enters the tree of elements as text and leaves it escaped; besides, the page forbids its
reader to run scripts or to fetch anything.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, SubElement, tostring

from canon.exercise.report.page_style import PAGE_STYLE, STYLE
from canon.exercise.sheet.declared_symbols import NAME_KEYS
from canon.exercise.sheet.kind import COMMON, Shape
from canon.exercise.sheet.kinds import KINDS, kind_of
from canon.exercise.sheet.reading import InvalidClaim, Reading
from canon.expression.mathml import formula
from canon.expression.parse import Scope
from canon.expression.symbols.user_input import counted
from canon.printable import printable

if TYPE_CHECKING:
    from canon.exercise.report.judgement import Judged, Judgement
    from canon.exercise.sheet.sheet import Claim

__all__ = ["fragment", "page"]

MAX_SHOWN = 2_000
"""Characters of a text that is no formula; the rest is cut."""
MAX_ITEMS = 50
_OWN_KEYS = (*COMMON, *NAME_KEYS[: NAME_KEYS.index("constants")])
"""Keys whose content is told in the line of names, or not at all."""
_POLICY = "default-src 'none'; style-src 'unsafe-inline'"
_VERDICTS = {"holds": "holds", "fails": "fails", "undecided": "undecided", "invalid": "can't be read"}


def page(report: Judged) -> str:
    """Return a whole HTML page.

    Examples
    --------
    >>> from canon.exercise.report.judgement import Judgement
    >>> from canon.exercise.report.report import Report
    >>> text = page(Report("<b>", (Judgement("a", "equality-only", "holds"),)))
    >>> "&lt;b&gt;" in text, "<b>" in text, "<script" in text
    (True, False, False)
    """
    root = Element("html", {"lang": "en"})
    head = SubElement(root, "head")
    SubElement(head, "meta", {"charset": "utf-8"})
    SubElement(head, "meta", {"http-equiv": "Content-Security-Policy", "content": _POLICY})
    SubElement(head, "meta", {"name": "viewport", "content": "width=device-width, initial-scale=1"})
    _text(SubElement(head, "title"), report.title or "Judged claims")
    SubElement(head, "style").text = PAGE_STYLE + STYLE
    SubElement(root, "body").append(_body(report))
    return f"<!DOCTYPE html>\n{_written(root)}\n"


def fragment(report: Judged) -> str:
    """Return the report for a notebook: the same without the frame of a page."""
    root = Element("div")
    SubElement(root, "style").text = STYLE
    root.append(_body(report))
    return _written(root)


def _written(root: Element) -> str:
    return tostring(root, encoding="unicode", method="html")


def _text(element: Element, text: str) -> Element:
    element.text = printable(text)
    return element


def _put(parent: Element, tag: str, text: str = "", kind: str = "") -> Element:
    element = SubElement(parent, tag, {"class": kind} if kind else {})
    return _text(element, text) if text else element


def _body(report: Judged) -> Element:
    main = Element("main", {"class": "canon"})
    _put(main, "h1", report.title or "Judged claims")
    counts = _put(main, "p", kind="counts")
    _put(counts, "span", f"{counted(len(report.judgements), 'claim')}")
    for status, number in report.counts.items():
        _put(counts, "span", f"{number} {_VERDICTS[status]}", status)
    seconds = sum(judgement.seconds for judgement in report.judgements)
    _put(counts, "span", f"{seconds:.1f} s")
    many = len({judgement.file for judgement in report.judgements}) > 1
    claims = (
        report.claims if len(report.claims) == len(report.judgements) else (None,) * len(report.judgements)
    )
    for judgement, claim in zip(report.judgements, claims, strict=True):
        card = _card(judgement, claim)
        if many and judgement.file:
            _put(card[1], "span", judgement.file)
        main.append(card)
    return main


def _card(judgement: Judgement, claim: Claim | None) -> Element:
    card = Element("section", {"class": f"claim {judgement.status}"})
    head = _put(card, "h2")
    _put(head, "span", _VERDICTS[judgement.status], "verdict")
    _put(head, "span", judgement.title or judgement.id, "title")
    about = _put(card, "p", kind="about")
    _put(about, "code", judgement.id)
    _put(about, "span", judgement.kind)
    _put(about, "span", f"{judgement.seconds:.2f} s")
    if judgement.certificate:
        _put(about, "span", f"decided by: {judgement.certificate}")
    if not judgement.as_expected:
        _put(about, "strong", f"expected: {judgement.expect}")
    scope = _scope(claim)
    if claim is not None:
        _claimed(card, claim, scope)
    _reasons(card, judgement, scope)
    for warning in judgement.warnings:
        _put(card, "p", warning, "warning")
    if judgement.steps:
        details = _put(card, "details")
        _put(details, "summary", "How it was judged")
        listed = _put(details, "ol")
        for text, shown in judgement.steps:
            item = _put(listed, "li", f"{text} " if text else "")
            if shown:
                item.append(_formula(shown, scope))
    return card


def _scope(claim: Claim | None) -> Scope:
    """Return the names a claim declares, which its LaTeX is read with."""
    if claim is None or claim.errors:
        return Scope()
    try:
        return Reading(claim).scope
    except InvalidClaim:
        return Scope()


def _claimed(card: Element, claim: Claim, scope: Scope) -> None:
    kind = kind_of(claim.kind, claim.keys) if claim.kind in KINDS else None
    shapes = {**COMMON, **kind.shapes} if kind is not None else {}
    given = _put(card, "dl")
    for key, value in claim.keys.items():
        if key not in _OWN_KEYS or (key in shapes and shapes[key] not in (Shape.NAMES, *COMMON.values())):
            _put(given, "dt", str(key)[:60])
            _content(_put(given, "dd"), value, scope, word=shapes.get(key) in (Shape.WORD, Shape.WORDS))
    assumed = claim.keys.get("parameters")
    if isinstance(assumed, Mapping) and any(word != "real" for word in assumed.values()):
        _put(given, "dt", "assumed")
        row = _put(given, "dd")
        for name, word in list(assumed.items())[:MAX_ITEMS]:
            if word != "real":
                row.append(_formula(str(name), scope))
                row[-1].tail = printable(f" {word}  ")
    if "domain" in claim.keys:
        _put(given, "dt", "domain")
        _content(_put(given, "dd"), claim.keys["domain"], scope)
    if "in" in claim.keys:
        _put(given, "dt", "written in")
        _content(_put(given, "dd"), claim.keys["in"], scope)
    if claim.keys.get("complete") is True:
        _put(given, "dt", "wanted")
        _put(given, "dd", "a complete answer")


def _content(parent: Element, value: Any, scope: Scope, *, word: bool = False) -> None:
    """Put what stands under a key: an expression, a list of them, or tables of them."""
    if isinstance(value, list):
        for item in value[:MAX_ITEMS]:
            _content(_put(parent, "div"), item, scope, word=word)
        if len(value) > MAX_ITEMS:
            _put(parent, "div", f"and {len(value) - MAX_ITEMS} more")
    elif isinstance(value, Mapping):
        for name, item in list(value.items())[:MAX_ITEMS]:
            row = _put(parent, "div", kind="entry")
            row.append(_formula(str(name), scope))
            row[-1].tail = " : "
            _content(row, item, scope)
    elif word:
        _put(parent, "span", str(value)[:MAX_SHOWN])
    else:
        parent.append(_formula(str(value), scope))


def _formula(text: str, scope: Scope) -> Element:
    """Return a formula set, or as the text it is where it is none."""
    found = formula(text, scope)
    return found if found is not None else _text(Element("code"), text[:MAX_SHOWN])


def _reasons(card: Element, judgement: Judgement, scope: Scope) -> None:
    if judgement.status == "fails":
        feedback = judgement.feedback or f"{judgement.question or 'the claim'} is wrong"
        _put(card, "p", feedback, "feedback")
        _counterexample(card, judgement, scope)
        if judgement.corrected:
            right = _put(card, "div", "right would be: ", "corrected")
            for part in judgement.corrected.split("; "):
                _equated(_put(right, "div"), part, scope)
    elif judgement.status != "holds":
        _put(card, "pre", judgement.known[:MAX_SHOWN], "feedback")


def _equated(line: Element, text: str, scope: Scope) -> None:
    """Put a formula, or one that words stand before: ``{f, g} of pair 1 = x``."""
    words, sign, rest = text.partition(" = ")
    shown = formula(text, scope)
    if shown is None and sign and (after := formula(rest, scope)) is not None:
        _text(line, f"{words} = ")
        shown = after
    line.append(shown if shown is not None else _formula(text, scope))


def _counterexample(card: Element, judgement: Judgement, scope: Scope) -> None:
    example = judgement.counterexample
    if example is None:
        return
    at = _put(card, "p", "at ", "counterexample")
    point = list(example["point"].items())
    for name, value in point[:MAX_ITEMS]:
        if len(at):
            at[-1].tail = ", "
        at.append(_formula(f"{name} = {value}", scope))
    if not point:
        at.text = "at every point"
    _put(at, "span", f": {example['left']} against {example['right']}")
