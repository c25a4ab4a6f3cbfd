"""Attacks on canon: flipped bits, kills, hostile files and claims, streams; each sort counts what came of it."""
