"""The choice of method, step and precision for a wanted accuracy, and work against precision."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
