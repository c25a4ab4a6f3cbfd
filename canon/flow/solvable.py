"""Splittings by exactly solvable parts, as methods: Wisdom and Holman's map, SABA, SBAB and their kin."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.kernel.perturbed import ABA, corrector, saba, sbab, wisdom_holman
from canon.kernel.planets import Centres, Planets, UnsolvableError, named_part, solvable_part
from canon.kernel.solvable import solvable_loop

if TYPE_CHECKING:
    from sympy import Expr

    from canon.flow.precision import Precision
    from canon.kernel.loop import Loop
    from canon.kernel.scheme import Scheme
    from canon.kernel.structure import Equations

__all__ = ["SABA", "SBAB", "SolvableSplitting", "UnsolvableError", "WisdomHolman", "loop_of"]

Parts = tuple["Expr", "Expr"] | None


@dataclass(frozen=True)
class SolvableSplitting:
    """A symplectic splitting of H = H₀ + H₁ by the flow of H₀, known in closed form, and kicks by H₁.

    Made by :func:`WisdomHolman`, :func:`SABA` and :func:`SBAB`, or by ``Splitting(…, parts=(H0, H1))``.

    Parameters
    ----------
    scheme
        Its a are the times of H₀'s flow, its b those of the kicks, in steps.
    corrector
        The order of a symplectic corrector, 0 for none.
    parts
        H₀ and H₁; found from the structure of H where not given.
    """

    scheme: Scheme
    corrector: int = 0
    parts: Parts = None

    def __post_init__(self) -> None:
        if self.corrector:
            corrector(self.scheme, self.corrector)

    def __str__(self) -> str:
        corrected = f", corrector {self.corrector}" if self.corrector else ""
        return f"{self.scheme.name or 'splitting'}{corrected}{', own parts' if self.parts else ''}"

    @property
    def order(self) -> int:
        """The order in the step size; what is linear in H₁ errs by a higher one."""
        return self.scheme.order

    @property
    def stages(self) -> int:
        """Kicks in a step."""
        return self.scheme.stages

    @property
    def citation(self) -> str:
        """Where the scheme was published."""
        return self.scheme.citation


def WisdomHolman(*, corrector: int = 0, parts: Parts = None) -> SolvableSplitting:
    """Return Wisdom and Holman's method: Kepler's motion of every planet, kicks by the planets' attractions.

    For planets about a star the coordinates are Jacobi's, the bodies in the order of the Hamiltonian's coordinates
    after the heaviest, which should be the order of their orbits. H₀ may also be Kepler's motion about fixed centres,
    or what is quadratic in (q, p).

    Parameters
    ----------
    corrector
        The order of a symplectic corrector, an odd number from 3 to 17; 0 for none. The energy's error
        is ε τ² without, ε τ^(corrector + 1) + ε² τ² with it.
    parts
        H₀ and H₁, in place of what is found from the structure of H. H₁ is to be a function of q alone.

    Raises
    ------
    ValueError
        There is no such corrector.

    Examples
    --------
    >>> from canon.flow.propagate import propagate
    >>> from canon.scene import find
    >>> planets = find("outer-solar-system")
    >>> start = planets.start("1994")
    >>> motion = propagate(
    ...     planets.hamiltonian, [*start.q, *start.p], (0, 100_000), method=WisdomHolman(corrector=7), step=200.0,
    ...     parameters=planets.values,
    ... )
    >>> bool(abs(motion.energy_error).max() < 3e-8)
    True
    """
    return SolvableSplitting(wisdom_holman(), corrector, parts)


def SABA(stages: int | str, *, corrector: int = 0, parts: Parts = None) -> SolvableSplitting:
    """Return Laskar and Robutel's method SABA_n, or one of Blanes and others that kills ε² τ² too.

    Parameters
    ----------
    stages
        n = 1 … 8 kicks in a step, errors ε τ^2n + ε² τ²; or ``"8-6-4"`` (7 kicks, ε τ⁸ + ε² τ⁶ + ε³ τ⁴),
        ``"10-6-4"`` (8 kicks, ε τ¹⁰ + ε² τ⁶ + ε³ τ⁴).
    corrector, parts
        As for :func:`WisdomHolman`.

    Raises
    ------
    ValueError
        There is no such method or corrector.

    Examples
    --------
    >>> str(SABA(4)), SABA("10-6-4").stages
    ('saba-4', 8)
    """
    if isinstance(stages, str):
        if stages not in ABA:
            raise ValueError(
                f"SABA({stages!r}): give a number of stages from 1 to 8, or one of {', '.join(ABA)}"
            )
        return SolvableSplitting(ABA[stages], corrector, parts)
    return SolvableSplitting(saba(stages), corrector, parts)


def SBAB(stages: int, *, corrector: int = 0, parts: Parts = None) -> SolvableSplitting:
    """Return Laskar and Robutel's method SBAB_n: n kicks in a step, the first and last half ones of two steps.

    Parameters
    ----------
    stages
        n = 1 … 8, errors ε τ^2n + ε² τ².
    corrector, parts
        As for :func:`WisdomHolman`.

    Examples
    --------
    >>> SBAB(3).stages
    3
    """
    return SolvableSplitting(sbab(stages), corrector, parts)


def loop_of(system: Equations, method: SolvableSplitting, precision: Precision) -> Loop:
    """Return the compiled loop of a splitting by solvable parts, kept from an earlier call if there was one.

    Raises
    ------
    UnsolvableError
        H has no solvable part, or not the one that was named.
    ValueError
        The precision is another than ``"double"`` and ``"compensated"``.
    """
    if precision.name not in ("double", "compensated"):
        raise ValueError(
            f"precision={precision.name!r}: splittings by solvable parts have 'double' and 'compensated'; "
            "Taylor() has more"
        )
    if not system.autonomous:
        raise UnsolvableError(
            "H depends on t: splittings by solvable parts are for H(q, p); use Splitting('kahan-li-8')"
        )
    if system.varying:
        raise UnsolvableError(
            "parameters that differ by orbit: splittings by solvable parts take one number for each"
        )
    return _kept(system, method, compensated=precision.compensated)


@functools.lru_cache(maxsize=64)
def _kept(system: Equations, method: SolvableSplitting, *, compensated: bool) -> Loop:
    part = solvable_part(system) if method.parts is None else named_part(system, *method.parts)
    if isinstance(part, Planets | Centres) and len({len(body) for body in part.bodies}) > 1:
        raise UnsolvableError(
            "the bodies have different numbers of coordinates; give each as many, or name two parts"
        )
    chosen = corrector(method.scheme, method.corrector) if method.corrector else None
    return solvable_loop(part, len(system.q), method.scheme, chosen, compensated=compensated)
