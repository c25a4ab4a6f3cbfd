"""Study files of strangers: told what is wrong, at once; names that are no commands to terminals and spreadsheets."""

from __future__ import annotations

import csv
import io
import sys

import pytest

from canon.cli import main
from canon.study.cases.case import Case
from canon.study.cases.export import csv_of, rows_of
from canon.study.cases.run_study import run_study
from canon.study.cases.store import Store
from canon.study.cases.study import Study, read_study
from canon.study.errors import StudyError

SYSTEM = (
    '[system."{name}"]\nH = "{H}"\nq = "q"\nparameters = {{ k = {k} }}\nstarts = {{ near = [0.5, 0.0] }}\n'
)
OWN = SYSTEM.format(name="own", H="p_q**2/2 + k*q**4/4", k="2.0")
FINE = {"system": '"own"', "method": '"verlet"', "step": "0.1", "span": "60.0"}


def text(head=OWN, **changed):
    return head + "[[study]]\n" + "\n".join(f"{key} = {value}" for key, value in {**FINE, **changed}.items())


def read(tmp_path, written):
    file = tmp_path / "study.toml"
    file.write_bytes(written if isinstance(written, bytes) else written.encode())
    return read_study(file)


def test_the_study_that_is_changed_below_is_fine(tmp_path):
    assert len(read(tmp_path, text()).cases) == 1
    assert len(read(tmp_path, b"\xef\xbb\xbf" + text(samples="512.0", parts="3").encode()).cases) == 1


LARGE = "9" * 400
REFUSED = {
    "no table": ("study = [1]", "holds [[study]] tables"),
    "infinite samples": (text(samples="inf"), "samples = inf: give a whole number"),
    "samples that no memory has": (
        text(samples="1_000_000_000"),
        "samples = 1000000000: give a whole number from",
    ),
    "half a sample": (text(samples="512.5"), "samples = 512.5: give a whole number"),
    "400 digits": (text(span=LARGE), "give a number"),
    "400 digits of a parameter": (
        text(SYSTEM.format(name="own", H="p_q**2/2 + k*q**4/4", k=LARGE)),
        "too large",
    ),
    "400 digits of a start": (text(start=f"[[{LARGE}, 0]]"), "a start's number = 99"),
    "a start that is no number": (text(start="[[nan, 0.0]]"), "finite numbers"),
    "a billion parts": (
        text(parts="1_000_000_000"),
        "parts = 1000000000: give a whole number from 1 to 100000",
    ),
    "a trillion steps": (text(step="1e-12"), "6e+13 steps, and a case may take 1e+12"),
    "a method in numbers": (text(method="5"), "method=5 is no method"),
    "a billion stages": (text(method="{ gauss = 1000000000 }"), "stages"),
    "a power of ten as a coefficient": (
        text(method='{ splitting = { a = ["1e999999999"], b = [1] } }'),
        "a coefficient is a number",
    ),
    "a system in numbers": (text(system="5"), "system = 5: give the name of a scene"),
    "parameters in numbers": (
        SYSTEM.format(name="own", H="q", k="1").replace("{ k = 1 }", "5") + "[[study]]",
        "is a table of names",
    ),
    "precision in numbers": (text(precision="5"), "precision = 5: give its name"),
    "parameters as a text": (text(parameters='"k"'), "parameters is a table"),
    "arrays in arrays": ("a = " + "[" * 5000, "nested too deeply"),
    "a key of 100 000 parts": (".".join("a" * 100_000) + " = 1", "a key of more than 32 parts, at line 1"),
    "a million cases": (
        text(step=str([0.1] * 1001), start=str([[0.5, 0.0]] * 1000)),
        "more than 100000 cases",
    ),
    "a tower of powers": (text(SYSTEM.format(name="own", H="9**9**9*q", k=1)), "H: "),
    "code": (text(SYSTEM.format(name="own", H="__import__('os')", k=1)), "H: "),
    "a name that commands": (
        text(SYSTEM.format(name="\\u001b[2J", H="q", k=1)),
        "something is called '\\x1b[2J'",
    ),
    "a name of two lines": (text(observables='{ "a\\nb" = "q" }'), "something is called 'a\\nb'"),
    "bytes": (b"\xff\xfe", "can't decode"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_it_is_told_what_is_wrong(tmp_path, what):
    written, told = REFUSED[what]
    with pytest.raises(StudyError) as caught:
        read(tmp_path, written)
    assert told in str(caught.value)
    assert len(str(caught.value)) < 1_500


@pytest.mark.skipif(sys.platform == "win32", reason="a device of POSIX")
def test_a_device_is_no_study(capsys):
    assert main(["study", "run", "/dev/zero"]) == 2
    assert capsys.readouterr().err == "canon study: /dev/zero: it is a device and no file\n"


def test_names_are_no_formulas_in_a_table(tmp_path):
    name = "=cmd|' /C calc'!A0"
    system = SYSTEM.format(name=name, H="p_q**2/2 + k*q**4/4", k="2.0")
    study = read(
        tmp_path, text(system, system=f'"{name}"', observables='{ "@SUM(A1)" = "q**2" }', samples="512")
    )
    store = Store(tmp_path / "study.sqlite")
    run_study(study, store)
    head, row = list(csv.reader(io.StringIO(csv_of(store))))
    assert row[head.index("system")] == f"'{name}"
    assert not [cell for cell in (*head, *row) if cell.startswith(("=", "@", "+"))]
    assert float(row[head.index("slope")]) == rows_of(store)[0]["slope"]


def test_a_file_of_results_that_asks_for_the_impossible_is_refused(tmp_path, capsys):
    case = Study.of(system="henon-heiles", method="verlet", step=0.1, span=60.0).cases[0]
    with pytest.raises(ValueError, match="parts = 0"):
        Case(**{**{name: getattr(case, name) for name in case.__dataclass_fields__}, "parts": 0})
    store = Store(tmp_path / "crafted.sqlite")
    store.add_cases({"k": case.to_text().replace('"parts": null', '"parts": 0')})
    assert main(["study", "status", str(store.path)]) == 2
    assert "these are not the inputs of a case" in capsys.readouterr().err
