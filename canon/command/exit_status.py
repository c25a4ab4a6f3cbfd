"""Exit statuses of ``canon`` beside those that say something of claims."""

__all__ = ["BROKEN_PIPE", "INTERRUPTED", "UNWRITTEN"]

BROKEN_PIPE = 141
"""Exit status of a program whose reader went away, as shells report it: 128 + SIGPIPE."""
INTERRUPTED = 130
"""Exit status of a program that was interrupted: 128 + SIGINT."""
UNWRITTEN = 2
"""Exit status where what was found can't be told: none of those that say something of claims."""
