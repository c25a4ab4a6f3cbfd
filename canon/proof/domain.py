"""The domain a claim is about, and points of it.

What a single symbol may be (positive, real, integer …) is said by the symbol's own SymPy assumptions; a
:class:`Domain` adds conditions that tie symbols together and boxes from which points are usefully drawn.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

from sympy import Rational, Symbol

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy.logic.boolalg import Boolean

__all__ = ["Domain"]


@dataclass(frozen=True)
class Domain:
    """Conditions that hold beside the symbols' own assumptions.

    Parameters
    ----------
    conditions
        SymPy relations and ``Ne`` that hold at every point of the domain.
    box
        Ranges from which sample points can usefully be drawn: a hint, not part of the claim.

    Examples
    --------
    >>> from sympy import symbols
    >>> x = symbols("x", real=True)
    >>> Domain(conditions=(x < 1,)).conditions
    (x < 1,)
    """

    conditions: tuple[Boolean, ...] = ()
    box: Mapping[Symbol, tuple[Rational, Rational]] = field(default_factory=lambda: MappingProxyType({}))
