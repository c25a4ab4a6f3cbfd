"""Symbolic mechanics: Lagrangians, Hamiltonians, brackets, transformations, generating functions."""
