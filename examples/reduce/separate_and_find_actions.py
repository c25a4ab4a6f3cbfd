r"""
Does it separate? Then it has actions
=====================================

A body is drawn to a centre and by a uniform force. In Cartesian coordinates it does not separate; canon finds
the coordinates in which it does, and encloses action, frequency and turning points of a motion between certain
bounds.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

from canon import Event, Hamiltonian, propagate
from canon.mechanics import action_variables, hamilton_jacobi, is_separable

x, y, px, py = sp.symbols("x y p_x p_y", real=True)
F = sp.Rational(1, 20)
stark = Hamiltonian((px**2 + py**2) / 2 - 1 / sp.sqrt(x**2 + y**2) - F * x, [x, y], [px, py])
print(is_separable(stark))

# %%
found = hamilton_jacobi(stark, "any")
print(found.chart.name, "coordinates:", found.chart.position)
for momentum in found.momenta:
    print(f"{momentum.p}² =", momentum.square)
print(found.is_complete_integral().status, "is a complete integral")

# %%
# The constants of the separation are integrals of the motion. One of them is the energy, the other is new:
for constant, meaning in found.defined_as.items():
    print(constant, "=", meaning)

# %%
# A torus of this motion: its actions and frequencies, each in a ball that certainly holds it.
u, v = found.chart.q
pu, pv = (momentum.p for momentum in found.momenta)
torus = action_variables(found, {u: 1, v: sp.Rational(1, 2), pu: 0.3, pv: 0.4}, digits=15)
print(torus)

# %%
# Librations counted along a motion of the same start, which knows nothing of actions:
H = Hamiltonian(found.defined_as[found.energy], [u, v], [pu, pv])
span = 2000
motion = propagate(H, (0, span), [1, 0.5, 0.3, 0.4], events=[Event(pu, name="u"), Event(pv, name="v")])
for name, ball in zip("uv", torus.frequencies, strict=True):
    turns = sum(met.event.name == name for met in motion.events) / 2
    print(f"ω_{name}: {2 * np.pi * turns / span:.3f} counted, {float(ball):.12f} by the torus")

# %%
# A little of the same orbit, back in the plane:
some = propagate(H, (0, 120), [1, 0.5, 0.3, 0.4], samples=2000)
figure, axes = plt.subplots(figsize=(4.5, 4), layout="constrained")
axes.plot(some["u"] ** 2 / 2 - some["v"] ** 2 / 2, some["u"] * some["v"], lw=0.6)
axes.set(aspect="equal", xlabel="x", ylabel="y", title="An orbit fills what its two constants allow")
