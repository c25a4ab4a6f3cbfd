r"""
Where do orbits go?
===================

The phase portrait of a pendulum, and beside it a chain of them: one call each, since a row of starts is an
ensemble.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import Rational, cos

from canon import Event, Hamiltonian, coordinates, propagate

q = coordinates("q")
pendulum = Hamiltonian(q.momentum**2 / 2 - cos(q), [q], [q.momentum])
speeds = np.array([0.5, 1.0, 1.5, 1.9, 1.99, 2.01, 2.1, 2.5])
portrait = propagate(pendulum, (0, 15), np.array([0 * speeds, speeds]), samples=600)

# %%
# With a second well, :math:`V = q^4/4 - q^2/2`, and a drive, stirred by its period: a section at the phases
# of the drive, in which the time is a coordinate of its own.
phase = coordinates("phase")
push = Rational(1, 10) * q * cos(phase)
wells = q.momentum**2 / 2 - q**2 / 2 + q**4 / 4 - push
driven = Hamiltonian(wells + phase.momentum, [q, phase], [q.momentum, phase.momentum])
starts = np.array([np.linspace(-1.4, 1.4, 15), np.zeros(15), np.zeros(15), np.zeros(15)])
periods = 2 * np.pi * np.arange(400)
stirred = propagate(driven, (0, periods[-1]), starts, times=periods)

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
for k, speed in enumerate(speeds):
    left.plot(portrait.y[0, :, k], portrait.y[1, :, k], lw=0.9, color="C0" if speed < 2 else "C1")
left.set(xlabel="q", ylabel="p", xlim=(-2, 10), title="pendulum: librations, rotations")
for k in range(starts.shape[1]):
    right.plot(stirred.y[0, :, k], stirred.y[2, :, k], ".", ms=1)
right.set(xlabel="q", ylabel="p", title="two wells and a drive, stroboscopic")

# %%
# Which of them turned over? Those above the separatrix at p = 2:
turned = [speed for k, speed in enumerate(speeds) if portrait.y[0, -1, k] > np.pi]
print("turned over with the momenta", *turned)
upright = propagate(pendulum, (0, 20), [0, 2.01], events=[Event(q - np.pi, action="stop")])
print(f"the first time upright with p = 2.01 at t = {upright.t[-1]:.3f}")
