"""Splittings by exactly solvable parts as methods: Wisdom–Holman, SABA, SBAB and their variants."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from canon.flow.method.engine import FIXED_STEPS
from canon.kernel.schemes.perturbed_schemes import (
    ABA,
    LASKAR_ROBUTEL,
    corrector,
    saba,
    sbab,
    wisdom_holman,
    with_commutator,
)

if TYPE_CHECKING:
    from sympy import Expr

    from canon.kernel.schemes.splitting_schemes import Scheme

__all__ = ["COORDINATES", "SABA", "SBAB", "SolvableSplitting", "WisdomHolman"]

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

    :class:`WisdomHolman`, :class:`SABA` and :class:`SBAB` are those with a published scheme; what ``Splitting(…,
    parts=(H0, H1))`` says is one too.

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
    engine, family, is_symplectic, tolerance = FIXED_STEPS, "solvable", True, None

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

    def _call(self, *stages: str) -> str:
        """Return the call that makes this method."""
        given = [f"{name}={value!r}" for name, value in self._choices.items()]
        return f"{type(self).__name__}({', '.join([*stages, *given])})"

    @property
    def _choices(self) -> dict[str, Any]:
        """What differs from the ordinary choices."""
        usual = {"corrector": 0, "commutator": False, "coordinates": "jacobi", "parts": None}
        return {name: chosen for name, each in usual.items() if (chosen := getattr(self, name)) != each}

    def __str__(self) -> str:
        notes = [
            f", corrector {self.corrector}" if self.corrector else "",
            ", commutator" if self.commutator else "",
            f", {self.coordinates}" if self.coordinates != "jacobi" else "",
            ", own parts" if self.parts else "",
        ]
        return (self.scheme.name or "splitting") + "".join(notes)

    @property
    def solvable(self) -> SolvableSplitting:
        """The splitting itself, as other methods have None."""
        return self

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it.

        Raises
        ------
        ValueError
            It has parts or a scheme of its own, which are no text.
        """
        if self.parts is not None or not self.scheme.name:
            raise ValueError(f"{self}: a study takes parts that are found from the structure of H")
        return {"solvable": self.scheme.name, "corrector": self.corrector, **self._choices}

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


@dataclass(frozen=True, init=False, repr=False)
class WisdomHolman(SolvableSplitting):
    """Wisdom and Holman's method: Kepler's motion of every planet, kicks by the planets' attractions.

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
    >>> from canon.flow.propagation import propagate
    >>> from canon.scene import find
    >>> planets = find("outer-solar-system")
    >>> start = planets.start("1994")
    >>> motion = propagate(
    ...     planets.hamiltonian, (0, 100_000), [*start.q, *start.p], method=WisdomHolman(corrector=7), step=200.0,
    ...     parameters=planets.values,
    ... )
    >>> bool(abs(motion.energy_error).max() < 3e-8)
    True
    """

    def __init__(
        self,
        *,
        corrector: int = 0,
        commutator: bool = False,
        coordinates: str = "jacobi",
        parts: Parts = None,
    ) -> None:
        super().__init__(wisdom_holman(), corrector, parts, commutator, coordinates)

    def __repr__(self) -> str:
        return self._call()


@dataclass(frozen=True, init=False, repr=False)
class SABA(SolvableSplitting):
    """Laskar and Robutel's splitting SABA_n of H = H₀ + ε H₁, or a method by Blanes and others without the error ε² τ².

    Parameters
    ----------
    stages
        n = 1 … 8 kicks in a step, errors ε τ^2n + ε² τ²; or ``"8-6-4"`` (7 kicks, ε τ⁸ + ε² τ⁶ + ε³ τ⁴),
        ``"10-6-4"`` (8 kicks, ε τ¹⁰ + ε² τ⁶ + ε³ τ⁴).
    commutator
        Whether steps end with a kick by the commutator {H₁, {H₀, H₁}}: SABAC_n, one evaluation more, errors
        ε τ^2n + ε² τ⁴.
    corrector, coordinates, parts
        As for :class:`WisdomHolman`.

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

    def __init__(
        self,
        stages: int | str,
        *,
        corrector: int = 0,
        commutator: bool = False,
        coordinates: str = "jacobi",
        parts: Parts = None,
    ) -> None:
        if isinstance(stages, str) and stages not in ABA:
            raise ValueError(
                f"SABA({stages!r}): give a number of stages from 1 to 8, or one of {', '.join(ABA)}"
            )
        scheme = ABA[stages] if isinstance(stages, str) else saba(stages)
        super().__init__(scheme, corrector, parts, commutator, coordinates)

    def __repr__(self) -> str:
        stages = self.scheme.name.partition("-")[2]
        return self._call(stages if stages.isdecimal() else repr(stages))


@dataclass(frozen=True, init=False, repr=False)
class SBAB(SolvableSplitting):
    """Laskar and Robutel's splitting SBAB_n of H = H₀ + ε H₁, whose steps begin and end with a kick by H₁.

    Parameters
    ----------
    stages
        n = 1 … 8, errors ε τ^2n + ε² τ².
    commutator
        Whether the first and the last kick hold the commutator {H₁, {H₀, H₁}} too: SBABC_n, errors ε τ^2n + ε² τ⁴.
    corrector, coordinates, parts
        As for :class:`WisdomHolman`.

    Examples
    --------
    >>> SBAB(3).stages, SBAB(3, commutator=True).stages
    (3, 3)
    """

    def __init__(
        self,
        stages: int,
        *,
        corrector: int = 0,
        commutator: bool = False,
        coordinates: str = "jacobi",
        parts: Parts = None,
    ) -> None:
        super().__init__(sbab(stages), corrector, parts, commutator, coordinates)

    def __repr__(self) -> str:
        return self._call(self.scheme.name.partition("-")[2])
