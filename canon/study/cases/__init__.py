"""Studies of many cases: definition, runs that resume, the file of results, export."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
