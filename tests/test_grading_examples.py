"""The examples of grading: right and wrong are marked, what is unreadable or undecided is no zero anywhere."""

from __future__ import annotations

import ast
import contextlib
import csv
import importlib.util
import io
import json
import runpy
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

import canon
from canon.exercise import Judgement, MarkingPolicy
from canon.exercise.report.report import Report

GRADING = Path(__file__).parents[1] / "examples" / "grading"
RIGHT = r"$\ddot\theta + \frac{g}{l}\sin\theta = 0$"
WRONG = "theta'' + g/l*cos(theta) = 0"
UNREADABLE = "theta'' + g/l*sin(theta"
UNDECIDED = "hard"
ANSWERS = {RIGHT: "holds", WRONG: "fails", UNREADABLE: "invalid", UNDECIDED: "undecided"}
KNOWN = {"invalid": "key claim[0], column 24: a bracket is open", "undecided": "agreement at 48 points"}


@pytest.fixture
def quick(monkeypatch):
    """Verdicts on the four answers without judging them; :func:`test_the_verdicts_are_those` does."""

    def check(sheet, **_):
        claims = sheet if isinstance(sheet, list) else [dict(claim.keys) for claim in sheet.claims]
        judged = []
        for claim in claims:
            said = claim.get("claim", claim.get("I"))
            status = ANSWERS[said if isinstance(said, str) else said[0]]
            judged.append(
                Judgement(claim["id"], claim["kind"], status, known=KNOWN.get(status, ""), feedback="no")
            )
        return Report("", tuple(judged))

    monkeypatch.setattr(canon, "check", check)


def loaded(path):
    spec = importlib.util.spec_from_file_location(path.stem, GRADING / path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_verdicts_are_those():
    question = json.loads((GRADING / "moodle" / "question.json").read_text())
    answers = [RIGHT, WRONG, UNREADABLE]
    report = canon.check([{**question, "id": f"{k}", "claim": [answer]} for k, answer in enumerate(answers)])
    assert [judgement.status for judgement in report] == [ANSWERS[answer] for answer in answers]
    assert MarkingPolicy().marks(report)[2].asks_again


def test_all_ask_the_same_question():
    """Five copies of the pendulum, none of which may drift away from the others."""
    asked = json.loads((GRADING / "moodle" / "question.json").read_text())
    for path in ("otter/tests/q1.py", "prairielearn/pendulum/server.py", "moodle/coderunner_template.py"):
        tree = ast.parse((GRADING / path).read_text())
        assigned = [node for node in tree.body if isinstance(node, ast.Assign)]
        (said,) = (node.value for node in assigned if ast.unparse(node.targets[0]) == "QUESTION")
        assert {k: v for k, v in ast.literal_eval(said).items() if k != "id"} == asked


def cells(name):
    return json.loads((GRADING / name).read_text())["cells"]


def run_as_nbgrader(answer):
    """What nbgrader gives: 0 where a cell raised, else the value of its last line, else all points; and the error."""
    names = {"answer": answer}
    tree = ast.parse("".join(cells("nbgrader/pendulum.ipynb")[2]["source"]))
    last = ast.Expression(tree.body.pop().value)
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(tree, "cell", "exec"), names)  # noqa: S102 (our own notebook)
        return eval(compile(last, "cell", "eval"), names), ""  # noqa: S307
    except AssertionError as error:
        return 0, str(error)


