"""What a person or a program is told of judged claims: table, JSON lines, JUnit XML, page."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
