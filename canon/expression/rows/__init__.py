"""Rows of an answer: bullets, labels and numbers of its lines, before anything in them is read."""
