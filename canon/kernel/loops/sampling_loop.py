"""Sampling loop: the states at many step numbers copied in one call, so that a sample costs no more than its copy."""

from __future__ import annotations

import ctypes
import functools
from typing import TYPE_CHECKING

from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.llvm.writer import Writer

if TYPE_CHECKING:
    from canon.kernel.llvm.machine_code import MachineCode

__all__ = ["sampling_function"]

_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64
_SIGNATURE = (*[_POINTER] * 7, *[_INTEGER] * 4)
_PARAMETERS = ", ".join(
    (
        "ptr %advance, ptr %y, ptr %e, ptr %c, ptr noalias %stops, ptr noalias %kept_y, ptr noalias %kept_e",
        "i64 %samples, i64 %blocks, i64 %y_bytes, i64 %e_bytes",
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
        begin, end = (
            w.let(f"load i64, ptr {_at(w, 'i64', '%stops', place)}")
            for place in (k, w.let(f"add i64 {k}, 1"))
        )
        steps = w.let(f"sub i64 {end}, {begin}")
        w.line(f"call void %advance(ptr %y, ptr %e, ptr %c, i64 {begin}, i64 {steps}, i64 %blocks)")
        for source, target, size in (("%y", "%kept_y", "%y_bytes"), ("%e", "%kept_e", "%e_bytes")):
            row = _at(w, "i8", target, w.let(f"mul i64 {k}, {size}"))
            w.line(f"call void @llvm.memcpy.p0.p0.i64(ptr {row}, ptr {source}, i64 {size}, i1 false)")
    w.declarations.add("declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)")
    return compiled_function(w, "sample", _PARAMETERS, _SIGNATURE)


def _at(w: Writer, kind: str, array: str, place: str) -> str:
    return w.let(f"getelementptr {kind}, ptr {array}, i64 {place}")
