"""Random Hamiltonians and their motion by heyoka alone: its own derivatives, wider numbers, steps held short.

A Hamiltonian is a tree of plain tuples. Two short translations lead from it to SymPy, which canon reads, and to heyoka,
which derives Hamilton's equations itself: nothing of canon has a part in the reference.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import heyoka as hy
import numpy as np
import sympy as sp
from hypothesis import strategies as st

from canon import Hamiltonian, coordinates
from canon import time as canon_time

Tree = tuple[Any, ...]
"""("number", x), ("time",), ("q", i), ("p", i), or the name of an operation and its operands."""

FUNCTIONS = ("sin", "cos", "exp", "tanh", "sqrt", "log", "atan")


@dataclass(frozen=True)
class RandomMotion:
    """A Hamiltonian T + V with a start and a span, and what is known of its time scales.

    Parameters
    ----------
    tree
        H.
    n, units
        Degrees of freedom; what the momenta are measured by, which lets the reference see all of them.
    y0
        The start (q, p), numbers that doubles are.
    span
        First and last time.
    scale
        A time in which little happens, in the units of time.
    moments
        Times and widths of pulses.
    separable
        Whether H = T(p, t) + V(q, t).
    """

    tree: Tree
    n: int
    units: tuple[float, ...]
    y0: tuple[float, ...]
    span: tuple[float, float]
    scale: float
    moments: tuple[tuple[float, float], ...]
    separable: bool

    def hamiltonian(self) -> Hamiltonian:
        q = coordinates(",".join("xyz"[: self.n]) + ",")
        p = [each.momentum for each in q]
        return Hamiltonian(in_sympy(self.tree, q, p), q, p)


# a Hamiltonian's two translations --------------------------------------------------------------------


def in_sympy(tree: Tree, q: Any, p: Any) -> sp.Expr:
    kind, *operands = tree
    if kind in ("number", "time", "q", "p"):
        return {
            "number": lambda: sp.Rational(Fraction(operands[0])),
            "time": lambda: canon_time,
            "q": lambda: q[operands[0]],
            "p": lambda: p[operands[0]],
        }[kind]()
    if kind == "power":
        return in_sympy(operands[0], q, p) ** operands[1]
    parts = [in_sympy(each, q, p) for each in operands]
    if kind in FUNCTIONS:
        return getattr(sp, kind)(*parts)
    return {"add": sp.Add, "mul": sp.Mul}[kind](*parts)


def in_heyoka(tree: Tree, q: Any, p: Any, number: Any) -> Any:
    kind, *operands = tree
    if kind in ("number", "time", "q", "p"):
        return {
            "number": lambda: hy.expression(number(float(operands[0]))),
            "time": lambda: hy.time,
            "q": lambda: q[operands[0]],
            "p": lambda: p[operands[0]],
        }[kind]()
    if kind == "power":
        return heyoka_power(in_heyoka(operands[0], q, p, number), operands[1], number)
    parts = [in_heyoka(each, q, p, number) for each in operands]
    if kind in FUNCTIONS:
        return getattr(hy, kind)(*parts)
    return hy.sum(parts) if kind == "add" else hy.prod(parts)


def heyoka_power(base: Any, exponent: float, number: Any) -> Any:
    """Return a power, a natural one as products: heyoka's series of x ** 3 are lost at x = 0."""
    if exponent in (2, 4, 8, 16):
        half = base if exponent == 2 else heyoka_power(base, exponent // 2, number)
        return half * half
    return base ** hy.expression(number(float(exponent)))


# the motion by heyoka alone --------------------------------------------------------------------------

KINDS = {"extended": np.longdouble, "quad": hy.real128, "more": partial(hy.real, prec=160)}
"""Numbers of the reference, each wider than those of the motions that are held against it."""


def reference(case: RandomMotion, times: np.ndarray, width: str = "extended", shorter: int = 1) -> np.ndarray:
    """Return the states at some times; rows of NaN from where the motion leaves all bounds.

    Steps are held to a 16th of the time in which little happens and to a quarter of every pulse's width, as heyoka
    passes over what the coefficients of its series do not know; beside zeros of high powers they know nothing at all.
    """
    kind = KINDS[width]
    if highest_power(case.tree) > 8:
        shorter *= 8 if width == "more" else 64  # with 57 coefficients much more is known
    q, p = ([hy.expression(f"{letter}{i}") for i in range(case.n)] for letter in "qp")
    units = [hy.expression(kind(each)) for each in case.units]
    H = in_heyoka(case.tree, q, [unit * each for unit, each in zip(units, p, strict=True)], kind)
    equations = [(a, hy.diff(H, b) / unit) for a, b, unit in zip(q, p, units, strict=True)]
    equations += [(b, -hy.diff(H, a) / unit) for a, b, unit in zip(q, p, units, strict=True)]
    sizes = np.array([kind(x) for x in (*(1.0 for _ in q), *case.units)])
    start = [kind(y) / size for y, size in zip(case.y0, sizes, strict=True)]
    options = {"fp_type": hy.real if width == "more" else kind, "compact_mode": True, "opt_level": 1}
    own = hy.taylor_adaptive(equations, start, time=kind(case.span[0]), **options)
    forward = 1.0 if case.span[1] > case.span[0] else -1.0
    stops = sorted({*times.tolist(), *near_pulses(case)}, key=lambda t: forward * t)
    rows: dict[float, np.ndarray] = {}
    for before, stop in zip([case.span[0], *stops], stops, strict=False):
        longest = min(
            [case.scale / 16, *(w / 4 for t, w in case.moments if abs((before + stop) / 2 - t) < 40 * w)]
        )
        outcome, *_ = own.propagate_until(kind(stop), max_delta_t=kind(longest / shorter), max_steps=200_000)
        if (
            outcome != hy.taylor_outcome.time_limit
            or not max(abs(float(x)) for x in own.state[: case.n]) < 1e6
        ):
            break
        rows[stop] = own.state * sizes
    lost = np.array([kind(np.nan) for _ in case.y0])
    return np.array([rows.get(t, lost) for t in times.tolist()]).T


def highest_power(tree: Tree) -> int:
    """Return the highest exponent in a tree."""
    own = [abs(tree[2])] if tree[0] == "power" else []
    return max([*own, *(highest_power(each) for each in tree[1:] if isinstance(each, tuple))], default=0)


def near_pulses(case: RandomMotion) -> list[float]:
    a, b = sorted(case.span)
    return [
        s for t, w in case.moments for s in (t - 40 * w, t - 8 * w, t, t + 8 * w, t + 40 * w) if a < s < b
    ]


# strategies ------------------------------------------------------------------------------------------


def number(x: float) -> Tree:
    return ("number", x)


def times_(factor: float, *trees: Tree) -> Tree:
    return ("mul", number(factor), *trees)


def square(tree: Tree) -> Tree:
    return ("power", tree, 2)


small = st.integers(-24, 24).filter(bool).map(lambda k: k / 16)
positive = st.integers(2, 32).map(lambda k: k / 8)
places = st.one_of(st.sampled_from([0.0, 0.0, 1.0, -1.0]), st.integers(-32, 32).map(lambda k: k / 16))


@st.composite
def arguments(draw: st.DrawFn, q: list[Tree]) -> Tree:
    """A linear or quadratic form of the coordinates."""
    first, second = draw(st.sampled_from(q)), draw(st.sampled_from(q))
    return draw(
        st.sampled_from(
            [
                first,
                ("add", first, times_(draw(small), second)),
                ("add", first, number(draw(small))),
                times_(draw(small), first, second),
            ]
        )
    )


@st.composite
def bounded(draw: st.DrawFn, q: list[Tree]) -> Tree:
    """A function of the coordinates that is finite everywhere and grows like a power."""
    u, v = draw(arguments(q)), draw(arguments(q))
    one_more = ("add", number(1), square(u))
    return draw(
        st.sampled_from(
            [
                ("sin", u),
                ("cos", times_(draw(positive), u)),
                ("exp", times_(-1, square(u))),
                ("exp", times_(-16 * draw(positive), square(("add", u, number(draw(small)))))),
                ("tanh", times_(draw(positive), u)),
                ("atan", v),
                ("power", one_more, -1),
                ("sqrt", one_more),
                ("log", one_more),
                ("mul", ("sin", u), ("cos", v)),
                ("cos", ("add", u, ("sin", v))),
                ("mul", ("exp", times_(-0.5, square(u))), v),
                ("power", ("add", number(1), square(u), square(v)), -1.5),
                ("mul", u, v),
            ]
        )
    )


@st.composite
def confining(draw: st.DrawFn, q: Tree) -> Tree:
    """A potential that no motion leaves."""
    k = draw(positive)
    return draw(
        st.sampled_from(
            [
                times_(k / 2, square(q)),
                ("add", times_(k / 2, square(q)), times_(1 / 4, ("power", q, 4))),
                times_(1 / 4, ("power", q, 4)),
                times_(1 / 8, ("power", q, 8)),
                times_(1 / 8, ("power", q, 16)),
                ("add", ("exp", q), ("exp", times_(-1, q))),
                times_(-k, ("cos", q)),
                ("sqrt", ("add", number(1), times_(k, square(q)))),
                ("add", times_(1 / 4, ("power", q, 4)), times_(-1, square(q))),
                square(("add", number(1), times_(-1, ("exp", times_(-0.5, q))))),
            ]
        )
    )


@st.composite
def random_motions(draw: st.DrawFn, *, timed: bool = True) -> RandomMotion:
    """Hamiltonians of one to three degrees of freedom with starts and spans."""
    n = draw(st.sampled_from([1, 1, 2, 2, 3]))
    q, p = [("q", i) for i in range(n)], [("p", i) for i in range(n)]
    unit = 2.0 ** draw(
        st.sampled_from([0, 0, 0, 0, -40, 40, 20])
    )  # of mass and energy: times stay as they are
    parts = [2.0 ** draw(st.sampled_from([0, 0, 0, 1, -1, -6, 6, 40])) for _ in range(n)]
    span = draw(st.sampled_from([3.0, 10.0, 20.0])) * min(1.0, min(parts) ** 0.5)
    kinetic, separable = [], True
    for i in range(n):
        kind = draw(st.sampled_from(["plain"] * 5 + ["relativistic", "curved"]))
        m = unit * parts[i]
        T = times_(1 / (2 * m), square(p[i]))
        if kind == "relativistic":
            T = times_(m, ("sqrt", ("add", number(1), square(times_(1 / m, p[i])))))
        if kind == "curved":
            T, separable = (
                ("mul", T, ("power", ("add", number(1), times_(0.5, square(draw(arguments(q))))), -1)),
                False,
            )
        kinetic.append(T)
    if n > 1 and draw(st.integers(0, 3)) == 0:  # p·A
        B, (i, j) = draw(small), draw(st.sampled_from([(0, 1), (1, 0), (0, n - 1)]))
        weight = 1 / max(1.0, parts[i], parts[j])
        kinetic += [times_(B * weight, p[i], q[j]), times_(-B * weight, p[j], q[i])]
        separable = False
    V = [draw(confining(each)) for each in q]
    V += [times_(draw(small) / 2, draw(bounded(q))) for _ in range(draw(st.integers(0, 3)))]
    begin = draw(st.sampled_from([0.0, 0.0, 1.0, -2.5]))
    way, moments = draw(st.sampled_from([1.0, 1.0, -1.0])), ()
    if timed:
        drives, moments = draw(driven(q, begin, way * span, min(1.0, min(parts) ** 0.5)))
        V += drives
    tree = ("add", *kinetic, *(times_(unit, each) for each in V))
    still = draw(st.integers(0, 2)) == 0
    moved = st.just(0.0) if still else places
    y0 = [draw(places) for _ in range(n)]
    units = tuple(unit * 2.0 ** (math.frexp(part)[1] // 2) for part in parts)
    y0 += [each * draw(moved) for each in units]
    if draw(st.integers(0, 7)) == 0:
        y0[0] = float(np.pi / 2)
    return RandomMotion(
        tree,
        n,
        units,
        tuple(y0),
        (begin, begin + way * span),
        min(1.0, min(parts) ** 0.5),
        moments,
        separable,
    )


@st.composite
def driven(
    draw: st.DrawFn, q: list[Tree], begin: float, length: float, scale: float
) -> tuple[list[Tree], tuple[tuple[float, float], ...]]:
    """Terms with the time in them: waves, pulses, switches."""
    found, moments = list[Tree](), list[tuple[float, float]]()
    for _ in range(draw(st.sampled_from([0, 0, 1, 1, 2]))):
        kind = draw(st.sampled_from(["wave", "pumped", "gauss", "switch", "lorentz", "slow"]))
        where = draw(st.sampled_from(q))
        w = scale * 2.0 ** draw(st.sampled_from([0, -3, -7, -10, -17]))
        at = begin + length * draw(st.integers(1, 15)) / 16
        u = times_(1 / w, ("add", ("time",), number(-at)))
        if kind == "wave":
            shape = ("cos", times_(draw(positive) / scale, ("time",)))
        elif kind == "pumped":
            shape, where = ("sin", times_(draw(positive) / scale, ("time",))), square(where)
        elif kind == "slow":
            shape = ("exp", times_(-1 / 16 / scale, ("time",)))
        else:
            shape = {
                "gauss": ("exp", times_(-1, square(u))),
                "switch": ("tanh", u),
                "lorentz": ("power", ("add", number(1), square(u)), -1),
            }[kind]
            moments.append((at, w))
        found.append(times_(draw(small) / 2, shape, where))
    return found, tuple(moments)
