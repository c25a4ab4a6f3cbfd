"""Claims about actions, angles and frequencies of separable systems.

Actions are (1/2π) ∮ p dq over one cycle of each coordinate. The right ones are known in closed form where the loop
integral is a known one, recognised and certified on tori (:func:`canon.mechanics.closed_actions`); elsewhere a claim is
refuted by certified quadrature, or not decided. A formula holds for motions of one kind: where the domain has several,
such as the librations and rotations of a pendulum, it must be narrowed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, islice
from typing import TYPE_CHECKING, cast

import numpy as np
import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.exercise.judges.canonical import canonical_parts
from canon.exercise.question.deadline import PROOF_SECONDS, Deadline
from canon.exercise.question.question import Part, Question, Same, Stated, wrong_variables
from canon.expression.symbols.user_input import counted
from canon.frozen_mapping import FrozenMapping
from canon.mechanics.algebra.constraint_manifold import transported
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.actions import ActionVariables, action_variables
from canon.mechanics.integrable.ball_function import NotHolomorphicError
from canon.mechanics.integrable.closed_form.actions_in_closed_form import closed_actions, lies_in
from canon.mechanics.integrable.complete_integral import CompleteIntegral, hamilton_jacobi
from canon.mechanics.integrable.cycles import ball_of
from canon.mechanics.integrable.separated_momenta import NotSeparatedError
from canon.mechanics.integrable.turning_points import NoCycleError
from canon.proof.domain.balls import precision
from canon.proof.domain.domain import EVERYWHERE, Domain
from canon.proof.domain.verdict import Counterexample, Status, Undecided, Verdict
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from flint import arb
    from sympy.logic.boolalg import Boolean

    from canon.exercise.sheet.reading import Reading

__all__ = ["action_angle", "frequency", "slow_invariant"]

DIGITS = 15
TORI = 3
"""On how many tori of the domain the actions must be the same formulas."""
COMPARED = 9
"""On how many tori of the domain, in its box and outside, kinds of motion and formulas are compared."""
POINTS = 24
"""Points of the domain that are tried for these tori; through some of them no bounded motion goes."""
BITS = 128
LONGEST = 400
"""Operations of a formula of an action that is compared; claims about others are refuted by quadrature alone."""
KEPT = 8
"""Systems whose tori are kept."""


@dataclass(frozen=True)
class _Tori:
    """Some tori of a separable system, and its actions in closed form where they are known.

    Parameters
    ----------
    integral
        The complete integral that separates.
    tori
        Tori through points of the domain.
    J
        Actions as functions of the constants, the same on all of these tori; None where no closed form is known.
    back
        The functions of parameters for which symbols stand in the integral.
    """

    integral: CompleteIntegral
    tori: tuple[ActionVariables, ...]
    J: tuple[Expr | None, ...]
    back: Mapping[Expr, Expr]

    def of_state(self, f: Expr) -> Expr:
        """Return a function of the constants as one of (q, p)."""
        return exchanged(substitute(f, dict(self.integral.defined_as)), self.back)

    @property
    def in_closed_form(self) -> bool:
        """Whether all actions are known as formulas."""
        return all(J is not None for J in self.J)

    def shown(self) -> tuple[Expr, ...]:
        """Return all actions as functions of the constants, the energy being E."""
        E = Symbol("E", real=True)
        return tuple(substitute(J, {self.integral.energy: E}) for J in self.known())

    def known(self) -> tuple[Expr, ...]:
        """Return all actions as functions of the constants.

        Raises
        ------
        Undecided
            Where one of them has no closed form that is known.
        """
        found = [J for J in self.J if J is not None]
        if len(found) < len(self.J):
            unknown = [str(x) for x, J in zip(self.integral.H.q, self.J, strict=True) if J is None]
            raise Undecided(
                f"the action of {', '.join(unknown)} has no closed form that canon knows; certified quadrature at "
                f"{len(self.tori)} points has nothing against the claim, which is no proof"
            )
        return tuple(found)


def action_angle(reading: Reading) -> Iterator[Question]:
    """J are the actions; or a map is canonical, and its new momenta are the actions up to a unimodular matrix."""
    H = _hamiltonian(reading)
    if not reading.has("J"):
        yield from _map_to_actions(reading, H)
        return
    claimed, at_energy, tori = (
        reading.expressions("J", like="q"),
        _at_energy(reading, H),
        _tori(H, reading),
    )
    if not tori.in_closed_form:
        numbers = [substitute(J, at_energy) for J in claimed]
        refuted = _refuted(numbers, [torus.J for torus in tori.tori], tori.tori, "the action of")
        if refuted is not None:
            yield Stated(refuted)
            return
    right = tuple(map(tori.of_state, tori.known()))
    yield Same(
        _components("the action", "J", H.q, claimed, right, at_energy),
        reading.domain,
        tori.shown,
        _whole_loop,
    )


def _components(
    name: str,
    key: str,
    q: Sequence[Symbol],
    claimed: Sequence[Expr],
    right: Sequence[Expr],
    through: Mapping[Symbol, Expr],
) -> tuple[Part, ...]:
    return tuple(
        Part(f"{name} of {x}", f, due, FrozenMapping(through), key=f"{key}[{i}]")
        for i, (x, f, due) in enumerate(zip(q, claimed, right, strict=True))
    )


def _whole_loop(part: Part) -> str:
    """Say whether 1/2π was forgotten, as where ∮ p dq itself is called the action."""
    return f"this is ∮ p dq; {part.name} is that divided by 2π" if _is_times(part, 2 * sp.pi) else ""


def _turns_alone(part: Part) -> str:
    """Say whether turns are counted, not radians."""
    return f"this counts turns; {part.name} is 2π times that" if _is_times(part, 1 / (2 * sp.pi)) else ""


def _is_times(part: Part, factor: Expr) -> bool:
    return vanishes_off_kinks(part.seen(part.claimed) - factor * part.right, EVERYWHERE, PROOF_SECONDS).holds


def _map_to_actions(reading: Reading, H: Hamiltonian) -> Iterator[Question]:
    """{Q, P} is the unit matrix, and the actions are A P + constants with an integer matrix A, det A = ±1."""
    new_q, new_p = reading.phase_space("new_q", "new_p")
    if len(new_q) != len(H.q):
        reading.fault("new_q", f"{counted(len(new_q), 'angle')} for {counted(len(H.q), 'coordinate')}")
    table, n = reading.table("transformation"), len(H.q)
    new, old = ({s.name: s for s in side} for side in ((*new_q, *new_p), (*H.q, *H.p)))
    if set(table) == set(new):
        images, (q, p), written = [table[name] for name in new], (H.q, H.p), new
        momenta, seen = images[n:], FrozenMapping[Symbol, Expr]({})
    elif set(table) == set(old):
        images, (q, p), written = [table[name] for name in old], (new_q, new_p), old
        momenta, seen = list(new_p), FrozenMapping(dict(zip((*H.q, *H.p), images, strict=True)))
    else:
        reading.fault("transformation", f"should say what {', '.join(new)} are, or what {', '.join(old)} are")
    if any(f.has(*written.values()) for f in images):
        reading.fault("transformation", "the variables on the left can't occur in the expressions")
    for name, f in table.items():
        yield from wrong_variables(f, (reading.time,), name, "the other variables alone, as H is")
    domain = transported(reading.domain, seen) if seen else reading.domain
    yield Same(canonical_parts(images[:n], images[n:], q, p), domain)
    tori = _tori(H, reading)
    right = [substitute(tori.of_state(J), seen) for J in tori.known()]
    A = _integer_matrix(right, momenta, (*q, *p), domain)
    rows = (sp.Add(*(k * P for k, P in zip(A.row(i), momenta, strict=True))) for i in range(n))
    parts = tuple(
        Part(f"∂/∂{z} of the action of {x}", row.diff(z), J.diff(z))
        for x, row, J in zip(H.q, rows, right, strict=True)
        for z in (*q, *p)
    )
    said = "the new momenta are not the actions (1/2π) ∮ p dq: the angles do not grow by 2π in a turn"
    yield Same(parts, domain, tori.shown, lambda _: said)


def _integer_matrix(
    right: Sequence[Expr], momenta: Sequence[Expr], z: Sequence[Symbol], domain: Domain
) -> sp.Matrix:
    """Return the unimodular integer matrix that takes momenta to actions; the unit matrix where none does."""
    unit = sp.eye(len(right))
    symbols = {s for f in (*right, *momenta) for s in f.free_symbols if isinstance(s, Symbol)} | {*z}
    for point in domain.points(symbols, 6):
        due, given = (
            np.array([[complex(sp.N(substitute(f.diff(s), point))) for s in z] for f in functions])
            for functions in (right, momenta)
        )
        if not (np.isfinite(due).all() and np.isfinite(given).all()):
            continue
        if np.linalg.matrix_rank(given) == len(right):
            found = np.linalg.lstsq(given.T, due.T, rcond=None)[0].T.real
            A = sp.Matrix(np.rint(found).astype(int).tolist())
            return A if A.det() in (1, -1) else unit
    return unit


def frequency(reading: Reading) -> Iterator[Question]:
    """ω_i = ∂H/∂J_i: by Cramer's rule the quotient of a cofactor of ∂J/∂α and its determinant."""
    H = _hamiltonian(reading)
    names = reading.symbols("actions")
    if names and len(names) != len(H.q):
        reading.fault("actions", "should name one action for each coordinate, or be left out")
    claimed, through = reading.expressions("omega", like="q"), _at_energy(reading, H)
    tori = _tori(H, reading)
    if not names and not tori.in_closed_form:
        numbers = [substitute(f, through) for f in claimed]
        refuted = _refuted(numbers, [torus.frequencies for torus in tori.tori], tori.tori, "the frequency of")
        if refuted is not None:
            yield Stated(refuted)
            return
    J, constants = tori.known(), tori.integral.constants
    slopes = sp.Matrix([[action.diff(c) for c in constants] for action in J])
    through |= {name: tori.of_state(f) for name, f in zip(names, J, strict=False)}
    energy = constants.index(tori.integral.energy)
    determinant = slopes.det(method="berkowitz")
    omega = tuple(slopes.cofactor(i, energy, method="berkowitz") / determinant for i in range(len(J)))
    right = tuple(map(tori.of_state, omega))
    answer = tuple(substitute(f, {tori.integral.energy: Symbol("E", real=True)}) for f in omega)
    yield Same(
        _components("the frequency", "omega", H.q, claimed, right, through),
        reading.domain,
        lambda: answer,
        _turns_alone,
    )


