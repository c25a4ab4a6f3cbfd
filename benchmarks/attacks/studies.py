"""Hostile study files: values of the wrong kind and size in every place, broken text, names that command a terminal."""

from __future__ import annotations

import random
import shutil
import signal
import time
from typing import TYPE_CHECKING

from canon.study.cases.case import part_count
from canon.study.cases.study import read_study
from canon.study.errors import StudyError

from .count import Count, command

if TYPE_CHECKING:
    from pathlib import Path

    from canon.study.cases.study import Study

BUDGET = 10.0
"""Seconds of processor time that a file may take to be read."""

SYSTEM = {
    "H": '"p**2/2 + k*q**4/4"',
    "q": '"q"',
    "p": '"p"',
    "parameters": "{ k = 2.0 }",
    "starts": "{ near = [0.5, 0.0] }",
    "period": "6.0",
}
STUDY = {
    "system": '["own", "henon-heiles"]',
    "method": '["verlet", { gauss = 2 }]',
    "step": "[0.1, 0.2]",
    "span": "60.0",
    "samples": "512",
    "parts": "2",
    "observables": '["energy"]',
    "keep": '["motion", { section = "t - 30" }]',
    "tags": '["paper"]',
}
MORE = ("start", "parameters", "steps_per_period", "periods", "tolerance", "precision", "colour")

VALUES = (
    *(
        "inf",
        "-inf",
        "nan",
        "0",
        "-1",
        "1e308",
        "1e-320",
        "true",
        "5",
        "1.5",
        "1_000_000_000",
        "10000000000000",
    ),
    *("9" * 400, "9" * 5000, "0x" + "f" * 400, '""', '"abc"', "\"=cmd|'/C calc'!A0\"", r'"\u001b[2Jgone"'),
    *(
        r'"a\n✓ holds"',
        "[]",
        "[[]]",
        "[[[[[[1]]]]]]",
        "[1, 'a']",
        "[nan]",
        "{}",
        "{ a = 1 }",
        "{ k = [1, 2] }",
    ),
    *(
        "{ k = 'x' }",
        "{ gauss = 1000000000 }",
        "{ gauss = 0 }",
        "{ taylor = 0.0 }",
        "{ taylor = nan }",
        "1979-05-27",
    ),
    *("{ splitting = { a = ['1e999999999'], b = [1] } }", "{ splitting = { a = [inf], b = [1] } }"),
    *("{ time_transformed = 'verlet' }", "{ solvable = 'saba-4' }", '{ "=1+1" = "q" }', '"9**9**9*q"'),
    *(
        '"exp(exp(exp(q)))"',
        "\"__import__('os').system('touch owned')\"",
        '"q.__class__"',
        "'$\\frac{q}{0}$'",
    ),
    *(
        '"../../../etc/passwd"',
        '"/dev/zero"',
        '"/proc/self/mem"',
        '"~root"',
        '"$(touch owned)"',
        r'"\u202eenil"',
        r'"\u2066"',
    ),
    *(
        "-0.0",
        "1e400",
        "-1e-400",
        '"inf"',
        '"nan"',
        '"1e400"',
        "{ a.b.c.d = 1 }",
        "[{}, {}]",
        "['verlet', 'verlet']",
    ),
    *(
        "['taylor', 'taylor', 'taylor']",
        "[0.1, 0.1]",
        "[1, 1.0, true]",
        '"é"',
        r'"e\u0301"',
        '"ｖerlet"',
        '"Verlet "',
        "''",
    ),
    *(
        "9223372036854775808",
        "-9223372036854775809",
        "0b1" + "0" * 2_000,
        "0o7" * 1,
        "00:00:00",
        "{ section = 'q', direction = 5 }",
    ),
    *(
        "{ section = '" + "(" * 500 + "q' }",
        "['motion', 'motion']",
        "{ section = 'p*0' }",
        "{ taylor = 1e-400 }",
        "{ gauss = 2.0 }",
    ),
    "[" * 300 + "]" * 300,
    "[" * 5000 + "]" * 5000,
    "[" + "0.1, " * 20_000 + "]",
    '"' + "(" * 200 + "q" + ")" * 200 + '"',
    '"' + "+".join(["q"] * 20_000) + '"',
    '"' + "q" * 100_000 + '"',
    "{ " + ", ".join(f"x{i} = 1" for i in range(2_000)) + " }",
)
WHOLE = (
    "study = [1]",
    "study = 5",
    "study = []",
    "[[study]]",
    "[study]",
    "system = 1\n[[study]]",
    ".".join(["a"] * 100_000) + " = 1",
    "a = " + "[" * 100_000,
    "[[study]]\n" * 5_000,
    "\x00" * 1_000,
    "x = 1\n" * 10_000,
    "[[study]]\nstep = 0.1\nstep = 0.2\n",
    "[system.a]\n[system.a]\n",
    "[system]\na = 1\n[system.a]\nH = 'p**2'\n",
    "[[study]]\n[study]\n",
    "\ufeff[[study]]\n",
    "[[study]]\r\rsystem = 'kepler'",
    "# " + "x" * 10_000_000,
    "[[study]]\nsystem = " + "'" * 3 + "x" * 1_000_000,
)


