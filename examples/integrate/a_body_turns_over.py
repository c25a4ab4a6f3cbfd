r"""
A body turns over again and again
=================================

Thrown with a spin about its middle axis, a handle, a book or a wing nut turns over every few seconds. Jacobi's
functions say how often: every :math:`2 K(m)/\lambda`. A Lie–Poisson splitting turns it about its axes in exact
steps.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import ellipk
from sympy import Matrix

from canon import propagate
from canon.flow import LiePoissonSplitting
from canon.mechanics import EULER_PARAMETERS, attitude_matrix, rotating_body

A, B, C = 1.0, 2.0, 3.0
body = rotating_body([A, B, C])
tilt = 1e-3
start = [tilt, np.sqrt(1 - 2 * tilt**2), tilt, 1, 0, 0, 0]
motion = propagate(body, (0, 500), start, method=LiePoissonSplitting(4), step=0.1, samples=5000)

# %%
# It turns over where the angular momentum about the middle axis passes zero. Between, it hardly moves:
across = motion["M_2"]
k = np.flatnonzero(np.diff(np.sign(across)))
zeros = motion.t[k] - across[k] * np.diff(motion.t)[k] / np.diff(across)[k]
square, energy = 1.0, motion.energy[0]
high, low = 2 * energy * C - square, square - 2 * energy * A
if square > 2 * energy * B:
    rate, m = np.sqrt((C - B) * low / (A * B * C)), (B - A) * high / ((C - B) * low)
else:
    rate, m = np.sqrt((B - A) * high / (A * B * C)), (C - B) * low / ((B - A) * high)
print(f"turns over every {np.diff(zeros).mean():.4f} s, by Jacobi's functions {2 * ellipk(m) / rate:.4f} s")

# %%
# What is conserved: the energy to the method's order, the rest to round-off. The angular momentum along fixed axes,
# R(e) M, is no Casimir function, but every part of H keeps it:
fixed = attitude_matrix() * Matrix(body.x[:3])
print(f"energy error at most {abs(motion.energy_error).max():.0e}")
for name, f in {
    "|e|^2": sum(e**2 for e in EULER_PARAMETERS),
    "|M|^2": sum(M**2 for M in body.x[:3]),
    "M_z": fixed[2],
}.items():
    values = motion[f]
    print(f"{name:6s} off by at most {abs(values - values[0]).max():.0e}")

# %%
figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
for name in ("M_1", "M_2", "M_3"):
    axes.plot(motion.t[:1500], motion[name][:1500], label=name)
axes.set(xlabel="t", ylabel="angular momentum along the body's axes", title="The middle axis is not stable")
axes.legend(loc="upper right")
