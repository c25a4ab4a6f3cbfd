"""``canon check`` from end to end, in a process of its own, on good, wrong and hostile sheets."""

import argparse
import json
import math
import subprocess
import sys
from fractions import Fraction

import pytest

from canon.cli import main
from canon.command.argument_types import seconds
from canon.exercise.judging_process import Worker
from canon.exercise.sheet.sheet import Claim

TRUE = {"id": "yes", "kind": "equality-only", "title": "double angle", "lhs": "sin(2*x)", "rhs": "2*sin(x)*cos(x)",
        "parameters": {"x": "real"}}  # fmt: skip
FALSE = {**TRUE, "id": "no", "rhs": "sin(x)*cos(x)"}
INVALID = {**TRUE, "id": "bad", "rhs": "2*sin(y)"}


def write(folder, *claims, name="sheet.json"):
    path = folder / name
    path.write_text(json.dumps({"title": "A sheet", "claims": list(claims)}), "utf-8")
    return str(path)


def run(*arguments, stdin=None):
    return subprocess.run(
        [sys.executable, "-m", "canon.cli", *arguments],
        capture_output=True, text=True, encoding="utf-8", input=stdin, check=False,
    )  # fmt: skip


def test_a_table_for_people(tmp_path):
    done = run("check", write(tmp_path, TRUE, FALSE, INVALID))
    assert done.returncode == 2
    assert done.stderr == ""
    assert "A sheet" in done.stdout
    assert "✓ holds     yes" in done.stdout
    assert "✗ fails     no" in done.stdout
    assert "rhs should be twice what it is" in done.stdout
    assert "! invalid   bad" in done.stdout
    assert "key rhs, column 7: y is not declared" in done.stdout
    assert "2*sin(y)\n          ^" in done.stdout
    assert "3 claims: 1 holds, 1 fails, 1 invalid" in done.stdout


def test_ill_formed_claims_are_named_and_the_others_judged(tmp_path):
    odd = [
        {**TRUE, "kind": "equality"},
        {"id": "b", "kind": "equality-only", "lhs": "1"},
        {**TRUE, "id": "c", "lsh": "1"},
        7,
    ]
    done = run("check", write(tmp_path, *odd, {**TRUE, "id": "good"}))
    assert done.returncode == 2
    assert done.stdout.count("! invalid") == 4
    for part in (
        "is equality-only meant?",
        "key rhs: missing",
        "unknown key",
        "invalid   #4",
        "✓ holds     good",
    ):
        assert part in done.stdout
    assert done.stdout.count("sheet.json: ") == 4


def test_json_lines_for_programs(tmp_path):
    done = run("check", "--json", write(tmp_path, TRUE, FALSE))
    yes, no = map(json.loads, done.stdout.splitlines())
    assert done.returncode == 1
    assert {
        "id",
        "kind",
        "status",
        "seconds",
        "certificate",
        "counterexample",
        "residual",
        "feedback",
        "corrected",
    } <= set(no)
    assert (yes["status"], no["status"]) == ("holds", "fails")
    assert yes["certificate"]
    assert yes["counterexample"] is None
    example = no["counterexample"]
    x = float(Fraction(example["point"]["x"]))
    difference = float(example["left"]) - float(example["right"])
    assert difference == pytest.approx(math.sin(2 * x) - math.sin(x) * math.cos(x), rel=1e-9)
    assert no["feedback"]


@pytest.mark.parametrize(
    ("claims", "arguments", "status"),
    [
        ([TRUE], [], 0),
        ([TRUE, FALSE], [], 1),
        ([TRUE, FALSE, INVALID], [], 2),
        ([TRUE, FALSE], ["--only", "yes"], 0),
        ([TRUE, FALSE], ["--only", "maybe"], 2),
        ([{**TRUE, "expect": "holds"}, {**FALSE, "expect": "fails"}], ["--expect"], 0),
        ([{**TRUE, "expect": "holds"}, {**FALSE, "expect": "holds"}], ["--expect"], 1),
        ([{**TRUE, "expect": "fails"}], ["--expect"], 1),
        ([TRUE, INVALID], ["--expect"], 2),
    ],
)
def test_exit_status(tmp_path, capsys, claims, arguments, status):
    assert main(["check", *arguments, write(tmp_path, *claims)]) == status
    capsys.readouterr()


