r"""
One wheel, two books
====================

A solid wheel rolls down a slope. Lagrange's book takes the rolling condition in at once; Newton's and Euler's
keeps the friction and throws it out at the end. Are the equations the same? That is a question with a verdict.
"""

from sympy import Symbol, sin

from canon import Lagrangian, PlanarBody, coordinates, equivalent_equations, kinetic_energy, parameters

s, phi = coordinates("s phi")
m, R, g, alpha = parameters("m R g alpha", positive=True)
inertia = m * R**2 / 2

# %%
# Lagrange: :math:`\varphi = s/R`, so one coordinate is enough.
wheel = PlanarBody(m, [s, 0], moment=inertia, angle=s / R)
lagranges = Lagrangian(kinetic_energy([wheel], [s]) + m * g * sin(alpha) * s, [s])
print("Lagrange:", lagranges.equations[0], "= 0")

# %%
# Newton and Euler: the friction F acts up the slope and turns the wheel.
F = Symbol("F", real=True)
newtons = [m * s.ddot - m * g * sin(alpha) + F, inertia * phi.ddot - R * F, s.ddot - R * phi.ddot]
unknowns = [s.ddot, phi.ddot, F]
with_friction = [*lagranges.equations, phi.ddot - s.ddot / R, F - m * g * sin(alpha) / 3]
print(equivalent_equations(newtons, with_friction, unknowns))

# %%
# The wrong friction, half of the weight's part along the slope, is found out with numbers:
wrong = [*lagranges.equations, phi.ddot - s.ddot / R, F - m * g * sin(alpha) / 2]
print(equivalent_equations(newtons, wrong, unknowns))

# %%
# The result that one remembers: two thirds of the acceleration without friction.
acceleration = lagranges.accelerations[0]
print("s̈ =", acceleration, "=", acceleration / (g * sin(alpha)), "of g sin α")
