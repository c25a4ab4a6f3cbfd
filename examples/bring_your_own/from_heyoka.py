r"""
From heyoka: a list of pairs
============================

A system written for ``heyoka.taylor_adaptive`` goes to ``propagate`` as it is. In canon one would write its
energy; then the error is measured as well.
"""

import heyoka as hy
import matplotlib.pyplot as plt
import numpy as np
from sympy import Rational, cos

from canon import Hamiltonian, coordinates, drift, propagate

x, v = hy.make_vars("x", "v")
system = [(x, v), (v, -9.8 * hy.sin(x))]
by_hand = hy.taylor_adaptive(system, [2.5, 0.0])
by_hand.propagate_until(50.0)

# %%
taken = propagate(system, (0, 50), [2.5, 0.0])
print("difference:", np.abs(taken.y[:, -1] - by_hand.state).max())

# %%
q = coordinates("q")
pendulum = Hamiltonian(q.momentum**2 / 2 - Rational("9.8") * cos(q), [q], [q.momentum])
run = propagate(pendulum, (0, 20_000), [2.5, 0.0], samples=2000)
print(drift(run))

# %%
# Another precision is a word:
figure, (motion, energy) = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
for precision in ("double", "quad"):
    run = propagate(pendulum, (0, 50), [2.5, 0.0], precision=precision)
    error = abs(run.energy_error).astype(float)
    energy.semilogy(run.t[1:], error[1:], label=precision)
    print(f"{precision:7} max |ΔE/E| = {error.max():.0e}")

# %%
# The motion of the list of pairs, where it ended by hand, and what only an energy tells:
motion.plot(taken.t, taken.y[0])
motion.plot(by_hand.time, by_hand.state[0], "ro")
motion.set(xlabel="t", ylabel="x", title="Taken as it is; red: its end by hand")
energy.set(xlabel="t", ylabel="|ΔE/E|", title="The error of its energy")
energy.legend(loc="center right")
