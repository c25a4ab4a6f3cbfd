r"""
The period of a pendulum, to the sixth order
============================================

How much slower does a pendulum swing where it swings far? Its normal form says so, as a series whose
coefficients are exact, and the same series stands in Huygens's tables: :math:`T/T_0 = 1 + \theta_0^2/16 +
11\,\theta_0^4/3072 + \dots`
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import Rational, cos, lambdify

from canon import Event, Hamiltonian, birkhoff_normal_form, coordinates, parameters, propagate
from canon.mechanics import is_normal_form

q, p = coordinates("q"), parameters("p")
pendulum = Hamiltonian(p**2 / 2 - cos(q), [q], [p])
form = birkhoff_normal_form(pendulum, 6)
print(form.in_actions())
print(is_normal_form(form))

# %%
# :math:`\omega = \partial K/\partial I`, and :math:`I` from the energy of a start at rest, :math:`E = 1 -
# \cos\theta_0`.
(I,) = form.actions
frequency = form.in_actions().diff(I)
print("ω =", frequency)
energy = lambdify(I, form.in_actions() - form.in_actions().subs(I, 0))

# %%
# Periods of true motions, from one passage through the bottom to the next but one:
amplitudes = np.linspace(0.1, 2.0, 12)
found = []
for amplitude in amplitudes:
    swing = propagate(pendulum, (0, 25), [amplitude, 0], events=[Event(q)])
    found.append(swing.events[2].t - swing.events[0].t)
actions = np.linspace(0, 1.2, 400)
reached = np.arccos(1 - energy(actions))
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(amplitudes, np.array(found) / (2 * np.pi), "o", label="motions")
axes.plot(reached, 1 / lambdify(I, frequency)(actions), label="normal form of degree 6")
axes.set(xlabel="amplitude / rad", ylabel="T / T₀", title="Period of a pendulum")
axes.legend()

# %%
small, series = found[0] / (2 * np.pi), 1 + Rational(1, 1600) + Rational(11, 3072) / 10**4
print(f"T/T₀ at 0.1 rad: {small:.8f} on a motion, {float(series):.8f} by Huygens's series")
