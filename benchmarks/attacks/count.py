"""Counts of attacks: how many, what came of them, and the first that went wrong."""

from __future__ import annotations

import io
import os
import traceback
from collections import Counter
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from typing import Any

from days import today

from canon.cli import main

__all__ = ["BAD", "Count", "command", "load_is_low"]

BAD = (
    "traceback",
    "other numbers",
    "code run",
    "over budget",
    "left running",
    "wrong status",
    "false line",
    "false verdict",
    "lost",
    "closed without a word",
)
"""What must not come of an attack."""


@dataclass
class Count:
    """What came of one sort of attack."""

    sort: str
    outcomes: Counter[str] = field(default_factory=Counter)
    first: dict[str, str] = field(default_factory=dict)
    figures: list[str] = field(default_factory=list)
    """Lines of what was measured besides."""
    day: str = field(default_factory=today)

    def add(self, outcome: str, attack: str) -> None:
        self.outcomes[outcome] += 1
        if outcome in BAD:
            self.first.setdefault(outcome, attack)

    @property
    def bad(self) -> int:
        return sum(self.outcomes[outcome] for outcome in BAD)

    def to_dict(self) -> dict[str, Any]:
        return {
            "sort": self.sort,
            "outcomes": dict(sorted(self.outcomes.items())),
            "first": self.first,
            "figures": self.figures,
            "day": self.day,
        }

    @staticmethod
    def from_dict(written: dict[str, Any]) -> Count:
        return Count(**{**written, "outcomes": Counter(written["outcomes"])})

    def __str__(self) -> str:
        told = ", ".join(f"{number} {outcome}" for outcome, number in sorted(self.outcomes.items()))
        lines = [f"{self.sort}: {self.outcomes.total()}: {told}; {self.bad} bad"]
        lines += [f"  {figure}" for figure in self.figures]
        return "\n".join([*lines, *(f"  {outcome}: {attack}" for outcome, attack in self.first.items())])


def command(*arguments: object) -> tuple[int | None, str, str]:
    """Return what a command ends with and prints, in this process; None and a traceback where it raises."""
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as ended:
            status = int(ended.code or 0)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt):
                raise
            return None, out.getvalue(), traceback.format_exc()
    return status, out.getvalue(), err.getvalue()


def load_is_low() -> bool:
    """Whether the machine has had a processor to spare in the last minute."""
    return os.getloadavg()[0] < (os.cpu_count() or 1)
