"""Normal form of elementary and special functions: angles, arcs, powers, logarithms, gamma functions."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
