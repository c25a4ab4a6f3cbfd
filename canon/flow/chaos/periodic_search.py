"""Search for periodic orbits: Newton's method on what does not close, by the flow and its derivative."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.chaos.floquet import FloquetMultipliers, floquet_multipliers, symplectic_inverse
from canon.flow.chaos.orbit_scale import OrbitScale, orbit_scale
from canon.flow.geometry.flow_jacobian import flow_jacobian
from canon.flow.propagation import propagated
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.system.named_values import variables_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from canon.array import Array
    from canon.flow.request import Request
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["NoPeriodicOrbitError", "PeriodicOrbit", "PeriodicSearch"]

_TRIES = 40
_ROUNDING = 2.0**-52
_LEFT = 1e3 * _ROUNDING
"""What rounding leaves, in parts of a size."""

_SAMPLES = 64
_PERIODS = 2.0
"""The period found is not so many times longer or shorter than the guess."""
_LEAST_ROW = 1e-2
"""Least scale of an equation, in parts of the largest: what is smaller may be all rounding."""

_SMALLEST_SINGULAR, _SURE_SINGULAR = 1e-9, 1e-3
"""Directions in which less changes than this part of the largest change are those of symmetries: none is followed.
Where they are nearly so, as among Kepler's orbits, which all close, a step is better that leaves them alone."""


_LAPS, _SAME = (2, 3, 5, 7, 11), 1e-6
"""Parts of a period after which an orbit may close already, and how near, in its scale, at most."""

_ALONG = 1e-6
"""Part of a slope below which it says nothing of a direction."""


