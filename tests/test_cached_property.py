"""Cached properties: computed once, and by a forked child though a thread of its parent was computing one."""

import os
import signal
import sys
import threading

import pytest

from canon.cached_property import cached_property


class Slow:
    """An object whose property is computed as long as the event is not set."""

    computed = 0

    def __init__(self, ready: threading.Event) -> None:
        self.ready, self.begun = ready, threading.Event()

    @cached_property
    def value(self) -> int:
        """A number."""
        self.begun.set()
        self.ready.wait()
        self.computed += 1
        return 7


def ready() -> threading.Event:
    event = threading.Event()
    event.set()
    return event


def test_a_property_is_computed_once_and_kept_with_the_object():
    found = Slow(ready())
    assert (found.value, found.value, found.computed) == (7, 7, 1)
    assert vars(found)["value"] == 7
    assert Slow.value.__doc__ == "A number."


def test_an_error_is_not_kept():
    class Failing:
        tried = 0

        @cached_property
        def value(self) -> int:
            self.tried += 1
            return 1 // (self.tried - 1)

    found = Failing()
    with pytest.raises(ZeroDivisionError):
        _ = found.value
    assert found.value == 1


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")  # Python 3.12 warns of forks beside threads
def test_a_forked_child_does_not_wait_for_a_thread_of_its_parent():
    other = Slow(threading.Event())
    thread = threading.Thread(target=lambda: other.value)
    thread.start()
    other.begun.wait()
    child = os.fork()
    if child == 0:
        os._exit(0 if Slow(ready()).value == 7 else 1)
    status = ended(child)
    other.ready.set()
    thread.join()
    assert status == 0


def ended(child: int) -> int:
    """Return a child's exit status; one that waits for ever is ended when the guard of the tests ends this one."""
    try:
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    except BaseException:
        os.kill(child, signal.SIGKILL)
        raise


def test_the_standard_librarys_property_has_a_lock_in_python_3_11_only():
    """Where this fails the module has become needless."""
    import functools

    assert hasattr(functools.cached_property(lambda _: 1), "lock") == (sys.version_info < (3, 12))


def test_who_asks_while_it_is_known_gets_what_is_known() -> None:
    """As a thread does that began to ask before another had computed it."""
    slow = Slow(ready())
    slow.ready.set()
    assert [Slow.value.__get__(slow, Slow) for _ in range(3)] == [7, 7, 7]
    assert slow.computed == 1
