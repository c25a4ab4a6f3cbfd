"""Engines of methods: what integrates, which systems, by steps of which kind and in which precisions."""

from __future__ import annotations

from dataclasses import dataclass, replace

from canon.flow.method.number_formats import ADAPTIVE, FIXED

__all__ = ["FICTITIOUS_TIME", "FIXED_STEPS", "HEYOKA", "SCIPY", "Engine", "needs_hamiltonian"]

_FOR_ANY_SYSTEM = (
    "taylor", "dop853", "rk4", "gauss", "rattle", "nonholonomic_leapfrog", "lie_poisson", "galerkin",
)  # fmt: skip
"""Families of methods that need no Hamiltonian."""


def needs_hamiltonian(family: str) -> bool:
    """Tell whether the methods of a family are made for Hamiltonians and apply to nothing else."""
    return family not in _FOR_ANY_SYSTEM


@dataclass(frozen=True)
class Engine:
    """What integrates the methods of a kind, and what it can be asked for.

    Parameters
    ----------
    name
        What it is called.
    takes_step
        Whether the size of a step is given, ``step=``; else the method chooses its steps by its ``tolerance=``.
    precisions
        Keywords of the number formats it has, lowest first.
    usual_precision
        The one that is taken where none is asked for.
    takes_digits
        Whether a number of decimal digits is a precision too.
    keeps_polynomials
        Whether the motion can be kept as a function of time, ``dense=True``.
    """

    name: str
    takes_step: bool
    precisions: tuple[str, ...]
    usual_precision: str
    takes_digits: bool = False
    keeps_polynomials: bool = False

    @property
    def wider(self) -> tuple[str, ...]:
        """The precisions above the usual one."""
        return self.precisions[self.precisions.index(self.usual_precision) + 1 :]

    def understood(self, precision: str | None) -> str | None:
        """Return the precision asked of several methods at once as this one takes it.

        Of those meant for fixed steps, methods that choose their steps take none and run in their usual one.

        Examples
        --------
        >>> FIXED_STEPS.understood("single"), HEYOKA.understood("quad"), HEYOKA.understood("single")
        ('single', 'quad', None)
        """
        return precision if self.takes_step or precision in self.wider else None


FIXED_STEPS = Engine(
    "steps of one size", takes_step=True, precisions=tuple(FIXED), usual_precision="compensated"
)
"""Compiled loops, whose steps are all of one size."""

FICTITIOUS_TIME = replace(FIXED_STEPS, name="steps of one size in a fictitious time")
"""The same loops in a fictitious time."""

HEYOKA = Engine(
    "heyoka",
    takes_step=False,
    precisions=ADAPTIVE,
    usual_precision="double",
    takes_digits=True,
    keeps_polynomials=True,
)
"""heyoka's Taylor method."""

SCIPY = Engine("SciPy", takes_step=False, precisions=("double",), usual_precision="double")
"""SciPy's Runge–Kutta method."""
