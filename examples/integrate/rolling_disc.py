r"""
A disc that rolls and must not slip
===================================

No slipping is a condition on velocities that no choice of coordinates takes away. canon keeps it, gives the
force of friction that does so, and knows how much work the motor did.
"""

import matplotlib.pyplot as plt
from sympy import cos, sin

from canon import ConstrainedLagrangian, Lagrangian, coordinates, parameters, propagate

x, y, heading, phi = coordinates("x y heading phi")
m, R, I, J, M = parameters("m R I J M", positive=True)
T = m * (x.dot**2 + y.dot**2) / 2 + I * heading.dot**2 / 2 + J * phi.dot**2 / 2
driven = Lagrangian(T, [x, y, heading, phi], forces=[0, 0, 0, M])
disc = ConstrainedLagrangian(
    driven, nonholonomic=[x.dot - R * phi.dot * cos(heading), y.dot - R * phi.dot * sin(heading)]
)
print("degrees of freedom:", disc.degrees_of_freedom)

# %%
values = {m: 2, R: 0.5, I: 0.1, J: 0.25, M: 0.2}
start = {"x": 0, "y": 0, "heading": 0, "phi": 0}
start |= {"x_dot": 0.5, "y_dot": 0, "heading_dot": 1, "phi_dot": 1}
rolling = propagate(disc, (0, 20), start, parameters=values, samples=500)

figure, axes = plt.subplots(figsize=(4.5, 4.5), layout="constrained")
axes.plot(rolling["x"], rolling["y"])
axes.set(aspect="equal", xlabel="x / m", ylabel="y / m", title="A motor makes the circle a spiral")

# %%
print(f"slip: {abs(rolling.residuals).max():.0e} m/s")
print(f"work of the motor {rolling.work[-1]:.6f} J, change of energy {rolling.energy_change[-1]:.6f} J")
expected = 1 + 20 * 0.2 / (0.25 + 2 * 0.5**2)
print(f"φ̇ at the end {rolling['phi_dot'][-1]:.9f}, by hand {expected:.9f}")
