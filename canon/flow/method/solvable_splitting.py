"""Splittings by exactly solvable parts as methods: Wisdom–Holman, SABA, SBAB and their variants."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.kernel.schemes.perturbed_schemes import (
    ABA,
    LASKAR_ROBUTEL,
    corrector,
    saba,
    sbab,
    wisdom_holman,
    with_commutator,
)
from canon.kernel.solvable.solvable_loop import solvable_loop
from canon.kernel.solvable.solvable_parts import Centres, Planets, UnsolvableError, named_part, solvable_part

if TYPE_CHECKING:
    from sympy import Expr

    from canon.flow.method.number_formats import Precision
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.schemes.splitting_schemes import Scheme

__all__ = ["COORDINATES", "SABA", "SBAB", "SolvableSplitting", "UnsolvableError", "WisdomHolman", "loop_of"]

Parts = tuple["Expr", "Expr"] | None

COORDINATES = ("jacobi", "democratic-heliocentric")
"""Coordinates of planets about a star."""

_CORRECTORS = "J. Wisdom, M. Holman, J. Touma, Symplectic correctors, Fields Inst. Commun. 10 (1996) 217–244"

_DEMOCRATIC = (
    "M. J. Duncan, H. F. Levison, M. H. Lee, A multiple time step symplectic algorithm for integrating close "
    "encounters, Astron. J. 116 (1998) 2067–2077, doi:10.1086/300541"
)


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
    commutator
        Whether kicks hold the commutator {H₁, {H₀, H₁}} too, which takes ε² τ² away.
    coordinates
        Of planets about a star: ``"jacobi"`` or ``"democratic-heliocentric"``.
    """

    scheme: Scheme
    corrector: int = 0
    parts: Parts = None
    commutator: bool = False
    coordinates: str = "jacobi"

    def __post_init__(self) -> None:
        if self.corrector:
            corrector(self.scheme, self.corrector)
        if self.coordinates not in COORDINATES:
            raise ValueError(
                f"coordinates={self.coordinates!r}: there are {' and '.join(map(repr, COORDINATES))}"
            )
        if self.commutator and self.scheme.order > 2:
            raise ValueError(f"{self.scheme.name} has no ε² τ² that a commutator could take away")
        if self.commutator and self.coordinates != "jacobi":
            raise ValueError(
                "commutator=True asks for kicks that are functions of q, but in democratic heliocentric coordinates "
                "H₁ holds the star's momentum: use Jacobi's"
            )

    def __repr__(self) -> str:
        return f"<SolvableSplitting: {self}>"

    def __str__(self) -> str:
        notes = [
            f", corrector {self.corrector}" if self.corrector else "",
            ", commutator" if self.commutator else "",
            f", {self.coordinates}" if self.coordinates != "jacobi" else "",
            ", own parts" if self.parts else "",
        ]
        return (self.scheme.name or "splitting") + "".join(notes)

    @property
    def kicks(self) -> Scheme:
        """The scheme with the weights of the commutator in its kicks."""
        return (
            with_commutator(self.scheme, corrected=bool(self.corrector)) if self.commutator else self.scheme
        )

    @property
    def order(self) -> int:
        """The order in the step size; what is linear in H₁ errs by a higher one."""
        return self.scheme.order

    @property
    def stages(self) -> int:
        """Kicks in a step."""
        return self.kicks.stages

    @property
    def citation(self) -> str:
        """Where the scheme was published, and what else it uses."""
        used = [
            self.scheme.citation,
            _CORRECTORS if self.corrector else "",
            LASKAR_ROBUTEL if self.commutator and self.scheme.citation != LASKAR_ROBUTEL else "",
            _DEMOCRATIC if self.coordinates != "jacobi" else "",
        ]
        return "; ".join(filter(None, used))


