"""Worker process for heavy proofs, which can be killed."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
