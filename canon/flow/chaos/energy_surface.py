"""Starts on a surface of constant energy: one momentum of each found so that H has a given value."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE
from canon.expression.symbols.user_input import listed
from canon.flow.checked_request import hamilton_equations_of
from canon.flow.system.scene_as_system import is_scene, opened
from canon.flow.system_request import is_hamiltonian
from canon.kernel.program.hamilton_equations import exact_numbers

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy.typing as npt
    from sympy import Symbol

    from canon.array import Array
    from canon.flow.system.recognised_system import MovableSystem
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["starts_of_energy"]


def starts_of_energy(
    system: MovableSystem,
    energy: float,
    y0: npt.ArrayLike,
    momentum: Symbol | str,
    *,
    sign: int = 1,
    parameters: Mapping[Symbol | str, Any] | None = None,
    inside_only: bool = False,
) -> Array:
    """Return states whose energy is given, one momentum of each being replaced.

    With H = a p² + b p + c in that momentum, p = (−b ± √(b² − 4a(c − E)))/(2a); (E − c)/b where a vanishes.

    Parameters
    ----------
    system
        A Hamiltonian that does not depend on time, or a scene that has one.
    energy
        E.
    y0
        States (q, p), shape (2n,) or (2n, orbits); the momentum that is replaced may be anything.
    momentum
        Which one, by symbol or name.
    sign
        1: the larger of the two solutions, −1: the smaller.
    parameters
        As :func:`canon.propagate` takes them.
    inside_only
        Leave states out where no momentum gives the energy, in place of an error: grids reach beyond its surface.

    Raises
    ------
    ValueError
        The momentum does not stand in H as its square; no momentum gives the energy somewhere.
    KeyError
        There is no such momentum.

    Examples
    --------
    >>> starts_of_energy("henon-heiles", 0.125, [0.0, 0.1, 0.0, 0.0], "p_x").round(6).tolist()
    [0.0, 0.1, 0.490578, 0.0]
    """
    if sign not in (1, -1):
        raise ValueError(f"sign={sign}: 1 takes the larger momentum, -1 the smaller")
    equations = _equations(system, dict(parameters or {}))
    names = {symbol.name: k for k, symbol in enumerate(equations.p)}
    if str(momentum) not in names:
        raise KeyError(f"there is no momentum {momentum}, H has {listed(names)}")
    if not equations.autonomous:
        raise ValueError("H depends on time, so that its value is no energy to start with")
    row = len(equations.q) + names[str(momentum)]
    graph, p = equations.graph, equations.p[names[str(momentum)]]
    slope = equations.velocity[names[str(momentum)]]
    bend = graph.gradient(slope, [p])[0]
    if graph.mask([p]) & graph.masks[bend] or bend == graph.number(0):
        raise ValueError(
            f"H is no square in {p}: start where another momentum is replaced, or solve H = E yourself"
        )
    given = np.array(y0, dtype=np.float64)
    if given.shape[:1] != (2 * len(equations.q),):
        raise ValueError(
            f"y0 of shape {given.shape}: states (q, p) have shape ({2 * len(equations.q)}, orbits)"
        )
    found, inside = _solved(equations, (slope, bend), given.reshape(len(given), -1), row, energy, sign)
    if inside_only:
        return found[:, inside]
    if not inside.all():
        lost = int(np.argmin(inside))
        raise ValueError(
            f"no {p} gives the energy {energy:g} at {given.reshape(len(given), -1)[:, lost]}: that lies beyond the "
            "surface of constant energy; inside_only=True leaves such starts out"
        )
    return found.reshape(given.shape)


def _equations(system: Any, parameters: dict[Any, Any]) -> HamiltonEquations:
    if is_scene(system):
        system, _, parameters = opened(system, (), parameters)
    if not is_hamiltonian(system):
        raise TypeError(
            f"{system!r:.60} is no Hamiltonian: give one, such as canon.hamiltonian(L), or a scene that has one"
        )
    numbers: dict[Any, Any] = exact_numbers(parameters)
    return hamilton_equations_of(system, numbers)


def _solved(
    equations: HamiltonEquations,
    derivatives: tuple[int, int],
    given: Array,
    row: int,
    energy: float,
    sign: int,
) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Return states with the momentum replaced, and which of them there are."""
    wide = np.longdouble
    point = given.astype(wide)
    point[row] = 0
    values = dict(zip(equations.inputs, (*point, wide(0)), strict=True))
    numbers = LONGDOUBLE if np.finfo(wide).nmant >= np.finfo(np.float64).nmant + 10 else FLOAT64
    c, b, twice_a = (
        np.broadcast_to(np.asarray(v, dtype=wide), given.shape[1:])
        for v in equations.graph.evaluate([equations.hamiltonian, *derivatives], values, numbers)
    )
    excess = c - wide(energy)
    square = b * b - 2 * twice_a * excess
    root = np.sqrt(np.where(square >= 0, square, 0))
    # Where the square has no coefficient one momentum is left; where the terms cancel, its other form does not.
    side = np.where(twice_a == 0, np.sign(b), np.sign(twice_a) * sign)
    above, below = -b + side * root, -b - side * root
    direct = (side * b <= 0) & (twice_a != 0)
    over = np.where(direct, twice_a, below)
    inside = (square >= 0) & (over != 0)
    found = given.copy()
    found[row] = np.where(direct, above, 2 * excess) / np.where(over == 0, 1, over)
    return found, inside
