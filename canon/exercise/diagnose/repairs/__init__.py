"""Repairs of wrong answers: candidates that differ by one slip, and the values at points that screen them."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
