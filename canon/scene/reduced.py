"""Routh reduction of a scene: its ignorable coordinates eliminated, with the Routhian as the new Lagrangian."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from canon.scene.parts import Parameter, SceneError, Start

if TYPE_CHECKING:
    from canon.scene.scene import Scene

__all__ = ["reduced"]


def reduced(scene: Scene, start: str | None = None) -> Scene:
    """Return the scene of the coordinates that are not ignorable, for the constant momenta of one start.

    The momenta become parameters, so that ``with_parameters(p_phi=…)`` looks at other ones. The ignored coordinates
    follow by quadrature, :meth:`canon.mechanics.reduction.routh.Routhian.quadrature_at`.

    Parameters
    ----------
    scene
        A scene without constraints.
    start
        The start whose momenta to take; the first one unless given.

    Raises
    ------
    SceneError
        Where no coordinate is ignorable, or constraints act.

    Examples
    --------
    >>> from canon.scene import find
    >>> bob = reduced(find("spherical-pendulum"))
    >>> bob.coordinates, bob.lagrangian.L
    ('theta', g*l*m*cos(theta) + l**2*m*theta_dot**2/2 - p_phi**2/(2*l**2*m*sin(theta)**2))
    """
    from canon.expression.symbols.symbol import parameters
    from canon.mechanics.reduction.ignorable import ignorable_coordinates
    from canon.mechanics.reduction.routh import routhian

    if scene.is_constrained:
        raise SceneError(f"{scene.name} has constraints; eliminate them before coordinates are ignored")
    ignored = ignorable_coordinates(scene.lagrangian)
    if not ignored:
        raise SceneError(f"no coordinate of {scene.name} is ignorable, so nothing can be left out")
    names = [s.momentum.name for s in scene.q if s in ignored]
    found = routhian(
        scene.lagrangian, [s for s in scene.q if s in ignored], [parameters(name) for name in names]
    )
    chosen = scene.start(start)
    n, state = len(scene.q), scene.state(chosen)
    kept = [i for i, s in enumerate(scene.q) if s not in ignored]
    constant = [
        Parameter(s.momentum.name, float(state[n + i]), "", f"constant momentum of {s}", sign="real")
        for i, s in enumerate(scene.q)
        if s in ignored
    ]
    return replace(
        scene,
        name=f"{scene.name}-reduced",
        title=f"{scene.title}; {found.note}",
        coordinates=" ".join(scene.q[i].name for i in kept),
        angles=" ".join(scene.q[i].name for i in kept if scene.q[i].name in scene.angles.split()),
        parameters=(*scene.parameters, *constant),
        starts=(
            Start(
                chosen.name,
                chosen.about,
                tuple(state[i] for i in kept),
                p=tuple(state[n + i] for i in kept),
            ),
        ),
        L_of=lambda _: found.lagrangian.L,
        H_of=None,
        bodies_of=None,
        V_of=None,
        forces_of=(lambda _: found.forces) if any(Q != 0 for Q in found.forces) else None,
        integrals=(),
        solutions=(),
        picture_of=None,
    )
