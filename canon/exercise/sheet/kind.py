"""A kind of claim as one value: its keys, its judge, where its answer stands and how a wrong one is explained."""

from __future__ import annotations

import enum
import importlib
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = ["BESIDE", "COMMON", "USUAL", "Kind", "Shape", "named_function"]


class Shape(enum.Enum):
    """What stands under a key."""

    TEXT = "an expression"
    TEXTS = "a list of expressions"
    NAMES = "a list of names"
    WORD = "a word"
    TRUE = "true"
    SWITCH = "true or false"
    NUMBER = "a number"
    ASSUMPTIONS = "a table {name = assumption}"
    DIMENSIONS = "a table {name = dimension}"
    FUNCTIONS = "a table {function = [arguments]}"
    BOX = "a table {name = [lo, hi]}"
    EXPRESSIONS = "a table {name = expression}"
    LISTS = "a table of lists of expressions"
    BRACKETS = "a list of tables, each with three expressions"
    BODIES = "a list of tables {m, r, I, angle, omega}"
    FORCES = "a list of tables {F, r}, {torque, angle} or {torque, omega}"
    WORDS = "a list of words"
    VALUES = "a list of tables {name = expression}"


COMMON: Mapping[str, Shape] = MappingProxyType(
    {
        "id": Shape.WORD,
        "kind": Shape.WORD,
        "title": Shape.WORD,
        "source": Shape.WORD,
        "t": Shape.WORD,
        "expect": Shape.WORD,
        "parameters": Shape.ASSUMPTIONS,
        "functions": Shape.FUNCTIONS,
        "domain": Shape.TEXTS,
        "box": Shape.BOX,
        "budget": Shape.NUMBER,
        "implicit_multiplication": Shape.TRUE,
        "complete": Shape.SWITCH,
        "in": Shape.NAMES,
        "points": Shape.NUMBER,
        "partial": Shape.SWITCH,
        "dimensions": Shape.DIMENSIONS,
    }
)
"""Keys that every claim may have."""

BESIDE = frozenset(("id", "title", "source", "expect", "budget", "points"))
"""Keys that say nothing of what is claimed: the verdict does not depend on them."""

USUAL = (
    "convention.opposite_sign",
    "derivation.multipliers",
    "derivation.total_derivative",
    "changed_claims.another_reading",
    "components.part_by_part",
    "changed_claims.only_where",
    "one_change.anywhere",
    "changed_claims.only_for",
    "asymptotic.right_to_an_order",
    "changed_claims.right_where",
)
"""What is tried on a wrong answer of any kind, in this order."""


@dataclass(frozen=True)
class Kind:
    """One kind of claim.

    Functions are named as text, since a sheet is read without SymPy; each takes the claim that was read.

    Parameters
    ----------
    judge
        What the claim comes down to: module and function in :mod:`canon.exercise.judges`.
    required, optional
        Shape of each key.
    one_of
        Alternatives: at least one whole group of keys must be there.
    exclusive
        Whether the alternatives say the same thing, so that only one of them can be there.
    ways
        Groups of keys that say the same thing in other ways: those of one group are there, and none of another.
    answer
        The keys where the answer stands; all others say what is asked.
    claimed_too
        Keys of what is claimed together with the answer.
    components
        Keys of lists that hold components, where others have equations.
    several
        Keys of lists that hold values in any order, of which ``±`` is two.
    unknowns
        What a complete answer determines.
    implied
        What the name of the kind says already, such as the type of a generating function.
    about
        The kinds of the claim inside, named under ``of``, where the claim is about another one.
    complex_names
        Keys whose names stand for complex variables: of a real one |s|² is s², and would pass for a polynomial.
    following
        Keys whose names stand for what follows from other variables and can't be chosen freely.
    dependent
        Keys of names that depend on other names in a way that is not written: derivatives of them are asked about.
    independent
        Whether a derivative of one symbol by another is plainly 0, as in brackets.
    two_sided
        Whether what is claimed is that two sides are the same, in symbols that are all alike.
    varying
        Keys whose expressions say nothing where they do not depend on the variables.
    quadratures
        Keys of functions that may hold integrals over a coordinate without limits.
    derived
        Whether what is compared are derivatives of the answer, so that a component is no answer to tell.
    repaired
        Keys in which one change is tried, where the claim is judged as a whole; ``map.P`` is P in the table map.
    screen
        What tells wrong answers from values at points: a function in
        :mod:`canon.exercise.diagnose.repairs.screen_tests`.
    rereadings
        Other claims of the same formulas that may have been meant, in :mod:`canon.exercise.diagnose.rereadings`.
    opposite
        The sign convention of the kind; every component has the opposite sign under another one.
    diagnoses
        What is tried on a wrong answer, one after the other: modules and functions in :mod:`canon.exercise.diagnose`.
    """

    judge: str
    required: Mapping[str, Shape]
    optional: Mapping[str, Shape] = field(default_factory=lambda: MappingProxyType({}))
    one_of: tuple[tuple[str, ...], ...] = ()
    exclusive: bool = False
    ways: tuple[tuple[str, ...], ...] = ()
    answer: tuple[str, ...] = ()
    components: tuple[str, ...] = ()
    several: tuple[str, ...] = ()
    unknowns: str = ""
    claimed_too: tuple[str, ...] = ()
    implied: Mapping[str, int] = field(default_factory=lambda: MappingProxyType({}))
    about: tuple[str, ...] = ()
    complex_names: tuple[str, ...] = ()
    following: tuple[str, ...] = ("momenta", "multipliers")
    dependent: tuple[str, ...] = ()
    independent: bool = False
    two_sided: bool = False
    varying: tuple[str, ...] = ()
    quadratures: tuple[str, ...] = ()
    derived: bool = False
    repaired: tuple[str, ...] = ()
    screen: str = ""
    rereadings: tuple[str, ...] = ()
    opposite: str = ""
    diagnoses: tuple[str, ...] = USUAL

    @property
    def shapes(self) -> dict[str, Shape]:
        """The shape of every key, required or not."""
        return {**self.required, **self.optional}


def named_function(place: str, name: str) -> Callable[..., Any]:
    """Return the function that a kind names, such as ``lagrangian.routhian`` in ``canon.exercise.judges``.

    Examples
    --------
    >>> named_function("canon.exercise.judges", "lagrangian.routhian").__name__
    'routhian'
    """
    module, _, function = name.rpartition(".")
    return getattr(importlib.import_module(f"{place}.{module}" if module else place), function)
