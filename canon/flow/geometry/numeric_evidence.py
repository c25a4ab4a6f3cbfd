"""Numeric evidence for or against what was claimed: brackets at points, and motion along a trajectory.

Nothing here proves anything. A true claim is kept to round-off; one that fails by far more than that is
certainly not met by the numbers given, but no verdict follows from it: ``verdict.witness(seen.evidence)``
adds it to a verdict and leaves the status.

Brackets and rates are exact derivatives evaluated at exact points with 30 and with 50 digits, whose
difference shows the round-off. Trajectories are heyoka's, in doubles at the tolerance of round-off. Both
MᵀJM and the bilinear covariant keep their values under the linearised Hamilton's equations along any curve,
and an integral changes only by what each step errs, so what is expected of round-off grows as the square
root of the steps even where neighbouring motions part exponentially (D. Brouwer, Astron. J. 46 (1937) 149).
"""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
import sympy as sp

from canon.display import preformatted
from canon.flow.geometry.certified_derivatives import FINE, Residual, bracket_residuals
from canon.flow.geometry.vector_field_motion import carried, integral_rate, step_error, vector_field_system
from canon.kernel.program.hamilton_equations import exact_numbers
from canon.proof.domain.verdict import Evidence

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.array import Array
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.mechanics.canonical.transformation import CanonicalTransformation
    from canon.mechanics.hamilton.vector_field import VectorField

__all__ = ["Witness", "bilinear_covariant", "brackets_at_points", "integral_along_motion", "symplectic_flow"]

_ROUNDED, _WRONG = 10, 1_000
"""Changes up to so many units of the expected round-off are round-off; from so many on they are not."""

_TINY = float(np.finfo(float).tiny)
"""Stands for no round-off at all, as what is measured may be zero with all its derivatives."""

_SMALL = 1e-6
"""A change is neither called round-off when it is larger, nor wrong when it is smaller, than this part of its scale."""


@dataclass(frozen=True)
class Witness:
    """Numerical evidence for or against a claim, which never decides it.

    Parameters
    ----------
    kind
        What was measured.
    text
        What came out, one sentence.
    speaks
        For the claim, against it, or neither: where round-off hides the answer.
    largest
        The largest of what should have vanished.
    roundoff
        The size that round-off alone would give it.
    looks
        Points or instants looked at.
    """

    kind: str
    text: str
    speaks: Literal["for", "against", "neither"]
    largest: float
    roundoff: float
    looks: int

    def __repr__(self) -> str:
        return f"<Witness: {self.kind}: speaks {self.speaks}{'' if self.speaks == 'neither' else ' it'}>"

    def _repr_html_(self) -> str:
        return preformatted("\n".join(textwrap.wrap(f"{self.kind}: {self.text}", 90)))

    @property
    def evidence(self) -> Evidence:
        """The sentence as evidence for a verdict: ``verdict.witness(this.evidence)``."""
        return Evidence(self.kind, self.text)


