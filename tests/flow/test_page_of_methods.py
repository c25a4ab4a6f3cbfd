"""docs/howto/my_problem_is.md: the names of methods, what they are in Python and how study files write them."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import pytest

from canon import flow
from canon.flow.method.method_text import _named, method_from, method_named

PAGE = (Path(__file__).parents[2] / "docs" / "howto" / "my_problem_is.md").read_text(encoding="utf-8")
TABLE = PAGE.partition("## Names of methods")[2]
ROWS = re.findall(r"^\| (`.+?) \| `(.+?)` \| `(.+?)` \| .+ \|$", TABLE, re.MULTILINE)
SHORT = re.compile(r"`([a-z-]+)-(\d)`, and -(\d), -(\d), -(\d)")


def names_in(cell):
    """The names of a cell, ranges and what is written short among them."""
    names = re.findall(r"`(.+?)`", cell)
    for low, high in re.findall(r"from `(\S+)` to `(\S+)`", cell):
        family, first, last = (
            low.rpartition("-")[0],
            int(low.rpartition("-")[2]),
            int(high.rpartition("-")[2]),
        )
        names += [f"{family}-{number}" for number in range(first, last + 1)]
    for family, *numbers in SHORT.findall(cell):
        names += [f"{family}-{number}" for number in numbers]
    return names


def made(call):
    """The method of a call in the text, whose arguments are plain values."""
    tree = ast.parse(call, mode="eval").body
    given = {each.arg: ast.literal_eval(each.value) for each in tree.keywords}
    return getattr(flow, tree.func.id)(*map(ast.literal_eval, tree.args), **given)


@pytest.mark.parametrize(("names", "value", "written"), ROWS, ids=[row[1] for row in ROWS])
def test_a_row_is_one_method_three_times(names, value, written):
    first = method_named(names_in(names)[0])
    assert first == made(value)
    assert first == method_from(tomllib.loads(f"method = {written}")["method"])


def test_every_name_stands_on_the_page_and_nothing_else():
    told = {name for names, *_ in ROWS for name in names_in(names)}
    beside = {"gauss-2-newton", "tao-4, omega 20"}
    odd_orders = {f"avf-{order}" for order in range(3, 16, 2)}
    assert told - beside - odd_orders == set(_named())


def test_case_hyphens_and_blanks_are_forgiven():
    assert method_named("RK4") == method_named("rk 4") == method_named("rk4")
    assert method_named("Kahan Li 8") == method_named("kahan-li-8")
