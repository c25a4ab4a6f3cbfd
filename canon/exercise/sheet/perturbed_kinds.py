"""Kinds of claims of Hamilton–Jacobi theory, of action and angle, and of perturbation theory."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from canon.exercise.sheet.kind import Kind, Shape

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["PERTURBED"]

_T, _TS, _N = Shape.TEXT, Shape.TEXTS, Shape.NAMES
_SYSTEM = {"q": _N, "p": _N, "H": _T}
_MAP = {"new_q": _N, "new_p": _N, "transformation": Shape.EXPRESSIONS}
_TO_AN_ORDER = {"order": Shape.NUMBER}

PERTURBED: Mapping[str, Kind] = MappingProxyType(
    {
        "hamilton-jacobi": Kind(
            "perturbed.complete_integrals.complete_integral",
            {**_SYSTEM, "constants": _N},
            {"W": _T, "S": _T, "gradient": _TS, "energy": _T},
            one_of=(("W",), ("S",), ("gradient",)),
            exclusive=True,
            answer=("W", "S", "gradient"),
            unknowns="an integral with as many independent constants as there are coordinates",
            quadratures=("W", "S"),
            derived=True,
            repaired=("W", "S", "gradient"),
            screen="by_question",
        ),
        "separable": Kind(
            "perturbed.complete_integrals.separable",
            {**_SYSTEM, "is": Shape.WORDS},
            answer=("is",),
            unknowns="whether the Hamilton–Jacobi equation separates in these coordinates",
            diagnoses=(),
        ),
        "action-angle": Kind(
            "perturbed.tori.action_angle",
            _SYSTEM,
            {"J": _TS, "energy": Shape.WORD, **_MAP},
            one_of=(("J",), ("new_q", "new_p", "transformation")),
            exclusive=True,
            answer=("J", "transformation"),
            components=("J",),
            unknowns="the action of each coordinate, or the map",
            dependent=("energy",),
        ),
        "frequency": Kind(
            "perturbed.tori.frequency",
            {**_SYSTEM, "omega": _TS},
            {"energy": Shape.WORD, "actions": _N},
            answer=("omega",),
            components=("omega",),
            unknowns="the frequency of each coordinate",
            dependent=("energy", "actions"),
        ),
        "lie-series": Kind(
            "perturbed.lie_transforms.lie_series",
            {"q": _N, "p": _N, "f": _T, "W": _T, "small": _N, "claim": _T},
            _TO_AN_ORDER,
            answer=("claim",),
            unknowns="the series up to the order",
            opposite="exp(ε L) with L f = {f, W}, {q, p} = +1",
        ),
        "normal-form": Kind(
            "perturbed.lie_transforms.normal_form",
            {**_SYSTEM, "actions": _N, "degree": Shape.NUMBER, "K": _T},
            answer=("K",),
            unknowns="K up to the degree",
        ),
        "averaged-hamiltonian": Kind(
            "perturbed.lie_transforms.averaged_hamiltonian",
            {**_SYSTEM, "angles": _N, "small": _N, "K": _T},
            _TO_AN_ORDER,
            answer=("K",),
            unknowns="K up to the order",
        ),
        "generating-first-order": Kind(
            "perturbed.lie_transforms.generator_of_first_order",
            {**_SYSTEM, "small": _N},
            {"W": _T, "F2": _T, "new_p": _N, "angles": _N},
            one_of=(("W",), ("F2", "new_p")),
            exclusive=True,
            answer=("W", "F2"),
            unknowns="a generator of first order",
            derived=True,
            repaired=("W", "F2"),
            screen="by_question",
            opposite="K = H + ε {H, W}, or F2 = Σ q P + ε S",
        ),
        "adiabatic-invariant": Kind(
            "perturbed.lie_transforms.adiabatic_invariant",
            {**_SYSTEM, "small": _N, "I": _T},
            {**_TO_AN_ORDER, "slow": _N, "slow_q": _N},
            answer=("I",),
            unknowns="one invariant to the order",
            dependent=("slow", "slow_q"),
            varying=("I",),
            derived=True,
            repaired=("I",),
            screen="by_question",
        ),
    }
)
"""Kinds whose judges are in :mod:`canon.exercise.judges.perturbed`."""
