"""Fewer variables: Routh's procedure, ignorable coordinates, constraints eliminated, singular Lagrangians."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
