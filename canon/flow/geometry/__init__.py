"""The derivative of a flow, and what it shows: symplecticity, brackets at points, reversal."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
