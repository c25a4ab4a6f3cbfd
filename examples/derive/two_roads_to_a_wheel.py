r"""
One wheel, two books
====================

A solid wheel rolls down a slope. Lagrange's book takes the rolling condition in at once; Newton's and Euler's
keeps the friction and throws it out at the end. Are the equations the same? That is a question with a verdict.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import Symbol, lambdify, pi, sin, solve

from canon import Lagrangian, PlanarBody, coordinates, equivalent_equations, kinetic_energy, parameters

s, phi = coordinates("s phi")
m, R, g, alpha = parameters("m R g alpha", positive=True)
inertia = m * R**2 / 2

# %%
# Lagrange: :math:`\varphi = s/R`, so one coordinate is enough.
wheel = PlanarBody(m, [s, 0], moment=inertia, angle=s / R)
lagranges = Lagrangian(kinetic_energy([wheel], [s]) + m * g * sin(alpha) * s, [s])
print("Lagrange:", lagranges.equations[0], "= 0")

# %%
# Newton and Euler: the friction F acts up the slope and turns the wheel.
F = Symbol("F", real=True)
newtons = [m * s.ddot - m * g * sin(alpha) + F, inertia * phi.ddot - R * F, s.ddot - R * phi.ddot]
unknowns = [s.ddot, phi.ddot, F]
with_friction = [*lagranges.equations, phi.ddot - s.ddot / R, F - m * g * sin(alpha) / 3]
print(equivalent_equations(newtons, with_friction, unknowns))

# %%
# The wrong friction, half of the weight's part along the slope, is found out with numbers:
wrong = [*lagranges.equations, phi.ddot - s.ddot / R, F - m * g * sin(alpha) / 2]
print(equivalent_equations(newtons, wrong, unknowns))

# %%
# Newton's equations for any friction: only where it is a third of the weight's part along the slope does the rim
# turn as fast as the wheel advances, and there the acceleration is Lagrange's.
free = solve(newtons[:2], [s.ddot, phi.ddot])
numbers = {m: 1, R: 1, g: 1, alpha: pi / 2}
along, rim = (lambdify(F, each.subs(numbers)) for each in (free[s.ddot], R * free[phi.ddot]))
friction = np.array([0, 0.6])
figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
axes.plot(friction, along(friction), label="s̈, Newton")
axes.plot(friction, rim(friction), label="R φ̈, Euler")
axes.axhline(lagranges.accelerations[0].subs(numbers), color="grey", ls="--", label="s̈, Lagrange")
axes.plot([0.5, 0.5], [along(0.5), rim(0.5)], "rx", label="the wrong friction")
axes.set(xlabel="F / (m g sin α)", ylabel="acceleration / (g sin α)", title="Two books, one point")
axes.legend(loc="center left", bbox_to_anchor=(1, 0.5))

# %%
# The result that one remembers: two thirds of the acceleration without friction.
acceleration = lagranges.accelerations[0]
print("s̈ =", acceleration, "=", acceleration / (g * sin(alpha)), "of g sin α")
