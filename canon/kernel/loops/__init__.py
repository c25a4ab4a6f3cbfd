"""Compiled loops over steps: splittings, Gauss methods, statistics and events inside the loop."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
