"""Motions that are studied: a system with numbers, and its observables."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
