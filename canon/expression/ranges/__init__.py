"""Integrals and sums over a range: what they mean, and where they stand in LaTeX."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
