"""What studies keep of their motions beside the numbers: which, how it is written, and how it is read back."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
