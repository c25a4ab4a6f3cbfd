r"""
A bead that leaves the hoop
===========================

A bead slides down the outside of a hoop, which pushes it and can't hold it. Where the push would have to become
a pull the bead flies off: at two thirds of the height, whatever the hoop's size and the strength of gravity.
"""

import matplotlib.pyplot as plt
import numpy as np

from canon import Lagrangian, coordinates, parameters, propagate
from canon.mechanics import UnilateralLagrangian

x, y = coordinates("x y")
R, g = parameters("R g", positive=True)
free = Lagrangian((x.dot**2 + y.dot**2) / 2 - g * y, [x, y])
hoop = UnilateralLagrangian(free, x**2 + y**2 - R**2)  # what is not negative

# %%
# It begins at the top, nearly at rest. Without a coefficient of restitution a motion would end where it met
# the hoop again; here it doesn't.
v = 0.02
slide = propagate(hoop, (0, 1.85), [0, 1, v, 0], parameters={g: 9.81, R: 1}, samples=400)
left = slide.events[0]
print(left)

# %%
figure, axes = plt.subplots(figsize=(4, 4), layout="constrained")
turn = np.linspace(0, np.pi, 200)
axes.plot(np.cos(turn), np.sin(turn), color="0.7")
axes.plot(slide["x"], slide["y"])
axes.plot(*left.y[:2], "o")
axes.set(
    aspect="equal", xlabel="x / R", ylabel="y / R", ylim=(-0.6, 1.2), title="It leaves at 2/3 of the height"
)

# %%
# By hand: the energy gives the speed, and the push vanishes where :math:`v^2 = g y`, so :math:`y = (2gR +
# v_0^2)/3g`.
print(f"leaves at y = {left.y[1]:.12f}, by hand {(2 * 9.81 + v**2) / (3 * 9.81):.12f}")