class NoPeriodicOrbitError(ValueError):
    """Raised where no periodic orbit is found from a start.

    Parameters
    ----------
    message
        What happened.
    y, period, defect
        The state and period that came nearest, and how far from closing.
    """

    def __init__(self, message: str, y: Array, period: float, defect: float) -> None:
        super().__init__(message)
        self.y, self.period, self.defect = y, period, defect

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes this error again, in another process too."""
        return type(self), (str(self), self.y, self.period, self.defect)


@dataclass(frozen=True, eq=False)
class PeriodicOrbit:
    """A motion that comes back to its start, and how its neighbours move.

    Parameters
    ----------
    y
        A state on it, (q, p), shape (2n,).
    period
        The time after which it comes back.
    energy
        H there.
    defect
        How far from its start it arrives, in the largest component.
    M
        The monodromy matrix, the derivative of the flow over the period, shape (2n, 2n).
    multipliers
        The eigenvalues of M but for the two that are 1, their Krein signs and what they say of stability.
    search
        How it was found.
    scale
        The sizes of its variables, its period and its energy that it was measured by.
    least_period
        The shortest time after which it comes back: the period, unless that is a multiple. Of a system that depends on
        time the period.
    """

    y: Array
    period: float
    energy: float
    defect: float
    M: Array
    multipliers: FloquetMultipliers
    search: PeriodicSearch = field(repr=False)
    scale: OrbitScale = field(repr=False)
    least_period: float

    def __repr__(self) -> str:
        stable = {True: "stable", False: "unstable", None: "of unknown stability"}[self.multipliers.stable]
        kinds = ", ".join(self.multipliers.kinds)
        laps = round(self.period / self.least_period)
        over = f" ({laps} times {self.least_period:.12g})" if laps > 1 else ""
        return (
            f"<PeriodicOrbit: period {self.period:.12g}{over}, energy {self.energy:.12g}, {stable} ({kinds})>"
        )


@dataclass(frozen=True, eq=False)
class PeriodicSearch:
    """Newton's method for the periodic orbits of one system.

    Parameters
    ----------
    request
        The system, its parameters and how to integrate.
    equations
        Its equations.
    shift
        What angles gain in a period.
    signs
        The signs of a reversing symmetry, or None.
    fixed_period
        Whether the period is kept.
    """

    request: Request
    equations: HamiltonEquations
    shift: Array
    signs: Array | None
    fixed_period: bool

    def energy(self, y: Array) -> float:
        """Return H."""
        return float(self._values([self.equations.hamiltonian], y)[0])

    def field(self, y: Array) -> Array:
        """Return the rates (q̇, ṗ)."""
        return self._values([*self.equations.velocity, *self.equations.force], y)

    def slope(self, y: Array) -> Array:
        """Return ∇H."""
        n = len(y) // 2
        rates = self.field(y)
        return np.concatenate([-rates[n:], rates[:n]])

    def _values(self, nodes: Sequence[int], y: Array) -> Array:
        start = dict(zip(self.equations.inputs, (*y, 0.0), strict=True))
        return np.array([float(x) for x in self.equations.graph.evaluate(nodes, start)])

    def flow(self, y: Array, time: float, scale: OrbitScale) -> tuple[Array, Array]:
        """Return where a state is after a time, and the derivative by the state, as a pure number."""
        r = self.request
        largest = max(1.0, float(abs(y / scale.state).max()))
        found = flow_jacobian(
            r.system,
            (0.0, time),
            y,
            method=r.method,
            step=r.step,
            tolerance=r.tolerance,
            parameters=r.parameters,
            sizes=scale.state * largest,
        )
        return found.y[:, -1], scale.bare(found.final)

    def course(self, y: Array, period: float) -> Array:
        """Return states along a trial orbit, shape (2n, times): of half of one that is symmetric, and its image."""
        time = period if self.signs is None else period / 2
        half = propagated(replace(self.request, t_span=(0.0, time), y0=y, samples=_SAMPLES)).y
        return half if self.signs is None else np.hstack([half, self.signs[:, np.newaxis] * half])

    def scale(self, y: Array, period: float) -> OrbitScale:
        """Return the sizes that a trial orbit is measured by."""
        return orbit_scale(self.equations, self.course(y, period), self.shift, period)

    def check_reversal(self, y: Array, period: float) -> None:
        """Refuse signs that do not reverse the motion: S f(S y) = −f(y) is to hold.

        Raises
        ------
        ValueError
            They do not.
        """
        assert self.signs is not None
        sizes = self.scale(y, period).state
        place = y + 0.1 * sizes * np.random.default_rng(20).standard_normal(len(y))
        rates, mirrored = self.field(place) / sizes, self.signs * self.field(self.signs * place) / sizes
        if not abs(rates + mirrored).max() <= 1e-9 * abs(rates).max():
            changed = [
                s.name for s, sign in zip(variables_of(self.equations), self.signs, strict=True) if sign < 0
            ]
            raise ValueError(
                f"changing the signs of {', '.join(changed)} does not reverse the motion of this system"
            )

    def found(
        self, y: Array, period: float, energy: float | None, across: Array | None = None
    ) -> PeriodicOrbit:
        """Return the periodic orbit from a guess: of an energy, or across a step, which a form of (y, T) is 0 of.

        Raises
        ------
        NoPeriodicOrbitError
            Where Newton's method does not come to an end.
        """
        guess = _Guess.of(self, y, period, self.scale(y, period), energy)
        for _ in range(_TRIES):
            following = None if guess.exact else self._following(guess, across, period)
            if following is None:
                if guess.settled:
                    self._check_moving(guess)
                    return self.orbit(guess)
                break
            guess = following
        raise NoPeriodicOrbitError(
            f"no periodic orbit is found: the nearest arrives {guess.defect:.2g} from its start after "
            f"{guess.period:.9g}; begin nearer to one, or at another period",
            guess.y, guess.period, guess.defect,
        )  # fmt: skip

    def _check_moving(self, guess: _Guess) -> None:
        """Refuse an equilibrium, which closes after any time.

        Raises
        ------
        NoPeriodicOrbitError
            The state is at rest but for rounding.
        """
        way = abs(self.field(guess.y) / guess.scale.state).max() * guess.period
        if self.equations.autonomous and way <= guess.rounding:
            raise NoPeriodicOrbitError(
                f"the search ends at an equilibrium, {guess.y}, which closes after any time and is no orbit; begin "
                "farther from it, with an energy or a period that an orbit has",
                guess.y, guess.period, guess.defect,
            )  # fmt: skip

    def _following(self, guess: _Guess, across: Array | None, first: float) -> _Guess | None:
        """Return the better of the guesses in all directions and in those that are certainly no symmetries."""
        whole, sure = (
            self._newton_step(guess, across, least) for least in (_SMALLEST_SINGULAR, _SURE_SINGULAR)
        )
        steps = [whole] if np.array_equal(whole, sure) else [whole, sure]
        found = [each for step in steps if (each := self._improved(guess, step, first)) is not None]
        return min(found, key=lambda each: each.missing, default=None)

    def _improved(self, guess: _Guess, step: Array, first: float) -> _Guess | None:
        """Return a better guess along a step of Newton's, or None where there is none near the first period."""
        for halvings in range(8):
            part = 0.5**halvings
            period = guess.period + part * step[-1]
            if not 1 / _PERIODS < period / first < _PERIODS:
                continue
            try:
                following = _Guess.of(self, guess.y + part * step[:-1], period, guess.scale, guess.energy)
            except (NonFiniteStateError, ValueError):
                continue
            if following.missing < guess.missing * (1 - 0.25 * part):
                return following
            if guess.settled:
                return None
        return None

    def orbit(self, guess: _Guess) -> PeriodicOrbit:
        """Return the orbit of a guess that closes."""
        scale = guess.scale
        M = guess.M if self.signs is None else _whole(guess.M, self.signs)
        slope = self.slope(guess.y) * scale.state / scale.energy if self.equations.autonomous else None
        return PeriodicOrbit(
            guess.y, float(guess.period), self.energy(guess.y), guess.defect, scale.dimensional(M),
            floquet_multipliers(M, slope), self, scale, self._least_period(guess),
        )  # fmt: skip

    def _least_period(self, guess: _Guess) -> float:
        """Return the shortest part of the period, with small primes, after which the orbit closes."""
        laps = 1
        if self.equations.autonomous or self.equations.kicked:
            for prime in _LAPS:
                while self._closes_after(guess, laps * prime):
                    laps *= prime
        return float(guess.period) / laps

    def _closes_after(self, guess: _Guess, laps: int) -> bool:
        time, turns = guess.period / laps, self.shift / (2 * np.pi * laps)
        if (self.equations.kicked and time % 1) or abs(turns - turns.round()).max() > _LEFT:
            return False
        end = propagated(replace(self.request, t_span=(0.0, time), y0=guess.y, samples=1)).y[:, -1]
        missed = (end - guess.y - self.shift / laps) / guess.scale.state
        return bool(abs(missed).max() <= min(_SAME, 1e3 * guess.rounding))

    def _newton_step(self, guess: _Guess, across: Array | None, least: float) -> Array:
        """Return the step of (y, T) by which what does not close would vanish to first order."""
        scale = guess.scale
        rows, right = self.conditions(guess)
        if guess.energy is not None:
            rows.append(np.append(self.slope(guess.y) * scale.state / scale.energy, 0.0))
            right.append(-guess.energy_missed)
        if across is not None:
            rows.append(across * scale.both)
            right.append(0.0)
        return self.solved(np.array(rows), np.array(right), least) * scale.both

    def conditions(self, guess: _Guess) -> tuple[list[Array], list[float]]:
        """Return linear equations for (δy, δT) in the orbit's scale: that it closes, and that the step is across it."""
        size, scale = len(guess.y), guess.scale
        part = 1.0 if self.signs is None else 0.5
        derivative = guess.M - (np.eye(size) if self.signs is None else 0.0)
        arriving, starting = (self.field(y) * scale.period / scale.state for y in (guess.end, guess.y))
        rows = np.concatenate([derivative, part * arriving[:, np.newaxis]], axis=1)
        right = -guess.missed
        if self.signs is not None:
            rows, right = rows[self.signs < 0], right[self.signs < 0]
        equations, values = list(rows), right.tolist()
        if self.fixed_period:
            equations.append(np.append(np.zeros(size), 1.0))
            values.append(0.0)
        elif self.signs is None:
            equations.append(np.append(starting, 0.0))
            values.append(0.0)
        return equations, values

    def kernel(self, y: Array, period: float, scale: OrbitScale, before: Array | None = None) -> Array:
        """Return the direction (δy, δT), of length 1 in a scale, in which orbits go on closing to first order.

        Of several it is that in which the energy changes: along the others symmetries move the orbit. At a fold of the
        energy it is the one nearest to the direction before, which is given as a form.
        """
        rows, _ = self.conditions(_Guess.of(self, y, period, scale, None))
        free = self._free(len(y) + 1)
        found = np.zeros(len(y) + 1)
        _, singular, directions = np.linalg.svd(np.array(rows)[:, free])
        rank = int((singular > _SMALLEST_SINGULAR * singular[0]).sum())
        closing = directions[min(rank, len(directions) - 1) :]
        found[free] = closing[-1]
        for form in (np.append(self.slope(y), 0.0), before) if len(closing) > 1 else ():
            if form is not None:
                bare = form * scale.both
                along = closing @ bare[free]
                if np.linalg.norm(along) > _ALONG * np.linalg.norm(bare):
                    found[free] = along @ closing / np.linalg.norm(along)
                    break
        return found

    def _free(self, size: int) -> npt.NDArray[np.bool_]:
        """Return which of (y, T) vary: of starts on the fixed states of a symmetry those that are not zero there."""
        free = np.ones(size, dtype=bool)
        if self.signs is not None:
            free[:-1] = self.signs > 0
        return free

    def solved(self, rows: Array, right: Array, least: float = _SMALLEST_SINGULAR) -> Array:
        """Return the shortest solution in what varies, in directions in which enough changes."""
        free = self._free(rows.shape[1])
        scale = np.abs(rows[:, free]).max(axis=1)
        # At a turning point the derivatives of a row vanish but for rounding, which is not to be blown up.
        scale = np.maximum(scale, _LEAST_ROW * scale.max(initial=0.0))
        scale[scale == 0] = 1.0
        found = np.zeros(rows.shape[1])
        found[free] = np.linalg.lstsq(rows[:, free] / scale[:, np.newaxis], right / scale, rcond=least)[0]
        return found


