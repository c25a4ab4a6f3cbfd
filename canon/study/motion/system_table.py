"""Systems of study files: a table [system.NAME] with a Hamiltonian, or a Lagrangian with forces and constraints."""

from __future__ import annotations

import reprlib
from typing import TYPE_CHECKING, Any

from canon.study.errors import StudyError
from canon.study.motion.hamiltonian_text import (
    LONGEST_NAME,
    MOST_NAMES,
    entries_of,
    formula_from,
    names_of,
    number_of,
    require_labels,
    scope_of,
)
from canon.study.motion.system_text import system_text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from sympy import Expr

    from canon.study.motion.hamiltonian_text import Formula
    from canon.study.motion.system_text import SystemText

__all__ = ["system_from"]

KEYS = ("L", "q", "forces", "dissipation", "holonomic", "nonholonomic", "parameters", "starts", "period")
"""What a table in a file may say of a Lagrangian."""


def system_from(name: str, table: Mapping[str, Any]) -> Formula | SystemText:
    """Return the system that a table of a study file describes: by ``H``, or by ``L``.

    Parameters
    ----------
    name
        What it is called there.
    table
        With ``H``: as :func:`canon.study.motion.hamiltonian_text.formula_from` reads it. With ``L``, a function of q,
        ``<coordinate>_dot`` and ``t``: ``q``; ``forces``, one a coordinate; Rayleigh's ``dissipation``;
        ``holonomic`` and ``nonholonomic`` constraints, each = 0; ``parameters``, ``starts`` (q, q̇) and ``period`` where
        there are any.

    Raises
    ------
    StudyError
        Where a key is missing, unknown or of the wrong kind, or an expression can't be read or makes no Lagrangian.

    Examples
    --------
    >>> damped = {"L": "x_dot**2/2 - k*x**2/2", "q": "x", "forces": ["-x_dot/10"], "parameters": {"k": 4}}
    >>> system_from("spring", damped).variables
    ('x', 'x_dot')
    """
    if not ("L" in table or {*table} & {"forces", "dissipation", "holonomic", "nonholonomic"}):
        return formula_from(name, table)
    require_labels(name)
    if unknown := sorted(set(table) - set(KEYS)):
        raise StudyError(
            f"system {name}: unknown key {unknown[0][:LONGEST_NAME]!r}; beside L there are {', '.join(KEYS[1:])}"
        )
    for key in ("L", "q"):
        if key not in table:
            raise StudyError(f"system {name}: {key!r} is missing")
    try:
        return _of_lagrangian(name, table)
    except StudyError:
        raise
    except (TypeError, OverflowError, ValueError) as error:
        raise StudyError(f"system {name}: {str(error)[:500]}") from error


def _of_lagrangian(name: str, table: Mapping[str, Any]) -> SystemText:
    from canon.expression.symbols.symbol import Coordinate, parameters
    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    from canon.mechanics.lagrange.lagrangian import Lagrangian

    given = {key: number_of(x) for key, x in entries_of(table.get("parameters", {}), "parameters").items()}
    starts = entries_of(table.get("starts", {}), "starts")
    period = table.get("period")
    names = names_of(table["q"])
    if len(names) + len(given) > MOST_NAMES:
        raise StudyError(f"{name}: more than {MOST_NAMES} names; write larger systems in Python")
    q = [Coordinate(each, real=True) for each in names]
    read = _reader(name, scope_of((*q, *(parameters(each) for each in given))))
    L, dissipation = read("L", table["L"]), read("dissipation", table.get("dissipation", "0"))
    lagrangian = Lagrangian(L, q, _listed(table, "forces", read), dissipation=dissipation)
    bound = [_listed(table, key, read) for key in ("holonomic", "nonholonomic")]
    return system_text(
        ConstrainedLagrangian(lagrangian, *bound) if any(bound) else lagrangian,
        name,
        parameters=given,
        starts={key: _state(state) for key, state in starts.items()},
        period=None if period is None else number_of(period),
    )


def _reader(name: str, scope: Any) -> Callable[[str, Any], Expr]:
    """Return what reads the text of a key."""
    from canon.expression.parse import LanguageError, parse_expression

    def read(key: str, text: Any) -> Expr:
        if not isinstance(text, str):
            raise TypeError(f"{key} is text in quotation marks, not {reprlib.repr(text)}")
        try:
            return parse_expression(text, scope)
        except LanguageError as error:
            raise StudyError(f"system {name}, {key}: {error}") from error

    return read


def _listed(table: Mapping[str, Any], key: str, read: Callable[[str, Any], Expr]) -> list[Expr]:
    """Return the expressions of a key that has one text or a list of them."""
    texts = table.get(key, [])
    return [read(key, text) for text in (texts if isinstance(texts, list | tuple) else [texts])]


def _state(written: Any) -> tuple[float, ...]:
    if not isinstance(written, list | tuple):
        raise TypeError(f"a start is a list of numbers (q, q̇), not {reprlib.repr(written)}")
    return tuple(map(number_of, written))
