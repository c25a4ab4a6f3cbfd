"""Rows that misbehave on purpose: the harness has to survive and name them. Not among the parts."""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING

from extremes.row import Outcome, Row, refused

if TYPE_CHECKING:
    from collections.abc import Iterator


def rows() -> Iterator[Row]:
    """Yield one row of every kind."""
    good = Outcome("3", error=0.5, estimate=1.0)
    yield Row(
        "right", "an error below its estimate", lambda: good, {"other": lambda: Outcome("4", error=1.0)}
    )
    yield Row("wrong", "an error above its estimate", lambda: Outcome("3", error=2.0, estimate=1.0))
    yield Row(
        "refuses", "a division by zero", lambda: refused(lambda: 1 // 0, ZeroDivisionError, holds="zero")
    )
    yield Row("hangs", "an hour's sleep", lambda: good, {"sleeper": _sleep, "after": lambda: good}, limit=1.0)
    yield Row("dies", "abort()", lambda: os.abort() or good)
    yield Row("raises", "an error nobody expected", lambda: Outcome(str(1 // 0)))
    yield Row("eats", "4 GiB under a limit of 1", lambda: Outcome(str(len(bytes(4 << 30)))), memory=1.0)


def _sleep() -> Outcome:
    time.sleep(3600)
    return Outcome("awake")
