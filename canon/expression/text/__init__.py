"""Plain text read into a syntax tree: tokens, grammar, names, units, products without a sign."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