def slow_invariant(reading: Reading, I: Expr, tau: Symbol, H0: Expr) -> Iterator[Question]:
    """I is a function of the action of H₀ at fixed τ: their gradients in (q, p, τ) are parallel."""
    q, p = reading.phase_space("q", "p")
    if len(q) > 1:
        raise Undecided(
            "to lowest order invariants of one degree of freedom are judged; for more, claim I with order = 1"
        )
    tori = _tori(Hamiltonian(H0, q, p, reading.time), reading)
    J = tori.of_state(tori.known()[0])
    variables = (*q, *p, tau)
    parts = tuple(
        Part(f"∂(I, J)/∂({a}, {b})", I.diff(a) * J.diff(b) - I.diff(b) * J.diff(a))
        for a, b in combinations(variables, 2)
    )
    said = f"I is no function of the action: its mean changes as {tau} does"
    yield Same(parts, reading.domain, lambda: J, lambda _: said)


def _hamiltonian(reading: Reading) -> Hamiltonian:
    q, p = reading.phase_space("q", "p")
    H = reading.expression("H")
    if H.has(reading.time):
        reading.fault("H", f"depends on {reading.time}; actions are those of motions with a fixed energy")
    return Hamiltonian(H, q, p, reading.time)


def _at_energy(reading: Reading, H: Hamiltonian) -> dict[Symbol, Expr]:
    """Return H for the name of the energy, which is ``energy``, or E where it is declared."""
    name = reading.word("energy") if reading.has("energy") else "E"
    E = reading.scope.symbol(name)
    if reading.has("energy") and (E is None or E in (*H.q, *H.p) or H.H.has(E)):
        reading.fault("energy", f"should be a name among the parameters that does not stand in H, not {name}")
    return {} if E is None or E in (*H.q, *H.p) or H.H.has(E) else {E: H.H}


