"""Setting of a run: a method with its step or tolerance, and the numbers it is run in."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from canon.flow.method.method import Method

__all__ = ["Setting"]


@dataclass(frozen=True)
class Setting:
    """A method with its step or tolerance and its precision, as :func:`canon.flow.propagation.propagate` takes them.

    Parameters
    ----------
    method
        The method.
    step, tolerance
        What its errors are set by; None for the other, or for the method's own tolerance.
    precision
        The numbers; the method's usual ones where None.

    Examples
    --------
    >>> from canon import Splitting
    >>> coarse = Setting(Splitting("verlet"), step=0.1)
    >>> coarse.turned(0.05).step, coarse.arithmetic
    (0.05, 'compensated')
    """

    method: Method
    step: float | None = None
    tolerance: float | None = None
    precision: str | None = None

    @property
    def arithmetic(self) -> str:
        """The precision, the method's usual one where none is given."""
        return self.precision or self.method.engine.usual_precision

    @property
    def knob(self) -> float:
        """The step, or the tolerance of a method that chooses its steps."""
        return self.step if self.step is not None else self.tolerance or 2.0**-52

    def turned(self, knob: float) -> Setting:
        """Return the setting with another step or tolerance."""
        return replace(self, **{"step" if self.method.engine.takes_step else "tolerance": knob})
