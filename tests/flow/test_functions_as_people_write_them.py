"""Functions f(t, y) as people write them: branches, tables, matrices, filled arrays, objects; each against SciPy."""

from __future__ import annotations

import bisect
import cmath
import functools
import itertools
import math
import random
from dataclasses import dataclass
from math import cos, sin
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from numpy.linalg import norm, solve
from scipy import linalg
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline, PchipInterpolator, interp1d

from canon import propagate
from canon.mechanics import field_of_function

if TYPE_CHECKING:
    from collections.abc import Callable

G = 9.81


def by_math(t, y):
    theta, omega = y
    return [omega, -G * math.sin(theta) - 0.1 * omega + 0.4 * cos(1.7 * t) + math.log(2, 10)]


def filled(t, y):
    n = len(y) // 2
    rates = np.zeros(2 * n, dtype=float)
    rates[:n] = y[n:]
    for i in range(n):
        left = y[i - 1] if i > 0 else 0.0
        right = y[i + 1] if i < n - 1 else 0.0
        rates[n + i] = left - 2 * y[i] + right
    return rates


def with_a_branch(t, y):
    if y[1] > 0:
        force = -0.3
    elif y[1] < 0:
        force = 0.3
    else:
        force = 0.0
    return np.array([y[1], -y[0] + force])


def motor(t, y):
    drive = 1.5 if t < 2 else 0.0
    return [y[1], drive - 0.5 * y[1]]


def contact(t, y):
    x, v = y
    return [v, -1.0 + np.where(x < 0, 400 * np.abs(x) - 2 * v, 0.0)]


def sphere_on_a_wall(t, y):
    depth = -y[0]
    return [y[1], (3e3 * depth**1.5 if depth > 0 else 0) - 1]


def spheres(t, y):
    overlap = np.maximum(0.1 - (y[1] - y[0]), 0)
    return [y[2], y[3], -1e3 * overlap**1.5, 2e3 * overlap**1.5]


def square_wave(t, y):
    return [y[1], -4 * y[0] + (1 if t % 3 < 1.2 else -1) + 0.1 * (np.floor(t / 0.8) % 2)]


def mass_matrix(t, y):
    q, v = y[:2], y[2:]
    c, s = np.cos(q[0] - q[1]), np.sin(q[0] - q[1])
    M = np.array([[2.0, c], [c, 1.0]])
    h = np.array([-s * v[1] ** 2 - 2 * G * np.sin(q[0]), s * v[0] ** 2 - G * np.sin(q[1])])
    return np.concatenate([v, np.linalg.solve(M, h)])


def indefinite(t, y):
    x, v = y[:2], y[2:]
    saddle = np.block([[np.eye(2), x.reshape(2, 1)], [x.reshape(1, 2), np.zeros((1, 1))]])
    found = solve(saddle, np.array([0.0, -G, -(v @ v)]))
    return np.hstack((v, found[:2]))


def three_bodies(t, y):
    masses, r = np.array([1.0, 0.5, 0.2]), y[:6].reshape(3, 2)
    a = np.zeros((3, 2))
    for i in range(3):
        for j in range(3):
            if i != j:
                d = r[j] - r[i]
                a[i] += masses[j] * d / norm(d) ** 3
    return np.concatenate([y[6:], a.ravel()])


def broadcast_bodies(t, y):
    r = y[:6].reshape(3, 2)
    d = r[None, :, :] - r[:, None, :]
    squares = np.sum(d**2, axis=-1) + np.eye(3)
    return np.r_[y[6:], (d / squares[..., None] ** 1.5).sum(axis=1).flatten()]


def field_and_charge(t, y):
    v = y[3:]
    return np.append(v, np.cross(v, [0, 0, 1.5]) - 0.1 * np.clip(v, -0.2, 0.2))


def complex_plane(t, y):
    z, w = y[0] + 1j * y[1], y[2] + 1j * y[3]
    a = -z / abs(z) ** 3 + 0.2j * w
    return [w.real, w.imag, np.real(a), a.imag]


def guarded(t, y):
    r = np.sqrt(y[0] ** 2 + y[1] ** 2)
    if r == 0:
        raise ValueError("collision")
    assert np.all(np.isfinite(y)), "lost"
    return np.array([y[2], y[3], -y[0] / r**3, -y[1] / r**3])


