"""Generated examples are the same in every run of CI, elsewhere new ones; a test has at most five minutes."""

import os
import signal

import pytest
from hypothesis import settings

settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("here", deadline=None)  # a busy machine proves nothing against a law
settings.load_profile("ci" if os.environ.get("CI") else "here")

LONGEST = 300.0
"""Seconds of a test, slow ones included."""


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    """Fail a test that has not ended in time, with where it was, so that it does not hold up the others."""
    if not hasattr(signal, "setitimer"):
        return (yield)

    def give_up(*_):
        pytest.fail(f"not ended after {LONGEST:g} s; split it, or find what does not end")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.setitimer(signal.ITIMER_REAL, LONGEST)
    try:
        return (yield)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
