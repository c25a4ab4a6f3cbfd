r"""
A cloud of starts becomes a banana
==================================

Where a satellite will be is known as well as where it is: a cloud. One integration, with the derivatives of the flow up
to some order, carries the whole cloud: a Taylor map. The first order knows ellipses only.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import sqrt

from canon import Hamiltonian, coordinates, propagate
from canon.flow import flow_series

x, y = coordinates("x y")
px, py = x.momentum, y.momentum
kepler = Hamiltonian((px**2 + py**2) / 2 - 1 / sqrt(x**2 + y**2), [x, y], [px, py])
start = np.array([1.0, 0.0, 0.0, 1.1])
until = 40.0  # four orbits and a half
cloud = 0.003 * np.random.default_rng(1).standard_normal((4, 500))
true = propagate(kepler, (0, until), start[:, None] + cloud, samples=1).y[:, -1]

# %%
figure, panels = plt.subplots(1, 3, figsize=(6, 4.6), layout="constrained", sharex=True, sharey=True)
for axes, order in zip(panels, (1, 2, 5), strict=True):
    series = flow_series(kepler, (0, until), start, order=order)
    there = series(cloud)
    axes.plot(true[0], true[1], ".", markersize=2, label="integrated")
    axes.plot(there[0], there[1], ".", markersize=2, label="series")
    missed = np.linalg.norm(there[:2] - true[:2], axis=0)
    axes.set(xlabel="x", title=f"order {order}: off by {missed.max():.2f}", aspect="equal")
    print(
        f"order {order}: symplectic to {series.symplecticity_defect:.0e}, right to 1e-3 within {series.reach(1e-3):.0e}"
    )
panels[0].set(ylabel="y", xlim=(-1.8, -0.3), ylim=(-1.3, 1.7))
panels[0].legend(markerscale=6, loc="upper right")
