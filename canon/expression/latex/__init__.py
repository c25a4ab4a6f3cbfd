"""LaTeX read into the syntax tree that plain text is read into."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
