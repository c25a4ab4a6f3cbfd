"""The kinds of claims: which keys each takes, and what shape they have."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["COMMON", "KINDS", "Kind", "Shape"]


class Shape(enum.Enum):
    """What stands under a key."""

    TEXT = "an expression"
    TEXTS = "a list of expressions"
    NAMES = "a list of names"
    WORD = "a word"
    TRUE = "true"
    NUMBER = "a number"
    ASSUMPTIONS = "a table {name = assumption}"
    FUNCTIONS = "a table {function = [arguments]}"
    BOX = "a table {name = [lo, hi]}"
    EXPRESSIONS = "a table {name = expression}"
    LISTS = "a table of lists of expressions"
    BRACKETS = "a list of tables, each with three expressions"
    BODIES = "a list of tables {m, r, I, angle, omega}"
    FORCES = "a list of tables {F, r}, {torque, angle} or {torque, omega}"
    WORDS = "a list of words"


@dataclass(frozen=True)
class Kind:
    """The keys of one kind of claim.

    Parameters
    ----------
    required, optional
        Shape of each key.
    one_of
        Alternatives: at least one whole group of keys must be there.
    exclusive
        Whether the alternatives say the same thing, so that only one of them can be there.
    """

    required: Mapping[str, Shape]
    optional: Mapping[str, Shape] = field(default_factory=lambda: MappingProxyType({}))
    one_of: tuple[tuple[str, ...], ...] = ()
    exclusive: bool = False


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
    }
)
"""Keys that every claim may have."""

_T, _TS, _N = Shape.TEXT, Shape.TEXTS, Shape.NAMES
_PHASE = {"q": _N, "p": _N}
_NEW = {"new_q": _N, "new_p": _N}
_LAGRANGE = {"q": _N, "L": _T}
_MAP_EITHER_WAY = {"map": Shape.LISTS, "inverse_map": Shape.LISTS}
_CANONICITY = Kind(
    _PHASE,
    {"Q": _TS, "P": _TS, "valence": _T, **_NEW, "implicit": _TS},
    one_of=(("Q", "P"), ("new_q", "new_p", "implicit")),
    exclusive=True,
)
_GENERATING = Kind({**_PHASE, **_NEW, "F": _T}, _MAP_EITHER_WAY, (("map",), ("inverse_map",)), exclusive=True)
_MOTION = {**_PHASE, "H": _T, "L": _T, "x": _N, "X": _TS}
_CONSTRAINED = Kind({**_LAGRANGE, "constraints": _TS, "multipliers": _N, "claim": _TS})

KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "euler-lagrange": Kind({**_LAGRANGE, "claim": _TS}),
        "dissipative": Kind(
            _LAGRANGE,
            {"F": _T, "Qnc": _TS, "claim": _TS, "energy_rate": _T},
            one_of=(("claim",), ("energy_rate",)),
        ),
        "multiplier-holonomic": _CONSTRAINED,
        "nonholonomic": _CONSTRAINED,
        "legendre-hamiltonian": Kind(
            {**_PHASE, "L": _T}, {"H": _T, "exists": Shape.TRUE}, one_of=(("H",), ("exists",))
        ),
        "hamilton-equations": Kind(
            {**_PHASE, "H": _T},
            {"q_dot": _TS, "p_dot": _TS, "solution": Shape.EXPRESSIONS},
            one_of=(("q_dot", "p_dot"), ("solution",)),
        ),
        "routhian": Kind(
            {**_LAGRANGE, "cyclic": _N, "momenta": _N, "convention": Shape.WORD},
            {"R": _T, "claim": _TS},
            one_of=(("R",), ("claim",)),
        ),
        "gibbs-appell": Kind(
            {"q": _N, "bodies": Shape.BODIES},
            {"quasi": _N, "q_dot": _TS, "V": _T, "S": _T, "claim": _TS},
            one_of=(("S",), ("claim",)),
        ),
        "poisson-bracket": Kind({**_PHASE, "pairs": Shape.BRACKETS}),
        "lagrange-bracket": Kind({"variables": _N, "q": _TS, "p": _TS, "pairs": Shape.BRACKETS}),
        "lie-bracket": Kind({"x": _N, "X": _TS, "Y": _TS, "claim": _TS}),
        "canonicity": _CANONICITY,
        "canonicity-time-dependent": _CANONICITY,
        "bilinear-covariant": Kind(
            {},
            {"x": _N, "form": _TS, "claim": _T, **_PHASE, "Q": _TS, "P": _TS, "factor": _T},
            one_of=(("x", "form", "claim"), ("q", "p", "Q", "P", "factor")),
            exclusive=True,
        ),
        "generating-F1": _GENERATING,
        "generating-F2": _GENERATING,
        "generating-F3": _GENERATING,
        "generating-F4": _GENERATING,
        "transformed-hamiltonian-K": Kind(
            {**_PHASE, "H": _T, **_NEW, "K": _T},
            _MAP_EITHER_WAY,
            one_of=(("map",), ("inverse_map",)),
            exclusive=True,
        ),
        "constant-of-motion": Kind(
            {"I": _T},
            {**_PHASE, "H": _T, "L": _T, "x": _N, "X": _TS, "restrict": _TS},
            one_of=(("q", "p", "H"), ("q", "L"), ("x", "X")),
            exclusive=True,
        ),
        "lagrangian-equivalence": Kind({"q": _N, "L1": _T, "L2": _T, "relation": Shape.WORD}, {"F": _T}),
        "equality-only": Kind({"lhs": _T, "rhs": _T}),
        "kinetic-energy": Kind({"q": _N, "bodies": Shape.BODIES, "T": _T}, {"constraints": _TS}),
        "generalized-force": Kind(
            {"q": _N, "Q": _TS},
            {"forces": Shape.FORCES, "work": _T, "power": _T, "V": _T},
            one_of=(("forces",), ("work",), ("power",), ("V",)),
        ),
        "constraint-class": Kind({"q": _N, "constraints": _TS, "class": Shape.WORDS}),
        "degrees-of-freedom": Kind({"q": _N, "dof": _T}, {"constraints": _TS, "counting": Shape.WORD}),
        "reaction": Kind(
            {**_LAGRANGE, "constraints": _TS, "multipliers": _N},
            {"Qnc": _TS, "integrals": _TS, "values": Shape.EXPRESSIONS, "force": _TS},
            one_of=(("values",), ("force",)),
        ),
        "leaving-condition": Kind(
            {**_LAGRANGE, "contact": _T, "leaves": _T},
            {"constraints": _TS, "Qnc": _TS, "integrals": _TS},
        ),
        "conserved-or-not": Kind(
            {},
            {**_MOTION, "conserved": _TS, "not_conserved": _TS, "Qnc": _TS},
            one_of=(("conserved",), ("not_conserved",)),
        ),
        "solution": Kind(
            {},
            {
                **_MOTION,
                "Qnc": _TS,
                "equations": _TS,
                "solution": Shape.EXPRESSIONS,
                "rates": Shape.EXPRESSIONS,
                "initial": Shape.EXPRESSIONS,
                "t0": _T,
                "constants": _N,
            },
            one_of=(("solution",), ("rates",)),
        ),
        "linearisation": Kind({**_LAGRANGE, "equilibrium": Shape.EXPRESSIONS, "claim": _TS}, {"Qnc": _TS}),
        "first-order": Kind({"exact": _TS, "small": _N, "claim": _TS}, {"q": _N, "order": Shape.NUMBER}),
        "invariance": Kind(
            {"q": _N, "of": Shape.WORD},
            {"p": _N, "Q": _TS, "P": _TS, **_NEW, "F": _T, "type": Shape.NUMBER},
            one_of=(("Q",), ("new_q", "new_p", "F", "type")),
        ),
        "jacobi-identity": Kind({"x": _N, "pairs": Shape.BRACKETS}, {"casimirs": _TS}),
        "positive-real": Kind({"variables": _N, "H": _T, "is": Shape.WORDS}),
        "variation": Kind({**_LAGRANGE, "boundary": _T, "integrand": _T}, {"Qnc": _TS}),
        "differential": Kind({"x": _N, "f": _T, "claim": _T}, {"given": Shape.EXPRESSIONS}),
    }
)
"""Every kind of claim that can stand in a sheet."""
