"""File of a run: its record as arrays and JSON in one .npz archive, with a checksum over every byte.

The archive is NumPy's, so that other programs can look into it; the checksum, SHA-256 of all that stands before it, is
the archive's comment. Nothing of a file is executed when it is read: there are no pickles in it, and text is data.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import tempfile
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.record_data import record_data, record_from
from canon.version import __version__

if TYPE_CHECKING:
    import numpy.typing as npt

    from canon.flow.run_record import RunRecord

__all__ = ["read_record", "record_in", "write_record"]

_FORMAT = 1
"""Files of other versions of the format are refused."""

_LENGTH = 64
"""Letters of a checksum."""


def write_record(record: RunRecord, path: str | os.PathLike[str]) -> None:
    """Write a record to a file, which is there as a whole or not at all.

    Raises
    ------
    ValueError
        Something in it can't be kept exactly.
    OSError
        The file can't be written.
    """
    data, arrays = record_data(record)
    text = json.dumps({"canon motion": _FORMAT, "canon": __version__, **data}, allow_nan=False)
    stream = io.BytesIO()
    meaning: Any = {"meaning": np.frombuffer(text.encode(), dtype=np.uint8), **arrays}
    np.savez(stream, **meaning)
    with zipfile.ZipFile(stream, "a") as archive:
        archive.comment = b"0" * _LENGTH
    content = stream.getvalue()[:-_LENGTH]
    place = Path(path)
    handle, name = tempfile.mkstemp(dir=place.parent, prefix=f".{place.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content + _checksum(content))
        Path(name).replace(place)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def read_record(path: str | os.PathLike[str]) -> RunRecord:
    """Return the record that a file holds.

    Raises
    ------
    ValueError
        The file is damaged, is no motion's, or is of another version of the format.
    OSError
        The file can't be read.
    """
    return record_in(Path(path).read_bytes(), str(path))


def record_in(whole: bytes, path: str) -> RunRecord:
    """Return the record that the bytes of a file of that name hold.

    Raises
    ------
    ValueError
        As :func:`read_record`.
    """
    if whole[:2] != b"PK":
        raise ValueError(f"{path} holds no motion: give a file that motion.save(path) has written")
    if _checksum(whole[:-_LENGTH]) != whole[-_LENGTH:]:
        raise ValueError(
            f"{path} is damaged, or no file that motion.save(path) has written: its checksum is wrong. Take another "
            "copy, or compute the motion again"
        )
    try:
        with np.load(io.BytesIO(whole), allow_pickle=False) as archive:
            arrays: dict[str, npt.NDArray[Any]] = {name: archive[name] for name in archive.files}
        data: dict[str, Any] = json.loads(arrays.pop("meaning").tobytes())
        if data["canon motion"] == _FORMAT:
            return record_from(data, arrays)
    except (
        ArithmeticError,
        LookupError,
        TypeError,
        ValueError,
        AttributeError,
        zipfile.BadZipFile,
    ) as strange:
        raise ValueError(f"{path} holds no motion that canon has written ({strange!r})") from strange
    raise ValueError(
        f"{path} has format {data['canon motion']}, written by canon {data['canon']}; this canon {__version__} reads "
        f"format {_FORMAT}: read it with that version"
    )


def _checksum(content: bytes) -> bytes:
    return hashlib.sha256(content).hexdigest().encode()
