"""The proving rungs, from the quickest to the most thorough."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
