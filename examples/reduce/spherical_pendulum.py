r"""
Routh takes an angle out
========================

The angle about the vertical does not appear in the Lagrangian of a spherical pendulum. Routh's procedure takes
it out; what is left moves in one dimension, in an effective potential.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import cos, lambdify, sin

from canon import Lagrangian, coordinates, parameters, propagate, routhian

theta, phi = coordinates("theta phi")
m, l, g = parameters("m l g", positive=True)
T = m * l**2 * (theta.dot**2 + sin(theta) ** 2 * phi.dot**2) / 2
reduced = routhian(Lagrangian(T + m * g * l * cos(theta), [theta, phi]))
print("ignored: ", reduced.note)
print("V_eff =", reduced.effective_potential)
print("dφ/dt =", *reduced.ignorable_velocities)

# %%
# The reduced system knows how to bring the angle back: a motion of it has both.
values = {m: 1, l: 1, g: 9.81}
start = {"theta": 1, "phi": 0, "theta_dot": 0, "p_phi": 0.5}
swing = propagate(reduced, (0, 20), start, parameters=values, samples=2000)
figure, (well, above) = plt.subplots(1, 2, figsize=(8, 3.6), layout="constrained")
potential = lambdify(theta, reduced.effective_potential.subs({**values, phi.momentum: 0.5}))
angles = np.linspace(0.05, 1.6, 200)
well.plot(angles, potential(angles))
energy = potential(1.0)
well.plot([swing["theta"].min(), swing["theta"].max()], [energy] * 2)
well.set(xlabel="θ / rad", ylabel="V_eff / J", ylim=(-10, 2), title="effective potential")
x, y = np.sin(swing["theta"]) * np.cos(swing["phi"]), np.sin(swing["theta"]) * np.sin(swing["phi"])
above.plot(x, y, lw=0.7)
above.set(aspect="equal", xlabel="x / l", ylabel="y / l", title="seen from above")

# %%
# Where it turns, :math:`V_\mathrm{eff} = E`; beside it the smallest angle of the motion:
lower = angles[np.flatnonzero(potential(angles) < energy)[0]]
print(f"turns at θ = {lower:.2f} by the potential, {swing['theta'].min():.2f} on the motion")
