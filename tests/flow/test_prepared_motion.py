"""A prepared motion finds, records, refuses and warns of the same as `propagate`, bit for bit."""

from __future__ import annotations

import dataclasses
import warnings
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from canon import (
    DOP853,
    RK4,
    SABA,
    AccuracyWarning,
    Event,
    Gauss,
    Hamiltonian,
    Lagrangian,
    Splitting,
    Taylor,
    TimeTransformed,
    VectorField,
    WisdomHolman,
    coordinates,
    parameters,
    propagate,
)
from canon.flow import prepare, propagation
from canon.flow.transformed import transformed_orbit

X = coordinates("x")
G = parameters("g", positive=True)
PENDULUM = Hamiltonian(X.momentum**2 / 2 - G * sp.cos(X), [X], [X.momentum])
MAGNETIC = Hamiltonian((X.momentum - X**2 / 3) ** 2 / 2 + X**4 / 4, [X], [X.momentum])
KINKED = Hamiltonian(X.momentum**2 / 2 + sp.Abs(X), [X], [X.momentum])
HALF_LINE = Hamiltonian(X.momentum**2 / 2 - sp.log(X), [X], [X.momentum])
DAMPED = Lagrangian(X.dot**2 / 2 - X**2 / 2, [X], forces=[-X.dot / 5])

FIXED = [
    {"method": Splitting("verlet"), "step": 0.1},
    {"method": "kahan-li-8", "step": 0.25, "precision": "double"},
    {"method": "srkn-6b", "step": 0.25, "precision": "extended"},
    {"method": RK4(), "step": Fraction(1, 10), "precision": "double-double"},
    {"method": Gauss(3), "step": 0.3},
    {"method": "verlet", "step": 0.05, "precision": "single", "cadence": 2, "samples": 7},
]
ADAPTIVE = [{}, {"method": Taylor(1e-9)}, {"method": DOP853(), "tolerance": 1e-8}, {"precision": "quad"}]
KEPLERS = [
    {"method": WisdomHolman(), "step": 0.25},
    {"method": SABA(2), "step": 0.2},
    {"method": TimeTransformed(Splitting("verlet")), "step": 0.1},
    {"method": TimeTransformed(Splitting("verlet")), "step": 0.1, "times": [0.5, 1.0]},
]
CASES = [
    *(("simple-pendulum", 1, {"samples": 5, **by}) for by in (*FIXED, *ADAPTIVE)),
    *((PENDULUM, 1, {"parameters": {G: 9.81}, **by}) for by in (*FIXED[:2], *ADAPTIVE[:3])),
    *((PENDULUM, 1, {"parameters": {"g": [9.0, 10.0]}, **by}) for by in (FIXED[0], ADAPTIVE[0])),
    *(("kepler", 2, by) for by in (*KEPLERS, *FIXED[:2], *ADAPTIVE[:2])),
    *((MAGNETIC, 1, by) for by in (FIXED[3], FIXED[4], ADAPTIVE[1])),
    *((KINKED, 1, by) for by in (FIXED[0], ADAPTIVE[1])),
    *((HALF_LINE, 1, by) for by in (FIXED[0], ADAPTIVE[1])),
    (PENDULUM, 1, {"parameters": {G: 1.0}, "events": [Event(X)], "method": Taylor(), "dense": True}),
    (PENDULUM, 1, {"parameters": {G: 1.0}, "events": [Event(X, action="stop")], **FIXED[0]}),
    (PENDULUM, 1, {"parameters": {G: 1.0}, "observables": {"x²": X**2}, "times": [0.5, 1.5], **FIXED[1]}),
    *((DAMPED, 1, by) for by in (FIXED[4], ADAPTIVE[0])),
    (VectorField([X.dot, -X], [X, X.dot]), 1, ADAPTIVE[0]),
    (lambda _t, y: [y[1], -y[0]], 1, ADAPTIVE[1]),
]
WRONG = [
    [1.0],
    [1.0, np.nan, 0.0, 0.0],
    [np.inf, 0.0],
    "nowhere",
    None,
    {"x": 1.0},
    [[1.0, 2.0]],
    ["a", "b"],
    [],
]


