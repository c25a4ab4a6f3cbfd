"""A kind of claim is one value: what it names exists, nothing else knows it by name, and the page adds one."""

import ast
import importlib.util
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import canon.exercise
from canon.exercise import claim_verdict as judging
from canon.exercise.diagnose import rereadings
from canon.exercise.diagnose.change import Mistake
from canon.exercise.diagnose.diagnosis import Proof
from canon.exercise.diagnose.repairs import screen_tests
from canon.exercise.question import answer_values
from canon.exercise.report.sentences import OF_A_COMPONENT, SENTENCES, feedback
from canon.exercise.sheet import key_shapes, kind, kinds
from canon.exercise.sheet.kind import Kind, named_function
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import sheet_from

ROOM = Path(canon.exercise.__file__).parent
PAGE = Path(__file__).parent.parent.parent / "docs" / "howto" / "add_a_claim_kind.md"
SOURCES = {path.relative_to(ROOM).as_posix(): path.read_text("utf-8") for path in ROOM.rglob("*.py")}


@pytest.mark.parametrize("name", KINDS)
def test_what_a_kind_names_exists(name):
    own = KINDS[name]
    arguments = ["reading", "ask"] if own.about else ["reading"]
    assert list(inspect.signature(named_function("canon.exercise.judges", own.judge)).parameters) == arguments
    if own.screen:
        assert own.screen in screen_tests.__all__
    assert set(own.rereadings) <= set(rereadings.__all__) - {"read_anew"}
    for diagnosis in own.diagnoses:
        tried = named_function("canon.exercise.diagnose", diagnosis)
        assert list(inspect.signature(tried).parameters) == ["wrong"]
    assert set(own.about) <= set(KINDS)


@pytest.mark.parametrize("name", KINDS)
def test_the_keys_that_a_kind_names_are_its_own(name):
    own = KINDS[name]
    groups = {key for group in own.one_of for key in group}
    repaired = {key.partition(".")[0] for key in own.repaired}
    named = {*groups, *own.answer, *own.claimed_too, *own.complex_names, *own.varying, *repaired}
    assert named <= set(own.shapes)
    assert not set(own.required) & set(own.optional)


def test_reading_a_sheet_loads_no_sympy_and_no_judge():
    code = (
        "import sys, canon.exercise.sheet.kinds; "
        "print([m for m in sys.modules if m == 'sympy' or m.startswith('canon.exercise.judges')])"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"


def test_a_right_answer_loads_no_numpy_no_diagnosis_and_no_judge_that_it_does_not_need():
    code = (
        "import sys\n"
        "from canon.exercise import Claim\n"
        "from canon.exercise.explained_judgement import judgements\n"
        "keys = {'lhs': 'sin(x)**2', 'rhs': '1 - cos(x)**2', 'parameters': {'x': 'real'}}\n"
        "*_, (judgement, _) = judgements(Claim('a', 'equality-only', keys))\n"
        "loaded = ('numpy', 'canon.exercise.diagnose', 'canon.exercise.judges.canonical')\n"
        "print(judgement.status, sorted(m for m in sys.modules if m.startswith(loaded)))"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "holds []"


def test_no_other_module_knows_a_kind_by_its_name():
    answers = ("positive-real", "hamilton-equations")  # kinds without a dash are keys and English words, too
    names = {name for name in KINDS if "-" in name and name not in answers}
    for path, source in SOURCES.items():
        if path in ("sheet/kinds.py", "sheet/perturbed_kinds.py"):
            continue
        texts = {
            node.value for node in ast.walk(ast.parse(source))
            if isinstance(node, ast.Constant) and isinstance(node.value, str)
        }  # fmt: skip
        assert not texts & {*names, "generating-F"}, path
        assert not re.search(r"\bkind (==|!=|in|not in) [\"(\[{]|kind\.startswith", source), path


def test_no_sentence_is_read_again():
    for path, source in SOURCES.items():
        if path.startswith(("diagnose/", "question/")):
            assert not re.search(
                r"^import re$|[\"'] in [\w.]*feedback|name\.startswith", source, re.MULTILINE
            ), path


def test_sentences_are_made_in_one_module():
    """A diagnosis is a value: nothing in the room that makes it says in words what is wrong."""
    for path, source in SOURCES.items():
        if path.startswith("diagnose/"):
            tree = ast.parse(source)
            inside = {
                id(node.value)
                for node in ast.walk(tree)
                if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
            }
            texts = [
                node.value
                for node in ast.walk(tree)
                if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in inside
            ]
            enumerated = {proof.value for proof in Proof}
            assert not [
                text for text in texts if text.count(" ") > 2 and text not in enumerated and "[" not in text
            ], path
    assert set(Mistake) == {*SENTENCES, *OF_A_COMPONENT}


def imported(name, source, folder, monkeypatch):
    path = folder / f"{name.rpartition('.')[2]}.py"
    path.write_text(source, "utf-8")
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, name, module)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def with_the_kind_of_the_page(monkeypatch, tmp_path):
    value, judge = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    imported("canon.exercise.judges.equilibrium", judge, tmp_path, monkeypatch)
    table = f"from canon.exercise.sheet.kinds import _LAGRANGE, Kind, Shape\nMADE = {{{value}}}\n"
    made = imported("made", table, tmp_path, monkeypatch).MADE

    def add(**more):
        [(name, own)] = made.items()
        own = Kind(**{**{f: getattr(own, f) for f in Kind.__dataclass_fields__}, **more})
        for holder in (kinds, key_shapes, answer_values, rereadings):
            monkeypatch.setattr(holder, "KINDS", {**KINDS, name: own})

    return add


def test_the_kind_that_the_page_adds_is_judged_as_the_page_says(with_the_kind_of_the_page):
    with_the_kind_of_the_page()
    [sheet] = re.findall(r"```toml\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    claims = sheet_from(sheet.encode(), toml=True).claims
    findings = [judging.examine(claim) for claim in claims]
    said = re.findall(r"^# (holds|fails)$", sheet, re.MULTILINE)
    assert [finding.verdict.status.value for finding in findings] == said
    assert findings[1].verdict.feedback == "the force along theta does not vanish there"
    with_the_kind_of_the_page(repaired=("at",))
    told = feedback(judging.examine(claims[1]))
    assert f"*{told}*" in PAGE.read_text("utf-8")


def test_the_page_names_every_field_of_a_kind():
    named = set(re.findall(r"`(\w+)`", PAGE.read_text("utf-8")))
    assert set(Kind.__dataclass_fields__) - {"judge", "required"} <= named
    assert kind.USUAL
