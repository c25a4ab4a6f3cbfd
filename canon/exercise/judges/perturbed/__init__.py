"""Judges of Hamilton–Jacobi theory, of action and angle, and of perturbation theory."""
