"""Kept of a case: what its run leaves behind part by part, and the arrays made of it when the run has ended."""

from __future__ import annotations

import traceback
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from canon.flow.chaos.chaos_indicators import megno
from canon.flow.chaos.regularity import Regularity
from canon.flow.geometry.flow_jacobian import flow_jacobian
from canon.flow.run.event import Event, prepared_events
from canon.study.cases.case_observables import read_formula
from canon.study.kept.keep_choice import CHAOS, DIRECTIONS, EXPONENT, MOTION, SECTION
from canon.study.kept.kept_arrays import finite_arrays
from canon.study.kept.kept_motion import KeptMotion, joined_rows, rows_as_text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from sympy import Expr

    from canon.array import Array
    from canon.flow.trajectory import Trajectory
    from canon.study.cases.case import Case
    from canon.study.motion.extended_phase_space import Driven

__all__ = ["FailedFunction", "kept_arrays", "kept_on_the_way", "section_of"]

INNERMOST = 5
"""Places in a function that raised which are told, the innermost ones."""

TIMES_OF_EXPONENT = 64
"""Times at which the exponent of a motion is kept: how it settles shows in them."""


@lru_cache(maxsize=64)
def section_of(case: Case, timed: Driven | None) -> tuple[Event, ...]:
    """Return the event that makes the section of a case, none where no section is kept.

    Raises
    ------
    StudyError
        Where its formula can't be read.
    """
    text = dict(case.keep).get(SECTION)
    if text is None:
        return ()
    direction, _, formula = text.partition(" ")
    function = read_formula(case, "the section", formula)
    if timed is not None:
        function = cast("Expr", function.xreplace(dict([timed.time])))
    return (Event(function, DIRECTIONS[direction], name=SECTION),)


def kept_on_the_way(
    case: Case, so_far: Mapping[str, tuple[str, ...]], found: Trajectory, timed: Driven | None
) -> Mapping[str, tuple[str, ...]]:
    """Return what is kept after one more part: its states, and where it passed the section."""
    new: dict[str, str] = {}
    if any(name == MOTION or text.startswith("function ") for name, text in case.keep):
        first = 1 if so_far else 0  # the first sample of a part is the last one of the part before
        new[MOTION] = rows_as_text(_in_own_variables(found.y, timed)[:, first:])
    if SECTION in dict(case.keep):
        rows = [[met.t, *_in_own_variables(met.y, timed)] for met in found.events]
        if so_far and _passes_at_start(found, section_of(case, timed)[0]):
            rows.insert(0, [float(found.t[0]), *_in_own_variables(found.y[:, 0], timed)])
        new[SECTION] = rows_as_text(np.array(rows).T)
    return {name: (*so_far.get(name, ()), text) for name, text in new.items()}


def _passes_at_start(found: Trajectory, section: Event) -> bool:
    """Tell whether a part begins on the section and passes it: the part before ended there, this one starts there."""
    record = found.record
    event = prepared_events(record.task.system, [section])[0]
    value, rate = (float(values[0]) for values in record.values((event.value, event.rate)))
    return value == 0.0 and rate != 0.0 and section.counts(rising=rate > 0.0)


def kept_arrays(
    case: Case,
    kept: Mapping[str, tuple[str, ...]],
    t: Array,
    energy_change: Array,
    functions: Mapping[str, Callable[..., Any]],
) -> dict[str, Array]:
    """Return all arrays that are kept of a case that reached its end, by whole name.

    Parameters
    ----------
    case
        The case.
    kept
        What the parts left (:func:`kept_on_the_way`).
    t, energy_change
        Times of the samples, and H − H(start) there.
    functions
        Functions of the motion by name.

    Raises
    ------
    KeyError
        A function of the case is not given.
    FailedFunction
        One of them raised.
    ValueError
        What one of them returns can't be kept.
    """
    variables = case.variables
    found: dict[str, Array] = {}
    for name, _ in case.keep:
        if name == SECTION:
            rows = joined_rows(kept[SECTION], 1 + len(variables))
            found |= {f"{SECTION}.{each}": row for each, row in zip(("t", *variables), rows, strict=True)}
        elif name in COMPUTED_ANEW:
            found |= {f"{name}.{each}": row for each, row in COMPUTED_ANEW[name](case).items()}
        else:
            y = joined_rows(kept[MOTION], len(variables))
            motion = KeptMotion(case.system_name, case.values, variables, t, y, energy_change)
            if name == MOTION:
                found |= {f"{MOTION}.{each}": row for each, row in motion.arrays.items()}
            else:
                found |= finite_arrays(name, _result(name, functions[name], motion))
    return found


class FailedFunction(Exception):
    """Raised where a function of the motion, which is not canon's, raised; says where in it."""

    def __init__(self, name: str, error: Exception) -> None:
        inside = traceback.extract_tb(error.__traceback__)[1:]  # the first is the call from here
        where = ", ".join(f"{Path(at.filename).name}:{at.lineno} in {at.name}" for at in inside[-INNERMOST:])
        super().__init__(f"{name} raised {type(error).__name__}: {error}" + (f" ({where})" if where else ""))


def _result(name: str, function: Callable[..., Any], motion: KeptMotion) -> Any:
    try:
        return function(motion)
    except MemoryError:
        raise
    except Exception as error:  # of code that is not canon's: it fails for this case, and may not for others
        raise FailedFunction(name, error) from error


def _exponent(case: Case) -> dict[str, Array]:
    """Return ln ‖∂y(t)/∂y(0)‖ / t at some times: it tends to the largest Lyapunov exponent.

    It is computed after the run, from the start in one piece; ‖ ‖ is the size of the largest entry (Benettin et al.,
    Meccanica 15 (1980) 9, https://doi.org/10.1007/BF02128236, have the theory).
    """
    found = flow_jacobian(
        case.hamiltonian,
        (0.0, case.span),
        case.state,
        method=case.method,
        step=case.step,
        tolerance=case.tolerance,
        precision=case.precision,
        parameters={**case.values},
        samples=TIMES_OF_EXPONENT,
    )
    later = found.t > 0.0
    t = found.t[later]
    return {"t": t, "largest": found.log_size[later] / t}


OF_VERDICTS = {
    Regularity.REGULAR: -1.0,
    Regularity.NOT_KNOWN: 0.0,
    Regularity.CHAOTIC: 1.0,
    Regularity.UNSTABLE: 2.0,
}
"""Verdicts as numbers, which arrays of many cases hold."""


def _chaos(case: Case) -> dict[str, Array]:
    """Return MEGNO at some times, and at each the verdict on the whole run with the rate that would have been found."""
    found = megno(
        case.hamiltonian,
        (0.0, case.span),
        case.state,
        method=case.method,
        step=case.step,
        tolerance=case.tolerance,
        precision=case.precision,
        parameters={**case.values},
        samples=TIMES_OF_EXPONENT,
    )
    later = found.t > 0.0
    verdict = np.full(int(later.sum()), OF_VERDICTS[cast("Regularity", found.verdict)])
    limit = np.full(len(verdict), found.detection_limit)
    return {"t": found.t[later], "megno": found.history[later], "verdict": verdict, "detection_limit": limit}


COMPUTED_ANEW = {EXPONENT: _exponent, CHAOS: _chaos}
"""What is computed after the run, from the start in one piece."""


def _in_own_variables(y: Array, timed: Driven | None) -> Array:
    return y if timed is None else timed.original(y)