def brackets_at_points(
    transformation: CanonicalTransformation,
    *,
    valence: Expr | int = 1,
    points: int = 20,
    seed: int = 0,
    parameters: Mapping[Symbol | str, Any] = MappingProxyType({}),
) -> Witness:
    """Measure M J Mᵀ − c J at random points of the domain, M = ∂(Q, P)/∂(q, p).

    Parameters
    ----------
    transformation
        The map (q, p) → (Q, P).
    valence
        The constant c.
    points
        How many points; those where the map has no finite real value are passed over.
    seed
        Equal seeds draw equal points.
    parameters
        Numbers for parameters; the others are drawn as q, p and t are.

    Raises
    ------
    ValueError
        The map holds an arbitrary function, or has no finite real value at any point drawn.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon import CanonicalTransformation
    >>> q, p = symbols("q p", real=True)
    >>> seen = brackets_at_points(CanonicalTransformation(q, p, p, -2*q), points=5)
    >>> print(seen.text)
    {Q1, P1} differs from 1 by 1 at ...: the map is certainly not canonical with valence 1
    """
    fixed = exact_numbers(parameters)
    seen, misses = 0, list[Residual]()
    for found in bracket_residuals(transformation, sp.sympify(valence, strict=True), points, seed, fixed):
        misses.extend(found)
        seen += 1
    if not seen:
        raise ValueError("the map has no finite real value at any point drawn: state its domain, or a box")
    wrong = max((m for m in misses if m.certain), key=lambda m: m.size, default=None)
    worst = wrong or max(misses, key=lambda m: m.size)
    unit = float(max(m.unit for m in misses))
    largest, kind = float(worst.size), "brackets at points"
    if wrong is not None:
        where = ", ".join(f"{s} = {x}" for s, x in sorted(wrong.where.items(), key=str))
        text = f"{wrong.what} by {largest:.2g} at {where}: the map is certainly not canonical with valence {valence}"
        return Witness(kind, text, "against", largest, unit, seen)
    J = "J" if valence == 1 else f"({valence}) J"
    text = f"M J Mᵀ − {J} is at most {largest:.1g} at {seen} random points (round-off: {unit:.1g}): "
    if all(m.rounded for m in misses):
        text += "strong evidence that the map is canonical there, no proof"
        return Witness(kind, text, "for", largest, unit, seen)
    text += (
        "more than round-off, but so little that rounded numbers in the map may cause it; it decides nothing"
    )
    return Witness(kind, text, "neither", largest, unit, seen)


def symplectic_flow(
    motion: HamiltonianSystem | VectorField,
    t_span: tuple[float, float],
    y0: Sequence[Any],
    *,
    parameters: Mapping[Symbol | str, Any] = MappingProxyType({}),
    samples: int = 100,
) -> Witness:
    """Measure MᵀJM − J along a trajectory, M = ∂(q, p)(t)/∂(q, p)(0) the Jacobian of the flow.

    M is carried by the variational equations dM/dt = (∂X/∂x) M that heyoka makes of the equations of motion.
    Its entries bear units: where those of q and p differ by many powers of ten, round-off decides nothing.

    Parameters
    ----------
    motion
        A Hamiltonian, or a vector field on (q, p) that is claimed to be Hamiltonian.
    t_span
        First and last time.
    y0
        The starting state (q, p), shape (2n,).
    parameters
        A number for every parameter.
    samples
        Instants looked at after the first, evenly spaced.

    Raises
    ------
    KeyError, ValueError
        A parameter has no number; the equations hold an arbitrary function; the state has the wrong length.
    NonFiniteStateError
        The motion can't be continued over the whole span.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p = symbols("q p", real=True)
    >>> from canon.mechanics.hamilton.vector_field import VectorField
    >>> damped = VectorField((p, -q - p/10), (q, p))
    >>> print(symplectic_flow(damped, (0, 5), [1, 0]).text)
    MᵀJM − J reaches 0.39 over t = 0 … 5, ... times the round-off expected: the flow is not symplectic
    """
    import heyoka as hy

    field = vector_field_system(motion, parameters)
    n = field.half()
    pairs = field.heyoka_pairs()
    states, steps = carried(
        field, hy.var_ode_sys(pairs, hy.var_args.vars, order=1), t_span, field.state(y0), samples, 2 * n
    )
    M = states[:, 2 * n :].reshape(-1, 2 * n, 2 * n)
    J = np.block([[np.zeros((n, n)), np.eye(n)], [-np.eye(n), np.zeros((n, n))]])
    with np.errstate(over="ignore", invalid="ignore"):
        change = _finite(np.abs(M.swapaxes(1, 2) @ J @ M - J), "MᵀJM − J").max()
    error = step_error(states, steps)[2 * n :].reshape(2 * n, 2 * n)
    unit = float(2 * (np.abs(M.swapaxes(1, 2) @ J) @ error).max())
    return _by_round_off(
        "symplectic flow",
        "MᵀJM − J",
        _Change(float(change), unit, 1.0, t_span, samples + 1),
        "good evidence that the flow is symplectic near such a motion, no proof",
        "the flow is not symplectic",
    )


