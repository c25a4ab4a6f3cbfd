"""Maps of kicks: iterated as written down, proved canonical, with the exponents and periodic orbits that are known."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import Event, Splitting, coordinates, parameters, propagate
from canon.flow import (
    HamiltonianMap,
    Regularity,
    flow_jacobian,
    lyapunov_spectrum,
    megno,
    periodic_orbit,
    reversal_error,
)

q, r = coordinates("q r")
K, L, c = parameters("K L c", positive=True)
STANDARD = HamiltonianMap(q.momentum**2 / 2, K * sp.cos(q), [q], [q.momentum])
FROESCHLE = HamiltonianMap(
    (q.momentum**2 + r.momentum**2) / 2,
    K * sp.cos(q) + L * sp.cos(r) + c * sp.cos(q + r),
    [q, r],
    [q.momentum, r.momentum],
)


@settings(max_examples=50)
@given(start=st.tuples(*[st.floats(-3, 3)] * 2), strength=st.floats(0.125, 2), count=st.integers(1, 8))
def test_it_is_iterated_as_it_is_written_down(
    start: tuple[float, float], strength: float, count: int
) -> None:
    motion = propagate(STANDARD, (0, count), start, samples=count, parameters={K: strength})
    x, p = start
    for k in range(count):
        p += strength * np.sin(x)
        x += p
        assert motion.y[:, k + 1] == pytest.approx([x, p], abs=1e-11)


def test_it_is_proved_canonical_and_its_images_are_what_is_iterated() -> None:
    assert FROESCHLE.transformation.is_canonical()
    start, numbers = [0.3, -0.4, 0.1, 0.7], {K: 0.5, L: 0.25, c: 0.125}
    at = dict(zip((*FROESCHLE.q, *FROESCHLE.p), start, strict=True)) | numbers
    once = propagate(FROESCHLE, (0, 1), start, samples=1, parameters=numbers)
    assert once.final == pytest.approx([float(image.subs(at)) for image in FROESCHLE.images], abs=1e-15)


def test_its_jacobian_is_symplectic_and_it_runs_back() -> None:
    numbers = {K: 0.5, L: 0.25, c: 0.125}
    found = flow_jacobian(FROESCHLE, (0, 20), [0.3, -0.4, 0.1, 0.7], parameters=numbers, samples=20)
    assert found.symplecticity_defect.max() < 1e-11
    assert found.M[:, :, 1] == pytest.approx(
        np.array(sp.Matrix(FROESCHLE.images).jacobian([*FROESCHLE.q, *FROESCHLE.p]).subs(
            dict(zip((*FROESCHLE.q, *FROESCHLE.p), (0.3, -0.4, 0.1, 0.7), strict=True)) | numbers
        )).astype(float), abs=1e-14
    )  # fmt: skip
    assert abs(reversal_error(FROESCHLE, (0, 20), [0.3, -0.4, 0.1, 0.7], parameters=numbers)).max() < 1e-12
    there = propagate(STANDARD, (0, 7), [0.3, 0.2], parameters={K: 1.5}).final
    back = propagate(STANDARD, (7, 0), there, parameters={K: 1.5}).final
    assert back == pytest.approx([0.3, 0.2], abs=1e-13)


@pytest.mark.parametrize("strength", [0.5, 1.5, 3.9])
def test_fixed_point_and_orbit_of_period_two(strength: float) -> None:
    at_rest = periodic_orbit(STANDARD, [3.1, 0.05], 1, parameters={K: strength})
    assert at_rest.y == pytest.approx([np.pi, 0], abs=1e-14)
    assert at_rest.multipliers.indices.real == pytest.approx([2 - strength], abs=1e-13)
    assert at_rest.multipliers.stable is (strength < 4)
    two = periodic_orbit(STANDARD, [0.05, 3.1], 2, parameters={K: strength}, turns={q: 2 * np.pi})
    assert two.y == pytest.approx([0, np.pi], abs=1e-13)
    assert two.multipliers.indices.real == pytest.approx([2 - strength**2], abs=1e-12)
    assert two.multipliers.stable is (strength < 2)


def test_exponents_of_strong_kicks_and_islands_of_weak_ones() -> None:
    """B. V. Chirikov, Phys. Rep. 52 (1979) 263, § 5.3: λ = ln(K/2) for K > 6."""
    strong = lyapunov_spectrum(STANDARD, (0, 100_000), [0.1, 0.2], parameters={K: 20})
    assert strong.largest == pytest.approx(np.log(10), abs=0.02)
    assert strong.pairing_defect < 1e-12
    starts = np.array([[3.0, 0.01], [0.1, 0.0]])
    found = megno(STANDARD, (0, 10_000), starts, parameters={K: 1.5})
    assert found.verdict.tolist() == [Regularity.REGULAR, Regularity.CHAOTIC]


def test_what_a_map_has_not_is_told() -> None:
    start = [0.1, 0.2]
    with pytest.raises(ValueError, match="a map has no method, it is iterated; leave method out"):
        propagate(STANDARD, (0, 10), start, method=Splitting("verlet"), parameters={K: 1})
    with pytest.raises(ValueError, match="a map has no step"):
        propagate(STANDARD, (0, 10), start, step=0.1, parameters={K: 1})
    with pytest.raises(ValueError, match=r"t = 2\.5: a map is iterated a whole number of times"):
        propagate(STANDARD, (0, 2.5), start, parameters={K: 1})
    with pytest.raises(ValueError, match="no states between its iterations"):
        propagate(STANDARD, (0, 10), start, parameters={K: 1}, events=[Event(q)])
    with pytest.raises(ValueError, match="no step that could be made smaller"):
        propagate(STANDARD, (0, 10), start, parameters={K: 1}).error_estimate()
    with pytest.raises(ValueError, match=r"H depends on t, so its change is no error"):
        assert propagate(STANDARD, (0, 10), start, parameters={K: 1}).energy_error
    with pytest.raises(ValueError, match="T = p_q\\*q holds q"):
        HamiltonianMap(q * q.momentum, sp.cos(q), [q], [q.momentum])
    with pytest.raises(KeyError, match="K"):
        propagate(STANDARD, (0, 10), start)


def test_a_map_has_no_states_between_its_iterations():
    motion = propagate(STANDARD, (0, 10), [0.1, 0.2], parameters={K: 0.9}, samples=5)
    np.testing.assert_array_equal(motion(4), motion.y[:, 2])
    with pytest.raises(ValueError, match="no states between its iterations"):
        motion([4, 4.5])


def test_a_map_steps_over_no_kinks():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = propagate(HamiltonianMap(q.momentum**2 / 2, sp.Abs(q), [q], [q.momentum]), (0, 3), [0.3, 0.1])
    np.testing.assert_allclose(found.y, [[0.3, -0.6, -0.5, 0.6], [0.1, -0.9, 0.1, 1.1]], atol=1e-15)
