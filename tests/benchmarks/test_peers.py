"""The benchmarks beside other libraries run with tiny numbers; what is not installed is left out of them."""

import sys
from pathlib import Path

import numpy as np
import pytest

HOME = Path(__file__).parents[2]
sys.path.insert(0, str(HOME / "benchmarks"))

import peer_libraries  # noqa: E402  (found through the line above)
import peer_problems  # noqa: E402
import peers  # noqa: E402
import peers_ensembles  # noqa: E402
import peers_losing  # noqa: E402


def test_both_times_of_every_contender_are_told(monkeypatch):
    monkeypatch.setattr(peers, "ACCURACIES", (1e-2,))
    monkeypatch.setattr(peers, "INSTANTS", 20)
    monkeypatch.setattr(peers, "TURNS", 1)
    monkeypatch.setattr(peer_problems, "TURNS", 1)
    monkeypatch.setattr(peers, "LIBRARIES", {"heyoka": peer_libraries.LIBRARIES["heyoka"]})
    title, *rows, ratio = peers.compare(("Hénon–Heiles", "henon-heiles", 0, 4))
    assert title == "Hénon–Heiles, max |ΔE/E| ≤ 1e-02"
    assert {row.split()[0] for row in rows} == {"canon", "heyoka"}
    for row in rows:
        loop, whole = (
            float(words.split()[-1]) for words in row.replace(" the whole call", "").split(" µs a period, ")
        )
        assert 0.0 < loop <= whole
    assert ratio.startswith("    canon ")
    assert ratio.endswith("by the whole call")


def test_ensembles_run_beside_heyoka_and_keep_the_accuracy(monkeypatch):
    monkeypatch.setattr(peers_ensembles, "TURNS", 1)
    monkeypatch.setattr(peers_ensembles, "METHODS", {"canon": first_of(peers_ensembles.canon_methods)})
    title, row = peers_ensembles.compare(("Hénon–Heiles", "henon-heiles", 0, 8, 5), 8)
    assert title == "Hénon–Heiles, 8 orbits, max |ΔE/E| ≤ 1e-08"
    assert float(row.split()[3]) <= 1e-8


def first_of(methods):
    return lambda problem: [next(methods(problem))]


def test_heyokas_ways_find_the_same_ends():
    problem = peer_problems.Problem("Hénon–Heiles", "henon-heiles", 0, 4, 2)
    starts = peers_ensembles.starts_of(problem, 16)
    ends = [
        run(1e-12, starts, 1)[1]
        for name, _, run in peers_ensembles.heyoka_methods(problem)
        if "8" not in name
    ]
    _, _, ours = next(iter(peers_ensembles.canon_methods(problem)))
    for end in ends:
        assert end.shape == (4, 2, 16)
        assert abs(end - ours(200, starts, 1)[1]).max() < 1e-10


def test_starts_lie_on_one_energy():
    problem = peer_problems.Problem("Hénon–Heiles", "henon-heiles", 0, 4, 2)
    assert problem.energy(*peers_ensembles.starts_of(problem, 100)) == pytest.approx(1 / 12)


@pytest.mark.parametrize(
    ("problem", "settings"),
    [
        (lambda: peers_losing.stiff(), {"canon Gauss(3, newton)": 400, "canon verlet": 62832}),
        (lambda: peers_losing.large(70, 0.1), {"canon verlet": 50, "canon blanes-moan-4": 20}),
        (lambda: peers_losing.encounters(1), {"canon Taylor": 1e-12}),
    ],
    ids=["stiff", "large", "encounters"],
)
def test_problems_canon_is_not_made_for_are_solved_all_the_same(problem, settings, monkeypatch):
    monkeypatch.setattr(peers_losing.importlib.util, "find_spec", lambda name: None)
    posed = problem()
    by_name = {contender.name: contender for contender in posed.contenders}
    for name, setting in settings.items():
        _, found = by_name[name].run(setting)
        assert posed.error(found) < 1e-5
        assert posed.error(found * 1.01) > 1e-4


def test_a_row_says_who_wins(monkeypatch):
    state = np.zeros(1)
    cheap, dear = (
        peers_losing.Contender(name, [1.0], lambda _, cost=cost: (cost, state))
        for name, cost in (("canon Taylor", 2.0), ("rebound ias15", 1.0))
    )
    posed = peers_losing.Problem("none", (1e-3,), lambda _: 0.0, [cheap, dear])
    monkeypatch.setattr(peers_losing, "timed", lambda call: (call()[0], call()))
    *_, verdict = peers_losing.compare(posed, 1.0)
    assert verdict == "    canon 2 × the cheapest other, 2 × by the whole call: canon loses"


def test_problems_measured_anew_take_the_place_of_the_old():
    before = ["here, June", "a", "    1", "    2", "b", "    3"]
    once = peer_problems.exchanged(before, ["there, July", "b", "    4", "c", "    5"])
    assert once == ["here, June", "there, July: b, c", "a", "    1", "    2", "b", "    4", "c", "    5"]
    again = peer_problems.exchanged(once, ["there, August", "b", "    6", "c", "    7"])
    assert again == ["here, June", "there, August: b, c", "a", "    1", "    2", "b", "    6", "c", "    7"]
    rest = peer_problems.exchanged(again, ["there, May", "a", "    8"])
    assert rest[:2] == ["there, August: b, c", "there, May: a"]  # of the first run nothing is left
    assert peer_problems.exchanged([], before) == before
