"""Equations of typed answers: several in one text, chains, products of matrices, vectors, numbers beside them."""
