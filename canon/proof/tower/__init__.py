"""The normal form: a tower of function fields over the rationals, with signs and factors."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
