"""Counterexamples: points of the domain where two sides certainly differ."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
