"""Observables of a case besides the energy: constants by name, and functions of (q, p, t) as text."""

from __future__ import annotations

import reprlib
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.system.recognised_system import recognised
from canon.scene import find
from canon.study.errors import StudyError
from canon.study.motion.hamiltonian_text import Formula, require_labels, scope_of
from canon.study.motion.observables import ENERGY, SYMPLECTICITY, Observable, observables_of
from canon.study.motion.studied_motion import variables_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Expr, Symbol

    from canon.study.cases.case import Case

__all__ = ["followed", "observables_from", "read_formula"]


def observables_from(written: Any) -> tuple[tuple[str, str], ...]:
    """Return names and formulas of observables from what a study says; the energy, always judged, is left out.

    Parameters
    ----------
    written
        A name, or a list of names (formula empty) and of tables ``{ name = "formula" }``.

    Examples
    --------
    >>> observables_from(["energy", "momenta", {"area": "x*p_y - y*p_x"}])
    (('momenta', ''), ('area', 'x*p_y - y*p_x'))
    """
    found: dict[str, str] = {}
    for each in written if isinstance(written, list | tuple) else [written]:
        table = {each: ""} if isinstance(each, str) else each
        if not isinstance(table, dict) or not all(
            isinstance(part, str) for part in (*table, *table.values())
        ):
            shown = reprlib.repr(each)
            raise TypeError(f'an observable is a name or a table {{ name = "formula" }}, not {shown}')
        require_labels(*table)
        found.update(table)
    if SYMPLECTICITY in found:
        raise ValueError("studies do not follow the symplecticity; 'canon drift' does")
    return tuple((name, text) for name, text in found.items() if name != ENERGY)


@lru_cache(maxsize=64)
def followed(case: Case) -> tuple[Observable, ...]:
    """Return the observables of a case beside the energy.

    Raises
    ------
    StudyError
        Where there is no observable of a name, or a formula can't be read.
    """
    if not case.observables:
        return ()
    hamiltonian, y0 = case.hamiltonian, np.array(case.state)
    values: Mapping[Symbol | str, float] = {**case.values}
    named = [name for name, text in case.observables if not text]
    written = {
        name: read_formula(case, f"the observable {name!r}", text) for name, text in case.observables if text
    }
    system = find(case.system) if isinstance(case.system, str) else hamiltonian
    found = observables_of(system, hamiltonian, named, y0, values) if named else ()
    own = observables_of(system, hamiltonian, written, y0, values) if written else ()
    return (*found, *own)


def read_formula(case: Case, what: str, text: str) -> Expr:
    """Return a formula in the variables and parameters of a case, as an expression.

    Raises
    ------
    StudyError
        It can't be read; the error begins with what it is.
    """
    from canon.expression.parse import LanguageError, parse_expression
    from canon.expression.symbols.symbol import parameters

    constants: tuple[Symbol, ...]
    if isinstance(case.system, str):
        constants = tuple(find(case.system).values_by_symbol())
    elif isinstance(case.system, Formula):
        constants = tuple(parameters(constant) for constant, _ in case.system.parameters)
    else:
        moving = {symbol.name: symbol for symbol in recognised(case.hamiltonian).parameters}
        declared = (name for name, _ in case.system.parameters if name not in moving)
        constants = (*moving.values(), *(parameters(name) for name in declared))
    symbols = (*variables_of(case.hamiltonian)[0], *constants)
    try:
        return parse_expression(text, scope_of(symbols))
    except LanguageError as error:
        raise StudyError(f"{what}: {error}") from error
