"""Elementary and special functions in the normal form: angles, arcs, powers, logarithms, gamma functions."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
