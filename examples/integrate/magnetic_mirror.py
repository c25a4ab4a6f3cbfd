r"""
A magnetic mirror
=================

Where field lines crowd, a charge that circles about them is turned back, at :math:`B = E/\mu`: its magnetic moment
:math:`\mu = m v_\perp^2/2B` hardly changes. Boris's push follows it in explicit steps, and so does a symplectic
splitting, for which the vector potential has to be integrated once: here it is a polynomial.
"""

import matplotlib.pyplot as plt
import numpy as np

from canon import RK4, Hamiltonian, coordinates, propagate
from canon.flow import Boris, MagneticSplitting

x, y, z = coordinates("x y z")
p = [s.momentum for s in (x, y, z)]
along_axis = 1 + z**2 / 4
A = [-y * along_axis / 2, x * along_axis / 2, 0]
charge = Hamiltonian(sum((a - b) ** 2 for a, b in zip(p, A, strict=True)) / 2, [x, y, z], p)
start = [0.05, 0, 0, 0, 0.05 + 0.025, 0.05]

# %%
# The field is the curl of A; the moment is read off the motion with it:
B = [A[2] - A[1].diff(z), A[0].diff(z), A[1].diff(x) - A[0].diff(y)]
size2 = sum(b**2 for b in B)
v = [a - b for a, b in zip(p, A, strict=True)]
parallel = sum(a * b for a, b in zip(v, B, strict=True))
moment = (sum(a**2 for a in v) - parallel**2 / size2) / (2 * size2**0.5)

# %%
figure, axes = plt.subplots(2, 1, figsize=(7, 5), layout="constrained")
for method, step in ((Boris(), 0.4), (MagneticSplitting(4), 0.4), (RK4(), 0.1)):
    motion = propagate(charge, (0, 20_000), start, method=method, step=step, samples=50_000)
    mu, field = motion[moment], np.sqrt(motion[size2])
    turns = np.flatnonzero(np.diff(np.sign(motion[parallel])))
    change = mu[-5000:].mean() / mu[:5000].mean() - 1
    print(f"{method!s:12s} energy off by at most {abs(motion.energy_error).max():.0e}, ", end="")
    print(f"moment changed by {change:+.0e}, {len(turns)} turns at B = {field[turns].mean():.3f}, ", end="")
    print(f"E/mu = {(motion.energy / mu).mean():.3f}")
    axes[0].plot(motion.t[:2500], motion["z"][:2500], label=str(method), lw=0.8)
    axes[1].plot(motion.t[::50], mu[::50] / mu[0], lw=0.8)
axes[0].set(ylabel="z", title="To and fro between two mirrors")
axes[0].legend(loc="upper right")
axes[1].set(xlabel="t", ylabel="magnetic moment")
