r"""
The outer planets for a hundred thousand years
==============================================

A Wisdom–Holman map moves every planet on its Kepler ellipse and lets the planets pull on one another in
between. Its steps may be long: here there are 22 in a year of Jupiter's.
"""

import matplotlib.pyplot as plt
import numpy as np

from canon import WisdomHolman, drift, propagate
from canon.scene import find

planets = find("outer-solar-system")
print(planets.title)
year = 365.25  # the scene counts in days and astronomical units
span = 100_000 * year
run = propagate(planets.name, (0, span), method=WisdomHolman(corrector=17), step=200, samples=4000)

# %%
found = drift(run)
print(found)

# %%
# The error of the energy, sample by sample:
figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
axes.semilogy(run.t[1:] / year, np.abs(run.energy_error[1:]), lw=0.5)
axes.set(xlabel="years", ylabel="|ΔE/E|", title="Energy error, steps of 200 days")

# %%
print(f"steps of 200 days, energy error at most {abs(run.energy_error).max():.1e}: {found.verdict}")