def bilinear_covariant(
    motion: HamiltonianSystem | VectorField,
    t_span: tuple[float, float],
    y0: Sequence[Any],
    *,
    variations: Sequence[Sequence[Any]] | None = None,
    parameters: Mapping[Symbol | str, Any] = MappingProxyType({}),
    samples: int = 100,
    seed: int = 0,
) -> Witness:
    """Measure the change of Σ (δp Δq − Δp δq) for two variations δ, Δ carried along a trajectory.

    The variations obey the linearised equations of motion, differentiated on canon's own graph: a second
    route beside :func:`symplectic_flow`.

    Parameters
    ----------
    motion, t_span, y0, parameters, samples
        As for :func:`symplectic_flow`, with the same errors.
    variations
        The two at the start, each of shape (2n,); drawn at random with ``seed`` where not given.
    seed
        Equal seeds draw equal variations.

    Examples
    --------
    >>> from canon import Hamiltonian
    >>> from sympy import cos, symbols
    >>> q, p = symbols("q p", real=True)
    >>> pendulum = Hamiltonian(p**2/2 - cos(q), q, p)
    >>> bilinear_covariant(pendulum, (0, 20), [1, 0]).speaks
    'for'
    """
    field = vector_field_system(motion, parameters)
    n = field.half()
    if variations is None:
        start = np.random.default_rng(seed).standard_normal((2, 2 * n))
    else:
        start = np.array([field.state(each) for each in variations])
        if len(start) != 2 or not start.any(axis=1).all():
            raise ValueError(f"variations = {start.tolist()}: the covariant is of two that are not zero")
    y = np.concatenate([field.state(y0), *start])
    states, steps = carried(field, field.heyoka_pairs(variations=2), t_span, y, samples, 2)
    d, D = states[:, 2 * n : 4 * n], states[:, 4 * n :]
    with np.errstate(over="ignore", invalid="ignore"):
        terms = np.hstack([d[:, n:] * D[:, :n], -D[:, n:] * d[:, :n]])
        covariant = _finite(terms.sum(axis=1), "the bilinear covariant")
    change = float(np.abs(covariant - covariant[0]).max())
    error_d, error_D = np.split(step_error(states, steps)[2 * n :], 2)
    unit = float((np.abs(d) @ np.roll(error_D, n) + np.abs(D) @ np.roll(error_d, n)).max())
    return _by_round_off(
        "bilinear covariant",
        f"the change of Σ(δp Δq − Δp δq), {covariant[0]:.3g} at the start,",
        _Change(change, unit, float(np.abs(terms[0]).sum()), t_span, samples + 1),
        "good evidence that the flow is symplectic near such a motion, no proof",
        "the flow is not symplectic",
    )


