"""Study error: raised for a study that can't be run."""

from __future__ import annotations

__all__ = ["StudyError"]


class StudyError(ValueError):
    """Raised for a study that can't be run as asked."""
