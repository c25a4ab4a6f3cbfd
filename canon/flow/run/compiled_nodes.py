"""Compiled nodes: functions of the state on a graph, such as the rates, as one compiled function of t and y."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.kernel.llvm.loop import field_function

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["CompiledNodes", "compiled_nodes"]


@dataclass(frozen=True, eq=False)
class CompiledNodes:
    """Nodes as a compiled function of t and y in doubles, and how long compiling took."""

    call: Callable[[float, Array], Array]
    seconds: float


def compiled_nodes(system: HamiltonEquations, nodes: Sequence[int]) -> CompiledNodes:
    """Return nodes as a compiled function of t and y, which several threads may call at once."""
    code, inputs, outputs = field_function(system.program(nodes)), len(system.inputs), len(nodes)

    def values(t: float, y: Array) -> Array:
        x, out = np.empty(inputs), np.empty(outputs)
        x[:-1], x[-1] = y, t
        code.call(x.ctypes.data, out.ctypes.data)
        return out

    return CompiledNodes(values, code.seconds)
