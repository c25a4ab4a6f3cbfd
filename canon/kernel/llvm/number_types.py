"""Machine numbers: the types the compiled loops work in, and how exact constants are printed for LLVM."""

from __future__ import annotations

import math
import platform
import struct
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from canon.array import Array

__all__ = ["DOUBLE", "DOUBLE_DOUBLE", "EXTENDED", "SINGLE", "MachineType", "double_pair"]


@dataclass(frozen=True)
class MachineType:
    """A hardware floating-point type, one number or several side by side in SIMD lanes.

    Parameters
    ----------
    scalar
        LLVM's name of the type.
    mantissa
        Bits of the mantissa.
    dtype
        NumPy's name of the type in memory.
    library_suffix
        What libm appends to a function's name for this type.
    lanes
        Numbers side by side.
    pair
        Whether a number is the sum of two of these: double-double.
    """

    scalar: str
    mantissa: int
    dtype: str
    library_suffix: str
    lanes: int = 1
    pair: bool = False

    @property
    def base(self) -> str:
        """The LLVM type of a value, or of each of its two parts."""
        return self.scalar if self.lanes == 1 else f"<{self.lanes} x {self.scalar}>"

    @property
    def name(self) -> str:
        """The LLVM type of a value."""
        return f"{{ {self.base}, {self.base} }}" if self.pair else self.base

    @property
    def flags(self) -> str:
        """The LLVM type of a comparison's result."""
        return "i1" if self.lanes == 1 else f"<{self.lanes} x i1>"

    @property
    def intrinsic(self) -> str:
        """How LLVM's intrinsics name the type."""
        short = {"double": "f64", "float": "f32", "x86_fp80": "f80"}[self.scalar]
        return short if self.lanes == 1 else f"v{self.lanes}{short}"

    @property
    def alignment(self) -> int:
        """Bytes of one scalar in memory, to which arrays from Python are aligned at least."""
        return np.dtype(self.dtype).itemsize

    def literal(self, value: Fraction) -> str:
        """Return the LLVM constant nearest to an exact number, in every lane."""
        one = _extended_literal(value) if self.scalar == "x86_fp80" else self._literal(value)
        if not self.pair:
            return self._in_every_lane(one)
        rest = self._literal(value - Fraction(float(value)))
        return f"{{ {self.base} {self._in_every_lane(one)}, {self.base} {self._in_every_lane(rest)} }}"

    def nearest(self, value: Fraction) -> Fraction:
        """Return the number of this type nearest to an exact one."""
        if self.pair:
            return sum(map(Fraction, double_pair(value)), Fraction(0))
        if self.scalar == "double":
            return Fraction(float(value))
        if not value:
            return value
        exponent = abs(value.numerator).bit_length() - value.denominator.bit_length() - self.mantissa
        scale = Fraction(2) ** exponent
        if abs(value) >= scale * 2**self.mantissa:
            scale *= 2
        return round(value / scale) * scale

    def packed(self, high: Array, low: Array) -> npt.NDArray[Any]:
        """Return numbers high + low as they lie in memory.

        Parameters
        ----------
        high, low
            Shape (count, lanes), or (count,) for one lane.
        """
        high, low = high.reshape(-1, self.lanes), low.reshape(-1, self.lanes)
        if self.pair:
            return np.stack([high, low], axis=1).ravel()
        return np.add(high.astype(self.dtype, copy=False), low.astype(self.dtype, copy=False)).ravel()

    def unpacked(self, memory: npt.NDArray[Any]) -> tuple[Array, Array]:
        """Return numbers in memory as sums high + low of doubles, each of shape (count, lanes)."""
        if self.pair:
            parts = memory.reshape(-1, 2, self.lanes)
            return parts[:, 0].copy(), parts[:, 1].copy()
        numbers = memory.reshape(-1, self.lanes)
        if self.scalar == "double":
            return numbers.copy(), np.zeros(numbers.shape)
        high = numbers.astype(np.float64)
        with np.errstate(invalid="ignore"):
            return high, (numbers - high).astype(np.float64)

    def available(self) -> bool:
        """Return whether this platform has the type: only x87's long double is missing on some."""
        return self.scalar != "x86_fp80" or (np.finfo(np.longdouble).nmant == 63 and _is_x86())

    def special(self, name: str) -> str:
        """Return the LLVM constant for ``"inf"`` or ``"nan"``, in every lane."""
        ieee, extended = {
            "inf": ("0x7FF0000000000000", "0xK7FFF8000000000000000"),
            "nan": ("0x7FF8000000000000", "0xK7FFFC000000000000000"),
        }[name]
        return self._in_every_lane(extended if self.scalar == "x86_fp80" else ieee)

    def _in_every_lane(self, one: str) -> str:
        return one if self.lanes == 1 else "<" + ", ".join([f"{self.scalar} {one}"] * self.lanes) + ">"

    def _literal(self, value: Fraction) -> str:
        with np.errstate(over="ignore"):
            nearest = float(value) if self.scalar == "double" else float(np.float32(float(value)))
        if not math.isfinite(nearest):
            raise OverflowError(
                f"the constant {float(value):g} is too large for {self.scalar} numbers; choose other units"
            )
        return f"0x{struct.unpack('<Q', struct.pack('<d', nearest))[0]:016X}"


def _extended_literal(value: Fraction) -> str:
    if not value:
        return "0xK" + "0" * 20
    size = abs(value)
    exponent = size.numerator.bit_length() - size.denominator.bit_length() - 64
    mantissa = round(size / Fraction(2) ** exponent)
    while mantissa >= 1 << 64:
        exponent += 1
        mantissa = round(size / Fraction(2) ** exponent)
    biased = exponent + 63 + 16383 + (0x8000 if value < 0 else 0)
    return f"0xK{biased:04X}{mantissa:016X}"


def _is_x86() -> bool:
    return platform.machine().lower() in ("x86_64", "amd64")


def double_pair(value: Fraction) -> tuple[float, float]:
    """Return an exact number as a sum of two doubles.

    Raises
    ------
    ValueError
        Doubles hold no number of that size.
    """
    n, d = value.numerator, value.denominator
    try:
        high = n / d
    except OverflowError:
        size = n.bit_length() - d.bit_length()
        raise ValueError(
            f"a number of about 1e{size * 0.30103:.0f} is beyond 1e308: choose other units"
        ) from None
    a, b = high.as_integer_ratio()
    # Quotients of whole numbers are rounded correctly, and quicker than fractions are subtracted.
    return high, (n * b - a * d) / (d * b)


DOUBLE = MachineType("double", 53, "float64", "")
SINGLE = MachineType("float", 24, "float32", "f")
EXTENDED = MachineType("x86_fp80", 64, "longdouble", "l")
DOUBLE_DOUBLE = MachineType("double", 106, "float64", "", pair=True)
