"""Diagnosis of wrong answers: what is wrong, and what would be right."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
