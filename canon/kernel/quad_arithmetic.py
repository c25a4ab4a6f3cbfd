"""Quad precision as an arithmetic of expression graphs: numbers of 113 bits in NumPy arrays, by heyoka."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import NOT_IN_NUMPY, Arithmetic, numpy_functions, written_constant
from canon.kernel.heyoka_bridge import heyoka_number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.expression.graph.graph import Graph

__all__ = ["quad_arithmetic", "quad_array", "quad_for"]


@functools.cache
def quad_arithmetic() -> Arithmetic | None:
    """Return arithmetic with heyoka's numbers of 113 bits, single or in arrays; None where heyoka has none.

    An energy takes a small part of what it takes by mpmath in 40 digits (``benchmarks/preparation.py``).
    """
    import heyoka as hy

    if not hasattr(hy, "real128"):
        return None
    number = functools.lru_cache(maxsize=4096)(heyoka_number("quad"))
    return Arithmetic(
        name="113 bits",
        digits=34,
        number=number,
        named=lambda name: hy.real128(written_constant(name)),
        root=np.sqrt,
        functions=numpy_functions(),
    )


def quad_for(graph: Graph, nodes: Sequence[int]) -> Arithmetic | None:
    """Return that arithmetic where all functions in some nodes are known to it."""
    found = quad_arithmetic()
    if found is None or any(graph.nodes[node].kind in NOT_IN_NUMPY for node in graph.reachable(nodes)):
        return None
    return found


def quad_array(high: Any, low: Any) -> Any:
    """Return sums of two doubles in 113 bits, as an array.

    Examples
    --------
    >>> float(quad_array(np.array([0.1]), np.array([2.0**-110]))[0] - 0.1) == 2.0**-110
    True
    """
    import heyoka as hy

    return high.astype(hy.real128) + low.astype(hy.real128)
