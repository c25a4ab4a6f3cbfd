"""Machine code through LLVM: number types, formulas, double-double arithmetic, loops."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
