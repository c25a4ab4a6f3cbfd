"""Lagrangians with forces and constraints in the tables of study files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from canon import (
    ConstrainedLagrangian,
    Lagrangian,
    coordinates,
    parameters,
    propagate,
    read_study,
    results_of,
    run_study,
)
from canon.expression.parse import Scope, parse_expression
from canon.study.errors import StudyError
from canon.study.motion.system_table import system_from
from canon.study.motion.system_text import SystemText, system_in

if TYPE_CHECKING:
    from pathlib import Path

DAMPED: dict[str, Any] = {
    "L": "m*l**2*th_dot**2/2 + m*g*l*cos(th)",
    "q": "th",
    "forces": ["cos(2*t)"],
    "dissipation": "c*th'**2/2",
    "parameters": {"m": 1, "l": 1, "g": 9.81, "c": 0.3},
    "starts": {"high": [1.0, 0.0]},
    "period": 2.0,
}

FILE = """
[system.damped]
L = "m*l**2*th_dot**2/2 + m*g*l*cos(th)"
q = "th"
forces = "cos(2*t)"
dissipation = "c*th'**2/2"
parameters = { m = 1, l = 1, g = 9.81, c = 0.3 }
starts = { high = [1.0, 0.0] }
period = 2.0

[system.wire]
L = "(x_dot**2 + y_dot**2)/2 - 9.81*y"
q = ["x", "y"]
holonomic = ["y - x**2"]
starts = { side = [1, 1, 0, 0] }
period = 2

[[study]]
system = ["damped", "wire"]
method = ["taylor", "RK4"]
steps_per_period = 200
periods = 5
"""


def test_a_table_is_the_lagrangian_that_one_writes_in_python() -> None:
    found = system_from("damped", DAMPED)
    assert isinstance(found, SystemText)
    th, names = coordinates("th"), DAMPED["parameters"]
    scope = Scope({"th": th, **dict(zip(names, parameters(" ".join(names)), strict=True))})
    by_hand = Lagrangian(
        parse_expression(DAMPED["L"], scope), [th], [parse_expression("cos(2*t) - c*th'", scope)]
    )
    assert system_in(found) == by_hand
    twin = system_from("damped", DAMPED | {"dissipation": "-c*th'**2/2"})
    assert isinstance(twin, SystemText)
    assert system_in(twin) != by_hand


def test_rolling_without_slipping_is_kept() -> None:
    table = {
        "L": "(x_dot**2 + y_dot**2 + h_dot**2)/2",
        "q": "x y h",
        "nonholonomic": "x_dot*sin(h) - y_dot*cos(h)",
        "starts": {"one": [0, 0, 0, 1, 0, 1]},
    }
    found = system_from("blade", table)
    assert isinstance(found, SystemText)
    blade = system_in(found)
    assert isinstance(blade, ConstrainedLagrangian)
    motion = propagate(blade, (0, 5), found.starts[0][1])
    assert np.abs(motion["x"] - np.sin(motion.t)).max() < 1e-12  # a circle


def test_a_study_file_runs_them(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(FILE)
    study = read_study(tmp_path / "study.toml")
    run_study(study, tmp_path / "study.sqlite")
    results = results_of(tmp_path / "study.sqlite")
    assert len(list(results.rows)) == 4
    assert {case.system.name for case in study.cases} == {"damped", "wire"}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"H": "1"}, "unknown key 'H'"),
        ({"forces": ["1", "2"]}, "system damped: "),
        ({"L": "th_ddot**2"}, "accelerations"),
        ({"L": "th_dot**2 + u"}, "system damped, L: "),
        ({"forces": ["__import__('os')"]}, "system damped, forces: "),
        ({"L": 3}, "L is text"),
        ({"q": 3}, "system damped: "),
        ({"starts": {"one": [1.0]}}, "2 finite numbers"),
        ({"starts": {"one": 1.0}}, "a start is a list"),
        ({"parameters": {"m": "x"}}, "is no number"),
        ({"period": -1}, "period"),
        ({"nonholonomic": ["th_dot**2"]}, "affine"),
        ({"holonomic": ["th_dot"]}, "holds velocities"),
        ({"dissipation": ["c"]}, "dissipation is text"),
    ],
)
def test_what_is_wrong_in_a_table_is_told(change: dict[str, Any], said: str) -> None:
    with pytest.raises(StudyError, match=said):
        system_from("damped", DAMPED | change)


def test_a_lagrangian_needs_its_coordinates() -> None:
    with pytest.raises(StudyError, match="'q' is missing"):
        system_from("bare", {"L": "1"})
    with pytest.raises(StudyError, match="'L' is missing"):
        system_from("bare", {"q": "x", "forces": ["1"]})
