"""Programs that LLVM's register allocator may spill by half, found before machine code is made of them.

A vector of numbers and its first number can go round a loop side by side, as two ``phi``: the search for parallel
scalars (SLP) leaves such pairs. On x86 both live in one register, which is merged of them; where registers run short,
the number's eight bytes are all that is stored, and the vector comes back with zeros in its other lanes (LLVM 22, seen
with ``SemiexplicitSplitting`` on processors with sixteen registers: the first step was off by 0.2, without a word).
"""

from __future__ import annotations

import re

__all__ = ["may_spill_by_half"]

_PHI = re.compile(r"\s+(\S+) = phi (?:[a-z]+ )*(<\d+ x \w+>|\w+) (\[.*)")
_EDGE = re.compile(r"\[ (.+?), (%[^\]]+?) \]")
_FIRST = re.compile(r"\s+(\S+) = extractelement <\d+ x \w+> (\S+), i\d+ 0\b")


def may_spill_by_half(program: str) -> bool:
    r"""Return whether in some loop of a program a vector and its first number go round side by side.

    Parameters
    ----------
    program
        A module in LLVM's textual form, as the optimizer leaves it.

    Examples
    --------
    >>> vector = "  %v = phi <2 x double> [ %a, %entry ], [ %b, %loop ]"
    >>> number = "  %s = phi double [ 0.0, %entry ], [ %b0, %loop ]"
    >>> taken = "  %b0 = extractelement <2 x double> %b, i64 0"
    >>> may_spill_by_half("\n".join(["loop:", vector, number, taken]))
    True
    >>> may_spill_by_half("\n".join(["loop:", vector, taken]))
    False
    """
    return any(_in_function(function) for function in re.split(r"(?m)^define ", program))


def _in_function(body: str) -> bool:
    firsts = {found[1]: found[2] for found in map(_FIRST.match, body.splitlines()) if found}
    if not firsts:
        return False
    for block in re.split(r"(?m)^\S.*:", body):
        vectors: set[tuple[str, str]] = set()
        numbers: set[tuple[str, str]] = set()
        for _, kind, edges in (found.groups() for found in map(_PHI.match, block.splitlines()) if found):
            (vectors if kind.startswith("<") else numbers).update(_EDGE.findall(edges))
        if any((firsts.get(value), edge) in vectors for value, edge in numbers):
            return True
    return False
