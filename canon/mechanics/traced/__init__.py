"""Functions f(t, y) of Python, read as formulas."""
