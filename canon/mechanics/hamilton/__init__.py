"""Hamilton's formalism: Hamiltonians, Legendre's transformation, brackets, vector fields, symmetries."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
