"""Number formats that a motion can be computed in, by the keyword ``precision``."""

from __future__ import annotations

from dataclasses import dataclass

from canon.kernel.llvm.number_types import DOUBLE, DOUBLE_DOUBLE, EXTENDED, SINGLE, MachineType

__all__ = ["ADAPTIVE", "FIXED", "Precision", "fixed_precision", "unit_round_off"]


@dataclass(frozen=True)
class Precision:
    """A machine number and whether round-off is carried along.

    Parameters
    ----------
    name
        The keyword.
    number
        The type of the state and of every operation.
    compensated
        Whether what rounding takes from the state is kept and added with the next increment.
    """

    name: str
    number: MachineType
    compensated: bool = False


FIXED = {
    precision.name: precision
    for precision in (
        Precision("single", SINGLE),
        Precision("double", DOUBLE),
        Precision("compensated", DOUBLE, compensated=True),
        Precision("extended", EXTENDED),
        Precision("double-double", DOUBLE_DOUBLE),
    )
}
"""Precisions of fixed-step methods, lowest first: 24, 53, 53 + carried round-off, 64 and 106 bits."""

ADAPTIVE = ("double", "extended", "quad")
"""Precisions of heyoka's Taylor method beside a number of decimal digits: 53, 64 and 113 bits."""

_QUAD_BITS = 113
"""Bits of IEEE 754's binary128."""


def unit_round_off(precision: str) -> float:
    """Return the largest relative error of rounding to the numbers of a precision, 2⁻ᵖ with p bits of mantissa.

    Parameters
    ----------
    precision
        A keyword, or a number of decimal digits as text, as :class:`canon.flow.Trajectory` has it.

    Raises
    ------
    ValueError
        There is no such precision.

    Examples
    --------
    >>> [unit_round_off(name) == 2.0**-bits for name, bits in (("single", 24), ("compensated", 53), ("quad", 113))]
    [True, True, True]
    """
    if precision in FIXED:
        return 2.0 ** -FIXED[precision].number.mantissa
    if precision == "quad":
        return 2.0**-_QUAD_BITS
    if precision.isdecimal():
        return 0.5 * 10.0 ** (1 - int(precision))
    raise ValueError(f"precision={precision!r}: there are {', '.join((*FIXED, 'quad'))} and decimal digits")


def fixed_precision(name: str | int | None) -> Precision:
    """Return a fixed-step method's precision by its keyword; ``"compensated"`` where none is given.

    Raises
    ------
    ValueError
        There is no such precision, or the platform lacks the type.

    Examples
    --------
    >>> fixed_precision(None).name, fixed_precision("single").number.mantissa
    ('compensated', 24)
    """
    precision = FIXED.get(str(name or "compensated"))
    if precision is None:
        raise ValueError(f"precision={name!r}: fixed-step methods have {', '.join(FIXED)}")
    if not precision.number.available():
        raise ValueError(
            f"precision={name!r}: this platform has no 80-bit long double; use 'double-double' or Taylor()"
        )
    return precision
