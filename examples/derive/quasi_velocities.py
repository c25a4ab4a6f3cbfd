r"""
Euler's equations from the energy of acceleration
=================================================

The angular velocity of a body is no velocity of any coordinates: it is a quasi-velocity. Gibbs's and Appell's
function takes it as it is, and Euler's equations come out.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

from canon import GibbsAppell, RigidBody, coordinates, equivalent_equations, parameters, propagate
from canon.mechanics import euler_rotation

phi, theta, psi = coordinates("phi theta psi")
A, B, C = parameters("A B C", positive=True)
wx, wy, wz = sp.symbols("omega_x omega_y omega_z", real=True)

# %%
# Euler's angles turn with these velocities where the body turns with ω, written along its own axes:
rates = [
    (wx * sp.sin(psi) + wy * sp.cos(psi)) / sp.sin(theta),
    wx * sp.cos(psi) - wy * sp.sin(psi),
    wz - (wx * sp.sin(psi) + wy * sp.cos(psi)) * sp.cos(theta) / sp.sin(theta),
]
body = RigidBody(1, [0, 0, 0], inertia=[A, B, C], rotation=euler_rotation(phi, theta, psi))
top = GibbsAppell([body], [phi, theta, psi], u=[wx, wy, wz], q_dot=rates)

# %%
# Are they Euler's equations?
ax, ay, az = top.u_dot
eulers = [A * ax - (B - C) * wy * wz, B * ay - (C - A) * wz * wx, C * az - (A - B) * wx * wy]
print(equivalent_equations(top.equations, eulers, [ax, ay, az]))

# %%
# Turned about its middle axis a body does not stay so: it tumbles, again and again (the tennis racket).
start = {phi: 0, theta: 1.5, psi: 0, wx: 0.001, wy: 1, wz: 0}
racket = propagate(top, (0, 100), start, parameters={A: 1, B: 2, C: 3}, samples=1000)
figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
axes.plot(racket.t, racket["omega_y"])
axes.set(xlabel="t", ylabel="ω about the middle axis", title="A body that turns about its middle axis")

# %%
# The energy and the square of the angular momentum stay what they were:
x, y, z = (racket[name] for name in ("omega_x", "omega_y", "omega_z"))
energy, square = (x**2 + 2 * y**2 + 3 * z**2) / 2, x**2 + 4 * y**2 + 9 * z**2
print(f"energy {energy[0]:.6f}, changed by at most {np.ptp(energy):.0e}")
print(f"angular momentum squared {square[0]:.6f}, changed by at most {np.ptp(square):.0e}")
