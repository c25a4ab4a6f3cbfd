"""Sentences around and between formulas, in whatever language they are written, and formulas that are dictated."""
