"""Drift of the formal integral of Hénon and Heiles with the size of the orbit: figure of the explanation of series.

python docs/figures/integral_drift.py
"""

from pathlib import Path

import sympy as sp

from canon import Hamiltonian, birkhoff_normal_form
from canon.mechanics import formal_integral
from canon.plot import plot_integral_drift
from canon.study import integral_drift

HERE = Path(__file__).parent


def drifts():
    x, y, px, py = sp.symbols("x y p_x p_y", real=True)
    H = Hamiltonian((px**2 + py**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py])
    radii = (0.04, 0.06, 0.09, 0.13, 0.2)
    return [
        integral_drift(formal_integral(birkhoff_normal_form(H, order)), [1, 0.3, 0.2, 0.7], radii)
        for order in (2, 4, 6, 8)
    ]


if __name__ == "__main__":
    axes = plot_integral_drift(*drifts())
    axes.figure.savefig(HERE / "integral_drift.png", dpi=130, bbox_inches="tight")
