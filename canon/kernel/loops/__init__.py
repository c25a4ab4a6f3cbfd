"""Compiled loops over steps: splittings, Gauss methods, statistics and events inside the loop."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
