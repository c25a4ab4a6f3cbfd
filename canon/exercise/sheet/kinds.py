"""Kinds of claims: one value each, with everything that makes it a kind."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet.kind import USUAL, Kind, Shape
from canon.exercise.sheet.perturbed_kinds import PERTURBED

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["KINDS", "kind_of"]

_T, _TS, _N = Shape.TEXT, Shape.TEXTS, Shape.NAMES
_FIRST = ("changed_claims.another_reading", "components.part_by_part")
_CHANGED = ("changed_claims.only_where", "one_change.anywhere", "changed_claims.only_for")
_OF_F = ("convention.rescaled", "convention.one_rule", *_FIRST, "components.generating_function")
_OF_K = ("convention.lost_time_derivative", *_FIRST, "components.new_hamiltonian")
_AT_LAST = ("asymptotic.right_to_an_order", "changed_claims.right_where")
_OF_MAPS = (
    "convention.valence", *_FIRST, "changed_claims.only_where", "changed_claims.staggered_step",
    "one_change.anywhere", "components.point_momenta", "changed_claims.only_for", "convention.variable_valence",
    *_AT_LAST,
)  # fmt: skip
_PHASE, _NEW = {"q": _N, "p": _N}, {"new_q": _N, "new_p": _N}
_LAGRANGE = {"q": _N, "L": _T}
_MAP_EITHER_WAY = {"map": Shape.LISTS, "inverse_map": Shape.LISTS}
_CANONICITY = Kind(
    "canonical.canonicity",
    _PHASE,
    {"Q": _TS, "P": _TS, "valence": _T, **_NEW, "implicit": _TS},
    one_of=(("Q", "P"), ("new_q", "new_p", "implicit")),
    exclusive=True,
    ways=(("Q", "P"), ("new_q", "new_p", "implicit")),
    answer=("Q", "P", "valence", "implicit"),
    unknowns="the map",
    derived=True,
    repaired=("P", "Q", "implicit"),
    screen="canonicity",
    diagnoses=_OF_MAPS,
)
_GENERATING = Kind(
    "canonical.generating",
    {**_PHASE, **_NEW, "F": _T},
    _MAP_EITHER_WAY,
    (("map",), ("inverse_map",)),
    exclusive=True,
    answer=("F",),
    unknowns="the generating function",
    claimed_too=("map", "inverse_map"),
    derived=True,
    repaired=("F", "map.Q", "map.P", "inverse_map.q", "inverse_map.p"),
    screen="generating",
    rereadings=("inverse_map", "other_type", "exchanged_map"),
    diagnoses=(*_OF_F, *_CHANGED, *_AT_LAST),
)
_MOTION = {**_PHASE, "H": _T, "L": _T, "x": _N, "X": _TS}
_SYSTEMS = (("q", "p", "H"), ("q", "L"), ("x", "X"))
_WITH_FORCES = (("q", "L", "Qnc"), ("q", "p", "H"), ("x", "X"))
_CONSTRAINED = Kind(
    "constrained.nonholonomic",
    {**_LAGRANGE, "constraints": _TS, "multipliers": _N, "claim": _TS},
    answer=("claim",),
    unknowns="all accelerations and multipliers, together with the constraints",
)

_OF_PARAMETERS = (
    "canonicity", "canonicity-time-dependent", "generating-F1", "generating-F2", "generating-F3",
    "generating-F4", "transformed-hamiltonian-K", "bilinear-covariant", "constant-of-motion",
    "solution", "hamilton-equations", "legendre-hamiltonian", "lagrangian-equivalence",
    "poisson-bracket", "lagrange-bracket", "lie-bracket", "jacobi-identity",
)  # fmt: skip

KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "euler-lagrange": Kind(
            "lagrangian.euler_lagrange",
            {**_LAGRANGE, "claim": _TS},
            answer=("claim",),
            unknowns="what Lagrange's equations determine: the accelerations",
        ),
        "dissipative": Kind(
            "lagrangian.dissipative",
            _LAGRANGE,
            {"F": _T, "Qnc": _TS, "claim": _TS, "energy_rate": _T},
            one_of=(("claim",), ("energy_rate",)),
            answer=("claim", "energy_rate"),
            unknowns="the accelerations where equations are claimed, and dE/dt without them where it is claimed",
        ),
        "multiplier-holonomic": replace(_CONSTRAINED, judge="constrained.multiplier_holonomic"),
        "nonholonomic": replace(_CONSTRAINED, judge="constrained.nonholonomic"),
        "legendre-hamiltonian": Kind(
            "hamiltonian.legendre_hamiltonian",
            {**_PHASE, "L": _T},
            {"H": _T, "exists": Shape.TRUE},
            one_of=(("H",), ("exists",)),
            answer=("H",),
            unknowns="H",
            following=("p",),
        ),
        "hamilton-equations": Kind(
            "hamiltonian.hamilton_equations",
            {**_PHASE, "H": _T},
            {"q_dot": _TS, "p_dot": _TS, "solution": Shape.EXPRESSIONS},
            one_of=(("q_dot", "p_dot"), ("solution",)),
            answer=("q_dot", "p_dot", "solution"),
            unknowns="the rates of all coordinates and momenta, or a motion of all of them",
            independent=True,
            repaired=("solution",),
            screen="solution",
            rereadings=("exchanged_equations",),
        ),
        "routhian": Kind(
            "lagrangian.routhian",
            {**_LAGRANGE, "cyclic": _N, "momenta": _N, "convention": Shape.WORD},
            {"R": _T, "claim": _TS},
            one_of=(("R",), ("claim",)),
            answer=("R", "claim"),
            unknowns="R, or the accelerations of the other coordinates",
            rereadings=("other_convention",),
            opposite="the one that `convention` says",
        ),
        "gibbs-appell": Kind(
            "lagrangian.gibbs_appell",
            {"q": _N, "bodies": Shape.BODIES},
            {"quasi": _N, "q_dot": _TS, "V": _T, "Qnc": _TS, "S": _T, "claim": _TS},
            one_of=(("S",), ("claim",)),
            answer=("S", "claim"),
            unknowns="S up to terms without accelerations, or the accelerations",
            derived=True,
            repaired=("S",),
            screen="by_question",
            diagnoses=("components.acceleration_energy", *USUAL),
        ),
        "poisson-bracket": Kind(
            "canonical.poisson_brackets",
            {**_PHASE, "pairs": Shape.BRACKETS},
            answer=("pairs",),
            independent=True,
            unknowns="the bracket of each f with each g in the list",
            repaired=("pairs",),
            screen="poisson_brackets",
            opposite="{q, p} = +1",
        ),
        "lagrange-bracket": Kind(
            "canonical.lagrange_brackets",
            {"variables": _N, "q": _TS, "p": _TS, "pairs": Shape.BRACKETS},
            answer=("pairs",),
            independent=True,
            unknowns="the brackets of all pairs of variables",
            repaired=("p", "q"),
            screen="lagrange_brackets",
            opposite="[u, v] = Σ (∂q/∂u ∂p/∂v − ∂q/∂v ∂p/∂u)",
        ),
        "lie-bracket": Kind(
            "canonical.lie_brackets",
            {"x": _N, "X": _TS, "Y": _TS, "claim": _TS},
            answer=("claim",),
            components=("claim",),
            independent=True,
            unknowns="all components",
            opposite="[X, Y] = X·∇Y − Y·∇X",
        ),
        "canonicity": _CANONICITY,
        "canonicity-time-dependent": _CANONICITY,
        "bilinear-covariant": Kind(
            "canonical.bilinear",
            {},
            {"x": _N, "form": _TS, "claim": _T, **_PHASE, "Q": _TS, "P": _TS, "factor": _T},
            one_of=(("x", "form", "claim"), ("q", "p", "Q", "P", "factor")),
            exclusive=True,
            ways=(("x", "form", "claim"), ("q", "p", "Q", "P", "factor")),
            answer=("claim", "factor"),
            unknowns="the covariant, or the factor",
            claimed_too=("Q", "P"),
            repaired=("P", "Q"),
            screen="bilinear_covariant",
            diagnoses=("convention.factor", *USUAL),
        ),
        **{f"generating-F{i}": replace(_GENERATING, implied={"type": i}) for i in (1, 2, 3, 4)},
        "transformed-hamiltonian-K": Kind(
            "canonical.new_hamiltonian",
            {**_PHASE, "H": _T, **_NEW, "K": _T},
            _MAP_EITHER_WAY,
            one_of=(("map",), ("inverse_map",)),
            exclusive=True,
            answer=("K",),
            unknowns="K up to a function of the time",
            claimed_too=("map", "inverse_map"),
            derived=True,
            repaired=("K", "map.P", "map.Q", "inverse_map.p", "inverse_map.q"),
            screen="new_hamiltonian",
            rereadings=("inverse_map", "exchanged_map"),
            diagnoses=(*_OF_K, *_CHANGED, *_AT_LAST),
        ),
        "constant-of-motion": Kind(
            "hamiltonian.constant_of_motion",
            {"I": _T},
            {**_PHASE, "H": _T, "L": _T, "x": _N, "X": _TS, "restrict": _TS},
            one_of=_SYSTEMS,
            exclusive=True,
            ways=_SYSTEMS,
            answer=("I",),
            unknowns="one constant of the motion",
            varying=("I",),
            derived=True,
            repaired=("I",),
            screen="constant",
            diagnoses=(*_FIRST, "derived_part.time_term", *_CHANGED, *_AT_LAST),
        ),
        "lagrangian-equivalence": Kind(
            "lagrangian.lagrangian_equivalence",
            {"q": _N, "L1": _T, "L2": _T, "relation": Shape.WORD},
            {"F": _T},
            answer=("F",),
            unknowns="F up to a constant, where the relation is `gauge`",
            claimed_too=("L2",),
            derived=True,
            repaired=("F", "L2"),
            screen="gauge",
            rereadings=("same_equations_of_motion",),
            diagnoses=(
                *_FIRST,
                "changed_claims.only_where",
                "one_change.in_one_of_two",
                "changed_claims.only_for",
                "asymptotic.right_to_an_order",
                "changed_claims.another_gauge",
                "changed_claims.right_where",
                "components.second_lagrangian",
            ),
        ),
        "equality-only": Kind(
            "hamiltonian.equality",
            {"lhs": _T, "rhs": _T},
            answer=("rhs",),
            unknowns="the right side",
            two_sided=True,
            claimed_too=("lhs",),
            repaired=("rhs", "lhs"),
            screen="equality",
        ),
        "kinetic-energy": Kind(
            "energy_and_force.kinetic_energy",
            {"q": _N, "bodies": Shape.BODIES, "T": _T},
            {"constraints": _TS},
            answer=("T",),
            unknowns="T",
        ),
        "generalized-force": Kind(
            "energy_and_force.generalized_force",
            {"q": _N, "Q": _TS},
            {"forces": Shape.FORCES, "work": _T, "power": _T, "V": _T},
            one_of=(("forces",), ("work",), ("power",), ("V",)),
            answer=("Q",),
            unknowns="the force of each coordinate",
        ),
        "constraint-class": Kind(
            "constraint_class.constraint_class",
            {"q": _N, "constraints": _TS, "class": Shape.WORDS},
            answer=("class",),
            unknowns="a word of each of the three pairs",
        ),
        "degrees-of-freedom": Kind(
            "constraint_class.degrees_of_freedom",
            {"q": _N, "dof": _T},
            {"constraints": _TS, "counting": Shape.WORD},
            answer=("dof",),
            unknowns="the number",
        ),
        "reaction": Kind(
            "reaction.reaction",
            {**_LAGRANGE, "constraints": _TS, "multipliers": _N},
            {"Qnc": _TS, "integrals": _TS, "values": Shape.EXPRESSIONS, "force": _TS},
            one_of=(("values",), ("force",)),
            answer=("values", "force"),
            unknowns="all multipliers, or the force on each coordinate",
        ),
        "leaving-condition": Kind(
            "reaction.leaving_condition",
            {**_LAGRANGE, "contact": _T, "leaves": _T},
            {"constraints": _TS, "Qnc": _TS, "integrals": _TS},
            answer=("leaves",),
            unknowns="where the reaction vanishes",
        ),
        "conserved-or-not": Kind(
            "conserved.conserved_or_not",
            {},
            {**_MOTION, "conserved": _TS, "not_conserved": _TS, "Qnc": _TS},
            one_of=(("conserved",), ("not_conserved",)),
            ways=_WITH_FORCES,
            answer=("conserved", "not_conserved"),
            unknowns="what is told of each quantity that is listed",
        ),
        "solution": Kind(
            "solution.solution",
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
            ways=(*_WITH_FORCES, ("q", "equations")),
            answer=("solution", "rates"),
            unknowns="the general solution (`constants`), or the one with given initial values of the whole state",
            repaired=("solution", "rates"),
            screen="motion",
        ),
        "linearisation": Kind(
            "small_quantities.linearisation",
            {**_LAGRANGE, "equilibrium": Shape.EXPRESSIONS, "claim": _TS},
            {"Qnc": _TS},
            answer=("equilibrium", "claim"),
            unknowns="the accelerations to first order",
        ),
        "first-order": Kind(
            "small_quantities.first_order",
            {"exact": _TS, "small": _N, "claim": _TS},
            {"q": _N, "order": Shape.NUMBER},
            answer=("claim",),
            components=("claim",),
            unknowns="the expansions: sums of powers of what is small",
        ),
        "invariance": Kind(
            "invariance.invariance",
            {"q": _N, "of": Shape.WORD},
            {"p": _N, "Q": _TS, "P": _TS, **_NEW, "F": _T, "type": Shape.NUMBER},
            one_of=(("Q",), ("new_q", "new_p", "F", "type")),
            ways=(("Q", "P"), ("new_q", "new_p", "F", "type")),
            answer=("Q", "P", "F"),
            unknowns="the map",
        ),
        "jacobi-identity": Kind(
            "invariance.jacobi_identity",
            {"x": _N, "pairs": Shape.BRACKETS},
            {"casimirs": _TS},
            answer=("pairs", "casimirs"),
            independent=True,
            unknowns="as many independent Casimir functions as there are",
        ),
        "positive-real": Kind(
            "positive_real.positive_real",
            {"variables": _N, "H": _T, "is": Shape.WORDS},
            answer=("is",),
            unknowns="whether H is positive real",
            claimed_too=("H",),
            complex_names=("variables",),
        ),
        "number": Kind(
            "number.number",
            {"value": _TS, "claim": _TS},
            {"tolerance": _T, "unit": Shape.WORD, "given": Shape.EXPRESSIONS, "name": Shape.WORD},
            answer=("claim",),
            several=("value", "claim"),
            unknowns="all values",
            diagnoses=(),
        ),
        "parameters": Kind(
            "parameter_values.parameters",
            {"of": Shape.WORD, "find": _N, "values": Shape.VALUES},
            answer=("values",),
            unknowns="all values, whether or not `complete` is said",
            about=_OF_PARAMETERS,
            rereadings=("inverse_map", "exchanged_map"),
        ),
        "variation": Kind(
            "variation.variation",
            {**_LAGRANGE, "boundary": _T, "integrand": _T},
            {"Qnc": _TS},
            answer=("boundary", "integrand"),
            unknowns="the boundary term and the integrand",
        ),
        "differential": Kind(
            "variation.differential",
            {"x": _N, "f": _T, "claim": _T},
            {"given": Shape.EXPRESSIONS},
            answer=("claim",),
            unknowns="the coefficient of each differential",
        ),
        **PERTURBED,
    }
)
"""Every kind of claim that can stand in a sheet."""


def kind_of(kind: str, keys: Mapping[str, Any]) -> Kind:
    """Return the kind of a claim; one about a claim of another kind has the keys of that one as well.

    Examples
    --------
    >>> sorted(kind_of("parameters", {"of": "constant-of-motion"}).required)
    ['I', 'find', 'of', 'values']
    """
    own, of = KINDS[kind], keys.get("of")
    if of not in own.about:
        return own
    inner = KINDS[of]
    return replace(
        own,
        required={**own.required, **inner.required},
        optional=inner.optional,
        one_of=inner.one_of,
        exclusive=inner.exclusive,
        ways=inner.ways,
    )
