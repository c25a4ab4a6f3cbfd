"""Sums of one term over many rows of arguments: their values, rates and loops, never written out."""
