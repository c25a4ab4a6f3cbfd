"""The table of benchmarks/headline.py hides nothing, and is what is stored; the page says the same numbers."""

import json
import sys
from pathlib import Path

import pytest

HOME = Path(__file__).parents[2]
sys.path.insert(0, str(HOME / "benchmarks"))

import headline  # noqa: E402  (found through the line above)

STORED = json.loads(headline.STORED.read_text(encoding="utf-8"))


def row(error, span, law):
    return {"name": "some method", "span": span, "error": [error], "cpu": 1.0, "law": law}


@pytest.mark.parametrize(
    ("span", "law", "told"), [(1e7, 1.0, "3e+01"), (1e4, 1.0, "3e+04"), (1e5, 0.5, "3e+02")]
)
def test_an_error_above_one_is_told_as_it_is(span, law, told):
    line = headline.table(headline.PROBLEMS["kepler"], [row(28.0, span, law)])[-1]
    assert line.split()[5] == told
    assert line.endswith("extrapolated") == (span < 1e7)


def test_the_printed_table_is_that_of_the_stored_runs():
    lines = []
    for name, problem in headline.PROBLEMS.items():
        lines += [STORED[f"{name} run"], *headline.table(problem, STORED[name])]
    printed = "\n".join(lines) + "\n"
    assert headline.STORED.with_suffix(".txt").read_text(encoding="utf-8") == printed
    assert printed in (HOME / "docs" / "measured.md").read_text(encoding="utf-8")


def test_the_page_tells_the_stored_numbers():
    page = (HOME / "docs" / "explanation" / "headline.md").read_text(encoding="utf-8")
    last = {(p, each["name"]): each["error"][-1] for p in headline.PROBLEMS for each in STORED[p]}
    ellipse, planets = last["kepler", "Verlet, 250.3 steps"], last["planets", "Verlet, 100.3 steps"]
    assert (f"{ellipse:.0e}", f"{planets:.0e}") == ("8e-04", "8e-05")
    assert "8·10⁻⁴ on the ellipse and 8·10⁻⁵ among the planets" in page
    assert f"wrong by {last['kepler', 'RK4, 250.3 steps']:.0f} times itself" in page


def test_every_method_has_lost_some_place_on_the_ellipse():
    places = {each["name"]: each["place"] for each in STORED["kepler"]}
    assert list(places) == [case.name for case in headline.KEPLER]
    assert all(place > 0.0 for place in places.values())


def test_the_place_lost_is_that_of_a_run():
    """Of the cheapest method whose loss is its own and not that of round-off."""
    (number,) = (k for k, case in enumerate(headline.KEPLER) if "logarithmic" in case.name)
    found = headline.lost_place(headline.KEPLER[number])
    assert found == pytest.approx(STORED["kepler"][number]["place"], rel=1e-6)


def test_keeping_the_energy_is_not_keeping_the_place():
    (late,) = (each for each in STORED["kepler"] if "logarithmic" in each["name"])
    assert late["error"][-1] < 1e-11
    assert late["place"] > 0.5
