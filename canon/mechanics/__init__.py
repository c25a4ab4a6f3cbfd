"""Symbolic mechanics: Lagrangians, Hamiltonians, brackets, transformations, generating functions."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
