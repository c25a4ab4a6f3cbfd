"""Rows of an answer as they are typed: their bullets, labels and numbers taken off before anything in them is read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.rows.bullets import without_bullets
from canon.expression.rows.dashed_numbers import without_dashed_numbers
from canon.expression.rows.row_dress import undressed
from canon.expression.rows.row_labels import without_row_labels
from canon.expression.rows.row_remarks import without_row_remarks
from canon.expression.rows.sentence_ends import with_sentences_apart
from canon.expression.text.tokens import MAX_CHARACTERS

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["plain_rows"]


def plain_rows(text: str, scope: Scope) -> str:
    """Return an answer without what only sets its rows apart, every column where it was, zero widths left out.

    Raises
    ------
    LanguageError
        Where a bullet, a label or a number may be a part of the formula.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> plain_rows("- $x = 1$ -- (1)", Scope()).strip()
    '$x = 1$'
    """
    if len(text) > MAX_CHARACTERS:
        return text
    text = without_dashed_numbers(with_sentences_apart(undressed(text)), scope)
    text = without_row_remarks(text, scope)
    return without_row_labels(without_bullets(text, scope), scope)
