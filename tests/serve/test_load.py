"""The service under load: every claim has its answer, hostile ones run nothing, killed processes are replaced."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="the extra 'serve' is not installed")
sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from attacks import service
from attacks.count import BAD

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not sys.platform.startswith("linux"), reason="processes are found as Linux lists them"
    ),
]


def test_sixty_four_clients_are_answered_while_processes_are_killed(tmp_path, monkeypatch):
    """What benchmarks/robustness.py counts for 10 000 claims, for fewer."""
    monkeypatch.setattr(service, "KILLED_EVERY", 60)
    found = service.served_load(700, tmp_path)
    assert found.bad == 0, str(found)
    assert found.outcomes.total() == 701
    assert sum(found.outcomes[status] for status in ("holds", "fails")) >= 600
    assert any("hostile" in outcome for outcome in found.outcomes)


@pytest.mark.parametrize("status", ["holds", "lost"])
def test_the_count_would_notice(monkeypatch, status):
    """The check itself: an answer of the wrong kind, and none at all, are counted as what went wrong."""

    async def ask(self, number, claim):
        if status == "lost":
            raise ConnectionResetError
        return status

    monkeypatch.setattr(service._Load, "_ask", ask)
    load = service._Load(service.Count("none"), 0, 0, service.random.Random(1))
    outcomes = {service.asyncio.run(load._outcome(0, {}, wanted)) for wanted in ("holds", "fails", "hostile")}
    assert outcomes == ({"lost"} if status == "lost" else {"holds", "wrong status"})
    assert {"lost", "wrong status"} <= set(BAD)
