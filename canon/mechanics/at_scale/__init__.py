"""Equations of motion of large systems on the expression graph, and as numeric functions."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
