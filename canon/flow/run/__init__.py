"""Records of a run: sampled times, events, observables, ranges of numbers."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
