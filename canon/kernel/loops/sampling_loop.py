"""Sampling loop: states at many step numbers, and what is watched between them, copied in one call."""

from __future__ import annotations

import ctypes
import functools
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.llvm.writer import Writer

if TYPE_CHECKING:
    from canon.kernel.llvm.machine_code import MachineCode

__all__ = ["sampling_function", "watched_sampling_function"]

_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64
_SIGNATURE = (*[_POINTER] * 7, *[_INTEGER] * 4)
_PARAMETERS = ", ".join(
    (
        "ptr %advance, ptr %y, ptr %e, ptr %c, ptr noalias %stops, ptr noalias %kept_y, ptr noalias %kept_e",
        "i64 %samples, i64 %blocks, i64 %y_bytes, i64 %e_bytes",
    )
)
_WATCHED = ", ".join(
    (
        "ptr %follow, ptr noalias %record, ptr noalias %fresh, ptr noalias %kept_records",
        "i64 %cadence, i64 %record_bytes",
    )
)


@functools.cache
def sampling_function() -> MachineCode:
    """Compile ``sample(advance, y, e, c, stops, kept_y, kept_e, samples, blocks, y_bytes, e_bytes)``.

    It calls a loop's own machine code from one step number in ``stops`` to the next, so that the motion is bit for
    bit the one without it, and copies what y and e have there. ``stops`` has one number more than there are
    samples, the first is where the motion stands.
    """
    w = Writer(DOUBLE)
    with w.loop(0, "%samples") as k:
        begin, steps = _interval(w, k)
        w.line(f"call void %advance(ptr %y, ptr %e, ptr %c, i64 {begin}, i64 {steps}, i64 %blocks)")
        _keep_states(w, k)
    return compiled_function(w, "sample", _PARAMETERS, _SIGNATURE)


@functools.cache
def watched_sampling_function() -> MachineCode:
    """Compile the same with ``(…, follow, record, fresh, kept_records, cadence, record_bytes)`` behind its arguments.

    ``follow`` is a :func:`canon.kernel.loops.statistics_loop.statistics_function`. What its ``record`` has at a stop
    is copied, and ``fresh`` is put in its place.
    """
    w = Writer(DOUBLE)
    with w.loop(0, "%samples") as k:
        begin, steps = _interval(w, k)
        orbit = "ptr %advance, ptr %y, ptr %e, ptr %c"
        w.line(
            f"call void %follow({orbit}, i64 {begin}, i64 {steps}, i64 %blocks, i64 %cadence, ptr %record)"
        )
        _keep_states(w, k)
        _copy(w, "%record", _row(w, "%kept_records", k, "%record_bytes"), "%record_bytes")
        _copy(w, "%fresh", "%record", "%record_bytes")
    signature = (*_SIGNATURE, *[_POINTER] * 4, *[_INTEGER] * 2)
    return compiled_function(w, "sample_watched", f"{_PARAMETERS}, {_WATCHED}", signature)


def _interval(w: Writer, k: str) -> tuple[str, str]:
    """Load the step number at which the motion stands, and count the steps to the next stop."""
    begin, end = (
        w.let(f"load i64, ptr {_at(w, 'i64', '%stops', place)}") for place in (k, w.let(f"add i64 {k}, 1"))
    )
    return begin, w.let(f"sub i64 {end}, {begin}")


def _keep_states(w: Writer, k: str) -> None:
    for source, target, size in (("%y", "%kept_y", "%y_bytes"), ("%e", "%kept_e", "%e_bytes")):
        _copy(w, source, _row(w, target, k, size), size)


def _copy(w: Writer, source: str, target: str, size: str) -> None:
    w.declarations.add("declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)")
    w.line(f"call void @llvm.memcpy.p0.p0.i64(ptr {target}, ptr {source}, i64 {size}, i1 false)")


def _row(w: Writer, array: str, k: str, size: str) -> str:
    return _at(w, "i8", array, w.let(f"mul i64 {k}, {size}"))


def _at(w: Writer, kind: str, array: str, place: str) -> str:
    return w.let(f"getelementptr {kind}, ptr {array}, i64 {place}")
