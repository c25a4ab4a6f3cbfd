"""The examples: each script runs, is a page long, and ends in the result that a reader can check."""

from __future__ import annotations

import re
import runpy
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

EXAMPLES = Path(__file__).parents[1] / "examples"
GALLERY = sorted(path for path in EXAMPLES.glob("*/*.py") if path.parent.name not in ("grading", "sheets"))
A_PAGE = 60
LONGEST = 30.0
"""Seconds of a processor that a script may take, its processes included."""
RESULTS = {
    "derive/double_pendulum": r"period: 2.62 s by the formula, 2.62 s on the motion",
    "derive/quasi_velocities": r"energy 1.000001, changed by at most \de-1[3-6]",
    "derive/symmetry_and_integral": r"\{P_x, P_y\} = -m\*omega holds",
    "derive/tension_of_a_rod": r"tension at the lowest point: 3\*g\*m = 3 times the weight",
    "derive/two_roads_to_a_wheel": r"s̈ = 2\*g\*sin\(alpha\)/3 = 2/3 of g sin α",
    "transform/angle_and_action": r"K / P = omega",
    "transform/is_a_step_canonical": r"after 120 steps:  Verlet 0.729\d+, Heun 1.46\d+",
    "transform/map_from_its_function": r"trace at the fixed point: 2 - k  as it should be: holds",
    "transform/rotating_frame": r"holds\nFAILS",
    "reduce/frequency_of_an_amplitude": r"T/T₀ at 0.1 rad: 1.00062536 on a motion, 1.00062536 by",
    "reduce/heavy_top": r"it stands from p = 2\*sqrt\(A\)\*sqrt\(g\)\*sqrt\(h\)\*sqrt\(m\)",
    "reduce/separate_and_find_actions": r"ω_u: 2.57[78] counted, 2.577698442724 by the torus",
    "reduce/shaken_pivot": r"b = 35: farthest from the top 0.30 rad",
    "reduce/spherical_pendulum": r"turns at θ = 0.17 by the potential, 0.17 on the motion",
    "judge/a_class": r"12 of 22 points, 1 asked again",
    "judge/one_answer": r"ben: 1.0 points, wrong",
    "judge/where_a_formula_fails": r"fails  √\(x²\) = x .*\n.*\n.*\nfails  \(eˣ\)² = e\^\(x²\)",
    "integrate/a_body_turns_over": r"every 54.0652 s, by Jacobi's functions 54.0652 s\n.*\n.*off by at most \de-1[567]",
    "integrate/bead_leaves_the_hoop": r"leaves at y = 0.666680258240, by hand 0.666680258240",
    "integrate/soliton_in_a_long_chain": r"2167 sites far; the places are wrong by \de-0[789], the energy by \de-1\d",
    "integrate/falling_chain": r"kept to \de-1[0-3]\nthe end is 0.95 m below after 0.8[89] of a stone's time",
    "integrate/kepler_three_ways": r"TimeTransformed +\d.\de-1[4-6] +\d.\de-1[3-5]",
    "integrate/magnetic_mirror": r"boris-2 .* by [-+][1-9]e-0[678], 159 turns at B = 1.995, E/mu = 1.995",
    "integrate/outer_planets": r"energy error at most [2-5].\de-09: (wandering|bounded)",
    "integrate/rolling_disc": r"φ̇ at the end 6.333333333, by hand 6.333333333",
    "integrate/section_of_henon_heiles": r"energy off by at most \de-1[3-6]",
    "measure/does_it_drift": r"RK4         secular    a drift above \de-0[89]",
    "measure/is_the_computed_flow_symplectic": r"verlet +symplectic to \de-1[5-7]",
    "measure/let_canon_choose": r"found [1-9].\de-1[0-9], wanted 1e-09",
    "measure/round_off_walks": r"(1.[7-9]\d|2.[0-3]\d) times \(a walk: 2\)",
    "measure/what_a_digit_costs": r"kahan-li-8  order [78].\d, should be 8",
    "explore/a_cloud_of_starts": r"order 5: symplectic to \de-1[3-6], right to 1e-3 within 3e-03",
    "explore/a_ready_scene": r"energy off by at most \de-1[3-6]",
    "explore/a_study_of_steps": r"27 cases: 27 finished, 0 failed, 0 pending$",
    "explore/halo_orbits": r"period 3.4155308066, in the catalogue 3.4155308066\n26 orbits: all",
    "explore/two_neighbours_part": r"exponent 0.\d\d/s: an error grows tenfold",
    "explore/where_do_orbits_go": r"turned over with the momenta 2.01 2.1 2.5",
    "bring_your_own/a_measured_potential": r"stretched to 1.1: period 2.38\d\d",
    "bring_your_own/from_heyoka": r"quad +max \|ΔE/E\| = \de-3[1-3]",
    "bring_your_own/from_solve_ivp": r"canon +constant off by \de-1[4-6]",
    "bring_your_own/from_sympy_mechanics": r"they differ by (0.0|\d(\.\d+)?e-1[3-6])",
}
"""What each prints in the end: by hand, by a second route or from a book, see the scripts."""
QUICK = (
    "bring_your_own/from_solve_ivp",
    "derive/two_roads_to_a_wheel",
    "integrate/bead_leaves_the_hoop",
    "integrate/rolling_disc",
    "judge/where_a_formula_fails",
    "reduce/spherical_pendulum",
)
"""Half a second each at most; the others are run by ``pytest -m slow``."""


def name_of(path: Path) -> str:
    return path.relative_to(EXAMPLES).with_suffix("").as_posix()


def parameter(path: Path) -> object:
    slow = () if name_of(path) in QUICK else pytest.mark.slow
    return pytest.param(path, id=name_of(path), marks=slow)


def test_every_script_has_a_result():
    assert sorted(map(name_of, GALLERY)) == sorted(RESULTS)
    assert len(GALLERY) >= 24


@pytest.mark.parametrize("path", [parameter(path) for path in GALLERY])
def test_example(
    path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    processor_seconds: Callable[[], float],
) -> None:
    plt = pytest.importorskip("matplotlib.pyplot")
    plt.switch_backend("agg")
    monkeypatch.chdir(path.parent)
    used = processor_seconds()
    try:
        runpy.run_path(str(path), run_name="__main__")
    finally:
        plt.close("all")
    assert processor_seconds() - used < LONGEST
    printed = capsys.readouterr().out
    assert re.search(RESULTS[name_of(path)], printed.rstrip()), printed


@pytest.mark.parametrize("path", GALLERY, ids=name_of)
def test_a_script_is_a_page_with_a_title(path):
    text = path.read_text("utf-8")
    assert len(text.splitlines()) <= A_PAGE
    assert re.match(r'r?"""\n(.+)\n=+\n\n', text), "sphinx-gallery takes the title from the docstring"
    assert "/tmp" not in text
    assert "canon._" not in text
