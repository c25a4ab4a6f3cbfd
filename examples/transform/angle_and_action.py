r"""
Angle and action of the oscillator, by four functions
=====================================================

:math:`Q = \arctan(m\omega q/p)`, :math:`P = (p^2 + m^2\omega^2q^2)/2m\omega` makes circles of the oscillator's
ellipses. It is canonical, so it has a generating function of each type; with a 2 forgotten it is not.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import atan

from canon import CanonicalTransformation, coordinates, generating_function, new_hamiltonian, parameters

q, p = coordinates("q"), parameters("p")
m, w = parameters("m omega", positive=True)
action = (p**2 + m**2 * w**2 * q**2) / (2 * m * w)
to_action = CanonicalTransformation([q], [p], new_q=[atan(m * w * q / p)], new_p=[action])

# %%
print(to_action.is_canonical())
for kind in (1, 2, 3, 4):
    print(f"F{kind} =", generating_function(to_action, kind).F)

# %%
# The forgotten 2 makes every area twice as large:
forgotten = CanonicalTransformation([q], [p], new_q=[atan(m * w * q / p)], new_p=[2 * action])
print(forgotten.is_canonical().status, "with valence", forgotten.valence)

# %%
# In the plane: the map takes an ellipse to a straight line P = const, and a little square keeps its area.
figure, (old, new) = plt.subplots(1, 2, figsize=(7, 3), layout="constrained")
turn = np.linspace(0, 2 * np.pi, 200)
for size in (0.5, 1.0, 1.5):
    ellipse = size * np.cos(turn) / np.sqrt(2), size * np.sin(turn) * np.sqrt(2)
    old.plot(*ellipse, color="C0")
    new.plot((-np.pi / 2, np.pi / 2), (size**2 / 2,) * 2, color="C0")
old.set(xlabel="q", ylabel="p", title="old variables", aspect="equal")
new.set(xlabel="Q", ylabel="P", title="new variables")

# %%
# In the new variables nothing is left to solve, :math:`K = \omega P`:
K = new_hamiltonian(to_action, p**2 / (2 * m) + m * w**2 * q**2 / 2)
print("K / P =", (K / action).simplify())
