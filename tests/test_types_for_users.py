"""A user's program has canon's types: pyright tells each wrong line of one, and none of its right twin.

``.ci/wheel`` asks mypy too, of the wheel in an environment of its own.
"""

import json
import subprocess
import sys
from pathlib import Path

import pytest

TYPED = Path(__file__).parent / "data" / "typed"


def lines_told(name, folder):
    """Return the lines of which pyright tells an error, where canon is found as users find it."""
    settings = {"extraPaths": [str(TYPED.parents[2])], "include": [str(TYPED / name)]}
    (folder / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "basedpyright", "--level", "error", "--outputjson", "--project", str(folder)],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    return {each["range"]["start"]["line"] + 1 for each in json.loads(done.stdout)["generalDiagnostics"]}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["right.py", "wrong.py"])
def test_pyright_tells_what_is_marked_and_nothing_else(name, tmp_path):
    text = (TYPED / name).read_text(encoding="utf-8").splitlines()
    marked = {number for number, line in enumerate(text, 1) if line.endswith("# wrong")}
    assert len(marked) == (3 if name == "wrong.py" else 0)
    assert lines_told(name, tmp_path) == marked
