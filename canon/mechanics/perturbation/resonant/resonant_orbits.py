"""Periodic orbits of a resonant normal form: critical points of K on levels of its integral, and their stability."""

from __future__ import annotations

from dataclasses import dataclass
from math import gcd, tau
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.cached_property import cached_property
from canon.mechanics.perturbation.near_identity import near_identity_map
from canon.mechanics.perturbation.normal_form_step import weight_of
from canon.mechanics.perturbation.resonant.numeric_polynomial import NumericPolynomial

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy.typing as npt

    from canon.mechanics.perturbation.birkhoff import NormalForm

    Array = npt.NDArray[np.float64]

__all__ = ["NotIsolatedError", "ResonantOrbit", "resonant_orbits"]

SHARES, PHASES = 7, 12
"""Shares of the first pair in the integral, and differences of phase, from which critical points are searched."""
MOST = 24
"""Orbits beyond which they are taken for members of a family."""
STEPS = 40
CLOSED = 1e-11
"""What is left of an equation, relative to its terms, where Newton's method has come to its end."""


class NotIsolatedError(ValueError):
    """Raised where the critical points of a normal form come in families, as its terms do not tell them apart."""


@dataclass(frozen=True)
class ResonantOrbit:
    """A periodic orbit that a resonant normal form predicts.

    Parameters
    ----------
    state
        (q, p) of one of its points, from the map of the normal form to its order.
    period
        Its period.
    weights, level
        The integral Σ wⱼ Iⱼ of the normal form, and its value. Through an unstable orbit the level is the border of
        islands: ``formal_integral(form, weights)`` has it on their separatrix.
    exponent
        ν of its neighbours, which go as exp(±ν t): imaginary about a stable orbit, where its size is their frequency.
    """

    state: tuple[float, ...]
    period: float
    weights: tuple[int, ...]
    level: float
    exponent: complex

    @property
    def is_stable(self) -> bool:
        """Whether neighbours stay in an island about it, to this order."""
        return abs(self.exponent.imag) > abs(self.exponent.real)


def resonant_orbits(form: NormalForm, energy: float) -> tuple[ResonantOrbit, ...]:
    """Return the periodic orbits of an energy that a resonant normal form of two degrees of freedom predicts.

    With one resonance k the normal form has the integral I = Σ wⱼ Iⱼ, w·k = 0. Where ∇K = λ ∇I the motion is that of I
    with the frequency λ, and so periodic; the other eigenvalues of J (∂²K − λ ∂²I) say how neighbours move
    (R. C. Churchill, M. Kummer and D. L. Rod, J. Differ. Equ. 49, 359 (1983), doi:10.1016/0022-0396(83)90003-7).

    Parameters
    ----------
    form
        The normal form of two elliptic pairs, without parameters.
    energy
        The value of H.

    Raises
    ------
    NotIsolatedError
        Where orbits come in families; a higher order may tell them apart.
    ValueError
        Where the normal form has no resonance or several, or the integral is not definite.

    Examples
    --------
    >>> import sympy as sp
    >>> from canon import Hamiltonian, birkhoff_normal_form
    >>> x, y, px, py = sp.symbols("x y p_x p_y", real=True)
    >>> H = Hamiltonian((px**2 + py**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py])
    >>> found = resonant_orbits(birkhoff_normal_form(H, 6), 0.01)
    >>> len(found), sum(orbit.is_stable for orbit in found)
    (8, 5)
    """
    weights = _integral_weights(form)
    scene = _Reduced.of(form, weights)
    found: list[tuple[Array, float]] = []
    for start in scene.starts(energy):
        solved = scene.solved(start, energy)
        if solved is not None and not any(scene.same(solved[0], other) for other, _ in found):
            found.append(solved)
        if len(found) > MOST:
            raise NotIsolatedError(
                f"to degree {form.order} the periodic orbits are not isolated; take a normal form of a higher order"
            )
    return tuple(sorted((scene.orbit(x, rate) for x, rate in found), key=lambda orbit: orbit.level))


def _integral_weights(form: NormalForm) -> tuple[int, ...]:
    """Return coprime w > 0 with w·k = 0 for every k that occurs in the normal form."""
    diagonal = form.diagonal
    if len(diagonal.eigenvalues) != 2 or not all(diagonal.is_elliptic(j) for j in range(2)):
        raise ValueError("orbits are found of normal forms of two elliptic pairs")
    if diagonal.eigenvalues[0].ring.parameters:
        raise ValueError("put numbers for the parameters into H before the normal form")
    met = {k for part in form.parts.values() for k in part.split(weight_of) if any(k)}
    if not met:
        raise ValueError(
            f"to degree {form.order} the normal form has no resonant terms; its tori are not broken up"
        )
    first = min(met, key=lambda k: (abs(k[0]) + abs(k[1]), k))
    if any(k[0] * first[1] != k[1] * first[0] for k in met):
        raise ValueError("the normal form has several resonances, and no integral beside itself")
    if first[0] * first[1] >= 0:
        raise ValueError(f"the integral of the resonance {first} is not definite: its levels are not bounded")
    common = gcd(*first)
    return abs(first[1]) // common, abs(first[0]) // common


