"""Resonances of normal forms: their periodic orbits, and the islands about them."""
