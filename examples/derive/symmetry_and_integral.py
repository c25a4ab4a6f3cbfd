r"""
A symmetry and its integral
===========================

A charge moves in a uniform magnetic field. A shift along x changes the Lagrangian, and is a symmetry all the
same, because it changes it by a total derivative; a turn about the origin is one at once. Noether's theorem
gives an integral for each, and Poisson's theorem makes further ones out of them.
"""

import matplotlib.pyplot as plt
from sympy import Rational

from canon import Lagrangian, coordinates, hamiltonian, is_constant_of_motion, parameters, propagate
from canon.mechanics import is_symmetry, noether_charge, poissons_theorem

x, y = coordinates("x y")
m, w = parameters("m omega", positive=True)
half = Rational(1, 2)
charge = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 + half * m * w * (x * y.dot - y * x.dot), [x, y])

# %%
# The shift :math:`x \to x + \varepsilon`: without a compensating function it is no symmetry,
print(is_symmetry(charge, [1, 0]))

# %%
# but with :math:`K = \tfrac12 m\omega y` it is.
K = half * m * w * y
print("K =", K, "makes it one:", is_symmetry(charge, [1, 0], K=K).status)
in_x = noether_charge(charge, [1, 0], K=K)
in_y = noether_charge(charge, [0, 1], K=-half * m * w * x)
turn = noether_charge(charge, [-y, x])
print(in_x, in_y, turn, sep="\n")

# %%
# The same in momenta, as constants of the motion of H:
H = hamiltonian(charge)
to_momenta = dict(zip((x.dot, y.dot), H.q_dot, strict=True))
in_x, in_y, turn = (integral.subs(to_momenta).expand() for integral in (in_x, in_y, turn))
for I in (in_x, in_y, turn):
    print(I, "is constant:", is_constant_of_motion(I, H).status)

# %%
# Together they hold the centre of the circle, at :math:`x = P_y/m\omega`, :math:`y = -P_x/m\omega`:
start = {"x": 1, "y": 0, "x_dot": 0.5, "y_dot": 1}
circle = propagate(charge, (0, 6), start, parameters={m: 1, w: 1}, samples=200)
figure, axes = plt.subplots(figsize=(4, 4), layout="constrained")
axes.plot(circle["x"], circle["y"])
axes.plot(1 + 1, -0.5, "o")
axes.set(aspect="equal", xlabel="x", ylabel="y", title="A charge in a magnetic field, and its centre")

# %%
# The bracket of two integrals is an integral. Here it is a number: the two shifts do not commute in a
# magnetic field.
bracket, verdict = poissons_theorem(in_x, in_y, H)
print("{P_x, P_y} =", bracket.expand(), verdict.status)
