r"""
True, false, and true only in places
====================================

Is :math:`\arctan x + \arctan(1/x) = \pi/2`? It is for positive x. Formula collections forget to say so; a
verdict doesn't, and shows the point at which an identity fails.
"""

import matplotlib.pyplot as plt
import numpy as np
from sympy import Symbol, atan, cos, cosh, exp, log, pi, sin, sqrt, tan

from canon import Domain, equal

x = Symbol("x", real=True)
print(equal(atan(x) + atan(1 / x), pi / 2))

# %%
print(equal(atan(x) + atan(1 / x), pi / 2, Domain((x > 0,))))

# %%
figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
places = np.linspace(-4, 4, 400)
axes.plot(places, np.arctan(places) + np.arctan(1 / places))
axes.set(xlabel="x", title="arctan x + arctan 1/x")

# %%
# A few that were met in lecture notes, and what becomes of each:
claims = {
    "sin 3x = 3 sin x − 4 sin³x": (sin(3 * x), 3 * sin(x) - 4 * sin(x) ** 3),
    "√(x²) = x": (sqrt(x**2), x),
    "tan(x/2) = (1 − cos x)/sin x": (tan(x / 2), (1 - cos(x)) / sin(x)),
    "cosh log(x + √(x²+1)) = √(x²+1)": (cosh(log(x + sqrt(x**2 + 1))), sqrt(x**2 + 1)),
    "(eˣ)² = e^(x²)": (exp(x) ** 2, exp(x**2)),
    "√(5 + 2√6) = √2 + √3": (sqrt(5 + 2 * sqrt(6)), sqrt(2) + sqrt(3)),
}
for text, (left, right) in claims.items():
    verdict = equal(left, right)
    print(f"{verdict.status!s:6} {text:33} {verdict.counterexample or ''}")
