"""Questions of proof that claims come down to, and the systems of equations they are asked about."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
