"""Claims about what a map leaves invariant for arbitrary functions, and about brackets given by their structure.

Poisson's brackets of all functions, Lagrange's brackets of all variables and phase volume are invariant exactly where
M J Mᵀ = J (volume: det² M = 1). Hamilton's equations keep their form for every H exactly where M J Mᵀ = c J with a
constant c ≠ 0 (then K = c H + …); Lagrange's for every L where ∂Q/∂q is regular.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.exercise.judges.canonical import canonical_parts, rules_of
from canon.exercise.judges.conserved import same_everywhere
from canon.exercise.judges.energy_and_force import shown_short
from canon.exercise.question.answer import stay_open
from canon.exercise.question.continuous_answer import constants_are_continuous, is_continuous
from canon.exercise.question.question import Determines, Part, Question, Regular, Same, Stated, Tells
from canon.expression.symbols.symbol import acceleration, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.linear import eliminate
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.hamilton.bracket import lagrange_bracket, poisson_bracket
from canon.proof.continuity.smooth import PIECED, without_pieces
from canon.proof.domain.verdict import Status, Undecided, Verdict
from canon.proof.kinks import off_kinks

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = ["invariance", "jacobi_identity"]

_SUBJECTS = (
    "poisson-brackets",
    "lagrange-brackets",
    "hamilton-equations",
    "phase-volume",
    "lagrange-equations",
)


def invariance(reading: Reading) -> Iterator[Question]:
    """The map leaves brackets, volume, or the form of the equations of motion invariant for all functions."""
    subject = reading.word("of")
    if subject not in _SUBJECTS:
        reading.fault("of", f"write {', '.join(_SUBJECTS[:-1])} or {_SUBJECTS[-1]}")
    if subject == "lagrange-equations":
        yield _point_transformation(reading)
        return
    for key in ("p",) if reading.has("F") else ("p", "P"):
        if not reading.has(key):
            reading.fault(key, f"missing; a map of phase space is needed for {subject}")
    if reading.has("F"):
        yield from _generated(reading)
        return
    q, p = reading.phase_space("q", "p")
    Q, P = reading.expressions("Q", like="q"), reading.expressions("P", like="p")
    domain = reading.domain
    if subject == "phase-volume":
        M = sp.Matrix([[f.diff(z) for z in (*q, *p)] for f in (*Q, *P)])
        part = Part("the square of the determinant", cast("Expr", M.det(method="berkowitz")) ** 2, sp.S.One)
        yield Same((part,), domain, _no_answer, is_instead)
    elif subject == "poisson-brackets":
        yield Same(canonical_parts(Q, P, q, p), domain, _no_answer, is_instead)
    elif subject == "lagrange-brackets":
        yield Same(_lagrange_parts(Q, P, q, p), domain, _no_answer, is_instead)
    else:
        yield from _hamiltonian_form(reading, domain, Q, P, q, p)


def _hamiltonian_form(
    reading: Reading,
    domain: Domain,
    Q: Sequence[Expr],
    P: Sequence[Expr],
    q: Sequence[Symbol],
    p: Sequence[Symbol],
) -> Iterator[Question]:
    """M J Mᵀ = c J with the same c ≠ 0 at all points and times."""
    valence = poisson_bracket(Q[0], P[0], q, p)
    yield Regular(
        sp.Matrix([[valence]]), "{Q, P}", domain, "{Q, P} = 0: the map is singular", exceptions=True
    )
    moving = (*q, *p, reading.time)
    yield Same(tuple(_constancy(valence, moving, domain)), domain, _no_answer, is_instead)
    yield is_continuous(valence, moving, domain, "{Q, P}")
    yield Same(canonical_parts(Q, P, q, p, valence), domain, _no_answer, is_instead)


def _constancy(valence: Expr, moving: Sequence[Symbol], domain: Domain) -> Iterator[Part]:
    """Yield slopes that vanish where the valence is constant; one with pieces is compared with its value at a point."""
    beside = off_kinks([valence], domain).strictly
    point = next(beside.points(moving, 1), None) if valence.has(*PIECED) else None
    if point is not None:
        yield Part("{Q, P}", valence, substitute(valence, {z: point[z] for z in moving}))
        return
    for z in moving:
        yield Part(f"∂{{Q, P}}/∂{z}", valence.diff(z))


def _lagrange_parts(
    Q: Sequence[Expr], P: Sequence[Expr], q: Sequence[Symbol], p: Sequence[Symbol]
) -> tuple[Part, ...]:
    """[z, z′] formed with Q and P is what it is with q and p: Mᵀ J M = J."""
    z, n = (*q, *p), len(q)
    return tuple(
        Part(f"[{z[i]}, {z[j]}]", lagrange_bracket(z[i], z[j], Q, P), sp.S.One if j - i == n else sp.S.Zero)
        for i, j in combinations(range(2 * n), 2)
    )


def _generated(reading: Reading) -> Iterator[Question]:
    """A map given by a generating function, arbitrary perhaps: Lagrange's brackets in the variables of F agree.

    Σ dq∧dp = Σ dQ∧dP in the variables of F is invariance of Lagrange's brackets, and for a regular map of the rest.
    """
    if reading.claim.keys["type"] not in (1, 2, 3, 4):
        reading.fault("type", "should be 1, 2, 3 or 4")
    number = int(reading.claim.keys["type"])
    q, p = reading.phase_space("q", "p")
    Q, P = reading.phase_space("new_q", "new_p")
    if len(Q) != len(q):
        reading.fault("new_q", f"{counted(len(Q), 'new coordinate')} for {len(q)} old; give one each")
    F = reading.expression("F")
    if F.has(
        *((*p, *P) if number == 1 else (*p, *Q) if number == 2 else (*q, *P) if number == 3 else (*q, *Q))
    ):
        reading.fault(
            "F", f"depends on variables that a generating function of type {number} can't depend on"
        )
    rules = rules_of(reading, number, F)
    domain = reading.domain
    hessian = _with_free_jets(rules.mixed_hessian)
    yield Regular(hessian, "the mixed Hessian", domain, "the mixed Hessian is singular: F generates no map")
    given: Mapping[Symbol, Expr] = dict(zip(rules.foreign, rules.values, strict=True))
    old, new = (tuple(given.get(z, z) for z in side) for side in ((*q, *p), (*Q, *P)))
    n = len(q)
    parts = tuple(
        Part(
            f"[{u}, {v}]", lagrange_bracket(u, v, new[:n], new[n:]), lagrange_bracket(u, v, old[:n], old[n:])
        )
        for u, v in combinations((*rules.old, *rules.new), 2)
    )
    yield Same(parts, domain, _no_answer, is_instead)


def _with_free_jets(matrix: sp.Matrix) -> sp.Matrix:
    """Return a matrix with a symbol for each derivative of an arbitrary function: at one point they are independent."""
    atoms = sorted(matrix.atoms(AppliedUndef, sp.Derivative), key=str)
    jets: dict[sp.Basic, Expr] = {atom: Symbol(f"jet{i}", real=True) for i, atom in enumerate(atoms)}
    return matrix.applyfunc(lambda entry: exchanged(entry, jets))


def _no_answer() -> None:
    """Return nothing: many maps would be right."""


def is_instead(part: Part) -> str:
    """Say what a component is, and what it should be."""
    return f"{part.name} is {shown_short(part.seen(part.claimed))}, and should be {shown_short(part.right)}"


def _point_transformation(reading: Reading) -> Question:
    """Q = Q(q, t) with a regular ∂Q/∂q: then Lagrange's equations of every L keep their form."""
    if not reading.has("Q"):
        reading.fault("Q", "missing; give the new coordinates as functions of the old ones")
    if reading.has("P"):
        reading.fault("P", "can't stand here: Lagrange's equations are about Q alone; leave it out")
    q, Q = reading.symbols("q"), reading.expressions("Q", like="q")
    moving = (*(rate(x) for x in q for rate in (velocity, acceleration)), *reading.symbols("p"))
    if any(f.has(*moving) for f in Q):
        why = (
            "new coordinates that hold velocities or momenta are no point transformation: the equations get third "
            "derivatives"
        )
        return Verdict(Status.FAILS, "a point transformation", "structure", feedback=why)
    jacobian = sp.Matrix([[f.diff(x) for x in q] for f in Q])
    if jacobian.has(*PIECED) and not without_pieces(jacobian.flat(), reading.domain):
        raise Undecided(
            "∂Q/∂q has pieces, and may be singular on one of them; narrow the domain to one piece"
        )
    singular = "∂Q/∂q is singular: Q are no coordinates"
    return Regular(jacobian, "∂Q/∂q", reading.domain, singular, exceptions=True)


