"""Diagnoses on trial: answers with a known slip, of which most are named and none is explained by what is not so."""

import os
import signal
import subprocess
import sys
import threading
import time
from itertools import islice
from os import cpu_count

import pytest

from canon.exercise.claim_verdict import examine
from canon.exercise.diagnose.change import Mistake
from canon.exercise.diagnose.diagnosis import judged_to_hold
from canon.exercise.diagnose.diagnosis_search import diagnosis
from canon.exercise.diagnose.effort import Effort
from canon.exercise.judging_process import Worker
from canon.exercise.report.sentences import feedback
from canon.exercise.sheet.sheet import Claim, claim_from
from tests.exercise.slips_of_students import KINDS, is_named, of_a_question, questions, wrong_answers

SAMPLE = 24
NAMED = 0.85
"""Share of the slips that are named at least, in either half; benchmarks/feedback.py prints the table."""


def named(answers):
    """Return of how many answers the slip is named, and of how many; every repair is judged to hold."""
    results = []
    for answer in answers:
        found = diagnosis(answer.finding)
        if found is not None and found.repaired is not None:
            assert judged_to_hold(found.repaired, Effort(60.0)), answer.claim.id
        results.append(is_named(answer, found))
    return sum(results), len(results)


def test_most_slips_of_a_sample_are_named():
    some = islice(wrong_answers("open", each=1), SAMPLE)
    right, asked = named(some)
    assert asked == SAMPLE
    assert right >= NAMED * asked


@pytest.mark.slow
@pytest.mark.parametrize("half", ["open", "closed"])
def test_most_slips_are_named(half):
    right, asked = named(wrong_answers(half, each=3))
    assert asked >= 250
    assert right >= NAMED * asked


@pytest.mark.slow
def test_the_corpus_is_large():
    assert sum(1 for half in ("open", "closed") for _ in wrong_answers(half)) >= 1000
    assert len({question.keys["kind"] for question in questions()}) >= 25
    assert {question.keys["kind"] for question in questions()} <= set(KINDS)


ROTATING = {"kind": "euler-lagrange", "q": ["r", "phi"], "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r",
            "parameters": {"m": "positive", "k": "positive", "r": "positive"}}  # fmt: skip
BEAD = {"kind": "multiplier-holonomic", "q": ["r", "theta"], "parameters": {"m": "positive", "g": "positive",
        "l": "positive", "r": "positive"}, "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 + m*g*r*cos(theta)",
        "constraints": ["r - l"], "multipliers": ["lam"]}  # fmt: skip
PENDULUM = {"kind": "euler-lagrange", "q": ["theta"], "parameters": {"m": "positive", "g": "positive", "l": "positive"},
            "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"}  # fmt: skip

HOOP = {"kind": "legendre-hamiltonian", "q": ["theta"], "p": ["p"], "parameters": {"m": "positive", "g": "positive"},
        "L": "m*theta_dot**2*(1 + cos(theta)**2)/2 + m*g*cos(theta)"}  # fmt: skip


@pytest.mark.parametrize(
    ("question", "answer", "said"),
    [
        (
            ROTATING,
            {"claim": ["m*r_ddot - m*r*phi_dot**2 + k/r**2", "m*r**2*phi_ddot"]},
            "in equation 2 the Coriolis term 2*m*phi_dot*r*r_dot is missing",
        ),
        (
            BEAD,
            {"claim": ["-lam + m*l*theta_dot**2 + m*g*cos(theta)"]},
            "right with the opposite sign of lam; the convention here is d/dt ∂L/∂q̇ − ∂L/∂q = Σ λ ∂f/∂q",
        ),
        (PENDULUM, {"claim": ["theta_ddot + g/l*theta"]}, "in equation 1 theta should be sin(theta)"),
        (PENDULUM, {"claim": ["theta_ddot + l/g*sin(theta)"]}, "is upside down"),
        (PENDULUM, {"claim": ["l*theta_ddot + m*g*sin(theta)"]}, "in equation 1"),
        (PENDULUM, {"claim": ["theta_dot + g/l*sin(theta)"]}, "theta_dot should be theta_ddot"),
        (
            HOOP,
            {"H": "p**2/(2*m*(1 + sin(theta)**2)) - m*g*sin(theta)"},
            "in H sin(theta) should be cos(theta) everywhere",
        ),
    ],
)
def test_a_mistake_is_named_as_a_teacher_would(question, answer, said):
    keys = {k: v for k, v in question.items() if k != "kind"}
    assert said in feedback(examine(Claim("a", question["kind"], {**keys, **answer})))