@dataclass(frozen=True)
class _Reduced:
    """K and I in real variables x, with z = R x for the variables of the normal form."""

    form: NormalForm
    weights: tuple[int, ...]
    R: npt.NDArray[np.complex128]
    K: NumericPolynomial
    I: NumericPolynomial

    @cached_property
    def images(self) -> tuple[NumericPolynomial, ...]:
        """The old variables as functions of z."""
        return tuple(NumericPolynomial.of(parts.values()) for parts in near_identity_map(self.form).images)

    @classmethod
    def of(cls, form: NormalForm, weights: tuple[int, ...]) -> _Reduced:
        diagonal = form.diagonal
        integral = diagonal.action(0).times(weights[0]) + diagonal.action(1).times(weights[1])
        rows = np.array(
            [NumericPolynomial.of([row]).gradient(np.zeros(4, dtype=complex)) for row in diagonal.rows]
        )
        return cls(
            form, weights, rows, NumericPolynomial.of(form.parts.values()), NumericPolynomial.of([integral])
        )

    def starts(self, energy: float) -> Iterator[Array]:
        """Yield points of the energy, by shares of the integral and differences of phase."""
        room = energy - float(self.K.value(np.zeros(4, dtype=complex)).real)
        frequencies = [float(w) for w in self.form.frequencies]
        rate = frequencies[0] / self.weights[0]
        if not room / rate > 0:
            raise ValueError(f"there is no motion of the energy {energy} near the equilibrium")
        back = np.linalg.inv(self.R)
        units = [
            1 / NumericPolynomial.of([self.form.diagonal.action(j)]).value(np.ones(4, dtype=complex)).real
            for j in range(2)
        ]
        z = np.zeros(4, dtype=complex)
        for share in np.linspace(0.0, 1.0, SHARES):
            for phase in np.linspace(0.0, tau, PHASES, endpoint=False):
                actions = [room / rate * share / self.weights[0], room / rate * (1 - share) / self.weights[1]]
                a, b = (np.sqrt(I * unit) for I, unit in zip(actions, units, strict=True))
                z[:2] = a, b * np.exp(1j * phase / self.weights[0])
                z[2:] = z[:2].conj()
                yield np.asarray((back @ z).real, dtype=np.float64)
                if share in (0.0, 1.0):
                    break

    def solved(self, x: Array, energy: float) -> tuple[Array, float] | None:
        """Return a critical point and λ by Newton's method from a start; None where it does not end."""
        slope, normal = self._slope(self.K, x), self._slope(self.I, x)
        rate = float(slope @ normal / (normal @ normal))
        for _ in range(STEPS):
            slope, normal = self._slope(self.K, x), self._slope(self.I, x)
            left = np.append(slope - rate * normal, self.K.value(self.R @ x).real - energy)
            curvature = self._curvature(self.K, x) - rate * self._curvature(self.I, x)
            matrix = np.block([[curvature, -normal[:, None]], [slope[None, :], np.zeros((1, 1))]])
            step = np.linalg.lstsq(matrix, -left, rcond=1e-10)[0]
            if np.linalg.norm(step) < 1e-13 * np.linalg.norm(x) and np.linalg.norm(
                left
            ) < CLOSED * np.linalg.norm(slope):
                return x, rate
            longest = 0.3 * np.linalg.norm(x)
            step *= min(1.0, longest / max(np.linalg.norm(step[:4]), 1e-300))
            x, rate = x + step[:4], rate + float(step[4])
        return None

    def same(self, x: Array, other: Array) -> bool:
        """Tell whether two points are on one orbit of I."""
        (m, n), scale = self.weights, max(np.linalg.norm(x), np.linalg.norm(other))
        marks: list[Any] = []
        for point in (x, other):
            z = self.R @ point / scale
            marks.append(np.array([abs(z[0]) ** 2, abs(z[1]) ** 2, z[0] ** n * z[1].conj() ** m]))
        return bool(np.max(np.abs(marks[0] - marks[1])) < 1e-5)

    def orbit(self, x: Array, rate: float) -> ResonantOrbit:
        """Return the orbit through a critical point, in the old variables."""
        flow = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
        matrix = flow @ (self._curvature(self.K, x) - rate * self._curvature(self.I, x))
        half = np.trace(matrix @ matrix) / 2  # the eigenvalues are 0, 0 and ±ν
        z = self.R @ x
        size = np.abs(z[:2])
        turns = [w for w, s in zip(self.weights, size, strict=True) if s > 1e-9 * size.max()]
        variables = (*self.form.source.q, *self.form.source.p)
        rest = [float(self.form.equilibrium[s]) for s in variables]
        state = tuple(float(e + image.value(z).real) for e, image in zip(rest, self.images, strict=True))
        period = tau / (abs(rate) * gcd(*turns))
        level = float(self.I.value(z).real)
        return ResonantOrbit(state, period, self.weights, level, complex(np.sqrt(complex(half))))

    def _slope(self, f: NumericPolynomial, x: Array) -> Array:
        return (self.R.T @ f.gradient(self.R @ x)).real

    def _curvature(self, f: NumericPolynomial, x: Array) -> Array:
        return (self.R.T @ f.hessian(self.R @ x) @ self.R).real
