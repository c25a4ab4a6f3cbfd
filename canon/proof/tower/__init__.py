"""The normal form: a tower of function fields over the rationals, with signs and factors."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
