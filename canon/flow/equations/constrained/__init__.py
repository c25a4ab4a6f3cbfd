"""Constrained motion: as methods take it that keep the constraints themselves, by reactions, and impacts at once."""
