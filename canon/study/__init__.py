"""Long runs: drift statistics, cost against accuracy."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
