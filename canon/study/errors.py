"""What a study that can't be run raises."""

from __future__ import annotations

__all__ = ["StudyError"]


class StudyError(ValueError):
    """A study that can't be run as asked."""
