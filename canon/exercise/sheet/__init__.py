"""Sheets of claims as files and as values: keys, shapes, expressions read."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
