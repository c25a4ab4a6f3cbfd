r"""
From SciPy: the function you have
=================================

A right-hand side written for ``solve_ivp`` goes to ``propagate`` as it is. It is called once, with symbols, and
becomes formulas.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

from canon import propagate


def rates(_t, y, a, b):
    hares, foxes = y
    return [hares * (a - foxes), foxes * (hares - b)]


# %%
by_scipy = solve_ivp(rates, (0, 50), [2.0, 1.0], args=(1.0, 1.5), rtol=1e-9, atol=1e-9)
by_canon = propagate(lambda t, y: rates(t, y, 1.0, 1.5), (0, 50), [2.0, 1.0], samples=500)


# %%
# Hares and foxes have a constant, :math:`x - b\ln x + y - a\ln y`. Which of the two kept it?
def constant(y):
    return y[0] - 1.5 * np.log(y[0]) + y[1] - np.log(y[1])


for name, run in (("SciPy, rtol 1e-9", by_scipy), ("canon", by_canon)):
    print(f"{name:17} constant off by {np.ptp(constant(run.y)):.0e}")

# %%
figure, axes = plt.subplots(figsize=(4.5, 3.5), layout="constrained")
axes.plot(*by_canon.y)
axes.set(xlabel="hares", ylabel="foxes", title="Lotka and Volterra")
