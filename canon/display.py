"""Text as notebooks show it: letters of one width, lines not broken, nothing in it taken for markup."""

from __future__ import annotations

from html import escape

__all__ = ["preformatted"]

STYLE = "font-family: monospace; white-space: pre; overflow-x: auto; line-height: 1.3"
"""Notebooks set ``pre`` in proportional letters where it stands in a page of HTML."""


def preformatted(text: str, *, lead: str = "", colour: str = "") -> str:
    """Return HTML that shows a text as it stands, after a word in white on a colour: a page may be light or dark.

    Examples
    --------
    >>> preformatted(" a < b", lead="HOLDS", colour="#1a7f4b").partition(">")[2]
    '<b style="background: #1a7f4b; color: #fff; padding: 0 0.3em">HOLDS</b> a &lt; b</pre>'
    """
    style = f"background: {colour}; color: #fff; padding: 0 0.3em"
    word = f'<b style="{style}">{escape(lead)}</b>' if lead else ""
    return f'<pre style="{STYLE}">{word}{escape(text)}</pre>'
