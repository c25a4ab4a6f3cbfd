"""Integrable systems: Hamilton–Jacobi equation, separation of variables, actions, frequencies and angles."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
