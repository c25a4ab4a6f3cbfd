"""Domains, points of them, verdicts, and values enclosed by balls."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
