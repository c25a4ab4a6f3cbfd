"""Scenes as systems to propagate: a ready system, by value or by name, with its parameters and its start.

Scenes stand above this room and use it. The one import that points back is that of their list, when a scene is asked
for by name.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, cast

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.array import Array
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    from canon.mechanics.lagrange.lagrangian import Lagrangian

__all__ = ["Opened", "SceneLike", "StartLike", "is_named", "is_scene", "opened", "scene_of"]


class StartLike(Protocol):
    """A start of a scene: coordinates, and velocities or momenta."""

    @property
    def q(self) -> Sequence[float]:
        """The coordinates."""
        ...

    @property
    def v(self) -> Sequence[float] | None:
        """The velocities, where it is given by them."""
        ...


class SceneLike(Protocol):
    """What is needed of a scene, such as those of :mod:`canon.scene`."""

    @property
    def name(self) -> str:
        """What it is called."""
        ...

    @property
    def is_free(self) -> bool:
        """Whether a Hamiltonian says all."""
        ...

    @property
    def is_constrained(self) -> bool:
        """Whether constraints act."""
        ...

    @property
    def hamiltonian(self) -> HamiltonianSystem:
        """The Hamiltonian of a free one."""
        ...

    @property
    def lagrangian(self) -> Lagrangian:
        """The Lagrangian with its forces."""
        ...

    @property
    def constrained(self) -> ConstrainedLagrangian:
        """The Lagrangian with forces and constraints."""
        ...

    def values_by_symbol(self) -> dict[Symbol, float]:
        """The values of its parameters."""
        ...

    def start(self, name: str | None = None) -> StartLike:
        """The start of that name, or the default one."""
        ...

    def state(self, start: str | None = None, values: Mapping[str, Any] | None = None) -> Array:
        """The start (q, p) of that name, with values in place of its parameters' own."""
        ...


class Opened(NamedTuple):
    """What is propagated of a scene: the system, its start, and the values of its parameters."""

    system: Any
    y0: Any
    parameters: dict[Symbol | str, Any]


def is_scene(system: Any) -> bool:
    """Tell whether something is a scene, or the name of one."""
    return isinstance(system, str) or all(
        hasattr(system, x) for x in ("values_by_symbol", "state", "is_free")
    )


def opened(system: str | SceneLike, y0: Any, parameters: Mapping[Symbol | str, Any]) -> Opened:
    """Return what is propagated of a scene.

    A scene without forces and constraints moves by its Hamiltonian, its state being (q, p); any other by its
    Lagrangian, its state being (q, q̇).

    Parameters
    ----------
    system
        The scene, or its name.
    y0
        The name of one of its starts, None for the first, or any state.
    parameters
        Values in place of the scene's own.

    Raises
    ------
    canon.scene.SceneError
        There is no scene or start of that name.
    KeyError
        The scene has no such parameter.

    Examples
    --------
    >>> found = opened("simple-pendulum", "small", {"l": 2.0})
    >>> found.system.p, found.y0, found.parameters["l"]
    ((p_theta,), array([0.1, 0. ]), 2.0)

    Of a start by velocities the momenta are those at these values, here m l² times 7 rad/s:

    >>> opened("simple-pendulum", "rotating", {"l": 2.0}).y0
    array([ 0., 28.])
    """
    scene = scene_of(system)
    own = {s.name: value for s, value in scene.values_by_symbol().items()}
    values: dict[Symbol | str, Any] = {**own}
    for key, value in parameters.items():
        name = str(key)
        if name not in own:
            raise KeyError(f"{scene.name} has no parameter {name}; it has {', '.join(own) or 'none'}")
        values[name] = value
    if scene.is_free:
        # p = ∂L/∂q̇ of a start given by velocities is the one at the values that the motion has
        start = scene.state(y0, {str(name): x for name, x in values.items()}) if is_named(y0) else y0
        return Opened(scene.hamiltonian, start, values)
    moving = scene.constrained if scene.is_constrained else scene.lagrangian
    return Opened(moving, _placed(scene, y0, values) if is_named(y0) else y0, values)


def scene_of(system: str | SceneLike) -> SceneLike:
    """Return a scene, or the one of a name."""
    return _by_name(system) if isinstance(system, str) else system


def _by_name(name: str) -> SceneLike:
    from canon.scene import find  # the one import against the order of the rooms, when a name is given

    return cast("SceneLike", find(name))


def is_named(y0: Any) -> bool:
    """Tell whether a start is given as one of a scene's: by its name, or None for the first."""
    return y0 is None or isinstance(y0, str)


def _placed(scene: SceneLike, name: str | None, values: Mapping[Symbol | str, Any]) -> list[float]:
    """Return a start (q, q̇), put onto the constraints to round-off."""
    start = scene.start(name)
    if start.v is None:
        raise ValueError(f"this start of {scene.name} is given by momenta: give y0 as (q, q̇)")
    if not scene.is_constrained:
        return [*start.q, *start.v]
    from canon.mechanics.at_scale.constrained import constrained, constrained_motion
    from canon.mechanics.at_scale.second_order import derivation_of_lagrangian

    system = scene.constrained
    equations = constrained(
        derivation_of_lagrangian(system.lagrangian), system.holonomic, system.nonholonomic
    )
    numbers = {s: float(values[s.name]) for s in scene.values_by_symbol()}
    q, v = constrained_motion(equations, numbers).projected(start.q, start.v, 0.0)
    return [*q.tolist(), *v.tolist()]
