"""Coefficients of integration schemes and the conditions for their order."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
