"""SymPy at the border, graphs inside: symbols, the safe expression language, the expression graph."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
