"""Canonical transformations: tests, generating functions, inverses, the new Hamiltonian."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
