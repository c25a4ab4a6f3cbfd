"""The flow as a polynomial in deviations from a start: its derivatives of any order, by heyoka's equations for them."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.symbols.user_input import counted
from canon.flow.geometry.vector_field_motion import VectorFieldSystem, sampled
from canon.flow.kinked.regimes import kinks_of
from canon.flow.method.adaptive_methods import Taylor
from canon.flow.request import Request
from canon.flow.system.hamiltonian_map import HamiltonianMap
from canon.flow.system_request import any_task, refuse_contacts
from canon.kernel.heyoka_bridge import heyoka_equations

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Symbol

    from canon.array import Array
    from canon.flow.system.recognised_system import MovableSystem

__all__ = ["FlowSeries", "flow_series"]

MOST_EQUATIONS = 4000
"""Equations for the derivatives that are integrated at most: they are compiled anew for every system and order."""


@dataclass(frozen=True, eq=False)
class FlowSeries:
    """The state at the end of a motion as a polynomial in the deviations δ of its start.

    y_i(δ) = Σ_k ``coefficients[i, k]`` · Π_j δ_j ** ``powers[k, j]`` + O(δ^(order + 1)): a Taylor map, or state
    transition tensors.

    Parameters
    ----------
    order
        The highest power of the deviations.
    powers
        Exponents of the deviations, shape (terms, 2n), by their sum; the first row is 0.
    coefficients
        Of the state at the end, shape (2n, terms): derivatives by the start over their factorials.

    Examples
    --------
    >>> from canon import Hamiltonian, coordinates
    >>> x = coordinates("x")
    >>> free = Hamiltonian(x.momentum**4 / 4, [x], [x.momentum])
    >>> end = flow_series(free, (0, 2), [0.0, 1.0], order=3)  # x + 2 p³
    >>> end([0.5, 0.1]).round(12)
    array([3.162, 1.1  ])
    """

    order: int
    powers: npt.NDArray[np.int64]
    coefficients: Array

    def __repr__(self) -> str:
        size, terms = self.coefficients.shape
        return f"<FlowSeries: {counted(size, 'variable')}, order {self.order}, {counted(terms, 'term')} each>"

    @property
    def y(self) -> Array:
        """The end of the motion without deviations, shape (2n,)."""
        return self.coefficients[:, 0]

    @property
    def M(self) -> Array:
        """The Jacobian ∂y/∂y0, shape (2n, 2n)."""
        size = len(self.coefficients)
        return self.coefficients[:, 1 : 1 + size]

    def __call__(self, deviations: npt.ArrayLike) -> Array:
        """Return the states at the end, shape of the deviations: (2n,) of one start, (2n, orbits) of several.

        Raises
        ------
        ValueError
            The deviations have another length, or are not finite.
        """
        given, size = np.asarray(deviations, dtype=np.float64), len(self.coefficients)
        if given.ndim not in (1, 2) or len(given) != size:
            raise ValueError(
                f"deviations of shape {given.shape}: give ({size},) of one start or ({size}, orbits) of several"
            )
        if not np.isfinite(given).all():
            raise ValueError(f"the deviations {given} are not finite")
        rising = given[np.newaxis] ** np.arange(self.order + 1).reshape(-1, *(1,) * given.ndim)
        terms = np.prod([rising[self.powers[:, j], j] for j in range(size)], axis=0)
        return self.coefficients @ terms

    def derivative(self, component: int, *by: int) -> float:
        """Return a partial derivative of a component of the end by components of the start, (q, p) from 0.

        ``derivative(0, 1, 1)`` is ∂²y_0/∂y0_1².

        Raises
        ------
        ValueError
            It is of a higher order than the series, or there is no such component.
        """
        size = len(self.coefficients)
        if len(by) > self.order or not all(0 <= each < size for each in (component, *by)):
            raise ValueError(
                f"derivative{(component, *by)}: there are orders up to {self.order} of components 0 … {size - 1}"
            )
        counts = Counter(by)
        wanted = [counts[j] for j in range(size)]
        (term,) = np.flatnonzero((self.powers == wanted).all(axis=1))
        return float(self.coefficients[component, term]) * math.prod(map(math.factorial, wanted))

    def reach(self, tolerance: float) -> float:
        """Return the deviation of any start's components up to which the terms of the highest order stay within it.

        An estimate of where the series may be used, since what is left out is smaller than they are where it
        converges quickly; ``inf`` where there are no such terms.

        Parameters
        ----------
        tolerance
            An error of a component of the end, in its units.

        Raises
        ------
        ValueError
            It is not positive.
        """
        if not tolerance > 0:
            raise ValueError(f"tolerance={tolerance}: give a positive error")
        last = self.powers.sum(axis=1) == self.order
        size = float(abs(self.coefficients[:, last]).sum(axis=1).max())
        return (tolerance / size) ** (1 / self.order) if size else math.inf

    @property
    def symplecticity_defect(self) -> float:
        """The largest coefficient of D(δ)ᵀ J D(δ) − J, D = ∂y/∂δ, over the size of the terms it is the sum of.

        Of all powers of δ below ``order``. The derivatives of a symplectic flow fulfil them up to round-off.
        """
        size = len(self.coefficients)
        n = size // 2
        if size % 2:
            raise ValueError(f"{counted(size, 'variable')} are no coordinates and momenta (q, p)")
        slopes = [[self._slope(i, j) for j in range(size)] for i in range(size)]
        found = 0.0
        for a in range(size):
            for b in range(a):
                sums, sizes = defaultdict[bytes, float](float), defaultdict[bytes, float](float)
                for i in range(n):
                    self._add_product(slopes[i][a], slopes[i + n][b], 1.0, sums, sizes)
                    self._add_product(slopes[i + n][a], slopes[i][b], -1.0, sums, sizes)
                if a - b == n:
                    zero = bytes(self.powers[0])
                    sums[zero] += 1.0
                found = max([found, *(abs(sums[k]) / each for k, each in sizes.items() if each)])
        return found

    def _slope(self, i: int, j: int) -> list[tuple[npt.NDArray[np.int64], float]]:
        """Return the terms of ∂y_i/∂δ_j: exponents and numbers."""
        lowered = self.powers - np.eye(len(self.coefficients), dtype=np.int64)[j]
        numbers = self.coefficients[i] * self.powers[:, j]
        return [(lowered[k], float(numbers[k])) for k in np.flatnonzero(numbers)]

    def _add_product(
        self,
        first: list[tuple[npt.NDArray[np.int64], float]],
        second: list[tuple[npt.NDArray[np.int64], float]],
        sign: float,
        sums: defaultdict[bytes, float],
        sizes: defaultdict[bytes, float],
    ) -> None:
        """Add a product of polynomials, without its terms that the series does not know, by their exponents."""
        for e, x in first:
            for f, y in second:
                power = e + f
                if power.sum() < self.order:
                    key = bytes(power)
                    sums[key] += sign * x * y
                    sizes[key] += abs(x * y)


def flow_series(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
    *,
    order: int,
    parameters: Mapping[Symbol | str, Any] | None = None,
) -> FlowSeries:
    """Return the end of a motion as a polynomial in the deviations of its start, by Taylor's method.

    heyoka makes the equations of the derivatives, of all orders up to the given one, and carries them along with the
    motion. One integration then stands for those of a whole neighbourhood of starts: a cloud of uncertain ones, a beam,
    or the next steps of a search. M. Berz, Modern Map Methods in Particle Beam Physics, Academic Press 1999, ch. 5;
    R. S. Park, D. J. Scheeres, J. Guid. Control Dyn. 29 (2006) 1367, doi:10.2514/1.20177.

    Parameters
    ----------
    system, t_span, parameters
        As :func:`canon.propagate` takes them.
    y0
        One starting state, (q, p) of a Hamiltonian, shape (2n,). Of other systems the series is in their own variables.
    order
        The highest power of the deviations, from 1 on.

    Raises
    ------
    ValueError
        As ``propagate``; or there is no order; or there are too many derivatives; or the system is a map, has contacts
        or kinks, at which there are no higher derivatives; or several starts are given.
    NonFiniteStateError
        The motion, or its derivatives, can't be continued over the whole span.

    Examples
    --------
    A thousand starts around one of a pendulum, without integrating them:

    >>> from canon import Hamiltonian, coordinates
    >>> import numpy as np, sympy
    >>> x = coordinates("x")
    >>> pendulum = Hamiltonian(x.momentum**2 / 2 - sympy.cos(x), [x], [x.momentum])
    >>> end = flow_series(pendulum, (0, 10), [1.0, 0.0], order=5)
    >>> end
    <FlowSeries: 2 variables, order 5, 21 terms each>
    >>> cloud = 0.01 * np.random.default_rng(1).standard_normal((2, 1000))
    >>> end(cloud).shape, bool(end.symplecticity_defect < 1e-12)
    ((2, 1000), True)
    """
    import heyoka as hy

    if isinstance(system, HamiltonianMap):
        raise ValueError(
            "a map is no flow: its derivatives are those of its own functions; give a system in time"
        )
    if type(order) is not int or order < 1:
        raise ValueError(f"order={order!r}: give the highest power of the deviations, 1, 2, 3, …")
    request = Request(system, t_span, y0, method=Taylor(), parameters=parameters, samples=1)
    task, moving = any_task(request)
    refuse_contacts(moving, "the series of a flow")
    if not task.single:
        raise ValueError("the series is made of one orbit: give one state and one set of parameters")
    if kinks_of(task.system) is not None:
        raise ValueError(
            "the equations have kinks, at which a flow has no higher derivatives: flow_jacobian(…) has the first ones"
        )
    made = task.system
    field = VectorFieldSystem(made.graph, (*made.q, *made.p), made.t, {}, made.rates)
    pairs = heyoka_equations(made)
    rows = np.arange(len(field.x))[slice(None) if moving is None else made.rows]
    powers = np.array(list(_exponents(len(rows), order)))
    equations = len(field.x) * len(powers)
    if equations > MOST_EQUATIONS:
        raise ValueError(
            f"order={order} of {counted(len(rows), 'variable')} takes {equations} equations, more than the "
            f"{MOST_EQUATIONS} that can be compiled in reasonable time: give a lower order"
        )
    by = [pairs[k][0] for k in rows.tolist()]
    times = np.array([float(task.plan.instants[0]), float(task.plan.instants[-1])])
    found = sampled(
        field, hy.var_ode_sys(pairs, by, order=order), times, task.states[0][:, 0], variations=equations
    )
    return FlowSeries(order, powers, _by_term(found.rows[-1], powers, len(field.x))[rows])


def _exponents(size: int, order: int) -> Iterator[list[int]]:
    """Yield the exponents of the deviations in heyoka's order: by their sum, those of the first variables first."""
    for degree in range(order + 1):
        for chosen in combinations_with_replacement(range(size), degree):
            yield [chosen.count(j) for j in range(size)]


def _by_term(state: Array, powers: npt.NDArray[np.int64], size: int) -> Array:
    """Return Taylor coefficients, shape (size, terms), of the state and its derivatives as heyoka has them.

    It has the derivatives of each order after another, in each of them one component after another.
    """
    blocks, at = [state[:0].reshape(size, 0)], 0
    for degree in range(int(powers[-1].sum()) + 1):
        terms = int((powers.sum(axis=1) == degree).sum())
        blocks.append(state[at : at + size * terms].reshape(size, terms))
        at += size * terms
    factorials = [math.prod(map(math.factorial, row)) for row in powers.tolist()]
    return np.concatenate(blocks, axis=1) / np.array(factorials, dtype=np.float64)
