"""Linear equations and turns written into compiled loops."""
