"""SymPy at the border, graphs inside: symbols, the safe expression language, the expression graph."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
