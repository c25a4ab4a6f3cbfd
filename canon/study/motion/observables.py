"""Observables that should stay constant along a motion: energy, momenta, integrals, residuals, symplecticity."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.system_request import is_hamiltonian
from canon.scene.scene import Scene, near
from canon.study.errors import StudyError
from canon.study.motion.studied_motion import variables_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from sympy import Expr, Symbol

    from canon.array import Array
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.mechanics.hamilton.hamiltonian import Hamiltonian

__all__ = [
    "ENERGY",
    "SYMPLECTICITY",
    "Observable",
    "Tangent",
    "counts_as_zero",
    "expressions_of",
    "observables_of",
    "tangent_of",
]

ENERGY = "energy"
SYMPLECTICITY = "symplecticity"

NEGLIGIBLE = 1e-8
"""Share of the size of its terms below which a quantity counts as zero at the start."""


@dataclass(frozen=True)
class Observable:
    """A function of (q, p, t) that should stay constant, and what its error is divided by.

    Parameters
    ----------
    name
        What users call it.
    expression
        The function; None for the energy and the symplecticity defect.
    unit
        Its size at the start; where that is negligible, the size of its terms Σ|yᵢ ∂I/∂yᵢ|; else one.
    relative
        Whether its error is relative to itself or to its terms.
    """

    name: str
    expression: Expr | None = None
    unit: float = 1.0
    relative: bool = True


def counts_as_zero(value: float, terms: float) -> bool:
    """Tell whether a quantity is nothing, or rounding, beside the size of its terms Σ|yᵢ ∂I/∂yᵢ|."""
    return not abs(value) > NEGLIGIBLE * terms


def expressions_of(observables: Iterable[Observable]) -> dict[str, Expr]:
    """Return the functions of observables by name, but for those that every motion has."""
    return {of.name: of.expression for of in observables if of.expression is not None}


def observables_of(
    system: Scene | HamiltonianSystem,
    hamiltonian: HamiltonianSystem,
    wanted: Sequence[str] | Mapping[str, Expr],
    y0: Array,
    values: Mapping[Symbol | str, float],
) -> tuple[Observable, ...]:
    """Return the observables of these names, or of these functions by name.

    Parameters
    ----------
    system, hamiltonian
        A scene, whose known constants have names, or a Hamiltonian; and the Hamiltonian itself.
    wanted
        ``"energy"``; ``"momenta"``, those of the coordinates H does not depend on, or one of them by name;
        ``"integrals"``, all known constants of a scene, or one of them by name; ``"symplecticity"``, the
        change of the bilinear covariant Σ (δp Δq − Δp δq) of two variations carried along by the method. Or
        functions of (q, p) of your own, such as a constraint's residual.
    y0, values
        Initial state (q, p) and values of the parameters, for the size of the error's unit.

    Raises
    ------
    StudyError
        Where there is no observable of that name.

    Examples
    --------
    >>> from canon.scene import find
    >>> kepler = find("kepler")
    >>> found = observables_of(kepler, kepler.hamiltonian, ["integrals"], kepler.state(), kepler.values)
    >>> [each.name for each in found]
    ['angular momentum', 'Runge–Lenz vector, x', 'Runge–Lenz vector, y']
    """
    functions: dict[str, Expr | None]
    if isinstance(wanted, Mapping):
        functions = {**wanted}
    else:
        functions = _by_name(system, hamiltonian, [wanted] if isinstance(wanted, str) else list(wanted))
    if not functions:
        raise StudyError("no observable to follow: name at least one")
    return tuple(
        Observable(name) if f is None else _with_unit(name, f, hamiltonian, y0, values)
        for name, f in functions.items()
    )


def _by_name(
    system: Scene | HamiltonianSystem, hamiltonian: HamiltonianSystem, names: Iterable[str]
) -> dict[str, Expr | None]:
    if not is_hamiltonian(hamiltonian):
        if list(names) == [ENERGY]:
            return {ENERGY: None}
        raise StudyError(
            "of a system that is no Hamiltonian the energy has a name, no other observable: give functions by name"
        )
    free = hamiltonian.H.free_symbols
    ignorable = {str(p): p for q, p in zip(hamiltonian.q, hamiltonian.p, strict=True) if q not in free}
    constants = _constants(system) if isinstance(system, Scene) else {}
    single: dict[str, Expr | None] = {ENERGY: None, SYMPLECTICITY: None, **ignorable, **constants}
    found: dict[str, Expr | None] = {}
    for name in names:
        if name == "momenta":
            if not ignorable:
                raise StudyError("H depends on every coordinate, so no momentum is constant")
            found.update(ignorable)
        elif name == "integrals":
            if not constants:
                raise StudyError("no constant beside the energy is known: give functions of your own")
            found.update(constants)
        elif name in single:
            found[name] = single[name]
        else:
            raise StudyError(
                f"there is no observable {name!r}{near(name, [*single, 'momenta', 'integrals'])}"
            )
    return found


def _constants(scene: Scene) -> dict[str, Expr]:
    """Return the known constants of a scene as functions of q, p and t."""
    from canon.mechanics.algebra.substitution import exchanged

    velocities = dict(zip((q.dot for q in scene.q), scene.hamiltonian.q_dot, strict=True))
    return {name: exchanged(f, velocities) for name, f in scene.constants().items()}


def _with_unit(
    name: str, f: Expr, hamiltonian: HamiltonianSystem, y0: Array, values: Mapping[Symbol | str, float]
) -> Observable:
    from canon.expression.graph.graph import Graph
    from canon.proof.trees.sympy_types import free_symbols

    graph = Graph()
    variables, t = variables_of(hamiltonian)
    node = graph.from_sympy(f)
    nodes = [node, *graph.gradient(node, variables)]
    by_name = {str(symbol): value for symbol, value in values.items()}
    point = {s: np.float64(x) for s, x in zip(variables, y0, strict=True)} | {t: np.float64(0.0)}
    missing = [s for s in free_symbols(f) if s not in point and str(s) not in by_name]
    if missing:
        raise StudyError(
            f"the observable {name!r} holds {', '.join(sorted(map(str, missing)))}, which is no variable of the "
            "motion and has no value: give it one in parameters"
        )
    point |= {s: np.float64(by_name[str(s)]) for s in free_symbols(f) if s not in point}
    value, *slopes = (float(x) for x in graph.evaluate(nodes, point))
    if not math.isfinite(value):
        raise StudyError(
            f"the observable {name!r} is not finite at the start: take another start, or another observable"
        )
    terms = float(sum(abs(slope * x) for slope, x in zip(slopes, y0, strict=True)))
    terms = terms if math.isfinite(terms) else 0.0  # √x has no slope at 0
    if not counts_as_zero(value, terms):
        return Observable(name, f, abs(value))
    return Observable(name, f, terms or 1.0, relative=bool(terms))


@dataclass(frozen=True)
class Tangent:
    """A motion with two variations carried along, as a Hamiltonian motion of its own.

    K = Σ δq ∂H/∂q + δp ∂H/∂p with the pairs (q, δp) and (δq, p) generates the motion and its linearised
    one; a method applied to K varies as the method applied to H does, and K splits where H does. Each
    variation has a copy of the motion; both copies take the same steps.

    Parameters
    ----------
    hamiltonian
        K(q, δq; δp, p) + K(q′, Δq; Δp, p′).
    covariant
        Σ (δp Δq − Δp δq), −1 at the start.
    y0
        The starting state, shape (8n,).
    """

    hamiltonian: Hamiltonian
    covariant: Expr
    y0: Array


def tangent_of(hamiltonian: HamiltonianSystem, y0: Array) -> Tangent:
    """Return the motion with the variations δq = (1, …, 1), Δp = (1, …, 1)/n carried along.

    Parameters
    ----------
    hamiltonian
        H(q, p, t).
    y0
        The starting state (q, p), shape (2n,).

    Examples
    --------
    >>> from canon.scene import find
    >>> scene = find("harmonic-oscillator")
    >>> tangent_of(scene.hamiltonian, scene.state()).hamiltonian.H
    d1_p_x*p_x/m + d1_x*k*x + d2_p_x*p_x_copy/m + d2_x*k*x_copy
    """
    import sympy as sp

    from canon.mechanics.hamilton.hamiltonian import Hamiltonian

    q, p = tuple(hamiltonian.q), tuple(hamiltonian.p)
    copies = {s: sp.Symbol(f"{s}_copy", real=True) for s in (*q, *p)}
    d1, d2 = ({s: sp.Symbol(f"d{k}_{s}", real=True) for s in (*q, *p)} for k in (1, 2))
    slopes = {s: sp.diff(hamiltonian.H, s) for s in (*q, *p)}
    first = sp.Add(*(d1[s] * slope for s, slope in slopes.items()))
    second = sp.Add(*(d2[s] * slope.xreplace(copies) for s, slope in slopes.items()))
    places = [*q, *(d1[s] for s in q), *(copies[s] for s in q), *(d2[s] for s in q)]
    momenta = [*(d1[s] for s in p), *p, *(d2[s] for s in p), *(copies[s] for s in p)]
    covariant = sp.Add(*(d1[b] * d2[a] - d2[b] * d1[a] for a, b in zip(q, p, strict=True)))
    n = len(q)
    zero, one, at, moving = np.zeros(n), np.ones(n), y0[:n], y0[n:]
    start = np.concatenate([at, one, at, zero, zero, moving, one / n, moving])
    return Tangent(Hamiltonian(first + second, places, momenta), covariant, start)
