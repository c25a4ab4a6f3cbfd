"""SymPy's expression trees: their anatomy, replacement in them, their types."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
