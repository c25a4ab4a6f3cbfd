"""Drift of what should stay constant: error series judged, methods compared."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
