r"""
Double pendulum: from two places to two frequencies
===================================================

Two masses hang on two rods. Say where the masses are; the kinetic energy, the equations of motion and, near
rest, the two frequencies :math:`\omega^2 = (2 \pm \sqrt2)\,g/l` follow.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp
from sympy import cos, sin

from canon import Particle, coordinates, lagrangian_of_bodies, parameters, propagate
from canon.mechanics import gravity

theta, phi = coordinates("theta phi")
m, l, g = parameters("m l g", positive=True)

# %%
# The y axis points down, and so does gravity.
upper = sp.Matrix([l * sin(theta), l * cos(theta)])
lower = upper + sp.Matrix([l * sin(phi), l * cos(phi)])
bobs = [Particle(m, upper), Particle(m, lower)]
pendulum = lagrangian_of_bodies(bobs, [theta, phi], V=gravity(bobs, [0, g]))
for equation in pendulum.equations:
    print(sp.simplify(equation), "= 0")

# %%
# Near rest the equations are linear, :math:`M\ddot q + Kq = 0`, and :math:`\det(K - \omega^2 M) = 0`.
rest = dict.fromkeys([theta, phi, theta.dot, phi.dot, theta.ddot, phi.ddot], 0)
equations = sp.Matrix(pendulum.equations)
M = equations.jacobian([theta.ddot, phi.ddot]).subs(rest)
K = equations.jacobian([theta, phi]).subs(rest)
squares = sp.solve((K - sp.Symbol("w2") * M).det(), sp.Symbol("w2"))
print("ω² =", squares)

# %%
# In the slow mode the lower rod swings √2 times as far. From a small start like that, both cross zero
# together:
slow = propagate(
    pendulum, (0, 10), [0.02, 0.02 * 2**0.5, 0, 0], parameters={m: 1, l: 1, g: 9.81}, samples=400
)
figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
axes.plot(slow.t, slow["theta"], label="θ")
axes.plot(slow.t, slow["phi"], label="φ")
axes.set(xlabel="t / s", ylabel="angle / rad", title="The slow mode of a double pendulum")
axes.legend()

# %%
# Its period by the formula, and counted on the motion:
period = 2 * np.pi / float(sp.sqrt((2 - sp.sqrt(2)) * 9.81))
falling = np.flatnonzero((slow["theta"][:-1] > 0) & (slow["theta"][1:] <= 0))
seen = (slow.t[falling[-1]] - slow.t[falling[0]]) / (len(falling) - 1)
print(f"period: {period:.2f} s by the formula, {seen:.2f} s on the motion")
