"""Text reader: tells people while they type how their text is read, by a process that can be killed."""

from __future__ import annotations

import asyncio
import json
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from canon.process import Child, Ended, Late
from canon.serve.refusal import Refusal

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.serve.token_bucket import WorkTime

__all__ = ["TextReader"]

SECONDS = 3.0
"""Seconds after which nobody wants to see any more how a text is read."""
START = 60.0
"""Seconds that the process may take to start, on a slow or busy machine."""
WAITING = 100
"""Texts of all clients that wait to be read."""
TEXTS_A_PROCESS = 10_000
"""Texts after which the process is replaced, so that what libraries keep in memory does not grow for ever."""


class TextReader:
    """The process that reads texts, one after the other."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, "reading")
        self._child: Child | None = None
        self._starting = threading.Lock()
        self._closed = False
        self._texts = 0
        self.waiting = 0
        """Texts that are read or wait for it."""
        self._thread.submit(self._ready)

    async def how_read(self, asked: Mapping[str, Any], work: WorkTime) -> dict[str, Any]:
        """Return how a text is read, as :func:`canon.serve.reading_process.how_read` says it.

        Parameters
        ----------
        asked
            The text, and the names that it may use.
        work
            What counts the seconds of reading; those of waiting are not counted.

        Raises
        ------
        Refusal
            Where too many texts wait already, or where reading this one does not come to an end.
        """
        if self.waiting >= WAITING:
            raise Refusal(503, f"{WAITING} texts wait to be read; ask again in a second", retry_after=1.0)
        self.waiting += 1
        try:
            return await asyncio.get_running_loop().run_in_executor(
                self._thread, self._read, dict(asked), work
            )
        finally:
            self.waiting -= 1

    def close(self) -> None:
        """Kill the process, whatever it is reading; none is started any more."""
        with self._starting:
            self._closed = True
        self._thread.shutdown(wait=False, cancel_futures=True)
        self._stop()

    def _read(self, asked: dict[str, Any], work: WorkTime) -> dict[str, Any]:
        child = self._ready()
        with work:
            try:
                self._texts += 1
                child.send(lambda: json.dumps(asked).encode(), SECONDS)
                return json.loads(child.receive(time.monotonic() + SECONDS))
            except (Late, Ended) as reason:
                self._stop()
                self._ready()  # the next text does not wait for it, and whose text ended the last one pays
                raise Refusal(
                    422, f"this text could not be read within {SECONDS:g} s; shorten it"
                ) from reason

    def _ready(self) -> Child:
        """Return the process once it waits for a text; a new one where it ended or has read enough."""
        child = self._child
        if child is None or not child.usable or self._texts >= TEXTS_A_PROCESS:
            self._stop()
            with self._starting:  # what starts is known to whoever closes, or does not start
                if self._closed:
                    raise Refusal(503, "the service is ending; ask again when it is back")
                self._child = child = Child("canon.serve.reading_process", leads=True)
            try:
                child.receive(time.monotonic() + START)
            except (Late, Ended) as reason:
                self._stop()
                raise Refusal(
                    503,
                    "the process that reads texts does not start; ask again in a minute",
                    retry_after=60.0,
                ) from reason
            self._texts = 0
        return child

    def _stop(self) -> None:
        child, self._child = self._child, None
        if child is not None:
            child.kill()