@dataclass(frozen=True, eq=False)
class _Guess:
    """A state and a period, where the motion arrives after it, or after half of it, and the derivative.

    Parameters
    ----------
    y, period
        The start and the period.
    scale
        What all of it is measured by.
    energy
        The energy that is wanted, where one is.
    end, M
        Where it arrives, and the derivative in the scale.
    missed, energy_missed
        What does not close, and how far the energy is from what is wanted, in the scale.
    energy_rounding
        What rounding leaves of the energy, in the scale.
    """

    y: Array
    period: float
    scale: OrbitScale
    energy: float | None
    end: Array
    M: Array
    missed: Array
    energy_missed: float
    energy_rounding: float

    @classmethod
    def of(
        cls, search: PeriodicSearch, y: Array, period: float, scale: OrbitScale, energy: float | None
    ) -> _Guess:
        off = rounding = 0.0
        if energy is not None:
            off = (search.energy(y) - energy) / scale.energy
            rounding = _LEFT * (abs(energy) + abs(search.slope(y) * y).sum()) / scale.energy
        end, M = search.flow(y, period if search.signs is None else period / 2, scale)
        missed = end - y - search.shift if search.signs is None else np.where(search.signs < 0, end, 0.0)
        return cls(y, period, scale, energy, end, M, missed / scale.state, off, rounding)

    @property
    def defect(self) -> float:
        """How far from its start it arrives, in the largest component."""
        return float(abs(self.missed * self.scale.state).max())

    @property
    def missing(self) -> float:
        """What is missing for the orbit that is wanted, in the scale."""
        return max(float(abs(self.missed).max()), abs(self.energy_missed))

    @property
    def exact(self) -> bool:
        """Whether what is missing is too little to be worth a step, which might shrink it for ever."""
        return self.missing <= _ROUNDING

    @property
    def settled(self) -> bool:
        """Whether what is missing is no more than rounding leaves, times what the motion makes of it."""
        closed = float(abs(self.missed).max()) <= self.rounding
        return closed and abs(self.energy_missed) <= max(self.energy_rounding, self.rounding)

    @property
    def rounding(self) -> float:
        """What rounding leaves, times what the motion makes of it, in the scale."""
        size = float(abs(self.y / self.scale.state).max())
        return _LEFT * max(1.0, size) * max(1.0, float(abs(self.M).max()))


def _whole(half: Array, signs: Array) -> Array:
    """Return the monodromy matrix S M⁻¹ S M of half a period's derivative."""
    return signs[:, np.newaxis] * symplectic_inverse(half) * signs @ half
