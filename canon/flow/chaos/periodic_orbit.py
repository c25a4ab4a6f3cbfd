"""Periodic orbits of Hamiltonians and maps: what is asked, checked, and where the search begins."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.chaos.period_of_drive import check_period_of_drive
from canon.flow.chaos.periodic_search import PeriodicOrbit, PeriodicSearch
from canon.flow.request import Request
from canon.flow.system.named_values import variables_of
from canon.flow.system_request import any_task
from canon.flow.tangent.deviation_growth import check_jumps

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy.typing as npt
    from sympy import Symbol

    from canon.array import Array
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.system.recognised_system import MovableSystem

__all__ = ["periodic_orbit"]


def periodic_orbit(
    system: MovableSystem,
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None,
    period: float,
    *,
    energy: float | None = None,
    fixed_period: bool = False,
    reversal: Sequence[str | Symbol] | None = None,
    turns: Mapping[str | Symbol, float] | None = None,
    method: MethodGiven | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
) -> PeriodicOrbit:
    """Return the periodic orbit near a start and a guess of its period.

    Newton's method solves Φ_T(y) = y + turns for y and T, with steps at right angles to the orbit, at constant energy,
    or at constant period. A system that depends on time keeps the period that is given, which is to be a multiple of
    its own. Everything is measured by the trial orbit itself, so that units do not matter.

    Parameters
    ----------
    system
        A Hamiltonian, or a scene that has one.
    y0, parameters
        As :func:`canon.propagate` takes them; one start.
    period
        A guess of the period, positive.
    energy
        The orbit's energy; that of the start where not given.
    fixed_period
        Keep the period and let the energy vary instead.
    reversal
        The variables whose signs a symmetry of the system changes that reverses the motion, such as ``("y", "p_x")`` of
        the restricted three-body problem. Then an orbit is looked for that passes their common zeros twice, half a
        period apart, and half of it is integrated. The start is moved there.
    turns
        Of angles: how much they gain in a period, such as 2π.
    method, step, tolerance
        As ``propagate`` takes them; Taylor's method where none is given. With a method of fixed steps the orbit is a
        periodic one of the method's own map, at the given step.

    Raises
    ------
    NoPeriodicOrbitError
        Newton's method does not come to an end; the error has the nearest it came.
    TypeError, ValueError, KeyError
        As ``propagate``; the period is not positive; the system is no Hamiltonian; the reversal is none of its
        symmetries; it depends on time, and is not the same after the period.

    Notes
    -----
    What is found near the start may close after a part of the period already, as a fixed point of a map does after any:
    ``least_period`` has the shortest time, M and the multipliers are those of the whole period.

    Examples
    --------
    The orbit of R. F. Arenstorf between Earth and Moon (Amer. J. Math. 85 (1963) 27, doi:10.2307/2373181):

    >>> orbit = periodic_orbit("restricted-three-body", "Arenstorf", 17.07, reversal=("y", "p_x"))
    >>> round(orbit.period, 6), orbit.multipliers.kinds
    (17.065217, ('hyperbolic',))
    """
    if not float(period) > 0:
        raise ValueError(
            f"period={period}: give a guess of the time after which the orbit comes back, above 0"
        )
    given = Request(
        system, (0.0, float(period)), y0, method=method, step=step, tolerance=tolerance, parameters=parameters,
        samples=1,
    )  # fmt: skip
    search, start = _search(given, reversal, turns, fixed_period=fixed_period)
    driven = not (search.equations.autonomous or search.equations.kicked)
    if driven:
        check_period_of_drive(search.equations, search.course(start, float(period)), float(period))
    wanted = energy if energy is not None else None if search.fixed_period else search.energy(start)
    if energy is not None and search.fixed_period:
        raise ValueError("the period is fixed, so that the energy follows: give one of them")
    return search.found(start, float(period), wanted)


def _search(
    given: Request,
    reversal: Sequence[str | Symbol] | None,
    turns: Mapping[str | Symbol, float] | None,
    *,
    fixed_period: bool,
) -> tuple[PeriodicSearch, Array]:
    """Return what is looked for, and where from.

    Raises
    ------
    TypeError, ValueError, KeyError
        As :func:`periodic_orbit`.
    """
    task, moving = any_task(given)
    if moving is not None or not task.system.canonical:
        raise TypeError(
            f"a {moving.kind if moving else 'system'} is no Hamiltonian: periodic orbits of others are not looked for"
        )
    if not task.single:
        raise ValueError("one start at a time: y0 of shape (2n,)")
    if task.fictitious is not None:
        raise ValueError(f"{task.method} has steps that vary: take Taylor(), or a method of fixed steps")
    check_jumps(task)
    system = task.system
    variables = [symbol.name for symbol in variables_of(system)]
    shift = np.zeros(len(variables))
    for name, turn in (turns or {}).items():
        shift[_place(variables, name)] = turn
    signs = None
    if reversal is not None:
        signs = np.ones(len(variables))
        signs[[_place(variables, name) for name in reversal]] = -1
        if shift.any():
            raise ValueError("turns and reversal: give one of them")
    search = PeriodicSearch(given, system, shift, signs, fixed_period or not system.autonomous)
    start = (
        (task.states[0] + task.states[1])[:, 0]
        if task.states[0].ndim == 2
        else task.states[0] + task.states[1]
    )
    if signs is not None:
        if system.kicked and float(given.t_span[1]) % 2:
            raise ValueError("reversal: a map has no state after half of an odd period; leave reversal out")
        start = np.where(signs < 0, 0.0, start)
        search.check_reversal(start, float(given.t_span[1]))
    return search, start


def _place(variables: list[str], name: str | Symbol) -> int:
    if str(name) not in variables:
        raise KeyError(f"there is no variable {name}, the motion has {', '.join(variables)}")
    return variables.index(str(name))
