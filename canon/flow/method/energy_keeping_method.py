"""Average vector field methods: the energy kept to round-off whatever the step, the comparison to symplectic ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from canon.flow.method.engine import FIXED_STEPS
from canon.flow.method.stage_iteration import ITERATIONS, check_iteration
from canon.kernel.program.polynomial_degree import polynomial_degree
from canon.kernel.schemes.average_vector_field import MOST_POINTS
from canon.kernel.schemes.gauss_tableau import HIGHEST_STAGES

if TYPE_CHECKING:
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["AverageVectorField"]

_ORDERS = tuple(range(2, 2 * HIGHEST_STAGES + 1, 2))


@dataclass(frozen=True, repr=False)
class AverageVectorField:
    """The average vector field method and its kin of higher order: keeps H to round-off, symmetric; not symplectic.

    Parameters
    ----------
    order
        2, 4 … 16: the average vector field method of Quispel and McLaren, and Hairer's energy-preserving collocation.
    points
        Nodes of Gauss's quadrature for the average of the vector field over a step, order/2 … 16. Where not given:
        as many as make it exact where H is a polynomial; else 8, and 16 for orders above 8.
    iteration
        How the implicit equations are solved, ``"fixed-point"`` or ``"newton"``, as in :class:`canon.Gauss`; the second
        rounds less where the first takes dozens of repetitions.

    Raises
    ------
    ValueError
        No such order, number of points, or iteration. Where it runs: the quadrature of a polynomial of so high a degree
        takes more than 16 points.

    Notes
    -----
    For Hamilton's equations of every H. In s = order/2 and k points: H is kept to round-off where it is a polynomial in
    (q, p) of degree up to 2k/s; elsewhere up to the error of the quadrature, of order h^2k. Of H(q, p, t) it is the
    energy less the work ∫ ∂H/∂t dt that is kept. A small error of energy says nothing of the orbit then, whose error is
    like that of Gauss methods of the order, at a higher cost: :func:`canon.choose` considers it where it is named. It
    keeps neither phase volume nor quadratic integrals such as angular momentum, which Gauss
    methods do. On quadratic H and with k = s it is ``Gauss(s)``.

    Examples
    --------
    >>> from canon import Gauss, Hamiltonian, coordinates, flow_jacobian, propagate
    >>> x, y = coordinates("x y")
    >>> henon_heiles = (x.momentum**2 + y.momentum**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3
    >>> H = Hamiltonian(henon_heiles, [x, y], [x.momentum, y.momentum])
    >>> how = {"t_span": (0, 1000), "y0": [0, 0.1, 0.4, 0], "step": 0.5}
    >>> kept, swings = (propagate(H, method=method, **how) for method in (AverageVectorField(4), Gauss(2)))
    >>> bool(abs(kept.energy_error).max() < 1e-14), bool(abs(swings.energy_error).max() > 1e-5), kept.method
    (True, True, AverageVectorField(4, points=3))
    >>> step = flow_jacobian(H, (0, 0.5), [0, 0.1, 0.4, 0], method=AverageVectorField(4), step=0.5)
    >>> bool(step.symplecticity_defect[-1] > 1e-6)
    True
    """

    order: int = 2
    points: int | None = None
    iteration: str = ITERATIONS[0]
    engine, family, is_symplectic, solvable = FIXED_STEPS, "average_vector_field", False, None
    tolerance = None

    def __post_init__(self) -> None:
        order: Any = self.order
        if not isinstance(order, int) or order not in _ORDERS:
            raise ValueError(f"AverageVectorField({order!r}): the order is 2, 4, … or {_ORDERS[-1]}")
        if self.points is not None and self.points not in range(self.degree, MOST_POINTS + 1):
            raise ValueError(
                f"AverageVectorField({self.order}, points={self.points!r}): the points of the quadrature are "
                f"{self.degree} … {MOST_POINTS}"
            )
        check_iteration(self.iteration)

    @property
    def _choices(self) -> dict[str, Any]:
        """What is not as usual."""
        points = {} if self.points is None else {"points": self.points}
        return points if self.iteration == ITERATIONS[0] else {**points, "iteration": self.iteration}

    def __repr__(self) -> str:
        more = "".join(f", {name}={value!r}" for name, value in self._choices.items())
        return f"AverageVectorField({self.order}{more})"

    def __str__(self) -> str:
        points = "" if self.points is None else f", points {self.points}"
        return f"avf-{self.order}{points}{'' if self.iteration == ITERATIONS[0] else f', {self.iteration}'}"

    @property
    def written(self) -> dict[str, Any]:
        """The method as JSON and TOML can hold it."""
        return {"average_vector_field": self.order, **self._choices}

    @property
    def degree(self) -> int:
        """s = order/2, the degree of the polynomial that the motion is over a step."""
        return self.order // 2

    @property
    def stages(self) -> int:
        """Evaluations of the vector field in an iteration: the points, or those for an H that is no polynomial."""
        if self.points is not None:
            return self.points
        return MOST_POINTS // 2 if self.order <= MOST_POINTS // 2 else MOST_POINTS

    @property
    def citation(self) -> str:
        """Where the method was published."""
        if self.order == _ORDERS[0]:
            return (
                "G. R. W. Quispel, D. I. McLaren, A new class of energy-preserving numerical integration methods, "
                "J. Phys. A 41 (2008) 045206, doi:10.1088/1751-8113/41/4/045206"
            )
        return (
            "E. Hairer, Energy-preserving variant of collocation methods, J. Numer. Anal. Ind. Appl. Math. 5 (2010) "
            "73–84"
        )

    def on(self, system: HamiltonEquations) -> AverageVectorField:
        """Return the method with its number of points, where none was given that for the Hamiltonian of a system.

        Raises
        ------
        ValueError
            It takes more than there can be.
        """
        if self.points is not None:
            return self
        moving = len(system.q) - system.varying
        variables = (*system.q[:moving], *system.p[:moving], system.t)
        power = polynomial_degree(system.graph, system.hamiltonian, variables)
        if power is None:
            return replace(self, points=self.stages)
        points = max(self.degree, -(-power * self.degree // 2))
        if points > MOST_POINTS:
            highest = max((order for order in _ORDERS if power * order <= 4 * MOST_POINTS), default=0)
            lower = f"AverageVectorField({highest}), or " if highest else ""
            raise ValueError(
                f"{self}: H is a polynomial of degree {power}, for which it takes {points} points of quadrature to "
                f"keep the energy exactly, and there are at most {MOST_POINTS}; take {lower}"
                f"AverageVectorField({self.order}, points={MOST_POINTS}), which keeps it up to that quadrature's error"
            )
        return replace(self, points=points)
