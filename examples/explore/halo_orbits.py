r"""
Halo orbits between Earth and Moon
==================================

Behind the Moon a spacecraft can circle a point where there is nothing, always in sight of the Earth. One such orbit of
JPL's catalogue, made exact by Newton's method on the tangent map, and its family towards the Moon: halfway it is stable
for a while, and near the Moon again (J. V. Breakwell, J. V. Brown, Celest. Mech. 20 (1979) 389).
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import Float, sqrt

from canon import Hamiltonian, coordinates, propagate
from canon.flow import continue_family, periodic_orbit

x, y, z = coordinates("x y z")
px, py, pz = x.momentum, y.momentum, z.momentum
mu = Float("0.01215058560962404", 17)  # the Moon's share of both masses
earth, moon = (sqrt((x + a) ** 2 + y**2 + z**2) for a in (mu, mu - 1))
frame = Hamiltonian(
    (px**2 + py**2 + pz**2) / 2 + px * y - py * x - (1 - mu) / earth - mu / moon, [x, y, z], [px, py, pz]
)
x0, z0, speed = 1.1808985497899205, 1.0295054075242347e-4, -0.15585631393981156
first = periodic_orbit(frame, [x0, 0, z0, 0, speed + x0, 0], 3.4155, reversal=["y", "p_x", "p_z"])
family = continue_family(first, 26, 0.02)


def index(orbit):
    """Return the largest ½|λ + 1/λ| of the multipliers: an orbit is stable where it is 1."""
    largest = abs(orbit.multipliers.values).max()
    return (largest + 1 / largest) / 2


indices = np.array([index(orbit) for orbit in family.orbits])
steady = int(np.argmin(indices))
print(f"period {first.period:.10f}, in the catalogue 3.4155308066")
print(f"{len(family.orbits)} orbits: {family.ended}")
print(
    f"unstable by {indices[0]:.0f} a turn at first, by {indices[steady]:.2f} at the period {family.periods[steady]:.3f}"
)

# %%
figure, (side, growth) = plt.subplots(1, 2, figsize=(8, 3.6), layout="constrained")
for orbit in family.orbits[::3]:
    motion = propagate(frame, (0, orbit.period), orbit.y, samples=400)
    side.plot(motion["y"], motion["z"], linewidth=1)
side.plot(0, 0, "o", color="grey", label="the Moon, seen from the Earth")
side.set(xlabel="y", ylabel="z", aspect="equal")
side.legend(loc="upper left", bbox_to_anchor=(0, 1.14), frameon=False)
growth.semilogy(family.periods, indices, ".-")
growth.axhline(1, color="grey", linewidth=0.8)
growth.set(xlabel="period", ylabel="growth of a deviation in a turn")
