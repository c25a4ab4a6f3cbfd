"""Tangent maps beside motions: deviations from orbits, moved by the derivative of every step and renormalised."""
