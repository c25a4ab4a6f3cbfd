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

from canon.kernel.llvm.half_spills import may_spill_by_half
from canon.kernel.llvm.kept_code import kept_or_made

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

_OPTIONS = (
    "2: level 3, loops vectorized and unrolled, single numbers too in small modules, none spilled by half"
)
"""What :func:`object_code` does; kept code made with other words is not used."""

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
        Wall-clock time it took to optimize and compile, or to load what an earlier process had compiled.
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
        code = kept_or_made(f"{_compiler()}\n{ir}", lambda: object_code(ir, machine))
        engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        address = engine.get_function_address(function)
    call = ctypes.CFUNCTYPE(None, *arguments)(address)
    return MachineCode(call, address, time.perf_counter() - started, engine)


def object_code(ir: str, machine: binding.TargetMachine) -> bytes:
    """Optimize and compile a module for a processor, and return the object file."""
    return machine.emit_object(optimized(ir, machine))


def optimized(ir: str, machine: binding.TargetMachine) -> binding.ModuleRef:
    """Return a module as LLVM has optimized it for a processor."""
    if len(ir) < _LARGE:
        module = _optimized(ir, machine, parallel=True)
        if not may_spill_by_half(str(module)):
            return module
    return _optimized(ir, machine, parallel=False)


def _optimized(ir: str, machine: binding.TargetMachine, *, parallel: bool) -> binding.ModuleRef:
    """Optimize a module; ``parallel`` where single numbers are to be computed side by side."""
    import llvmlite.binding as llvm

    module = llvm.parse_assembly(ir)
    module.verify()
    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    tuning.loop_vectorization = tuning.loop_unrolling = True
    tuning.slp_vectorization = parallel
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(module, builder)
    return module


@functools.cache
def _compiler() -> str:
    """Return what code depends on beside its program: the compiler, how it is told to work, and the processor."""
    import llvmlite
    import llvmlite.binding as llvm

    processor = llvm.get_default_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
    return "\n".join((_OPTIONS, llvmlite.__version__, str(llvm.llvm_version_info), *processor))


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
