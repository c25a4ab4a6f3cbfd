r"""
Order and chaos on one page
===========================

Hénon and Heiles looked at where orbits of one energy pass through the plane x = 0. Orbits that keep a further
integral draw curves; those that don't fill areas.
"""

import matplotlib.pyplot as plt
import numpy as np

from canon import Event, Hamiltonian, coordinates, propagate

x, y = coordinates("x y")
px, py = x.momentum, y.momentum
V = (x**2 + y**2) / 2 + x**2 * y - y**3 / 3
star = Hamiltonian((px**2 + py**2) / 2 + V, [x, y], [px, py])

# %%
# Starts on the plane with the energy 1/8, where order and chaos share it. A row of starts is an ensemble, one
# array, run side by side:
energy = 1 / 8
heights = np.linspace(-0.25, 0.6, 18)
speed = np.sqrt(2 * (energy - heights**2 / 2 + heights**3 / 3))
starts = np.array([0 * heights, heights, speed, 0 * heights])
motion = propagate(star, (0, 2000), starts, events=[Event(x, direction=1)], samples=2)

# %%
figure, axes = plt.subplots(figsize=(6, 5), layout="constrained")
for crossings in motion.events:
    states = np.array([met.y for met in crossings])
    axes.plot(states[:, 1], states[:, 3], ".", ms=1.5)
axes.set(xlabel="y", ylabel="p_y", title="Hénon–Heiles, E = 1/8")

# %%
# Every crossing should lie on the plane and have the energy of the start:
met = np.concatenate([[crossing.y for crossing in crossings] for crossings in motion.events])
at = (met[:, 2] ** 2 + met[:, 3] ** 2 + met[:, 1] ** 2) / 2 - met[:, 1] ** 3 / 3
print(f"{len(met)} crossings, off the plane by at most {abs(met[:, 0]).max():.0e}")
print(f"energy off by at most {abs(at - energy).max():.0e}")