def WisdomHolman(
    *, corrector: int = 0, commutator: bool = False, coordinates: str = "jacobi", parts: Parts = None
) -> SolvableSplitting:
    """Return Wisdom and Holman's method: Kepler's motion of every planet, kicks by the planets' attractions.

    For planets about a star the coordinates are Jacobi's, the bodies in the order of the Hamiltonian's coordinates
    after the heaviest, which should be the order of their orbits. H₀ may also be Kepler's motion about fixed centres,
    or what is quadratic in (q, p).

    Parameters
    ----------
    corrector
        The order of a symplectic corrector, an odd number from 3 to 17; 0 for none. The energy's error
        is ε τ² without, ε τ^(corrector + 1) + ε² τ² with it.
    commutator
        Whether each kick holds the commutator {H₁, {H₀, H₁}} too: with a corrector ε² τ⁴ remains of ε² τ².
    coordinates
        ``"jacobi"``, or ``"democratic-heliocentric"``, where orbits may cross: each planet's place from the star
        (M. J. Duncan, H. F. Levison, M. H. Lee, Astron. J. 116 (1998) 2067–2077, doi:10.1086/300541).
    parts
        H₀ and H₁, in place of what is found from the structure of H. H₁ is to be a function of q alone.

    Raises
    ------
    ValueError
        There is no such corrector, or no such coordinates; or a commutator is asked of a kick that depends on p.

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
    return SolvableSplitting(wisdom_holman(), corrector, parts, commutator, coordinates)


def SABA(
    stages: int | str,
    *,
    corrector: int = 0,
    commutator: bool = False,
    coordinates: str = "jacobi",
    parts: Parts = None,
) -> SolvableSplitting:
    """Return Laskar and Robutel's method SABA_n, or one of Blanes and others that kills ε² τ² too.

    Parameters
    ----------
    stages
        n = 1 … 8 kicks in a step, errors ε τ^2n + ε² τ²; or ``"8-6-4"`` (7 kicks, ε τ⁸ + ε² τ⁶ + ε³ τ⁴),
        ``"10-6-4"`` (8 kicks, ε τ¹⁰ + ε² τ⁶ + ε³ τ⁴).
    commutator
        Whether steps end with a kick by the commutator {H₁, {H₀, H₁}}: SABAC_n, one evaluation more, errors
        ε τ^2n + ε² τ⁴.
    corrector, coordinates, parts
        As for :func:`WisdomHolman`.

    Raises
    ------
    ValueError
        There is no such method or corrector.

    Examples
    --------
    >>> str(SABA(4)), SABA("10-6-4").stages
    ('saba-4', 8)
    >>> str(SABA(3, commutator=True)), SABA(3, commutator=True).stages
    ('saba-3, commutator', 4)
    """
    if isinstance(stages, str):
        if stages not in ABA:
            raise ValueError(
                f"SABA({stages!r}): give a number of stages from 1 to 8, or one of {', '.join(ABA)}"
            )
        return SolvableSplitting(ABA[stages], corrector, parts, commutator, coordinates)
    return SolvableSplitting(saba(stages), corrector, parts, commutator, coordinates)


def SBAB(
    stages: int,
    *,
    corrector: int = 0,
    commutator: bool = False,
    coordinates: str = "jacobi",
    parts: Parts = None,
) -> SolvableSplitting:
    """Return Laskar and Robutel's method SBAB_n: n kicks in a step, the first and last half ones of two steps.

    Parameters
    ----------
    stages
        n = 1 … 8, errors ε τ^2n + ε² τ².
    commutator
        Whether the first and the last kick hold the commutator {H₁, {H₀, H₁}} too: SBABC_n, errors ε τ^2n + ε² τ⁴.
    corrector, coordinates, parts
        As for :func:`WisdomHolman`.

    Examples
    --------
    >>> SBAB(3).stages, SBAB(3, commutator=True).stages
    (3, 3)
    """
    return SolvableSplitting(sbab(stages), corrector, parts, commutator, coordinates)


def loop_of(system: HamiltonEquations, method: SolvableSplitting, precision: Precision) -> Loop:
    """Return the compiled loop of a splitting by solvable parts, kept from an earlier call if there was one.

    Raises
    ------
    UnsolvableError
        H has no solvable part, or not the one that was named.
    """
    if not system.autonomous:
        raise UnsolvableError(
            "H depends on t: splittings by solvable parts are for H(q, p); use Splitting('kahan-li-8')"
        )
    if system.varying:
        raise UnsolvableError(
            "parameters that differ by orbit: splittings by solvable parts take one number for each"
        )
    return _kept(system, method, precision)


@functools.lru_cache(maxsize=64)
def _kept(system: HamiltonEquations, method: SolvableSplitting, precision: Precision) -> Loop:
    part = solvable_part(system) if method.parts is None else named_part(system, *method.parts)
    if isinstance(part, Planets | Centres) and len({len(body) for body in part.bodies}) > 1:
        raise UnsolvableError(
            "the bodies have different numbers of coordinates; give each as many, or name two parts"
        )
    chosen = corrector(method.scheme, method.corrector) if method.corrector else None
    democratic = method.coordinates == "democratic-heliocentric"
    if democratic and not isinstance(part, Planets):
        raise UnsolvableError(
            "democratic heliocentric coordinates are for planets about a star, which H is not"
        )
    return solvable_loop(
        part,
        len(system.q),
        method.kicks,
        chosen,
        compensated=precision.compensated,
        number=precision.number,
        democratic=democratic,
    )
