"""The kinds of claims: which keys each takes, what shape they have, where the answer stands and what it determines."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["COMMON", "KINDS", "OF_PARAMETERS", "Kind", "Shape", "kind_of"]


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
    FUNCTIONS = "a table {function = [arguments]}"
    BOX = "a table {name = [lo, hi]}"
    EXPRESSIONS = "a table {name = expression}"
    LISTS = "a table of lists of expressions"
    BRACKETS = "a list of tables, each with three expressions"
    BODIES = "a list of tables {m, r, I, angle, omega}"
    FORCES = "a list of tables {F, r}, {torque, angle} or {torque, omega}"
    WORDS = "a list of words"
    VALUES = "a list of tables {name = expression}"


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
    answer
        The keys where the answer stands; all others say what is asked.
    unknowns
        What a complete answer determines.
    """

    required: Mapping[str, Shape]
    optional: Mapping[str, Shape] = field(default_factory=lambda: MappingProxyType({}))
    one_of: tuple[tuple[str, ...], ...] = ()
    exclusive: bool = False
    answer: tuple[str, ...] = ()
    unknowns: str = ""


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
    answer=("Q", "P", "valence", "implicit"),
    unknowns="the map",
)
_GENERATING = Kind(
    {**_PHASE, **_NEW, "F": _T},
    _MAP_EITHER_WAY,
    (("map",), ("inverse_map",)),
    exclusive=True,
    answer=("F",),
    unknowns="the generating function",
)
_MOTION = {**_PHASE, "H": _T, "L": _T, "x": _N, "X": _TS}
_CONSTRAINED = Kind(
    {**_LAGRANGE, "constraints": _TS, "multipliers": _N, "claim": _TS},
    answer=("claim",),
    unknowns="all accelerations and multipliers, together with the constraints",
)

KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "euler-lagrange": Kind(
            {**_LAGRANGE, "claim": _TS},
            answer=("claim",),
            unknowns="what Lagrange's equations determine: the accelerations",
        ),
        "dissipative": Kind(
            _LAGRANGE,
            {"F": _T, "Qnc": _TS, "claim": _TS, "energy_rate": _T},
            one_of=(("claim",), ("energy_rate",)),
            answer=("claim", "energy_rate"),
            unknowns="the accelerations, and dE/dt without them where it is claimed",
        ),
        "multiplier-holonomic": _CONSTRAINED,
        "nonholonomic": _CONSTRAINED,
        "legendre-hamiltonian": Kind(
            {**_PHASE, "L": _T},
            {"H": _T, "exists": Shape.TRUE},
            one_of=(("H",), ("exists",)),
            answer=("H",),
            unknowns="H",
        ),
        "hamilton-equations": Kind(
            {**_PHASE, "H": _T},
            {"q_dot": _TS, "p_dot": _TS, "solution": Shape.EXPRESSIONS},
            one_of=(("q_dot", "p_dot"), ("solution",)),
            answer=("q_dot", "p_dot", "solution"),
            unknowns="the rates of all coordinates and momenta, or a motion of all of them",
        ),
        "routhian": Kind(
            {**_LAGRANGE, "cyclic": _N, "momenta": _N, "convention": Shape.WORD},
            {"R": _T, "claim": _TS},
            one_of=(("R",), ("claim",)),
            answer=("R", "claim"),
            unknowns="R, or the accelerations of the other coordinates",
        ),
        "gibbs-appell": Kind(
            {"q": _N, "bodies": Shape.BODIES},
            {"quasi": _N, "q_dot": _TS, "V": _T, "S": _T, "claim": _TS},
            one_of=(("S",), ("claim",)),
            answer=("S", "claim"),
            unknowns="S up to terms without accelerations, or the accelerations",
        ),
        "poisson-bracket": Kind(
            {**_PHASE, "pairs": Shape.BRACKETS},
            answer=("pairs",),
            unknowns="the bracket of each f with each g in the list",
        ),
        "lagrange-bracket": Kind(
            {"variables": _N, "q": _TS, "p": _TS, "pairs": Shape.BRACKETS},
            answer=("pairs",),
            unknowns="the brackets of all pairs of variables",
        ),
        "lie-bracket": Kind(
            {"x": _N, "X": _TS, "Y": _TS, "claim": _TS}, answer=("claim",), unknowns="all components"
        ),
        "canonicity": _CANONICITY,
        "canonicity-time-dependent": _CANONICITY,
        "bilinear-covariant": Kind(
            {},
            {"x": _N, "form": _TS, "claim": _T, **_PHASE, "Q": _TS, "P": _TS, "factor": _T},
            one_of=(("x", "form", "claim"), ("q", "p", "Q", "P", "factor")),
            exclusive=True,
            answer=("claim", "factor"),
            unknowns="the covariant, or the factor",
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
            answer=("K",),
            unknowns="K up to a function of the time",
        ),
        "constant-of-motion": Kind(
            {"I": _T},
            {**_PHASE, "H": _T, "L": _T, "x": _N, "X": _TS, "restrict": _TS},
            one_of=(("q", "p", "H"), ("q", "L"), ("x", "X")),
            exclusive=True,
            answer=("I",),
            unknowns="one constant of the motion",
        ),
        "lagrangian-equivalence": Kind(
            {"q": _N, "L1": _T, "L2": _T, "relation": Shape.WORD},
            {"F": _T},
            answer=("F",),
            unknowns="F up to a constant, where the relation is `gauge`",
        ),
        "equality-only": Kind({"lhs": _T, "rhs": _T}, answer=("rhs",), unknowns="the right side"),
        "kinetic-energy": Kind(
            {"q": _N, "bodies": Shape.BODIES, "T": _T}, {"constraints": _TS}, answer=("T",), unknowns="T"
        ),
        "generalized-force": Kind(
            {"q": _N, "Q": _TS},
            {"forces": Shape.FORCES, "work": _T, "power": _T, "V": _T},
            one_of=(("forces",), ("work",), ("power",), ("V",)),
            answer=("Q",),
            unknowns="the force of each coordinate",
        ),
        "constraint-class": Kind(
            {"q": _N, "constraints": _TS, "class": Shape.WORDS},
            answer=("class",),
            unknowns="a word of each of the three pairs",
        ),
        "degrees-of-freedom": Kind(
            {"q": _N, "dof": _T},
            {"constraints": _TS, "counting": Shape.WORD},
            answer=("dof",),
            unknowns="the number",
        ),
        "reaction": Kind(
            {**_LAGRANGE, "constraints": _TS, "multipliers": _N},
            {"Qnc": _TS, "integrals": _TS, "values": Shape.EXPRESSIONS, "force": _TS},
            one_of=(("values",), ("force",)),
            answer=("values", "force"),
            unknowns="all multipliers, or the force on each coordinate",
        ),
        "leaving-condition": Kind(
            {**_LAGRANGE, "contact": _T, "leaves": _T},
            {"constraints": _TS, "Qnc": _TS, "integrals": _TS},
            answer=("leaves",),
            unknowns="where the reaction vanishes",
        ),
        "conserved-or-not": Kind(
            {},
            {**_MOTION, "conserved": _TS, "not_conserved": _TS, "Qnc": _TS},
            one_of=(("conserved",), ("not_conserved",)),
            answer=("conserved", "not_conserved"),
            unknowns="what is told of each quantity that is listed",
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
            answer=("solution", "rates"),
            unknowns="the general solution (`constants`), or the one with given initial values of the whole state",
        ),
        "linearisation": Kind(
            {**_LAGRANGE, "equilibrium": Shape.EXPRESSIONS, "claim": _TS},
            {"Qnc": _TS},
            answer=("equilibrium", "claim"),
            unknowns="the accelerations to first order",
        ),
        "first-order": Kind(
            {"exact": _TS, "small": _N, "claim": _TS},
            {"q": _N, "order": Shape.NUMBER},
            answer=("claim",),
            unknowns="the expansions: sums of powers of what is small",
        ),
        "invariance": Kind(
            {"q": _N, "of": Shape.WORD},
            {"p": _N, "Q": _TS, "P": _TS, **_NEW, "F": _T, "type": Shape.NUMBER},
            one_of=(("Q",), ("new_q", "new_p", "F", "type")),
            answer=("Q", "P", "F"),
            unknowns="the map",
        ),
        "jacobi-identity": Kind(
            {"x": _N, "pairs": Shape.BRACKETS},
            {"casimirs": _TS},
            answer=("pairs", "casimirs"),
            unknowns="as many independent Casimir functions as there are",
        ),
        "positive-real": Kind(
            {"variables": _N, "H": _T, "is": Shape.WORDS},
            answer=("is",),
            unknowns="whether H is positive real",
        ),
        "parameters": Kind(
            {"of": Shape.WORD, "find": _N, "values": Shape.VALUES},
            answer=("values",),
            unknowns="all values, whether or not `complete` is said",
        ),
        "variation": Kind(
            {**_LAGRANGE, "boundary": _T, "integrand": _T},
            {"Qnc": _TS},
            answer=("boundary", "integrand"),
            unknowns="the boundary term and the integrand",
        ),
        "differential": Kind(
            {"x": _N, "f": _T, "claim": _T},
            {"given": Shape.EXPRESSIONS},
            answer=("claim",),
            unknowns="the coefficient of each differential",
        ),
    }
)
"""Every kind of claim that can stand in a sheet."""

OF_PARAMETERS = (
    "canonicity",
    "canonicity-time-dependent",
    "generating-F1",
    "generating-F2",
    "generating-F3",
    "generating-F4",
    "transformed-hamiltonian-K",
    "bilinear-covariant",
    "constant-of-motion",
    "solution",
    "hamilton-equations",
    "legendre-hamiltonian",
    "lagrangian-equivalence",
    "poisson-bracket",
    "lagrange-bracket",
    "lie-bracket",
    "jacobi-identity",
)
"""Kinds of claims whose parameters can be asked for."""


def kind_of(kind: str, keys: Mapping[str, Any]) -> Kind:
    """Return the kind of a claim; one about parameters has the keys of the claim that it is about as well.

    Examples
    --------
    >>> sorted(kind_of("parameters", {"of": "constant-of-motion"}).required)
    ['I', 'find', 'of', 'values']
    """
    own, of = KINDS[kind], keys.get("of")
    if kind != "parameters" or of not in OF_PARAMETERS:
        return own
    inner = KINDS[of]
    return replace(
        own,
        required={**own.required, **inner.required},
        optional=inner.optional,
        one_of=inner.one_of,
        exclusive=inner.exclusive,
    )
