"""Is this expression zero on this domain?"""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
