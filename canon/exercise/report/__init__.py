"""Reports of judged claims for people and programs: table, JSON lines, JUnit XML, page."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