def outcome(run):
    """Return what came out: a motion or an error, and the warnings on the way."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            found = run()
        except (ArithmeticError, KeyError, TypeError, ValueError) as wrong:
            found = wrong
    return found, [(each.category, str(each.message), each.filename) for each in told]


def alike(a, b):
    """Whether two values have the same type and the same bits, arrays in them included; times of the clock apart."""
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and a.shape == b.shape and (a.dtype == object or a.tobytes() == b.tobytes())
    if isinstance(a, tuple | list):
        return len(a) == len(b) and all(map(alike, a, b))
    if isinstance(a, BaseException):
        rest = {name: value for name, value in vars(a).items() if name != "motion"}
        return str(a) == str(b) and all(alike(value, vars(b)[name]) for name, value in rest.items())
    if hasattr(a, "items"):
        return list(a) == list(b) and all(alike(a[k], b[k]) for k in a)
    if dataclasses.is_dataclass(a):
        kept = [f.name for f in dataclasses.fields(a) if not f.name.endswith("_seconds") and f.name in SEEN]
        return all(alike(getattr(a, name), getattr(b, name)) for name in kept)
    return a == b or (a != a and b != b)


SEEN = {
    "t", "y", "carried", "energies", "method", "precision", "step", "steps", "evaluations", "autonomous", "observables",
    "changes", "statistics", "events", "mean", "least", "greatest", "rising", "after", "record", "samples", "task",
    "watched", "crossings", "names", "nodes", "cadence", "dense", "single", "states", "max_step",
}  # fmt: skip


def both(system, start, by, prepared=None):
    span = (0, 2)
    alone = outcome(lambda: propagate(system, span, start, **by))
    twin = outcome(lambda: (prepared or prepare(system, span, **by)).propagate(start))
    return alone, twin


def same(alone, twin):
    assert alone[1] == twin[1]
    assert alike(alone[0], twin[0]), (alone[0], twin[0])
    if hasattr(alone[0], "record"):
        np.testing.assert_array_equal(alone[0].final, twin[0].final)
        assert alone[0].record.names == twin[0].record.names


numbers = st.floats(-1.5, 1.5) | st.sampled_from([0.0, 1.0, -1.0, 1e-30, 1e200])


@settings(max_examples=60)
@given(st.sampled_from(range(len(CASES))), st.data())
def test_every_start_moves_as_by_propagate(which, data):
    system, n, by = CASES[which]
    prepared = outcome(lambda: prepare(system, (0, 2), **by))[0]
    assume(not isinstance(prepared, BaseException))
    for _ in range(2):
        start = data.draw(st.lists(numbers, min_size=2 * n, max_size=2 * n))
        same(*both(system, start, by, prepared))


@pytest.mark.parametrize("by", KEPLERS[2:])
@pytest.mark.parametrize(
    "start", [[1e200, 0.0, 0.3, 1.2], [1.0, 1e200, 1e-30, 0.3], [1e200, -0.7, 1e-30, -0.7]]
)
def test_a_time_that_would_take_years_to_come_is_given_up(start, by):
    """dt/ds is 10⁻¹⁸³ a step there: these waited for as long as anybody let them."""
    with pytest.raises(
        ArithmeticError, match=r"the time has gone on by \S+e-\d+, and \S+ are left: dt/ds is too small"
    ):
        propagate("kepler", (0, 2), start, **by)


def test_a_time_that_comes_to_stand_nearly_still_is_given_up(monkeypatch):
    """The first step passes 0.05, all others 10⁻⁴⁷: judged by their mean they went on for ever."""
    monkeypatch.setattr(transformed_orbit, "_PATIENCE", 2**12)
    with pytest.raises(
        ArithmeticError, match=r"in 4,096 steps the time has gone on by 0, and 0\.45 are left"
    ):
        propagate("kepler", (0, 2), [1e-30, 1e-30, 0.0, 0.0], **KEPLERS[3])
    for by in KEPLERS[2:]:
        assert propagate("kepler", (0, 2), [1.0, 0.1, 0.1, 1.1], **by).t[-1] == 2


@pytest.mark.parametrize("which", range(len(CASES)))
def test_good_starts_move(which):
    system, n, by = CASES[which]
    start = [1.0, 0.2] if n == 1 else [1.0, 0.1, 0.1, 1.1]
    alone, twin = both(system, start, by)
    assert hasattr(alone[0], "final"), alone[0]
    same(alone, twin)


@pytest.mark.parametrize("wrong", WRONG, ids=str)
@pytest.mark.parametrize("which", [0, 6, 12, -3, -2])
def test_wrong_starts_are_refused_in_the_same_words(which, wrong):
    system, _, by = CASES[which]
    same(*both(system, wrong, by))


def test_many_starts_go_side_by_side():
    by = {"parameters": {G: 2.0}, **FIXED[0]}
    starts = np.array([[0.5, 1.0, 1.5], [0.0, 0.1, 0.2]])
    same(*both(PENDULUM, starts, by))


def test_a_collision_is_told_of():
    by = {"method": "verlet", "step": 0.1}
    alone, twin = both("kepler", [0.02, 0.0, 0.0, 0.01], by)
    assert alone[1][0][0] is AccuracyWarning
    same(alone, twin)
    assert twin[1][0][2] == __file__


def test_what_is_wrong_whatever_the_start_is_told_at_once():
    for by in (
        {"method": "verlet"},
        {"parameters": {"h": 1.0}},
        {"samples": 0},
        {"method": Taylor(), "step": 0.1},
        {"method": "verlet", "step": -1.0},
        {"observables": {"energy": X}},
        {"t_eval": [0, 1]},
    ):
        wanted = {"parameters": {G: 1.0}, **by}
        alone, _ = outcome(lambda wanted=wanted: propagate(PENDULUM, (0, 2), [1.0, 0.0], **wanted))
        early, _ = outcome(lambda wanted=wanted: prepare(PENDULUM, (0, 2), **wanted))
        assert isinstance(alone, Exception)
        assert type(alone) is type(early)
        assert str(alone).replace("propagate has", "prepare has") == str(early)


def test_a_start_given_too_early_is_told_where_it_goes():
    for name in ("y0", "x0", "start"):
        with pytest.raises(TypeError, match=r"prepare\(…\)\.propagate\(y0\)"):
            prepare(PENDULUM, (0, 2), **{name: [1.0, 0.0]})


def test_a_prepared_motion_reads_its_request_once(monkeypatch):
    prepared = prepare(PENDULUM, (0, 2), parameters={G: 1.0}, **FIXED[0])
    monkeypatch.setattr(propagation, "propagated", lambda *_: pytest.fail("looked at anew"))
    assert prepared.propagate([1.0, 0.0]).steps == 20


def test_a_prepared_motion_shows_its_request_and_nothing_made_of_it() -> None:
    prepared = prepare("kepler", (0, 10), samples=2)
    assert repr(prepared) == f"PreparedMotion(request={prepared.request})"


def test_a_motion_that_was_prepared_goes_on():
    by = {"parameters": {G: 1.0}, "method": "verlet", "step": 0.125, "samples": 4}
    half = prepare(PENDULUM, (0, 2), **by).propagate([1.0, 0.0])
    whole = propagate(PENDULUM, (0, 4), [1.0, 0.0], **{**by, "samples": 8})
    np.testing.assert_array_equal(half.resume(4).y, whole.y)
