"""Machine code through LLVM: number types, formulas, double-double arithmetic, loops."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
