r"""
How fast must a top spin to stand?
==================================

Two of the three Euler angles of a heavy top are ignorable. What is left is the angle of nutation, and its
effective potential says whether the top stands: :math:`p_\psi^2 > 4 A m g h`.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import Symbol, cos, lambdify, series, sin, solve

from canon import Lagrangian, coordinates, parameters, routhian

theta, phi, psi = coordinates("theta phi psi")
A, C, m, g, h = parameters("A C m g h", positive=True)
spin = psi.dot + phi.dot * cos(theta)
T = A * (theta.dot**2 + phi.dot**2 * sin(theta) ** 2) / 2 + C * spin**2 / 2
reduced = routhian(Lagrangian(T - m * g * h * cos(theta), [theta, phi, psi]))
print("ignored:", reduced.note)
V = reduced.effective_potential.simplify()
print("V_eff =", V)

# %%
# Upright both momenta are equal. Near θ = 0 the potential is a parabola, up or down:
P = Symbol("P", positive=True)
upright = V.subs({phi.momentum: P, psi.momentum: P})
parabola = series(upright, theta, 0, 3).removeO().coeff(theta, 2)
print("V_eff'' / 2 =", parabola.simplify())

# %%
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
angles = np.linspace(-1.2, 1.2, 200)
for momentum in (1.0, 1.6, 2.0, 2.4):
    well = lambdify(theta, upright.subs({A: 1, C: 1, m: 1, g: 1, h: 1, P: momentum}))
    axes.plot(angles, well(angles) - well(1e-3), label=f"p = {momentum}")
axes.set(xlabel="θ / rad", ylabel="V_eff − V_eff(0)", title="Below p = 2 the top falls", ylim=(-0.4, 0.4))
axes.legend()

# %%
# The limit that every textbook has:
print("it stands from p =", *solve(parabola, P))
