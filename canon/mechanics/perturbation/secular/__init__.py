"""Secular theory: averages over the mean anomaly in closed form, adiabatic invariants, von Zeipel's function."""
