"""Quantities as sheets write them: units behind numbers, and dimensions."""
