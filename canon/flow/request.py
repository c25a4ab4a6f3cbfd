"""Request of a motion: the system, its span and start, how to integrate, and what to keep of it, as a user says it."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Expr, Symbol

    from canon.flow.method.method_text import MethodGiven
    from canon.flow.method.setting import Setting
    from canon.flow.run.event import Event

__all__ = ["Request"]


@dataclass(frozen=True, eq=False)
class Request:
    """The arguments of :func:`canon.flow.propagate.propagate`, which documents them, as one value; nothing is checked.

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
