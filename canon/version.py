"""The version of canon: part of the key of every stored result."""

__version__ = "0.1.0"
