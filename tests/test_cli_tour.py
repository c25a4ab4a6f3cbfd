"""``canon tour``, the main job, from end to end; and what the README says of it."""

import re
from pathlib import Path

import pytest

from canon.cli import main
from canon.exercise.sheet.sheet import bundled_sheet

README = Path(__file__).parents[1] / "README.md"
TOUR = README.read_text(encoding="utf-8").partition("## Six more commands")[0]
VERDICT = re.compile(r"^[✓✗] (holds|fails)\s+(\S+)", re.MULTILINE)


@pytest.fixture(scope="module")
def tour(tmp_path_factory, processor_seconds):
    import contextlib
    import io

    figure = tmp_path_factory.mktemp("tour") / "tour.png"
    printed = io.StringIO()
    used = processor_seconds()
    with contextlib.redirect_stdout(printed):
        status = main(["tour", "--plot", str(figure)])
    return status, printed.getvalue(), figure, processor_seconds() - used


def test_every_answer_is_judged_as_its_author_expects(tour):
    status, printed, _, _ = tour
    assert status == 0
    expected = {claim.id: claim.expect for claim in bundled_sheet("tour").claims}
    assert {name: verdict for verdict, name in VERDICT.findall(printed)} == expected
    assert {"holds", "fails"} == set(expected.values())


def test_the_missing_factor_of_the_oscillators_F1_is_named(tour):
    lines = tour[1].splitlines()
    place = next(i for i, line in enumerate(lines) if "oscillator-F1" in line)
    assert "half" in lines[place + 1]


def test_the_methods_are_told_apart(tour):
    row = r"^(kahan-li-8|verlet|RK4|Taylor) .*?(bounded|secular|round-off)"
    verdicts = dict(re.findall(row, tour[1], re.MULTILINE))
    assert verdicts == {"kahan-li-8": "bounded", "verlet": "bounded", "RK4": "secular", "Taylor": "round-off"}


def test_a_figure_is_written_and_time_is_kept(tour):
    assert tour[2].read_bytes().startswith(b"\x89PNG")
    assert tour[3] < 30.0


def test_the_readme_shows_what_the_tour_prints(tour):
    shown = {name: verdict for verdict, name in VERDICT.findall(TOUR)}
    printed = {name: verdict for verdict, name in VERDICT.findall(tour[1])}
    assert shown
    assert shown.items() <= printed.items()
    for line in re.findall(r"^    (?:in|F) .*$", TOUR, re.MULTILINE):
        assert line in tour[1]


def test_the_readme_shows_the_table_of_the_tour(tour):
    """The fixed-step runs hold no library function, so their figures are the same on every machine."""
    shown = re.findall(r"^(?:kahan-li-8|verlet|RK4) .*$", TOUR, re.MULTILINE)
    assert len(shown) == 3
    for row in shown:
        assert row.rstrip() in tour[1]
