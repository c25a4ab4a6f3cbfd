"""``--set NAME=VALUE``: how a parameter's value is given on the command line."""

from __future__ import annotations

import math

__all__ = ["setting"]


def setting(text: str) -> tuple[str, float]:
    """Return name and value.

    Raises
    ------
    ValueError
        Where the text is no name, =, and finite number.

    Examples
    --------
    >>> setting("l=2")
    ('l', 2.0)
    """
    name, equals, value = text.partition("=")
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not (name.strip() and equals and math.isfinite(number)):
        raise ValueError(f"--set {text}: write a parameter's name, =, and a number, as in --set l=2")
    return name.strip(), number