def _tori(H: Hamiltonian, reading: Reading) -> _Tori:
    """Return the tori of a system; those of the last few are kept, as each repair of an answer asks for them anew."""
    domain = reading.domain
    box = tuple(domain.box.items())
    return _kept_tori(H.H, H.q, H.p, H.t, domain.conditions, box, reading.claim.budget)


@lru_cache(maxsize=KEPT)
def _kept_tori(
    energy: Expr,
    q: tuple[Symbol, ...],
    p: tuple[Symbol, ...],
    t: Symbol,
    conditions: tuple[Boolean, ...],
    box: tuple[tuple[Symbol, tuple[sp.Rational, sp.Rational]], ...],
    budget: float,
) -> _Tori:
    """Return tori through points of the domain, and the actions that are one formula on all of them.

    Raises
    ------
    Undecided
        Where H does not separate, no bounded motions were found in the time of the claim, or the formula is another one
        in parts of the domain.
    """
    deadline = Deadline.after(budget)
    frozen = _frozen(energy, (*q, *p))
    still = Hamiltonian(exchanged(energy, frozen), q, p, t)
    there = Domain(tuple(cast("Boolean", c.xreplace(frozen)) for c in conditions), FrozenMapping(dict(box)))
    try:
        integral = hamilton_jacobi(still, domain=there, energy=Symbol("E_0", real=True))
    except NotSeparatedError as reason:
        raise Undecided(f"actions are known where the Hamilton–Jacobi equation separates; {reason}") from None
    try:
        # A box is a hint only: what holds there must hold on the rest of the domain too.
        compared = list(islice(_bounded(integral, Domain(there.conditions), deadline), COMPARED))
        found = list(islice(_bounded(integral, there, deadline), TORI)) if there.box else compared[:TORI]
    except NotHolomorphicError as reason:
        raise Undecided(f"no quadrature of this H is certified: {reason}") from None
    if len(found) < TORI:
        raise Undecided(
            f"bounded motions were found through {len(found)} of {POINTS} points of the domain only; narrow it"
        )
    if len({tuple(cycle.kind for cycle in torus.cycles) for torus in (*found, *compared)}) > 1:
        raise Undecided(
            "the domain has motions of several kinds, librations and rotations; narrow it to those that are meant"
        )
    known = tuple(None if action is None else action.J for action in closed_actions(found[0], LONGEST))
    if not all(_lie_in(known, torus) for torus in (*found, *compared)):
        raise Undecided("the actions are other functions in parts of the domain; narrow it")
    back = {symbol: f for f, symbol in frozen.items()}
    return _Tori(integral, tuple(found), tuple(J if J is None else exchanged(J, back) for J in known), back)


