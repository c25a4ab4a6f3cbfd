"""What a study is about: a system with numbers, its observables."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
