"""Symbols of mechanics: coordinates, velocities, momenta, parameters; checks of what users pass in."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
