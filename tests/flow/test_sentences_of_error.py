"""What an error estimate says, and where no companion of a motion knows more than it does."""

from __future__ import annotations

from time import process_time
from typing import Any

import numpy as np
import pytest
import sympy as sp

from canon import Event, Hamiltonian, Splitting, WisdomHolman, coordinates, propagate, time
from canon.flow import NonFiniteStateError
from canon.flow.estimate import companion
from canon.flow.estimate.error_estimate import ErrorEstimate

x, y = coordinates("x y")
SWING = Hamiltonian((x.momentum**2 + x**2) / 2, [x], [x.momentum])
FALL = Hamiltonian(
    (x.momentum**2 + y.momentum**2) / 2 - 1 / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
)


def estimate(relative: Any, condition: Any) -> ErrorEstimate:
    t = np.linspace(0, 10, 101)
    return ErrorEstimate(
        t, relative * np.ones((2, 101)), relative * np.ones(101), condition(t), np.array([]), "a companion"
    )


def test_growth_is_told_as_exponential_or_not_or_not_at_all() -> None:
    chaotic = estimate(1e-9, lambda t: np.exp(2 * t))
    assert chaotic.lyapunov_time == pytest.approx(0.5, rel=1e-12)
    assert str(chaotic) == (
        "relative error up to 1.0e-09 (9.0 digits); small changes grow up to 4.9e+08-fold; "
        "e-fold in 0.5 units of time (unstable); by a companion"
    )
    power = estimate(1e-9, lambda t: 1 + t**3)
    assert power.lyapunov_time is None
    assert str(power) == (
        "relative error up to 1.0e-09 (9.0 digits); small changes grow up to 1.0e+03-fold; by a companion"
    )
    unknown = estimate(1e-9, lambda t: np.full_like(t, np.nan))
    assert unknown.lyapunov_time is None
    assert str(unknown) == "relative error up to 1.0e-09 (9.0 digits); by a companion"


def test_growth_is_fitted_where_neighbours_still_have_to_do_with_each_other() -> None:
    """A condition beyond 10¹⁰ is that of strangers: of a few samples below it nothing is said."""
    assert estimate(1e-9, lambda t: np.exp(2 * np.minimum(t, 12))).lyapunov_time == pytest.approx(
        0.5, rel=1e-12
    )
    assert estimate(1e-9, lambda t: np.exp(50 * t)).lyapunov_time is None


def test_a_single_motion_means_nothing_beyond_a_tenth_of_its_size() -> None:
    lost = estimate(np.where(np.arange(101) < 40, 1e-3, 0.5), np.ones_like)
    assert lost.meaningful_until == 4.0
    assert str(lost) == (
        "relative error up to 5.0e-01 (0.3 digits); small changes grow up to 1.0e+00-fold; "
        "after t = 4 this single trajectory means nothing; by a companion"
    )


@pytest.mark.filterwarnings("ignore:the energy changes by")
@pytest.mark.parametrize("samples", [1, 10])
def test_nothing_is_known_beyond_a_collision_that_was_stepped_over(
    samples: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A fall from rest at 1 takes π/√8 = 1.11, which no companion passes; before it each sample is compared."""
    monkeypatch.setattr(companion, "_wider_taylor", lambda _: [("extended", 63)])
    motion = propagate(FALL, (0, 2), [1.0, 0, 0, 0], method="verlet", step=0.1, samples=samples)
    found = motion.error_estimate()
    before = motion.t < np.pi / np.sqrt(8)
    assert np.isinf(found.relative[~before]).all()
    assert found.companion == ("no companion" if samples == 1 else found.companion)
    if samples > 1:
        assert np.isfinite(found.relative[before]).all()
        # t = (arccos √x + √(x (1 − x)))/√2 at the distance x.
        fallen = motion.y[0][before]
        late = (np.arccos(np.sqrt(fallen)) + np.sqrt(fallen * (1 - fallen))) / np.sqrt(2) - motion.t[before]
        speeds = np.abs(motion.y[2][before])
        assert (np.abs(late) * speeds <= found.error[0][before] + 1e-12).all()


def test_a_fall_in_wide_numbers_ends_in_seconds() -> None:
    """They are never too large to be finite: steps towards a collision shrank for minutes."""
    begun = process_time()
    with pytest.raises(NonFiniteStateError, match="a collision or the edge of H's domain") as told:
        propagate(FALL, (0, 2), [1.0, 0, 0, 0], precision=25, samples=1)
    assert told.value.time == pytest.approx(np.pi / np.sqrt(8), abs=1e-15)
    assert process_time() - begun < 10


def test_where_rounding_is_all_the_error_the_last_companion_is_believed() -> None:
    """Kepler's motion is exact in each step of its own splitting: half the step rounds as much."""
    start = [0.5, 0.0, 0.0, np.sqrt(3)]
    motion = propagate(FALL, (0, 2 * np.pi), start, method=WisdomHolman(), step=np.pi / 50, samples=10)
    found = motion.error_estimate()
    assert np.abs(motion.final - start).max() <= found.error[:, -1].max() < 1e-12
    assert found.companion.startswith("wisdom-holman, step 0.0314159, ")


def test_events_in_another_order_have_times_that_are_not_known() -> None:
    """Verlet's oscillation is ahead of cos t: it meets zero before the clock does, and its companion after it."""
    early = sp.Rational(1570796, 10**6) - sp.Rational(4, 10**4)
    zero, clock = Event(x, name="zero"), Event(time - early, name="clock")
    motion = propagate(SWING, (0, 2), [1.0, 0.0], method=Splitting("verlet"), step=0.1, events=[zero, clock])
    assert [met.event.name for met in motion.events] == ["zero", "clock"]
    assert motion.events[0].t < early
    found = motion.error_estimate()
    assert np.isinf(found.events).all()
    exact = propagate(SWING, (0, 2), [1.0, 0.0], method=Splitting("verlet"), step=0.001, events=[zero, clock])
    assert [met.event.name for met in exact.events] == ["clock", "zero"]


def test_of_an_ensemble_the_events_of_the_orbits_that_are_asked_for() -> None:
    starts = np.array([[1.0, 0.0], [0.0, 1.0]])
    motion = propagate(SWING, (0, 4), starts, method="kahan-li-8", step=0.1, events=[Event(x)])
    found = motion.error_estimate(orbits=[1])
    # x = sin t: the zero at π alone; the other orbit has another.
    assert len(found.events) == 1
    assert len(motion.error_estimate(orbits=[0, 1]).events) == 2
