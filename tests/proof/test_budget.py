"""The time limit holds, the worker is reused, an interrupt gets through."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest
import sympy as sp

from canon.process import Child
from canon.proof import vanishes
from canon.proof.domain.domain import EVERYWHERE
from canon.proof.worker import budget as budget_
from canon.proof.worker.budget import prove_in_worker, seconds_in_worker

x, y, z, t, u, v = sp.symbols("x y z t u v", real=True)


def heavy_and_true():
    """An identity that only expansion of very many terms proves."""
    s = 1 + x + y + z + t + u + v
    return (s**9 + x) * (s**9 - x) - s**18 + x**2 + (s**20 + y) ** 2 - s**40 - 2 * y * s**20 - y**2


@pytest.mark.parametrize("budget", [0.4, 1.5])
def test_budget_is_kept(budget, processor_seconds):
    def spent():
        prove_in_worker([x - x], EVERYWHERE, 10.0)
        used = processor_seconds()
        verdict = vanishes(heavy_and_true(), budget=budget)
        assert verdict.undecided
        assert verdict.evidence
        return processor_seconds() - used

    # A core that is shared makes seconds longer, never shorter: the best of three counts.
    assert any(spent() < budget + 0.5 for _ in range(3))


def test_worker_proves_and_is_reused(processor_seconds):
    proved = prove_in_worker([sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1, x], EVERYWHERE, 10.0)
    assert [attempt.holds for attempt in proved] == [True, False]
    used = processor_seconds()
    for _ in range(10):
        prove_in_worker([sp.cos(2 * x) - 1 + 2 * sp.sin(x) ** 2], EVERYWHERE, 10.0)
    assert processor_seconds() - used < 1.0


def test_worker_comes_back_after_being_killed():
    assert isinstance(prove_in_worker([heavy_and_true()], EVERYWHERE, 0.5), str | list)
    assert prove_in_worker([sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1], EVERYWHERE, 20.0)[0].holds


PROGRAM = """
import sympy as sp
from canon.proof.worker.budget import prove_in_worker
from canon.proof.domain.domain import EVERYWHERE
x = sp.Symbol("x", real=True)
print(prove_in_worker([sp.sin(x)**2 + sp.cos(x)**2 - 1], EVERYWHERE, 30.0)[0].holds)
"""


def test_works_from_standard_input():
    done = subprocess.run(
        [sys.executable, "-"], input=PROGRAM, capture_output=True, text=True, env=_environment()
    )
    assert done.stdout.strip() == "True", done.stderr


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_interrupt_gets_through(processor_seconds):
    program = textwrap.dedent("""
        import signal
        import sympy as sp
        signal.signal(signal.SIGINT, signal.default_int_handler)  # where the tests run in the background too
        from canon.proof.worker.budget import prove_in_worker
        from canon.proof.domain.domain import EVERYWHERE
        names = sp.symbols("x y z t u v", real=True)
        s = 1 + sum(names)
        print(prove_in_worker([sp.Symbol("x") - 1], EVERYWHERE, 30.0)[0].holds, flush=True)
        while True:
            prove_in_worker([(s**20 + names[0])**2 - s**40], EVERYWHERE, 60.0)
    """)
    running = subprocess.Popen(
        [sys.executable, "-c", program],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=_environment(),
    )
    with running:
        assert running.stdout.readline().strip() == "False"
        time.sleep(0.3)
        used = processor_seconds()
        running.send_signal(signal.SIGINT)
        _, errors = running.communicate()
    assert processor_seconds() - used < 2.0
    assert "KeyboardInterrupt" in errors


def _environment():
    return {**os.environ, "PYTHONPATH": os.pathsep.join(entry or str(Path.cwd()) for entry in sys.path)}


OPEN = sp.Matrix([sp.besselj(0, x) - sp.besselj(1, x), sp.besselj(0, y) - sp.besselj(1, y)])


def test_a_proof_waits_for_that_of_another_thread_no_longer_than_it_may():
    worker = budget_._worker(os.getpid())
    with worker._lock:
        said = prove_in_worker([x - x], EVERYWHERE, 0.1)
        assert said == "another thread's proof took the 0.1 s"
        assert vanishes(OPEN, budget=0.3).undecided
    assert prove_in_worker([x - x], EVERYWHERE, 20.0)[0].holds


def test_where_no_system_tells_the_seconds_of_a_process_those_of_waiting_count(monkeypatch):
    prove_in_worker([x - x], EVERYWHERE, 20.0)
    monkeypatch.setattr(Child, "processor_seconds", None)
    before = seconds_in_worker()
    assert prove_in_worker([sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1], EVERYWHERE, 20.0)[0].holds
    assert seconds_in_worker() > before