def test_the_notebook_of_nbgrader_marks_and_sets_aside(quick, tmp_path):
    assert run_as_nbgrader(RIGHT) == (1.0, "")
    assert run_as_nbgrader(WRONG) == (0.0, "")
    question, answer, mark = cells("nbgrader/pendulum.ipynb")
    assert [cell["metadata"]["nbgrader"]["grade"] for cell in (question, answer, mark)] == [
        False,
        False,
        True,
    ]
    assert "### BEGIN SOLUTION" in "".join(answer["source"])
    script = loaded(Path("nbgrader/set_aside.py"))
    for student, text in (("ann", UNREADABLE), ("bo", UNDECIDED), ("cy", WRONG)):
        _, error = run_as_nbgrader(text)
        outputs = [{"output_type": "error", "ename": "AssertionError", "evalue": error}] if error else []
        path = tmp_path / student / "week3" / "pendulum.ipynb"
        path.parent.mkdir(parents=True)
        path.write_text(json.dumps({"cells": [question, answer, {**mark, "outputs": outputs}]}))
        grade = SimpleNamespace(auto_score=0.0, needs_manual_grade=False)
        book = SimpleNamespace(find_grade=lambda *where, g=grade: g, db=SimpleNamespace(commit=lambda: None))
        found = script.set_aside(book, "week3", path)
        aside = student != "cy"
        assert list(found) == (["pendulum-mark"] if aside else [])
        assert (grade.auto_score, grade.needs_manual_grade) == ((None, True) if aside else (0.0, False))


@pytest.fixture
def otter(monkeypatch):
    """Otter's decorator, of which the example uses the name and the points; the real one where it is installed."""
    if importlib.util.find_spec("otter") is not None:
        return

    def test_case(name, points):
        return lambda function: SimpleNamespace(name=name, points=points, test_func=function)

    module = ModuleType("otter.test_files")
    module.test_case = test_case
    monkeypatch.setitem(sys.modules, "otter", ModuleType("otter"))
    monkeypatch.setitem(sys.modules, "otter.test_files", module)


def test_the_test_of_otter_fails_where_there_is_no_mark_and_is_set_aside(quick, otter):
    q1 = loaded(Path("otter/tests/q1.py"))
    assert (q1.OK_FORMAT, q1.points, q1.the_equation_of_motion.points) == (False, 1, 1)
    q1.the_equation_of_motion.test_func(RIGHT)
    said = {}
    for answer in (WRONG, UNREADABLE, UNDECIDED):
        with pytest.raises(AssertionError) as error:
            q1.the_equation_of_motion.test_func(answer)
        said[answer] = str(error.value)
    tests = [
        {"name": n, "score": 0.0, "max_score": 1.0, "output": out, "status": "failed"}
        for n, out in said.items()
    ]
    results = loaded(Path("gradescope/set_aside.py")).set_aside({"tests": tests, "score": 0.0})
    assert [test["max_score"] for test in results["tests"]] == [1.0, 0.0, 0.0]
    assert results["extra_data"]["for_a_person"] == [UNREADABLE, UNDECIDED]
    assert "score" not in results


@pytest.mark.parametrize(
    ("answer", "score", "most"), [(RIGHT, 1, 1), (WRONG, 0, 1), (UNREADABLE, 0, 0), (UNDECIDED, 0, 0)]
)
def test_gradescope_has_a_score_only_where_there_is_a_mark(quick, tmp_path, answer, score, most):
    (tmp_path / "answers.json").write_text(json.dumps({"pendulum": answer, "other": 5}))
    grade = loaded(Path("gradescope/grade.py"))
    grade.main(tmp_path, tmp_path)
    results = json.loads((tmp_path / "results.json").read_text())
    pendulum, energy = results["tests"]
    assert (pendulum["name"], pendulum["score"], pendulum["max_score"]) == ("pendulum", score, most)
    assert (energy["score"], energy["max_score"], energy["output"]) == (0, 1, "not answered")
    assert results["extra_data"]["for_a_person"] == ([] if most else ["pendulum"])
    assert ("submit again" in pendulum["output"]) == (answer == UNREADABLE)


@pytest.mark.parametrize("said", ["", "[]", "{", "[" * 9_000, '{"pendulum": null}', None])
def test_gradescope_takes_any_submission(quick, tmp_path, said):
    if said is not None:
        (tmp_path / "answers.json").write_text(said)
    grade = loaded(Path("gradescope/grade.py"))
    answers = grade.submitted(tmp_path)
    assert answers == ({"pendulum": None} if said and "null" in said else {})


