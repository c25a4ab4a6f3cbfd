"""Sheets of claims: read, judged, reported."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
