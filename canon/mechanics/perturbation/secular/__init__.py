"""Averages over the mean anomaly of Kepler's ellipse in closed form, without a series in the eccentricity."""
