"""Limits on the arithmetic of a proof, and the error raised beyond them."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["QUICK", "THOROUGH", "Full", "Limits", "OutOfTime", "Refine", "TooLarge"]


@dataclass(frozen=True)
class Limits:
    """Sizes that are checked before an operation that cannot be interrupted.

    Parameters
    ----------
    product
        Products of terms in one multiplication.
    factored_terms, factored_degree
        Size of a polynomial that is still factored; larger ones are kept whole.
    eliminated_degree
        Product of the degrees of the radicals in one number.
    killable
        Whether this process may be killed, so that SymPy's own evaluation may take its time.
    """

    product: int
    factored_terms: int
    factored_degree: int
    eliminated_degree: int
    killable: bool


QUICK = Limits(product=100_000, factored_terms=40, factored_degree=16, eliminated_degree=48, killable=False)
"""Limits in the user's own process: no operation takes more than some milliseconds."""

THOROUGH = Limits(
    product=20_000_000, factored_terms=200, factored_degree=40, eliminated_degree=128, killable=True
)
"""Limits in the worker, which can be killed."""


class TooLarge(Exception):
    """The normal form would not fit."""


class Full(Exception):
    """More generators are needed than there is room for; start again with more room."""


class OutOfTime(Exception):
    """The deadline has passed."""


class Refine(Exception):
    """A kernel is needed at a finer fraction than was provided for; start again."""
