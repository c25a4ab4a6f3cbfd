"""Parametric generating functions: known as functions of (q, p, t) along their map only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.substitution import entry, exchanged
from canon.proof.continuity.continuity import continuity
from canon.proof.domain.verdict import Status, Verdict, all_hold

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.mechanics.canonical.transformation import CanonicalTransformation
    from canon.proof.domain.domain import Domain

__all__ = ["ParametricGeneratingFunction"]


@dataclass(frozen=True)
class ParametricGeneratingFunction:
    """A generating function that exists but is known only along the map: F(q, p, t) and the relations.

    Parameters
    ----------
    kind
        The type of each degree of freedom.
    F
        The value of the generating function at the old variables (q, p, t); None where the contact form was
        not integrated in closed form.
    relations
        The new variables of the type as functions of (q, p, t).
    transformation
        The map.
    """

    kind: tuple[int, ...]
    F: Expr | None
    relations: tuple[tuple[Symbol, Expr], ...]
    transformation: CanonicalTransformation

    def is_right(self, domain: Domain | None = None) -> Verdict:
        """Tell whether dF along the map is the differential of its type, at fixed t.

        For type 1, dF = Σ p dq − Σ P dQ as forms in (dq, dp), with + Q dP for types 2 and 4 in place of − P dQ
        and − q dp for types 3 and 4 in place of p dq.
        """
        T, F = self.transformation, self.F
        question = "F is the generating function along the map"
        if F is None:
            return Verdict(Status.UNDECIDED, question, feedback="F was not found in closed form")

        def due(z: Symbol) -> Expr:
            pairs = zip(self.kind, T.q, T.p, T.new_q, T.new_p, strict=True)
            return sp.Add(
                *(
                    (p * q.diff(z) if k in (1, 2) else -q * p.diff(z))
                    + (-P * Q.diff(z) if k in (1, 3) else Q * P.diff(z))
                    for k, q, p, Q, P in pairs
                )
            )

        claims = [(f"the coefficient of d{z} in dF", F.diff(z) - due(z)) for z in T.variables]
        verdict = all_vanish(claims, question, domain or T.domain)
        if not verdict.holds:
            return verdict
        continuous = continuity(F, T.variables, domain or T.domain, name="F", given=T.images)
        return all_hold([verdict, continuous], question)

    def evaluate(self, values: Mapping[Symbol, float], start: Mapping[Symbol, float]) -> float:
        """Return the number F(old, new) by solving the relations with Newton's method.

        Parameters
        ----------
        values
            Numbers for all variables of the type, the time and the parameters.
        start
            First guesses for the old variables that the type does not hold.

        Raises
        ------
        ValueError
            Where F is not known, or Newton's method does not converge.
        """
        if self.F is None:
            raise ValueError(
                "the contact form of this map was not integrated in closed form, so F has no formula; "
                "choose another type of generating function"
            )
        unknowns = list(start)
        known = {s: sp.Float(value, 30) for s, value in values.items()}
        equations = [exchanged(f - b, known) for b, f in self.relations]
        root = sp.nsolve(equations, unknowns, [start[s] for s in unknowns], prec=30)
        found = {s: entry(sp.Matrix(root), i, 0) for i, s in enumerate(unknowns)}
        return float(exchanged(self.F, {**known, **found}))
