r"""
What the rod of a pendulum has to hold
======================================

In Cartesian coordinates the rod is a constraint, :math:`x^2 + y^2 = l^2`, and the force along it is its
multiplier. On the constraint, and with the energy known, it is a function of the place alone: three times the
weight at the lowest point.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import Symbol

from canon import ConstrainedLagrangian, Lagrangian, coordinates, parameters, propagate
from canon.mechanics import constrained_motions

x, y = coordinates("x y")
m, g, l = parameters("m g l", positive=True)
free = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 + m * g * y, [x, y])  # y points down
pendulum = ConstrainedLagrangian(free, holonomic=[x**2 + y**2 - l**2])
for equation in pendulum.equations([Symbol("lambda")]):
    print(equation, "= 0")

# %%
# Released from rest at the height of the pivot, the energy :math:`T + V` is 0.
energy = m * (x.dot**2 + y.dot**2) / 2 - m * g * y
multiplier = constrained_motions(pendulum, integrals=[energy])[0].multipliers[0].factor()
print("λ =", multiplier)

# %%
# The force of the rod is :math:`\lambda\nabla f`, and :math:`|\nabla f| = 2l`. Along the motion, with no
# formula:
swing = propagate(pendulum, (0, 3), {x: 1, y: 0, "x_dot": 0, "y_dot": 0}, parameters={m: 1, g: 9.81, l: 1})
tension = -2 * swing.multipliers[0]

figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
axes.plot(swing.t, tension / 9.81)
axes.set(xlabel="t / s", ylabel="tension / weight", title="A pendulum released from the height of its pivot")

# %%
# By hand the tension is :math:`3mg\,y/l`:
print("largest difference:", np.abs(tension - 3 * 9.81 * swing["y"]).max())
lowest = -2 * l * multiplier.subs({x: 0, y: l})
print("tension at the lowest point:", lowest, "=", lowest / (m * g), "times the weight")