def _frozen(H: Expr, state: Sequence[Symbol]) -> dict[Expr, Expr]:
    """Return symbols for the functions of parameters that H holds."""
    functions = sorted(H.atoms(AppliedUndef), key=str)
    if any(f.has(*state) for f in functions):
        raise Undecided(
            "H holds a function of the coordinates that is not given, so its actions are not known"
        )
    return {f: Symbol(f"{f.func}_{i}", real=True, positive=f.is_positive) for i, f in enumerate(functions)}


def _bounded(integral: CompleteIntegral, domain: Domain, deadline: Deadline) -> Iterator[ActionVariables]:
    """Yield tori through points of a domain, where there are bounded motions.

    Raises
    ------
    Undecided
        Where the time ends before the points do: fewer tori would let a formula pass that is another one elsewhere.
    """
    H = integral.H
    symbols = {s for s in H.H.free_symbols if isinstance(s, Symbol)} | {*H.q, *H.p}
    for point in domain.points(symbols, POINTS):
        if deadline.worked_off:
            raise Undecided(
                "actions all over the domain were not found in the budget; give a larger one, or narrow the domain"
            )
        start = {z: point[z] for z in (*H.q, *H.p)}
        parameters = {s: point[s] for s in symbols - set(start)}
        try:
            yield action_variables(integral, start, parameters, DIGITS)
        except NoCycleError:
            continue


def _lie_in(known: Sequence[Expr | None], torus: ActionVariables) -> bool:
    with precision(BITS):
        pairs = zip(known, torus.J, strict=True)
        return all(lies_in(J, torus.values, ball) for J, ball in pairs if J is not None)


def _refuted(
    claimed: Sequence[Expr],
    balls: Sequence[Sequence[arb]],
    tori: Sequence[ActionVariables],
    name: str,
) -> Verdict | None:
    """Return FAILS where a claimed number is outside of the ball of certified quadrature on some torus."""
    with precision(BITS):
        for torus, right in zip(tori, balls, strict=True):
            for x, f, due in zip(torus.integral.H.q, claimed, right, strict=True):
                value = ball_of(substitute(f, dict(torus.values)))
                if not value.is_finite() or (value.imag.contains(0) and value.real.overlaps(due)):
                    continue
                point = {s.name: str(v) for s, v in torus.values.items() if s not in torus.integral.constants}
                example = Counterexample(point, value.str(8, radius=False), due.str(8, radius=False), DIGITS)
                return Verdict(Status.FAILS, f"{name} {x}", "ball", counterexample=example)
    return None
