"""Integration methods as values, and the number formats they run in."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