def test_several_mistakes_are_told_as_several():
    keys = {k: v for k, v in ROTATING.items() if k != "kind"}
    wrong = Claim(
        "a",
        "euler-lagrange",
        {**keys, "claim": ["m*r_ddot + m*r*phi_dot**2 + k/r**2", "r*phi_ddot + r_dot*phi_dot"]},
    )
    found = diagnosis(examine(wrong))
    assert [c.mistake for c in found.changes] == [Mistake.TERM_SIGN, Mistake.TERM_FACTOR]
    assert [c.place for c in found.changes] == ["equation 1", "equation 2"]


ACTION_ANGLE = {"q": ["q"], "p": ["p"], "Q": ["atan(m*w*q/p)"], "P": ["(p**2 + m**2*w**2*q**2)/(2*m*w)"],
                "parameters": {"m": "positive", "w": "positive", "q": "positive", "p": "positive"}}  # fmt: skip


def test_what_is_told_does_not_depend_on_the_time_it_takes(monkeypatch):
    """With a clock that goes twenty times as fast as the processor works, and a second time, the same is found."""
    wrong = Claim("a", "canonicity", {**ACTION_ANGLE, "P": ["(p**2 + m*w**2*q**2)/(2*m*w)"]})
    first = diagnosis(examine(wrong))
    start, clock = time.monotonic(), time.monotonic
    monkeypatch.setattr(
        "canon.exercise.question.deadline.time.monotonic", lambda: start + 20 * (clock() - start)
    )
    assert diagnosis(examine(wrong)).changes == first.changes != ()


def some_claims():
    """Return thirty claims: questions whose right answers hold, and wrong answers to them."""
    for question in questions()[::15]:
        yield claim_from({k: v for k, v in question.keys.items() if k != "expect"})
        yield from (answer.claim for answer in of_a_question(question, each=1))


def said(worker, claim):
    judgement = worker.judge(claim)
    return judgement.status, judgement.certificate, judgement.feedback, judgement.corrected, judgement.known


@pytest.mark.slow
def test_a_busy_machine_says_the_same():
    """Thirty claims on an idle machine, and again with more processes on each processor than it has threads."""
    claims = list(some_claims())[:30]
    with Worker() as worker:
        idle = [said(worker, claim) for claim in claims]
    spinners = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2 * cpu_count())]
    try:
        with Worker() as worker:
            busy = [said(worker, claim) for claim in claims]
    finally:
        for spinner in spinners:
            spinner.kill()
            spinner.wait()
    assert len(claims) == 30
    assert repr(busy).encode() == repr(idle).encode()


@pytest.mark.skipif(
    sys.platform != "linux", reason="no other system tells how long another process has worked"
)
def test_a_process_that_gets_no_processor_is_waited_for():
    """A worker that is held up for longer than the budget of a claim answers it when it goes on."""
    claim = Claim("a", "canonicity", ACTION_ANGLE, budget=1.0)
    with Worker() as worker:
        assert worker.judge(claim).status == "holds"
        os.kill(worker._child.pid, signal.SIGSTOP)
        threading.Timer(2.0, os.kill, (worker._child.pid, signal.SIGCONT)).start()
        assert worker.judge(claim).status == "holds"