def test_prairielearn_asks_again_before_it_marks(quick):
    server = loaded(Path("prairielearn/pendulum/server.py"))

    def data(answer):
        return {
            "submitted_answers": {"answer": answer},
            "format_errors": {},
            "partial_scores": {},
            "feedback": {},
            "score": 0,
        }

    for answer, score in ((RIGHT, 1.0), (WRONG, 0.0)):
        server.parse(said := data(answer))
        assert said["format_errors"] == {}
        server.grade(said)
        assert said["partial_scores"]["answer"]["score"] == said["score"] == score
    server.parse(unread := data(UNREADABLE))
    assert "write it again" in unread["format_errors"]["answer"]
    server.parse(hard := data(UNDECIDED))
    assert hard["format_errors"] == {}
    with pytest.raises(server.ForAPerson):
        server.grade(hard)
    assert hard["partial_scores"] == {}
    assert json.loads((GRADING / "prairielearn" / "pendulum" / "info.json").read_text())["type"] == "v3"
    assert 'answers-name="answer"' in (GRADING / "prairielearn" / "pendulum" / "question.html").read_text()


def test_moodle_has_marks_and_a_table_of_what_has_none(quick):
    script = loaded(Path("moodle/mark_responses.py"))
    table = io.StringIO()
    rows = csv.writer(table)
    rows.writerow(["Email address", "Response 1"])
    rows.writerows([["a@b", RIGHT], ["c@d", WRONG], ["e@f", UNREADABLE], ["g@h", UNDECIDED], ["i@j", "-"]])
    table.seek(0)
    question = json.loads((GRADING / "moodle" / "question.json").read_text())
    found = script.marks(table, question, "claim", "Response 1")
    script.write(found, marked := io.StringIO(), open_ := io.StringIO())
    assert [row[:2] for row in csv.reader(io.StringIO(marked.getvalue()))][1:] == [
        ["a@b", "1.0"],
        ["c@d", "0.0"],
    ]
    waiting = [row[:2] for row in csv.reader(io.StringIO(open_.getvalue()))][1:]
    assert waiting == [["e@f", "ask again"], ["g@h", "look at it"]]


@pytest.mark.parametrize("precheck", [False, True])
def test_coderunner_says_of_a_zero_that_it_is_no_mark_yet(quick, tmp_path, capsys, precheck):
    template = (GRADING / "moodle" / "coderunner_template.py").read_text()
    template = template.replace("{{ IS_PRECHECK }}", str(int(precheck)))
    told = {}
    for answer in ANSWERS:
        (path := tmp_path / "question.py").write_text(
            template.replace("{{ STUDENT_ANSWER | e('py') }}", answer.replace("\\", "\\\\"))
        )
        runpy.run_path(str(path))
        told[answer] = json.loads(capsys.readouterr().out)
    marks = [told[answer]["fraction"] for answer in ANSWERS]
    assert marks == ([1.0, 1.0, 0.0, 1.0] if precheck else [1.0, 0.0, 0.0, 0.0])
    open_ = ["no mark yet" in told[answer]["prologuehtml"] for answer in ANSWERS]
    assert open_ == ([False] * 4 if precheck else [False, False, True, True])


def test_gradescope_marks_a_submission_as_its_container_does(tmp_path):
    (tmp_path / "answers.json").write_text(json.dumps({"pendulum": RIGHT, "energy": "x_dot**2/2 - k*x**2/2"}))
    command = [sys.executable, str(GRADING / "gradescope" / "grade.py"), str(tmp_path), str(tmp_path)]
    subprocess.run(command, check=True)
    pendulum, energy = json.loads((tmp_path / "results.json").read_text())["tests"]
    assert (pendulum["score"], pendulum["status"]) == (1.0, "passed")
    assert (energy["score"], energy["status"]) == (0.5, "failed")  # one of its two terms


def test_the_page_about_grading_tells_what_its_program_prints(capsys):
    page = (GRADING.parents[1] / "docs" / "howto" / "grade.md").read_text("utf-8")
    program = page.partition("```python\n")[2].partition("```")[0]
    exec(compile(program, "grade.md", "exec"), {})  # noqa: S102 (our own page)
    assert capsys.readouterr().out.splitlines() == [
        "right 2.0 False False",
        "wrong 0.0 False False",
        "unreadable None True False",
    ]
    for file in sorted(GRADING.rglob("*.py")):
        assert file.name in page or "/".join(file.parts[-3:-1]) in page, file
