r"""
A soliton in a chain of 4,000 sites
===================================

Toda's chain, :math:`H = \sum p_i^2/2 + \sum (e^{-(q_{i+1} - q_i)} + q_{i+1} - q_i - 1)`, carries waves that keep their
shape. Written out, it would be 8,000 terms; :func:`~canon.mechanics.chain_sum` keeps it as one term and the list of
sites, and a symplectic method loops over the sites. The wave is known, so the error is the error:
:math:`q_n = \ln\cosh(\kappa(n-1) - \beta t) - \ln\cosh(\kappa n - \beta t)`, :math:`\beta = \sinh\kappa` (M. Toda,
*Theory of Nonlinear Lattices*, 1981).
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import exp

from canon import Hamiltonian, Splitting, coordinates, propagate
from canon.mechanics import chain_sum, row_sum

sites, kappa = 4000, 0.7
beta = np.sinh(kappa)
q = coordinates(f"q0:{sites}")
p = [each.momentum for each in q]
bonds = chain_sum(lambda a, b: exp(a - b) + b - a - 1, q)
chain = Hamiltonian(row_sum(lambda p: p**2 / 2, p) + bonds, q, p)


def soliton(t):
    phase = kappa * (np.arange(-1, sites) - 300) - beta * t
    heights = np.logaddexp(phase, -phase) - np.log(2)  # ln cosh
    return np.concatenate([heights[:-1] - heights[1:], beta * np.diff(np.tanh(phase))])


run = propagate(chain, (0, 2000), soliton(0), method=Splitting("blanes-moan-6"), step=0.2, samples=4)
there = np.abs(run.y[:sites, -1] - soliton(2000)[:sites]).max()
print(
    f"it goes {beta * 2000 / kappa:.0f} sites far; the places are wrong by {there:.0e}, the energy by ",
    end="",
)
print(f"{abs(run.energy_error).max():.0e}")

# %%
figure, axes = plt.subplots(figsize=(8, 3), layout="constrained")
for k, t in enumerate(run.t):
    axes.plot(run.y[sites:, k], label=f"t = {t:.0f}")
axes.set(xlabel="site", ylabel="momentum", ylim=(-0.02, 0.63))
axes.legend(frameon=False, loc="upper right", ncols=5)
