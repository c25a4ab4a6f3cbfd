"""Operations of M and f of the planar pendulum of n links, by different designs, counted after shared parts are named.

What canon does: slopes r = l (cos θ, sin θ) once a link, partial sums W of masses, M_ij = (W_i r_i)·r_j below the
diagonal and W_i l_i² on it, forces by sums of accelerations from the hinge outwards and of forces inwards. An entry
below the diagonal is a sum of two products, 3 operations; all the rest is proportional to n:

    3 n (n − 1)/2 + 20.7 n,  which is 984 at n = 20, where 3·190 = 570 are entries of M.

LagrangesMethod's M and f take 431, 1595 and 7061 operations after SymPy's cse at n = 5, 10 and 20 (SymPy 1.14), so
canon's share is 1/3.3, 1/4.7 and 1/7.2. The other designs below take more. A share of 1/8 at n = 20 would leave 312
operations for all but the entries, 15.6 a link, of which sines, cosines, slopes, masses and the diagonal take 9 and
v², the sums of accelerations and forces, and their projection 12; by the growth of both it is reached near n = 30.
Fewer operations need M not formed at all: a recursion over the links gives q̈ in a number proportional to n, but
then it is no longer M q̈ = f.

    python benchmarks/operations.py            # 10 links at most for SymPy
    python benchmarks/operations.py --peer 20  # two minutes and more
"""

import argparse
import itertools
import sys
import timeit
from pathlib import Path

import numpy as np
import sympy as sp

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "mechanics"))

from chains import planar_pendulum
from derivation import by_lagrange, theirs

from canon import Lagrangian, coordinates
from canon.flow import right_hand_side
from canon.mechanics.at_scale.second_order import derivation


def counted(replacements, expressions):
    return sum(sp.count_ops(e) for e in (*(e for _, e in replacements), *expressions))


def lower(M, n):
    return [M[i, j] for i in range(n) for j in range(i + 1)]


def of_canon(n):
    bodies, q, field = planar_pendulum(n)
    replacements, M, f = derivation(bodies, q, field=field).to_sympy()
    return counted(replacements, [*lower(M, n), *f])


class Links:
    """The symbols of n links and the partial sums of their masses."""

    def __init__(self, n):
        self.m, self.l = sp.symbols(f"m:{n}", positive=True), sp.symbols(f"l:{n}", positive=True)
        self.angle, self.v = sp.symbols(f"theta:{n}", real=True), sp.symbols(f"v:{n}", real=True)
        self.g = sp.Symbol("g", positive=True)
        self.W = [sp.Add(*self.m[k:]) for k in range(n)]

    def coefficient(self, i, j):
        return self.W[max(i, j)] * self.l[i] * self.l[j]


def differences_of_angles(n):
    """M_ij = W l_i l_j cos(θ_i − θ_j), f_i = −Σ W l_i l_j sin(θ_i − θ_j) v_j² − W_i g l_i sin θ_i."""
    s = Links(n)

    def sine(i, j):
        return sp.sin(s.angle[i] - s.angle[j]) if i > j else -sp.sin(s.angle[j] - s.angle[i])

    M = sp.Matrix(n, n, lambda i, j: s.coefficient(i, j) * sp.cos(s.angle[max(i, j)] - s.angle[min(i, j)]))
    f = [
        -sp.Add(*(s.coefficient(i, j) * sine(i, j) * s.v[j] ** 2 for j in range(n) if j != i))
        - s.W[i] * s.g * s.l[i] * sp.sin(s.angle[i])
        for i in range(n)
    ]
    return counted(*sp.cse([*lower(M, n), *f]))


def without_partial_sums(n):
    """M = Σ m_k J_kᵀ J_k as it stands, and canon's f."""
    s = Links(n)
    x = [l * sp.cos(a) for l, a in zip(s.l, s.angle, strict=True)]
    y = [l * sp.sin(a) for l, a in zip(s.l, s.angle, strict=True)]
    M = sp.Matrix(
        n, n, lambda i, j: sp.Add(*(s.m[k] * (x[i] * x[j] + y[i] * y[j]) for k in range(max(i, j), n)))
    )
    alone = counted(*sp.cse(lower(M, n)))
    bodies, q, field = planar_pendulum(n)
    replacements, _, f = derivation(bodies, q, field=field).to_sympy()
    return alone + counted(replacements, f) - counted(*sp.cse([*x, *y]))


def cosines_and_recursion(n):
    """M_ij by cos(θ_i − θ_j), its coefficients shared by row, and canon's f."""
    s = Links(n)
    row = [sp.Symbol(f"c{i}") for i in range(n)]  # W_i l_i, two operations a link but for the last
    M = [
        row[i] * s.l[j] * sp.cos(s.angle[i] - s.angle[j]) if i != j else row[i] * s.l[i]
        for i in range(n)
        for j in range(i + 1)
    ]
    bodies, q, field = planar_pendulum(n)
    equations = derivation(bodies, q, field=field)
    graph = equations.graph
    inner = [each for each in graph.reachable(equations.f) if graph.nodes[each].operands]
    f = sum(
        max(1, len([o for o in graph.nodes[each].operands if o != graph.minus_one]) - 1) for each in inner
    )
    return sum(sp.count_ops(e) for e in M) + 2 * n - 1 + f


DESIGNS = {
    "canon": of_canon,
    "cos(θi − θj) in M, f by recursion": cosines_and_recursion,
    "differences of angles in M and f": differences_of_angles,
    "Σ m JᵀJ, masses not summed first": without_partial_sums,
}


def recursion(n):
    """Return the microseconds of q̈ by the recursion that forms no M, compiled: the least of many calls."""
    q = coordinates(" ".join(f"theta{k}" for k in range(n)))
    vx, vy = (list(itertools.accumulate(f(a) * a.dot for a in q)) for f in (sp.cos, sp.sin))
    heights = itertools.accumulate(-sp.cos(a) for a in q)
    kinetic = sp.Add(*((x**2 + y**2) / 2 for x, y in zip(vx, vy, strict=True)))
    start = np.array([0.1] * n + [0.0] * n)
    f = right_hand_side(Lagrangian(kinetic - sp.Add(*heights), q), start)
    f(0.0, start)
    return 1e6 * min(timeit.repeat(lambda: f(0.0, start), number=100, repeat=20)) / 100


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--peer", type=int, default=10, help="the longest chain LagrangesMethod is given")
    options = parser.parse_args()
    print(f"{'operations of M and f':36s}" + "".join(f"{n:>8d}" for n in (5, 10, 20)))
    for name, design in DESIGNS.items():
        print(f"{name:36s}" + "".join(f"{design(n):8d}" for n in (5, 10, 20)), flush=True)
    sizes = [n for n in (5, 10, 20) if n <= options.peer]
    print(f"{'LagrangesMethod and cse':36s}" + "".join(f"{theirs(n, by_lagrange)['ops']:8d}" for n in sizes))
    print("\nq̈ by the recursion over the links, which forms no M, µs an evaluation called from Python")
    for n in (10, 20, 50, 100, 200):
        print(f"of {n:3d} links{recursion(n):10.1f}", flush=True)
