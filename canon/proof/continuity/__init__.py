"""Continuity and differentiability: jumps certified, angles told from steps."""
