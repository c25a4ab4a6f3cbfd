r"""
Is the computed flow symplectic?
================================

Not the equations, the *numbers*: the Jacobian of what a method computed, and how far :math:`M^TJM` is from
:math:`J`. A symplectic method keeps it to round-off at any step; the others only as far as they are accurate.
"""

import matplotlib.pyplot as plt

from canon import RK4, Gauss, Splitting, flow_jacobian
from canon.flow import reversal_error

steps = [0.4, 0.2, 0.1, 0.05]
methods = {"RK4": RK4(), "verlet": Splitting("verlet"), "Gauss of 2 stages": Gauss(2)}

# %%
defects = {
    name: [
        flow_jacobian("henon-heiles", (0, 20), method=method, step=h, samples=2).symplecticity_defect[-1]
        for h in steps
    ]
    for name, method in methods.items()
}
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
for name, row in defects.items():
    axes.loglog(steps, row, "o-", label=name)
axes.set_xticks(steps, [str(h) for h in steps], minor=False)
axes.set_xticks([], minor=True)
axes.set(xlabel="step", ylabel="|MᵀJM − J|", title="after 20 units of time")
axes.legend()

# %%
# The other test of a symmetric method: there and back again.
for name, method in methods.items():
    back = abs(reversal_error("henon-heiles", (0, 20), method=method, step=0.2)).max()
    print(f"{name:18} symplectic to {defects[name][1]:.0e}, comes back to {back:.0e}")
