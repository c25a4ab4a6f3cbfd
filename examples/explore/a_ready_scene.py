r"""
A ready scene, and what is known of it
======================================

A scene has its equations, its parameters, starts and truths that can be checked: constants of the motion,
frequencies, exact solutions. Here is Atwood's machine with one mass that swings; with the ratio of masses 3 it
is integrable.
"""

import matplotlib.pyplot as plt

from canon import propagate
from canon.plot import plot_scene
from canon.scene import find
from canon.scene.known_truths import check
from canon.scene.scene_motion import run

scene = find("swinging-atwood")
print(scene.title)
print("L =", scene.lagrangian.L)
print("H =", scene.hamiltonian.H)

# %%
# Its constants, and whether they are:
for verdict in check(scene):
    print(verdict)

# %%
# How it looks: the pulleys stand still, and the swinging mass draws a loop.
motion = run(scene, periods=20, samples=2000)
figure, axes = plt.subplots(figsize=(5, 5), layout="constrained")
plot_scene(motion, axes)

# %%
# The same by its name, from another start, with the energy followed:
orbit = propagate("swinging-atwood", (0, 60), "pushed")
print(f"energy off by at most {abs(orbit.energy_error).max():.0e}")
