"""LLVM IR text to machine code in this process, through llvmlite; no compiler on the user's machine.

No fast-math and no contraction: every operation is the IEEE operation the program names, so results do not
depend on the optimizer. libm functions are handed to the linker by address, from the platform's own maths
library (libm on Linux, libSystem on macOS, the C runtime on Windows).
"""

from __future__ import annotations

import ctypes
import ctypes.util
import functools
import os
import sys
import threading
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    import llvmlite.binding as binding

__all__ = ["MachineCode", "compiled", "simd_bytes"]

_COMPILING = threading.Lock()
if hasattr(
    os, "register_at_fork"
):  # a child of a fork in the middle of a compilation would wait for it for ever
    os.register_at_fork(
        before=_COMPILING.acquire, after_in_parent=_COMPILING.release, after_in_child=_COMPILING.release
    )

_LARGE = 200_000
"""Above this size of a module the search for parallel scalars (SLP) takes longer than it saves."""


@dataclass(frozen=True)
class MachineCode:
    """Machine code of one function, compiled by LLVM.

    Parameters
    ----------
    call
        The function as a ctypes callable; it releases the interpreter lock while it runs.
    address
        Its address, for other compiled code to call.
    seconds
        Wall-clock time it took to optimize and compile.
    engine
        What owns the machine code: it lives as long as this object.
    """

    call: Any
    address: int
    seconds: float
    engine: Any


def compiled(ir: str, function: str, arguments: Sequence[Any], libm: Sequence[str] = ()) -> MachineCode:
    """Return the machine code of a function given as LLVM IR text.

    Parameters
    ----------
    ir
        A module in LLVM's textual form.
    function
        The name of the function in it; it returns nothing.
    arguments
        The ctypes types of its arguments.
    libm
        The libm functions the module calls, by their names in the library.

    Raises
    ------
    OSError
        The platform's maths library lacks one of those functions.
    """
    import llvmlite.binding as llvm

    started = time.perf_counter()
    with _COMPILING:
        machine = _target_machine()
        for name in libm:
            llvm.add_symbol(name, _address(name))
        module = llvm.parse_assembly(ir)
        module.verify()
        tuning = llvm.create_pipeline_tuning_options(speed_level=3)
        tuning.loop_vectorization = tuning.loop_unrolling = True
        tuning.slp_vectorization = len(ir) < _LARGE
        builder = llvm.create_pass_builder(machine, tuning)
        builder.getModulePassManager().run(module, builder)
        engine = llvm.create_mcjit_compiler(module, machine)
        engine.finalize_object()
        address = engine.get_function_address(function)
    call = ctypes.CFUNCTYPE(None, *arguments)(address)
    return MachineCode(call, address, time.perf_counter() - started, engine)


@functools.cache
def simd_bytes() -> int:
    """Return how many bytes this processor's SIMD registers hold."""
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features()
    return 64 if features.get("avx512f") else 32 if features.get("avx") else 16


def _target_machine() -> binding.TargetMachine:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=3, jit=True
    )


@functools.cache
def _mathematics() -> ctypes.CDLL:
    if sys.platform == "win32":
        return ctypes.CDLL("ucrtbase")
    return ctypes.CDLL(ctypes.util.find_library("m") or "libm.so.6")


def _address(name: str) -> int:
    library = _mathematics()
    try:
        function = getattr(library, name)
    except AttributeError:
        raise OSError(
            f"the C maths library of this platform has no function {name!r}; use Taylor() or DOP853()"
        ) from None
    address = ctypes.cast(function, ctypes.c_void_p).value
    if address is None:
        raise OSError(
            f"the C maths library of this platform gives no address for {name!r}; use Taylor() or DOP853()"
        )
    return address
