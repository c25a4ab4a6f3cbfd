"""LaTeX read into the syntax tree that plain text is read into."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
