"""Continuity and differentiability: jumps are certified, and angles that turn by 2π are told from them."""
