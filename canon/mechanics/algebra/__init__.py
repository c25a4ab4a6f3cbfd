"""Algebra that mechanics rests on: linear systems, Jacobians, substitution, inversion on a branch, quadratures."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