def test_a_report_that_cannot_be_written_gives_2(tmp_path, capsys):
    page = str(tmp_path / "no folder" / "report.html")
    assert main(["check", write(tmp_path, TRUE), "--html", page]) == 2
    told = capsys.readouterr()
    assert "✓ holds     yes" in told.out
    assert f"{page}: can't be written (No such file or directory)" in told.err


def test_an_undecided_claim_gives_3(tmp_path, capsys):
    hard = {"id": "hard", "kind": "equality-only", "lhs": "LambertW(exp(sin(1) + LambertW(2)))", "budget": 0.5,
            "rhs": "LambertW(exp(sin(1) + LambertW(2))) + LambertW(3)*exp(LambertW(3)) - 3 + 0*t"}  # fmt: skip
    status = main(["check", "--json", write(tmp_path, hard)])
    told = json.loads(capsys.readouterr().out)
    assert (told["status"], status) in (("undecided", 3), ("holds", 0))
    if told["status"] == "undecided":
        assert told["known"]


def test_several_sheets_and_standard_input(tmp_path):
    one = write(tmp_path, TRUE)
    done = run("check", "--json", one, "-", stdin=json.dumps({"claims": [FALSE]}))
    assert [json.loads(line)["id"] for line in done.stdout.splitlines()] == ["yes", "no"]


def test_one_sheet_of_many_that_cannot_be_read_costs_the_others_nothing(tmp_path):
    broken = tmp_path / "broken.json"
    broken.write_text('{"claims": [', "utf-8")
    done = run("check", "--json", str(broken), str(tmp_path / "none.toml"), write(tmp_path, TRUE))
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert [t["status"] for t in told] == ["invalid", "invalid", "holds"]
    assert "not valid JSON" in told[0]["known"]
    assert told[0]["file"] == str(broken)
    assert done.returncode == 2
    assert done.stderr.count("canon check: ") == 2
    assert "Traceback" not in done.stderr
    assert run("check", "--only", "yes", str(broken), write(tmp_path, TRUE)).returncode == 2


def test_equal_claims_are_judged_once_and_several_at_a_time(tmp_path):
    class_ = [{**(TRUE if i % 3 else FALSE), "id": f"student {i}"} for i in range(200)]
    done = run("check", "--json", "--jobs", "2", write(tmp_path, *class_))
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert [t["id"] for t in told] == [c["id"] for c in class_]
    assert [t["status"] for t in told] == ["holds" if i % 3 else "fails" for i in range(200)]
    assert len({t["seconds"] for t in told}) <= 2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["check"], "SHEET"),
        (["check", "missing.toml"], "can't be read"),
        (["check", "--budget", "no", "x.toml"], "seconds"),
        (["judge"], "there is no command 'judge'"),
        (["chek", "sheet.toml"], "did you mean check?"),
        ([], "canon tour"),
    ],
)
def test_bad_usage_is_2_and_says_why(arguments, said):
    done = run(*arguments)
    assert done.returncode == 2
    assert said in done.stderr
    assert "Traceback" not in done.stderr


def test_help_teaches():
    overview, check = run("--help").stdout, run("check", "--help").stdout
    assert "canon tour" in overview
    for word in ("[[claim]]", "euler-lagrange", "exit status", "--expect"):
        assert word in check
    assert run("--version").stdout.startswith("canon ")