def integral_along_motion(
    integral: Expr,
    motion: HamiltonianSystem | VectorField,
    t_span: tuple[float, float],
    y0: Sequence[Any],
    *,
    parameters: Mapping[Symbol | str, Any] = MappingProxyType({}),
    samples: int = 100,
) -> Witness:
    """Measure how a claimed integral I(q, p, t) changes along a trajectory.

    It speaks against the claim only where moreover dI/dt, an exact derivative taken with 50 digits, is not
    zero at a state of the trajectory: that does not rest on the integration. It speaks for the claim only
    where dI/dt vanishes to round-off at all of them.

    Parameters
    ----------
    integral
        I as a function of the variables, t and the parameters.
    motion, t_span, y0, parameters, samples
        As for :func:`symplectic_flow`, with the same errors; a vector field may have any number of variables.

    Examples
    --------
    >>> from canon import Hamiltonian
    >>> from sympy import cos, symbols
    >>> q, p = symbols("q p", real=True)
    >>> pendulum = Hamiltonian(p**2/2 - cos(q), q, p)
    >>> integral_along_motion(pendulum.H, pendulum, (0, 20), [1, 0]).speaks
    'for'
    >>> print(integral_along_motion(pendulum.H + q/100, pendulum, (0, 20), [1, 0]).text)
    the claimed integral changes by 0.02 over t = 0 … 20, ... times the round-off expected, ...
    """
    field = vector_field_system(motion, parameters)
    claimed = field.node(integral, "the claimed integral")
    if not field.graph.symbols(claimed) & {*field.x, field.t}:
        raise ValueError(
            f"the claimed integral {integral} holds no variable of the motion: nothing can drift"
        )
    states, steps = carried(field, field.heyoka_pairs(), t_span, field.state(y0), samples)
    if (states == states[0]).all():
        raise ValueError(f"nothing moves from {list(y0)}: start away from equilibrium")
    times = np.linspace(float(t_span[0]), float(t_span[1]), samples + 1)
    looks = [integral_rate(field, claimed, y, t) for y, t in zip(states, times.tolist(), strict=True)]
    first = looks[0].value
    change = float(max(abs(look.value - first) for look in looks))
    scale = float(max(look.scale for look in looks))
    slopes = np.array([look.slopes for look in looks])
    unit = float((slopes @ step_error(states, steps)).max() + np.finfo(float).eps * scale) or _TINY
    rate = max((look.rate for look in looks), key=lambda m: m.size)
    span = f"over t = {_short(t_span[0])} … {_short(t_span[1])}"
    times_unit = f"{change / unit:.2g} times the round-off expected"
    kind = "drift of an integral"
    if any(look.rate.certain for look in looks) and change > min(_WRONG * unit, _SMALL * scale):
        text = (
            f"the claimed integral changes by {change:.2g} {span}, {times_unit}, and dI/dt reaches "
            f"{float(rate.size):.2g}: it is certainly no constant of this motion"
        )
        return Witness(kind, text, "against", change, unit, len(looks))
    kept = f"the claimed integral is kept to {change:.1g} {span}, {times_unit}"
    if all(look.rate.rounded for look in looks) and change <= min(_ROUNDED * unit, _SMALL * scale):
        text = (
            f"{kept}, and dI/dt is round-off of {FINE} digits at {len(looks)} states: "
            "strong evidence if the start is a general one, no proof"
        )
        return Witness(kind, text, "for", change, unit, len(looks))
    text = f"{kept}, and dI/dt is at most {float(rate.size):.1g}: this decides nothing"
    return Witness(kind, text, "neither", change, unit, len(looks))


class _Change(NamedTuple):
    """What should not have changed: by how much it did, what round-off gives, and its own size."""

    largest: float
    unit: float
    scale: float
    t_span: tuple[float, float]
    looks: int


def _by_round_off(kind: str, what: str, change: _Change, true: str, false: str) -> Witness:
    speaks: Literal["for", "against", "neither"] = "neither"
    conclusion = "this decides nothing; look at a shorter span, where round-off has grown less"
    if change.largest <= min(_ROUNDED * change.unit, _SMALL * change.scale):
        speaks, conclusion = "for", true
    elif change.largest > max(_WRONG * change.unit, _SMALL * change.scale):
        speaks, conclusion = "against", false
    text = (
        f"{what} reaches {change.largest:.2g} over t = {_short(change.t_span[0])} … {_short(change.t_span[1])}, "
        f"{change.largest / change.unit:.2g} times the round-off expected: {conclusion}"
    )
    return Witness(kind, text, speaks, change.largest, change.unit, change.looks)


def _finite(values: Array, what: str) -> Array:
    if not np.isfinite(values).all():
        raise ValueError(f"{what} is too large for doubles: look at a shorter span")
    return values


def _short(x: Any) -> str:
    return f"{float(x):g}"
