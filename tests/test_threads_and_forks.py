"""canon in threads, forked children and interrupted calls: budgets are kept, workers killed by their owners only."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import pytest
import sympy as sp

from canon.exercise.judging_process import Worker
from canon.exercise.sheet.sheet import Claim
from canon.proof.domain.domain import Domain
from canon.proof.worker.budget import _worker, prove_in_worker

ROOT = Path(__file__).parents[1]
x = sp.Symbol("x", real=True)
EASY = sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1


def endless():
    """Return an expression whose proof takes far longer than any budget here."""
    s = sp.symbols("s0:9", real=True)
    return sp.Add(*(sp.sin(sp.Add(*s) * k) * sp.sqrt(sp.Add(*s[:k])) for k in range(1, 9))) ** 9 - 1


def in_a_child(run):
    """Run something in a forked child and return its exit status."""
    pid = os.fork()
    if pid == 0:
        try:
            os._exit(0 if run() else 1)
        except BaseException:  # noqa: BLE001, the child must end whatever happens
            os._exit(2)
    return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])


def proved(answer):
    return not isinstance(answer, str) and answer[0].holds


def test_threads_wait_for_one_another_no_longer_than_their_budgets(processor_seconds):
    assert proved(prove_in_worker([EASY], Domain(), 20.0))
    hard = endless()
    answers, used = [], processor_seconds()

    def ask():
        answers.append(prove_in_worker([hard], Domain(), 1.5))

    threads = [threading.Thread(target=ask) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(answers) == 3
    assert not any(map(proved, answers))
    assert processor_seconds() - used < 3.0  # one after the other it would be 4.5


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_child_has_a_worker_of_its_own_and_leaves_the_parents_alone():
    assert proved(prove_in_worker([EASY], Domain(), 20.0))
    worker = _worker(os.getpid())
    process = worker._child

    def child():
        worker.stop()  # what the exit handlers of a child that ends by sys.exit do
        return proved(prove_in_worker([EASY], Domain(), 20.0))

    assert in_a_child(child) == 0
    assert process.usable
    assert proved(prove_in_worker([EASY], Domain(), 20.0))
    assert worker._child is process


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_child_leaves_the_judge_of_its_parent_alone():
    claim = Claim("a", "equality-only", {"lhs": "1 + 1", "rhs": "2"})
    with Worker() as worker:
        assert worker.judge(claim).status == "holds"
        process = worker._child

        def child():
            worker.stop()
            return True

        assert in_a_child(child) == 0
        assert process.usable
        assert worker.judge(claim).status == "holds"


INTERRUPTED = """
import signal
import time
signal.signal(signal.SIGINT, signal.default_int_handler)  # where the tests run in the background too
import sympy as sp
from canon import Domain, vanishes
from canon.proof.worker.budget import prove_in_worker
from tests_endless import endless
print("ready", flush=True)
start = time.monotonic()
try:
    prove_in_worker([endless()], Domain(), 60.0)
except KeyboardInterrupt:
    print("interrupted", flush=True)
x = sp.Symbol("x", real=True)
print(vanishes(sp.sin(x)**2 + sp.cos(x)**2 - 1).status.value, flush=True)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="interrupts are sent as POSIX does")
def test_an_interrupt_ends_a_proof_and_the_next_one_works(tmp_path, processor_seconds):
    source = Path(__file__).read_text(encoding="utf-8")
    body = source[source.index("def endless") : source.index("def in_a_child")]
    (tmp_path / "tests_endless.py").write_text(f"import sympy as sp\n\n\n{body}", encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(tmp_path)])}
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(INTERRUPTED)],
        stdout=subprocess.PIPE, text=True, env=environment,
    )  # fmt: skip
    assert process.stdout.readline() == "ready\n"
    time.sleep(2.0)
    used = processor_seconds()
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "interrupted\n"
    assert processor_seconds() - used < 2.0
    assert process.stdout.readline() == "holds\n"
    process.stdout.close()
    assert process.wait() == 0
