r"""
Let canon choose, and check what it promised
============================================

A hundred thousand periods, the energy right to nine digits: which method, which step? ``choose`` makes short
runs, and foretells cost and error of the long one. It is run here, to see whether the promise was kept.
"""

import matplotlib.pyplot as plt

from canon import choose
from canon.plot import plot_energy_error
from canon.scene import find

pendulum = find("simple-pendulum")
choice = choose(pendulum, 1e5 * pendulum.period, accuracy=1e-9)
print(choice)

# %%
run = choice.run(samples=2000)
figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
plot_energy_error(run, axes)

# %%
print(f"{choice.method}, step {choice.step or 'of its own'}, {choice.precision}")
print(f"error: foretold {choice.predicted_error:.1e}, found {abs(run.energy_error).max():.1e}, wanted 1e-09")
