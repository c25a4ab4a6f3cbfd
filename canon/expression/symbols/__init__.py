"""Symbols of mechanics: coordinates, velocities, momenta, parameters; checks of what users pass in."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
