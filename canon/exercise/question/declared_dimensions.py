"""Dimensions that a sheet declares of the quantities of a claim, and what follows from them: rates and momenta.

With an action of the dimension [L] [t] or [H] [t], p = ∂L/∂q̇ and q̇ = ∂H/∂p have [p] = [L] [t]/[q] (H. Goldstein,
C. Poole, J. Safko, Classical Mechanics, 3rd ed., §§2.6, 8.1). What is given and contradicts the declaration is told.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.question.expression_dimension import analysed, dimension_of
from canon.exercise.sheet.kind import Shape
from canon.exercise.sheet.quantities.dimension_texts import TIME, Dimension, DimensionError, dimension_from
from canon.expression.symbols.symbol import Coordinate

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from sympy import Expr

    from canon.exercise.sheet.reading import Reading

__all__ = ["declared_dimensions"]

KEY = "dimensions"


def declared_dimensions(reading: Reading) -> dict[str, Dimension]:
    """Return the dimensions of a claim's symbols and functions by name, as far as they are known.

    Parameters
    ----------
    reading
        A claim, with or without ``dimensions``.

    Raises
    ------
    InvalidClaim
        Where a text is no dimension, a name is not declared, or the declaration contradicts itself or what is given.

    Examples
    --------
    >>> from canon.exercise import Claim
    >>> from canon.exercise.sheet.reading import Reading
    >>> keys = {"q": ["x"], "p": ["p"], "L": "m*x_dot**2/2", "parameters": {"m": "positive"}}
    >>> keys["dimensions"] = {"m": "mass", "x": "length"}
    >>> known = declared_dimensions(Reading(Claim("a", "legendre-hamiltonian", keys)))
    >>> print(known["x_dot"], known["p"], known["t"])
    velocity momentum time
    """
    if not reading.has(KEY):
        return {}
    known = _written(reading)
    known.setdefault(reading.time.name, TIME)
    known |= _rates(reading, known)
    energy = None
    for key, function in _given(reading):
        _refuse_clash(reading, key, function, known)
        energy = energy or _dimension_of_terms(function, known)
    if energy is None:
        return known
    known |= _momenta(reading, known, energy * known[reading.time.name])
    for key, function in _given(reading):
        _refuse_clash(reading, key, function, known)
    return known


def _written(reading: Reading) -> dict[str, Dimension]:
    """Return what the table says."""
    found: dict[str, Dimension] = {}
    scope = reading.scope
    for name, text in reading.claim.keys[KEY].items():
        place = f"{KEY}.{name}"
        if name not in scope.names and name not in scope.functions and name != reading.time.name:
            if scope.symbol(name) is not None:
                reading.fault(place, "follows from that of its coordinate and of the time; leave it out")
            reading.fault(place, f"is not declared; {scope.near(name)}")
        try:
            found[name] = dimension_from(str(text))
        except DimensionError as error:
            reading.fault(place, str(error))
    return found


def _rates(reading: Reading, known: Mapping[str, Dimension]) -> dict[str, Dimension]:
    """Return the dimensions of velocities, accelerations and displacements."""
    found: dict[str, Dimension] = {}
    time = known[reading.time.name]
    for name, symbol in reading.scope.names.items():
        if name in known:
            found |= {f"d_{name}": known[name], f"delta_{name}": known[name]}
            if isinstance(symbol, Coordinate):
                found |= {f"{name}_dot": known[name] / time, f"{name}_ddot": known[name] / time / time}
    return {name: dimension for name, dimension in found.items() if name not in known}


def _given(reading: Reading) -> Iterator[tuple[str, Expr]]:
    """Yield the Lagrangian and Hamiltonian that the question gives."""
    for key in ("L", "H"):
        is_one = reading.kind.shapes.get(key) is Shape.TEXT
        if is_one and reading.has(key) and key not in reading.kind.answer:
            yield key, reading.expression(key)


def _dimension_of_terms(f: Expr, known: Mapping[str, Dimension]) -> Dimension | None:
    """Return the dimension of the first term of a sum that has one."""
    terms = (dimension_of(term, known) for term in sp.Add.make_args(f))
    return next((dimension for dimension in terms if dimension is not None), None)


def _momenta(reading: Reading, known: Mapping[str, Dimension], action: Dimension) -> dict[str, Dimension]:
    found: dict[str, Dimension] = {}
    for positions, conjugates in (("q", "p"), ("cyclic", "momenta")):
        if not (reading.is_names(positions) and reading.is_names(conjugates)):
            continue
        for x, p in zip(reading.words(positions), reading.words(conjugates), strict=False):
            if x not in known:
                continue
            wanted = action / known[x]
            if known.get(p, wanted) != wanted:
                why = f"{p} is declared as {known[p]}, and follows from L or H as {wanted}; mend one of them"
                reading.fault(f"{KEY}.{p}", why)
            found[p] = wanted
    return found


def _refuse_clash(reading: Reading, key: str, f: Expr, known: Mapping[str, Dimension]) -> None:
    """Refuse a declaration by which what is given is impossible."""
    clash = next(iter(analysed(f, known)), None)
    if clash is None:
        return
    shown: dict[Dimension, Expr] = {}
    for part, dimension in clash.parts:
        shown.setdefault(dimension, part)
    told = ", ".join(f"{part} is {dimension}" for dimension, part in shown.items())
    what = "the terms of a sum differ" if clash.is_of_a_sum else f"in {clash.node} a number is needed"
    reading.fault(KEY, f"in {key} that is given {what}: {told}; numbers have no dimension")
