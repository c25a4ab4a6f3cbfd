"""Variational integrators: steps that make a discrete action stationary, with forces by Lagrange and d'Alembert."""
