"""Long arrays of compiled loops begin apart within a page of memory, wherever the pages are."""

import itertools
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from canon.kernel.llvm.number_types import DOUBLE, DOUBLE_DOUBLE
from canon.kernel.llvm.writer import Writer

PAGE, LINE = 4096, 64


def begins(w: Writer, parts: list[int], gap: int, length: int, size: int) -> list[int]:
    """Return where each part begins, in bytes from the first array: LLVM lays them out downwards, one by one."""
    sizes = [int(re.search(r"\[(\d+) x", line)[1]) * size for line in w.reserved]
    ends = list(itertools.accumulate(-(-each // LINE) * LINE for each in sizes))
    return [
        sizes[0] - end + part * (length + gap) * size
        for end, count in zip(ends, parts, strict=True)
        for part in range(count)
    ]


@given(st.integers(128, 20_000), st.sampled_from([(DOUBLE, 8), (DOUBLE_DOUBLE, 16)]))
def test_no_two_of_five_begin_near_each_other_in_a_page(length, kind):
    """q and p of a state and of its compensation, and the force."""
    number, size = kind
    w = Writer(number)
    gap = w.gap(length)
    for _ in range(2):
        w.array(2 * length + gap, 2)
    w.array(length)
    places = sorted(each % PAGE for each in begins(w, [2, 2, 1], gap, length, size))
    assert min(np.diff([*places, places[0] + PAGE])) >= 512


def test_short_ones_waste_nothing():
    w = Writer(DOUBLE)
    assert w.gap(64) == 0
    w.array(127)
    assert "[127 x double]" in w.reserved[0]


@pytest.mark.parametrize("length", [20_000, 20_480])
def test_no_two_on_the_heap_do(length):
    w = Writer(DOUBLE)
    for parts in (2, 2, 1):
        w.array(length, parts)
    apart = [int(each) for each in re.findall(r"ptr %r\d+\.page, i64 (\d+)", w.body())]
    assert apart == [0, 2 * 1152, 4 * 1152 - PAGE]