def jacobi_identity(reading: Reading) -> Iterator[Question]:
    """{xᵢ, xⱼ} = Jᵢⱼ(x), antisymmetric, satisfies Σ_l (J_il ∂_l J_jk + J_jl ∂_l J_ki + J_kl ∂_l J_ij) = 0."""
    x = reading.symbols("x")
    J = _structure(reading, x)
    n = len(x)

    def turned(i: int, j: int, k: int) -> Expr:
        return sp.Add(*(J(i, m) * J(j, k).diff(x[m]) for m in range(n)))

    def brackets(C: Expr) -> list[Expr]:
        return [sp.Add(*(J(k, m) * C.diff(x[m]) for m in range(n))) for k in range(n)]

    parts = [
        Part(f"{{{x[i]}, {{{x[j]}, {x[k]}}}}} + cyclic", turned(i, j, k) + turned(j, k, i) + turned(k, i, j))
        for i, j, k in combinations(range(n), 3)
    ]
    if parts:
        yield Same(tuple(parts), reading.domain, _no_answer, is_instead)
    else:
        yield Stated(Verdict(Status.HOLDS, "Jacobi's identity of two variables", "structure"))
    casimirs = reading.expressions("casimirs") if reading.has("casimirs") else ()
    for i, C in enumerate(casimirs):
        kept = [Part(f"{{{s}, casimirs[{i}]}}", bracket) for s, bracket in zip(x, brackets(C), strict=True)]
        yield Same(tuple(kept), reading.domain, _no_answer, is_instead)
        yield from constants_are_continuous(C, x, reading.domain)
    if casimirs:
        yield Tells(
            (same_everywhere(casimirs, x, reading.domain),), "a number has vanishing brackets in any system"
        )
    bracket = sp.Matrix(n, n, lambda i, j: J(i, j))
    slopes = sp.Matrix([[C.diff(s) for s in x] for C in casimirs])
    yield Determines(lambda: _casimirs_missing(bracket, slopes, reading.domain))


