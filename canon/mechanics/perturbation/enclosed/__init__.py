"""Series with coefficients in balls: what is irrational is enclosed, and every digit that is told is certain."""