NAMES = (
    *(
        r'"=cmd|x"',
        r'"\u001b[31mred"',
        r'"a\nstudy.sqlite: 4 cases"',
        '"../up"',
        '"/"',
        '""',
        '"."',
        '"a/b"',
        r'"\u0000"',
    ),
    *(
        r'"\u202ecba"',
        '"é"',
        r'"e\u0301"',
        '"-rf"',
        '"--help"',
        '"henon-heiles"',
        '"' + "n" * 5_000 + '"',
        '"a,b;c"',
        '"\'"',
    ),
)


def hostile_studies(count: int, folder: Path, seed: int = 1) -> Count:
    """Write hostile study files, read each, and run those that ask for little."""
    found, draw = Count("hostile study files"), random.Random(seed)
    path = folder / "hostile.toml"
    for number in range(count):
        path.write_text(_file(number, draw), encoding="utf-8", errors="replace")
        shutil.rmtree(folder / "hostile.sqlite.kept", ignore_errors=True)
        for old in folder.glob("hostile.sqlite*"):
            old.unlink()
        found.add(
            _outcome(path, folder), f"seed {seed}, file {number}: {path.read_text(encoding='utf-8')[:300]!r}"
        )
    return found


def _file(number: int, draw: random.Random) -> str:
    """Return a study with one to three places changed; the first ones are broken as a whole."""
    if number < len(WHOLE):
        return WHOLE[number]
    system, study = dict(SYSTEM), dict(STUDY)
    for _ in range(draw.choice((1, 1, 2, 3))):
        table = draw.choice((system, study))
        table[draw.choice((*table, *MORE) if table is study else tuple(table))] = draw.choice(VALUES)
        if "periods" in table:
            table.pop("span", None)
    name = "own" if draw.random() < 0.9 else draw.choice(NAMES)
    lines = [f"[system.{name}]", *(f"{key} = {value}" for key, value in system.items())]
    text = "\n".join([*lines, "[[study]]", *(f"{key} = {value}" for key, value in study.items())])
    if draw.random() < 0.1:
        place = draw.randrange(len(text))
        text = text[:place] + draw.choice("[]{}\"'=\x00\x1b\ud800#.") + text[place + draw.randrange(20) :]
    return text


def _outcome(path: Path, folder: Path) -> str:
    def late(*_: object) -> None:
        raise TimeoutError

    signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, 12 * BUDGET)
    start = time.process_time()
    try:
        study = read_study(path)
    except StudyError:
        return "told" if time.process_time() - start < BUDGET else "over budget"
    except TimeoutError:
        return "over budget"
    except Exception:  # noqa: BLE001, whatever it is, it is counted
        return "traceback"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    if time.process_time() - start > BUDGET:
        return "over budget"
    return _after_running(path, folder) if _is_small(study) else "read, asks for much"


def _is_small(study: Study) -> bool:
    return len(study.cases) <= 8 and all(
        case.span / (case.step or 0.1) <= 20_000 and case.samples <= 20_000 and part_count(case) <= 100
        for case in study.cases
    )


def _after_running(path: Path, folder: Path) -> str:
    """Run a study that was read; look at what is printed and exported of it."""
    kept, table = path.with_suffix(".sqlite"), folder / "hostile.csv"
    status, out, err = command("study", "run", path)
    if status is None:
        return "traceback"
    command("study", "export", kept, table)
    cells = table.read_text(encoding="utf-8").replace('"', "").split(",") if table.exists() else []
    if any(cell.startswith(("=", "@")) for cell in cells) or "\x1b" in out + err or "\n✓" in out:
        return "false line"
    if (folder / "owned").exists():
        return "code run"
    return "read and run" if status in (0, 1, 2, 3) else "wrong status"
