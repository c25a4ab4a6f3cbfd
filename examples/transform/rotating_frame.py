r"""
Into a rotating frame
=====================

A frame that turns with the angular velocity :math:`\Omega` is a point transformation that depends on the time.
What it adds to the Hamiltonian is :math:`-\Omega` times the angular momentum; Coriolis's and the centrifugal
force come out of that.
"""

import matplotlib.pyplot as plt
import sympy as sp
from sympy import cos, sin

from canon import Hamiltonian, coordinates, equal, lagrangian, parameters, point_transformation, propagate
from canon import time as t
from canon.mechanics import transformed_hamiltonian

x, y = coordinates("x y")
px, py = parameters("p_x p_y")
m, W = parameters("m Omega", positive=True)

# %%
turned = [x * cos(W * t) + y * sin(W * t), -x * sin(W * t) + y * cos(W * t)]
frame = point_transformation([x, y], [px, py], turned)
print(frame.is_canonical().status)
print("P =", *(sp.simplify(image) for image in frame.new_p), sep="\n    ")

# %%
# A free particle, seen from the frame:
X, Y = coordinates("X Y")
free = Hamiltonian((px**2 + py**2) / (2 * m), [x, y], [px, py])
K = transformed_hamiltonian(frame, free, [X, Y], [X.momentum, Y.momentum])
K = Hamiltonian(sp.simplify(K.H), K.q, K.p)  # canon never simplifies by itself
print("K =", K.H)

# %%
# As a Lagrangian, and its equations of motion solved for the accelerations:
seen = lagrangian(K)
for name, acceleration in zip("XY", seen.accelerations, strict=True):
    print(f"{name}'' =", sp.simplify(acceleration))

# %%
# A straight line, seen from the frame:
line = propagate(
    seen, (0, 10), {"X": 1, "Y": 0, "X_dot": 0, "Y_dot": -0.5}, parameters={m: 1, W: 1}, samples=300
)
figure, axes = plt.subplots(figsize=(4, 4), layout="constrained")
axes.plot(line["X"], line["Y"])
axes.set(aspect="equal", xlabel="X", ylabel="Y", title="A free particle, seen from a merry-go-round")

# %%
# Coriolis :math:`2\Omega\dot Y` and centrifugal :math:`\Omega^2X`, as they should be; and the sign everybody
# gets wrong once:
print(equal(seen.accelerations[0], W**2 * X + 2 * W * Y.dot).status)
print(equal(seen.accelerations[0], W**2 * X - 2 * W * Y.dot))
