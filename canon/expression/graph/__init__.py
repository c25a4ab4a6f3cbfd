"""The expression graph: hash-consed nodes, their algebra, derivatives and values."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
