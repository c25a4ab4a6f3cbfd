"""The choice of method, step and precision for a wanted accuracy, and work against precision."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
