"""Assertions for notebooks and tests: passed where a claim is proved, else one sentence says why it is wrong."""

from __future__ import annotations

import atexit
import os
from collections.abc import Mapping
from decimal import Decimal
from functools import cache
from typing import TYPE_CHECKING, Any

from canon.exercise.judging_process import Worker
from canon.exercise.sheet.sheet import DEFAULT_BUDGET, SheetError, claim_from
from canon.expression.symbols.input_in_words import of_sympy
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from canon.exercise.report.judgement import Judgement

__all__ = ["expect"]


def expect(kind: str, /, *, budget: float = DEFAULT_BUDGET, **keys: Any) -> None:
    """Assert that a claim holds; for cells that grade a notebook, and for tests.

    Parameters
    ----------
    kind
        The kind of claim, such as ``"euler-lagrange"``.
    budget
        Seconds that the judgement may take; it runs in a process of its own, which is killed then.
    keys
        The keys of that kind. An expression may be text of the language or LaTeX, a SymPy expression or equation
        (with coordinates of canon's or ``dynamicsymbols``), or a number.

    Raises
    ------
    AssertionError
        Where the claim is wrong, with one sentence that says where; or where an expression can't be read.
    Undecided
        Where the claim was neither proved nor refuted.
    SheetError
        Where the keys are not those of the kind.

    Examples
    --------
    >>> pendulum = {"q": ["theta"], "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
    ...             "parameters": {"m": "positive", "g": "positive", "l": "positive"}}
    >>> expect("euler-lagrange", **pendulum, claim=["theta'' + g/l*sin(theta) = 0"])
    >>> expect("euler-lagrange", **pendulum, claim=["theta'' + g/l*cos(theta) = 0"])
    Traceback (most recent call last):
        ...
    AssertionError: in equation 1 cos(theta) should be sin(theta)
    """
    __tracebackhide__ = True  # pytest shows the test that asks, not this line
    names = keys.get("q", [])
    q = [name for name in (names if isinstance(names, list | tuple) else [names]) if isinstance(name, str)]
    said = {key: _written(value, q) for key, value in keys.items()}
    claim = claim_from({"id": "answer", **said, "kind": kind, "budget": Decimal(str(budget))})
    if claim.errors:
        raise SheetError("; ".join(error.brief for error in claim.errors))
    judgement = _worker(os.getpid()).judge(claim)
    if judgement.status == "undecided":
        raise Undecided(f"neither proved nor refuted: {judgement.known}")
    if judgement.status != "holds":
        raise AssertionError(_sentence(judgement))


def _sentence(judgement: Judgement) -> str:
    """Return the feedback, or where there is none the point at which the claim is wrong."""
    if judgement.status == "invalid":
        return judgement.known
    return judgement.feedback or ", ".join(judgement.reasons[:2])


@cache
def _worker(pid: int) -> Worker:  # noqa: ARG001
    """Return the worker of this process; a forked child gets one of its own."""
    worker = Worker()
    atexit.register(worker.stop)
    return worker


def _written(value: Any, q: list[str]) -> Any:
    """Return a value as a sheet would hold it."""
    if of_sympy(value):
        return _written_by_sympy(value, q)
    if isinstance(value, Mapping):
        return {str(name): _written(item, q) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_written(item, q) for item in value]
    if isinstance(value, bool | int | str):
        return value
    return str(value)


def _written_by_sympy(value: Any, q: list[str]) -> Any:
    import sympy as sp
    from sympy.core.function import AppliedUndef

    from canon.expression.symbols.symbol import coordinates
    from canon.mechanics.algebra.dynamicsymbols import plain

    if isinstance(value, sp.Equality):
        return f"{_written(value.lhs, q)} = {_written(value.rhs, q)}"
    if isinstance(value, sp.MatrixBase):
        return [_written(item, q) for item in value]
    if isinstance(value, sp.Expr):
        clocked = q and value.has(AppliedUndef)
        return str(plain(value, [coordinates(name) for name in q]) if clocked else value)
    if isinstance(value, sp.And | sp.Or):
        return f"{type(value).__name__}({', '.join(_written(each, q) for each in value.args)})"
    return str(value)
