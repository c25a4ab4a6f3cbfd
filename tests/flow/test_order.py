"""Every method has the order it claims, on nonlinear problems, against heyoka."""

import numpy as np
import pytest

from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor
from canon.flow.propagation import propagate
from canon.kernel.schemes.splitting_schemes import SCHEMES
from tests.flow.systems import (
    DRIVEN,
    DRIVEN_START,
    HENON_HEILES,
    HENON_HEILES_START,
    RELATIVISTIC,
    RELATIVISTIC_START,
)

SPAN = 12.0


def fitted_order(system, start, method, window=(3e-12, 1e-4), span=SPAN, longest=0.5):
    """Fit errors inside a window: below it is round-off, above it the steps are too long for a power law."""
    floor, ceiling = window
    true = propagate(system, (0, span), start, method=Taylor(), samples=1).final
    steps, errors = [], []
    for n in np.unique(np.geomspace(span / longest, 500 * span, 120).astype(int)):
        found = propagate(system, (0, span), start, method=method, step=span / n, samples=1)
        error = abs(found.final - true).max()
        if floor < error < ceiling:
            steps.append(found.step)
            errors.append(error)
    assert len(steps) >= 6
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize("method", [*map(Splitting, SCHEMES), RK4()], ids=str)
def test_fitted_order(method):
    if method.order == 10:
        slope = fitted_order(HENON_HEILES, HENON_HEILES_START, method, window=(3e-13, 3e-9), span=60.0)
    else:
        slope = fitted_order(HENON_HEILES, HENON_HEILES_START, method)
    assert slope == pytest.approx(method.order, abs=0.05 * method.order)


@pytest.mark.parametrize(
    "method", [Splitting("verlet"), Splitting("blanes-moan-4"), Splitting("kahan-li-6"), RK4()], ids=str
)
def test_fitted_order_where_both_parts_of_h_depend_on_time(method):
    slope = fitted_order(DRIVEN, DRIVEN_START, method)
    assert slope == pytest.approx(method.order, abs=0.05 * method.order)


@pytest.mark.parametrize("stages", range(1, 9))
def test_fitted_order_of_gauss_methods_on_a_hamiltonian_that_does_not_split(stages):
    window = (1e-7, 1e-4) if stages == 1 else (3e-13, 1e-6)
    slope = fitted_order(
        RELATIVISTIC, RELATIVISTIC_START, Gauss(stages), window=window, span=40.0, longest=1.0
    )
    assert slope == pytest.approx(2 * stages, abs=0.1 * stages)


def test_gauss_methods_follow_a_driven_system():
    assert fitted_order(DRIVEN, DRIVEN_START, Gauss(2)) == pytest.approx(4, abs=0.1)


def test_the_users_own_coefficients_run():
    # Ruth's third-order method: not symmetric, so its order is odd.
    ruth = Splitting(a=["0", "2/3", "-2/3", "1"], b=["7/24", "3/4", "-1/24"])
    assert ruth.order == 3
    assert fitted_order(HENON_HEILES, HENON_HEILES_START, ruth) == pytest.approx(3, abs=0.1)


def test_dop853_follows_its_tolerance():
    true = propagate(HENON_HEILES, (0, SPAN), HENON_HEILES_START).final
    errors = [
        abs(propagate(HENON_HEILES, (0, SPAN), HENON_HEILES_START, method=DOP853(tol)).final - true).max()
        for tol in (1e-4, 1e-7, 1e-10)
    ]
    assert errors[0] > 20 * errors[1] > 400 * errors[2]
    assert errors[2] < 1e-8
