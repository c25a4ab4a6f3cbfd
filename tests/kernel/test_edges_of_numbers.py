"""Numbers at the edges of their kinds, and orders that are looked for up to a highest one."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from canon.kernel.heyoka_bridge import fraction_of, heyoka_number
from canon.kernel.llvm.number_types import EXTENDED, SINGLE
from canon.kernel.schemes.order_conditions import order


def test_an_order_is_looked_for_up_to_the_highest() -> None:
    # Yoshida's triple jump of leapfrog steps: 1/(2 − 2^(1/3)) and what is left.
    outer = 1 / (2 - 2 ** (1 / 3))
    a = [outer / 2, (1 - outer) / 2, (1 - outer) / 2, outer / 2]
    b = [outer, 1 - 2 * outer, outer]
    assert [order(a, b, highest=highest) for highest in (1, 2, 3, 4, 6)] == [1, 2, 3, 4, 4]
    assert order([0.5, 0.5], [1.0], highest=4) == 2


def test_wide_numbers_below_all_doubles_are_read_exactly() -> None:
    kind = heyoka_number(40)
    small = kind(Fraction(3, 2**700))
    assert fraction_of(small * small) == Fraction(9, 2**1400)
    for lost in (np.inf, np.nan, kind(Fraction(1)) * float("inf")):
        with pytest.raises(ValueError, match="is no finite number"):
            fraction_of(lost)


@pytest.mark.parametrize(("number", "bits"), [(SINGLE, 24), (EXTENDED, 64)])
def test_zero_is_its_own_nearest_and_a_third_is_rounded(number: object, bits: int) -> None:
    assert number.nearest(Fraction(0)) == 0
    third = number.nearest(Fraction(1, 3))
    assert third != Fraction(1, 3)
    assert abs(third - Fraction(1, 3)) <= Fraction(1, 2 ** (bits + 2))
