r"""
Is one step of a method a canonical map?
========================================

A step of Verlet's method takes (q, p) to (Q, P), and so does one of Heun's. The first is canonical for every
step h, which is why its energy stays; the second is not, and loses.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import Rational, lambdify

from canon import Hamiltonian, coordinates, parameters
from canon.mechanics import runge_kutta_step, splitting_step

q, p, h = coordinates("q"), parameters("p"), parameters("h", positive=True)
oscillator = Hamiltonian(p**2 / 2 + q**2 / 2 + q**4 / 4, [q], [p])

# %%
# Verlet: half a kick, a drift, half a kick. Heun: the Runge–Kutta method of two stages.
verlet = splitting_step(oscillator, h, kicks=[Rational(1, 2), Rational(1, 2)], drifts=[1])
heun = runge_kutta_step(oscillator, h, A=[[0, 0], [1, 0]], b=[Rational(1, 2), Rational(1, 2)])
print("Verlet:", verlet.is_canonical())
print("Heun:  ", heun.is_canonical())

# %%
# Heun's step changes areas, from the fourth power of h on:
area = heun.jacobian.det().expand()
print("area after a step of Heun's: 1 + h⁴ times", area.coeff(h, 4))

# %%
# A hundred and twenty steps of both, from the same start:
figure, axes = plt.subplots(1, 2, figsize=(7, 3.3), layout="constrained", sharey=True)
ends = {}
for ax, (name, step) in zip(axes, {"Verlet": verlet, "Heun": heun}.items(), strict=True):
    advance = lambdify((q, p, h), step.images)
    states = [(1.0, 0.0)]
    for _ in range(120):
        states.append(tuple(advance(*states[-1], 0.25)))
    x, y = np.transpose(states)
    ax.plot(x, y, ".", ms=2)
    ax.set(xlabel="q", title=name, xlim=(-1.6, 1.6), ylim=(-1.9, 1.9))
    ends[name] = y[-1] ** 2 / 2 + x[-1] ** 2 / 2 + x[-1] ** 4 / 4
axes[0].set_ylabel("p")

# %%
print("energy at first: 0.750000")
print("after 120 steps: ", ", ".join(f"{name} {energy:.6f}" for name, energy in ends.items()))
