r"""
Upside down on a shaken pivot
=============================

A pendulum stands on its head where its pivot shakes fast enough. Averaging over the fast phase leaves an
effective potential, and its curvature at the top says how fast is enough.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import cos, lambdify, pi, solve, symbols

from canon import Hamiltonian, propagate
from canon.mechanics import average

q, p, tau, T = symbols("q p tau T", real=True)
b, W, eps = symbols("b Omega epsilon", positive=True)
shaken = Hamiltonian(W * T + eps * (p**2 / 2 - cos(q) + b * cos(tau) * cos(q)), [q, tau], [p, T])
averaged = average(shaken, tau, 3, eps)
print(averaged.is_average().status, "is an average to the third order")
K = averaged.K.subs(eps, 1) - W * T
print("K =", K.expand())

# %%
# The effective potential, and its curvature where q = π:
V = K.subs(p, 0)
curvature = V.diff(q, 2).subs(q, pi).simplify()
print("V'' at the top:", curvature, " changes its sign at b =", *solve(curvature, b))

# %%
# The effective potential for three strengths, and true motions from 0.3 rad beside the top, below and above
# the threshold, √2 Ω = 28.3:
figure, (well, path) = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
angles = np.linspace(0, 2 * np.pi, 300)
for strength in (0, 20, 50):
    shape = lambdify(q, V.subs({W: 20, b: strength}))
    well.plot(angles, shape(angles) * np.ones_like(angles), label=f"b = {strength}")
well.set(xlabel="q / rad", ylabel="effective potential", title="Ω = 20")
well.legend()
for strength in (25, 35):
    numbers = {W: 20, b: strength, eps: 1}
    run = propagate(shaken, (0, 30), [3.44159, 0, 0, 0], parameters=numbers, samples=3000)
    path.plot(run.t, run["q"], label=f"b = {strength}", lw=0.8)
    print(f"b = {strength}: farthest from the top {abs(run['q'] - np.pi).max():.2f} rad")
path.set(xlabel="t", ylabel="q / rad", title="true motions", ylim=(-8, 8))
path.legend()
