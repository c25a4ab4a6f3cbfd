"""Rows of extreme cases, and what runs them."""
