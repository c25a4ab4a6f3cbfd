r"""
What a digit costs
==================

Error against processor time, for several methods and steps: the slope of a line is the order of its method, and
where the lines cross is where one should change the method.
"""

import matplotlib.pyplot as plt
import numpy as np

from canon import DOP853, RK4, Splitting, Taylor, work_precision
from canon.plot import plot_work_precision
from canon.scene import find

star = find("henon-heiles")
methods = [Splitting("verlet"), Splitting("kahan-li-8"), RK4(), Taylor(), DOP853()]
measured = work_precision(
    star,
    50 * star.period,
    methods=methods,
    steps=[star.period / n for n in (30.3, 60.3, 120.3, 240.3)],
    tolerances=[1e-4, 1e-7, 1e-10, 1e-13],
)
print(measured)

# %%
figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
plot_work_precision(measured, axes)

# %%
# The order of each method of fixed step, from its two largest steps, against the one it should have:
for method in methods[:3]:
    rows = sorted((row.step, row.position_error) for row in measured.rows if row.method == method)
    (small, fine), (large, coarse) = rows[-2:]
    print(
        f"{method!s:11} order {np.log(coarse / fine) / np.log(large / small):.1f}, should be {method.order}"
    )
