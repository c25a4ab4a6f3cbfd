r"""
From SymPy: LagrangesMethod and KanesMethod
===========================================

Models of ``sympy.physics.mechanics`` work as they are. One pendulum, by Lagrange and by
Kane, must make one motion.
"""

import matplotlib.pyplot as plt
import sympy as sp
from sympy.physics.mechanics import (
    KanesMethod,
    LagrangesMethod,
    Particle,
    Point,
    ReferenceFrame,
    dynamicsymbols,
)

from canon import from_sympy_mechanics, propagate

theta, omega = dynamicsymbols("theta omega")
m, l, g = sp.symbols("m l g", positive=True)

# %%
# The pendulum by Lagrange,
L = m * l**2 * theta.diff() ** 2 / 2 + m * g * l * sp.cos(theta)
by_lagrange = LagrangesMethod(L, [theta])

# %%
# and by Kane:
N, O = ReferenceFrame("N"), Point("O")
A = N.orientnew("A", "Axis", [theta, N.z])
A.set_ang_vel(N, omega * N.z)
O.set_vel(N, 0)
P = O.locatenew("P", l * A.x)
P.v2pt_theory(O, N, A)
by_kane = KanesMethod(N, q_ind=[theta], u_ind=[omega], kd_eqs=[theta.diff() - omega])
by_kane.kanes_equations([Particle("bob", P, m)], [(P, m * g * N.x)])

# %%
numbers = {m: 1, l: 1, g: 9.81}
first = propagate(by_lagrange, (0, 5), [2.0, 0.0], parameters=numbers)
second = propagate(by_kane, (0, 5), [2.0, 0.0], parameters=numbers)
figure, axes = plt.subplots(figsize=(6, 2.6), layout="constrained")
axes.plot(first.t, first.y[0], label="Lagrange")
axes.plot(second.t, second.y[0], "--", label="Kane")
axes.set(xlabel="t / s", ylabel="θ / rad", title="One pendulum, two of SymPy's methods")
axes.legend()

# %%
print(from_sympy_mechanics(by_lagrange).lagrangian.equations)
print("they differ by", abs(first.y[:, -1] - second.y[:, -1]).max())
