r"""
Round-off walks
===============

Two hundred neighbouring orbits by one method whose truncation is below the last digit. What is left is
round-off, a random walk: the spread grows with the root of the time.
"""

import matplotlib.pyplot as plt
import numpy as np

from canon import Splitting, propagate
from canon.plot import plot_ensemble_fan
from canon.scene import find

star = find("henon-heiles")
generator = np.random.default_rng(1)
start = np.array(star.state())
starts = start[:, None] * (1 + 1e-3 * generator.standard_normal((4, 200)))
times = np.linspace(0, 10_000, 801)
fan = propagate(star.name, (0, 10_000), starts, method=Splitting("kahan-li-8"), step=0.02, times=times)

# %%
figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
plot_ensemble_fan(fan, axes)

# %%
# The width of the fan at a quarter of the time and at the end: a walk doubles it, a drift would make it four
# times as wide.
width = fan.energy_error.std(axis=1)
quarter, end = width[len(times) // 4], width[-1]
print(f"width {quarter:.1e} at t = 2500, {end:.1e} at t = 10 000: {end / quarter:.2f} times (a walk: 2)")
