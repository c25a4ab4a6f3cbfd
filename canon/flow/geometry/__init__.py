"""The derivative of a flow, and what it shows: symplecticity, brackets at points, reversal."""

from canon.doors import door

__getattr__, __dir__, __all__ = door(__name__, __file__)
