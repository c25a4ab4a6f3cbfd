"""Motions read from files: what ``motion.save(path)`` has written, ready to be read and to go on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.flow.record_file import read_record
from canon.flow.trajectory import trajectory_of

if TYPE_CHECKING:
    import os

    from canon.flow.trajectory import Trajectory

__all__ = ["load_motion"]


def load_motion(path: str | os.PathLike[str]) -> Trajectory:
    """Return the motion that :meth:`canon.flow.Trajectory.save` has written to a file.

    It has the same numbers, bit for bit, and ``resume`` goes on with the bits of a run that was never saved, on the
    same kind of machine. Nothing in the file is executed.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    ValueError
        The file is damaged, holds no motion, or was written by a version of canon with another format.
    OSError
        The file can't be read.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> from canon import load_motion, propagate
    >>> motion = propagate("kepler", (0, 10), method="kahan-li-8", step=0.125)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     motion.save(pathlib.Path(folder) / "kepler.npz")
    ...     again = load_motion(pathlib.Path(folder) / "kepler.npz")
    >>> bool((again.y == motion.y).all()), bool((again.resume(20).y == motion.resume(20).y).all())
    (True, True)
    """
    return trajectory_of(read_record(path))
