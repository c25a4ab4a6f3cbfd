"""Tower of function fields over the rationals: arithmetic of the zero test's normal form, with signs and factors."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
