r"""
A comet, by three methods
=========================

An eccentric ellipse is hard on methods of one step: all happens near the Sun. The same motion by RK4, by a
symplectic method, and by one in whose own time the steps near the Sun are short.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import sqrt

from canon import RK4, Hamiltonian, Splitting, Taylor, TimeTransformed, coordinates, propagate

x, y = coordinates("x y")
px, py = x.momentum, y.momentum
comet = Hamiltonian((px**2 + py**2) / 2 - 1 / sqrt(x**2 + y**2), [x, y], [px, py])
e = 0.9
start = [1 + e, 0, 0, np.sqrt((1 - e) / (1 + e))]  # at aphelion; the semi-major axis is 1, so a year has 2π

# %%
years, step = 20, 2 * np.pi / 2000
methods = {"RK4": RK4(), "Splitting": Splitting("kahan-li-8")}
runs = {
    name: propagate(comet, (0, 2 * np.pi * years), start, method=method, step=step)
    for name, method in methods.items()
}
in_its_time = TimeTransformed(Splitting("kahan-li-8"))
runs["TimeTransformed"] = propagate(comet, (0, 2 * np.pi * years), start, method=in_its_time, step=step)
referee = propagate(comet, (0, 2 * np.pi * years), start, method=Taylor())

# %%
figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
for name, run in runs.items():
    axes.plot(run["x"], run["y"], ".-", ms=2, lw=0.4, label=name)
axes.set(xlabel="x", ylabel="y", aspect="equal", title="20 years of a comet with e = 0.9")
axes.legend(loc="upper left")

# %%
# After whole years the comet should be where it began:
print("                  max |ΔE/E|   place lost")
for name, run in {**runs, "Taylor": referee}.items():
    lost = np.hypot(*(run.q[:, -1] - start[:2]))
    print(f"{name:16} {abs(run.energy_error).max():12.1e} {lost:12.1e}")