def limited(t, y):
    return [y[1], -y[0] - max(-0.5, min(0.5, 3 * y[1])) + float(y[0]) * 0.1 + np.sign(math.sin(t)) / 4]


def piecewise(t, y):
    u = y[0]
    return [y[1], -np.piecewise(u, [u < -1, u > 1], [lambda u: 2 * u + 1, lambda u: 2 * u - 1, lambda u: u])]


def selected(t, y):
    return [y[1], np.select([y[0] > 0.5, y[0] < -0.5], [-2 * y[0] + 0.5, -2 * y[0] - 0.5], -y[0])]


@np.vectorize
def stiffening(u):
    return 5 * u + 2 * u**2 if u > 0 else 5 * u


def elementwise(t, y):
    return np.concatenate((y[2:], -stiffening(y[:2])))


def masked(t, y):
    force = -y[:2]
    force[y[:2] > 0] *= 2
    return np.concatenate((y[2:], force))


@functools.lru_cache
def stiffness(k):
    return k + math.sin(k) ** 2


def with_memory_of_its_own(k, c=0.1):
    def damping(v):
        return -c * v * np.hypot(v, 0.1)

    def f(t, y):
        return y[1], -k * y[0] + damping(y[1])

    return f


@dataclass
class Rocket:
    thrust: float
    burn: float

    def pushed(self, t):
        return self.thrust if t < self.burn else 0.0

    def __call__(self, t, y):
        _, v, m = y
        return np.array([v, self.pushed(t) / m - 1.0, -self.pushed(t) / 4.0])

    def again(self, t, y):
        return self(t, y)


@dataclass(frozen=True)
class Spring:
    k: float

    @classmethod
    def of(cls, period):
        return cls(4 * math.pi**2 / period**2)

    @staticmethod
    def damping(v):
        return -0.2 * math.tanh(v)

    def __call__(self, t, y):
        return y[1], -self.k * y[0] + Spring.damping(y[1])


def in_two_parts(f):
    @functools.wraps(f)
    def of_state(*args):
        t, y = args
        n = len(y) // 2
        return [*y[n:], *f(t, y[:n], y[n:])]

    return of_state


@in_two_parts
def tied(t, q, v):
    return [-q[0] - 0.3 * (q[0] - q[1]), -q[1] + 0.3 * (q[0] - q[1]) - 0.1 * v[1]]


def summed_over_bonds(t, y):
    u, v = y.reshape(2, 3)
    a = -0.2 * v
    i, j = np.array([0, 1, 2]), np.array([1, 2, 0])
    pull = u[j] - u[i]
    np.add.at(a, i, pull)
    np.subtract.at(a, j, pull)
    return np.concatenate([v, a - u])


def by_determinants(t, y):
    area = np.linalg.det(np.array([[y[0], y[2]], [y[1], y[3]]]))
    rows = np.apply_along_axis(lambda r: -r * math.dist(r, (0.0, 0.0)), 1, y[:2].reshape(1, 2))
    return np.hstack([y[2:], rows[0] - 0.1 * area])


def by_cmath(t, y):
    r, angle = cmath.polar(complex(y[0], y[1]))
    pull = cmath.rect(-r, angle) + 0.3 * cmath.exp(2j * t)
    return [y[2], y[3], pull.real, pull.imag]


STROKES = [0.5, 1.0, 2.0, 40.0]


def from_a_list(t, y):
    push = [0.0, 1.0, -1.0, 0.5][bisect.bisect_right(STROKES, t)]
    blow, rest = divmod(t, 0.8)
    return [y[1], -y[0] + push + (-1) ** blow * rest]


def nested_guard(t, y):
    if (depth := -y[0]) > 0 and (force := 300 * depth**1.5 - 2 * y[1]) > 0:
        return [y[1], force - 1]
    return [y[1], -1.0]


TABLE = interp1d([-2.0, -0.5, 0.5, 2.0], [3.0, 0.5, -0.5, -3.0])
SPLINE = CubicSpline([-2, -1, 0, 1, 2], [4.0, 1.0, 0.0, -1.0, -4.0])
WIND = PchipInterpolator([0, 1, 2, 3], [0, 1, -1, 0])

