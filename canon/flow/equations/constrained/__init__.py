"""Constrained motion as methods take it that keep the constraints themselves."""
