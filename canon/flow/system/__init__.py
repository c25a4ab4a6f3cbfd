"""Systems of every kind as equations of first order: what is integrated, from which state, and what is read from it."""
