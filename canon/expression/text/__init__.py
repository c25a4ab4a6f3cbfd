"""Plain text read into a syntax tree: tokens, grammar, names, units, products without a sign."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
