"""Lagrange's formalism: Lagrangians, bodies, forces, constraints, quasi-velocities, Gibbs and Appell."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
