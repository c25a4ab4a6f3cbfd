"""Claims about motion under holonomic and nonholonomic constraints, with Lagrange's multipliers."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.judges.lagrangian import lagrangian_of
from canon.exercise.question.answer import equations_missing
from canon.exercise.question.answer_values import without_value_on
from canon.exercise.question.deadline import Deadline
from canon.exercise.question.question import Determines, Part, Question, Same, SameEquations, Tells, decide
from canon.expression.symbols.symbol import acceleration, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.constraint_manifold import check_whole, on_manifold
from canon.mechanics.algebra.jets import jets_of, with_jets
from canon.mechanics.algebra.linear import SingularMatrixError, eliminate, solve_affine
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.hidden_constraints import all_motions
from canon.proof.domain.verdict import Undecided, Verdict
from canon.proof.trees.affine_form import is_affine

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.exercise.sheet.reading import Reading
    from canon.mechanics.algebra.constraint_manifold import Branch
    from canon.mechanics.lagrange.lagrangian import Lagrangian
    from canon.proof.domain.domain import Domain

__all__ = ["bound_by", "is_one_of", "multiplier_holonomic", "nonholonomic"]

MOST_OPERATIONS = 150
"""Size of an answer that is still shown."""


def multiplier_holonomic(reading: Reading) -> Iterator[Question]:
    """With d/dt L_v − L_q = Σ λ ∂f/∂q, f(q, t) = 0, every claimed equation holds on every motion."""
    constraints = reading.equations("constraints")
    velocities = tuple(velocity(x) for x in reading.symbols("q"))
    for i, f in enumerate(constraints):
        if f.has(*velocities):
            reading.fault(f"constraints[{i}]", "a holonomic constraint depends on coordinates and time only")
    yield from _on_every_motion(reading)


def nonholonomic(reading: Reading) -> Iterator[Question]:
    """With d/dt L_v − L_q = Σ λ ∂g/∂q̇, g(q, q̇, t) = 0 affine in q̇, every claimed equation holds on every motion."""
    constraints = reading.equations("constraints")
    velocities = tuple(velocity(x) for x in reading.symbols("q"))
    for i, g in enumerate(constraints):
        if not g.has(*velocities):
            reading.fault(f"constraints[{i}]", "this constraint holds no velocity; give its time derivative")
    yield from _on_every_motion(reading)


def bound_by(
    reading: Reading, lagrangian: Lagrangian, constraints: Sequence[Expr], multipliers: Sequence[Symbol]
) -> tuple[ConstrainedLagrangian, list[Symbol]]:
    """Return a system under constraints f(q, t), or g(q, q̇, t) affine in q̇, and its multipliers in its order."""
    if len(multipliers) != len(constraints):
        reading.fault(
            "multipliers",
            f"{counted(len(multipliers), 'multiplier')} for {counted(len(constraints), 'constraint')}",
        )
    v = lagrangian.velocities
    if not all(is_affine(g, v) for g in constraints):
        reading.fault("constraints", "every constraint should be affine in the velocities")
    for g in constraints:
        if not g.has(*lagrangian.q, *v):
            reading.fault("constraints", f"{g} = 0 constrains no coordinate and no velocity")
    pairs = list(zip(constraints, multipliers, strict=True))
    positions, moving = ([pair for pair in pairs if pair[0].has(*v) is some] for some in (False, True))
    bound = ConstrainedLagrangian(lagrangian, [f for f, _ in positions], [g for g, _ in moving])
    return bound, [x for _, x in (*positions, *moving)]


def _on_every_motion(reading: Reading) -> Iterator[Question]:
    """Accelerations and multipliers solve  M q̈ + b = Aᵀ λ  and  d(held)/dt = 0;  claims hold on the manifold.

    The branches of the manifold are all of it only where no factor without velocities of a constraint on velocities
    may vanish: y (ẋ − ẏ) = 0 holds for every velocity where y = 0, and motions with y = 0 obey other equations.
    """
    q, t, multipliers = reading.symbols("q"), reading.time, reading.symbols("multipliers")
    lagrangian = lagrangian_of(reading)
    bound, ordered = bound_by(reading, lagrangian, reading.equations("constraints"), multipliers)
    unknowns = (*(acceleration(x) for x in q), *multipliers)
    system, rates, manifold = bound.equations_of_motion(ordered), bound.differentiated, bound.manifold
    claims = reading.equations("claim")
    jets = jets_of((*system, *manifold, *claims), reading.domain, t)
    functions = {symbol: function for function, symbol in jets.items()}
    plain = system, manifold
    system, rates, claims, manifold = (
        [exchanged(e, jets) for e in given] for given in (system, rates, claims, manifold)
    )
    open_ = _not_among(claims, system)
    domain = with_jets(reading.domain, jets)
    check_whole([exchanged(g, jets) for g in bound.nonholonomic], lagrangian.velocities, domain)
    branches = on_manifold(manifold, domain, keep=(t, *unknowns), prefer=lagrangian.velocities)
    for branch in branches:
        here = [substitute(equation, branch.values) for equation in system]
        try:
            solution = solve_affine(here, unknowns, branch.domain)
            through = {**branch.values, **solution}
        except SingularMatrixError:  # dependent constraints or massless coordinates
            if jets or len(branches) > 1:
                seen = [substitute(claim, branch.values) for claim in open_.values()]
                yield _linear_consequences(here, seen, unknowns, branch.domain, reading)
                continue
            motions = all_motions(*plain, q, unknowns, domain, t)
            solution, branch, through = {}, motions.branch, motions.through
        parts = _parts(open_, through, functions)
        yield Same(parts, branch.domain, partial(_shown, solution if len(branches) == 1 else {}))
        yield from _valued(reading, {**jets, **through}, branch.domain, states_are_free=bool(solution))
    free = "it follows from the constraints alone" if any(claims) else "it is true of anything"
    yield Tells(tuple(_on_any_motion(claims, rates, unknowns[: len(q)], branch) for branch in branches), free)
    yield Determines(partial(_left_open, claims, rates, system, unknowns, branches))


def _valued(
    reading: Reading, known: Mapping[Any, Expr], domain: Domain, *, states_are_free: bool
) -> Iterator[Verdict]:
    """Yield what speaks against claims having a value on motions of which something is known."""
    q = reading.symbols("q")
    bound = [*map(acceleration, q), *reading.symbols("multipliers")]
    bound += [] if states_are_free else [*q, *map(velocity, q)]
    yield from without_value_on(reading, "claim", bound, lambda: [(known, domain)])


def _parts(
    claims: Mapping[int, Expr], through: Mapping[Symbol, Expr], functions: Mapping[Symbol, Expr]
) -> tuple[Part, ...]:
    """Return what is to vanish of claims that have numbers."""
    return tuple(
        Part(f"claim {i + 1}", claim, through=through, key=f"claim[{i}]", written=functions)
        for i, claim in claims.items()
    )


def _not_among(claims: Sequence[Expr], system: Sequence[Expr]) -> dict[int, Expr]:
    """Return the claims that are no equations of a system as they stand, by their numbers; 0 where there are none."""
    return {i: claim for i, claim in enumerate(claims) if not is_one_of(claim, system)} or {0: sp.S.Zero}


def _linear_consequences(
    system: Sequence[Expr],
    claims: Sequence[Expr],
    unknowns: Sequence[Symbol],
    domain: Domain,
    reading: Reading,
) -> Verdict:
    """Tell whether claims are combinations of equations; what is none may follow from them with their rates."""
    same = SameEquations((*system, *claims), tuple(system), tuple(unknowns), domain, before=len(system))
    verdict = decide(same, Deadline.after(reading.claim.budget / 4))
    if verdict.fails:
        raise Undecided(
            "the equations do not determine all accelerations and multipliers; where functions are arbitrary, or "
            "constraints have several branches, what follows from the rates of equations is not looked into"
        )
    return verdict


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
    through = {**branch.values, **(solve_affine(left, bound, branch.domain) if bound else {})}
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
