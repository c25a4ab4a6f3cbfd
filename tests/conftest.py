"""Generated examples are the same in every run of CI, elsewhere new ones; a test has at most five minutes."""

from __future__ import annotations

import gc
import os
import shutil
import signal
import sys
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import find, settings
from hypothesis.strategies import just

if TYPE_CHECKING:
    from collections.abc import Generator

settings.register_profile("ci", derandomize=True, deadline=None)
settings.register_profile("here", deadline=None)  # a busy machine proves nothing against a law
settings.load_profile("ci" if os.environ.get("CI") else "here")

collect_ignore_glob = ["data/typed/*"]  # read by checkers of types, never run: half of it is wrong

LONGEST = 300.0
"""Seconds of a test, slow ones included, and of what is set up for it and put away after it."""

PATIENCE = 4
"""A test may have so many times as long while more wants to run than there are processors."""

DOCUMENTATION = "test_the_documentation_builds_without_warnings_from_a_fresh_clone"
"""It executes all pages, and may have three times as long; so may a law of thousands, to make its example smaller."""

LONG = frozenset(Path(__file__).with_name("long_tests.txt").read_text(encoding="utf-8").splitlines())
"""Tests that `.ci/weigh` found to take long: they are run with the slow ones, but for laws, which stay."""

DEAR = {
    law: int(examples)
    for examples, law in map(
        str.split, Path(__file__).with_name("dear_laws.txt").read_text(encoding="utf-8").splitlines()
    )
}
"""Laws of which no more examples are drawn, however many --examples asks for: a minute of a processor for each."""


def pytest_addoption(parser):
    parser.addoption(
        "--examples",
        type=int,
        metavar="N",
        help="draw N new examples of each law, or as many as tests/dear_laws.txt says",
    )


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    """Mark the tests that take long as slow, before the marks are looked at; the longest comes first.

    Where several processes share the tests, none is left alone with it at the end.
    """
    examples = config.getoption("examples", None)
    for item in items:
        if not hasattr(getattr(item, "obj", None), "hypothesis"):
            if item.nodeid in LONG:
                item.add_marker(pytest.mark.slow)
        elif examples:
            draw_more(item, examples)
    items.sort(key=lambda item: item.name != DOCUMENTATION)


def draw_more(item, examples):
    """Have a law draw so many examples, other ones in each run."""
    law, dear = item.obj, DEAR.get(item.nodeid.partition("[")[0], examples)
    # Hypothesis refuses a second @settings, so that its own plugin for pytest changes them in this way too.
    before = law._hypothesis_internal_use_settings
    most = max(before.max_examples, min(dear, examples))
    law._hypothesis_internal_use_settings = settings(before, max_examples=most, derandomize=False)


def pytest_collection_finish():
    """Leave what was imported out of every search for garbage, which would look through millions of objects.

    An example is drawn before: hypothesis makes its random numbers with the first, and asks the search who holds them.
    """
    find(just(0), lambda drawn: drawn == 0)
    gc.collect()
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Generator[None, object, object]:
    with in_time(item):
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    with in_time(item):
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item) -> Generator[None, object, object]:
    with in_time(item):
        return (yield)


@contextmanager
def in_time(item: pytest.Item) -> Generator[None]:
    """Fail a test that has not ended in time, with where it was, so that it does not hold up the others.

    Tests wait for processes and threads without bounds of their own, and what never comes is met here.
    """
    if not hasattr(signal, "setitimer"):
        yield
        return

    has_more = item.name == DOCUMENTATION or item.config.getoption("examples", None)
    left, longest = PATIENCE - 1, LONGEST * (3 if has_more else 1)

    def give_up(*_: object) -> None:
        nonlocal left
        if left and os.getloadavg()[0] > (os.cpu_count() or 1):
            left -= 1
            signal.setitimer(signal.ITIMER_REAL, longest)
            return
        pytest.fail(f"not ended after {longest:g} s; split it, or find what does not end")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.setitimer(signal.ITIMER_REAL, longest)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@pytest.fixture(scope="module")
def browser():
    """Chromium without a window, which tells what its console says."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="Selenium is not installed")
    names = ("chromium", "chromium-browser", "google-chrome")
    program, driver = next(filter(None, map(shutil.which, names)), None), shutil.which("chromedriver")
    if not (program and driver):
        pytest.skip("no Chromium with its driver is installed")
    options = webdriver.ChromeOptions()
    options.binary_location = program
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    wanted = ["--headless=new", "--window-size=1200,900", "--disable-dev-shm-usage", "--disable-gpu"]
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        wanted.append("--no-sandbox")  # Chromium's own refuses to start for root
    for each in wanted:
        options.add_argument(each)
    made = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    yield made
    made.quit()


@pytest.fixture(scope="session")
def calls():
    """Tell how many functions were called in a piece of work: the same number on every machine, busy or not."""
    return _calls


def _calls(work):
    counted = 0

    def count(_frame, event, _function):
        nonlocal counted
        counted += event.endswith("call")

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        work()
    finally:
        sys.setprofile(before)
    return counted


@pytest.fixture(scope="session")
def processor_seconds():
    """What this process and all its descendants have used, ended ones too: a busy machine does not add to it.

    Where the system does not tell (not Linux) it is the clock.
    """
    return _processor_seconds if sys.platform.startswith("linux") else time.monotonic


def _processor_seconds():
    import resource  # POSIX only

    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    found = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            fields = path.read_text().rpartition(")")[2].split()
            found[int(path.parent.name)] = (int(fields[1]), sum(map(int, fields[11:15])))
    family = {os.getpid()}
    while grown := {pid for pid, (parent, _) in found.items() if parent in family} - family:
        family |= grown
    ticks = sum(found[pid][1] for pid in family - {os.getpid()} if pid in found)
    return time.process_time() + ended.ru_utime + ended.ru_stime + ticks / os.sysconf("SC_CLK_TCK")
