"""Sheets of claims as files and as values: keys, shapes, expressions read."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