def _casimirs_missing(bracket: sp.Matrix, slopes: sp.Matrix, domain: Domain) -> tuple[str, ...]:
    """Return how many Casimir functions stay open: as many are independent as the bracket has null directions."""
    there = bracket.rows - eliminate(bracket, domain=domain).rank
    missing = there - (eliminate(slopes, domain=domain).rank if slopes.rows else 0)
    return stay_open(
        ["a Casimir function" if missing == 1 else f"{missing} Casimir functions"] * (missing > 0)
    )


def _structure(reading: Reading, x: Sequence[Symbol]) -> Callable[[int, int], Expr]:
    table: dict[tuple[int, int], Expr] = {}
    for number, (u, v, value) in enumerate(reading.brackets("u", "v")):
        for letter, s in (("u", u), ("v", v)):
            if s not in x:
                reading.fault(f"pairs[{number}].{letter}", f"{s} is not one of {', '.join(map(str, x))}")
        i, j = x.index(cast("Symbol", u)), x.index(cast("Symbol", v))
        if i == j or (i, j) in table:
            reading.fault(f"pairs[{number}]", f"{{{u}, {v}}} is given already, or zero by antisymmetry")
        table[i, j], table[j, i] = value, -value

    def entry(i: int, j: int) -> Expr:
        return table.get((i, j), sp.S.Zero)

    return entry
