"""Studies of many cases: definition, runs that resume, the file of results, export."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
