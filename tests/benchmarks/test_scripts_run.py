"""Benchmarks that no other test runs a part of: they go through, and the page reads its tables from what they print."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))

from measured_page import section_of  # noqa: E402  (found through the line above)

SHORT = {
    "operations": ["--peer", "5"],
    "minimal": [],
    "import_cost": [],
    "sections": [],
    "preparation": [],
    "constraints": [],
    "nonholonomic": [],
    "rotations": [],
    "classroom": [],
    "drift_calibration": ["20"],
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SHORT)
def test_a_benchmark_prints_what_the_page_shows(name):
    done = subprocess.run(
        [sys.executable, str(BENCHMARKS / f"{name}.py"), *SHORT[name]],
        capture_output=True, text=True, cwd=BENCHMARKS.parent, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    assert all(table.rows(done.stdout) for table in section_of(name).tables)
