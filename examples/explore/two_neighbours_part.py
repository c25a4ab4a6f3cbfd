r"""
Two neighbours part
===================

Two double pendulums, let go a hair's breadth apart. How fast they part does not depend on the hair: it is the
exponent of the motion, and the Jacobian of the flow has it without a second pendulum.
"""

import matplotlib.pyplot as plt
import numpy as np

from canon import flow_jacobian, propagate

times = np.linspace(0, 60, 601)
start = np.array([2.0, 2.5, 0, 0])
both = np.column_stack([start, start + np.array([1e-9, 0, 0, 0])])
apart = propagate("double-pendulum", (0, 60), both, times=times)
distance = np.linalg.norm(apart.y[:, :, 1] - apart.y[:, :, 0], axis=0)

# %%
# The Jacobian along the first of them, ‖∂y(t)/∂y(0)‖, tells the same story and does not saturate:
tangent = flow_jacobian("double-pendulum", (0, 60), start, times=times)
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.semilogy(times, distance / 1e-9, label="two pendulums")
axes.semilogy(times, np.exp(tangent.log_size), label="Jacobian")
axes.set(
    xlabel="t / s", ylabel="distance / distance at first", title="Double pendulum, let go from 115° and 143°"
)
axes.legend()

# %%
exponent = tangent.log_size[-1] / times[-1]
print(f"exponent {exponent:.2f}/s: an error grows tenfold in {np.log(10) / exponent:.1f} s")
print(f"symplectic to {tangent.symplecticity_defect[100]:.0e} after 10 s")
