"""How many examples a law draws: fifty in each run or a reason beside it, two thousand where they are asked for."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
ENOUGH, MANY = 50, 2000
DEAR = dict(reversed(line.split()) for line in (TESTS / "dear_laws.txt").read_text().splitlines())


def laws_of(path):
    """Yield the laws of a file by their names, with the lines on which their decorators stand."""
    source = path.read_text(encoding="utf-8")
    if "@given" in source:
        for node in ast.parse(source).body:
            if isinstance(node, ast.FunctionDef) and any(
                "given(" in ast.unparse(d) for d in node.decorator_list
            ):
                lines = source.splitlines()[node.decorator_list[0].lineno - 1 : node.lineno - 1]
                yield f"tests/{path.relative_to(TESTS).as_posix()}::{node.name}", lines


LAWS = {name: lines for path in sorted(TESTS.rglob("test_*.py")) for name, lines in laws_of(path)}


def test_the_laws_are_found():
    assert len(LAWS) > 110


MORE_OF_THE_SAME = {
    "tests/exercise/test_fuzz.py::test_twenty_thousand_texts":
        "tests/exercise/test_fuzz.py::test_any_text_is_an_expression_or_its_fault_has_a_column",
}  # fmt: skip
"""Laws that are slow, each with the same of fewer examples that every run has."""


def test_every_run_has_every_law():
    slow = {name for name, lines in LAWS.items() if any("mark.slow" in line for line in lines)}
    assert slow == set(MORE_OF_THE_SAME)
    assert set(MORE_OF_THE_SAME.values()) <= set(LAWS) - slow


def own_examples(name):
    """Return how many examples a law draws by itself, and the line that says so."""
    for line in LAWS[name]:
        if found := re.search(r"max_examples=([\d_]+)|usual\((\d+)\)", line):
            return int(found[1] or found[2]), line
    return 100, ""  # hypothesis's own


def test_a_law_of_few_examples_says_what_one_costs():
    few = {name: line for name in LAWS for count, line in [own_examples(name)] if count < ENOUGH}
    assert [name for name, line in few.items() if not re.search(r"  # .*seconds? each: \w+", line)] == []


@pytest.mark.parametrize("name", DEAR)
def test_of_a_dear_law_more_are_drawn_where_more_are_asked_for(name):
    assert own_examples(name)[0] < int(DEAR[name]) < MANY


def drawn(law, examples):
    """Return how many examples of a law pytest draws with --examples."""
    options = ["-q", "--hypothesis-show-statistics", "-p", "no:cacheprovider", "--examples", str(examples)]
    told = subprocess.run(
        [sys.executable, "-m", "pytest", *options, law], capture_output=True, text=True, cwd=TESTS.parent
    ).stdout
    return int(re.findall(r"(\d+) passing", told)[-1])


def test_as_many_examples_are_drawn_as_are_asked_for():
    law = "tests/kernel/test_compensation.py::test_nothing_is_lost_but_what_the_increment_is_rounded_by"
    assert drawn(law, 300) == 300
    assert drawn(law, 50) == 100  # its own, where that is more
