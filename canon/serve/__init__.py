"""Judging over HTTP: claims in, verdicts out, and a page where people type them."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
