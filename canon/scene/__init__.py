"""Ready systems, one small file a family; each is data plus its known truths.

A scene is written by filling in :class:`Scene` in the file of its family and naming it in that file's ``SCENES``. It
says what it is (parameters with units and real values, starts), how it moves (``L_of``, ``H_of`` or ``bodies_of`` and
``V_of``, with ``forces_of``, ``holonomic_of``, ``nonholonomic_of``), what is known of it (``integrals``, ``solutions``,
with sources) and what it looks like (``picture_of``). :func:`canon.scene.known_truths.check` holds it to that.

>>> from canon.scene import find, names
>>> find("henon-heiles").title
'Hénon–Heiles: a star in the meridian plane of a galaxy'
>>> len(names()) > 10
True
"""

from __future__ import annotations

from canon.scene.scene import Condition, Integral, Parameter, Scene, SceneError, Solution, Start, near
from canon.scene.systems import (
    bead,
    bodies,
    celestial,
    charge,
    control,
    driven,
    first_kind,
    henon_heiles,
    incline,
    kepler,
    lattice,
    manipulator,
    motor,
    nonholonomic,
    orbit,
    oscillator,
    pendulum,
    piston,
    piston_joints,
    rotating,
    swinging_atwood,
    top,
    triple,
    two_degree,
    two_waves,
)

__all__ = [
    "SCENES", "Condition", "Integral", "Parameter", "Scene", "SceneError", "Solution", "Start", "find", "names",
]  # fmt: skip

SCENES: tuple[Scene, ...] = (
    *pendulum.SCENES,
    *oscillator.SCENES,
    *kepler.SCENES,
    *bodies.SCENES,
    *henon_heiles.SCENES,
    *two_degree.SCENES,
    *lattice.SCENES,
    *triple.SCENES,
    *swinging_atwood.SCENES,
    *top.SCENES,
    *rotating.SCENES,
    *celestial.SCENES,
    *nonholonomic.SCENES,
    *orbit.SCENES,
    *first_kind.SCENES,
    *incline.SCENES,
    *piston.SCENES,
    *piston_joints.SCENES,
    *bead.SCENES,
    *control.SCENES,
    *motor.SCENES,
    *manipulator.SCENES,
    *driven.SCENES,
    *two_waves.SCENES,
    *charge.SCENES,
)
"""Every scene."""


def names() -> tuple[str, ...]:
    """Return the names of all scenes."""
    return tuple(scene.name for scene in SCENES)


def find(name: str) -> Scene:
    """Return the scene of that name.

    Raises
    ------
    SceneError
        With near matches, where there is none.

    Examples
    --------
    >>> find("kepler").coordinates
    'x y'
    >>> find("double-pendulm")
    Traceback (most recent call last):
    canon.scene.parts.SceneError: there is no scene 'double-pendulm'; did you mean double-pendulum ...
    """
    wanted = name.strip().lower().replace("_", "-").replace(" ", "-")
    for scene in SCENES:
        if scene.name == wanted:
            return scene
    raise SceneError(f"there is no scene {name!r}{near(wanted, names())}")
