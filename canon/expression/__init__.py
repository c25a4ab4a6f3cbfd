"""Expressions: SymPy at the border, graphs inside, and the safe language in which they are typed."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