def test_a_reader_that_leaves_early_is_no_error(tmp_path):
    many = write(tmp_path, *({**TRUE, "id": f"c{i}"} for i in range(300)))
    process = subprocess.Popen(
        [sys.executable, "-m", "canon.cli", "check", many],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    process.stdout.readline()
    process.stdout.close()
    error = process.stderr.read()
    process.stderr.close()
    assert process.wait() == 141
    assert error == ""


HOSTILE = {
    "tower": {"lhs": "9**9**9", "rhs": "1"},
    "late tower": {"lhs": "exp(exp(exp(exp(exp(9)))))", "rhs": "1"},
    "sine of a tower": {"lhs": "sign(sin(exp(exp(exp(9)))))", "rhs": "1"},
    "deep": {"lhs": "sin(" * 63 + "x" + ")" * 63, "rhs": "x"},
    "deeper": {"lhs": "(" * 20_000, "rhs": "x"},
    "long sum": {"lhs": "+".join(["x"] * 100_000), "rhs": "x"},
    "long sum of powers": {"lhs": "+".join(f"sin({i}*x)**{i % 9}" for i in range(1, 3000)), "rhs": "0*x"},
    "power of a sum": {"lhs": "(x + t + 1)**900", "rhs": "(x + t)**900 + 1"},
    "nested powers": {"lhs": "((((x+1)**99+1)**99+1)**99+1)**99", "rhs": "x"},
    "big numbers": {"lhs": "7" * 900 + "**30 + sqrt(" + "3" * 900 + ")", "rhs": "x"},
    "attributes": {"lhs": "x.__class__.__mro__", "rhs": "x"},
    "string": {"lhs": "__import__('os').system('touch /tmp/owned')", "rhs": "x"},
    "lambda": {"lhs": "(lambda: x)()", "rhs": "x"},
    "lookalike": {"lhs": "ｅｖａｌ(x)", "rhs": "x"},
    "null": {"lhs": "x\x00", "rhs": "x"},
    "many maxima": {"lhs": "Max(" + ",".join(f"sin(x+{i})" for i in range(16)) + ")", "rhs": "x"},
    "pieces": {
        "lhs": "Piecewise(" + ",".join(f"(x**{i}, sin(x) < {i}/9)" for i in range(15)) + ",(0,True))",
        "rhs": "x",
    },
    "not real": {"lhs": "sqrt(-1-x**2)", "rhs": "log(-1-x**2)"},
}


def test_hostile_claims_are_answered_within_their_budget_and_the_next_is_judged(processor_seconds):
    budget = 2.0
    with Worker() as worker:
        assert worker.judge(Claim("warm", "equality-only", TRUE)).status == "holds"
        for name, change in HOSTILE.items():
            worker._running()  # one that was killed is started again before the clock of the next claim runs
            used = processor_seconds()
            told = worker.judge(Claim(name, "equality-only", {**TRUE, **change}, budget=budget))
            assert processor_seconds() - used < budget + 1, name
            assert told.status in ("invalid", "undecided", "fails"), (name, told)
            assert "Traceback" not in told.known
            assert len(json.dumps(told.to_dict())) < 20_000, name
        assert worker.judge(Claim("after", "equality-only", TRUE)).status == "holds"


def test_a_budget_that_is_spent_kills_the_worker_and_says_so(processor_seconds):
    with Worker() as worker:
        worker._running()
        slow = {
            **TRUE,
            "lhs": "(x + t + cos(x) + 1)**60*sin(x)**40",
            "rhs": "(x + t + cos(x) + 1)**60*(1 - cos(x)**2)**20 + 0*x",
        }
        used = processor_seconds()
        told = worker.judge(Claim("slow", "equality-only", slow, budget=0.02))
        assert told.status in ("undecided", "holds")
        assert processor_seconds() - used < 1.02
        assert worker.judge(Claim("after", "equality-only", TRUE)).status == "holds"


@pytest.mark.parametrize("text", ["-1", "-0.5", "-1e-9", "inf", "nan", "soon"])
def test_no_time_is_negative_or_without_end(text):
    assert seconds(none=True)("0") == 0.0
    with pytest.raises(argparse.ArgumentTypeError, match="should be a number of seconds, 0 or more"):
        seconds(none=True)(text)
    with pytest.raises(
        argparse.ArgumentTypeError, match="should be a number of seconds, above 0 and up to 60"
    ):
        seconds(60.0)(text)
