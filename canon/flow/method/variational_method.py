"""Galerkin variational integrators as a method: a discrete action of a Lagrangian made stationary, with forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from canon.flow.method.engine import FIXED_STEPS
from canon.kernel.schemes.galerkin_tableau import QUADRATURES
from canon.kernel.schemes.gauss_tableau import HIGHEST_STAGES

__all__ = ["GalerkinVariational"]

_MOST_POINTS = HIGHEST_STAGES + 1


@dataclass(frozen=True, repr=False)
class GalerkinVariational:
    """A Galerkin variational integrator for a Lagrangian and its forces: symplectic without forces, keeps momenta.

    Parameters
    ----------
    degree
        s = 1 … 8, the degree of the polynomials in time that the motion is over a step.
    points
        Points of the quadrature of the action, r = s … 9; s of Gauss's, s + 1 of Lobatto's where not given.
    quadrature
        ``"gauss"``, of order 2r, or ``"lobatto"``, of order 2r − 2, for which r is at least 2.

    Raises
    ------
    ValueError
        No such degree, number of points, or quadrature. Where it runs: the system is no Lagrangian without
        constraints, or not regular.

    Notes
    -----
    For a :class:`canon.Lagrangian` L(q, q̇, t) whose ∂L/∂q̇ determine q̇, with any forces Q(q, q̇, t), in the discrete form
    of Lagrange and d'Alembert's principle. The order is that of the quadrature, 2s at most. Steps are symmetric, and
    symplectic without forces. Momenta of symmetries that are linear in q, as momentum and angular momentum, are kept to
    round-off, and change by what forces do to them only (Noether's theorem of the discrete action). With s points of
    Gauss's it is the Gauss method on (q, p); with degree 1 and 2 points of Lobatto's, Störmer's and Verlet's; with
    s + 1 of Lobatto's the pair Lobatto IIIA–IIIB; more points make others. Newton's method solves s n equations with a
    full matrix in every step, whose time grows as (s n)³ for many degrees of freedom n.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, propagate
    >>> from sympy import cos
    >>> theta = coordinates("theta")
    >>> damped = Lagrangian(theta.dot**2 / 2 + cos(theta), [theta], forces=[-theta.dot / 50])
    >>> motion = propagate(damped, (0, 100), [2, 0], method=GalerkinVariational(3, quadrature="lobatto"), step=0.25)
    >>> motion.method.order, bool(abs(motion.energy_error).max() < 1e-5)
    (6, True)
    """

    degree: int = 2
    points: int | None = None
    quadrature: str = QUADRATURES[0]
    engine, family, is_symplectic, solvable = FIXED_STEPS, "galerkin", True, None
    tolerance = None
    citation = (
        "J. E. Marsden, M. West, Discrete mechanics and variational integrators, Acta Numerica 10 (2001) 357–514, "
        "doi:10.1017/S096249290100006X; S. Ober-Blöbaum, N. Saake, Construction and analysis of higher order Galerkin "
        "variational integrators, Adv. Comput. Math. 41 (2015) 955–986, doi:10.1007/s10444-014-9394-8"
    )

    def __post_init__(self) -> None:
        degree: Any = self.degree
        if not isinstance(degree, int) or degree is True or degree not in range(1, HIGHEST_STAGES + 1):
            raise ValueError(f"GalerkinVariational({degree!r}): the degree is 1 … {HIGHEST_STAGES}")
        if self.quadrature not in QUADRATURES:
            raise ValueError(
                f"quadrature={self.quadrature!r}: there are {' and '.join(map(repr, QUADRATURES))}"
            )
        least = max(degree, 1 if self.quadrature == QUADRATURES[0] else 2)
        if self.points is not None and self.points not in range(least, _MOST_POINTS + 1):
            raise ValueError(
                f"GalerkinVariational({degree}, points={self.points!r}, quadrature={self.quadrature!r}): the points of "
                f"the quadrature are {least} … {_MOST_POINTS}"
            )

    @property
    def _choices(self) -> dict[str, Any]:
        """What is not as usual."""
        points = {} if self.points is None else {"points": self.points}
        return points if self.quadrature == QUADRATURES[0] else {**points, "quadrature": self.quadrature}

    def __repr__(self) -> str:
        more = "".join(f", {name}={value!r}" for name, value in self._choices.items())
        return f"GalerkinVariational({self.degree}{more})"

    def __str__(self) -> str:
        points = "" if self.points is None else f", points {self.points}"
        return f"galerkin-{self.degree}{points}{'' if self.quadrature == QUADRATURES[0] else f', {self.quadrature}'}"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"galerkin": self.degree, **self._choices}

    @property
    def nodes(self) -> int:
        """Points of the quadrature."""
        return self.points or self.degree + (self.quadrature != QUADRATURES[0])

    @property
    def stages(self) -> int:
        """Evaluations of momenta and forces in an iteration: the points."""
        return self.nodes

    @property
    def order(self) -> int:
        """The quadrature's, 2s at most."""
        return min(2 * self.degree, 2 * self.nodes - (0 if self.quadrature == QUADRATURES[0] else 2))
