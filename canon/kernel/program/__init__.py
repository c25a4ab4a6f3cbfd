"""Straight-line programs for Hamilton's equations, and the sharing of work in them."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
