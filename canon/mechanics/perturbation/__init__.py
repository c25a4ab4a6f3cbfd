"""Perturbation theory: Lie transforms, normal forms, averaging, formal integrals, each to a stated order."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
