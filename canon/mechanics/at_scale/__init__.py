"""Equations of motion of large systems on the expression graph, and as numeric functions."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
