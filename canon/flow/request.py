"""Request of a motion: the system, its span and start, how to integrate, and what to keep of it, as a user says it."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, fields, replace
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Expr, Symbol

    from canon.flow.method.method_text import MethodGiven
    from canon.flow.method.setting import Setting
    from canon.flow.run.event import Event

__all__ = ["Request", "refuse_unknown"]

# What other libraries call the arguments of a run, and what is given here.
_ELSEWHERE = {
    "t_eval": "times=[…] keeps the states at these times",
    "args": "parameters={symbol or name: number} gives the numbers of a system; those of a function go into it, "
    "lambda t, y: f(t, y, 0.3)",
    "rtol": "tolerance= is the relative tolerance of an adaptive method",
    "atol": "there is no absolute tolerance; tolerance= is the relative one of an adaptive method",
    "dense_output": "dense=True keeps the polynomials, and motion(t) evaluates them",
    "first_step": "an adaptive method finds its first step; max_step= bounds it, and step= is for fixed steps",
    "jac": "derivatives are taken from the formulas, so none is needed",
    "vectorized": "many orbits are a start of shape (2n, orbits)",
    **dict.fromkeys(
        ("dt", "h", "timestep", "stepsize", "step_size"), "step= is the step of a fixed-step method"
    ),
    **dict.fromkeys(
        ("until", "span", "duration", "t_end", "t_final", "t"), "t_span=(first, last) is the span of time"
    ),
    **dict.fromkeys(("x0", "state", "initial", "start", "y_init", "ic"), "y0= is the starting state"),
    **dict.fromkeys(("n", "num", "n_samples", "points"), "samples= is how many states are kept"),
}


def refuse_unknown(unknown: Mapping[str, object], function: str = "propagate") -> None:
    """Refuse arguments that :func:`canon.flow.propagation.propagate` does not have, saying what is given instead.

    Parameters
    ----------
    unknown
        The arguments.
    function
        Which function was called; :func:`canon.flow.prepare` has the same arguments but the start.

    Raises
    ------
    TypeError
        Where there is one.

    Examples
    --------
    >>> refuse_unknown({"t_eval": [0, 1]})
    Traceback (most recent call last):
        ...
    TypeError: propagate has no argument t_eval=: times=[…] keeps the states at these times
    """
    known = [field.name for field in fields(Request)]
    said: list[str] = []
    for name in unknown:
        near = get_close_matches(name, [*known, "progress"], n=1)
        hint = _ELSEWHERE.get(name) or (
            f"did you mean {near[0]}=?" if near else f"it has {', '.join(known[3:])}"
        )
        if function == "prepare" and (name in ("y0", "progress") or hint == _ELSEWHERE["x0"]):
            hint = "what it returns takes the start, prepare(…).propagate(y0)"
        said.append(f"{function} has no argument {name}=: {hint}")
    if said:
        raise TypeError("; ".join(said))


@dataclass(frozen=True, eq=False)
class Request:
    """The arguments of :func:`canon.propagate`, which documents them, as one value; nothing is checked.

    Examples
    --------
    >>> from canon import RK4
    >>> from canon.flow.method.setting import Setting
    >>> Request("kepler", (0, 10), samples=2).by(Setting(RK4(), step=0.1)).step
    0.1
    """

    system: Any
    t_span: tuple[float | Fraction, float | Fraction]
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None
    _: KW_ONLY
    method: MethodGiven | None = None
    step: float | None = None
    tolerance: float | None = None
    max_step: float | None = None
    precision: str | int | None = None
    parameters: Mapping[Symbol | str, Any] | None = None
    samples: int | None = None
    times: npt.ArrayLike | None = None
    observables: Mapping[str, Expr] | None = None
    cadence: int | None = None
    events: Sequence[Event] = ()
    dense: bool = False

    def by(self, setting: Setting) -> Request:
        """Return the request of the same motion by a method with its step or tolerance and precision."""
        return replace(
            self,
            method=setting.method,
            step=setting.step,
            tolerance=setting.tolerance,
            precision=setting.precision,
        )