FUNCTIONS: dict[str, tuple[Callable[..., Any], Any]] = {
    "math": (by_math, [0.5, 0.0]),
    "zeros, filled": (filled, [0.1, 0.2, -0.1, 0.0, 0.0, 0.1]),
    "if, elif, else": (with_a_branch, [1.0, 0.2]),
    "if by the time": (motor, [0.0, 0.1]),
    "where": (contact, [0.5, 0.0]),
    "a root on one side": (sphere_on_a_wall, [0.2, -0.5]),
    "a root of a maximum": (spheres, [0.0, 0.5, 1.0, -0.5]),
    "remainders of the time": (square_wave, [0.3, 0.0]),
    "a mass matrix": (mass_matrix, [0.5, 0.2, 0.0, 0.1]),
    "a bordered matrix": (indefinite, [0.6, -0.8, 0.4, 0.3]),
    "bodies in loops": (three_bodies, [0, 0, 2, 0, 0, 3, 0, 0.1, 0, 0.7, -0.6, 0]),
    "bodies by broadcasting": (broadcast_bodies, [0, 0, 2, 0, 0, 3, 0, 0.1, 0, 0.7, -0.6, 0]),
    "cross and clip": (field_and_charge, [0.0, 0.0, 0.0, 1.0, 0.0, 0.5]),
    "complex numbers": (complex_plane, [1.0, 0.0, 0.0, 0.9]),
    "guards": (guarded, [1.0, 0.0, 0.0, 1.1]),
    "max, min, float": (limited, [1.0, 0.0]),
    "piecewise": (piecewise, [1.5, 0.0]),
    "select": (selected, [1.0, 0.0]),
    "vectorize": (elementwise, [0.3, -0.2, 0.0, 0.1]),
    "a closure": (with_memory_of_its_own(4.0), [1.0, 0.0]),
    "a partial": (functools.partial(lambda k, t, y: [y[1], -k * sin(y[0])], 2.0), [1.0, 0.0]),
    "an object that is called": (Rocket(3.0, 1.0), [0.0, 0.0, 2.0]),
    "a method": (Rocket(3.0, 1.0).again, [0.0, 0.0, 2.0]),
    "a table": (lambda t, y: [y[1], np.interp(y[0], [-2, 0, 1, 3], [1, 0, -0.5, -2])], [0.8, 0.0]),
    "SciPy's table": (lambda t, y: [y[1], TABLE(y[0])], [0.8, 0.0]),
    "a spline": (lambda t, y: [y[1], SPLINE(y[0]) + WIND(t)], [0.5, 0.0]),
    "a frozen object with methods of its class": (Spring.of(2.0), [0.5, 0.0]),
    "a decorator": (tied, [0.5, 0.1, 0.0, 0.2]),
    "at places": (summed_over_bonds, [0.3, -0.2, 0.1, 0.0, 0.4, 0.0]),
    "a determinant": (by_determinants, [1.0, 0.2, 0.1, 0.9]),
    "polar form": (by_cmath, [1.0, 0.0, 0.0, 0.5]),
    "a list by the time": (from_a_list, [0.2, 0.0]),
    "a guard in a guard": (nested_guard, [0.2, -0.5]),
    "masks": (masked, [0.4, -0.3, 0.0, 0.1]),
    "a cache": (lambda t, y: [y[1], -stiffness(3.0) * y[0] + t / 9], [0.4, 0.0]),
    "conditions as numbers": (lambda t, y: [y[1], -y[0] - 0.2 * (y[1] > 0) + 0.2 * (y[1] < 0)], [1.0, 0.3]),
    "roll and diff": (
        lambda t, y: np.hstack([y[3:], np.roll(y[:3], 1) + np.roll(y[:3], -1) - 2 * y[:3] - np.diff(y[:4]) ** 3]),
        [0.1, 0.3, -0.1, 0.0, 0.2, 0.0],
    ),
    "pad": (lambda t, y: np.r_[y[2:], np.diff(np.diff(np.pad(y[:2], 1)))], [0.3, -0.1, 0.0, 0.2]),
    "trace, dot, outer": (
        lambda t, y: [y[1], -np.trace(np.outer(y, y)) * y[0] - np.dot(y, y) * y[1] / 9], [0.8, 0.0]
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_moves_as_it_does_in_scipy(name: str) -> None:
    f, start = FUNCTIONS[name]
    motion = propagate(f, (0, 3), start, samples=4)
    reference = solve_ivp(
        f, (0, 3), start, method="DOP853", rtol=1e-9, atol=1e-10, t_eval=motion.t, max_step=0.02
    )
    np.testing.assert_allclose(motion.y, reference.y, rtol=2e-7, atol=2e-7)  # SciPy steps over kinks


def test_branches_become_pieces_of_what_depends_on_them() -> None:
    field = field_of_function(with_a_branch, 2)
    (x, v), (first, second) = field.x, field.components
    assert first == v
    assert [float(second.subs({x: 0, v: number})) for number in (-1, 1)] == pytest.approx([0.3, -0.3])


@pytest.mark.parametrize("span", [(0, 0.5), (0, 3), (3, 0), (1, -2)])
def test_what_steps_with_the_time_is_compared_within_the_span(span) -> None:
    """Beyond it no step is written out."""
    motion = propagate(square_wave, span, [0.3, 0.0], samples=1)
    steps = [t for t in np.arange(-4, 4, 0.1).round(1) if min(span) < t < max(span)]
    state, ends = [0.3, 0.0], [span[0], *sorted(steps, reverse=span[1] < span[0]), span[1]]
    for a, b in itertools.pairwise(ends):
        within = (a + b) / 2  # the wave is what it is in the middle
        rest = square_wave(within, [0.0, 0.0])[1]

        def way(t, y, rest=rest):
            return [y[1], -4 * y[0] + rest]

        state = solve_ivp(way, (a, b), state, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(motion.final, state, rtol=1e-9, atol=1e-9)


def test_constants_may_be_made_by_scipy() -> None:
    field = field_of_function(lambda t, y: linalg.expm(np.diag([0.0, 1.0])) @ y, 2)
    assert float(field.components[1].coeff(field.x[1])) == pytest.approx(math.e)


def test_modules_of_the_users_are_left_as_they_are() -> None:
    before = dict(globals())
    field_of_function(by_math, 2)
    assert globals() == before
    assert math.sin is by_math.__globals__["math"].sin


SEEN: list[Any] = []


def keeping_what_it_saw(t, y):
    SEEN.append((t, y[0]))
    return [y[1], -y[0]]


def test_what_is_written_into_the_users_lists_are_numbers() -> None:
    propagate(keeping_what_it_saw, (0, 1), [1.0, 0.0], samples=1)
    assert SEEN
    assert all(isinstance(number, float) for pair in SEEN for number in pair)


# -- what is no function of t and y ---------------------------------------------------------------------

CALLS = 0
LAST = [0.0]


def counting(t, y):
    global CALLS
    CALLS += 1
    return [y[1], -(4.0 if CALLS < 200 else 8.0) * y[0]]


def remembering(t, y):
    before, LAST[0] = LAST[0], float(y[0])
    return [y[1], -y[0] - 0.5 * before]


def noisy(t, y):
    return [y[1], -y[0] + random.random()]


def overwriting(t, y):
    y[0], y[1] = y[1], -y[0]
    return y


def truncating(t, y):
    rates = np.array([0, 0])
    rates[0], rates[1] = y[1], -y[0]
    return rates


def column(t, y):
    return np.array([[y[1]], [-y[0]]])


def endless(t, y):
    e = y[0]
    while abs(e - 0.3 * math.sin(e) - t) > 1e-12:
        e -= (e - 0.3 * math.sin(e) - t) / (1 - 0.3 * math.cos(e))
    return [y[1], -e]


def unset(t, y):
    if y[0] < 5 or y[0] > 6:
        force = -y[0]
    return [y[1], force]


def crashing(t, y):
    if y[0] < 0.5:
        raise RuntimeError("the ground")
    return [y[1], -y[0]]


WRONG = {
    counting: "CALLS, which it changes itself",
    remembering: "other rates when it is called again",
    noisy: "other rates when it is called again",
    overwriting: "writes into y",
    truncating: "number of something that moves",
    column: "in a row, .ravel",
    endless: "grow beyond 50000 operations",
    unset: "raises UnboundLocalError where",
    crashing: "raises RuntimeError where y_0 < 1/2: leave that out, and watch it by an event",
    lambda t, y: None: "returns 1 rate for 2 variables",
    lambda t, y: [y[1], -np.sum(y, initial=2.0)]: "initial= or where=",
    lambda t, y: [y[1], -math.sin(y[:2])]: "math.sin of an array",
}  # fmt: skip


@pytest.mark.parametrize("f", WRONG, ids=lambda f: f.__name__)
def test_what_is_none_is_refused(f: Callable[..., Any]) -> None:
    with pytest.raises((TypeError, ValueError), match=WRONG[f]):
        propagate(f, (0, 1), [1.0, 0.2])
