"""Claims about motion under holonomic and nonholonomic constraints, with Lagrange's multipliers."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.exercise.judges.lagrangian import lagrangian_of
from canon.exercise.question.affine_systems import solved
from canon.exercise.question.answer import equations_missing
from canon.exercise.question.question import Determines, Part, Question, Same, SameEquations, Tells
from canon.expression.symbols.symbol import acceleration, time_derivative, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.constraint_manifold import on_manifold
from canon.mechanics.algebra.linear import SingularMatrixError, eliminate
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.proof.domain.domain import Domain

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy.logic.boolalg import Boolean

    from canon.exercise.sheet.reading import Reading
    from canon.mechanics.algebra.constraint_manifold import Branch

__all__ = ["is_one_of", "jets_of", "multiplier_holonomic", "nonholonomic", "with_jets"]

MOST_OPERATIONS = 150
"""Size of an answer that is still shown."""


def multiplier_holonomic(reading: Reading) -> Iterator[Question]:
    """With d/dt L_v − L_q = Σ λ ∂f/∂q, f(q, t) = 0, every claimed equation holds on every motion."""
    q, t = reading.symbols("q"), reading.time
    constraints = reading.equations("constraints")
    velocities = tuple(velocity(x) for x in q)
    for i, f in enumerate(constraints):
        if f.has(*velocities):
            reading.fault(f"constraints[{i}]", "a holonomic constraint depends on coordinates and time only")
    directions = sp.Matrix([[f.diff(x) for x in q] for f in constraints])
    rates = tuple(time_derivative(f, q, t) for f in constraints)
    yield from _on_every_motion(reading, directions, (*constraints, *rates), rates)


def nonholonomic(reading: Reading) -> Iterator[Question]:
    """With d/dt L_v − L_q = Σ λ ∂g/∂q̇, g(q, q̇, t) = 0 affine in q̇, every claimed equation holds on every motion."""
    q = reading.symbols("q")
    constraints = reading.equations("constraints")
    velocities = tuple(velocity(x) for x in q)
    for i, g in enumerate(constraints):
        if not g.has(*velocities):
            reading.fault(f"constraints[{i}]", "this constraint holds no velocity; give its time derivative")
    directions = sp.Matrix([[g.diff(v) for v in velocities] for g in constraints])
    if directions.has(*velocities):
        reading.fault("constraints", "every constraint should be affine in the velocities")
    yield from _on_every_motion(reading, directions, constraints, constraints)


def _on_every_motion(
    reading: Reading, directions: sp.Matrix, manifold: Sequence[Expr], held: Sequence[Expr]
) -> Iterator[Question]:
    """Accelerations and multipliers solve  M q̈ + b = Aᵀ λ  and  d(held)/dt = 0;  claims hold on the manifold."""
    q, t, multipliers = reading.symbols("q"), reading.time, reading.symbols("multipliers")
    if len(multipliers) != directions.rows:
        reading.fault(
            "multipliers",
            f"{counted(len(multipliers), 'multiplier')} for {counted(directions.rows, 'constraint')}",
        )
    lagrangian = lagrangian_of(reading)
    unknowns = (*(acceleration(x) for x in q), *multipliers)
    reactions = directions.T * sp.Matrix(multipliers)
    system = [equation - reaction for equation, reaction in zip(lagrangian.equations, reactions, strict=True)]
    rates = [time_derivative(g, q, t) for g in held]
    system += rates
    claims = reading.equations("claim")
    jets = jets_of((*system, *manifold, *claims), t, reading.domain)
    functions = {symbol: function for function, symbol in jets.items()}
    system, rates, claims, manifold = (
        [exchanged(e, jets) for e in given] for given in (system, rates, claims, manifold)
    )
    open_ = {i: claim for i, claim in enumerate(claims) if not is_one_of(claim, system)} or {0: sp.S.Zero}
    domain = with_jets(reading.domain, jets)
    branches = on_manifold(manifold, domain, keep=(t, *unknowns), prefer=lagrangian.velocities)
    for branch in branches:
        here = [substitute(equation, branch.values) for equation in system]
        try:
            solution = solved(here, unknowns, branch.domain)
        except (
            SingularMatrixError
        ):  # dependent constraints or massless coordinates: ask for linear consequences
            seen = tuple(substitute(claim, branch.values) for claim in open_.values())
            yield SameEquations((*here, *seen), tuple(here), unknowns, branch.domain, before=len(here))
            continue
        through = {**branch.values, **solution}
        parts = tuple(
            Part(f"claim {i + 1}", claim, through=through, key=f"claim[{i}]", written=functions)
            for i, claim in open_.items()
        )
        yield Same(parts, branch.domain, partial(_shown, solution if len(branches) == 1 else {}))
    free = "it is true of anything" if not any(claims) else "it follows from the constraints alone"
    yield Tells(tuple(_on_any_motion(claims, rates, unknowns[: len(q)], branch) for branch in branches), free)
    yield Determines(partial(_left_open, claims, rates, system, unknowns, branches))


def _on_any_motion(
    claims: Sequence[Expr], rates: Sequence[Expr], accelerations: Sequence[Symbol], branch: Branch
) -> Same:
    """Return the question whether claims hold on every motion that the constraints allow, whatever moves it."""
    here = [substitute(rate, branch.values) for rate in rates]
    slopes = sp.Matrix([[rate.diff(a) for a in accelerations] for rate in here])
    rest = sp.Matrix([exchanged(rate, dict.fromkeys(accelerations, sp.S.Zero)) for rate in here])
    echelon = eliminate(slopes, rest, branch.domain)
    rows = echelon.rows[: echelon.rank]
    bound = [accelerations[j] for j in echelon.pivots]
    left = [
        sp.Add(*(a * slope for a, slope in zip(accelerations, row, strict=False)), row[-1]) for row in rows
    ]
    through = {**branch.values, **(solved(left, bound, branch.domain) if bound else {})}
    return Same(tuple(Part(f"claim {i}", c, through=through) for i, c in enumerate(claims, 1)), branch.domain)


def _left_open(
    claims: Sequence[Expr],
    rates: Sequence[Expr],
    system: Sequence[Expr],
    unknowns: Sequence[Symbol],
    branches: Sequence[Branch],
) -> tuple[str, ...]:
    """Return what claims and constraints together leave open of the accelerations and multipliers."""
    for branch in branches:
        told, whole = ([substitute(e, branch.values) for e in some] for some in ((*rates, *claims), system))
        if found := equations_missing(told, whole, unknowns, branch.domain):
            return found
    return ()


def is_one_of(claim: Expr, system: Sequence[Expr]) -> bool:
    """Whether a claim is an equation of a system as it stands, or its negative: nothing is to be solved then.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> is_one_of(y - x * (1 + y), [x + y, x + x * y - y])
    True
    """
    return any(sp.expand(claim - sign * equation) == 0 for equation in system for sign in (1, -1))


def _shown(solution: Mapping[Symbol, Expr]) -> tuple[str, ...] | None:
    """Return accelerations and multipliers as text, unless they are longer than anyone reads."""
    if not solution or sp.count_ops(sp.Tuple(*solution.values())) > MOST_OPERATIONS:
        return None
    return tuple(
        f"{u} = {sp.cancel(value) if value.is_rational_function() else value}"
        for u, value in solution.items()
    )


def with_jets(domain: Domain, jets: Mapping[Expr, Symbol]) -> Domain:
    """Return a domain with the symbols that stand for functions and derivatives in its conditions."""
    return Domain(tuple(cast("Boolean", c.xreplace(dict(jets))) for c in domain.conditions), domain.box)


def jets_of(expressions: Sequence[Expr], t: Symbol, domain: Domain) -> dict[Expr, Symbol]:
    """Return a symbol for each arbitrary function and each of its derivatives.

    At one point they are independent of one another, and nothing is differentiated any more. Functions of more than
    the time are left alone where they occur with different arguments.

    Examples
    --------
    >>> from sympy import Function, symbols
    >>> x, t = symbols("x t", real=True)
    >>> V = Function("V")(x)
    >>> jets_of([V + V.diff(x)], t, Domain())
    {Derivative(V(x), x): Derivative(V(x), x), V(x): V(x)}
    """
    everything = (*expressions, *domain.conditions)
    atoms = set[Expr]().union(*(e.atoms(AppliedUndef, sp.Derivative) for e in everything))
    places = {atom.expr if isinstance(atom, sp.Derivative) else atom for atom in atoms}
    named = [str(place.func) for place in places]
    jets: dict[Expr, Symbol] = {}
    for atom in sorted(atoms, key=str):
        function = atom.expr if isinstance(atom, sp.Derivative) else atom
        plain = all(isinstance(argument, Symbol) for argument in function.args)
        alone = named.count(str(function.func)) == 1
        if isinstance(function, AppliedUndef) and (function.args == (t,) or (plain and alone)):
            positive = {"positive": True} if atom == function and function.is_positive else {}
            jets[atom] = Symbol(str(atom), real=True, **positive)
    return jets
