r"""
A potential from a table
========================

A molecule's potential as a chemist has it: twelve distances, twelve energies. A spline of them is a function
like any other, and the period of its vibration follows, with the energy kept.
"""

import matplotlib.pyplot as plt
import numpy as np

from canon import Event, Hamiltonian, coordinates, propagate
from canon.flow import sampled_function

r = coordinates("r")
distances = np.array([0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0])
energies = (1 - np.exp(-1.9 * (distances - 1))) ** 2  # Morse's curve stands for the measurement here
V = sampled_function(r, distances, energies)
molecule = Hamiltonian(r.momentum**2 / 2 + V, [r], [r.momentum])

# %%
figure, (curve, path) = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
curve.plot(distances, energies, "o")
for stretch in (1.1, 1.3, 1.6):
    run = propagate(molecule, (0, 20), [stretch, 0], events=[Event(r.momentum, direction=-1)], samples=400)
    period = run.events[-1].t - run.events[-2].t
    path.plot(run.t, run["r"], label=f"{stretch}")
    error = abs(run.energy_error).max()
    print(f"stretched to {stretch}: period {period:.4f}, energy kept to {error:.0e}")
curve.set(xlabel="r", ylabel="V", title="the table")
path.set(xlabel="t", ylabel="r", title="vibrations")
path.legend(title="start")

# %%
# Small vibrations of Morse's curve itself: :math:`\omega = a\sqrt{2D}`.
print(f"small ones, by formula: {2 * np.pi / (1.9 * np.sqrt(2)):.4f}")
