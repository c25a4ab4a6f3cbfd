r"""
Does it drift, and how small a drift would have been seen?
==========================================================

One motion, four methods, 5000 periods. A small error today says nothing about tomorrow; what counts is whether
it is bounded, wanders or grows with the time.
"""

import matplotlib.pyplot as plt

from canon import RK4, Splitting, Taylor, drift_study
from canon.plot import plot_block_means, plot_energy_error

methods = [Splitting("kahan-li-8"), Splitting("verlet"), RK4(), Taylor()]
study = drift_study("henon-heiles", methods=methods, periods=5000)
print(study)

# %%
# The relative energy error of all four. What grows like t rises along a line of slope 1, a random walk along one
# of slope 1/2.
figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
plot_energy_error(study, axes)

# %%
# A verdict is reached on means over windows of time, which take out the oscillation. Those of RK4, with the
# line that was fitted:
rk4 = study.rows[2].drift
figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
plot_block_means(rk4, axes)

# %%
for row in study.rows:
    found = row.drift
    print(
        f"{row.method!s:11} {found.verdict!s:10} a drift above {found.detection_limit:.0e} would have been seen"
    )
