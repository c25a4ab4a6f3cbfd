"""Proof process: a child process for heavy proofs, which can be killed at any time.

A message is a pickle of expressions, their domain and the seconds for the proof; so is its answer.
"""

from __future__ import annotations

import pickle
import time
from typing import TYPE_CHECKING, cast

from canon.process import serve

if TYPE_CHECKING:
    from sympy import Expr

    from canon.proof.domain.domain import Domain
    from canon.proof.rungs.ladder import Attempt

__all__ = ["main"]

MEMORY = 4 * 2**30
"""Bytes of address space, where the system lets it be limited."""


class _NotImportable(Exception):
    """A class in a message is neither canon's nor of what canon rests on."""


def main() -> None:
    """Answer requests until the input ends."""
    from canon.proof.domain.limits import THOROUGH
    from canon.proof.rungs.ladder import prove_each

    def attempts(message: bytes) -> list[Attempt] | str:
        try:
            exprs, domain, seconds = _request(message)
            return prove_each(exprs, domain, time.monotonic() + seconds, THOROUGH)
        except _NotImportable:
            return (
                "it holds classes of the program that asks, which the process of the proofs does not import"
            )
        except MemoryError:
            return "the proof needs more memory than it may have"
        except RecursionError:
            return "the expression is nested too deeply"

    serve(lambda message: [pickle.dumps(attempts(message), protocol=pickle.HIGHEST_PROTOCOL)], MEMORY)


def _request(message: bytes) -> tuple[tuple[Expr, ...], Domain, float]:
    try:
        return cast("tuple[tuple[Expr, ...], Domain, float]", pickle.loads(message))
    except (ImportError, AttributeError) as reason:
        raise _NotImportable from reason
