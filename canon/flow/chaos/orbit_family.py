"""Families of periodic orbits, followed by pseudo-arclength, with the places where their stability changes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.expression.symbols.user_input import counted
from canon.flow.chaos.floquet import near_double
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.progress import reporting

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    from canon.array import Array
    from canon.flow.chaos.periodic_search import PeriodicOrbit, PeriodicSearch

__all__ = ["Bifurcation", "OrbitFamily", "continue_family"]

_LONGER, _SHORTER, _LEAST = 1.5, 0.5, 1e-6
"""Steps grow after orbits that were found at once, and shrink where none was found, down to a part of the first."""

_REFINEMENTS = 6

_AHEAD = 0.8
"""Cosine of the angle to the tangent from which on what is found is no more of the family, or the step too long."""


@dataclass(frozen=True)
class Bifurcation:
    """A place in a family where a stability index λ + 1/λ passes ±2, or two leave the real axis together.

    Parameters
    ----------
    kind
        ``"+1"``: a fold in energy or a branch of the same period; ``"-1"``: a branch of twice the period;
        ``"collision"``: two pairs that meet on the unit circle and leave it, or come back.
    orbit
        The orbit nearest to it.
    """

    kind: str
    orbit: PeriodicOrbit


@dataclass(frozen=True)
class OrbitFamily:
    """Periodic orbits of a family in order, and where their stability changes.

    Parameters
    ----------
    orbits
        The orbits, from the first one on.
    bifurcations
        Where a multiplier passes ±1 or pairs collide, in order.
    ended
        Why the family was followed no further.
    """

    orbits: tuple[PeriodicOrbit, ...]
    bifurcations: tuple[Bifurcation, ...]
    ended: str

    def __repr__(self) -> str:
        first, last = self.orbits[0], self.orbits[-1]
        return (
            f"<OrbitFamily: {counted(len(self.orbits), 'orbit')}, periods {first.period:.6g} … {last.period:.6g}, "
            f"energies {first.energy:.6g} … {last.energy:.6g}, {counted(len(self.bifurcations), 'bifurcation')}>"
        )

    @property
    def energies(self) -> Array:
        """H of each orbit, shape (orbits,)."""
        return np.array([orbit.energy for orbit in self.orbits])

    @property
    def periods(self) -> Array:
        """The period of each orbit, shape (orbits,)."""
        return np.array([orbit.period for orbit in self.orbits])


def continue_family(
    orbit: PeriodicOrbit,
    count: int,
    step: float,
    *,
    to_energy: float | None = None,
    progress: Callable[[float], None] | bool | None = None,
) -> OrbitFamily:
    """Follow a family of periodic orbits of a Hamiltonian from one of them.

    The next orbit is looked for along the tangent of the family in (y, T), and made to close at right angles to it, so
    that folds in energy and period are passed. Lengths and angles are those of pure numbers: each variable is measured
    by the scale of the last orbit, and the period by itself.

    Parameters
    ----------
    orbit
        The first orbit; its start, symmetry and method go on to be used.
    count
        How many orbits at most, the first one included.
    step
        The first distance from one to the next, in parts of the orbit's swing and its period, such as 0.1; of either
        sign, for the two directions: positive where the energy grows at first. It is made longer and shorter on the
        way, at most ten times as long.
    to_energy
        End with the first orbit beyond this energy.
    progress
        As :func:`canon.propagate` takes it.

    Raises
    ------
    ValueError
        The step is zero, or the system depends on time.

    Examples
    --------
    Oscillations of a pendulum: the period grows with the energy.

    >>> import sympy
    >>> from canon import Hamiltonian, coordinates
    >>> from canon.flow import continue_family, periodic_orbit
    >>> x = coordinates("x")
    >>> pendulum = Hamiltonian(x.momentum**2 / 2 - sympy.cos(x), [x], [x.momentum])
    >>> family = continue_family(periodic_orbit(pendulum, [0.5, 0.0], 6.4, reversal=["p_x"]), 5, 0.2)
    >>> bool((family.energies[1:] > family.energies[:-1]).all() and (family.periods[1:] > family.periods[:-1]).all())
    True
    """
    search = orbit.search
    if not step:
        raise ValueError("step=0: give the distance from one orbit to the next, of either sign")
    if search.fixed_period:
        raise ValueError("orbits of a fixed period make no family in energy: leave fixed_period out")
    orbits, bifurcations, ended = [orbit], list[Bifurcation](), "all that was asked for is done"
    tangent, length = _tangent(orbit, None) * np.sign(step), abs(step)
    with reporting(progress) as report:
        while len(orbits) < count:
            following = _next(search, orbits[-1], tangent, length)
            if following is None:
                length *= _SHORTER
                if length < _LEAST * abs(step):
                    ended = (
                        "no orbit is found beyond: the family ends there, or comes too near to a singularity"
                    )
                    break
                continue
            bifurcations += _bifurcations(search, orbits[-1], following, tangent, length)
            tangent = _tangent(following, tangent / orbits[-1].scale.both)
            orbits.append(following)
            length = min(length * _LONGER, 10 * abs(step))
            report(len(orbits) / count)
            if to_energy is not None and _beyond(to_energy, orbit.energy, following.energy):
                ended = f"the energy {to_energy:g} is reached"
                break
    return OrbitFamily(tuple(orbits), tuple(bifurcations), ended)


def _beyond(goal: float, first: float, now: float) -> bool:
    return now >= goal if goal >= first else now <= goal


def _next(
    search: PeriodicSearch, orbit: PeriodicOrbit, tangent: Array, length: float
) -> PeriodicOrbit | None:
    """Return the orbit at a distance along the tangent, or None where there is none near."""
    sizes = orbit.scale.both
    ahead = np.append(orbit.y, orbit.period) + length * tangent * sizes
    if ahead[-1] <= 0:
        return None
    try:
        found = search.found(ahead[:-1], float(ahead[-1]), None, across=tangent / sizes)
    except (NonFiniteStateError, ValueError):  # beyond H's domain too, where no motion starts
        return None
    gone = np.append(found.y - orbit.y, found.period - orbit.period) / sizes
    distance = float(np.linalg.norm(gone))
    return found if distance < 2 * length and gone @ tangent > _AHEAD * distance else None


def _tangent(orbit: PeriodicOrbit, before: Array | None) -> Array:
    """Return the direction of the family in (y, T), of length 1 in its scale: as a form before, or as energy grows."""
    search, sizes = orbit.search, orbit.scale.both
    found = search.kernel(orbit.y, orbit.period, orbit.scale, before)
    way = found * sizes
    sign = way[:-1] @ search.slope(orbit.y) if before is None else way @ before
    return found if sign >= 0 else -found


def _bifurcations(
    search: PeriodicSearch, first: PeriodicOrbit, second: PeriodicOrbit, tangent: Array, length: float
) -> list[Bifurcation]:
    """Return where between two orbits the kind of a pair of multipliers changes, by halving the distance."""
    found: list[Bifurcation] = []
    for kind in _VALUES:
        if not _passed(kind, first, second):
            continue
        low, high, nearest = 0.0, length, second
        for _ in range(_REFINEMENTS):
            between = _next(search, first, tangent, (low + high) / 2)
            if between is None:
                break
            nearest = between
            if _passed(kind, first, between):
                high = (low + high) / 2
            else:
                low = (low + high) / 2
        found.append(Bifurcation(kind, nearest))
    return found


def _passed(kind: str, first: PeriodicOrbit, second: PeriodicOrbit) -> bool:
    """Tell whether a pair passes a bifurcation between two orbits.

    One that is there at both ends, as that of a symmetry, passes none: its sign is rounding.
    """
    ends = [_VALUES[kind](orbit.multipliers.indices) for orbit in (first, second)]
    power = 2 if kind == "collision" else 1
    near = [(2 * near_double(orbit.multipliers.accuracy)) ** power for orbit in (first, second)]
    staying = min(int((abs(values) <= off).sum()) for values, off in zip(ends, near, strict=True))
    left = [values[np.argsort(abs(values))][staying:] for values in ends]
    if kind == "collision":
        a, b = (min(values.real, default=1.0) for values in left)
    else:
        a, b = (np.prod(values).real for values in left)
    return bool(a * b < 0)


def _squares(indices: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """Return discriminants of two indices each: negative where they are complex conjugates."""
    return np.array(
        [(a - b) ** 2 for k, a in enumerate(indices) for b in indices[k + 1 :]], dtype=np.complex128
    )


_VALUES: dict[str, Callable[[npt.NDArray[np.complex128]], npt.NDArray[np.complex128]]] = {
    "+1": lambda indices: indices - 2,
    "-1": lambda indices: indices + 2,
    "collision": _squares,
}
"""What changes its sign, by what the stability indices are."""
