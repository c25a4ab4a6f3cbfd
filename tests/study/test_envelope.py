"""Envelopes of errors: the largest and the median of each interval of the logarithm of time, by hand."""

from __future__ import annotations

import numpy as np

from canon.study.energy_drift.envelope import envelope_of


def test_largest_and_median_of_each_interval() -> None:
    t = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 20.0, 30.0, 100.0])
    error = np.array([0.0, 1.0, -9.0, 2.0, 4.0, 7.0, 0.5, -3.0])
    found = envelope_of(t, error, intervals=2)  # 1 … 10 and 10 … 100
    assert found is not None
    assert found["largest"].tolist() == [9.0, 7.0]
    assert found["median"].tolist() == [3.0, 3.0]
    assert found["t"].tolist() == [np.sqrt(10.0), 100.0]


def test_the_first_oscillation_is_left_out_and_zeros_have_no_logarithm() -> None:
    t = np.linspace(0.0, 100.0, 1001)
    error = np.where(t < 1.0, 50.0, 1.0)
    error[-1] = 0.0
    found = envelope_of(t, error, intervals=5)
    assert found is not None
    assert found["largest"].tolist() == [1.0] * 5
    assert envelope_of(t, np.zeros_like(t)) is None
