"""Lagrangian systems ready to compile, for methods that work on the Lagrangian itself."""
